//! FCS-MPC: the candidate nearest to the deadbeat voltage, by scores tried one after the other.

use super::scores::{Choice, Scores};
use super::two_steps::TwoSteps;
use super::weighted::Weights;
use super::{Decision, Inputs};
use crate::exact::Word;
use crate::model::bit_true::scale::Scale;
use crate::model::vectors;
use crate::{Error, Spec, Switch};

#[derive(Clone, Debug)]
pub struct FcsMpc<W> {
    scores: Scores<W>,
    /// A second vector shares the period.
    modulated: bool,
    weights: Option<Weights<W>>,
    two_steps: Option<TwoSteps<W>>,
}

impl<W: Word> FcsMpc<W> {
    pub fn new(spec: &Spec, options: &crate::FcsMpc, scale: &Scale) -> Result<Self, Error> {
        Ok(Self {
            scores: Scores::new(spec, options, scale)?,
            modulated: options.modulated == Switch::On,
            weights: Weights::new(spec, options, scale)?,
            two_steps: TwoSteps::new(options, scale)?,
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs<W>) -> Decision<W> {
        // 9
        let Scores {
            candidates,
            floating,
            form,
            ..
        } = &self.scores;
        let u_unsat = form.voltage(now);
        // 10
        let (zero, others) = vectors::candidates(*candidates, now.commutating, now.sector_eff);
        let exact = !floating || (zero == 0 && others.end <= vectors::FIRST_PAIR);
        let choice = Choice::new(&self.scores, now, u_unsat);
        if let Some(two_steps) = &self.two_steps {
            let vector = two_steps.choose(*candidates, &choice, now);
            return choice.apply(now, vector);
        }
        if let Some(weights) = &self.weights {
            let vector = weights.choose(&choice, now, exact);
            return choice.apply(now, vector);
        }
        let (mut vector, mut least) = (zero, choice.score(zero, exact));
        let has_off_leg = |vector: usize| vectors::off_leg(vector).is_some();
        for other in others {
            let score = choice.score(other, exact);
            let is_less = if exact || has_off_leg(other) || has_off_leg(vector) {
                score < least
            } else {
                // Three-phase vectors are distinguished by their exact scores, whatever the
                // products lose.
                choice.score(other, true) < choice.score(vector, true)
            };
            if is_less {
                (vector, least) = (other, score);
            }
        }
        if self.modulated {
            return choice.divide(now, vector);
        }
        choice.apply(now, vector)
    }
}
