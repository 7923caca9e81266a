//! The vector nearest to the deadbeat voltage, by geometry instead of enumeration (semantics, step
//! 10).
//!
//! In the three-phase set the nearest vector has the sign bits of u as gates, and the zero vector
//! wins while no phase exceeds a third of the bus. Of two pair vectors with the same leg off the
//! sign of a line voltage gives the better one, so three scores remain.

use super::changes::Changes;
use super::off_legs::OffLegs;
use super::score::{
    Candidate, PAIRS, Pair, Products, as_upper_words, state_exact_scores, state_score,
    zero_of_pair, zero_vector,
};
use crate::blocks::Lowering;
use crate::ir::{Expr, Flag, Named, Phases, named};
use crate::laws::current_loop::{CurrentLoop, Front};
use crate::laws::whole_vectors::{ALL_LOW, whole};
use crate::spec::{BusSource, Candidates, FcsMpcSpec};

const NEAREST_VECTOR: [&str; 3] = [
    "The three-phase vector nearest to the deadbeat voltage, which is the one of least predicted error: V0 while no",
    "phase exceeds a third of the bus, else the legs follow the signs of the phase voltages (on a zero the first of V1 to",
    "V6 wins).",
];

/// The chosen vector, and intermediate results on the deadbeat voltage.
pub(super) struct Choice<'b> {
    /// Its number.
    pub vector: Expr<'b>,
    /// Phase voltages.
    pub u: Phases<'b, 3>,
    /// Low legs of the nearest of V1 to V6.
    pub is_low: [Flag<'b>; 3],
    /// The largest phase voltage, and the largest of the other sign.
    pub heights: [Expr<'b>; 2],
    /// Largest magnitude of a phase voltage.
    pub largest: Expr<'b>,
    /// Terminal voltages of the legs if off.
    pub off_legs: Option<OffLegs<'b>>,
}

impl<'b> CurrentLoop<'_, 'b> {
    /// The allowed vector nearest to `u`.
    pub(super) fn choose(
        &self,
        options: &FcsMpcSpec,
        front: &Front<'b>,
        u: Phases<'b>,
    ) -> Choice<'b> {
        let (l, pair) = (self.l, u);
        l.b.stage("nearest_vector", &NEAREST_VECTOR);
        let u = pair.with_c("u_unsat");
        let [high, low] = u.extremes(["u_max", "u_min"]);
        let depth = -low;
        let depth = if options.modulated {
            depth.named("u_depth")
        } else {
            depth
        };
        named! {
            let u_largest = high.max(depth);
        }
        let (three, is_low) = nearest_three_phase(l, u, u_largest, front.reach.volts);
        let off_legs = self.predict_off_legs(options, front, pair);
        if off_legs.is_none() {
            state_exact_scores(l, u);
        }
        let rival = Candidate {
            vector: three,
            score: u_largest,
        };
        let vector = match (options.candidates, front.commutation, &off_legs) {
            (Candidates::ThreePhase, ..) | (_, None, _) => three,
            (Candidates::Table2, Some(commutation), off_legs) => {
                let pair = nearest_pair(l, front, u, off_legs.as_ref());
                commutation.flag.choose(three, pair)
            }
            (Candidates::All, Some(_), Some(off_legs)) => {
                nearest_physical(l, off_legs, front, u, None, Some(rival))
            }
            (Candidates::All, Some(_), None) => nearest_of_all(l, front, u, rival),
        };
        Choice {
            vector: vector.named("vector"),
            u,
            is_low,
            heights: [high, depth],
            largest: u_largest,
            off_legs,
        }
    }

    /// The same for Table 2's sets if only the vector is needed: the three-phase set is evaluated
    /// in commutation only.
    pub(super) fn choose_of_table2(
        &self,
        options: &FcsMpcSpec,
        front: &Front<'b>,
        u: Phases<'b>,
        commutating: Flag<'b>,
    ) -> Expr<'b> {
        let (l, pair) = (self.l, u);
        let doc = "Third phase of the deadbeat voltage.";
        l.b.stage("complete_voltage", &[doc]);
        let u = pair.with_c("u_unsat");
        let off_legs = self.predict_off_legs(options, front, pair);
        if off_legs.is_none() {
            state_exact_scores(l, u);
        }
        named! {
            let vector_pair = nearest_pair(l, front, u, off_legs.as_ref());
        }
        l.b.guarded_stage("nearest_vector", commutating, false, &NEAREST_VECTOR);
        let largest = largest_of_zero_sum(u);
        let (three, _) = nearest_three_phase(l, u, largest, front.reach.volts);
        let [vector] = l.b.join([("vector", three, vector_pair)]);
        vector
    }

    /// Low legs of the three-phase vector nearest to `u`, if only the legs are needed.
    pub(super) fn choose_low_legs(&self, front: &Front<'b>, u: Phases<'b>) -> Expr<'b> {
        let l = self.l;
        l.b.stage("nearest_vector", &NEAREST_VECTOR);
        let u = u.with_c("u_unsat");
        state_exact_scores(l, u);
        let (low_legs, _) = low_legs_of(u);
        let beyond = is_beyond_third(l, largest_of_zero_sum(u), front.reach.volts);
        named! {
            let pattern = beyond.choose(low_legs, ALL_LOW);
        }
        pattern
    }
}

