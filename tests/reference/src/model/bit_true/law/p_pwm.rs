//! Proportional control: proportional part and EMF feed-forward, limited and pulsed.

use super::common_mode::CommonModeRule;
use super::{Decision, Inputs, pulses};
use crate::exact::{Coefficient, Word, both, word};
use crate::model::bit_true::limit::Limited;
use crate::model::bit_true::scale::Scale;
use crate::model::variant::reference_gain;
use crate::{Error, Saturation, Spec};

#[derive(Clone, Debug)]
pub struct PPwm<W> {
    saturation: Saturation,
    k_drop: Coefficient<W>,
    common_mode: CommonModeRule<W>,
}

impl<W: Word> PPwm<W> {
    pub fn new(spec: &Spec, options: &crate::PPwm, scale: &Scale) -> Result<Self, Error> {
        Ok(Self {
            saturation: options.saturation,
            k_drop: scale.coefficient("k_drop", -scale.ohm * reference_gain(spec))?,
            common_mode: CommonModeRule::new(spec, options.common_mode, scale)?,
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs<W>) -> Decision<W> {
        // 9
        let u_unsat = both(|x| now.j[x] + self.k_drop.mul(now.i[x]) + now.e[x]);
        // 10, 11
        let rule = &self.common_mode;
        let Limited { u, legs, reach, .. } = rule.limited(now, self.saturation, u_unsat, now.e);
        Decision {
            u_unsat,
            u,
            reach,
            vector: 0,
            command: pulses::three(now, legs, [word(0.0); 3], rule, false).0,
            integral: now.integral,
            hysteresis: now.hysteresis,
            past: now.past,
        }
    }
}
