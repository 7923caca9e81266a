//! What states the EMF constant: `back_emf`, `speed_constant` or `torque_constant`, each of its own
//! basis.
//!
//! The phase constant is the peak EMF of a phase of the equivalent star over mechanical speed. Every
//! basis is that times a number, which follows from the shape of the EMF.

use crate::diagnostics::{Collector, Diagnostic, catalogue, engineering};
use crate::spec::EmfShape;
use crate::spec::ast::Basis;
use crate::spec::fields;
use crate::spec::reader::{Given, Reader};
use crate::spec::units::Dimension;

/// The fields that state it, in the order in which they are taken.
pub(super) const FIELDS: [&str; 3] = ["back_emf", "speed_constant", "torque_constant"];

/// Plausible peak phase EMF constants, V s/rad.
const PLAUSIBLE: [f64; 2] = [1e-5, 100.0];

/// How the phases are connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Winding {
    Star,
    Delta,
}

/// What a constant refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reading {
    /// Amplitude of a phase's EMF.
    PhasePeak,
    /// Amplitude between two terminals.
    LinePeak,
    /// Root mean square of a phase's EMF.
    PhaseRms,
    /// Root mean square between two terminals.
    LineRms,
    /// Mean over a sector of block commutation: of the EMF between its two terminals, or of the
    /// torque per ampere.
    BlockMean,
    /// Torque per ampere of the peak of a current of the EMF's own shape.
    PerPeakAmpere,
    /// Torque per ampere of that current's root mean square.
    PerRmsAmpere,
    /// Torque per ampere of a peak, of a block or of a sine: where the sheet does not say.
    PerAmpere,
}

impl Reading {
    /// The constant over the phase constant.
    pub fn factor(self, shape: EmfShape) -> f64 {
        match self {
            Self::PhasePeak => 1.0,
            Self::LinePeak => shape.line_to_line_peak(),
            Self::PhaseRms => shape.phase_rms(),
            Self::LineRms => shape.line_to_line_rms(),
            Self::PerPeakAmpere => shape.rated_factor(),
            Self::PerRmsAmpere => shape.rated_factor() * shape.rated_peak(),
            Self::BlockMean | Self::PerAmpere => shape.quasi_square_factor(),
        }
    }

    /// Basis words that say it, for messages.
    pub fn words(self) -> &'static str {
        match self {
            Self::PhasePeak => "phase peak",
            Self::LinePeak => "line_to_line peak",
            Self::PhaseRms => "phase rms",
            Self::LineRms => "line_to_line rms",
            Self::BlockMean => "block_mean",
            Self::PerPeakAmpere => "per_peak_ampere",
            Self::PerRmsAmpere => "per_rms_ampere",
            Self::PerAmpere => "",
        }
    }
}

/// Basis words of a reading for the number as it was written.
pub(super) fn words(given: &Given, reading: Reading) -> String {
    let words = reading.words();
    if given.basis.contains(&Basis::PeakToPeak) {
        doubled(words)
    } else {
        words.to_owned()
    }
}

/// Basis words of an amplitude for what is stated from peak to peak.
fn doubled(words: &str) -> String {
    words.replace("peak", "peak_to_peak")
}

/// The amplitude of what is stated from peak to peak.
pub(super) fn amplitude(given: Given) -> Given {
    let factor = match given.dimension {
        // It is over the voltage.
        Some(Dimension::SpeedConstant) => 2.0,
        _ => 0.5,
    };
    Given {
        si: factor * given.si,
        ..given
    }
}

/// A statement of the EMF constant.
#[derive(Clone, Debug)]
pub(super) struct Emf<'a> {
    pub given: Given<'a>,
    pub reading: Reading,
}

