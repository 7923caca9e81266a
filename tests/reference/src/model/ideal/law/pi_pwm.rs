//! PI control: proportional share, integral and fed-forward EMF, limited and pulsed.

use super::dead_time::DeadTime;
use super::{Decision, Inputs, pulses};
use crate::model::ideal::limit;
use crate::model::ideal::vector::{clarke, phases, to_ab};
use crate::model::variant::reference_gain;
use crate::{Error, Saturation, Spec};

#[derive(Clone, Copy, Debug)]
pub struct PiPwm {
    saturation: Saturation,
    /// Proportional gain, V/A.
    k_p: f64,
    /// Share of the proportional voltage that is integrated per period.
    k_i: f64,
    /// Largest integral, volt.
    integral_max: f64,
    dead_time: DeadTime,
}

impl PiPwm {
    pub fn new(spec: &Spec, options: &crate::PiPwm) -> Result<Self, Error> {
        Ok(Self {
            saturation: options.saturation,
            k_p: reference_gain(spec),
            k_i: spec.inverter.t_s / options.integral_time,
            dead_time: DeadTime::new(spec),
            integral_max: spec.inverter.v_bus_max()?,
        })
    }

    pub fn decide(&self, now: &Inputs) -> Decision {
        let p = (now.i_ref - now.i) * self.k_p;
        let u_unsat = p + now.integral + now.e;
        let limited = limit::limit(
            self.saturation,
            &phases(&u_unsat),
            &phases(&now.e),
            now.v_bus,
        );
        let u = clarke(&limited.u);
        let integral = now.integral + (p + u - u_unsat) * self.k_i;
        Decision {
            u_unsat,
            u,
            reach: limited.reach,
            vector: 0,
            command: pulses::three(now, &limited.u, &self.dead_time.shifts(now, 1.0)),
            integral: to_ab(&integral).map(|s_x| s_x.clamp(-self.integral_max, self.integral_max)),
            rises: now.rises,
        }
    }
}
