//! The motor's data: basis, winding and shape resolved to phase values of the equivalent star.

use super::reader::{Given, Reader};
use crate::diagnostics::{Collector, catalogue, list};
use crate::spec::ast::Basis;
use crate::spec::schema;
use crate::spec::units::Dimension;
use crate::spec::{EmfShape, MotorSpec};

/// How the phases are connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Winding {
    Star,
    Delta,
}

/// The motor data that could be read.
pub(super) struct Motor<'a> {
    pub description: String,
    pub pole_pairs: Option<u32>,
    pub resistance: Option<f64>,
    pub inductance: Option<f64>,
    pub winding: Option<Winding>,
    pub back_emf: Option<Given<'a>>,
    pub emf_constant: Option<f64>,
    pub emf_shape: Option<EmfShape>,
    pub rated_current: Option<Given<'a>>,
    pub rated_torque: Option<Given<'a>>,
    pub torque_constant: Option<Given<'a>>,
    pub rated_speed: Option<Given<'a>>,
    pub inertia: Option<f64>,
    pub inductance_tolerance: f64,
    pub resistance_tolerance: f64,
    pub hall_codes: [u8; 6],
}

/// Plausible peak phase EMF constants, V s/rad.
const EMF_CONSTANT: [f64; 2] = [1e-5, 100.0];

pub(super) fn read<'a>(reader: &Reader<'a>, errors: &mut Collector) -> Motor<'a> {
    reader.require(
        errors,
        &[
            "pole_pairs",
            "resistance",
            "inductance",
            "winding",
            "back_emf",
            "emf_shape",
            "rated_current",
            "rated_speed",
        ],
    );
    let pole_pairs = reader.integer(errors, "pole_pairs");
    let winding = reader.word(
        errors,
        "winding",
        &[("star", Winding::Star), ("delta", Winding::Delta)],
    );
    let resistance = read_winding_value(reader, errors, "resistance", winding);
    let inductance = read_winding_value(reader, errors, "inductance", winding);
    let emf_shape = read_shape(reader, errors);
    let back_emf = read_back_emf(reader, winding, errors);
    let emf_constant = match (&back_emf, winding, emf_shape, pole_pairs) {
        (Some(given), Some(winding), Some(shape), Some(pole_pairs)) => {
            let line_to_line = is_line_to_line(given, winding);
            let constant = phase_constant(given, line_to_line, shape, pole_pairs);
            check_emf_constant(given, constant, errors)
        }
        _ => None,
    };
    Motor {
        description: reader.text("description").unwrap_or_default().to_owned(),
        pole_pairs,
        resistance,
        inductance,
        winding,
        back_emf,
        emf_constant,
        emf_shape,
        rated_current: read_rated_current(reader, errors),
        rated_torque: reader.plain_quantity(errors, "rated_torque"),
        torque_constant: read_torque_constant(reader, errors),
        rated_speed: reader.plain_quantity(errors, "rated_speed"),
        inertia: reader
            .plain_quantity(errors, "inertia")
            .map(|given| given.si),
        inductance_tolerance: reader
            .plain_quantity(errors, "inductance_tolerance")
            .map_or(0.1, |given| given.si),
        resistance_tolerance: reader
            .plain_quantity(errors, "resistance_tolerance")
            .map_or(0.3, |given| given.si),
        hall_codes: read_hall_codes(reader, errors).unwrap_or([1, 5, 4, 6, 2, 3]),
    }
}

impl Motor<'_> {
    /// The checked motor. None if something is missing or in error.
    pub fn finish(&self) -> Option<MotorSpec> {
        Some(MotorSpec {
            description: self.description.clone(),
            pole_pairs: self.pole_pairs?,
            resistance: self.resistance?,
            inductance: self.inductance?,
            emf_constant: self.emf_constant?,
            emf_shape: self.emf_shape?,
            rated_current: self.rated_current.as_ref()?.si,
            rated_torque: self.rated_torque.as_ref().map(|given| given.si),
            rated_speed: self.rated_speed.as_ref()?.si,
            inertia: self.inertia,
            inductance_tolerance: self.inductance_tolerance,
            resistance_tolerance: self.resistance_tolerance,
            hall_codes: self.hall_codes,
        })
    }
}