impl Emf<'_> {
    /// As written, in V s/rad or Nm/A per mechanical angle.
    pub fn constant(&self, pole_pairs: u32) -> f64 {
        let si = self.given.si;
        match self.given.dimension {
            Some(Dimension::SpeedConstant) => 1.0 / si,
            Some(Dimension::FluxLinkage) => si * f64::from(pole_pairs),
            _ => si,
        }
    }

    /// What a constant of its dimension may refer to.
    pub fn readings(&self) -> &'static [Reading] {
        use Reading::{
            BlockMean, LinePeak, LineRms, PerPeakAmpere, PerRmsAmpere, PhasePeak, PhaseRms,
        };
        match self.given.dimension {
            Some(Dimension::EmfConstant) => &[PhasePeak, LinePeak, PhaseRms, LineRms, BlockMean],
            Some(Dimension::FluxLinkage) => &[PhasePeak, PhaseRms],
            Some(Dimension::SpeedConstant) => &[LinePeak, LineRms, BlockMean],
            _ => &[BlockMean, PerPeakAmpere, PerRmsAmpere],
        }
    }

    /// Whether neither its words nor its unit say what it refers to.
    pub fn is_open(&self) -> bool {
        let says = |basis: &Basis| *basis != Basis::LineToLine;
        self.given.dimension != Some(Dimension::FluxLinkage) && !self.given.basis.iter().any(says)
    }

    /// Peak phase EMF of the equivalent star over mechanical speed, V s/rad.
    pub fn phase_constant(&self, shape: EmfShape, pole_pairs: u32) -> f64 {
        self.constant(pole_pairs) / self.reading.factor(shape)
    }
}

/// Reports that none of the fields is given, and the constant that a no-load speed says in its place.
pub(super) fn require(reader: &Reader, errors: &mut Collector) {
    let is_missing = FIELDS.iter().all(|name| reader.may_lack(name));
    match of_no_load(reader).filter(|_| is_missing) {
        Some(error) => errors.push(error),
        None => reader.require_any_of(errors, &FIELDS),
    }
}

/// The speed constant of a no-load speed at a voltage that is stated beside it. Values that cannot be read are told of
/// elsewhere.
fn of_no_load(reader: &Reader) -> Option<Diagnostic> {
    let mut untold = Collector::new();
    let given =
        ["no_load_speed", "nominal_voltage"].map(|name| reader.plain_quantity(&mut untold, name));
    let is_right = untold.finish().is_none();
    let [Some(speed), Some(voltage)] = given else {
        return None;
    };
    is_right.then(|| {
        catalogue::missing_emf_beside_no_load_speed(
            reader.location(),
            &FIELDS,
            [&speed.part, &voltage.part],
            speed.si / voltage.si,
        )
    })
}

/// All statements, the one that is taken first. A constant that does not say its basis has the usual one;
/// `super::agreement` chooses among the others later.
pub(super) fn read<'a>(
    reader: &Reader<'a>,
    winding: Option<Winding>,
    shape: Option<EmfShape>,
    errors: &mut Collector,
) -> Vec<Emf<'a>> {
    let is_alone = FIELDS[..2].iter().all(|name| reader.field(name).is_none());
    let all = [
        read_back_emf(reader, winding, shape, errors),
        read_speed_constant(reader, shape, errors),
        read_torque_constant(reader, is_alone, shape, errors),
    ];
    // Where the first is in error the others must not take its place.
    let is_readable = FIELDS
        .iter()
        .zip(&all)
        .find(|(name, _)| reader.field(name).is_some())
        .is_some_and(|(_, stated)| stated.is_some());
    if is_readable {
        let mut all: Vec<Emf> = all.into_iter().flatten().collect();
        // A stated basis is more than a usual one.
        all.sort_by_key(Emf::is_open);
        all
    } else {
        Vec::new()
    }
}

fn refuse(given: &Given, basis: Basis, remedy: &str, errors: &mut Collector) {
    let part = &given.part;
    errors.push(catalogue::wrong_basis(
        &part.location,
        part.field,
        &part.given,
        basis.word(),
        remedy,
    ));
}

