//! PHCC: the predicted error's components against their bands, and the vector of a table for both
//! directions.

use super::whole::Whole;
use super::{Decision, Inputs, deadbeat, held};
use crate::model::Reach;
use crate::model::ideal::vector::to_ab;
use crate::model::switching::{self, Switching};

use crate::{Candidates, Error, Spec};

#[derive(Clone, Debug)]
pub struct Phcc {
    /// Ampere.
    band: f64,
    /// Vectors of pairs are allowed, which turn legs off.
    pairs: bool,
    whole: Whole,
    switching: Switching,
}

impl Phcc {
    pub fn new(spec: &Spec, options: &crate::Phcc) -> Result<Self, Error> {
        Ok(Self {
            band: options.band,
            pairs: options.candidates != Candidates::ThreePhase,
            whole: Whole::new(spec)?,
            switching: Switching::new(spec, options)?,
        })
    }

    pub fn decide(&self, now: &Inputs) -> Decision {
        let error = if now.emf_is_held {
            held::deviation(now)
        } else {
            now.i_ref - deadbeat::current_then(now)
        };
        // By the error outside of the band, as before within it; by its sign without a before.
        let rises = [0, 1].map(|axis| match now.rises[axis] {
            Some(true) => error[axis] >= -self.band,
            Some(false) => error[axis] > self.band,
            None => error[axis] >= 0.0,
        });
        let set = switching::Set::of(now.direction, now.set_point);
        let vector = self
            .switching
            .vector(set, now.sector_eff, now.commutating, rises);
        let u = self.whole.voltage(now, vector);
        Decision {
            u_unsat: error / now.phase.b,
            u,
            reach: Reach::Inside,
            vector,
            command: self.whole.command(now, vector, self.pairs),
            integral: to_ab(&now.integral),
            rises: rises.map(Some),
            past: if now.emf_is_held {
                held::past_of_prediction(now, &u)
            } else {
                now.past
            },
        }
    }
}
