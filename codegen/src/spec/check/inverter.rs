//! The inverter's data: bus, timer, ADCs, currents and speeds.

use super::sensing::{self, Sensing};
use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, Location, at_least, at_most, engineering};
use crate::spec::ast::Field;
use crate::spec::fields;
use crate::spec::model::period_within;
use crate::spec::reader::{Given, Reader};
use crate::spec::sensing::CurrentSensor;
use crate::spec::units::Dimension;
use crate::spec::{BusSource, Fade, SensedPhases};

/// The inverter data that could be read.
pub(super) struct Inverter<'a> {
    pub v_bus: Option<Given<'a>>,
    pub bus: Option<BusSource>,
    /// Where `v_bus` is stated.
    pub bus_at: Option<Location>,
    /// `f_pwm` or `sampling_time` as written.
    pub period: Option<Given<'a>>,
    /// PWM periods per control period.
    pub pwm_per_control: u32,
    /// Control period, second: of whole timer counts where the timer's clock is given, else as
    /// written.
    pub t_s: Option<f64>,
    pub timer_period: Option<u32>,
    pub dead_time: Option<Given<'a>>,
    pub adc: Option<Adc>,
    pub sensing: Sensing,
    /// `leg_enables`, if legs cannot turn on and off within a PWM period.
    pub slow_enables: Option<Part>,
    pub trip_current: Option<Given<'a>>,
    pub max_current: Option<Given<'a>>,
    /// Voltage at which the board holds its bus.
    pub bus_clamp: Option<Given<'a>>,
    /// `bus_current_limit`, `return_current_limit`.
    pub bus_currents: [Option<Given<'a>>; 2],
    pub hall_timer_clock: Option<Given<'a>>,
    /// Whether `hall_timer_clock` was written, readable or not.
    pub hall_timer_clock_given: bool,
    pub minimum_speed: Option<Given<'a>>,
    pub maximum_speed: Option<Given<'a>>,
    pub over_speed: Option<Given<'a>>,
    pub stall_timeout: Option<Given<'a>>,
    pub hall_glitches: u32,
    pub calibration_log2: u32,
    pub precharge: Option<Given<'a>>,
}

/// The phase-current ADC.
#[derive(Clone, Debug)]
pub(super) struct Adc {
    pub bits: u32,
    /// Ampere per count of the first sensor, positive.
    pub gain: f64,
    /// All sensors, in the order of the sensed phases.
    pub sensors: Vec<CurrentSensor>,
    /// Greatest deviation of a calibrated offset from the nominal one, counts.
    pub offset_tolerance: u32,
    /// Greatest current of either sign on every sensor, ampere: that of the last count, or of the amplifiers' swing.
    pub reach: f64,
    /// The amplifiers' own limit, ampere; infinite where they have none below the converter's.
    pub linear: f64,
    /// `adc_range`, `adc_gain` or `shunt` as written.
    pub part: Part,
    /// What bounds `reach`: the same, or `amplifier_swing`.
    pub bound: Part,
}

/// Default tolerance of a calibrated offset over the range of one sign.
const OFFSET_TOLERANCE: f64 = 0.05;

/// Greatest count of a measured bus over its nominal voltage. Output voltages are scaled by the
/// measured bus: half a count is then less than the 1 % of a voltage divider's resistors.
const COARSEST_BUS: f64 = 0.01;

