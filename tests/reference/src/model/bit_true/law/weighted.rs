//! The choice of FCS-MPC with weights in its cost (section 10w).

use super::Inputs;
use super::scores::{Choice, first_least};
use crate::exact::{Coefficient, Word, halve, round_half_up, word};
use crate::model::bit_true::scale::Scale;
use crate::model::vectors;
use crate::{Error, Spec, Switch};

#[derive(Clone, Debug)]
pub struct Weights<W> {
    /// S.
    change: f64,
    k_torque_weight: Option<Coefficient<W>>,
}

impl<W: Word> Weights<W> {
    /// `None` if only the current error is weighted.
    pub fn new(spec: &Spec, options: &crate::FcsMpc, scale: &Scale) -> Result<Option<Self>, Error> {
        let weighs = options.switching_weight + options.torque_weight > 0.0;
        if !weighs || options.modulated == Switch::On {
            return Ok(None);
        }
        let stiffness = options.switching_weight / scale.phase.b;
        let inverter = &spec.inverter;
        let share = f64::from(inverter.largest_compare()?) / f64::from(inverter.timer_period);
        let volts = 9.0 * stiffness * stiffness / (scale.v_bus * share);
        let torque = options.torque_weight > 0.0;
        let k_torque_weight =
            torque.then(|| scale.coefficient("k_torque_weight", 3.0 * options.torque_weight));
        Ok(Some(Self {
            change: round_half_up(volts / scale.w * scale.two_v),
            k_torque_weight: k_torque_weight.transpose()?,
        }))
    }

    /// The vector with the least cost; `exact`: no score of the list is rounded for its off legs.
    pub fn choose(&self, choice: &Choice<W>, now: &Inputs<W>, exact: bool) -> usize {
        let (zero, others) =
            vectors::candidates(choice.law.candidates, now.commutating, now.sector_eff);
        if now.sector_eff == 0 {
            return zero;
        }
        let list = std::iter::once(zero).chain(others.map(vectors::weighted_order));
        if let Some(k_torque_weight) = &self.k_torque_weight {
            return first_least(list, |vector| {
                self.rounded(choice, now, vector) + torque(k_torque_weight, choice, now, vector)
            });
        }
        if exact {
            return first_least(list, |vector| self.by_reach(choice, now, vector));
        }
        // One of each kind, in the list's order.
        let mut kept: Vec<usize> = vec![];
        for vector in list {
            match kept.iter().position(|known| kind(*known) == kind(vector)) {
                None => kept.push(vector),
                Some(place) => {
                    let [known, new] =
                        [kept[place], vector].map(|vector| self.by_reach(choice, now, vector));
                    if new < known {
                        kept[place] = vector;
                    }
                }
            }
        }
        // Pairs by their numbers, after the other vectors.
        kept.sort_by_key(|vector| if kind(*vector) < 3 { *vector } else { 0 });
        first_least(kept.into_iter(), |vector| self.rounded(choice, now, vector))
    }

    /// S n.
    fn changed(&self, now: &Inputs<W>, vector: usize) -> W {
        word::<W>(self.change) * vectors::changes(now.vector_prev, vector)
    }

    /// The score over V, without the contribution of an off leg.
    fn by_reach(&self, choice: &Choice<W>, now: &Inputs<W>, vector: usize) -> W {
        choice.by_reach(vector) + self.changed(now, vector)
    }

    /// The score with rounded products.
    fn rounded(&self, choice: &Choice<W>, now: &Inputs<W>, vector: usize) -> W {
        let along = self.by_reach(choice, now, vector);
        choice.rounded(vector, along)
    }
}

/// 0 to 2 pairs by their off leg, 3 vectors of three legs, 4 a pair's zero.
fn kind(vector: usize) -> usize {
    match (vectors::off_leg(vector), vector) {
        (Some(off), ..vectors::FIRST_PAIR_ZERO) => off,
        (None, _) => 3,
        _ => 4,
    }
}

/// Cost of the torque's error.
fn torque<W: Word>(
    weight: &Coefficient<W>,
    choice: &Choice<W>,
    now: &Inputs<W>,
    vector: usize,
) -> W {
    let v = choice.v;
    let terminal = |x: usize| match vectors::LEGS[vector][x] {
        1 => v,
        -1 => word(0.0),
        _ if vector >= vectors::FIRST_PAIR_ZERO => {
            if choice.law.floating {
                choice.off_terminal(x, word(0.0))
            } else {
                word(0.0)
            }
        }
        _ if choice.law.floating => choice.off_terminal(x, halve(v)),
        _ => halve(v),
    };
    let (x, y) = vectors::pair_of(now.sector_eff);
    let line = terminal(x) - terminal(y);
    let beside = weight.mul(line - (choice.u[x] - choice.u[y]) * 2.0);
    choice.law.score.floor_product(line, beside)
}
