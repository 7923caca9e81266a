//! Scores 6 (|v|^2 - 2 u v) of FCS-MPC's candidates, and the decision for a vector.

use super::deadbeat::Form;
use super::divided;
use super::whole::Whole;
use super::{Decision, Inputs};
use crate::exact::{Shift, Word, both, floor, halve, round_half_up, within, word};
use crate::model::Reach;
use crate::model::bit_true::scale::Scale;
use crate::model::vectors;
use crate::{Candidates, Error, Spec};

/// Constants of the scores and of the decision.
#[derive(Clone, Debug)]
pub struct Scores<W> {
    pub candidates: Candidates,
    /// Pairs are allowed and their off leg is where current or EMF puts it.
    pub floating: bool,
    pub form: Form<W>,
    whole: Whole<W>,
    pub score: Shift,
    i_comm_volts: f64,
}

impl<W: Word> Scores<W> {
    pub fn new(spec: &Spec, options: &crate::FcsMpc, scale: &Scale) -> Result<Self, Error> {
        let floating = scale.variant.floating;
        let held = scale.phase.a / scale.phase.b;
        let threshold = held * options.commutation_threshold / scale.w;
        Ok(Self {
            candidates: options.candidates,
            floating,
            form: Form::new(false, scale)?,
            whole: Whole::new(spec, scale)?,
            score: scale.product_if(floating || options.torque_weight > 0.0, "score")?,
            i_comm_volts: round_half_up(threshold * scale.two_v),
        })
    }
}

/// Inputs of the scores.
pub struct Choice<'a, W> {
    pub law: &'a Scores<W>,
    /// V: the voltage of a high leg.
    pub v: W,
    /// The upper rail.
    v_bus: W,
    pub u: [W; 3],
    e: [W; 3],
    /// K a i(k+1).
    held: [W; 3],
}

impl<'a, W: Word> Choice<'a, W> {
    pub fn new(law: &'a Scores<W>, now: &Inputs<W>, u: [W; 2]) -> Self {
        let abc = |x: [W; 2]| [x[0], x[1], -(x[0] + x[1])];
        Self {
            law,
            v: law.whole.reach(now),
            v_bus: now.v_bus,
            u: abc(u),
            e: abc(now.e),
            held: abc(both(|x| now.j[x] + now.e[x] - u[x])),
        }
    }

    /// The decision for a vector.
    pub fn apply(&self, now: &Inputs<W>, vector: usize) -> Decision<W> {
        // 12; a floating variant keeps the terminal voltages and traces the vector as it was
        // scored.
        let u = if self.law.floating {
            self.voltage(vector)
        } else {
            self.law.whole.voltage(now, vector)
        };
        Decision {
            u_unsat: [self.u[0], self.u[1]],
            u,
            reach: Reach::Inside,
            vector,
            // 11
            command: (self.law.whole).command(
                now,
                vector,
                self.law.candidates != Candidates::ThreePhase,
            ),
            integral: now.integral,
            hysteresis: now.hysteresis,
            past: self.law.form.past(now, u),
        }
    }

    /// Terminal voltage of the off leg, for a mean `driven` of the two others.
    pub fn off_terminal(&self, leg: usize, driven: W) -> W {
        if self.held[leg] > self.law.i_comm_volts {
            word(0.0)
        } else if self.held[leg] < -self.law.i_comm_volts {
            self.v_bus
        } else {
            within(driven + self.e[leg] + halve(self.e[leg]), 0.0, self.v_bus)
        }
    }

    /// The vector's score; `exact` without the product that is common to all scores of an exact
    /// list.
    pub fn score(&self, vector: usize, exact: bool) -> W {
        let along = self.by_reach(vector);
        if exact {
            along
        } else {
            self.rounded(vector, along)
        }
    }

    /// The score with the multiple `along` of V, one floor of both its products: vectors of
    /// the same voltage have the same score, whatever products it consists of.
    pub fn rounded(&self, vector: usize, along: W) -> W {
        let score = &self.law.score;
        match self.aside(vector) {
            None => score.floor_product(self.v, along),
            Some([x, y]) => score.floor_sum_of_products([x, y], [self.v, along]),
        }
    }

    /// The part of the score that is proportional to V, divided by V.
    pub fn by_reach(&self, vector: usize) -> W {
        score_by_reach(self.v, &self.u, vector)
    }