pub(super) fn read<'a>(reader: &Reader<'a>, errors: &mut Collector) -> Inverter<'a> {
    reader.require(errors, &["bus_voltage", "adc_bits"]);
    reader.require_one_of(errors, ["f_pwm", "sampling_time"]);
    reader.require_one_of(errors, ["timer_clock", "timer_period"]);
    let v_bus = reader.plain_quantity(errors, "bus_voltage");
    let bus = read_bus(reader, v_bus.as_ref(), errors);
    let f_pwm = reader.plain_quantity(errors, "f_pwm");
    let sampling_time = reader.plain_quantity(errors, "sampling_time");
    let period = f_pwm.or(sampling_time);
    let pwm_per_control = reader.integer(errors, "pwm_per_control").unwrap_or(1);
    let (timer_period, t_s) = read_timer(reader, period.as_ref(), pwm_per_control, errors);
    let sensing = sensing::read(reader, errors);
    Inverter {
        v_bus,
        bus,
        bus_at: reader.field("v_bus").map(|field| field.location.clone()),
        period,
        pwm_per_control,
        t_s,
        timer_period,
        dead_time: reader.plain_quantity(errors, "dead_time"),
        adc: read_adc(reader, sensing.phases, errors),
        sensing,
        slow_enables: read_slow_enables(reader, errors),
        trip_current: reader.plain_quantity(errors, "trip_current"),
        max_current: reader.plain_quantity(errors, "max_current"),
        bus_clamp: reader.plain_quantity(errors, "bus_clamp"),
        bus_currents: ["bus_current_limit", "return_current_limit"]
            .map(|name| reader.plain_quantity(errors, name)),
        hall_timer_clock: reader.plain_quantity(errors, "hall_timer_clock"),
        hall_timer_clock_given: reader.field("hall_timer_clock").is_some(),
        minimum_speed: reader.plain_quantity(errors, "minimum_speed"),
        maximum_speed: reader.plain_quantity(errors, "maximum_speed"),
        over_speed: reader.plain_quantity(errors, "over_speed"),
        stall_timeout: reader.plain_quantity(errors, "stall_timeout"),
        hall_glitches: reader.integer(errors, "hall_glitches").unwrap_or(0),
        calibration_log2: read_calibration(reader, errors),
        precharge: reader.plain_quantity(errors, "precharge"),
    }
}

/// The field by which a board says that it cannot turn legs on and off within a PWM period, if it does.
fn read_slow_enables(reader: &Reader, errors: &mut Collector) -> Option<Part> {
    const FIELD: &str = "leg_enables";
    let choices = [("within_period", false), ("per_period", true)];
    let is_slow = reader.word(errors, FIELD, &choices) == Some(true);
    is_slow.then(|| reader.part(FIELD, String::new))
}

/// Fields of a measured bus.
const OF_MEASURED: [&str; 8] = [
    "bus_adc_bits",
    "bus_adc_range",
    "bus_min",
    "bus_max",
    "over_voltage",
    "under_voltage",
    "braking_fade",
    "motoring_fade",
];

/// Fixed or measured bus; a measured one needs its ADC and takes limits.
fn read_bus(reader: &Reader, v_bus: Option<&Given>, errors: &mut Collector) -> Option<BusSource> {
    const NEEDED: [(&str, &str); 2] = [("bus_adc_bits", "12"), ("bus_adc_range", "80 V")];
    let adc_bits = reader.integer(errors, "bus_adc_bits");
    let range = reader.plain_quantity(errors, "bus_adc_range");
    let min = reader.plain_quantity(errors, "bus_min");
    let max = reader.plain_quantity(errors, "bus_max");
    let over = reader.plain_quantity(errors, "over_voltage");
    let under = reader.plain_quantity(errors, "under_voltage");
    let fades = ["braking_fade", "motoring_fade"].map(|name| reader.plain_quantity(errors, name));
    let measured = reader
        .word(errors, "v_bus", &[("fixed", false), ("measured", true)])
        .or_else(|| reader.field("v_bus").is_none().then_some(false))?;
    if !measured {
        reader.refuse_without(errors, "v_bus: measured", &OF_MEASURED);
        return Some(BusSource::Fixed);
    }
    reader.require_beside(errors, ["v_bus", "measured"], ("inverter", &NEEDED));
    let (nominal, adc_bits, range) = (v_bus?, adc_bits?, range?);
    let low = min.map_or(7.0 * nominal.si / 10.0, |given| given.si);
    let high = max.map_or(13.0 * nominal.si / 10.0, |given| given.si);
    let low_part = reader.part("bus_min", || engineering(low, "V"));
    let high_part = reader.part("bus_max", || engineering(high, "V"));
    if low >= nominal.si {
        errors.push(catalogue::bus_measurement(
            &low_part,
            "below",
            &nominal.part,
        ));
    }
    if high <= nominal.si {
        errors.push(catalogue::bus_measurement(
            &high_part,
            "above",
            &nominal.part,
        ));
    } else if range.si < high {
        errors.push(catalogue::bus_measurement(
            &range.part,
            "at least",
            &high_part,
        ));
    }
    let under = trip_level(under, low, |part, is_on| {
        if is_on && part.si >= nominal.si {
            errors.push(catalogue::bus_measurement(
                &part.part,
                "below",
                &nominal.part,
            ));
        }
    });
    let over = trip_level(over, high, |part, is_on| {
        if is_on && part.si <= nominal.si {
            errors.push(catalogue::bus_measurement(
                &part.part,
                "above",
                &nominal.part,
            ));
        } else if range.si < part.si {
            errors.push(catalogue::bus_measurement(
                &range.part,
                "at least",
                &part.part,
            ));
        }
    });
    let [braking, motoring] = fades;
    let gain = range.si / f64::from(1_u32 << adc_bits);
    if gain > COARSEST_BUS * nominal.si * (1.0 + 1e-9) {
        let full = f64::from(1_u32 << adc_bits);
        errors.push(catalogue::bus_resolution(
            &range.part,
            &nominal.part,
            [gain, gain / nominal.si, COARSEST_BUS],
            COARSEST_BUS * nominal.si * full,
            adc_bits,
        ));
    }
    Some(BusSource::Measured {
        gain,
        adc_bits,
        min: low,
        max: high,
        under,
        over,
        braking: fade(
            braking.as_ref(),
            [nominal.si, reached(over, high, f64::min)],
            errors,
        ),
        motoring: fade(
            motoring.as_ref(),
            [nominal.si, reached(under, low, f64::max)],
            errors,
        ),
    })
}

