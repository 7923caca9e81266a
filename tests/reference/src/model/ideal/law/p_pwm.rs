//! Proportional control: proportional part and EMF feed-forward, limited and pulsed.

use super::common_mode::CommonModeRule;
use super::{Decision, Inputs, pulses};
use crate::model::ideal::limit;
use crate::model::ideal::vector::{clarke, phases, to_ab};
use crate::model::variant::reference_gain;
use crate::{Error, Saturation, Spec};

#[derive(Clone, Copy, Debug)]
pub struct PPwm {
    saturation: Saturation,
    /// Proportional gain, V/A.
    k_p: f64,
    common_mode: CommonModeRule,
}

impl PPwm {
    pub fn new(spec: &Spec, options: &crate::PPwm) -> Result<Self, Error> {
        Ok(Self {
            saturation: options.saturation,
            k_p: reference_gain(spec),
            common_mode: CommonModeRule::new(spec, options.common_mode)?,
        })
    }

    pub fn decide(&self, now: &Inputs) -> Decision {
        let u_unsat = (now.i_ref - now.i) * self.k_p + now.e;
        let limited = limit::limit(
            self.saturation,
            &phases(&u_unsat),
            &phases(&now.e),
            self.common_mode.reach(now.v_bus),
        );
        let legs = self.common_mode.readable(&limited.u, now.v_bus);
        Decision {
            u_unsat,
            u: clarke(&legs),
            reach: limited.reach,
            vector: 0,
            command: pulses::three(now, &legs, &[0.0; 3].into(), self.common_mode),
            integral: to_ab(&now.integral),
            rises: now.rises,
            past: now.past,
        }
    }
}