/// A trace between two terminals does not show the harmonics of a phase that cancel there, so nothing of
/// a phase alone can be compared with it.
pub(super) fn refuse_phase(all: &mut Vec<Emf>, errors: &mut Collector) {
    let of_phase = |stated: &&Emf| matches!(stated.reading, Reading::PhasePeak | Reading::PhaseRms);
    if let Some(stated) = all.iter().find(of_phase) {
        let remedy = "a trace between two terminals does not show the third harmonic of a phase; give the constant with `line_to_line`";
        refuse(&stated.given, Basis::Phase, remedy, errors);
        // Nothing follows from them.
        all.clear();
    }
}

/// The EMF constant, whose basis must be stated and possible.
fn read_back_emf<'a>(
    reader: &Reader<'a>,
    winding: Option<Winding>,
    shape: Option<EmfShape>,
    errors: &mut Collector,
) -> Option<Emf<'a>> {
    let given = reader.quantity(errors, "back_emf")?;
    let has = |basis: Basis| given.basis.contains(&basis);
    let phase = has(Basis::Phase) || has(Basis::PerPhase);
    let line = has(Basis::LineToLine);
    let amplitudes = [Basis::Peak, Basis::PeakToPeak, Basis::Rms, Basis::BlockMean];
    let stated: Vec<Basis> = amplitudes.into_iter().filter(|&basis| has(basis)).collect();
    let of_torque = [Basis::PerPeakAmpere, Basis::PerRmsAmpere];
    if let Some(basis) = of_torque.into_iter().find(|&basis| has(basis)) {
        refuse(
            &given,
            basis,
            "that is a basis of `torque_constant`",
            errors,
        );
        return None;
    }
    if phase && line {
        let remedy = "it is given as `phase` already; keep one of the two";
        refuse(&given, Basis::LineToLine, remedy, errors);
        return None;
    }
    if let [first, second, ..] = stated[..] {
        let remedy = format!(
            "it is given as `{}` already; keep one of the two",
            first.word()
        );
        refuse(&given, second, &remedy, errors);
        return None;
    }
    let dimension = given.dimension?;
    if has(Basis::BlockMean) && (phase || dimension == Dimension::FluxLinkage) {
        let remedy = "a mean over block commutation is one between two terminals; give `peak` or `rms` of the phase";
        refuse(&given, Basis::BlockMean, remedy, errors);
        return None;
    }
    match dimension {
        Dimension::SpeedConstant if phase => {
            let remedy = "a speed constant refers to the voltage between two terminals; give V/krpm with `phase peak` instead";
            refuse(&given, Basis::Phase, remedy, errors);
            return None;
        }
        Dimension::FluxLinkage if line => {
            let remedy =
                "a flux linkage refers to the phase; give V/krpm with `line_to_line peak` instead";
            refuse(&given, Basis::LineToLine, remedy, errors);
            return None;
        }
        Dimension::FluxLinkage if winding == Some(Winding::Delta) => {
            let remedy = "the flux linkage of a delta winding is ambiguous; give V/krpm with `line_to_line peak`";
            refuse(&given, Basis::Phase, remedy, errors);
            return None;
        }
        _ => {}
    }
    let between_lines = match dimension {
        Dimension::SpeedConstant => Some(true),
        Dimension::FluxLinkage => Some(false),
        // The phase of a delta lies between two lines.
        _ if phase => winding.map(|winding| winding == Winding::Delta),
        _ => line.then_some(true),
    };
    if dimension == Dimension::SpeedConstant && stated.is_empty() && is_open(reader) {
        push_forms(&given, [false, true], None, shape, errors);
        return None;
    }
    let (given, basis) = match stated.first() {
        None if dimension != Dimension::EmfConstant => (given, Some(Basis::Peak)),
        Some(Basis::PeakToPeak) => (amplitude(given), Some(Basis::Peak)),
        stated => (given, stated.copied()),
    };
    let reading = match (between_lines, basis) {
        (_, Some(Basis::BlockMean)) => Reading::BlockMean,
        (Some(true), Some(Basis::Peak)) => Reading::LinePeak,
        (Some(true), Some(Basis::Rms)) => Reading::LineRms,
        (Some(false), Some(Basis::Peak)) => Reading::PhasePeak,
        (Some(false), Some(Basis::Rms)) => Reading::PhaseRms,
        // A winding in error says nothing of a phase.
        (None, Some(_)) if phase => return None,
        _ => {
            push_forms(&given, [phase, line], basis, shape, errors);
            return None;
        }
    };
    Some(Emf { given, reading })
}