/// The first of the levels that a voltage reaches, volt: that of a trip, 0 for none, or the limit of
/// the measurement.
fn reached(trip: f64, limit: f64, first: fn(f64, f64) -> f64) -> f64 {
    if trip > 0.0 {
        first(trip, limit)
    } else {
        limit
    }
}

/// A fade of the torque from the nominal voltage at most towards a level; none without a width.
fn fade(width: Option<&Given>, [nominal, level]: [f64; 2], errors: &mut Collector) -> Option<Fade> {
    let width = width.filter(|width| width.si > 0.0)?;
    let most = (level - nominal).abs();
    if width.si > most * (1.0 + 1e-9) {
        errors.push(catalogue::out_of_limits(
            &width.part.location,
            width.part.field,
            &width.part.given,
            "0 V",
            &format!(
                "{}, from `bus_voltage` to {}",
                engineering(at_most(most), "V"),
                engineering(level, "V")
            ),
        ));
    }
    Some(Fade::towards(level, width.si, level > nominal))
}

/// A voltage that trips, volt, 0 for none: by default the limit of the measurement. `check` takes a
/// given one, and whether it is not 0.
fn trip_level(given: Option<Given>, usual: f64, check: impl FnOnce(&Given, bool)) -> f64 {
    given.map_or(usual, |given| {
        check(&given, given.si > 0.0);
        given.si
    })
}

/// Fewest counts of a PWM timer.
pub const FEWEST_COUNTS: f64 = 100.0;

/// Counts of the centre-aligned timer, clock/(2 f_pwm) rounded, and its control period,
/// 2 counts/clock per PWM period: within 0.5 % of the stated one from 100 counts on. Where counts
/// are given in place of the clock, the period is the stated one.
fn read_timer(
    reader: &Reader,
    period: Option<&Given>,
    pwm_per_control: u32,
    errors: &mut Collector,
) -> (Option<u32>, Option<f64>) {
    let given = reader.integer(errors, "timer_period");
    let clock = reader.plain_quantity(errors, "timer_clock");
    let Some(period) = period else {
        return (given, None);
    };
    let per_control = f64::from(pwm_per_control);
    let asked = match period.dimension {
        Some(Dimension::Frequency) => per_control / period.si,
        _ => period.si,
    };
    let (None, Some(clock)) = (given, clock) else {
        return (given, Some(asked));
    };
    let counts = clock.si * asked / per_control / 2.0;
    // Decimal units may round the limits.
    if !(FEWEST_COUNTS - 1e-6..=65535.0 + 1e-6).contains(&counts) {
        errors.push(catalogue::timer_period(
            &clock.part,
            &period.part,
            counts,
            clock.si,
            per_control / asked,
        ));
        return (None, Some(asked));
    }
    let counts = counts.round();
    (
        Some(counts as u32),
        Some(per_control * 2.0 * counts / clock.si),
    )
}

