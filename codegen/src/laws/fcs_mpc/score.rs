//! Scores of vectors, 6 (|v|^2 - 2 u v): the least score has the least predicted error.

use crate::blocks::Lowering;
use crate::ir::{Expr, Flag, Lut, Named, Phases};
use crate::laws::whole_vectors::zero_vectors;

/// Pairs by off leg, in the order of their vectors: V12 | V45 a off, V23 | V56 c off, V34 | V61 b
/// off.
pub(super) const PAIRS: [Pair; 3] = [Pair(0, 2, 1), Pair(2, 0, 1), Pair(1, 0, 2)];

/// Off phase, high phase and low phase of the first of two vectors.
#[derive(Clone, Copy)]
pub(super) struct Pair(pub usize, usize, usize);

impl Pair {
    /// The letter of the phase that is off.
    pub(super) fn letter(self) -> &'static str {
        ["a", "b", "c"][self.0]
    }

    /// Numbers of the two vectors.
    pub(super) fn numbers(self) -> [usize; 2] {
        let first = 7 + [0, 2, 1][self.0];
        [first, first + 3]
    }

    /// The line voltage of the first.
    pub(super) fn line(self, u: Phases<'_, 3>) -> Expr<'_> {
        u.0[self.1] - u.0[self.2]
    }
}

/// Documentation of scores.
const SCORE: &str = "Score 6 (|v|^2 - 2 u v) of a vector";

/// A vector and its score.
#[derive(Clone, Copy)]
pub(super) struct Candidate<'b> {
    pub vector: Expr<'b>,
    pub score: Expr<'b>,
}

impl<'b> Candidate<'b> {
    /// The candidate of the lower score; on a tie that of the lower number. `name` is that of
    /// `next`.
    pub(super) fn first_least(self, next: Self, name: &str) -> Self {
        let less = next.score.is_below(self.score);
        let tied = next.score.is(self.score) & next.vector.is_below(self.vector);
        let take = (less | tied).named(&format!("take_{name}"));
        let vector = take.choose(next.vector, self.vector);
        let score = take.choose(next.score, self.score);
        Self {
            vector: vector.named(&format!("best_{name}")),
            score: score.named(&format!("best_score_{name}")),
        }
    }

    /// The candidate of the lower score; on a tie this one. `number` is that of `next`.
    pub(super) fn least(self, next: Self, number: usize) -> Self {
        let take = next.score.is_below(self.score);
        let take = take.named(&format!("take_{number}"));
        let vector = take.choose(next.vector, self.vector);
        let score = next.score.min(self.score);
        Self {
            vector: vector.named(&format!("best_{number}")),
            score: score.named(&format!("least_{number}")),
        }
    }

    /// The vector if its score is lower than the rival's; else the rival's vector.
    pub(super) fn against(self, rival: Self) -> Expr<'b> {
        let better = self.score.is_below(rival.score);
        better.choose(self.vector, rival.vector)
    }
}

/// A sum of products that is rounded once.
#[derive(Clone)]
pub(super) struct Products<'b>(pub Vec<[Expr<'b>; 2]>);

impl<'b> Products<'b> {
    /// Sum of the factors' bits, of the widest product.
    pub(super) fn bits(&self) -> u32 {
        let bits = |[x, y]: &[Expr<'b>; 2]| x.interval().bits() + y.interval().bits();
        self.0.iter().map(bits).max().unwrap_or(0)
    }

    /// The sum, shifted right; none without a product.
    pub(super) fn sum(&self, shift: u32) -> Option<Expr<'b>> {
        match self.0[..] {
            [] => None,
            [[x, y]] => Some(x.mul_floor(y, shift)),
            [first, second, ..] => Some(crate::ir::mul_add_floor(first, second, shift)),
        }
    }
}

/// Shifts the first factors left so that `shift` becomes 32, the upper word of each product,
/// without a 64-bit shift. No change if a factor has no room or the products fit a word. Returns
/// the new shift.
pub(super) fn as_upper_words(products: &mut [&mut Products<'_>], shift: u32) -> u32 {
    let room = 32_u32.saturating_sub(shift);
    let firsts = || products.iter().flat_map(|products| &products.0);
    let is_long = products.iter().any(|products| products.bits() > 32);
    let has_room = firsts().all(|[x, _]| x.interval().bits() + room <= 32);
    if !is_long || !has_room {
        return shift;
    }
    for [first, _] in products.iter_mut().flat_map(|products| &mut products.0) {
        *first = *first << room;
    }
    shift + room
}

/// States the error bound of a score that was shifted right by `shift`.
pub(super) fn state_score<'b>(l: &Lowering<'b>, score: Expr<'b>, shift: u32) {
    let word = f64::from(shift).exp2() / l.scale.voltage().powi(2);
    l.b.state_error("score", score, [SCORE, "V^2"], word);
}

/// States the error bound of a score over `weight` times the voltage of a high leg on the largest bus.
pub(super) fn state_score_over_bus<'b>(l: &Lowering<'b>, voltage: Expr<'b>, weight: f64) {
    let high = l.spec.inverter.greatest_bus() * l.spec.reach_share();
    let word = weight * high / l.scale.voltage();
    l.b.state_error("score", voltage, [SCORE, "V^2"], word);
}

/// States the error bound of the scores V (4 V - 12 u) and V (3 V - 6 line): the third phase has
/// the largest error of a phase, and a line at most twice that.
pub(super) fn state_exact_scores<'b>(l: &Lowering<'b>, u: Phases<'b, 3>) {
    state_score_over_bus(l, u.c(), 12.0);
}

/// Zero vectors of the pairs of sectors 1 to 6.
fn zero_vector_table<'b>(l: &Lowering<'b>) -> Lut<'b> {
    let doc = "Zero vector of the pair in sectors 1 to 6: its legs low, the third off.";
    l.b.column("sector", "zero_vector", zero_vectors(), doc)
}

pub(super) fn zero_vector<'b>(l: &Lowering<'b>, sector: Expr<'b>) -> Expr<'b> {
    zero_vector_table(l).at(sector).named("pair_zero_vector")
}

/// The zero vector of the sector's pair; flags: leg a, leg b is off in it.
pub(super) fn zero_of_pair<'b>(l: &Lowering<'b>, sector: Expr<'b>) -> (Expr<'b>, [Flag<'b>; 2]) {
    let vector = zero_vector(l, sector);
    let is_off = [(13, "a_is_off"), (14, "b_is_off")];
    (
        vector,
        is_off.map(|(number, name)| vector.is(number).named(name)),
    )
}
