//! The set-point in force (section "Slew rate").

use super::constants::Constants;
use super::scale::Scale;
use crate::exact::{Word, floor_weighted, greater, lesser, pow2, round_half_up, word};
use crate::model::variant::reference_gain;
use crate::{Error, Spec};

/// Constants of the slew rate.
#[derive(Clone, Copy, Debug)]
pub struct Slew {
    /// Greatest change in a period, words of the set-point in force.
    step: f64,
    /// 2^n.
    from_voltage: f64,
    /// Ampere per word of the set-point in force.
    pub ampere: f64,
}

impl Slew {
    /// `None` without a slew rate.
    pub fn new<W: Word>(
        spec: &Spec,
        scale: &Scale,
        k: &Constants<W>,
    ) -> Result<Option<Self>, Error> {
        let rate = spec.loop_options().slew_rate;
        if rate == 0.0 {
            return Ok(None);
        }
        let from_voltage = pow2(scale.extra_bits("j_in_force")?);
        let stiffness = reference_gain(spec);
        let words = stiffness / scale.w * scale.two_v * from_voltage;
        let top: W = k.k_set.mul(word(k.i_max_bits));
        let most = 2.0 * f64::from(top.to_i32()) * from_voltage;
        Ok(Some(Self {
            step: round_half_up(rate * spec.inverter.t_s * words).clamp(1.0, most),
            from_voltage,
            ampere: 1.0 / words,
        }))
    }

    /// The set-point of the step, and the set-point in force.
    #[inline]
    pub fn follow<W: Word>(&self, j: W, in_force: W) -> (W, W) {
        let goal = j * self.from_voltage;
        let followed = approached(goal, in_force, self.step);
        (floor_weighted(followed, 1.0 / self.from_voltage), followed)
    }
}

/// A word that approaches a goal by at most a step.
#[inline]
pub fn approached<W: Word>(goal: W, before: W, step: f64) -> W {
    lesser(greater(goal, before - step), before + step)
}
