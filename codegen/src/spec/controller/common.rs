//! Options that all controllers share, and how they are read.

use super::core::{Core, Target};
use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, at_least, at_most, engineering, significant};
use crate::spec::option_row::{Row, if_on, number, word};
use crate::spec::reader::Reader;
use crate::spec::rule::{self, Rule};
use crate::spec::units::Dimension as D;
use crate::spec::words::{Words as _, words};
use std::f64::consts::{PI, TAU};

words! {
    /// Source of the EMF.
    pub enum EmfSource {
        "estimated" = Estimated: "from the voltage and currents of the last period",
        "model" = Model: "from the motor's EMF shape at the Hall angle and speed",
        "observer" = Observer: "the modelled one plus its error, observed in the rotor frame: compensates deviations of `k_b`, R, L, bus and angle",
        "held" = Held: "taken as unchanged since the last period: fewest instructions, more ripple",
    }
}

impl EmfSource {
    /// Whether the motor's shape at the rotor's angle and speed says what EMF to expect.
    pub fn is_modelled(self) -> bool {
        matches!(self, Self::Model | Self::Observer)
    }
}

words! {
    /// Current reference.
    pub enum Reference {
        "quasi_square" = QuasiSquare: "two phases carry the current",
        "proportional" = Proportional: "in three phases, proportional to their EMFs: constant torque at minimum copper loss",
    }
}

words! {
    /// Discretisation of the plant.
    pub enum Discretisation {
        "exact" = Exact: "a = exp(-R Ts/L), b = (1 - a)/R",
        "euler" = Euler: "the paper's (7): a = 1 - R Ts/L, b = Ts/L",
    }
}

words! {
    /// Limiting of voltages outside the hexagon.
    pub enum LimitRule {
        "keep_angle" = KeepAngle: "the voltage is scaled: shortest code; above the speed limit 10 to 30 % less torque with a quasi-square reference than with the others",
        "nearest" = Nearest: "nearest point of the hexagon: with a proportional reference as fast as the others, and with less ripple where the bus ends the torque",
        "torque_priority" = TorquePriority: "the torque-producing component is kept: highest speed limit with a quasi-square reference",
    }
}

words! {
    /// The mean of three pulsed legs, which is free within the period.
    pub enum CommonMode {
        "centred" = Centred: "the legs' extremes lie as far from the ends of the period: least ripple",
        "readable" = Readable: "centred, but lowered where the highest leg would be low for less time than reading the sensors or `minimum_low_time` takes; of three sensors two are read at the end of the period",
        "clamped_low" = ClampedLow: "the lowest leg stays low: a third less switching",
    }
}

words! {
    /// Timing of Hall edges.
    pub(crate) enum HallEdges {
        "sampled" = Sampled: "at the sampling instants",
        "timer" = Timer: "by a capture timer; needs `hall_timer_clock`",
    }
}

/// A speed loop around the current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLoop {
    /// Bandwidth, hertz.
    pub bandwidth: f64,
    /// Inertia of rotor and load, kg m2.
    pub inertia: f64,
    /// Greatest rate of the speed set-point in force, mechanical rad/s2; none: it is the set-point.
    pub acceleration_limit: Option<f64>,
}

/// Electrical turns in the time 1/f of a speed loop's bandwidth f below which the delay of a speed that is the mean of the
/// last one makes it oscillate.
const TURNS_IN_CONTROL: f64 = 4.0;

impl SpeedLoop {
    /// Least speed that the loop holds where Hall edges tell the speed, as the mean of the last electrical turn, rad/s.
    pub fn least_speed(&self, pole_pairs: u32) -> f64 {
        TAU * TURNS_IN_CONTROL * self.bandwidth / f64::from(pole_pairs)
    }

    /// Greatest bandwidth with which such a loop holds a speed in rad/s, hertz.
    pub fn bandwidth_for(speed: f64, pole_pairs: u32) -> f64 {
        speed.abs() * f64::from(pole_pairs) / (TAU * TURNS_IN_CONTROL)
    }
}

/// Options that all controllers share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopOptions {
    /// EMF source.
    pub emf: EmfSource,
    /// Filter coefficient of the EMF estimate, above 0 to 1 (1: no filter).
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
    /// The core that runs it.
    pub core: Core,
    /// Whether the target chose words of 16 bits; 32 bits replace them where they do not suffice.
    pub word_by_target: bool,
    /// Outgoing current below which a commutation ends, ampere.
    pub commutation_threshold: f64,
    /// Commutation time-out, 1 to 255 periods.
    pub commutation_timeout: u32,
    /// Speed loop, if any.
    pub speed: Option<SpeedLoop>,
    /// Greatest rate at which the current set-point takes effect, ampere per second; none: at once.
    pub slew_rate: Option<f64>,
    /// Time-out of the residual watch, control periods; none: the currents are not watched.
    pub residual_periods: Option<u32>,
    /// Whether the reference turns against the field where the voltage ends.
    pub field_weakening: bool,
    /// What is learnt by the observer.
    pub learning: Learning,
}

