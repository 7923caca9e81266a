//! Tables of a generated drive in the types of the runtime.

use hexagen::{
    AngleSensor, Format, Limits, Rounding, SensedPhases, Sensor, Sensors, Supervisor, ThirdSensor,
};
use hexagen_codegen::interface::{self, FormatEntry};
use hexagen_codegen::ir::Program;
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// Names of the state words, as in `hexagen::Drive::state_names`: the supervisor's, then the law's.
pub fn state_names(program: &Program) -> Vec<&str> {
    let law = program.states.iter().map(|word| word.name.as_str());
    Supervisor::NAMES.into_iter().chain(law).collect()
}

/// The supervisor's limits.
pub fn limits(limits: &interface::Limits) -> Limits {
    let interface::Limits {
        adc_max,
        adc_inverted,
        current_bits,
        offset,
        offsets,
        trip,
        currents,
        calibration_log2,
        precharge_periods,
        stall_periods,
        hall_inverted,
        hall_glitches,
        sectors,
        brake_periods,
        start_periods,
        bus_counts,
        sensors: _,
        angle: _,
    } = *limits;
    Limits {
        adc_max,
        adc_inverted,
        current_bits,
        offset,
        offsets,
        trip,
        currents,
        calibration_log2,
        precharge_periods,
        stall_periods,
        hall_inverted,
        hall_glitches,
        sectors,
        brake_periods,
        start_periods,
        bus_counts,
    }
}

/// The angle sensor; none with Hall sensors.
pub fn angle(limits: &interface::Limits) -> Option<AngleSensor> {
    let sensor = limits.angle;
    sensor.map(|interface::AngleSensor { turns, offset }| AngleSensor { turns, offset })
}

/// The current sensors.
pub fn sensors(limits: &interface::Limits) -> Sensors {
    let interface::Sensors {
        phases,
        second,
        third,
    } = limits.sensors;
    Sensors {
        phases: match phases {
            interface::SensedPhases::Ab => SensedPhases::Ab,
            interface::SensedPhases::Bc => SensedPhases::Bc,
            interface::SensedPhases::Ca => SensedPhases::Ca,
        },
        second: second.map(sensor),
        third: third.map(|third| ThirdSensor {
            sensor: sensor(third.sensor),
            readable: third.readable,
            is_delayed: third.is_delayed,
            sum_tolerance: third.sum_tolerance,
            sum_samples: third.sum_samples,
        }),
    }
}

fn sensor(sensor: interface::Sensor) -> Sensor {
    Sensor {
        adc_inverted: sensor.adc_inverted,
        offset: sensor.offset,
        offsets: sensor.offsets,
        ratio: sensor.ratio,
    }
}

/// The format table. Widths and shifts of a verified program fit it.
pub fn formats(table: &[FormatEntry]) -> Vec<Format> {
    let convert = |entry: &FormatEntry| Format {
        name: interned(&entry.name),
        storage_bits: entry.storage_bits as u8,
        frac_bits: entry.frac_bits as i8,
        rounding: match entry.rounding {
            interface::Rounding::Floor => Rounding::Floor,
            interface::Rounding::RoundHalfUp => Rounding::RoundHalfUp,
        },
        segments: entry.segments.unwrap_or(0) as u8,
    };
    table.iter().map(convert).collect()
}

/// Names of formats are leaked, to be static as in compiled drives; there are few.
fn interned(name: &str) -> &'static str {
    static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(name) {
        return known;
    }
    let kept: &'static str = Box::leak(name.to_owned().into_boxed_str());
    names.insert(kept);
    kept
}
