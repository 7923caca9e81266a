//! Residual watch (section "Residual watch").

use super::scale::Scale;
use super::state::State;
use crate::exact::{Coefficient, Word, greater, pow2, round_half_up, within, word};
use crate::model::variant::{allowed_residual, reference_gain};
use crate::{Error, Spec};

/// Constants of the watch.
#[derive(Clone, Debug)]
pub struct ResidualWatch<W> {
    per_set_point: Coefficient<W>,
    per_angle: Coefficient<W>,
    least: f64,
    unseen: f64,
    /// Count at which the drive trips.
    periods: f64,
}

impl<W: Word> ResidualWatch<W> {
    /// `None` without a `residual_timeout`.
    pub fn new(spec: &Spec, scale: &Scale) -> Result<Option<Self>, Error> {
        let periods = spec.loop_options().residual_periods;
        if periods == 0 {
            return Ok(None);
        }
        let [least, per_ampere, per_speed, unseen] = allowed_residual(spec);
        let words = |volts: f64| volts / scale.w * scale.two_v;
        let per_set_point = per_ampere / reference_gain(spec);
        let speed = std::f64::consts::TAU / pow2(32) / spec.inverter.t_s;
        Ok(Some(Self {
            per_set_point: scale.coefficient("k_residual_j", per_set_point)?,
            per_angle: scale.coefficient("k_residual_w", words(per_speed) * speed)?,
            least: round_half_up(words(least)),
            unseen: round_half_up(words(unseen)),
            periods: periods.into(),
        }))
    }

    /// Whether the count has reached its end.
    #[inline]
    pub fn is_over(&self, count: W) -> bool {
        count >= self.periods
    }

    /// The count after a period with this residual of phases a, b; the EMF's error is that after it.
    #[inline]
    pub fn count(
        &self,
        state: &State<W>,
        residual: [W; 2],
        [q, d]: [W; 2],
        (j, step_angle): (W, W),
    ) -> W {
        let [a, b] = residual.map(W::abs);
        let learnt = greater(q.abs(), d.abs() * 2.0);
        let (seen, by_speed) = if state.timing.edges >= 2 {
            (learnt, self.per_angle.mul(step_angle.abs()))
        } else {
            (greater(a, b) - learnt, word(self.unseen))
        };
        let allowed = self.per_set_point.mul(j.abs()) + by_speed + self.least;
        let step = if seen > allowed { 1.0 } else { -1.0 };
        within(state.residual_count + word::<W>(step), 0.0, self.periods)
    }
}
