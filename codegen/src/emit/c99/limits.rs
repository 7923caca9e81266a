//! The runtime's macro for a drive's limits, and its arguments.

use super::names::typed_number;
use crate::interface::{Limits, SensedPhases, Sensor, Sensors};

/// The runtime's macro for these limits, and its arguments with their names.
pub(super) fn limits_of(limits: &Limits) -> (&'static str, Vec<(String, &'static str)>) {
    let mut all = arguments(limits).to_vec();
    let Sensors {
        phases,
        second,
        third,
    } = limits.sensors;
    if limits.sensors == Sensors::AB {
        return ("HEXAGEN_LIMITS", all);
    }
    let phases = match phases {
        SensedPhases::Ab => "HEXAGEN_SENSED_AB",
        SensedPhases::Bc => "HEXAGEN_SENSED_BC",
        SensedPhases::Ca => "HEXAGEN_SENSED_CA",
    };
    let first = Sensor {
        adc_inverted: limits.adc_inverted,
        offset: limits.offset,
        offsets: limits.offsets,
        ratio: Sensor::ALIKE,
    };
    let names = [
        "second_inverted",
        "second_offset",
        "second_least",
        "second_most",
        "second_ratio",
    ];
    all.push((phases.to_owned(), "sensed"));
    all.extend(sensor(second.unwrap_or(first), names));
    let Some(third) = third else {
        return ("HEXAGEN_LIMITS_OF", all);
    };
    let names = [
        "third_inverted",
        "third_offset",
        "third_least",
        "third_most",
        "third_ratio",
    ];
    all.extend(sensor(third.sensor, names));
    all.extend([
        ("true".to_owned(), "has_third"),
        (format!("{}", third.readable.is_some()), "is_low_side"),
        (format!("{}", third.readable.unwrap_or(0)), "readable"),
        (format!("{}", third.is_delayed), "is_delayed"),
        (typed_number(third.sum_tolerance), "sum_tolerance"),
        (format!("{}", third.sum_samples), "sum_samples"),
    ]);
    ("HEXAGEN_LIMITS_OF_THREE", all)
}

/// A sensor's arguments with these names.
fn sensor(
    sensor: Sensor,
    names: [&'static str; 5],
) -> impl Iterator<Item = (String, &'static str)> {
    let [least, most] = sensor.offsets;
    let ratio = if sensor.ratio == Sensor::ALIKE {
        "HEXAGEN_ALIKE".to_owned()
    } else {
        typed_number(sensor.ratio)
    };
    let values = [
        format!("{}", sensor.adc_inverted),
        format!("{}", sensor.offset),
        format!("{least}"),
        format!("{most}"),
        ratio,
    ];
    values.into_iter().zip(names)
}

/// The limits with their names, in the order of the runtime's macro.
fn arguments(limits: &Limits) -> [(String, &'static str); 19] {
    let [least, most] = limits.offsets;
    let [low, high] = limits.currents;
    [
        (format!("{}", limits.adc_max), "adc_max"),
        (format!("{}", limits.adc_inverted), "adc_inverted"),
        (format!("{}", limits.current_bits), "current_bits"),
        (format!("{}", limits.offset), "offset"),
        (format!("{least}"), "offset_least"),
        (format!("{most}"), "offset_most"),
        (typed_number(limits.trip), "trip"),
        (typed_number(low), "current_least"),
        (typed_number(high), "current_most"),
        (format!("{}", limits.calibration_log2), "calibration_log2"),
        (format!("{}", limits.precharge_periods), "precharge_periods"),
        (typed_number(limits.stall_periods), "stall_periods"),
        (format!("{}", limits.hall_inverted), "hall_inverted"),
        (format!("{}", limits.hall_glitches), "hall_glitches"),
        (format!("UINT32_C({:#010x})", limits.sectors), "sectors"),
        (typed_number(limits.brake_periods), "brake_periods"),
        (format!("{}", limits.start_periods), "start_periods"),
        (format!("{}", limits.bus_counts[0]), "bus_least"),
        (format!("{}", limits.bus_counts[1]), "bus_most"),
    ]
}