/// What a drive learns by its observer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Learning {
    /// The places of the Hall sensors.
    pub halls: bool,
    /// The torque constant.
    pub torque: bool,
}

/// Every group of options that several controllers take, and what it is for.
pub(crate) const SHARED: [(&str, &[Row<LoopOptions>]); 3] = [
    ("Options", LOOP),
    ("Options of voltage limits", LIMITED),
    ("Options of commutations", COMMUTATION),
];

/// The choice of controller.
pub(crate) const KIND: Rule = rule::word("kind", "pdcc");

/// Options that all controllers take.
pub(crate) const LOOP: &[Row<LoopOptions>] = &[
    Row::of(
        rule::choice::<EmfSource>("emf", "estimated")
            .by_default(
                "`observer` with pulse-width modulation and `reference: proportional`, unless an `emf_filter` is stated; else `estimated`",
                &[
                    ("observer", "in time where the EMF turns fast, and corrects wrong motor data"),
                    ("estimated", "from currents and voltages alone, without an angle between Hall edges"),
                ],
            )
            .about("Source of the EMF; `held` with `pdcc` unless `modulation: pair`, and with `fcs-mpc` and `phcc` unless `off_leg: physical` applies"),
        |options| Some(word(options.emf)),
    ),
    Row::of(
        rule::plain("emf_filter", 1e-3, 1.0, "0.5")
            // Stable from 60 % of the stated inductance up, and fast enough for real EMF shapes.
            .preset("0.25")
            .about("Filter coefficient of the EMF estimate (1: no filter); only with `emf: estimated`"),
        |options| Some(number(options.emf_filter)),
    ),
    Row::of(
        rule::choice::<Reference>("reference", "quasi_square")
            .by_default(
                "`proportional` where pulse-width modulation drives all three legs in every period, without `advance`; else `quasi_square`",
                &[
                    ("proportional", "constant torque for every shape of the EMF, at least copper loss"),
                    ("quasi_square", "two legs carry it, or `advance` moves its sectors"),
                ],
            )
            .about("Current reference; `proportional` not with `modulation: pair`"),
        |options| Some(word(options.reference)),
    ),
    Row::of(
        rule::choice::<bool>("speed_loop", "on")
            .preset("off")
            .about("PI speed controller on the speed from Hall edges or angle sensor: `set_speed` sets rpm, `set_current` and `set_torque` limit its current (`max_current` by default); needs `inertia` of rotor and load"),
        |_| None,
    ),
    Row::of(
        rule::quantity("speed_bandwidth", &[D::Frequency], 0.01, 1e4, "2 Hz")
            .by_default(
                "1/50 of the electrical frequency at rated speed",
                &[("", "slow beside the speed's delay: a mean over an electrical turn of Hall edges, or a filter of angles")],
            )
            .about("Bandwidth of the speed loop, at most 1/8 of the electrical frequency at rated speed, with `rotor: angle` also 1/10 over the time constant of the speed's filter; only with `speed_loop: on`"),
        |options| Some(number(options.speed?.bandwidth)),
    ),
    Row::of(
        rule::quantity("acceleration_limit", &[D::SpeedRate], SLOWEST_RATE, 1e6 * SLOWEST_RATE, "5000 rpm/s")
            .off("a set-point takes effect at once")
            .about("Greatest rate at which the speed loop follows `set_speed`, rpm/s, krpm/s, rad/s2; only with `speed_loop: on`"),
        |options| Some(number(options.speed?.acceleration_limit?)),
    ),
    Row::of(
        rule::quantity("slew_rate", &[D::CurrentRate], 1e-4, 1e9, "200 A/s")
            .off("a set-point takes effect at once")
            .about("Greatest rate at which the current follows `set_current` and `set_torque`, A/s, A/ms, mA/s; at least `rated_current` in a minute; not with `speed_loop: on`"),
        |options| Some(number(options.slew_rate?)),
    ),
    Row::of(
        rule::quantity("residual_timeout", &[D::Time], 1e-5, LONGEST_RESIDUAL, "5 ms")
            .off("the currents are not compared with the voltages")
            .about("Time, net of periods in which they do, after which currents that do not follow the voltages as the motor's data say trip the drive: a dead current sensor, an open or exchanged phase, wrong motor data; 50 control periods to 65,535; only with `emf: observer`"),
        |options| Some(number(options.residual_periods?)),
    ),
    Row::of(
        rule::plain("advance", 0.0, 2.0, "1.5")
            .preset("0")
            .about("Phase advance, control periods; not with `reference: proportional` where no leg is turned off"),
        |options| Some(number(options.advance)),
    ),
    Row::of(
        rule::integer("delay", 0, 1, "1")
            .preset("1")
            .about("Periods between a sample and the effect of its command"),
        |options| Some(number(options.delay)),
    ),
    Row::of(
        rule::choice::<Discretisation>("discretisation", "exact")
            .preset("exact")
            .about("Discretisation of the plant"),
        |options| Some(word(options.discretisation)),
    ),
    Row::of(
        rule::choice::<Target>("target", "cortex_m0")
            .preset("portable")
            .about("Core for which the word length is chosen and the time of a step is told"),
        |_| None,
    ),
    Row::of(
        rule::quantity("core_clock", &[D::Frequency], 1e6, 1e9, "72 MHz")
            .off("the chip's greatest is taken: 170 MHz for `cortex_m4`, 48 MHz for `cortex_m0`, 150 MHz for `riscv32`")
            .about("Clock of the core, for the share of the control period that a step takes; only with a `target`"),
        |_| None,
    ),
    Row::of(
        rule::one_of("word", &[16, 32], "32")
            .by_default(
                "32; with `target: cortex_m0` 16 where they suffice",
                &[
                    ("32", "enough for every drive; shorter words save time on a Cortex-M0 only"),
                    ("16", "they suffice, and a Cortex-M0 multiplies them in one instruction"),
                ],
            )
            .about("Word length of the control arithmetic, bits"),
        |options| Some(number(options.word)),
    ),
    Row::of(
        rule::choice::<HallEdges>("hall_capture", "sampled")
            .by_default(
                "`timer` with a `hall_timer_clock`, else `sampled`",
                &[
                    ("timer", "the angle is exact between samples"),
                    ("sampled", "no clock of a timer is stated"),
                ],
            )
            .about("Timing of Hall edges"),
        |_| None,
    ),
    Row::of(
        rule::choice::<bool>(HALL_LEARNING, "on")
            .preset("off")
            .about("Places of the Hall sensors, learnt while the rotor turns steadily: how the three stand against each other, and at up to a tenth of `max_current` how all stand against the EMF, up to 15 electrical degrees, until `reset()`; only with `emf: observer` and `hall_capture: timer`"),
        |options| if_on(options.learning.halls),
    ),
];

