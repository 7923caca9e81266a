//! Options that all controllers share, and how they are read.

use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, at_most, engineering};
use crate::spec::check::reader::Reader;
use crate::spec::schema::{self, Rule};
use crate::spec::units::Dimension as D;

/// Where the EMF comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmfSource {
    /// From the last period's voltage and currents.
    Estimated,
    /// From the motor's EMF shape at the Hall angle and speed.
    Model,
    /// That of the last period, taken as that of the target: no more than the past samples and commands folded.
    Held,
}

/// What the currents shall follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// The sector's corner.
    QuasiSquare,
    /// Parallel to the EMF: constant torque at least copper loss.
    Proportional,
}

/// How the plant is discretised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Discretisation {
    /// a = exp(-R Ts/L), b = (1 - a)/R.
    Exact,
    /// The paper's (7): a = 1 - R Ts/L, b = Ts/L.
    Euler,
}

/// What gives way where the voltage is beyond the hexagon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitRule {
    /// Scale to the edge.
    KeepAngle,
    /// Nearest point of the hexagon.
    Nearest,
    /// Keep the component along the EMF.
    TorquePriority,
}

/// A speed loop around the current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLoop {
    /// Bandwidth, hertz.
    pub bandwidth: f64,
    /// Inertia of rotor and load, kg m2.
    pub inertia: f64,
}

/// Options that all controllers share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopOptions {
    /// EMF source.
    pub emf: EmfSource,
    /// Share that the EMF estimate takes over of what is seen in a period, above 0 to 1 (1: all, no filter).
    pub emf_filter: f64,
    /// Current reference.
    pub reference: Reference,
    /// Phase advance, periods of electrical angle, 0 to 2.
    pub advance: f64,
    /// Periods between sampling and the command's effect: 0 or 1.
    pub delay: u32,
    /// Discretisation of the plant.
    pub discretisation: Discretisation,
    /// Word length of the control arithmetic, 16 or 32 bits.
    pub word: u32,
    /// Whether words of 16 bits are the target's choice, in place of which 32 bits stand where 16 do not suffice.
    pub word_by_target: bool,
    /// Outgoing current below which a commutation ends, ampere.
    pub commutation_threshold: f64,
    /// Periods after which a commutation is taken as ended, 1 to 255.
    pub commutation_timeout: u32,
    /// Whether a regulator of the speed asks for the current.
    pub speed: Option<SpeedLoop>,
}

/// All fields of controllers; [`super::KINDS`] says which kind takes which.
pub(crate) const OPTIONS: &[Rule] = &[
    schema::word("kind", "pdcc"),
    schema::word("emf", "estimated"),
    schema::plain("emf_filter", 1e-3, 1.0, "0.5"),
    schema::word("reference", "quasi_square"),
    schema::plain("advance", 0.0, 2.0, "1.5"),
    schema::integer("delay", 0, 1, "1"),
    schema::word("discretisation", "exact"),
    schema::integer("word", 1, 64, "32"),
    schema::word("target", "cortex_m0"),
    schema::quantity("commutation_threshold", &[D::Current], 1e-4, 1e3, "0.5 A"),
    schema::quantity(
        "commutation_timeout",
        &[D::Periods, D::Time],
        1.0,
        255.0,
        "8 periods",
    ),
    schema::word("speed_loop", "on"),
    schema::quantity("speed_bandwidth", &[D::Frequency], 0.01, 1e4, "2 Hz"),
    schema::word("hall_capture", "sampled"),
    schema::word("modulation", "three_phase"),
    schema::word("saturation", "torque_priority"),
    schema::word("candidates", "table2"),
    schema::word("off_leg", "physical"),
    schema::word("modulated", "off"),
    schema::integer("horizon", 1, 2, "2"),
    schema::quantity("switching_weight", &[D::Current], 1e-4, 1e4, "0.5 A"),
    schema::plain("torque_weight", 1e-3, 100.0, "2"),
    schema::word("table", "derived"),
    schema::quantity("band", &[D::Current], 1e-4, 1e4, "0.5 A"),
    schema::quantity("bandwidth", &[D::Frequency], 1.0, 1e5, "1 kHz"),
    schema::quantity("integral_time", &[D::Time], 1e-6, 10.0, "1.6 ms"),
    schema::word("feed_forward", "on"),
    schema::word("integral", "on"),
    schema::word("dead_time_compensation", "on"),
    schema::word("six_step", "off"),
];