/// The sensors of a board alone; none where it does not state them, or they are in error, which is told of elsewhere.
pub(super) fn gain(board: &Reader, phases: SensedPhases) -> Option<Adc> {
    let mut untold = Collector::new();
    let adc = read_adc(board, phases, &mut untold);
    let is_right = untold.finish().is_none();
    adc.filter(|_| is_right)
}

/// The sensors that are read: a count's worth, offset and sign, each for all phases or one of each
/// that has a sensor.
fn read_adc(reader: &Reader, phases: SensedPhases, errors: &mut Collector) -> Option<Adc> {
    let bits = reader.integer(errors, "adc_bits");
    let counts_of = bits.map_or(0.0, |bits| f64::from(1_u32 << bits));
    let gains = read_gains(reader, phases, counts_of, errors);
    let each = |name, errors: &mut Collector, read: fn(&Reader, &mut Collector) -> Option<u32>| {
        match reader.field(name) {
            None => Some(None),
            Some(_) => sensing::of_each_phase(reader, name, phases, errors, read).map(Some),
        }
    };
    let offsets = each("adc_offset", errors, |one, errors| {
        one.integer(errors, "adc_offset")
    });
    let inverted = each("adc_inverted", errors, |one, errors| {
        one.word(errors, "adc_inverted", &[("off", 0), ("on", 1)])
    });
    let full = 1_u32 << bits?;
    let count = phases.phases().len();
    let offsets = offsets?.unwrap_or_else(|| vec![full / 2; count]);
    if !offsets
        .iter()
        .all(|offset| (full / 4..=full - full / 4).contains(offset))
    {
        let part = reader.part("adc_offset", || (full / 2).to_string());
        errors.push(catalogue::adc_offset(&part, full));
        return None;
    }
    let inverted = inverted?.unwrap_or_else(|| vec![0; count]);
    let Gains {
        each: gains,
        linear,
        part,
        swing,
    } = gains?;
    let gain = *gains.first()?;
    if let Some(other) = gains
        .iter()
        .find(|other| !(0.5..=2.0).contains(&(**other / gain)))
    {
        errors.push(catalogue::unlike_gains(&part, [gain, *other]));
        return None;
    }
    let signs = inverted.iter().map(|on| if *on == 1 { -1.0 } else { 1.0 });
    let sensors: Vec<CurrentSensor> = gains
        .iter()
        .zip(signs)
        .zip(&offsets)
        .map(|((gain, sign), offset)| CurrentSensor {
            gain: sign * gain,
            offset: *offset,
        })
        .collect();
    let reaches = gains.iter().zip(&offsets);
    let counted = reaches
        .map(|(gain, offset)| gain * f64::from((*offset).min(full - offset)))
        .fold(f64::INFINITY, f64::min);
    let bound = swing.filter(|_| linear < counted);
    let offset_tolerance = read_offset_tolerance(reader, gain, full, errors)?;
    Some(Adc {
        bits: bits?,
        gain,
        sensors,
        offset_tolerance,
        reach: linear.min(counted),
        linear,
        bound: bound.unwrap_or_else(|| part.clone()),
        part,
    })
}

/// What currents the sensors show.
struct Gains {
    /// Ampere per count of each sensor, positive.
    each: Vec<f64>,
    /// Greatest current of either sign that the amplifiers show, ampere; none by themselves is infinite.
    linear: f64,
    /// `adc_range`, `adc_gain` or `shunt` as written.
    part: Part,
    /// `amplifier_swing` as written.
    swing: Option<Part>,
}

/// The current at the end of the converter's range.
const RANGE: &str = "adc_range";

/// Ampere per count, or volt per ampere of the sensors.
const GAIN: &str = "adc_gain";

/// The converter's reference.
const REFERENCE: &str = "adc_reference";

/// Fields that say together what a count is worth.
const SHUNT: [&str; 3] = ["shunt", "amplifier_gain", REFERENCE];

/// How far the amplifier's output follows the current.
const SWING: &str = "amplifier_swing";

/// With what a field of the converter's volts has an effect.
const OF_VOLTS: &str = "shunt` or a sensitivity in `adc_gain";