/// Option of [`LOOP`].
pub(crate) const HALL_LEARNING: &str = "hall_learning";

/// Options of the controllers that limit a voltage. With whole vectors the current ripples even at a set-point of 0,
/// which looks like another torque constant.
pub(crate) const LIMITED: &[Row<LoopOptions>] = &[
    Row::of(
        rule::choice::<bool>(TORQUE_LEARNING, "on")
            .preset("off")
            .about("Torque constant, learnt while the rotor turns and hardly any current flows, from two thirds to 1.5 times the stated one, until `reset()`; `set_torque` uses it. Only with `emf: observer`, a measured bus, and `hall_capture: timer` or `rotor: angle`"),
        |options| if_on(options.learning.torque),
    ),
    Row::of(
        rule::choice::<bool>(FIELD_WEAKENING, "on")
            .preset("off")
            .about("Torque above the speed at which the bus voltage ends: the current turns against the field, with up to `max_current` whatever the set-point; only with `reference: proportional`. Needs a `maximum_speed` whose EMF does not exceed the bus, or a `bus_clamp`"),
        |options| if_on(options.field_weakening),
    ),
];

/// Option of [`LIMITED`].
pub(crate) const TORQUE_LEARNING: &str = "torque_learning";

/// Option of [`LIMITED`].
pub(crate) const FIELD_WEAKENING: &str = "field_weakening";

/// Options of the controllers that may turn a leg off.
pub(crate) const COMMUTATION: &[Row<LoopOptions>] = &[
    Row::of(COMMUTATION_ENDS, |options| {
        Some(number(options.commutation_threshold))
    }),
    Row::of(COMMUTATION_TIMEOUT, |options| {
        Some(number(options.commutation_timeout))
    }),
];