/// The best pair vector with real off-leg voltages, against the zero vector or `three_phase`, whose
/// score is the largest phase voltage; with `changes` its score over the bus.
pub(super) fn nearest_physical<'b>(
    l: &Lowering<'b>,
    off_legs: &OffLegs<'b>,
    front: &Front<'b>,
    u: Phases<'b, 3>,
    changes: Option<&Changes<'b>>,
    three_phase: Option<Candidate<'b>>,
) -> Expr<'b> {
    let bus = front.reach.volts;
    let rival = match three_phase {
        Some(_) => "the three-phase vector",
        None => "the zero vector",
    };
    l.b.stage(
        "nearest_pair",
        &[
            &format!("The pair vector nearest to the deadbeat voltage, or {rival} if that is not worse: the least score 6 (|v|^2 - 2 u v)"),
            "of the better vectors per off leg. Ties go to the first vector. Both products of a score are rounded as one, so that",
            "a pair with its off leg at a rail ties exactly with the vector of the same voltage.",
        ],
    );
    // All factors first: their intervals give the shift of the products.
    let mut pairs = PAIRS.map(|pair| {
        let better = match changes {
            Some(changes) => changes.better(pair, bus, u),
            None => along_better(pair, bus, u),
        };
        let offset = off_legs.offsets.0[pair.0];
        let aside = offset - 6 * u.0[pair.0];
        let aside = aside.named(&format!("aside_{}", pair.letter()));
        let products = Products(vec![[offset, aside], [bus, better.score]]);
        (better.vector, products)
    });
    let (rival, mut rival_products) = match three_phase {
        Some(three) => three_phase_products(bus, three, changes.is_some()),
        None => zero_products(l, off_legs, front, u, changes),
    };
    let of_pairs = pairs.iter_mut().map(|(_, products)| products);
    let mut all: Vec<&mut Products<'b>> = of_pairs.chain([&mut rival_products]).collect();
    let shift = shift_of_scores(&all);
    l.product_format("score", shift, "products of two voltages in scores");
    let left = as_upper_words(&mut all, shift);
    let scored = |vector, score: Option<Expr<'b>>, name: &str| {
        let score = score.unwrap_or(bus).named(name);
        state_score(l, score, shift);
        Candidate { vector, score }
    };
    let candidates = pairs.iter().zip(PAIRS).map(|((vector, products), pair)| {
        let letter = pair.letter();
        let name = format!("score_{letter}");
        (scored(*vector, products.sum(left), &name), letter)
    });
    let best = candidates.reduce(|(best, _), (next, name)| (best.first_least(next, name), name));
    // The score of V0 is 0; the best three-phase vector scores less, or V0 was chosen.
    let is_negative = three_phase.is_some() && changes.is_none();
    let score = rival_products.sum(left);
    let score = score.map(|score| if is_negative { score.min(0) } else { score });
    let rival = scored(rival, score, "score_to_beat");
    best.map_or(rival.vector, |(best, _)| best.against(rival))
}

/// The shift at which the sum of two products fits a word with one bit to spare: a product of
/// factors of n and m bits has n + m - 1.
fn shift_of_scores(all: &[&mut Products<'_>]) -> u32 {
    let widest = all.iter().map(|products| products.bits()).max();
    widest.map_or(31, |bits| bits.saturating_sub(31))
}

/// The three-phase vector and the products of its score, from its score over the bus or from the
/// largest phase voltage.
fn three_phase_products<'b>(
    bus: Expr<'b>,
    three: Candidate<'b>,
    is_over_bus: bool,
) -> (Expr<'b>, Products<'b>) {
    if is_over_bus {
        return (three.vector, Products(vec![[bus, three.score]]));
    }
    named! {
        let along_three = (bus << 2) - 12 * three.score;
    }
    (three.vector, Products(vec![[bus, along_three]]))
}

