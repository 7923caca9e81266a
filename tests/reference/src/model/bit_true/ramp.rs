//! Ramp of the speed set-point (section "Acceleration limit").

use super::scale::Scale;
use super::slew::approached;
use super::state::State;
use crate::exact::{Word, floor_weighted, pow2, round_half_up};
use crate::{Error, Spec};
use std::f64::consts::TAU;

/// Fraction bits of a speed.
const SPEED_BITS: i32 = 32;

/// Constants of the ramp.
#[derive(Clone, Copy, Debug)]
pub struct Ramp {
    /// Greatest change in a period, words of the set-point in force.
    step: f64,
    /// 2^n.
    from_speed: f64,
    /// Mechanical rad/s per word of the set-point in force.
    pub unit: f64,
}

impl Ramp {
    /// `None` without an acceleration limit.
    pub fn new(spec: &Spec, scale: &Scale) -> Result<Option<Self>, Error> {
        let (inverter, limit) = (&spec.inverter, spec.loop_options().acceleration_limit);
        if limit == 0.0 {
            return Ok(None);
        }
        let tick = inverter.t_s / inverter.ticks;
        let speed = TAU / (pow2(SPEED_BITS) * tick * f64::from(spec.motor.pole_pairs));
        let from_speed = pow2(scale.signed_bits("speed_in_force")? - SPEED_BITS);
        let measured = match inverter.angle_turns {
            None => ((pow2(SPEED_BITS) - 1.0) / f64::from(inverter.rev_min)).floor(),
            Some(_) => f64::from(inverter.turn_max),
        };
        let fastest = measured.max((inverter.omega_max / speed).ceil() + 1.0);
        let unit = speed / from_speed;
        let step = round_half_up(limit * inverter.t_s / unit);
        Ok(Some(Self {
            step: step.clamp(1.0, 2.0 * fastest * from_speed),
            from_speed,
            unit,
        }))
    }

    /// The speed that is wanted in the step, and the set-point in force.
    #[inline]
    pub fn follow<W: Word>(&self, reference: W, speed: W, state: &State<W>) -> (W, W) {
        let before = if state.ramp_begun < state.timing.ramp_known() {
            speed * self.from_speed
        } else {
            state.speed_in_force
        };
        let followed = approached(reference * self.from_speed, before, self.step);
        (floor_weighted(followed, 1.0 / self.from_speed), followed)
    }
}
