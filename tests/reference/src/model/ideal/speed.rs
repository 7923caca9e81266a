//! The speed controller (section "Speed loop"), in physical units.

use crate::Spec;
use std::f64::consts::TAU;

/// Constants of the controller.
#[derive(Clone, Copy, Debug)]
pub struct SpeedLoop {
    /// Ampere per rad/s, mechanical.
    gain: f64,
    /// Share that a period integrates.
    share: f64,
    /// Mechanical rad/s per electrical radian a tick.
    per_tick: f64,
    greatest: f64,
    max_current: f64,
}

impl SpeedLoop {
    /// `None` without a speed loop.
    pub fn new(spec: &Spec) -> Option<Self> {
        let (motor, inverter, options) = (&spec.motor, &spec.inverter, spec.loop_options());
        let bandwidth = TAU * options.speed_bandwidth;
        options.has_speed_loop().then(|| Self {
            gain: bandwidth * options.inertia / motor.torque_constant,
            share: bandwidth * inverter.t_s / 4.0,
            per_tick: inverter.ticks / inverter.t_s / f64::from(motor.pole_pairs),
            greatest: inverter.omega_max,
            max_current: inverter.max_current,
        })
    }

    /// The speed within the limits, mechanical rad/s.
    pub fn allowed(&self, speed: f64) -> f64 {
        speed.clamp(-self.greatest, self.greatest)
    }

    /// The mechanical speed of an electrical angle per tick, rad/s.
    pub fn speed(&self, angle: f64) -> f64 {
        angle * self.per_tick
    }

    /// The current, within +-`most` and the limits of the bus, and the integral after the step, ampere;
    /// `angle` is the electrical angle per tick.
    pub fn regulate(
        &self,
        (wanted, angle): (f64, f64),
        most: f64,
        [least, greatest]: [f64; 2],
        integral: f64,
    ) -> (f64, f64) {
        let limit = 2.0 * self.max_current;
        let part = (self.gain * (wanted - self.speed(angle))).clamp(-limit, limit);
        let open = part + integral;
        let current = open.clamp(-most.abs(), most.abs());
        let current = current.max(least).min(greatest);
        let moved = integral + self.share * (part + 4.0 * (current - open));
        (current, moved.clamp(-self.max_current, self.max_current))
    }
}