/// Resistance or inductance of the equivalent star's phase: half of the line-to-line value, and a
/// third of a delta's phase value.
fn read_winding_value(
    reader: &Reader,
    errors: &mut Collector,
    name: &'static str,
    winding: Option<Winding>,
) -> Option<f64> {
    let given = reader.quantity(errors, name)?;
    let (at, text) = (&given.part.location, &given.part.given);
    match given.basis {
        [Basis::LineToLine] => Some(given.si / 2.0),
        [Basis::PerPhase] => match winding? {
            Winding::Star => Some(given.si),
            Winding::Delta => Some(given.si / 3.0),
        },
        [] => {
            let forms: Vec<(String, &str)> = schema::references(name)
                .iter()
                .map(|(basis, meaning)| (format!("{text} {}", basis.word()), *meaning))
                .collect();
            errors.push(catalogue::missing_basis(at, name, text, &forms));
            None
        }
        [.., last] => {
            let remedy = "write either `per_phase` or `line_to_line`";
            errors.push(catalogue::wrong_basis(at, name, text, last.word(), remedy));
            None
        }
    }
}

fn read_shape(reader: &Reader, errors: &mut Collector) -> Option<EmfShape> {
    let flat_top = reader.plain_quantity(errors, "flat_top");
    let trapezoidal = reader.word(
        errors,
        "emf_shape",
        &[("trapezoidal", true), ("sinusoidal", false)],
    )?;
    if trapezoidal {
        return Some(EmfShape::Trapezoidal {
            flat_top_deg: flat_top.map_or(120.0, |given| given.si),
        });
    }
    if let Some(given) = flat_top {
        errors.push(catalogue::needless_field(
            &given.part.location,
            "flat_top",
            &given.part.given,
            "emf_shape: trapezoidal",
        ));
    }
    Some(EmfShape::Sinusoidal)
}

/// Reads the EMF constant and checks that its basis is stated and possible.
fn read_back_emf<'a>(
    reader: &Reader<'a>,
    winding: Option<Winding>,
    errors: &mut Collector,
) -> Option<Given<'a>> {
    let given = reader.quantity(errors, "back_emf")?;
    let (at, text) = (&given.part.location, &given.part.given);
    let unit = given.number.unit?;
    let has = |basis: Basis| given.basis.contains(&basis);
    let line_stated = has(Basis::Phase) || has(Basis::LineToLine);
    let mut refuse = |basis: Basis, remedy: &str| {
        errors.push(catalogue::wrong_basis(
            at,
            "back_emf",
            text,
            basis.word(),
            remedy,
        ));
        None
    };
    if has(Basis::PerPhase) {
        return refuse(Basis::PerPhase, "write `phase` or `line_to_line`");
    }
    if has(Basis::Phase) && has(Basis::LineToLine) {
        return refuse(
            Basis::LineToLine,
            "it is given as `phase` already; keep one of the two",
        );
    }
    if has(Basis::Rms) {
        let peak = crate::diagnostics::significant(given.number.value * 2f64.sqrt());
        let forms: Vec<String> = [Basis::Phase, Basis::LineToLine]
            .into_iter()
            .filter(|&basis| has(basis) || !line_stated)
            .map(|basis| format!("{peak} {} {} peak", unit.symbol, basis.word()))
            .collect();
        return refuse(
            Basis::Rms,
            &format!(
                "give the peak; for a sinusoidal EMF it is sqrt(2) times as much, {}",
                list(&forms, "or")
            ),
        );
    }
    match unit.dimension {
        Dimension::SpeedConstant if has(Basis::Phase) => {
            return refuse(
                Basis::Phase,
                "a speed constant refers to the line-to-line peak; give V/krpm with `phase peak` instead",
            );
        }
        Dimension::FluxLinkage if has(Basis::LineToLine) => {
            return refuse(
                Basis::LineToLine,
                "a flux linkage refers to the phase peak; give V/krpm with `line_to_line peak` instead",
            );
        }
        Dimension::FluxLinkage if winding == Some(Winding::Delta) => {
            let remedy = "the flux linkage of a delta winding is ambiguous; give V/krpm with `line_to_line peak`";
            return refuse(Basis::Phase, remedy);
        }
        Dimension::SpeedConstant | Dimension::FluxLinkage => return Some(given),
        _ => {}
    }
    if line_stated && has(Basis::Peak) {
        return Some(given);
    }
    let forms: Vec<(String, &str)> = if line_stated {
        vec![(format!("{text} peak"), "the amplitude")]
    } else {
        let plain = format!("{} {}", given.number.digits, unit.symbol);
        schema::references("back_emf")
            .iter()
            .map(|(basis, meaning)| (format!("{plain} {} peak", basis.word()), *meaning))
            .collect()
    };
    errors.push(catalogue::missing_basis(at, "back_emf", text, &forms));
    None
}

