//! PHCC: the predicted error's components against their bands, and the vector that a table has for both wishes.

use super::whole::{self, Sixth};
use super::{Decision, Inputs};
use crate::exact::{Coefficient, both, round_half_up, word};
use crate::model::Reach;
use crate::model::bit_true::constants::Scale;
use crate::model::switching::{self, Switching};
use crate::model::trace::Past;

use crate::{Candidates, Error, Spec};

#[derive(Clone, Debug)]
pub struct Phcc {
    delayed: bool,
    holds: bool,
    /// Vectors of pairs are allowed, which turn legs off.
    pairs: bool,
    k_hold: Coefficient,
    /// Of the present current in this prediction and in the next, the EMF held.
    k_now: Coefficient,
    k_past: Coefficient,
    sixth: Sixth,
    /// BAND_A, BAND_B.
    bands: [f64; 2],
    switching: Switching,
}

impl Phcc {
    pub fn new(spec: &Spec, options: &crate::Phcc, scale: &Scale) -> Result<Self, Error> {
        let (a, b) = (scale.phase.a, scale.phase.b);
        let delayed = scale.variant.delayed();
        let holds = scale.variant.holds();
        let held = if delayed { a } else { 1.0 };
        let band = options.band / b / scale.w * scale.two_v;
        Ok(Self {
            delayed,
            holds,
            pairs: options.candidates != Candidates::ThreePhase,
            k_hold: scale.only_if(!holds, "k_hold", scale.ohm * held / b)?,
            k_now: scale.only_if(holds, "k_now", -scale.ohm * (1.0 + a) / b)?,
            k_past: scale.only_if(holds, "k_past", scale.ohm * a / b)?,
            sixth: Sixth::new(scale)?,
            bands: [band, 3f64.sqrt() * band].map(round_half_up),
            switching: Switching::new(spec, options)?,
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs) -> Decision {
        // 9
        let q = both(|x| {
            if self.holds {
                return now.j[x] + now.past.due[x] + self.k_now.mul(now.i[x]);
            }
            let held = now.j[x] - self.k_hold.mul(now.i[x]);
            if self.delayed {
                held - (now.v_now[x] - now.e_now[x])
            } else {
                held
            }
        });
        // 10; sqrt(3) times the component across a is b less c, c being minus the sum of a and b.
        let [band_a, band_b] = self.bands;
        let rises = [
            q[0] + now.hysteresis[0] >= 0.0,
            2.0 * q[1] + q[0] + now.hysteresis[1] >= 0.0,
        ];
        let memory = |rises, band: f64| word(if rises { band } else { -band - 1.0 });
        let set = switching::Set::of(now.direction, now.set_point);
        let vector = self
            .switching
            .vector(set, now.sector_eff, now.commutating, rises);
        // 11, 12
        let u = self.sixth.voltage(now, vector);
        let past = if self.holds {
            Past {
                due: both(|x| now.past.later[x] - u[x] + self.k_past.mul(now.i[x])),
                later: u,
            }
        } else {
            now.past
        };
        Decision {
            u_unsat: q,
            u,
            reach: Reach::Inside,
            vector,
            command: whole::command(now, vector, self.pairs),
            integral: now.integral,
            hysteresis: [memory(rises[0], band_a), memory(rises[1], band_b)],
            past,
        }
    }
}
