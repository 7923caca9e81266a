//! PHCC: the predicted error's components against their bands, and the vector of a table for both
//! directions.

use super::whole::Whole;
use super::{Decision, Inputs};
use crate::exact::{Coefficient, Word, both, floor_shift, round_half_up, word};
use crate::model::Reach;
use crate::model::bit_true::scale::Scale;
use crate::model::switching::{self, Switching};
use crate::model::trace::Past;

use crate::{Candidates, Error, Spec};

/// Storage of the axes' memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Memory {
    /// `h_a`, `h_b`.
    Words,
    /// In the contributions of past periods.
    Due,
}

#[derive(Clone, Debug)]
pub struct Phcc<W> {
    delayed: bool,
    holds: bool,
    memory: Memory,
    /// Vectors of pairs are allowed, which turn legs off.
    pairs: bool,
    k_hold: Coefficient<W>,
    /// Of the present current in this prediction and in the next, with a held EMF.
    k_now: Coefficient<W>,
    k_past: Coefficient<W>,
    whole: Whole<W>,
    /// BAND_A, BAND_B.
    bands: [f64; 2],
    switching: Switching,
}

impl<W: Word> Phcc<W> {
    pub fn new(spec: &Spec, options: &crate::Phcc, scale: &Scale) -> Result<Self, Error> {
        let (a, b) = (scale.phase.a, scale.phase.b);
        let delayed = scale.variant.delayed();
        let holds = scale.variant.holds();
        let held = if delayed { a } else { 1.0 };
        let band = options.band / b / scale.w * scale.two_v;
        Ok(Self {
            delayed,
            holds,
            memory: if scale.variant.folds_wishes() {
                Memory::Due
            } else {
                Memory::Words
            },
            pairs: options.candidates != Candidates::ThreePhase,
            k_hold: scale.only_if(!holds, "k_hold", scale.ohm * held / b)?,
            k_now: scale.only_if(holds, "k_now", -scale.ohm * (1.0 + a) / b)?,
            k_past: scale.only_if(holds, "k_past", scale.ohm * a / b)?,
            whole: Whole::new(spec, scale)?,
            bands: [band, 3f64.sqrt() * band].map(round_half_up),
            switching: Switching::new(spec, options)?,
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs<W>) -> Decision<W> {
        // 9
        let q = both(|x| {
            if self.holds {
                return now.j[x] + now.past.due[x] + self.k_now.mul(now.i[x]);
            }
            let held = now.j[x] - self.k_hold.mul(now.i[x]);
            if self.delayed {
                held - now.net[x]
            } else {
                held
            }
        });
        // 10; sqrt(3) times the component across a is b less c, c being minus the sum of a and b.
        let [band_a, band_b] = self.bands;
        let [h_a, h_b] = match self.memory {
            Memory::Words => now.hysteresis,
            Memory::Due => [word(0.0); 2],
        };
        let lifted = [q[0] + h_a, q[1] * 2.0 + q[0] + h_b];
        let rises = lifted.map(|error| error >= 0.0);
        let memory = |rises, band: f64| word(if rises { band } else { -band - 1.0 });
        let hysteresis = [memory(rises[0], band_a), memory(rises[1], band_b)];
        let folded = |hysteresis| match self.memory {
            Memory::Words => [word(0.0); 2],
            Memory::Due => in_due(hysteresis),
        };
        let set = switching::Set::of(now.direction, now.set_point);
        let vector = self
            .switching
            .vector(set, now.sector_eff, now.commutating, rises);
        // 11, 12
        let u = self.whole.voltage(now, vector);
        let past = if self.holds {
            let left = folded(hysteresis);
            Past {
                due: both(|x| now.past.later[x] - u[x] + self.k_past.mul(now.i[x]) + left[x]),
                later: u,
            }
        } else {
            now.past
        };
        let before = folded(now.hysteresis);
        Decision {
            u_unsat: both(|x| q[x] - before[x]),
            u,
            reach: Reach::Inside,
            vector,
            command: self.whole.command(now, vector, self.pairs),
            integral: now.integral,
            hysteresis,
            past,
        }
    }
}

/// Contribution of the axes' memory to the words of past periods, phases a and b (section 12).
#[inline]
pub fn in_due<W: Word>([h_a, h_b]: [W; 2]) -> [W; 2] {
    let falls: W = word(if h_b < 0.0 { 1.0 } else { 0.0 });
    [h_a, floor_shift(h_b - h_a + falls, 1)]
}