/// The rule of the current at which a commutation ends.
pub(crate) const COMMUTATION_ENDS: Rule =
    rule::quantity("commutation_threshold", &[D::Current], 1e-4, 1e3, "0.5 A")
        .by_default(
            "0.5 A, at most a quarter of `rated_current`, at least one ADC count",
            &[("", "less is noise of the ADC, more ends a commutation early")],
        )
        .about("Outgoing phase current below which a commutation ends; above one ADC count, below the rated current; only where a leg is turned off");

/// The rule of a commutation's time-out.
pub(crate) const COMMUTATION_TIMEOUT: Rule = rule::quantity(
    "commutation_timeout",
    &[D::Periods, D::Time],
    1.0,
    255.0,
    "8 periods",
)
.by_default(
    "4 L I/(v_bus Ts), 4 to 255 periods",
    &[(
        "",
        "four times as long as the bus takes to end the rated current of a phase",
    )],
)
.about("Commutation time-out, periods or time; only where a leg is turned off");

/// The rule of the saturation, without a default.
pub(crate) const fn saturation() -> Rule {
    rule::choice::<LimitRule>("saturation", "torque_priority")
        .about("Limiting of voltages outside the hexagon")
}

/// The rule of the compensation of the dead time.
pub(crate) const DEAD_TIME_COMPENSATION: Rule = rule::choice::<bool>(
    "dead_time_compensation",
    "on",
)
.by_default(
    "`on` with a stated `dead_time` and three pulsed legs, but `off` with `reference: proportional` where the dead time moves the current by at most 2 % of `rated_current` in a control period (pwm_per_control v_bus dead_time/L), unless `emf: model`",
    &[("on", "the dead time would take torque, or make it ripple")],
)
.about(
    "Dead-time compensation of the compare values, by the sign of the current; needs `dead_time`",
);

/// The rule of the prediction of rounding.
pub(crate) const ROUNDING_PREDICTION: Rule = rule::choice::<bool>("rounding_prediction", "on")
    .by_default(
        "`on` with three pulsed legs and `delay: 1`, where the voltage of a count of the PWM timer moves the current by more than 0.5 % of `rated_current` in a control period (v_bus Ts/(timer_period L)), else `off`",
        &[("on", "the voltage of a timer count moves the current by more than 0.5 % of the rated one")],
    )
    .about("Whether the prediction knows the voltage of the compare values as written: the commanded one, rounded to whole counts of the timer");

/// Change of the current in a control period by the voltage of a count of the PWM timer, over the rated current. Above it
/// the rounding of compare values is predicted by default. Below it the torque ripples by about a percent without that.
const FELT_COUNT: f64 = 0.005;

/// Change of the current in a control period by the dead time, over the rated current. Above it the dead time is
/// compensated by default with a proportional reference too; below it, the torque ripples by about a percent.
pub(crate) const FELT_DEAD_TIME: f64 = 0.02;

/// The rule of the mean of three pulsed legs.
pub(crate) const COMMON_MODE: Rule = rule::choice::<CommonMode>("common_mode", "clamped_low")
    .by_default(
        "`readable` with `current_sensing: low_side` or a `minimum_low_time`, else `centred`",
        &[
            ("readable", "legs must be low for a while, for their sensors or by `minimum_low_time`"),
            ("centred", "least ripple of the three"),
        ],
    )
    .about("Where the pulses of three legs lie, which makes no difference to the motor's mean voltages");

/// Its value in the normalised specification: left out where the pulses are centred.
pub(crate) fn common_mode_line(mode: CommonMode) -> Option<String> {
    (mode != CommonMode::Centred).then(|| word(mode))
}

/// Reads the option `common_mode`. `only`: the setting, with its reason, beside which no three legs are pulsed throughout.
pub(crate) fn read_common_mode(
    reader: &Reader,
    drive: &Surroundings,
    only: Option<([&str; 2], &str)>,
    errors: &mut Collector,
) -> CommonMode {
    const OPTION: &str = "common_mode";
    if let Some((setting, why)) = only {
        refuse(reader, OPTION, setting, why, errors);
        return CommonMode::Centred;
    }
    let by_default = if drive.must_be_low {
        CommonMode::Readable
    } else {
        CommonMode::Centred
    };
    reader.choice(errors, OPTION, &[]).unwrap_or(by_default)
}

