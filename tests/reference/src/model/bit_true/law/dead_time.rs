//! Shifts of the compare values to compensate the dead time (section 11).

use super::Inputs;
use crate::exact::{Coefficient, Word, both, halve, round_half_up, within};
use crate::model::bit_true::scale::Scale;
use crate::model::variant::reference_gain;
use crate::{Error, Spec};

/// Fraction of the largest set-point over which the shift grows in proportion to the current.
const SOFT_BAND: f64 = 0.1;

/// Coefficient and limit; zero without compensation.
#[derive(Clone, Debug)]
pub struct DeadTime<W> {
    k_dead: Coefficient<W>,
    /// 0 unless three legs are pulsed in every period.
    k_quiet: Coefficient<W>,
    limit: f64,
    delayed: bool,
}

impl<W: Word> DeadTime<W> {
    /// `three`: whether three legs are pulsed in every period.
    pub fn new(spec: &Spec, three: bool, scale: &Scale) -> Result<Self, Error> {
        let inverter = &spec.inverter;
        let lost = inverter.dead_time / inverter.pwm_period();
        let stiffness = reference_gain(spec);
        let slope = lost * inverter.v_bus / (2.0 * stiffness * SOFT_BAND * inverter.max_current);
        let quiet = stiffness * inverter.pwm_period() / (12.0 * spec.motor.inductance);
        let limit = round_half_up(lost * f64::from(inverter.timer_period) * scale.two_v);
        let compensated = scale.variant.compensates();
        Ok(Self {
            k_dead: scale.only_if(compensated, "k_dead", slope)?,
            k_quiet: scale.only_if(compensated && three, "k_quiet", quiet)?,
            delayed: spec.loop_options().delay == 1,
            limit: if compensated { limit } else { 0.0 },
        })
    }

    /// Shifts of legs a, b, c; `held` is the measured current as a voltage, phases a, b, and `spread`
    /// that of the limited voltages.
    #[inline]
    pub fn shifts(&self, now: &Inputs<W>, held: [W; 2], spread: W) -> [W; 3] {
        let [a, b] = both(|x| {
            let sum = now.j[x] + held[x];
            if self.delayed {
                now.j[x] + halve(sum)
            } else {
                sum
            }
        });
        let quiet = self.k_quiet.mul(spread);
        [a, b, -(a + b)].map(|flow| {
            let driven = flow - within(flow, -quiet, quiet);
            within(self.k_dead.mul(driven), -self.limit, self.limit)
        })
    }
}