/// What a reading of an EMF constant says, from peak to peak or not.
fn meaning(reading: Reading, is_double: bool) -> &'static str {
    match reading {
        Reading::PhasePeak if is_double => "from peak to peak of one phase",
        Reading::PhasePeak => "amplitude of one phase",
        Reading::LinePeak if is_double => "from peak to peak between two terminals",
        Reading::LinePeak => "amplitude between two terminals",
        Reading::PhaseRms => "root mean square of one phase",
        Reading::LineRms => "root mean square between two terminals",
        _ => "mean over block commutation, between two terminals",
    }
}

/// A reading of an EMF constant as it is written, from peak to peak or not, and its meaning. Of a constant from
/// peak to peak, `given` is the amplitude.
fn form(
    given: &Given,
    reading: Reading,
    is_double: bool,
    shape: Option<EmfShape>,
) -> (String, String) {
    let words = reading.words();
    let words = if is_double {
        doubled(words)
    } else {
        words.to_owned()
    };
    let what = meaning(reading, is_double);
    let meaning = shape.map_or_else(
        || what.to_owned(),
        |shape| {
            let given = given.clone();
            // A flux linkage says its basis by itself.
            let phase = Emf { given, reading }.phase_constant(shape, 1);
            let torque = engineering(phase * shape.quasi_square_factor(), "Nm/A");
            format!("{what}: {torque} in block commutation")
        },
    );
    (with_words(given, &words), meaning)
}

/// The readings of a constant that is open, as they are written, and what each would mean.
pub(super) fn forms(stated: &Emf, shape: EmfShape) -> Vec<(String, String)> {
    let all = stated.readings().iter();
    all.map(|&reading| form(&stated.given, reading, false, Some(shape)))
        .collect()
}

/// The readings of an EMF constant that does not say its basis, each with the torque per ampere of
/// block commutation that it means.
fn push_forms(
    given: &Given,
    [phase, line]: [bool; 2],
    amplitude: Option<Basis>,
    shape: Option<EmfShape>,
    errors: &mut Collector,
) {
    use Reading::{BlockMean, LinePeak, LineRms, PhasePeak, PhaseRms};
    let fits = |reading: &Reading| {
        let refers = match reading {
            PhasePeak | PhaseRms => !line,
            _ => !phase,
        };
        let means = match amplitude {
            None => true,
            Some(Basis::Rms) => matches!(reading, PhaseRms | LineRms),
            Some(_) => matches!(reading, PhasePeak | LinePeak),
        };
        refers && means
    };
    let is_double = given.basis.contains(&Basis::PeakToPeak);
    let mut readings = [PhasePeak, LinePeak, PhaseRms, LineRms, BlockMean];
    if given.dimension == Some(Dimension::SpeedConstant) {
        // The usual basis of a KV stands first.
        readings.rotate_right(1);
    }
    let mut forms: Vec<(String, String)> = readings
        .into_iter()
        .filter(fits)
        .map(|reading| form(given, reading, is_double, shape))
        .collect();
    // Of a trace between two terminals.
    if !phase && amplitude.is_none() && given.dimension == Some(Dimension::EmfConstant) {
        let halved = self::amplitude(given.clone());
        let behind_peaks = if line { 1 } else { 2 };
        forms.insert(behind_peaks, form(&halved, LinePeak, true, shape));
    }
    let part = &given.part;
    errors.push(catalogue::missing_basis(
        &part.location,
        part.field,
        &part.given,
        &forms,
    ));
}

/// The number with other basis words.
fn with_words(given: &Given, words: &str) -> String {
    let unit = given.number.unit.as_ref().map_or("", |unit| &unit.symbol);
    format!("{} {unit} {words}", given.number.digits)
}