/// The zero vector of the sector's pair and the products of its score.
fn zero_products<'b>(
    l: &Lowering<'b>,
    off_legs: &OffLegs<'b>,
    front: &Front<'b>,
    u: Phases<'b, 3>,
    changes: Option<&Changes<'b>>,
) -> (Expr<'b>, Products<'b>) {
    let (vector, is_off) = zero_of_pair(l, front.sector);
    let aside = off_legs.zero(u, is_off);
    let change = changes.map(|changes| [front.reach.volts, changes.to_zero(is_off)]);
    let products = std::iter::once(aside).chain(change);
    (vector, Products(products.collect()))
}

/// The index of three flags, with weights 1, 2 and 4.
fn index_of_flags([first, second, third]: [Flag<'_>; 3]) -> Expr<'_> {
    first.choose(1, 0) + second.choose(2, 0) + third.choose(4, 0)
}

/// `value - 1` if the flag holds, else `value`: makes a zero that counts as low negative.
fn lowered_by<'b>(value: Expr<'b>, flag: Flag<'b>) -> Expr<'b> {
    value - flag.choose(1, 0)
}

/// The largest magnitude of three zero-sum voltages: the sum of the positive ones.
fn largest_of_zero_sum(u: Phases<'_, 3>) -> Expr<'_> {
    named! {
        let u_largest = u.map(|u| u.max(0)).sum();
    }
    u_largest
}

/// Whether a magnitude exceeds a third of a high leg's voltage. An integer exceeds the third exactly if it
/// exceeds its integer part.
fn is_beyond_third<'b>(l: &Lowering<'b>, largest: Expr<'b>, bus: Expr<'b>) -> Flag<'b> {
    match l.spec.inverter.bus {
        BusSource::Fixed => {
            let doc = format!("A third of {}", whole(&l.spec.inverter));
            let third = l.voltage("third_of_bus", bus.interval().high / 3, &doc);
            largest.is_above(third)
        }
        BusSource::Measured { .. } => {
            named! {
                let u_triple = 3 * largest;
            }
            u_triple.is_above(bus)
        }
    }
}

/// Whether a line voltage exceeds half a high leg's voltage.
fn any_beyond_half<'b>(l: &Lowering<'b>, lines: [Expr<'b>; 3], bus: Expr<'b>) -> Flag<'b> {
    let doc = format!("Half {}", whole(&l.spec.inverter));
    let beyond = [0, 1, 2].map(|order| match l.spec.inverter.bus {
        BusSource::Fixed => {
            let half = || l.voltage("half_bus", bus.interval().high / 2, &doc);
            lines[order].is_above(half()) | lines[order].is_below(-half())
        }
        BusSource::Measured { .. } => {
            let name = format!("line_{}_twice", PAIRS[order].letter());
            let twice = (2 * lines[order]).named(&name);
            twice.is_above(bus) | twice.is_below(-bus)
        }
    });
    let [a, b, c] = beyond;
    a | b | c
}

/// Low legs of the nearest of V1 to V6 to `u`, as a pattern and as flags.
fn low_legs_of(u: Phases<'_, 3>) -> (Expr<'_>, [Flag<'_>; 3]) {
    // A zero takes the leg of the first of the two tied vectors: b low, a like b, c unlike b. A one
    // is subtracted from words that count as low, so that the sign decides.
    let [a, b, c] = u.0;
    named! {
        let b_is_low = (b - 1).is_below(0);
        let a_is_low = lowered_by(a, b_is_low).is_below(0);
        let c_is_low = lowered_by(c, !b.is_below(0)).is_below(0);
        let low_legs = index_of_flags([a_is_low, b_is_low, c_is_low]);
    }
    (low_legs, [a_is_low, b_is_low, c_is_low])
}

/// The nearest of V0 to V6 to `u`, and the low legs of the nearest of V1 to V6.
fn nearest_three_phase<'b>(
    l: &Lowering<'b>,
    u: Phases<'b, 3>,
    largest: Expr<'b>,
    bus: Expr<'b>,
) -> (Expr<'b>, [Flag<'b>; 3]) {
    let (low_legs, is_low) = low_legs_of(u);
    let doc =
        "Three-phase vector of a pattern of low legs: bit 0 leg a low, bit 1 leg b, bit 2 leg c.";
    let vectors = vec![0, 6, 2, 1, 4, 5, 3, 0];
    let table = l.b.table("vector_of_low_legs", vectors, &[doc.to_owned()]);
    let active = table.at(low_legs);
    named! {
        let vector_three = is_beyond_third(l, largest, bus).choose(active, 0);
    }
    (vector_three, is_low)
}