/// The gains of a converter of so many counts: from the range, as stated, from the sensors' sensitivity and the
/// converter's reference, or from shunt, amplifier and reference.
fn read_gains(
    reader: &Reader,
    phases: SensedPhases,
    counts: f64,
    errors: &mut Collector,
) -> Option<Gains> {
    let is_sensitivity = reader
        .field(GAIN)
        .is_some_and(|field| field.value.is_sensitivity());
    // A sensitivity takes the reference, too.
    let mut shunt = SHUNT.iter().filter_map(|name| reader.field(name));
    match shunt.find(|field| !is_sensitivity || field.name != REFERENCE) {
        Some(only) if only.name == REFERENCE && reader.field(GAIN).is_some() => {
            let given = reader.part(REFERENCE, String::new).given;
            let at = &only.name_location;
            errors.push(catalogue::needless_field(
                at, REFERENCE, &given, OF_VOLTS, None,
            ));
            stated_gains(reader, phases, counts, errors)
        }
        Some(shunt) => gains_of_shunt(reader, shunt, phases, counts, errors),
        None if is_sensitivity => gains_of_sensors(reader, phases, counts, errors),
        None => stated_gains(reader, phases, counts, errors),
    }
}

/// From the range, or ampere per count.
fn stated_gains(
    reader: &Reader,
    phases: SensedPhases,
    counts: f64,
    errors: &mut Collector,
) -> Option<Gains> {
    if let Some(swing) = reader.plain_quantity(errors, SWING) {
        let (at, given) = (&swing.part.location, &swing.part.given);
        errors.push(catalogue::needless_field(at, SWING, given, OF_VOLTS, None));
    }
    if [RANGE, GAIN]
        .iter()
        .all(|name| reader.field(name).is_none())
    {
        reader.require_any_of(errors, &[RANGE, GAIN, SHUNT[0]]);
    } else {
        reader.require_one_of(errors, [RANGE, GAIN]);
    }
    let range = reader.plain_quantity(errors, RANGE);
    let stated = reader.field(GAIN).and_then(|_| {
        sensing::of_each_phase(reader, GAIN, phases, errors, |one, errors| {
            one.plain_quantity(errors, GAIN).map(|given| given.si)
        })
    });
    let (each, part) = match range {
        Some(range) => {
            let gain = 2.0 * range.si / counts;
            (vec![gain; phases.phases().len()], range.part)
        }
        None => (stated?, reader.part(GAIN, String::new)),
    };
    Some(Gains {
        each,
        linear: f64::INFINITY,
        part,
        swing: None,
    })
}

/// From the voltage per ampere of sensors with an output of their own; a list may state some in ampere per count.
fn gains_of_sensors(
    reader: &Reader,
    phases: SensedPhases,
    counts: f64,
    errors: &mut Collector,
) -> Option<Gains> {
    let gain = reader.field(GAIN)?;
    refuse_beside(reader, gain, &[RANGE], errors);
    if reader.field(REFERENCE).is_none() {
        need(&gain.location, GAIN, REFERENCE, errors);
    }
    let swing = reader.plain_quantity(errors, SWING);
    let reference = reader.plain_quantity(errors, REFERENCE);
    let sensors = sensing::of_each_phase(reader, GAIN, phases, errors, |one, errors| {
        let given = one.plain_quantity(errors, GAIN)?;
        Some((given.si, given.dimension))
    })?;
    let volt = reference?.si / counts;
    let each: Vec<f64> = sensors
        .into_iter()
        .map(|(si, dimension)| match dimension {
            Some(Dimension::Sensitivity) => volt / si,
            _ => si,
        })
        .collect();
    let least = each.iter().copied().fold(f64::INFINITY, f64::min);
    Some(Gains {
        linear: swing
            .as_ref()
            .map_or(f64::INFINITY, |swing| swing.si * least / volt),
        each,
        part: reader.part(GAIN, String::new),
        swing: swing.map(|swing| swing.part),
    })
}