/// Whether nothing says to which voltage a speed constant refers: an oscilloscope shows the peak between two
/// terminals, a meter its root mean square, and makers of outrunners print the mean over block commutation. A
/// second constant tells which it is.
fn is_open(reader: &Reader) -> bool {
    let stated = FIELDS.iter().filter(|name| reader.field(name).is_some());
    stated.count() == 1
}

/// A speed constant refers to the peak between two terminals, unless its basis says otherwise.
fn read_speed_constant<'a>(
    reader: &Reader<'a>,
    shape: Option<EmfShape>,
    errors: &mut Collector,
) -> Option<Emf<'a>> {
    let given = reader.quantity(errors, "speed_constant")?;
    let others: Vec<Basis> = given
        .basis
        .iter()
        .copied()
        .filter(|basis| *basis != Basis::LineToLine)
        .collect();
    let reading = match others[..] {
        [] if is_open(reader) => {
            push_forms(&given, [false, true], None, shape, errors);
            return None;
        }
        [] | [Basis::Peak] => Reading::LinePeak,
        [Basis::PeakToPeak] => {
            let (given, reading) = (amplitude(given), Reading::LinePeak);
            return Some(Emf { given, reading });
        }
        [Basis::Rms] => Reading::LineRms,
        [Basis::BlockMean] => Reading::BlockMean,
        [first, ..] => {
            let is_amplitude = |basis: &Basis| {
                matches!(
                    basis,
                    Basis::Peak | Basis::Rms | Basis::PeakToPeak | Basis::BlockMean
                )
            };
            let wrong = others.iter().copied().find(|basis| !is_amplitude(basis));
            let remedy = "it is speed over the voltage between two terminals: its peak, `rms` or `block_mean`";
            refuse(&given, wrong.unwrap_or(first), remedy, errors);
            return None;
        }
    };
    Some(Emf { given, reading })
}

/// The torque constant; only where it is to give the EMF must it say its basis.
fn read_torque_constant<'a>(
    reader: &Reader<'a>,
    is_alone: bool,
    shape: Option<EmfShape>,
    errors: &mut Collector,
) -> Option<Emf<'a>> {
    let given = reader.quantity(errors, "torque_constant")?;
    let reading = match given.basis {
        [] if !is_alone => Reading::PerAmpere,
        [] => {
            let readings = [
                (Basis::BlockMean, Reading::BlockMean),
                (Basis::PerPeakAmpere, Reading::PerPeakAmpere),
                (Basis::PerRmsAmpere, Reading::PerRmsAmpere),
            ];
            let references = fields::field("torque_constant").references().iter();
            let forms: Vec<(String, String)> = references
                .zip(readings)
                .map(|((_, meaning), (_, reading))| {
                    let meaning = shape.map_or_else(
                        || (*meaning).to_owned(),
                        |shape| {
                            let peak = given.si / reading.factor(shape) * shape.line_to_line_peak();
                            let peak = engineering(peak, "V/(rad/s)");
                            format!("{meaning}: {peak} line to line, peak")
                        },
                    );
                    (with_words(&given, reading.words()), meaning)
                })
                .collect();
            let part = &given.part;
            errors.push(catalogue::missing_basis(
                &part.location,
                part.field,
                &part.given,
                &forms,
            ));
            return None;
        }
        [Basis::BlockMean] => Reading::BlockMean,
        [Basis::Peak | Basis::PerPeakAmpere] => Reading::PerPeakAmpere,
        [Basis::Rms | Basis::PerRmsAmpere] => Reading::PerRmsAmpere,
        [.., last] => {
            let remedy = "write `block_mean`, `per_peak_ampere` or `per_rms_ampere`";
            refuse(&given, *last, remedy, errors);
            return None;
        }
    };
    Some(Emf { given, reading })
}

/// The phase constant, if any motor may have it.
pub(super) fn check_plausible(stated: &Emf, constant: f64, errors: &mut Collector) -> Option<f64> {
    let [low, high] = PLAUSIBLE;
    if (low..=high).contains(&constant) {
        return Some(constant);
    }
    let part = &stated.given.part;
    errors.push(catalogue::implausible_emf(part, constant, low, high));
    None
}