/// Values of the drive for defaults and limits of the options; none where they are in error.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surroundings {
    /// Control period, second.
    pub t_s: Option<f64>,
    /// Nominal bus voltage, volt.
    pub v_bus: Option<f64>,
    /// Compare value of 100 % duty.
    pub timer_period: Option<u32>,
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
    /// PWM periods in a control period.
    pub pwm_per_control: u32,
    /// Fields of motor and inverter that are stated but in error, which has been told.
    pub in_error: Vec<&'static str>,
    /// Whether legs must be low for a while in every period, for their sensors or their bootstrap.
    pub must_be_low: bool,
    /// Whether all currents are known while a leg is off.
    pub reads_off_legs: bool,
    /// Inertia, kg m2.
    pub inertia: Option<f64>,
    /// Rated torque over rated speed, Nm s/rad.
    pub torque_per_speed: Option<f64>,
    /// Electrical frequency at rated speed, hertz.
    pub rated_frequency: Option<f64>,
    /// Time constant of the filter of the speed, second; none with Hall sensors, or where it is not known.
    pub speed_filter: Option<f64>,
}

impl Surroundings {
    /// Whether so many volt seconds move the current by more than a share of the rated one, where both are known.
    fn moves_more(&self, volt_seconds: f64, share: f64) -> Option<bool> {
        let moved = volt_seconds / self.inductance?;
        Some(moved > share * self.rated_current.as_ref()?.0)
    }
}

/// Least `acceleration_limit`, 10 rpm/s: the change in a period is still some words.
const SLOWEST_RATE: f64 = PI / 3.0;

/// Least and greatest number of periods of `residual_timeout`.
const RESIDUAL_PERIODS: [u32; 2] = [50, 65_535];

/// Longest `residual_timeout`, second.
const LONGEST_RESIDUAL: f64 = 1.0;

/// Default commutation threshold, ampere; less for small motors.
const COMMUTATION_THRESHOLD: f64 = 0.5;

/// Refuses the option `name`, if it is stated, because of another setting.
pub(crate) fn refuse(
    reader: &Reader,
    name: &'static str,
    [other, value]: [&str; 2],
    why: &str,
    errors: &mut Collector,
) {
    if reader.field(name).is_some() {
        errors.push(catalogue::option_without_effect(
            &reader.part(name, String::new),
            [other, value],
            reader.field(other).map(|field| &field.location),
            why,
        ));
    }
}

/// Refuses `emf: held` where a law needs the EMF by itself.
pub(crate) fn refuse_held(reader: &Reader, common: &LoopOptions, errors: &mut Collector) {
    if common.emf == EmfSource::Held
        && let Some(field) = reader.field("emf")
    {
        errors.push(catalogue::option_unavailable(
            &field.location,
            "emf",
            "held",
            &["estimated", "model", "observer"],
        ));
    }
}

/// What the shared options depend on in a controller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Traits {
    /// Whether pulse-width modulation drives all three legs in every period.
    pub pulses_three_legs: bool,
    /// Whether no leg is turned off, so that an advance has no effect with a proportional reference.
    pub advance_idle: bool,
    /// Whether it uses the EMF.
    pub uses_emf: bool,
}

/// Reads and checks the shared options. None only together with an error.
pub(crate) fn read_common(
    reader: &Reader,
    surroundings: &Surroundings,
    traits: Traits,
    errors: &mut Collector,
) -> Option<LoopOptions> {
    let advance = reader.plain(errors, "advance");
    let advanced = advance.as_ref().filter(|given| given.si > 0.0);
    let reference = read_reference(reader, traits, advanced.is_some(), errors);
    let emf = read_emf(reader, traits, reference, errors);
    let emf_filter = read_filter(reader, emf, errors);
    let delay = reader.integer_or_preset(errors, "delay");
    let discretisation = reader.choice_or_preset(errors, "discretisation", &[]);
    let core = Core::read(reader, errors);
    let (word, word_by_target) = core.word_length(reader, errors);
    let commutation_threshold = read_threshold(reader, surroundings, errors);
    let commutation_timeout = read_timeout(reader, surroundings, errors);
    let speed = read_speed_loop(reader, surroundings, errors);
    let slew_rate = read_slew_rate(reader, surroundings, speed, errors);
    let emf_in_use = traits.uses_emf.then_some(emf);
    let residual_periods = read_residual_timeout(reader, surroundings, emf_in_use, errors);
    let halls = read_learning(
        reader,
        HALL_LEARNING,
        emf_in_use,
        "only `emf: observer` tells how all sensors stand against the EMF",
        errors,
    );
    let torque = read_learning(
        reader,
        TORQUE_LEARNING,
        emf_in_use,
        "only `emf: observer` tells how far the EMF is from the stated one",
        errors,
    );
    let learning = Learning { halls, torque };
    let field_weakening =
        traits.pulses_three_legs && read_field_weakening(reader, reference, errors);

    if advanced.is_some() && reference == Reference::Proportional && traits.advance_idle {
        let why = "advance shifts sectors and commutations, which this reference does not use unless a leg is turned off";
        let proportional = ["reference", "proportional"];
        refuse(reader, "advance", proportional, why, errors);
    }
    Some(LoopOptions {
        emf,
        emf_filter,
        reference,
        advance: advance.map_or_else(|| reader.preset_number("advance"), |given| given.si),
        delay,
        discretisation,
        word,
        core,
        word_by_target,
        commutation_threshold: commutation_threshold?,
        commutation_timeout: commutation_timeout?,
        speed,
        slew_rate,
        residual_periods,
        field_weakening,
        learning,
    })
}

