//! The deadbeat voltage with the EMF of the last period held, its terms collected by age (section
//! 9, `emf: held`).

use super::Inputs;
use crate::Error;
use crate::exact::{Coefficient, Word, both, within, word};
use crate::model::bit_true::scale::Scale;
use crate::model::trace::Past;

#[derive(Clone, Debug)]
pub struct Held<W> {
    delayed: bool,
    now: Coefficient<W>,
    past: Coefficient<W>,
    fade: Coefficient<W>,
    /// Whether the law uses the EMF.
    asked: bool,
    due: Coefficient<W>,
    later: Coefficient<W>,
    di: Coefficient<W>,
    /// Only dead-time compensation uses the remaining current.
    hold: Coefficient<W>,
}

impl<W: Word> Held<W> {
    /// `asked`: the law uses the EMF.
    pub fn new(asked: bool, scale: &Scale) -> Result<Self, Error> {
        let (a, b) = (scale.phase.a, scale.phase.b);
        let delayed = scale.variant.delayed();
        let (now, past, hold) = if delayed {
            (1.0 + a + a * a, a * (1.0 + a), a * a)
        } else {
            (1.0 + a, a, a)
        };
        let ohm = scale.ohm;
        let unfolds = asked && delayed;
        Ok(Self {
            delayed,
            now: scale.coefficient("k_now", -ohm * now / b)?,
            past: scale.coefficient("k_past", ohm * past / b)?,
            fade: scale.only_if(delayed, "k_fade", -b * scale.resistance)?,
            asked,
            due: scale.only_if(unfolds, "k_due", 1.0 / (1.0 + a))?,
            later: scale.only_if(unfolds, "k_later", a / ((1.0 + a) * (1.0 + a)))?,
            di: scale.only_if(asked, "k_di", ohm / b)?,
            hold: scale.only_if(scale.variant.compensates(), "k_hold", ohm * hold / b)?,
        })
    }

    /// Phases a, b, not limited.
    #[inline]
    pub fn voltage(&self, now: &Inputs<W>) -> [W; 2] {
        both(|x| now.j[x] + now.past.due[x] + self.now.mul(now.i[x]))
    }

    /// The observed EMF of the last period, phases a, b.
    #[inline]
    pub fn emf(&self, now: &Inputs<W>) -> [W; 2] {
        if !self.asked {
            return [word(0.0); 2];
        }
        let limit = now.k.v_largest;
        both(|x| {
            let (due, later) = (now.past.due[x], now.past.later[x]);
            let known = if self.delayed {
                self.due.mul(due) + self.later.mul(later)
            } else {
                due
            };
            within(known - self.di.mul(now.i[x]), -limit, limit)
        })
    }

    /// The part of the measured current left when the voltage takes effect, as a voltage.
    #[inline]
    pub fn kept(&self, now: &Inputs<W>) -> [W; 2] {
        both(|x| self.hold.mul(now.i[x]))
    }

    /// Contributions of this step's current and voltage `u` to the next two.
    #[inline]
    pub fn past(&self, now: &Inputs<W>, u: [W; 2]) -> Past<W> {
        let sampled = both(|x| self.past.mul(now.i[x]));
        if self.delayed {
            let left = both(|x| u[x] + self.fade.mul(u[x]));
            Past {
                due: both(|x| now.past.later[x] - left[x] + sampled[x]),
                later: both(|x| u[x] + left[x]),
            }
        } else {
            Past {
                due: both(|x| u[x] + sampled[x]),
                later: [word(0.0); 2],
            }
        }
    }
}
