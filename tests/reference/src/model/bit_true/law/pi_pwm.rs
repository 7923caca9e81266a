//! PI control: proportional share, integral and fed-forward EMF, limited and pulsed.

use super::dead_time::DeadTime;
use super::{Decision, Inputs, pulses};
use crate::exact::{Coefficient, round_half_up};
use crate::model::bit_true::constants::Scale;
use crate::model::bit_true::limit;
use crate::model::variant::reference_gain;
use crate::{Error, Saturation, Spec};

#[derive(Clone, Debug)]
pub struct PiPwm {
    saturation: Saturation,
    k_p: Coefficient,
    k_i: Coefficient,
    integral_max: f64,
    dead_time: DeadTime,
}

impl PiPwm {
    pub fn new(spec: &Spec, options: &crate::PiPwm, scale: &Scale) -> Result<Self, Error> {
        Ok(Self {
            saturation: options.saturation,
            k_p: scale.coefficient("k_p", scale.ohm * reference_gain(spec))?,
            k_i: scale.coefficient("k_i", spec.inverter.t_s / options.integral_time)?,
            dead_time: DeadTime::new(spec, scale)?,
            integral_max: round_half_up(spec.inverter.v_bus_max()? / scale.w * scale.two_v),
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs) -> Decision {
        // 9; without feed-forward the EMF is 0.
        let held = now.i.map(|i| self.k_p.mul(i));
        let p = [0, 1].map(|x| now.j[x] - held[x]);
        let u_unsat = [0, 1].map(|x| p[x] + now.integral[x] + now.e[x]);
        // 10, 11
        let (u, reach) = limit::limit(self.saturation, now.k, now.v_bus, u_unsat, now.e);
        // 12
        let integral = [0, 1].map(|x| {
            (now.integral[x] + self.k_i.mul(p[x] + u[x] - u_unsat[x]))
                .clamp(-self.integral_max, self.integral_max)
        });
        Decision {
            u_unsat,
            u,
            reach,
            vector: 0,
            command: pulses::three(now, u, self.dead_time.shifts(now, held), false),
            integral,
            rises: now.rises,
        }
    }
}