/// A current that follows the EMF makes constant torque for every shape of it, where three legs can
/// drive one; an advance shifts the sectors of a quasi-square one.
fn read_reference(
    reader: &Reader,
    traits: Traits,
    is_advanced: bool,
    errors: &mut Collector,
) -> Reference {
    let by_default = if traits.pulses_three_legs && !is_advanced {
        Reference::Proportional
    } else {
        Reference::QuasiSquare
    };
    reader
        .choice(errors, "reference", &[])
        .unwrap_or(by_default)
}

/// Field weakening turns a reference that follows the rotor's angle, by what a limit of the voltage tells.
fn read_field_weakening(reader: &Reader, reference: Reference, errors: &mut Collector) -> bool {
    let is_on = reader.switch(errors, FIELD_WEAKENING) == Some(true);
    if is_on && reference == Reference::QuasiSquare {
        let quasi_square = ["reference", "quasi_square"];
        let why = "only a `proportional` reference can turn against the field";
        refuse(reader, FIELD_WEAKENING, quasi_square, why, errors);
    }
    is_on && reference == Reference::Proportional
}

/// An estimated EMF is late where the EMF turns fast, and so is the torque. A modelled one is not: it
/// takes the angle, which a proportional reference needs anyway. The observer corrects wrong motor data.
fn read_emf(
    reader: &Reader,
    traits: Traits,
    reference: Reference,
    errors: &mut Collector,
) -> EmfSource {
    let observes = reference == Reference::Proportional
        && traits.pulses_three_legs
        && traits.uses_emf
        && reader.field("emf_filter").is_none();
    let by_default = if observes {
        EmfSource::Observer
    } else {
        EmfSource::Estimated
    };
    reader.choice(errors, "emf", &[]).unwrap_or(by_default)
}

/// The slew rate of the current set-point, at least the rated current in a minute: a period's change
/// is then many words.
fn read_slew_rate(
    reader: &Reader,
    drive: &Surroundings,
    speed: Option<SpeedLoop>,
    errors: &mut Collector,
) -> Option<f64> {
    let rate = reader.plain_quantity(errors, "slew_rate")?;
    if speed.is_some() {
        let why = "the speed controller sets the current, and `set_current` only limits it";
        refuse(reader, "slew_rate", ["speed_loop", "on"], why, errors);
        return None;
    }
    let (rated, _) = drive.rated_current.as_ref()?;
    let least = rated / 60.0;
    if rate.si < least * (1.0 - 1e-9) {
        errors.push(catalogue::out_of_limits(
            &rate.part.location,
            "slew_rate",
            &rate.part.given,
            &format!(
                "{} (`rated_current` in a minute)",
                engineering(at_least(least), "A/s")
            ),
            "1 GA/s",
        ));
    }
    Some(rate.si)
}

/// Time-out of the residual watch, control periods: long enough for a torque step to pass where the
/// inductance is wrong.
fn read_residual_timeout(
    reader: &Reader,
    drive: &Surroundings,
    emf: Option<EmfSource>,
    errors: &mut Collector,
) -> Option<u32> {
    const OPTION: &str = "residual_timeout";
    let timeout = reader.plain_quantity(errors, OPTION)?;
    // A law that does not use the EMF refuses the option itself.
    let emf = emf?;
    if emf != EmfSource::Observer {
        let why = "only `emf: observer` tells how far the currents are from those that the motor's data predict";
        refuse(reader, OPTION, ["emf", emf.word()], why, errors);
        return None;
    }
    let t_s = drive.t_s?;
    let [least, most] = RESIDUAL_PERIODS;
    // Decimal units may round a whole number of periods.
    let periods = (timeout.si / t_s - 1e-6).ceil();
    if !(f64::from(least)..=f64::from(most)).contains(&periods) {
        errors.push(catalogue::out_of_limits(
            &timeout.part.location,
            OPTION,
            &timeout.part.given,
            &format!(
                "{} ({least} control periods)",
                engineering(at_least(f64::from(least) * t_s), "s")
            ),
            &engineering(at_most((f64::from(most) * t_s).min(LONGEST_RESIDUAL)), "s"),
        ));
        return None;
    }
    Some(periods as u32)
}

