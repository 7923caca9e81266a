//! Options that all controllers share, and how they are read.

use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, at_most, engineering};
use crate::spec::check::reader::Reader;
use crate::spec::options::{Row, number, word};
use crate::spec::rule::{self, Rule};
use crate::spec::units::Dimension as D;
use crate::spec::words::words;

words! {
    /// Where the EMF comes from.
    pub enum EmfSource {
        "estimated" = Estimated: "from the last period's voltage and currents",
        "model" = Model: "from the motor's EMF shape at the Hall angle and speed",
        "held" = Held: "that of the last period, folded into what past samples and commands add to the voltage: least instructions, more ripple",
    }
}

words! {
    /// What the currents shall follow.
    pub enum Reference {
        "quasi_square" = QuasiSquare: "the sector's corner: two phases carry the current",
        "proportional" = Proportional: "parallel to the EMF, in three phases: constant torque at least copper loss",
    }
}

words! {
    /// How the plant is discretised.
    pub enum Discretisation {
        "exact" = Exact: "a = exp(-R Ts/L), b = (1 - a)/R",
        "euler" = Euler: "the paper's (7): a = 1 - R Ts/L, b = Ts/L",
    }
}

words! {
    /// What gives way where the voltage is beyond the hexagon.
    pub enum LimitRule {
        "keep_angle" = KeepAngle: "the voltage is scaled: shortest code; past the speed limit 10 to 30 % less torque of a quasi-square reference than with the others",
        "nearest" = Nearest: "nearest point of the hexagon",
        "torque_priority" = TorquePriority: "what makes torque is kept: highest limit",
    }
}

words! {
    /// How Hall edges are timed.
    pub(crate) enum HallEdges {
        "sampled" = Sampled: "by the samples, in whole periods",
        "timer" = Timer: "by a capture timer; needs `hall_timer_clock`",
    }
}

