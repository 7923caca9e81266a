//! The choice over two periods (semantics, step 10h).
//!
//! For each first vector the best second one follows from geometry: it is the nearest to a known
//! voltage. So one score per first vector remains in place of one per sequence.

use super::score::{Candidate, state_score_over_bus};
use crate::blocks::Lowering;
use crate::ir::{Coefficient, Expr, Named, Phases, named};
use crate::laws::current_loop::{CurrentLoop, Front};
use crate::laws::whole_vectors::{sixths, vector_legs};
use crate::spec::{BusSource, Candidates, FcsMpcSpec};

/// Quantities of the first vectors' scores.
struct Sequences<'l, 'b> {
    l: &'l Lowering<'b>,
    with_pairs: bool,
    /// Voltage of a high leg.
    bus: Expr<'b>,
    /// (1 + a^2) V
    first: Expr<'b>,
    /// a V/6
    sixth: Expr<'b>,
    /// Deadbeat voltage of the second period after a zero vector.
    y: Phases<'b, 3>,
    /// u + a y
    z: Phases<'b, 3>,
}

impl<'b> CurrentLoop<'_, 'b> {
    /// The first vector of the best sequence of two; `e` is the EMF over the target period.
    pub(super) fn choose_two_steps(
        &self,
        options: &FcsMpcSpec,
        front: &Front<'b>,
        e: Phases<'b>,
        u: Phases<'b>,
    ) -> Expr<'b> {
        let (l, pole, word) = (self.l, self.design.plant.pole, self.options.word);
        // Its signals have up to three bits more than a deadbeat voltage.
        let narrow = if word == 16 { 12 } else { word };
        let doc = "Pole of the plant: remainder of a current after one period.";
        let k_pole = l.coefficient("k_pole", pole, narrow, doc, &format!("a = {pole:.6}"));
        let doc = "Weight of the square of the first vector.";
        let k_first = l.coefficient("k_first", 1.0 + pole * pole, word, doc, "1 + a^2");
        let doc = "Effect of a sixth of the bus in the first period on the deadbeat voltage of the second.";
        let k_sixth = l.coefficient("k_pole_sixth", pole / 6.0, word, doc, "a/6");
        l.b.stage(
            "second_period",
            &[
                "Deadbeat voltage of the second period after a zero vector, y = K (1 - a) i_ref + e + a u, with reference and EMF held.",
                "A first vector v changes it by -a v; z = u + a y is the first vector's target over both periods.",
            ],
        );
        let reference = front.reference;
        named! {
            let y = reference + e + k_pole * (u - reference);
            let z = u + k_pole * y;
        }
        let (y, z, bus) = (y.with_c("y"), z.with_c("z"), front.reach.volts);
        let sequences = Sequences {
            l,
            with_pairs: options.candidates == Candidates::All,
            bus,
            first: share_of_bus(l, k_first, bus, "v_first", "(1 + a^2) times the bus"),
            sixth: share_of_bus(l, k_sixth, bus, "v_sixth", "a sixth of the bus times a"),
            y,
            z,
        };
        l.b.stage(
            "best_sequence",
            &[
                "Score of each first vector: its own part plus that of the best second vector, which over the bus is 0 for V0, 4 V - 12 y",
                "for the nearest three-phase vector and 3 V - 6 line for the nearest pair. The least wins, the first on a tie.",
            ],
        );
        named! {
            let vector = sequences.best();
        }
        vector
    }
}

/// The coefficient times the bus, words of voltage.
fn share_of_bus<'b>(
    l: &Lowering<'b>,
    coefficient: Coefficient,
    bus: Expr<'b>,
    name: &str,
    doc: &str,
) -> Expr<'b> {
    match l.spec.inverter.bus {
        BusSource::Fixed => {
            let product = l.rounded_product(coefficient, bus.interval().high);
            l.voltage(name, product, doc)
        }
        BusSource::Measured { .. } => (coefficient * bus).named(name),
    }
}

impl<'b> Sequences<'_, 'b> {
    fn best(&self) -> Expr<'b> {
        let zero = Candidate {
            vector: self.l.b.number(0),
            score: self.share_ahead(0),
        };
        state_score_over_bus(self.l, zero.score, 1.0);
        let last = if self.with_pairs { 13 } else { 7 };
        let best = (1..last).fold(zero, |best, number| {
            let ahead = self.share_ahead(number);
            let score = self.own_share(number).map_or(ahead, |own| own + ahead);
            state_score_over_bus(self.l, score, 1.0);
            let next = Candidate {
                vector: self.l.b.number(number as i32),
                score: score.named(&format!("score_{number}")),
            };
            best.least(next, number)
        });
        best.vector
    }

    /// A first vector's own part of the score, F; none for V0.
    fn own_share(&self, number: usize) -> Option<Expr<'b>> {
        let legs = vector_legs()[number];
        let place = |sign: i32| legs.iter().position(|&leg| leg == sign);
        let (high, low) = (place(1)?, place(-1)?);
        let z = self.z.0;
        if place(0).is_some() {
            return Some(3 * self.first - 6 * (z[high] - z[low]));
        }
        let is_lone_high = legs.iter().filter(|&&leg| leg == 1).count() == 1;
        let twelve = if is_lone_high {
            12 * z[high]
        } else {
            -12 * z[low]
        };
        Some((self.first << 2) - twelve)
    }

    /// The best second vector's part of the score, B.
    fn share_ahead(&self, number: usize) -> Expr<'b> {
        let sixths = sixths(vector_legs()[number]);
        let left = Phases::<3>::each(|x| match sixths[x] {
            0 => self.y.0[x],
            share => {
                let left = self.y.0[x] - share * self.sixth;
                left.named(&format!("y_{}_{number}", ["a", "b", "c"][x]))
            }
        });
        let names = [format!("y_max_{number}"), format!("y_min_{number}")];
        let [high, low] = left.extremes([&names[0], &names[1]]);
        let largest = high.max(-low);
        let mut ahead = (self.bus << 2) - 12 * largest;
        if self.with_pairs {
            let six = 6 * (high - low);
            ahead = ahead.min(3 * self.bus - six);
        }
        ahead.min(0).named(&format!("ahead_{number}"))
    }
}