/// Whether the drive learns by the observer; `why`: what it tells. What else it needs of sensors and bus is checked
/// behind the options.
fn read_learning(
    reader: &Reader,
    option: &'static str,
    emf: Option<EmfSource>,
    why: &str,
    errors: &mut Collector,
) -> bool {
    let is_on = reader.switch(errors, option) == Some(true);
    // A law that does not use the EMF refuses the option itself.
    let Some(emf) = emf else {
        return false;
    };
    if is_on && emf != EmfSource::Observer {
        refuse(reader, option, ["emf", emf.word()], why, errors);
    }
    is_on && emf == EmfSource::Observer
}

/// The filter coefficient of the estimate; 1 without an estimate, where the option has no effect.
fn read_filter(reader: &Reader, emf: EmfSource, errors: &mut Collector) -> f64 {
    let filter = reader.plain(errors, "emf_filter");
    let why = match emf {
        EmfSource::Estimated => {
            return filter.map_or_else(|| reader.preset_number("emf_filter"), |given| given.si);
        }
        EmfSource::Model => "the filter smooths the estimate, which the model does not use",
        EmfSource::Observer => {
            "the filter smooths the estimate, and the observer has a gain of its own"
        }
        EmfSource::Held => "the filter smooths the estimate, and a held EMF is not filtered",
    };
    if filter.is_some() {
        refuse(reader, "emf_filter", ["emf", emf.word()], why, errors);
    }
    1.0
}

/// Greatest product of bandwidth and time constant of the filter of an angle sensor's speed: its lag of 32 degrees at
/// crossover leaves 44 of the 76 degrees that the PI regulator has without.
const FILTERED: f64 = 0.1;

/// Greatest bandwidth of the speed loop in hertz, and what limits it: the electrical frequency at rated speed, or the
/// time constant of the filter of an angle sensor's speed.
fn greatest_bandwidth(frequency: f64, filter: Option<f64>) -> (f64, &'static str) {
    const OF_FILTER: &str = "0.1 over the time constant of the angle sensor's speed filter (more `angle_bits`, if the sensor has them, shorten it)";
    let of_turn = frequency / 8.0;
    match filter.map(|time| FILTERED / time) {
        Some(most) if most < of_turn => (most, OF_FILTER),
        _ => (of_turn, "1/8 of the electrical frequency at rated speed"),
    }
}

/// Hall edges tell the speed as a mean over an electrical turn, which limits the bandwidth to 1/8 of the electrical
/// frequency at rated speed, and angles through a filter, whose lag limits it, too; 1/50 of that frequency by default.
fn read_speed_loop(
    reader: &Reader,
    drive: &Surroundings,
    errors: &mut Collector,
) -> Option<SpeedLoop> {
    let is_on = reader.switch(errors, "speed_loop") == Some(true);
    let bandwidth = reader.plain_quantity(errors, "speed_bandwidth");
    let acceleration = reader.plain_quantity(errors, "acceleration_limit");
    if !is_on {
        let options = [
            ("speed_bandwidth", bandwidth),
            ("acceleration_limit", acceleration),
        ];
        for (option, given) in options {
            if given.is_some() {
                let why = "no speed controller is generated";
                refuse(reader, option, ["speed_loop", "off"], why, errors);
            }
        }
        return None;
    }
    let frequency = drive.rated_frequency?;
    let (most, why) = greatest_bandwidth(frequency, drive.speed_filter);
    if let Some(bandwidth) = &bandwidth
        && bandwidth.si > most
    {
        errors.push(catalogue::out_of_limits(
            &bandwidth.part.location,
            "speed_bandwidth",
            &bandwidth.part.given,
            "10 mHz",
            &format!("{}, {why}", engineering(at_most(most), "Hz")),
        ));
    }
    let Some(inertia) = drive.inertia else {
        if drive.in_error.contains(&"inertia") {
            return None;
        }
        let at = reader
            .field("speed_loop")
            .map_or(reader.location(), |field| &field.location);
        errors.push(catalogue::needed_field(
            at,
            "speed_loop: on",
            ["motor", "inertia", &likely_inertia(drive)],
        ));
        return None;
    };
    Some(SpeedLoop {
        bandwidth: bandwidth.map_or(frequency / 50.0, |given| given.si),
        inertia,
        acceleration_limit: acceleration.map(|given| given.si),
    })
}

