//! The choice with weights in the cost (semantics, step 10w).
//!
//! A switching weight alone keeps the geometric choice: in the three-phase set it gives each leg's
//! sign a hysteresis, and the better of two pair vectors with the same leg off is exact. A torque
//! weight couples the legs, so the vectors are enumerated ([`super::torque`]).

use super::changes::Changes;
use super::choose::nearest_physical;
use super::off_legs::OffLegs;
use super::score::{Candidate, PAIRS, state_score_over_bus, zero_of_pair};
use super::torque::Weighing;
use crate::blocks::Lowering;
use crate::ir::{Expr, Memory, Phases, named};
use crate::laws::current_loop::{CurrentLoop, Front};
use crate::spec::{Candidates, FcsMpcSpec};

impl<'b> CurrentLoop<'_, 'b> {
    /// The allowed vector of least weighted cost.
    pub(super) fn choose_weighted(
        &self,
        options: &FcsMpcSpec,
        front: &Front<'b>,
        u: Phases<'b>,
        memory: Option<Memory<'b>>,
    ) -> Expr<'b> {
        let (l, pair) = (self.l, u);
        let changes = memory.map(|memory| {
            let volts = 9.0 * (self.design.k_di * options.switching_weight).powi(2);
            let high = l.spec.inverter.v_bus * l.spec.reach_share();
            let volts = volts / high;
            Changes::new(l, memory, volts, options.switching_weight)
        });
        let doc = "Third phase of the deadbeat voltage.";
        l.b.stage("third_phase", &[doc]);
        let u = pair.with_c("u_unsat");
        let off_legs = self.predict_off_legs(options, front, pair);
        let off_legs = off_legs.as_ref();
        named! {
            let vector = match changes {
                Some(changes) if options.torque_weight <= 0.0 => {
                    changes.fewest(l, options.candidates, front, u, off_legs)
                }
                changes => {
                    let doc = [
                        "Scores 6 (|v|^2 - 2 u v) of all vectors plus the weighted error along the sector's mean EMF, the line of its pair.",
                        "Each is a sum of products; the least wins, the first on a tie.",
                    ];
                    l.b.stage("weigh_candidates", &doc);
                    let changes = changes.as_ref();
                    Weighing::new(l, options, front, u, off_legs, changes).best(options.candidates)
                }
            };
        }
        vector
    }
}

impl<'b> Changes<'b> {
    /// The geometric choice, with a switching weight only.
    fn fewest(
        &self,
        l: &Lowering<'b>,
        candidates: Candidates,
        front: &Front<'b>,
        u: Phases<'b, 3>,
        off_legs: Option<&OffLegs<'b>>,
    ) -> Expr<'b> {
        let three = self.nearest_by_gains(l, u, front.reach.volts);
        if off_legs.is_none() {
            state_score_over_bus(l, three.score, 1.0);
        }
        let Some(commutation) = front.commutation else {
            return three.vector;
        };
        let rival = (candidates == Candidates::All).then_some(three);
        let pair = match off_legs {
            Some(off_legs) => nearest_physical(l, off_legs, front, u, Some(self), rival),
            None => self.nearest_exact(l, front, u, rival),
        };
        match candidates {
            Candidates::ThreePhase => three.vector,
            Candidates::All => pair,
            Candidates::Table2 => commutation.flag.choose(three.vector, pair),
        }
    }

    /// The best of V0 to V6, with its exact score over the bus.
    fn nearest_by_gains(&self, l: &Lowering<'b>, u: Phases<'b, 3>, bus: Expr<'b>) -> Candidate<'b> {
        l.b.stage(
            "nearest_vector",
            &[
                "The three-phase vector of least cost: a leg is high if twelve times its phase voltage exceeds the cost of high over low.",
                "If all three would be high, the one of the least gain is low. V0 while the gains are at most four times the bus.",
            ],
        );
        named! {
            let gain = Phases::<3>::each(|x| 12 * u.0[x] + (self.0[x][1] - self.0[x][0]));
        }
        let [gain_a, gain_b, gain_c] = gain.0;
        let gates = [0, 1, 2].map(|x| gain.0[x].is_above(0).choose(1 << x, 0));
        named! {
            let gates_gained = Phases(gates).sum();
            let gain_least = gain_a.min(gain_b).min(gain_c);
            let gained = gain.map(|gain| gain.max(0)).sum() - gain_least.max(0);
        }
        let c_is_least = gain_c.is_at_most(gain_least);
        let b_is_least = gain_b.is_at_most(gain_least);
        let without_least = c_is_least.choose(3, b_is_least.choose(5, 6));
        named! {
            let gates = gain_least.is_above(0).choose(without_least, gates_gained);
        }
        let doc =
            "Three-phase vector of a gate pattern: bit 0 leg a high, bit 1 leg b, bit 2 leg c.";
        let vectors = vec![0, 3, 5, 4, 1, 2, 6, 0];
        let table = l.b.table("vector_of_gates", vectors, &[doc.to_owned()]);
        let active = table.at(gates);
        named! {
            let vector_three = gained.is_at_most(bus << 2).choose(0, active);
            let along_three = ((bus << 2) - gained).min(0) + self.to(0);
        }
        Candidate {
            vector: vector_three,
            score: along_three,
        }
    }

    /// The best pair vector with off legs midway, against the zero vector or the best of V0 to V6,
    /// by exact scores over the bus.
    fn nearest_exact(
        &self,
        l: &Lowering<'b>,
        front: &Front<'b>,
        u: Phases<'b, 3>,
        three_phase: Option<Candidate<'b>>,
    ) -> Expr<'b> {
        let doc = "The pair vector of least cost, or the vector without a pair. Ties go to the first of V12 to V61.";
        l.b.stage("nearest_pair", &[doc]);
        let candidates = PAIRS.into_iter();
        let candidates =
            candidates.map(|pair| (self.better(pair, front.reach.volts, u), pair.letter()));
        let best =
            candidates.reduce(|(best, _), (next, name)| (best.first_least(next, name), name));
        let rival = three_phase.unwrap_or_else(|| {
            let (vector, is_off) = zero_of_pair(l, front.sector);
            let score = self.to_zero(is_off);
            Candidate { vector, score }
        });
        let Some((best, _)) = best else {
            return rival.vector;
        };
        state_score_over_bus(l, best.score, 1.0);
        best.against(rival)
    }
}
