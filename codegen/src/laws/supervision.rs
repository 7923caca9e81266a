//! Numbers of the runtime's supervisor: how ADC counts become words of current, trip levels, limits
//! of Hall sensors and bus.

use crate::blocks::Scale;
use crate::interface::{AngleSensor, Limits, SensedPhases, Sensor, Sensors, ThirdSensor};
use crate::spec::{self, InverterSpec, Spec};

pub(super) fn limits(spec: &Spec, scale: Scale) -> Limits {
    let inverter = &spec.inverter;
    let words = |current: i64| current as i32;
    let sensors = sensors(inverter);
    let (first, second) = (sensors[0], sensors[1]);
    Limits {
        adc_max: inverter.adc_max() as u16,
        adc_inverted: first.adc_inverted,
        current_bits: scale.current_bits,
        offset: first.offset,
        offsets: first.offsets,
        trip: (inverter.trip_current * scale.current() + 0.5).floor() as i32,
        currents: inverter.current_range(scale.current_bits).map(words),
        calibration_log2: inverter.calibration_log2,
        precharge_periods: inverter.precharge_periods as u16,
        stall_periods: inverter.stall_periods as i32,
        hall_inverted: spec.motor.hall_inverted(),
        hall_glitches: inverter.hall_glitches as u16,
        sectors: (spec.hall_sectors().into_iter().rev())
            .fold(0, |word, sector| word << 4 | u32::from(sector)),
        brake_periods: spec.brake_periods() as i32,
        start_periods: spec.start_periods(),
        bus_counts: inverter.bus_counts(),
        angle: spec.angle_sensor().map(|sensor| AngleSensor {
            turns: sensor.turns,
            offset: sensor.offset(),
        }),
        sensors: Sensors {
            phases: match inverter.sensed_phases {
                spec::SensedPhases::Bc => SensedPhases::Bc,
                spec::SensedPhases::Ca => SensedPhases::Ca,
                spec::SensedPhases::Ab | spec::SensedPhases::Abc => SensedPhases::Ab,
            },
            second: (second != first).then_some(second),
            third: sensors.get(2).map(|third| ThirdSensor {
                sensor: *third,
                readable: inverter.readable_at_end().map(|top| top as u16),
                is_delayed: spec.controller.common().delay > 0,
                sum_tolerance: (inverter.current_sum).map_or(0, |sum| {
                    (sum.tolerance * scale.current() + 0.5).floor() as i32
                }),
                sum_samples: inverter.current_sum.map_or(0, |sum| sum.samples as u16),
            }),
        },
    }
}

fn sensors(inverter: &InverterSpec) -> Vec<Sensor> {
    let sensors = inverter.sensors().into_iter();
    sensors
        .map(|sensor| Sensor {
            adc_inverted: sensor.gain < 0.0,
            offset: sensor.offset as u16,
            offsets: inverter.offsets(sensor).map(|offset| offset as u16),
            ratio: inverter.ratio(sensor),
        })
        .collect()
}
