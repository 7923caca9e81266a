//! The runtime's macro for a drive's limits, and its arguments.

use super::names::typed_number;
use crate::interface::{Limits, SensedPhases, Sensor, Sensors};

/// The runtime's macro for these limits, and its arguments with their names.
pub(super) fn limits_of(limits: &Limits) -> (&'static str, Vec<(String, &'static str)>) {
    let mut all = arguments(limits).to_vec();
    let Sensors { phases, second } = limits.sensors;
    if limits.sensors == Sensors::AB {
        return ("HEXAGEN_LIMITS", all);
    }
    let phases = match phases {
        SensedPhases::Ab => "HEXAGEN_SENSED_AB",
        SensedPhases::Bc => "HEXAGEN_SENSED_BC",
        SensedPhases::Ca => "HEXAGEN_SENSED_CA",
    };
    let Sensor {
        adc_inverted,
        offset,
        offsets: [least, most],
    } = second.unwrap_or(Sensor {
        adc_inverted: limits.adc_inverted,
        offset: limits.offset,
        offsets: limits.offsets,
    });
    all.extend([
        (phases.to_owned(), "sensed"),
        (format!("{adc_inverted}"), "second_inverted"),
        (format!("{offset}"), "second_offset"),
        (format!("{least}"), "second_least"),
        (format!("{most}"), "second_most"),
    ]);
    ("HEXAGEN_LIMITS_OF", all)
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
