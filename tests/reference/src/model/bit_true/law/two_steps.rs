//! The choice of FCS-MPC over two periods: every sequence of two vectors (section 10h).

use super::Inputs;
use super::scores::{Choice, score_by_reach};
use crate::exact::{Coefficient, Word, word};
use crate::model::bit_true::scale::Scale;
use crate::model::vectors;
use crate::{Candidates, Error};

#[derive(Clone, Debug)]
pub struct TwoSteps<W> {
    pole: Coefficient<W>,
    first: Coefficient<W>,
    pole_sixth: Coefficient<W>,
}

impl<W: Word> TwoSteps<W> {
    /// `None` for a horizon of one period.
    pub fn new(options: &crate::FcsMpc, scale: &Scale) -> Result<Option<Self>, Error> {
        if options.horizon != 2 {
            return Ok(None);
        }
        let a = scale.phase.a;
        Ok(Some(Self {
            pole: scale.coefficient("k_pole", a)?,
            first: scale.coefficient("k_first", 1.0 + a * a)?,
            pole_sixth: scale.coefficient("k_pole_sixth", a / 6.0)?,
        }))
    }

    /// The first vector of the best sequence.
    pub fn choose(&self, candidates: Candidates, choice: &Choice<W>, now: &Inputs<W>) -> usize {
        let (v, u) = (choice.v, choice.u);
        let abc = |x: [W; 2]| [x[0], x[1], -(x[0] + x[1])];
        let y = [0, 1].map(|x| now.j[x] + now.e[x] + self.pole.mul(u[x] - now.j[x]));
        let z = abc([0, 1].map(|x| u[x] + self.pole.mul(y[x])));
        let y = abc(y);
        let first = self.first.mul(v);
        let sixth = self.pole_sixth.mul(v);
        let list = || {
            let (zero, others) = vectors::candidates(candidates, now.commutating, now.sector_eff);
            std::iter::once(zero).chain(others)
        };
        let (mut chosen, mut least) = (0, word(f64::INFINITY));
        for one in list() {
            let moved = vectors::sixths(one);
            let left = [0, 1, 2].map(|x| y[x] - sixth * moved[x]);
            let own = score_by_reach(first, &z, one);
            for two in list() {
                let score = own + score_by_reach(v, &left, two);
                if score < least {
                    (chosen, least) = (one, score);
                }
            }
        }
        chosen
    }
}
