//! The inverter's data: bus, timer, ADCs, currents and speeds.

use super::reader::{Given, Reader};
use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, at_least, at_most, engineering};
use crate::spec::BusSource;
use crate::spec::model::period_within;
use crate::spec::units::Dimension;

/// The inverter data that could be read.
pub(super) struct Inverter<'a> {
    pub v_bus: Option<Given<'a>>,
    pub bus: Option<BusSource>,
    /// `f_pwm` or `sampling_time` as written.
    pub period: Option<Given<'a>>,
    /// Control period, second: of whole timer counts where the timer's clock is given, else as
    /// written.
    pub t_s: Option<f64>,
    pub timer_period: Option<u32>,
    pub dead_time: Option<Given<'a>>,
    pub adc: Option<Adc>,
    pub trip_current: Option<Given<'a>>,
    pub max_current: Option<Given<'a>>,
    pub hall_timer_clock: Option<Given<'a>>,
    /// Whether `hall_timer_clock` was written, readable or not.
    pub hall_timer_clock_given: bool,
    pub minimum_speed: Option<Given<'a>>,
    pub maximum_speed: Option<Given<'a>>,
    pub stall_timeout: Option<Given<'a>>,
    pub calibration_log2: u32,
    pub precharge: Option<Given<'a>>,
}

/// The phase-current ADC.
#[derive(Clone, Debug)]
pub(super) struct Adc {
    pub bits: u32,
    /// Ampere per count, positive.
    pub gain: f64,
    pub inverted: bool,
    pub offset: u32,
    /// Greatest deviation of a calibrated offset from `offset`, counts.
    pub offset_tolerance: u32,
    /// Greatest current of either sign, ampere, with one count of margin.
    pub reach: f64,
    /// `adc_range` or `adc_gain` as written.
    pub part: Part,
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
    reader.require_one_of(errors, ["adc_range", "adc_gain"]);
    let v_bus = reader.plain_quantity(errors, "bus_voltage");
    let bus = read_bus(reader, v_bus.as_ref(), errors);
    let f_pwm = reader.plain_quantity(errors, "f_pwm");
    let sampling_time = reader.plain_quantity(errors, "sampling_time");
    let period = f_pwm.or(sampling_time);
    let (timer_period, t_s) = read_timer(reader, period.as_ref(), errors);
    Inverter {
        v_bus,
        bus,
        period,
        t_s,
        timer_period,
        dead_time: reader.plain_quantity(errors, "dead_time"),
        adc: read_adc(reader, errors),
        trip_current: reader.plain_quantity(errors, "trip_current"),
        max_current: reader.plain_quantity(errors, "max_current"),
        hall_timer_clock: reader.plain_quantity(errors, "hall_timer_clock"),
        hall_timer_clock_given: reader.field("hall_timer_clock").is_some(),
        minimum_speed: reader.plain_quantity(errors, "minimum_speed"),
        maximum_speed: reader.plain_quantity(errors, "maximum_speed"),
        stall_timeout: reader.plain_quantity(errors, "stall_timeout"),
        calibration_log2: read_calibration(reader, errors),
        precharge: reader.plain_quantity(errors, "precharge"),
    }
}

/// Fixed or measured bus; a measured one needs its ADC and takes limits.
fn read_bus(reader: &Reader, v_bus: Option<&Given>, errors: &mut Collector) -> Option<BusSource> {
    const NEEDED: [(&str, &str); 2] = [("bus_adc_bits", "12"), ("bus_adc_range", "80 V")];
    let adc_bits = reader.integer(errors, "bus_adc_bits");
    let range = reader.plain_quantity(errors, "bus_adc_range");
    let min = reader.plain_quantity(errors, "bus_min");
    let max = reader.plain_quantity(errors, "bus_max");
    let measured = reader
        .word(errors, "v_bus", &[("fixed", false), ("measured", true)])
        .or_else(|| reader.field("v_bus").is_none().then_some(false))?;
    if !measured {
        for name in ["bus_adc_bits", "bus_adc_range", "bus_min", "bus_max"] {
            if let Some(field) = reader.field(name) {
                let (at, given) = (&field.location, field.value.to_string());
                errors.push(catalogue::needless_field(
                    at,
                    name,
                    &given,
                    "v_bus: measured",
                ));
            }
        }
        return Some(BusSource::Fixed);
    }
    for (name, example) in NEEDED {
        if reader.field(name).is_none() {
            let at = reader
                .field("v_bus")
                .map_or(reader.location(), |field| &field.location);
            errors.push(catalogue::needed_field(
                at,
                "v_bus: measured",
                name,
                example,
            ));
        }
    }
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
    })
}

/// Counts of the centre-aligned timer, clock/(2 f_pwm) rounded, and its control period,
/// 2 counts/clock: within 0.5 % of the stated one from 100 counts on. Where counts are given in
/// place of the clock, the period is the stated one.
fn read_timer(
    reader: &Reader,
    period: Option<&Given>,
    errors: &mut Collector,
) -> (Option<u32>, Option<f64>) {
    let given = reader.integer(errors, "timer_period");
    let clock = reader.plain_quantity(errors, "timer_clock");
    let Some(period) = period else {
        return (given, None);
    };
    let asked = match period.dimension {
        Some(Dimension::Frequency) => 1.0 / period.si,
        _ => period.si,
    };
    let (None, Some(clock)) = (given, clock) else {
        return (given, Some(asked));
    };
    let counts = clock.si * asked / 2.0;
    // Decimal units may round the limits.
    if !(100.0 - 1e-6..=65535.0 + 1e-6).contains(&counts) {
        errors.push(catalogue::timer_period(
            &clock.part,
            &period.part,
            counts,
            clock.si,
            1.0 / asked,
        ));
        return (None, Some(asked));
    }
    let counts = counts.round();
    (Some(counts as u32), Some(2.0 * counts / clock.si))
}

fn read_adc(reader: &Reader, errors: &mut Collector) -> Option<Adc> {
    let bits = reader.integer(errors, "adc_bits");
    let range = reader.plain_quantity(errors, "adc_range");
    let gain = reader.plain_quantity(errors, "adc_gain");
    let offset = reader.integer(errors, "adc_offset");
    let inverted = reader.word(errors, "adc_inverted", &[("off", false), ("on", true)]);
    let bits = bits?;
    let full = 1_u32 << bits;
    let offset = offset.unwrap_or(full / 2);
    if !(full / 4..=full - full / 4).contains(&offset) {
        let part = reader.part("adc_offset", || offset.to_string());
        errors.push(catalogue::adc_offset(&part, full));
        return None;
    }
    let part = range
        .as_ref()
        .or(gain.as_ref())
        .map(|given| given.part.clone())?;
    let gain = match range {
        Some(range) => 2.0 * range.si / f64::from(full),
        None => gain?.si,
    };
    let reach = gain * f64::from(offset.min(full - offset));
    let offset_tolerance = read_offset_tolerance(reader, gain, full, errors)?;
    Some(Adc {
        bits,
        gain,
        inverted: inverted.unwrap_or(false),
        offset,
        offset_tolerance,
        reach,
        part,
    })
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

impl Inverter<'_> {
    /// The longest period of whole timer counts within `limit`; `limit` where the timer is unknown.
    pub fn period_within(&self, limit: f64) -> f64 {
        match (self.t_s, self.timer_period) {
            (Some(t_s), Some(timer_period)) => period_within(limit, t_s, timer_period),
            _ => limit,
        }
    }
}