/// From shunt, amplifier and reference, of which `shunt` is the first that is given.
fn gains_of_shunt(
    reader: &Reader,
    shunt: &Field,
    phases: SensedPhases,
    counts: f64,
    errors: &mut Collector,
) -> Option<Gains> {
    refuse_beside(reader, shunt, &[RANGE, GAIN], errors);
    for name in SHUNT {
        if reader.field(name).is_none() {
            need(&shunt.location, &shunt.name, name, errors);
        }
    }
    let swing = reader.plain_quantity(errors, SWING);
    let [ohm, volt] = [SHUNT[0], REFERENCE].map(|name| reader.plain_quantity(errors, name));
    let amplified = reader.plain(errors, SHUNT[1]);
    let (ohm, volt, amplified) = (ohm?, volt?, amplified?);
    // Volt at the converter per ampere.
    let sensitivity = ohm.si * amplified.si;
    Some(Gains {
        each: vec![volt.si / (counts * sensitivity); phases.phases().len()],
        linear: swing
            .as_ref()
            .map_or(f64::INFINITY, |swing| swing.si / sensitivity),
        part: ohm.part,
        swing: swing.map(|swing| swing.part),
    })
}

/// Reports fields that say what `field` says.
fn refuse_beside(reader: &Reader, field: &Field, names: &[&str], errors: &mut Collector) {
    for name in names {
        if let Some(other) = reader.field(name) {
            let (at, other) = (&field.name_location, &other.name_location);
            errors.push(catalogue::exclusive_fields(at, &field.name, other, name));
        }
    }
}

/// Reports the field `name` of the inverter that another one needs.
fn need(at: &Location, field: &str, name: &str, errors: &mut Collector) {
    let example = fields::field(name).example();
    errors.push(catalogue::needed_field(
        at,
        field,
        ["inverter", name, example],
    ));
}

/// Default offset tolerance of an ADC of `full` counts, counts.
pub(super) fn usual_tolerance(full: u32) -> f64 {
    (OFFSET_TOLERANCE * f64::from(full / 2)).round()
}

/// Offset tolerance in whole counts; by default 5 % of the range of one sign.
fn read_offset_tolerance(
    reader: &Reader,
    gain: f64,
    full: u32,
    errors: &mut Collector,
) -> Option<u32> {
    let most = full / 4;
    let given = reader.plain_quantity(errors, "offset_tolerance");
    if given.is_none() && reader.field("offset_tolerance").is_some() {
        return None;
    }
    let counts = given
        .as_ref()
        .map_or(usual_tolerance(full), |given| (given.si / gain).round());
    if let Some(given) = &given
        && !(1.0..=f64::from(most)).contains(&counts)
    {
        errors.push(catalogue::out_of_limits(
            &given.part.location,
            "offset_tolerance",
            &given.part.given,
            &format!("{}, one ADC count", engineering(at_least(gain), "A")),
            &format!(
                "{}, half of the range",
                engineering(at_most(gain * f64::from(most)), "A")
            ),
        ));
        return None;
    }
    Some(counts as u32)
}

fn read_calibration(reader: &Reader, errors: &mut Collector) -> u32 {
    let samples = reader.integer(errors, "calibration_samples").unwrap_or(256);
    if !samples.is_power_of_two() {
        let part = reader.part("calibration_samples", String::new);
        let above = samples.next_power_of_two();
        errors.push(catalogue::not_a_power_of_two(
            &part.location,
            "calibration_samples",
            &part.given,
            above / 2,
            above,
        ));
    }
    samples.ilog2()
}

/// Greatest share of the PWM period that the dead time may take.
const MOST_DEAD_TIME: f64 = 0.1;

impl<'a> Inverter<'a> {
    /// A dead time that takes too much of the PWM period, and that period.
    pub fn long_dead_time(&self) -> Option<(&Given<'a>, f64)> {
        let pwm_period = self.t_s? / f64::from(self.pwm_per_control);
        let given = self.dead_time.as_ref()?;
        (given.si > MOST_DEAD_TIME * pwm_period * (1.0 + 1e-9)).then_some((given, pwm_period))
    }

    /// The longest period of whole timer counts within `limit`; `limit` where the timer is unknown.
    pub fn period_within(&self, limit: f64) -> f64 {
        match (self.t_s, self.timer_period) {
            (Some(t_s), Some(timer_period)) => period_within(limit, t_s, timer_period),
            _ => limit,
        }
    }
}
