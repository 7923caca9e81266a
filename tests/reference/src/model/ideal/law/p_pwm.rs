//! Proportional control: proportional part and EMF feed-forward, limited and pulsed.

use super::common_mode::CommonModeRule;
use super::{Decision, Inputs, pulses};
use crate::model::ideal::vector::{clarke, to_ab};
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
        let rule = self.common_mode;
        let limited = rule.limited(now, self.saturation, &u_unsat, &now.e);
        Decision {
            u_unsat,
            u: clarke(&limited.u),
            reach: limited.reach,
            vector: 0,
            command: pulses::three(now, &limited.u, &[0.0; 3].into(), rule),
            integral: to_ab(&now.integral),
            rises: now.rises,
            past: now.past,
        }
    }
}