/// Whether the constant is the line-to-line peak, as the phase value of a delta is.
pub(super) fn is_line_to_line(given: &Given, winding: Winding) -> bool {
    match given.dimension {
        Some(Dimension::SpeedConstant) => true,
        Some(Dimension::FluxLinkage) => false,
        _ => given.basis.contains(&Basis::LineToLine) || winding == Winding::Delta,
    }
}

/// Peak phase EMF of the equivalent star over mechanical speed, V s/rad.
pub(super) fn phase_constant(
    given: &Given,
    line_to_line: bool,
    shape: EmfShape,
    pole_pairs: u32,
) -> f64 {
    let mechanical = match given.dimension {
        Some(Dimension::SpeedConstant) => 1.0 / given.si,
        Some(Dimension::FluxLinkage) => given.si * f64::from(pole_pairs),
        _ => given.si,
    };
    if line_to_line {
        mechanical / shape.line_to_line_peak()
    } else {
        mechanical
    }
}

fn check_emf_constant(given: &Given, constant: f64, errors: &mut Collector) -> Option<f64> {
    let [low, high] = EMF_CONSTANT;
    if (low..=high).contains(&constant) {
        return Some(constant);
    }
    errors.push(catalogue::implausible_emf(
        &given.part.location,
        &given.part.given,
        constant,
        low,
        high,
    ));
    None
}

/// The rated current is the peak of the quasi-square wave.
fn read_rated_current<'a>(reader: &Reader<'a>, errors: &mut Collector) -> Option<Given<'a>> {
    let given = reader.quantity(errors, "rated_current")?;
    match given.basis {
        [] | [Basis::Peak] => Some(given),
        [.., last] => {
            let remedy = "give the peak of the phase current; for a sinusoidal current it is sqrt(2) times the rms value";
            let (at, text) = (&given.part.location, &given.part.given);
            errors.push(catalogue::wrong_basis(
                at,
                "rated_current",
                text,
                last.word(),
                remedy,
            ));
            None
        }
    }
}

/// Torque per peak ampere.
fn read_torque_constant<'a>(reader: &Reader<'a>, errors: &mut Collector) -> Option<Given<'a>> {
    let given = reader.quantity(errors, "torque_constant")?;
    match given.basis {
        [] | [Basis::Peak] => Some(given),
        [.., last] => {
            let remedy = "give the torque per peak ampere; a sinusoidal one per rms ampere is sqrt(2) times as large";
            let (at, text) = (&given.part.location, &given.part.given);
            errors.push(catalogue::wrong_basis(
                at,
                "torque_constant",
                text,
                last.word(),
                remedy,
            ));
            None
        }
    }
}

/// Each code from 1 to 6 once, neighbours one bit apart, last and first included.
fn read_hall_codes(reader: &Reader, errors: &mut Collector) -> Option<[u8; 6]> {
    let (list, part) = reader.integers(errors, "hall_codes")?;
    let codes: Vec<u8> = list
        .iter()
        .filter_map(|code| u8::try_from(*code).ok())
        .collect();
    let mut sorted = codes.clone();
    sorted.sort_unstable();
    let problem = if let Some(code) = list.iter().find(|code| !(1..=6).contains(*code)) {
        Some(format!("{code} lies outside 1 to 6"))
    } else if list.len() != 6 {
        Some(format!("{} codes instead of 6", list.len()))
    } else if sorted != [1, 2, 3, 4, 5, 6] {
        Some("not each of 1 to 6 once".to_owned())
    } else {
        let jump = (0..6).find(|&k| (codes[k] ^ codes[(k + 1) % 6]).count_ones() != 1);
        jump.map(|k| {
            format!(
                "{} and {} differ by more than one bit",
                codes[k],
                codes[(k + 1) % 6]
            )
        })
    };
    if let Some(problem) = problem {
        errors.push(catalogue::hall_codes(&part.location, &part.given, &problem));
        return None;
    }
    codes.try_into().ok()
}