    /// Factors of the contribution of an off leg that is not midway.
    fn aside(&self, vector: usize) -> Option<[W; 2]> {
        let off = vectors::off_leg(vector).filter(|_| self.law.floating)?;
        Some(if vector < vectors::FIRST_PAIR_ZERO {
            let d = self.off_terminal(off, halve(self.v)) * 2.0 - self.v;
            [d, d - self.u[off] * 6.0]
        } else {
            let tau = self.off_terminal(off, word(0.0));
            [tau, tau * 4.0 - self.u[off] * 12.0]
        })
    }

    /// The decision with a second vector (10a).
    pub fn divide(&self, now: &Inputs<W>, vector: usize) -> Decision<W> {
        let command = if now.sector_eff == 0 {
            divided::command(now, &self.law.whole, [word(0.0); 3], None)
        } else if let Some(off) = vectors::off_leg(vector) {
            let [first, second] = divided::with_off_leg(off);
            let line = |vector: usize| {
                let (p, q) = divided::high_and_low(vector);
                self.u[p] - self.u[q]
            };
            let pair = if line(second) > line(first) {
                second
            } else {
                first
            };
            let (p, _) = divided::high_and_low(pair);
            let rail = if !self.law.floating {
                None
            } else if self.held[off] > self.law.i_comm_volts {
                Some(word(0.0))
            } else if self.held[off] < -self.law.i_comm_volts {
                Some(self.v_bus)
            } else {
                None
            };
            let t = match rail {
                None => line(pair),
                Some(rail) => self.u[p] + halve(rail + self.u[p]),
            };
            let mut terminal = [word(0.0); 3];
            terminal[p] = within(t, 0.0, self.v);
            divided::command(now, &self.law.whole, terminal, Some(off))
        } else {
            let others = (0..vectors::FIRST_PAIR).filter(|other| *other != vector);
            let partner = first_least(others, |other| self.score(other, true));
            let scores = [vector, partner].map(|vector| self.score(vector, true));
            divided::command(
                now,
                &self.law.whole,
                divided::between(self.v, [vector, partner], scores),
                None,
            )
        };
        let u = if self.law.floating {
            self.predicted(command.terminal, command.off.checked_sub(1))
        } else {
            divided::mean(now, &command)
        };
        Decision {
            u_unsat: [self.u[0], self.u[1]],
            u,
            reach: Reach::Inside,
            vector,
            command,
            integral: now.integral,
            hysteresis: now.hysteresis,
            past: self.law.form.past(now, u),
        }
    }

    /// Voltages of phases a, b as in the score, for the trace.
    fn voltage(&self, vector: usize) -> [W; 2] {
        let legs = vectors::LEGS[vector];
        let terminal = legs.map(|leg| if leg > 0 { self.v } else { word(0.0) });
        self.predicted(terminal, vectors::off_leg(vector))
    }

    /// Voltages of phases a, b with the off leg where it is predicted, for the trace.
    fn predicted(&self, mut terminal: [W; 3], off: Option<usize>) -> [W; 2] {
        if let Some(off) = off {
            let driven = halve(terminal[0] + terminal[1] + terminal[2]);
            terminal[off] = self.off_terminal(off, driven);
        }
        let mean = floor((terminal[0] + terminal[1] + terminal[2]) / 3.0);
        [terminal[0] - mean, terminal[1] - mean]
    }
}

/// 6 (|v|^2 - 2 u v) over V, with an off leg midway.
pub fn score_by_reach<W: Word>(v: W, u: &[W; 3], vector: usize) -> W {
    let legs = vectors::LEGS[vector];
    let find = |wanted: i8| legs.iter().position(|leg| *leg == wanted);
    let high = legs.iter().filter(|leg| **leg > 0).count();
    match (vectors::off_leg(vector), find(1), find(-1)) {
        // One leg high.
        (None, Some(x), Some(_)) if high == 1 => v * 4.0 - u[x] * 12.0,
        // One leg low.
        (None, Some(_), Some(x)) => v * 4.0 + u[x] * 12.0,
        (Some(_), Some(p), Some(q)) => v * 3.0 - (u[p] - u[q]) * 6.0,
        _ => word(0.0),
    }
}

/// The first with the least score.
pub fn first_least<W: Word>(
    list: impl Iterator<Item = usize>,
    score: impl Fn(usize) -> W,
) -> usize {
    let mut least: Option<(usize, W)> = None;
    for vector in list {
        let found = score(vector);
        if least.is_none_or(|(_, known)| found < known) {
            least = Some((vector, found));
        }
    }
    least.map_or(0, |(vector, _)| vector)
}