words! {
    /// The core for which the word length is chosen.
    pub enum Target {
        "portable" = Portable: "any",
        "cortex_m4" = CortexM4: "the upper half of a product of two 32-bit words is one instruction, as on RV32IM",
        "cortex_m0" = CortexM0: "such a product is a call: words of 16 bits where they suffice; the type's documentation says what that costs in accuracy",
    }
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

/// The choice of controller.
pub(crate) const KIND: Rule = rule::word("kind", "pdcc");

/// Options that all controllers take.
pub(crate) const LOOP: &[Row<LoopOptions>] = &[
    Row::of(
        rule::choice::<EmfSource>("emf", "estimated")
            .preset("estimated")
            .about("Where the EMF comes from; `held` with `modulation: three_phase` of `pdcc`, and of `fcs-mpc` and `phcc` where no off leg is `physical`"),
        |options| Some(word(options.emf)),
    ),
    Row::of(
        rule::plain("emf_filter", 1e-3, 1.0, "0.5")
            // Stable from 60 % of the stated inductance up, and quick enough for what the motor's shape does not foresee.
            .preset("0.25")
            .about("Share that the EMF estimate takes over of what one period shows (1: all, no filter); only with `emf: estimated`"),
        |options| Some(number(options.emf_filter)),
    ),
    Row::of(
        rule::choice::<Reference>("reference", "quasi_square")
            .preset("quasi_square")
            .about("What the currents follow; `proportional` not with `modulation: pair`"),
        |options| Some(word(options.reference)),
    ),
    Row::of(
        rule::choice::<bool>("speed_loop", "on")
            .preset("off")
            .about("Whether a PI regulator of the speed from Hall timing asks for the current: `set_speed` sets rpm, `set_current` and `set_torque` the greatest current that it asks for (`max_current` until then); needs `inertia` of rotor and load"),
        |_| None,
    ),
    Row::of(
        rule::quantity("speed_bandwidth", &[D::Frequency], 0.01, 1e4, "2 Hz")
            .by_default("a fiftieth of the electrical turns per second at rated speed")
            .about("Bandwidth of the speed loop, at most an eighth of the electrical turns per second at rated speed: the speed is a mean over a turn; only with `speed_loop: on`"),
        |options| Some(number(options.speed?.bandwidth)),
    ),
    Row::of(
        rule::plain("advance", 0.0, 2.0, "1.5")
            .preset("0")
            .about("Phase advance, control periods of electrical angle; not with `proportional` where no pair of phases is switched"),
        |options| Some(number(options.advance)),
    ),
    Row::of(
        rule::integer("delay", 0, 1, "1")
            .preset("1")
            .about("Periods between a sample and the effect of the command that answers it"),
        |options| Some(number(options.delay)),
    ),
    Row::of(
        rule::choice::<Discretisation>("discretisation", "exact")
            .preset("exact")
            .about("How the plant is discretised"),
        |options| Some(word(options.discretisation)),
    ),
    Row::of(
        rule::choice::<Target>("target", "cortex_m0")
            .preset("portable")
            .about("The core for which the word length is chosen"),
        |_| None,
    ),
    Row::of(
        rule::one_of("word", &[16, 32], "32")
            .by_default("32; 16 as `target` chooses")
            .about("Bits of the words of control arithmetic"),
        |options| Some(number(options.word)),
    ),
    Row::of(
        rule::choice::<HallEdges>("hall_capture", "sampled")
            .preset("sampled")
            .about("How Hall edges are timed"),
        |_| None,
    ),
];

/// Options of the controllers that may turn a leg off.
pub(crate) const COMMUTATION: &[Row<LoopOptions>] = &[
    Row::of(
        rule::quantity("commutation_threshold", &[D::Current], 1e-4, 1e3, "0.5 A")
            .by_default("0.5 A, at most a quarter of `rated_current`")
            .about("Outgoing current below which a commutation ends; above one ADC count, below the rated current; only where a leg is turned off"),
        |options| Some(number(options.commutation_threshold)),
    ),
    Row::of(
        rule::quantity("commutation_timeout", &[D::Periods, D::Time], 1.0, 255.0, "8 periods")
            .by_default("4 L I/(v_bus Ts), 4 to 255 periods")
            .about("Periods, or time, after which a commutation is taken as ended; only where a leg is turned off"),
        |options| Some(number(options.commutation_timeout)),
    ),
];

/// The rule of the saturation, by default `preset`.
pub(crate) const fn saturation(preset: &'static str) -> Rule {
    rule::choice::<LimitRule>("saturation", "torque_priority")
        .preset(preset)
        .about("What gives way where the voltage is beyond the hexagon")
}

/// The rule of the compensation of the dead time.
pub(crate) const DEAD_TIME_COMPENSATION: Rule = rule::choice::<bool>("dead_time_compensation", "on")
    .preset("off")
    .about("Whether compare values are shifted by what `dead_time` costs, by the sign of the current; needs `dead_time`");

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
    let emf = reader.choice_or_preset(errors, "emf", &[]);
    let emf_filter = read_filter(reader, emf, errors);
    let reference = reader.choice_or_preset(errors, "reference", &[]);
    let advance = reader.plain(errors, "advance");
    let delay = reader.integer_or_preset(errors, "delay");
    let discretisation = reader.choice_or_preset(errors, "discretisation", &[]);
    let (word, word_by_target) = read_word_length(reader, errors);
    let commutation_threshold = read_threshold(reader, surroundings, errors);
    let commutation_timeout = read_timeout(reader, surroundings, errors);
    let speed = read_speed_loop(reader, surroundings, errors);

    if let Some(advance) = &advance
        && advance.si > 0.0
        && reference == Reference::Proportional
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
        emf,
        emf_filter,
        reference,
        advance: advance.map_or_else(|| reader.preset_number("advance"), |given| given.si),
        delay,
        discretisation,
        word,
        word_by_target,
        commutation_threshold: commutation_threshold?,
        commutation_timeout: commutation_timeout?,
        speed,
    })
}

/// The share of an estimate; 1 where none is made, and the option has no effect.
fn read_filter(reader: &Reader, emf: EmfSource, errors: &mut Collector) -> f64 {
    let filter = reader.plain(errors, "emf_filter");
    let (other, reason) = match emf {
        EmfSource::Estimated => {
            return filter.map_or_else(|| reader.preset_number("emf_filter"), |given| given.si);
        }
        EmfSource::Model => (
            "emf: model",
            "it smooths the estimate, and the model needs none",
        ),
        EmfSource::Held => (
            "emf: held",
            "it smooths the estimate, and what the last period showed is held as it is",
        ),
    };
    if let Some(filter) = &filter {
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
    1.0
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
    let target: Target = reader.choice_or_preset(errors, "target", &[]);
    let preferred = (target == Target::CortexM0).then_some(16);
    if reader.field("word").is_none() {
        return (preferred.unwrap_or(32), preferred.is_some());
    }
    (reader.integer(errors, "word").unwrap_or(32), false)
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
