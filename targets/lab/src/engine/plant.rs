//! The plant of a specification.

use crate::closed_loop::{Delay, RunOptions};
use crate::plant::{AdcChannel, AngleSensor, EmfShape, LowSide, PlantParams, Wiring};
use hexagen_codegen::spec::{self, Spec};

/// Motor, inverter and sensors exactly as specified: nominal parameters, nominal bus, the dead
/// time of the specification, ideal diodes, the shaft held at its speed.
pub fn plant_of(spec: &Spec) -> PlantParams {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let sensors = inverter.sensors();
    let times = inverter.current_sensing.times();
    PlantParams {
        pole_pairs: motor.pole_pairs,
        resistance: [motor.resistance; 3],
        inductance: [motor.inductance; 3],
        k_phase: [motor.emf_constant; 3],
        shape: shape_of(motor.emf_shape),
        v_bus: inverter.v_bus,
        t_s: inverter.t_s,
        pwm_per_control: inverter.pwm_per_control as u16,
        timer_period: inverter.timer_period as u16,
        dead_time: inverter.dead_time,
        diode_drop: 0.0,
        adc: (sensors.iter().zip(0..))
            .map(|(sensor, place)| AdcChannel {
                bits: inverter.adc_bits,
                amperes_per_count: sensor.gain,
                offset: f64::from(sensor.offset),
                most: inverter.amplifier_reach,
                noise: 0.0,
                instant: inverter.sampling_delay(spec.controller.common().delay)
                    + times.map_or(0.0, |times| {
                        f64::from(place / times.converters) * times.conversion
                    }),
            })
            .collect(),
        sensed: inverter.sensed_phases.phases().to_vec(),
        low_side: times.map(|times| LowSide {
            settling: times.settling,
            aperture: times.aperture,
        }),
        hall_ticks_per_period: inverter.rotor_sensing.ticks_per_period(),
        hall_codes: motor.hall_codes,
        hall_edges_deg: motor.hall_angles,
        hall_error_deg: [0.0; 3],
        angle: spec.angle_sensor().map(|sensor| AngleSensor {
            turns: sensor.turns,
            offset_deg: sensor.offset_deg,
            bits: sensor.bits,
        }),
        mechanics: None,
        wiring: Wiring::default(),
    }
}

/// The plant's shape of a specified one.
pub(super) fn shape_of(shape: spec::EmfShape) -> EmfShape {
    match shape {
        spec::EmfShape::Trapezoidal { flat_top_deg } => EmfShape::Trapezoidal { flat_top_deg },
        spec::EmfShape::Sinusoidal => EmfShape::Sinusoidal,
        spec::EmfShape::Harmonics(series) => EmfShape::Harmonics {
            sines: series.sines,
            cosines: series.cosines,
        },
    }
}

/// Largest torque in newton metres that a drive's set-point limit allows.
pub fn reach_of(spec: &Spec) -> f64 {
    spec.inverter.max_current * spec.torque_constant()
}

/// The standard measurement of a drive at a mechanical speed in rad/s and a torque in newton
/// metres: compared with the quasi-square reference of this torque, clamped to the set-point limit.
pub fn run_of(spec: &Spec, omega_m: f64, torque: f64) -> RunOptions {
    let controller = spec.controller.common();
    let reach = reach_of(spec);
    let torque = torque.clamp(-reach, reach);
    let amperes = torque.abs() / spec.torque_constant();
    let per_ampere = spec.motor.emf_constant * spec.motor.emf_shape.quasi_square_factor();
    RunOptions {
        delay: if controller.delay == 0 {
            Delay::None
        } else {
            Delay::OnePeriod
        },
        commutation_threshold: controller.commutation_threshold,
        wait: f64::from(spec.start_periods()) * spec.inverter.t_s,
        ramp: controller.slew_rate.map_or(0.0, |rate| amperes / rate),
        reach: Some(spec.reach() as u16),
        ..RunOptions::new(omega_m, torque / per_ampere)
    }
}