/// What the defaults and limits of the options need to know of the drive; none where it is itself
/// in error.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surroundings {
    /// Control period, second.
    pub t_s: Option<f64>,
    /// Nominal bus voltage, volt.
    pub v_bus: Option<f64>,
    /// Phase resistance, ohm.
    pub resistance: Option<f64>,
    /// Phase inductance, henry.
    pub inductance: Option<f64>,
    /// Rated current, ampere, and how it was written.
    pub rated_current: Option<(f64, Part)>,
    /// Ampere per ADC count.
    pub adc_gain: Option<f64>,
    /// Dead time, second; 0 where none is stated.
    pub dead_time: f64,
    /// Inertia, kg m2.
    pub inertia: Option<f64>,
    /// Electrical frequency at rated speed, hertz.
    pub rated_frequency: Option<f64>,
}

/// Share that the EMF estimate takes over in a period where none is stated: stable from 60 % of the stated
/// inductance up, and quick enough for what the motor's shape does not foresee.
const EMF_FILTER: f64 = 0.25;

/// The default threshold where the motor is not too small for it, ampere.
const COMMUTATION_THRESHOLD: f64 = 0.5;

/// Refuses the option `name`, if it is stated, beside another setting.
pub(crate) fn refuse(
    reader: &Reader,
    name: &str,
    [other, value]: [&str; 2],
    why: &str,
    errors: &mut Collector,
) {
    if let Some(field) = reader.field(name) {
        errors.push(catalogue::option_without_effect(
            &field.location,
            name,
            &field.value.to_string(),
            reader
                .field(other)
                .map_or(reader.location(), |field| &field.location),
            &format!("{other}: {value}"),
            why,
        ));
    }
}

/// Refuses `emf: held` where a law uses more of the EMF than its sum over the delay.
pub(crate) fn refuse_held(reader: &Reader, common: &LoopOptions, errors: &mut Collector) {
    if common.emf == EmfSource::Held
        && let Some(field) = reader.field("emf")
    {
        errors.push(catalogue::option_unavailable(
            &field.location,
            "emf",
            "held",
            &["estimated", "model"],
        ));
    }
}