/// Time from rest to rated speed of an inertia that a remedy names, second: that of a small vehicle or a fan.
const RUN_UP: f64 = 0.5;

/// An inertia that fits the rating, with one digit, as of a wheel and what it moves; a rotor's where that is not known.
fn likely_inertia(drive: &Surroundings) -> String {
    let Some(acceleration) = drive.torque_per_speed else {
        return "24 g cm2".to_owned();
    };
    let inertia = RUN_UP * acceleration;
    let digit = 10_f64.powf(inertia.log10().floor());
    format!(
        "{} kg m2",
        significant((inertia / digit).round().max(1.0) * digit)
    )
}

/// Refuses the commutation options where no leg is turned off, because of `setting`.
pub(crate) fn refuse_commutation(reader: &Reader, setting: [&str; 2], errors: &mut Collector) {
    let why = "no leg is turned off, so no commutation is timed";
    for name in ["commutation_threshold", "commutation_timeout"] {
        refuse(reader, name, setting, why, errors);
    }
}

/// 0.5 A by default; a quarter of the rated current where that is less, an ADC count where that is more.
fn read_threshold(reader: &Reader, drive: &Surroundings, errors: &mut Collector) -> Option<f64> {
    let given = reader.plain_quantity(errors, "commutation_threshold");
    if reader.field("commutation_threshold").is_some() && given.is_none() {
        return None;
    }
    let (rated, rated_part) = drive.rated_current.as_ref()?;
    let least = drive.adc_gain.unwrap_or(0.0);
    let default = COMMUTATION_THRESHOLD.min(rated / 4.0).max(least);
    // A rated current below a count is an error of its own.
    if given.is_none() && *rated <= least {
        return None;
    }
    let threshold = given.map_or(default, |given| given.si);
    let part = reader.part("commutation_threshold", || engineering(threshold, "A"));
    if threshold >= *rated {
        errors.push(catalogue::threshold_above_rated(&part, rated_part));
    } else if threshold < least {
        errors.push(catalogue::threshold_below_count(&part, least));
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
    // Decimal units may round a whole number of periods.
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

/// The default of the dead-time compensation. Without it, an observed or estimated EMF keeps the mean torque right,
/// and with a proportional reference a short dead time adds little ripple.
pub(crate) fn compensates_by_default(
    drive: &Surroundings,
    traits: Traits,
    common: &LoopOptions,
) -> bool {
    let felt = || {
        let lost = f64::from(drive.pwm_per_control) * drive.v_bus? * drive.dead_time;
        drive.moves_more(lost, FELT_DEAD_TIME)
    };
    let always = common.reference == Reference::QuasiSquare || common.emf == EmfSource::Model;
    traits.pulses_three_legs && drive.dead_time > 0.0 && (always || felt().unwrap_or(false))
}

/// The prediction of rounding: for pulses of three legs, and with a computation delay; by default where it is felt.
pub(crate) fn read_rounding_prediction(
    reader: &Reader,
    drive: &Surroundings,
    (modulation, is_three_phase, delay): (&str, bool, u32),
    errors: &mut Collector,
) -> bool {
    let option = ROUNDING_PREDICTION.name;
    if !is_three_phase {
        let why = "it is made for the pulses of three legs";
        refuse(reader, option, ["modulation", modulation], why, errors);
        return false;
    }
    if delay == 0 {
        let why = "without a computation delay nothing is predicted";
        refuse(reader, option, ["delay", "0"], why, errors);
        return false;
    }
    let felt = || {
        let count = drive.v_bus? * drive.t_s? / f64::from(drive.timer_period?);
        drive.moves_more(count, FELT_COUNT)
    };
    let stated = reader.switch(errors, option);
    stated.unwrap_or_else(|| felt().unwrap_or(false))
}

/// Dead-time compensation, which needs a stated dead time; none where it is not stated.
pub(crate) fn read_dead_time_compensation(
    reader: &Reader,
    drive: &Surroundings,
    errors: &mut Collector,
) -> Option<bool> {
    const OPTION: &str = "dead_time_compensation";
    let stated = reader.switch(errors, OPTION);
    if stated == Some(true)
        && drive.dead_time <= 0.0
        && !drive.in_error.contains(&"dead_time")
        && let Some(field) = reader.field(OPTION)
    {
        let setting = format!("{OPTION}: on");
        errors.push(catalogue::needed_field(
            &field.location,
            &setting,
            ["inverter", "dead_time", "500 ns"],
        ));
    }
    stated
}
