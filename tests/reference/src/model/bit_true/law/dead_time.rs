//! Shifts of the compare values to compensate the dead time (section 11).

use super::Inputs;
use crate::exact::{Coefficient, Word, round_half_up, within};
use crate::model::bit_true::scale::Scale;
use crate::model::variant::reference_gain;
use crate::{Error, Spec};

/// Fraction of the largest set-point up to which the shift is proportional to the current.
const SOFT_BAND: f64 = 0.1;

/// Coefficient and limit; zero without compensation.
#[derive(Clone, Debug)]
pub struct DeadTime<W> {
    k_dead: Coefficient<W>,
    limit: f64,
}

impl<W: Word> DeadTime<W> {
    pub fn new(spec: &Spec, scale: &Scale) -> Result<Self, Error> {
        let inverter = &spec.inverter;
        let lost = inverter.dead_time / inverter.pwm_period();
        let slope =
            lost * inverter.v_bus / (2.0 * reference_gain(spec) * SOFT_BAND * inverter.max_current);
        let limit = round_half_up(lost * f64::from(inverter.timer_period) * scale.two_v);
        let compensated = scale.variant.compensates();
        Ok(Self {
            k_dead: scale.only_if(compensated, "k_dead", slope)?,
            limit: if compensated { limit } else { 0.0 },
        })
    }

    /// Shifts of legs a, b, c; `held` is the measured current as a voltage, phases a, b.
    #[inline]
    pub fn shifts(&self, now: &Inputs<W>, held: [W; 2]) -> [W; 3] {
        let [a, b] = [now.j[0] + held[0], now.j[1] + held[1]];
        [a, b, -(a + b)].map(|flow| within(self.k_dead.mul(flow), -self.limit, self.limit))
    }
}