/// Reads and checks the shared options; `advance_idle` says that an advance has no effect under
/// `reference: proportional`. None only together with an error.
pub(crate) fn read_common(
    reader: &Reader,
    surroundings: &Surroundings,
    advance_idle: bool,
    errors: &mut Collector,
) -> Option<LoopOptions> {
    let emf = reader.word(
        errors,
        "emf",
        &[
            ("estimated", EmfSource::Estimated),
            ("model", EmfSource::Model),
            ("held", EmfSource::Held),
        ],
    );
    let emf_filter = reader.plain(errors, "emf_filter");
    let reference = reader.word(
        errors,
        "reference",
        &[
            ("quasi_square", Reference::QuasiSquare),
            ("proportional", Reference::Proportional),
        ],
    );
    let advance = reader.plain(errors, "advance");
    let delay = reader.integer(errors, "delay");
    let discretisation = reader.word(
        errors,
        "discretisation",
        &[
            ("exact", Discretisation::Exact),
            ("euler", Discretisation::Euler),
        ],
    );
    let (word, word_by_target) = read_word_length(reader, errors);
    let commutation_threshold = read_threshold(reader, surroundings, errors);
    let commutation_timeout = read_timeout(reader, surroundings, errors);
    let speed = read_speed_loop(reader, surroundings, errors);

    let unfiltered = match emf {
        Some(EmfSource::Model) => Some((
            "emf: model",
            "it smooths the estimate, and the model needs none",
        )),
        Some(EmfSource::Held) => Some((
            "emf: held",
            "it smooths the estimate, and what the last period showed is held as it is",
        )),
        _ => None,
    };
    if let (Some(filter), Some((other, reason))) = (&emf_filter, unfiltered) {
        errors.push(catalogue::option_without_effect(
            &filter.part.location,
            "emf_filter",
            &filter.part.given,
            reader
                .field("emf")
                .map_or(reader.location(), |field| &field.location),
            other,
            reason,
        ));
    }
    if let Some(advance) = &advance
        && advance.si > 0.0
        && reference == Some(Reference::Proportional)
        && advance_idle
    {
        errors.push(catalogue::option_without_effect(
            &advance.part.location,
            "advance",
            &advance.part.given,
            reader.field("reference").map_or(reader.location(), |field| &field.location),
            "reference: proportional",
            "advance moves sectors and commutations, and where no leg is turned off this reference has neither",
        ));
    }
    Some(LoopOptions {
        emf: emf.unwrap_or(EmfSource::Estimated),
        emf_filter: match (emf_filter, emf) {
            (Some(given), _) => given.si,
            (None, Some(EmfSource::Model | EmfSource::Held)) => 1.0,
            (None, _) => EMF_FILTER,
        },
        reference: reference.unwrap_or(Reference::QuasiSquare),
        advance: advance.map_or(0.0, |given| given.si),
        delay: delay.unwrap_or(1),
        discretisation: discretisation.unwrap_or(Discretisation::Exact),
        word,
        word_by_target,
        commutation_threshold: commutation_threshold?,
        commutation_timeout: commutation_timeout?,
        speed,
    })
}

/// The speed is a mean over an electrical turn: by default a loop of a fiftieth of the turns per second at
/// rated speed, at most of an eighth.
fn read_speed_loop(
    reader: &Reader,
    drive: &Surroundings,
    errors: &mut Collector,
) -> Option<SpeedLoop> {
    let is_on = reader.switch(errors, "speed_loop") == Some(true);
    let bandwidth = reader.plain_quantity(errors, "speed_bandwidth");
    if !is_on {
        if let Some(bandwidth) = bandwidth {
            let why = "there is no speed to regulate";
            errors.push(catalogue::option_without_effect(
                &bandwidth.part.location,
                "speed_bandwidth",
                &bandwidth.part.given,
                reader
                    .field("speed_loop")
                    .map_or(reader.location(), |field| &field.location),
                "speed_loop: off",
                why,
            ));
        }
        return None;
    }
    let frequency = drive.rated_frequency?;
    if let Some(bandwidth) = &bandwidth
        && bandwidth.si > frequency / 8.0
    {
        errors.push(catalogue::out_of_limits(
            &bandwidth.part.location,
            "speed_bandwidth",
            &bandwidth.part.given,
            "10 mHz",
            &format!(
                "{}, an eighth of the electrical turns per second at rated speed",
                engineering(at_most(frequency / 8.0), "Hz")
            ),
        ));
    }
    let Some(inertia) = drive.inertia else {
        let at = reader
            .field("speed_loop")
            .map_or(reader.location(), |field| &field.location);
        errors.push(catalogue::needed_field(
            at,
            "speed_loop: on",
            "inertia",
            "24 g cm2",
        ));
        return None;
    };
    Some(SpeedLoop {
        bandwidth: bandwidth.map_or(frequency / 50.0, |given| given.si),
        inertia,
    })
}

/// Refuses the options of commutations where the controller does not know of any; `other` is the setting that
/// it follows from.
pub(crate) fn refuse_commutation(reader: &Reader, setting: [&str; 2], errors: &mut Collector) {
    let why = "where no leg is turned off, no commutation has to end";
    for name in ["commutation_threshold", "commutation_timeout"] {
        refuse(reader, name, setting, why, errors);
    }
}

