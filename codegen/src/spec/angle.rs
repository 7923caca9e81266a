//! An angle sensor in place of Hall sensors: how its word becomes the electrical angle.

use super::words::words;
use super::{InverterSpec, RotorSensing, Spec};
use std::f64::consts::TAU;

words! {
    /// What tells the rotor's position.
    pub enum RotorSource {
        "halls" = Halls: "three Hall sensors",
        "angle" = Angle: "an angle in every sample",
    }
}

words! {
    /// Way in which the sensor's angle changes in forward rotation.
    pub enum AngleDirection {
        "forward" = Forward: "it rises",
        "backward" = Backward: "it falls",
    }
}

/// An angle sensor: encoder, resolver, or an observer of the firmware's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleSensor {
    /// Electrical turns in a turn of its word; negative where that falls in forward rotation.
    pub turns: i32,
    /// Electrical angle at word 0, degrees.
    pub offset_deg: f64,
    /// Bits of the word that it resolves.
    pub bits: u32,
}

/// The filter lets a step of the sensor change the speed by no more than this share of the rated one.
const STEP_SHARE: f64 = 0.002;

/// Greatest base-2 logarithm of the filter's time constant in periods: a slower filter would tell the speed of a
/// rotor late that speeds up.
const SLOWEST_FILTER: u32 = 6;

/// Greatest angle per period over that at the fastest speed.
const SPARE: f64 = 1.25;

/// A twelfth of a turn.
const TWELFTH: f64 = 357_913_941.0;

impl AngleSensor {
    /// The electrical angle at word 0 as a wrapped word, 2^32 a turn.
    pub fn offset(self) -> u32 {
        (self.offset_deg / 360.0 * 32_f64.exp2()).round() as i64 as u32
    }

    /// Electrical angle of its least step, 2^32 a turn.
    pub fn step(self) -> f64 {
        f64::from(self.turns.unsigned_abs()) * (32.0 - f64::from(self.bits)).exp2()
    }

    /// Base-2 logarithm of the time constant, in periods, of the filter behind the differences of its angles, given
    /// the electrical turns in a period at rated speed.
    pub fn speed_filter(self, rated_turns: f64) -> u32 {
        let allowed = STEP_SHARE * rated_turns * 32_f64.exp2();
        let periods = (self.step() / allowed).max(1.0);
        (periods.log2().ceil() as u32).clamp(1, SLOWEST_FILTER)
    }

    /// Time constant of that filter at a control period of `t_s`, second; `frequency`: electrical turns in a second at
    /// rated speed.
    pub fn filter_time(self, frequency: f64, t_s: f64) -> f64 {
        f64::from(self.speed_filter(frequency * t_s)).exp2() * t_s
    }
}

impl Spec {
    /// The angle sensor, if there is one.
    pub fn angle_sensor(&self) -> Option<AngleSensor> {
        match self.inverter.rotor_sensing {
            RotorSensing::Angle(sensor) => Some(sensor),
            RotorSensing::SampledHalls | RotorSensing::TimedHalls { .. } => None,
        }
    }

    /// Electrical angle per control period at a mechanical speed, 2^32 a turn.
    fn turn_at(&self, omega_m: f64) -> f64 {
        omega_m * f64::from(self.motor.pole_pairs) * self.inverter.t_s / TAU * 32_f64.exp2()
    }

    /// Base-2 logarithm of the time constant, in periods, of the filter behind the differences of a sensor's angles.
    pub fn speed_filter(&self, sensor: AngleSensor) -> u32 {
        sensor.speed_filter(self.turn_at(self.motor.rated_speed) / 32_f64.exp2())
    }

    /// Greatest difference of two angles in a row that is believed, 2^32 a turn: that at the maximum speed, or at the
    /// over-speed if that is more, a quarter more, and a step of the sensor, at most 30 degrees. The checks keep both
    /// speeds a quarter below these.
    pub fn greatest_turn(&self, sensor: AngleSensor) -> i32 {
        let InverterSpec {
            maximum_speed,
            over_speed,
            ..
        } = self.inverter;
        let fastest = over_speed.map_or(maximum_speed, |speed| speed.max(maximum_speed));
        let turn = SPARE * self.turn_at(fastest) + sensor.step();
        turn.min(TWELFTH).ceil() as i32
    }

    /// Electrical angle per control period above which the drive trips, 2^32 a turn.
    pub fn over_speed_step(&self) -> Option<i32> {
        let step = self.turn_at(self.inverter.over_speed?);
        // Decimal units may round a whole number.
        Some((step + 1e-6).floor() as i32)
    }
}