/// The one of two vectors with one leg off that has the larger line voltage: number and voltage.
fn better_of_two(pair: Pair, u: Phases<'_, 3>) -> [Expr<'_>; 2] {
    let letter = pair.letter();
    let line = pair.line(u).named(&format!("line_{letter}"));
    let [first, second] = pair.numbers().map(|number| number as i32);
    let vector = line.is_below(0).choose(second, first);
    [
        vector.named(&format!("pair_{letter}")),
        line.abs().named(&format!("size_{letter}")),
    ]
}

/// That vector with its score over the bus, without the off leg.
fn along_better<'b>(pair: Pair, bus: Expr<'b>, u: Phases<'b, 3>) -> Candidate<'b> {
    let [vector, size] = better_of_two(pair, u);
    let score = 3 * bus - 6 * size;
    Candidate {
        vector,
        score: score.named(&format!("along_{}", pair.letter())),
    }
}

/// The pair vector nearest to the voltage, or the zero vector.
fn nearest_pair<'b>(
    l: &Lowering<'b>,
    front: &Front<'b>,
    u: Phases<'b, 3>,
    off_legs: Option<&OffLegs<'b>>,
) -> Expr<'b> {
    match off_legs {
        Some(off_legs) => nearest_physical(l, off_legs, front, u, None, None),
        None => nearest_nominal(l, front, u),
    }
}

fn pair_stage(l: &Lowering<'_>) {
    l.b.stage(
        "nearest_pair",
        &[
            "The pair vector nearest to the deadbeat voltage: that of the largest line voltage, or the zero vector while it is at",
            "most half the bus. Ties go to the first of V12 to V61.",
        ],
    );
}

fn nearest_nominal<'b>(l: &Lowering<'b>, front: &Front<'b>, u: Phases<'b, 3>) -> Expr<'b> {
    pair_stage(l);
    let idle = zero_vector(l, front.sector);
    let lines = PAIRS.map(|pair| pair.line(u).named(&format!("line_{}", pair.letter())));
    // The order of the phase voltages is that of the vector's legs. Equal phases take the order of
    // the first of the tied vectors: a above b, c above b unless a is below both, a above c if b is
    // above both.
    let [line_a, line_c, line_b] = lines;
    named! {
        let a_below_b = line_c.is_below(0);
        let c_below_b = lowered_by(line_a, a_below_b).is_below(0);
        let a_below_c = lowered_by(line_b, !a_below_b).is_below(0);
        let order = index_of_flags([a_below_b, c_below_b, a_below_c]);
    }
    let doc = "Pair vector by the order of the phase voltages: bit 0 a below b, bit 1 c below b, bit 2 a below c (two patterns do not occur).";
    let vectors = vec![8, 0, 9, 10, 7, 12, 0, 11];
    let table = l.b.table("pair_of_order", vectors, &[doc.to_owned()]);
    let beyond = any_beyond_half(l, lines, front.reach.volts);
    beyond.choose(table.at(order), idle)
}

/// The nearest of all vectors.
fn nearest_of_all<'b>(
    l: &Lowering<'b>,
    front: &Front<'b>,
    u: Phases<'b, 3>,
    three: Candidate<'b>,
) -> Expr<'b> {
    pair_stage(l);
    let candidates = PAIRS.into_iter().map(|pair| {
        let [vector, size] = better_of_two(pair, u);
        let score = (-size).named(&format!("score_{}", pair.letter()));
        (Candidate { vector, score }, pair.letter())
    });
    let best = candidates.reduce(|(best, _), (next, name)| (best.first_least(next, name), name));
    let Some((best, _)) = best else {
        return three.vector;
    };
    // Scores over the bus: three-phase 4 V - 12 u or 0, pair 3 V - 6 line.
    let bus = front.reach.volts;
    named! {
        let line_largest = -best.score;
    }
    let of_three = Candidate {
        vector: three.vector,
        score: ((bus << 2) - 12 * three.score).min(0),
    };
    let of_pair = Candidate {
        vector: best.vector,
        score: 3 * bus - 6 * line_largest,
    };
    of_pair.against(of_three)
}