/// The word length as it is given, else as the target prefers it; whether it is the target's choice. A core without long
/// products takes words of 16 bits.
fn read_word_length(reader: &Reader, errors: &mut Collector) -> (u32, bool) {
    let targets = [
        ("portable", None),
        ("cortex_m4", None),
        ("cortex_m0", Some(16)),
    ];
    let preferred = reader.word(errors, "target", &targets).flatten();
    if reader.field("word").is_none() {
        return (preferred.unwrap_or(32), preferred.is_some());
    }
    let word = reader.integer(errors, "word").unwrap_or(32);
    if word != 16 && word != 32 {
        let part = reader.part("word", String::new);
        errors.push(catalogue::not_one_of(
            &part.location,
            "word",
            &part.given,
            &["16", "32"],
        ));
    }
    (word, false)
}

/// 0.5 A by default; a quarter of the rated current where that is less.
fn read_threshold(reader: &Reader, drive: &Surroundings, errors: &mut Collector) -> Option<f64> {
    let given = reader.plain_quantity(errors, "commutation_threshold");
    if reader.field("commutation_threshold").is_some() && given.is_none() {
        return None;
    }
    let (rated, rated_part) = drive.rated_current.as_ref()?;
    let threshold = given.map_or(COMMUTATION_THRESHOLD.min(rated / 4.0), |given| given.si);
    let part = reader.part("commutation_threshold", || engineering(threshold, "A"));
    if threshold >= *rated {
        errors.push(catalogue::threshold_above_rated(&part, rated_part));
    } else if let Some(count) = drive.adc_gain
        && threshold < count
    {
        errors.push(catalogue::threshold_below_count(&part, count));
    }
    Some(threshold)
}

/// By default twice the time in which the bus drives the rated current out of a winding pair,
/// 4 L I/(v_bus Ts), within 4 to 255 periods.
fn read_timeout(reader: &Reader, drive: &Surroundings, errors: &mut Collector) -> Option<u32> {
    if reader.field("commutation_timeout").is_none() {
        let (rated, _) = drive.rated_current.as_ref()?;
        let periods = (4.0 * drive.inductance? * rated / (drive.v_bus? * drive.t_s?)).ceil();
        return Some(periods.clamp(4.0, 255.0) as u32);
    }
    let given = reader.timespan(errors, "commutation_timeout")?;
    let periods = match given.dimension {
        Some(D::Time) => given.si / drive.t_s?,
        _ => given.si,
    };
    // A time that is a whole number of periods but for its rounding is that number.
    let whole = (periods - 1e-6).ceil();
    if !(1.0..=255.0).contains(&whole) {
        errors.push(catalogue::out_of_limits(
            &given.part.location,
            "commutation_timeout",
            &given.part.given,
            "1 period",
            "255 periods",
        ));
        return None;
    }
    Some(whole as u32)
}

/// Whether compare values are shifted against the dead time, which must be stated for it.
pub(crate) fn read_dead_time_compensation(
    reader: &Reader,
    drive: &Surroundings,
    errors: &mut Collector,
) -> bool {
    const OPTION: &str = "dead_time_compensation";
    let is_on = reader.switch(errors, OPTION) == Some(true);
    if is_on
        && drive.dead_time <= 0.0
        && let Some(field) = reader.field(OPTION)
    {
        let setting = format!("{OPTION}: on");
        errors.push(catalogue::needed_field(
            &field.location,
            &setting,
            "dead_time",
            "500 ns",
        ));
    }
    is_on
}

/// Which rule limits the voltage, where the controller has one.
pub(crate) fn read_saturation(reader: &Reader, errors: &mut Collector) -> Option<LimitRule> {
    reader.word(
        errors,
        "saturation",
        &[
            ("keep_angle", LimitRule::KeepAngle),
            ("nearest", LimitRule::Nearest),
            ("torque_priority", LimitRule::TorquePriority),
        ],
    )
}
