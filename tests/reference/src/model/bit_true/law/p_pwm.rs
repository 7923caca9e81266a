//! Proportional control: proportional part and EMF feed-forward, limited and pulsed.

use super::common_mode::CommonModeRule;
use super::{Decision, Inputs, pulses};
use crate::exact::{Coefficient, Word, both, word};
use crate::model::bit_true::constants::Scale;
use crate::model::bit_true::limit::{self, Limited};
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
        let limited = limit::limit(
            self.saturation,
            now.k,
            self.common_mode.reach(now.v_bus),
            u_unsat,
            now.e,
        );
        let Limited { u, legs, reach } = self.common_mode.readable(now.k, now.v_bus, &limited);
        Decision {
            u_unsat,
            u,
            reach,
            vector: 0,
            command: pulses::three(now, legs, [word(0.0); 3], &self.common_mode, false),
            integral: now.integral,
            hysteresis: now.hysteresis,
            past: now.past,
        }
    }
}
