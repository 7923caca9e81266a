//! The vector nearest to the deadbeat voltage, by geometry instead of enumeration (semantics, step 10).
//!
//! Over the three-phase set the nearest vector has the sign bits of u as gates, and the zero vector wins while no
//! phase exceeds a third of the bus. Of two pair vectors with the same leg off the better one is told by
//! the sign of a line voltage, so three scores remain.

use super::weighted::{Changes, better_with_changes, zero_with_changes};
use crate::controllers::current_loop::{CurrentLoop, Front};
use crate::controllers::whole_vectors::{ALL_LOW, zero_vectors};
use crate::ir::{Comparison, TableId, Value};
use crate::lower::Lowering;
use crate::spec::{BusSource, Candidates, FcsMpcSpec};

/// Pairs by the leg that is off, in the order of their vectors: V12 | V45 leave a off, V23 | V56 c, V34 | V61 b.
/// Off phase, the phase that is high in the first vector, the phase that is low in it.
pub(super) const PAIRS: [(usize, usize, usize); 3] = [(0, 2, 1), (2, 0, 1), (1, 0, 2)];

const NEAREST_VECTOR: [&str; 3] = [
    "The three-phase vector nearest to the deadbeat voltage, which is the one of least predicted error: V0 while no",
    "phase exceeds a third of the bus, else the legs are low by the signs of the phase voltages (a zero goes to the vector",
    "that stands first in V1 to V6).",
];

/// What the compared scores are.
pub(super) const SCORE: &str = "Score 6 (|v|^2 - 2 u v) of a vector";

/// The chosen vector, and what else is known of the voltage asked for.
pub(super) struct Choice {
    /// Its number.
    pub vector: Value,
    /// Phase voltages.
    pub u: [Value; 3],
    /// Flags: the legs that are low in the nearest of V1 to V6.
    pub is_low: [Value; 3],
    /// The greatest phase voltage, and that of the other sign.
    pub heights: [Value; 2],
    /// The greatest magnitude of a phase voltage.
    pub largest: Value,
    /// Per leg, whether its predicted current would flow through a diode inward or outward were it off.
    pub conducting: Option<[[Value; 2]; 3]>,
}

/// Where each leg would sit if it were off.
pub(super) struct OffLegs {
    /// Flags: the diode conducts inward, outward.
    conducting: [[Value; 2]; 3],
    /// Twice the terminal beside a driven pair, less the bus.
    pub offsets: [Value; 3],
    /// What the EMF lifts it by above the driven legs' mean.
    lifts: [Value; 3],
}

/// A vector and its score, six times (|v|^2 - 2 u v).
#[derive(Clone, Copy)]
pub(super) struct Candidate {
    pub vector: Value,
    pub score: Value,
}

impl CurrentLoop<'_, '_> {
    /// The allowed vector nearest to `u`.
    pub(super) fn choose(&mut self, options: &FcsMpcSpec, front: &Front, u: [Value; 2]) -> Choice {
        let l = &mut *self.lowering;
        l.b.stage("nearest_vector", &NEAREST_VECTOR);
        let u_c = l.third_phase("u_c_unsat", u[0], u[1]);
        let phases = [u[0], u[1], u_c];
        let [high, low] = l.extremes(["u_max", "u_min"], phases);
        let depth = l.b.neg(low);
        let largest = l.b.max(high, depth);
        l.b.name("u_largest", largest);
        if options.modulated {
            l.b.name("u_depth", depth);
        }
        let (three, is_low) = nearest_three_phase(l, phases, largest, front.bus.volts);
        let off_legs = self.predict_off_legs(options, front, phases);
        if off_legs.is_none() {
            state_exact_scores(&mut *self.lowering, u_c);
        }
        let vector = match (options.candidates, front.commutation) {
            (Candidates::ThreePhase, _) | (_, None) => three,
            (Candidates::Table2, Some(commutation)) => {
                let pair = if let Some(off_legs) = &off_legs {
                    self.nearest_physical(off_legs, front, phases, None, None)
                } else {
                    pair_stage(&mut *self.lowering);
                    nearest_nominal(&mut *self.lowering, front, phases)
                };
                let l = &mut *self.lowering;
                l.b.select(commutation.flag, three, pair)
            }
            (Candidates::All, Some(_)) => match &off_legs {
                Some(off_legs) => {
                    let rival = Candidate {
                        vector: three,
                        score: largest,
                    };
                    self.nearest_physical(off_legs, front, phases, None, Some(rival))
                }
                None => nearest_of_all(&mut *self.lowering, front, phases, three, largest),
            },
        };
        Choice {
            vector: self.lowering.b.name("vector", vector),
            u: phases,
            is_low,
            heights: [high, depth],
            largest,
            conducting: off_legs.map(|off_legs| off_legs.conducting),
        }
    }

    /// The same for Table 2's sets, where nothing but the vector is asked for: the three-phase set is looked at in
    /// commutation alone.
    pub(super) fn choose_of_table2(
        &mut self,
        options: &FcsMpcSpec,
        front: &Front,
        u: [Value; 2],
        commutating: Value,
    ) -> Value {
        let l = &mut *self.lowering;
        let doc = "The third phase of the deadbeat voltage.";
        l.b.stage("complete_voltage", &[doc]);
        let u_c = l.third_phase("u_c_unsat", u[0], u[1]);
        let phases = [u[0], u[1], u_c];
        let pair = if let Some(off_legs) = self.predict_off_legs(options, front, phases) {
            self.nearest_physical(&off_legs, front, phases, None, None)
        } else {
            let l = &mut *self.lowering;
            state_exact_scores(l, u_c);
            pair_stage(l);
            nearest_nominal(l, front, phases)
        };
        let l = &mut *self.lowering;
        l.b.name("vector_pair", pair);
        l.b.guarded_stage("nearest_vector", commutating, false, &NEAREST_VECTOR);
        let largest = largest_of_zero_sum(l, phases);
        let (three, _) = nearest_three_phase(l, phases, largest, front.bus.volts);
        let [vector] = l.b.join([("vector", three, pair)]);
        vector
    }

    /// The legs that are low in the three-phase vector nearest to `u`, where nothing but the legs is asked for.
    pub(super) fn choose_low_legs(&mut self, front: &Front, u: [Value; 2]) -> Value {
        let l = &mut *self.lowering;
        l.b.stage("nearest_vector", &NEAREST_VECTOR);
        let u_c = l.third_phase("u_c_unsat", u[0], u[1]);
        let phases = [u[0], u[1], u_c];
        state_exact_scores(l, u_c);
        let (low_legs, _) = low_legs_of(l, phases);
        let largest = largest_of_zero_sum(l, phases);
        let beyond = is_beyond_third(l, largest, front.bus.volts);
        let all = l.b.literal(ALL_LOW);
        let pattern = l.b.select(beyond, low_legs, all);
        l.b.name("pattern", pattern)
    }

    /// Where each leg would sit if it were off in the target period; none where a vector stands for its nominal voltage.
    pub(super) fn predict_off_legs(
        &mut self,
        options: &FcsMpcSpec,
        front: &Front,
        u: [Value; 3],
    ) -> Option<OffLegs> {
        let e = front
            .e
            .filter(|_| options.floating() && front.commutation.is_some())?;
        let threshold_volts = if options.common.delay == 1 {
            self.design.k_hold / self.design.plant.pole
        } else {
            self.design.k_hold
        } * options.common.commutation_threshold;
        let l = &mut *self.lowering;
        l.b.stage(
            "predict_off_legs",
            &[
                "Where each leg would sit if it were off in the target period: at a rail while its predicted current flows",
                "through a diode, else where its EMF puts it. h = K a i(k+1) = K i_ref + e - u needs no product.",
            ],
        );
        let e_c = l.third_phase("e_c_off", e[0], e[1]);
        let e = [e[0], e[1], e_c];
        let h = [0, 1].map(|x| {
            let sum = l.b.add(front.reference[x], e[x]);
            let h = l.b.sub(sum, u[x]);
            l.b.name(["h_a", "h_b"][x], h)
        });
        let h_c = l.third_phase("h_c", h[0], h[1]);
        let h = [h[0], h[1], h_c];
        let limit = l.volts_word(threshold_volts);
        let doc = "Predicted current above which an off leg's diode conducts, as the voltage K a i";
        let bus = front.bus.volts;
        let half = l.b.shift_right(bus, 1);
        l.b.name("half_bus_off", half);
        let mut flags = vec![];
        let mut offsets = vec![];
        let mut lifts = vec![];
        for x in 0..3 {
            let bound = l.voltage("i_comm_volts", limit, doc);
            let inward = l.b.compare(Comparison::Less, bound, h[x]);
            l.b.name(["a_inward", "b_inward", "c_inward"][x], inward);
            let bound = l.voltage("i_comm_volts", limit, doc);
            let negative = l.b.neg(bound);
            let outward = l.b.compare(Comparison::Less, h[x], negative);
            l.b.name(["a_outward", "b_outward", "c_outward"][x], outward);
            let half_e = l.b.shift_right(e[x], 1);
            let lift = l.b.add(e[x], half_e);
            l.b.name(["lift_a", "lift_b", "lift_c"][x], lift);
            let free = l.b.add(half, lift);
            let zero = l.zero();
            let free = l.b.clamp(free, zero, bus);
            let outer = l.b.select(outward, bus, free);
            let zero = l.zero();
            let tau = l.b.select(inward, zero, outer);
            let twice = l.b.shift_left(tau, 1);
            let offset = l.b.sub(twice, bus);
            l.b.name(["d_a", "d_b", "d_c"][x], offset);
            flags.push([inward, outward]);
            offsets.push(offset);
            lifts.push(lift);
        }
        Some(OffLegs {
            conducting: [flags[0], flags[1], flags[2]],
            offsets: [offsets[0], offsets[1], offsets[2]],
            lifts: [lifts[0], lifts[1], lifts[2]],
        })
    }

    /// The best pair vector with off legs where their diodes put them, against the zero vector or `three_phase`, whose
    /// score is the greatest phase voltage; with `changes` its score over the bus.
    pub(super) fn nearest_physical(
        &mut self,
        off_legs: &OffLegs,
        front: &Front,
        u: [Value; 3],
        changes: Option<&Changes>,
        three_phase: Option<Candidate>,
    ) -> Value {
        let l = &mut *self.lowering;
        let (bus, offsets) = (front.bus.volts, off_legs.offsets);
        let rival = match three_phase {
            Some(_) => "the three-phase vector",
            None => "the zero vector",
        };
        l.b.stage(
            "nearest_pair",
            &[
                "The pair vector nearest to the deadbeat voltage: per off leg the score 6 (|v|^2 - 2 u v) of the better of its two",
                &format!("vectors, the least of three, and {rival} where that is not worse. Ties go to the vector that stands first."),
                "Both products of a score are rounded as one: pairs whose off leg lies at a rail tie exactly with what has their voltage.",
            ],
        );
        // Factors first: their intervals give the shift of all products.
        let mut factors = vec![];
        let mut vectors = vec![];
        for (order, (off, ..)) in PAIRS.into_iter().enumerate() {
            let better = match changes {
                Some(changes) => better_with_changes(l, order, bus, u, changes),
                None => along_better(l, order, bus, u),
            };
            vectors.push(better.vector);
            let six = l.b.mul_by(6, u[off]);
            let aside = l.b.sub(offsets[off], six);
            l.b.name(["aside_a", "aside_c", "aside_b"][order], aside);
            factors.push([[offsets[off], aside], [bus, better.score]]);
        }
        let mut change = None;
        let mut rival = match three_phase {
            Some(three) if changes.is_some() => (three.vector, [bus, three.score]),
            Some(Candidate {
                vector,
                score: largest,
            }) => {
                let four = l.b.shift_left(bus, 2);
                let twelve = l.b.mul_by(12, largest);
                let along = l.b.sub(four, twelve);
                l.b.name("along_three", along);
                (vector, [bus, along])
            }
            None => {
                let (vector, is_off) = zero_of_pair(l, front.sector);
                let factors = off_legs.zero(l, front, u, is_off);
                change = changes.map(|changes| [bus, zero_with_changes(l, is_off, changes)]);
                (vector, factors)
            }
        };
        let widths: Vec<u32> = factors
            .iter()
            .copied()
            .flatten()
            .chain([rival.1])
            .chain(change)
            .map(|[x, y]| l.b.interval(x).bits() + l.b.interval(y).bits())
            .collect();
        // A product of n + m bits fits n + m - 1; the sum of two and one bit to spare make 31 at most.
        let shift = widths.into_iter().max().unwrap_or(62).saturating_sub(31);
        if shift > 31 {
            l.misfits.push("score".to_owned());
        }
        l.product_format("score", shift, "products of two voltages in scores");
        let word = f64::from(shift).exp2() / l.scale.voltage().powi(2);
        let products = factors.iter_mut().flatten();
        let products = products.chain([&mut rival.1]).chain(change.as_mut());
        let shift = as_upper_words(l, products.collect(), shift);
        let mut best: Option<Candidate> = None;
        for (order, [first, second]) in factors.into_iter().enumerate() {
            let score = l.b.mul_add_floor(first, second, shift);
            l.b.state_error("score", score, [SCORE, "V^2"], word);
            l.b.name(["score_a", "score_c", "score_b"][order], score);
            let next = Candidate {
                vector: vectors[order],
                score,
            };
            best = Some(match best {
                None => next,
                Some(best) => first_least(l, order, best, next),
            });
        }
        let Some(best) = best else {
            return rival.0;
        };
        let [first, second] = rival.1;
        let mut score = match change {
            None => l.b.mul_floor(first, second, shift),
            Some(change) => l.b.mul_add_floor(rival.1, change, shift),
        };
        if three_phase.is_some() && changes.is_none() {
            // V0 scores 0, the best three-phase vector less than that or V0 was taken.
            let zero = l.zero();
            score = l.b.min(score, zero);
        }
        l.b.state_error("score", score, [SCORE, "V^2"], word);
        l.b.name("score_to_beat", score);
        let better = l.b.compare(Comparison::Less, best.score, score);
        l.b.select(better, best.vector, rival.0)
    }
}

/// Shifts the first factors so that what a `shift` takes of the products is their upper words, which take no shift of
/// 64 bits; where one has no room for that, or products fit a word, nothing changes. Returns the shift that is left.
fn as_upper_words(l: &mut Lowering<'_>, mut products: Vec<&mut [Value; 2]>, shift: u32) -> u32 {
    let bits = |value: Value| l.b.interval(value).bits();
    let room = 32_u32.saturating_sub(shift);
    let is_long = products.iter().any(|&&mut [x, y]| bits(x) + bits(y) > 32);
    if !is_long || products.iter().any(|&&mut [x, _]| bits(x) + room > 32) {
        return shift;
    }
    for [first, _] in &mut products {
        *first = l.b.shift_left(*first, room);
    }
    shift + room
}

impl OffLegs {
    /// The factors of the score of a pair's zero vector, by flags of leg a and leg b being off in it.
    pub(super) fn zero(
        &self,
        l: &mut Lowering<'_>,
        front: &Front,
        u: [Value; 3],
        [is_a, is_b]: [Value; 2],
    ) -> [Value; 2] {
        let (flags, lifts) = (self.conducting, self.lifts);
        let lift = l.pick(is_a, is_b, lifts);
        let u_off = l.pick(is_a, is_b, u);
        let inward = l.pick(is_a, is_b, flags.map(|pair| pair[0]));
        let outward = l.pick(is_a, is_b, flags.map(|pair| pair[1]));
        let zero = l.zero();
        let free = l.b.clamp(lift, zero, front.bus.volts);
        let outer = l.b.select(outward, front.bus.volts, free);
        let zero = l.zero();
        let tau = l.b.select(inward, zero, outer);
        l.b.name("tau_zero", tau);
        let four = l.b.shift_left(tau, 2);
        let twelve = l.b.mul_by(12, u_off);
        let aside = l.b.sub(four, twelve);
        l.b.name("aside_zero", aside);
        [tau, aside]
    }
}

pub(super) fn zero_vector(l: &mut Lowering<'_>, sector: Value) -> Value {
    let table = l.b.program.column(
        "sector",
        "zero_vector",
        zero_vectors(),
        &["Zero vector of the pair of sectors 1 to 6: its legs low, the third off.".to_owned()],
    );
    let vector = l.b.lookup(table, sector);
    l.b.name("pair_zero_vector", vector)
}

/// The zero vector of the sector's pair; flags: leg a, leg b is off in it.
pub(super) fn zero_of_pair(l: &mut Lowering<'_>, sector: Value) -> (Value, [Value; 2]) {
    let vector = zero_vector(l, sector);
    let is_off = [(13, "a_is_off"), (14, "b_is_off")].map(|(number, name)| {
        let number = l.b.literal(number);
        let is_off = l.b.compare(Comparison::Equal, vector, number);
        l.b.name(name, is_off)
    });
    (vector, is_off)
}

/// States the error of the scores V (4 V - 12 u) and V (3 V - 6 line): no phase is further off than the third, and no
/// line than twice that.
fn state_exact_scores(l: &mut Lowering<'_>, u_c: Value) {
    state_score_over_bus(l, u_c, 12.0);
}

/// States the error of a voltage of which `weight` times the greatest bus is a score.
pub(super) fn state_score_over_bus(l: &mut Lowering<'_>, voltage: Value, weight: f64) {
    let bus = l.spec.inverter.greatest_bus();
    let word = weight * bus / l.scale.voltage();
    l.b.state_error("score", voltage, [SCORE, "V^2"], word);
}

/// Three-phase vectors by the pattern of low legs.
pub(super) fn vector_of_low_legs(l: &mut Lowering<'_>) -> TableId {
    l.b.program.table(
        "vector_of_low_legs",
        vec![0, 6, 2, 1, 4, 5, 3, 0],
        &[
            "Three-phase vector of a pattern of low legs: bit 0 leg a low, bit 1 leg b, bit 2 leg c."
                .to_owned(),
        ],
    )
}

/// The index of three flags: the sum of 1, 2 and 4.
fn index_of_flags(l: &mut Lowering<'_>, name: &str, flags: [Value; 3]) -> Value {
    let [first, second, third] = [0, 1, 2].map(|bit| {
        let (set, clear) = (l.b.literal(1 << bit), l.zero());
        l.b.select(flags[bit], set, clear)
    });
    let pair = l.b.add(first, second);
    let index = l.b.add(pair, third);
    l.b.name(name, index)
}

/// `value - 1` where the flag holds, else `value`: negative, too, for a zero that the flag tells to lie low.
fn lowered_by(l: &mut Lowering<'_>, value: Value, flag: Value) -> Value {
    let (one, zero) = (l.b.literal(1), l.zero());
    let step = l.b.select(flag, one, zero);
    l.b.sub(value, step)
}

/// Flag: the value is negative, told by its sign bit alone.
fn is_negative(l: &mut Lowering<'_>, name: &str, value: Value) -> Value {
    let zero = l.zero();
    let flag = l.b.compare(Comparison::Less, value, zero);
    l.b.name(name, flag)
}

/// The greatest magnitude of three voltages that add up to zero: the sum of those above it.
fn largest_of_zero_sum(l: &mut Lowering<'_>, u: [Value; 3]) -> Value {
    let zero = l.zero();
    let [a, b, c] = u.map(|u| l.b.max(u, zero));
    let pair = l.b.add(a, b);
    let largest = l.b.add(pair, c);
    l.b.name("u_largest", largest)
}

/// Flag: a magnitude is more than a third of the bus. A whole voltage is beyond the share exactly where it is beyond
/// its whole part.
fn is_beyond_third(l: &mut Lowering<'_>, largest: Value, bus: Value) -> Value {
    match l.spec.inverter.bus {
        BusSource::Fixed => {
            let third = l.nominal_bus() / 3;
            let third = l.voltage("third_of_bus", third, "A third of the bus");
            l.b.compare(Comparison::Less, third, largest)
        }
        BusSource::Measured { .. } => {
            let triple = l.b.mul_by(3, largest);
            l.b.name("u_triple", triple);
            l.b.compare(Comparison::Less, bus, triple)
        }
    }
}

/// Flag: one of the line voltages is farther from zero than half the bus.
fn any_beyond_half(l: &mut Lowering<'_>, lines: [Value; 3], bus: Value) -> Value {
    let names = ["line_a_twice", "line_c_twice", "line_b_twice"];
    let [a, b, c] = [0, 1, 2].map(|x| {
        let (volts, limits) = match l.spec.inverter.bus {
            BusSource::Fixed => {
                let half = l.nominal_bus() / 2;
                let half = [0, 1].map(|_| l.voltage("half_bus", half, "Half the bus"));
                (lines[x], half)
            }
            BusSource::Measured { .. } => {
                let twice = l.b.mul_by(2, lines[x]);
                l.b.name(names[x], twice);
                (twice, [bus, bus])
            }
        };
        let above = l.b.compare(Comparison::Less, limits[0], volts);
        let negative = l.b.neg(limits[1]);
        let below = l.b.compare(Comparison::Less, volts, negative);
        l.b.or(above, below)
    });
    let pair = l.b.or(a, b);
    l.b.or(pair, c)
}

/// The legs that are low in the nearest to `u` of V1 to V6: as a pattern and as flags.
fn low_legs_of(l: &mut Lowering<'_>, u: [Value; 3]) -> (Value, [Value; 3]) {
    // A zero lies as the leg does in the first of the two tied vectors: b low, a as b, c unlike b. The words tell
    // by their signs once a one is taken from those that lie low.
    let one = l.b.literal(1);
    let b_under = l.b.sub(u[1], one);
    let b_is_low = is_negative(l, "b_is_low", b_under);
    let a_under = lowered_by(l, u[0], b_is_low);
    let a_is_low = is_negative(l, "a_is_low", a_under);
    let zero = l.zero();
    let b_is_negative = l.b.compare(Comparison::Less, u[1], zero);
    let b_is_not = l.b.not(b_is_negative);
    let c_under = lowered_by(l, u[2], b_is_not);
    let c_is_low = is_negative(l, "c_is_low", c_under);
    let is_low = [a_is_low, b_is_low, c_is_low];
    (index_of_flags(l, "low_legs", is_low), is_low)
}

/// V0 to V6: the nearest to `u`, and the legs that are low in the nearest of V1 to V6.
fn nearest_three_phase(
    l: &mut Lowering<'_>,
    u: [Value; 3],
    largest: Value,
    bus: Value,
) -> (Value, [Value; 3]) {
    let (low_legs, is_low) = low_legs_of(l, u);
    let table = vector_of_low_legs(l);
    let active = l.b.lookup(table, low_legs);
    let beyond = is_beyond_third(l, largest, bus);
    let zero = l.zero();
    let vector = l.b.select(beyond, active, zero);
    l.b.name("vector_three", vector);
    (vector, is_low)
}

/// Of the two vectors that leave one leg off, the one with the greater line voltage: its number and that voltage.
fn better_of_two(
    l: &mut Lowering<'_>,
    order: usize,
    u: [Value; 3],
    plus: usize,
    minus: usize,
) -> (Value, Value) {
    let line = l.b.sub(u[plus], u[minus]);
    l.b.name(["line_a", "line_c", "line_b"][order], line);
    let zero = l.zero();
    let is_back = l.b.compare(Comparison::Less, line, zero);
    let (first, second) = (
        l.b.literal(7 + order as i32),
        l.b.literal(10 + order as i32),
    );
    let vector = l.b.select(is_back, second, first);
    l.b.name(["pair_a", "pair_c", "pair_b"][order], vector);
    let size = l.b.abs(line);
    l.b.name(["size_a", "size_c", "size_b"][order], size);
    (vector, size)
}

/// That vector with its score over the bus, the off leg left out.
fn along_better(l: &mut Lowering<'_>, order: usize, bus: Value, u: [Value; 3]) -> Candidate {
    let (_, plus, minus) = PAIRS[order];
    let (vector, size) = better_of_two(l, order, u, plus, minus);
    let gain = l.b.mul_by(3, bus);
    let six = l.b.mul_by(6, size);
    let score = l.b.sub(gain, six);
    l.b.name(["along_a", "along_c", "along_b"][order], score);
    Candidate { vector, score }
}

/// The candidate of the lesser score; on a tie that of the lesser number.
pub(super) fn first_least(
    l: &mut Lowering<'_>,
    order: usize,
    best: Candidate,
    next: Candidate,
) -> Candidate {
    let less = l.b.compare(Comparison::Less, next.score, best.score);
    let equal = l.b.compare(Comparison::Equal, next.score, best.score);
    let earlier = l.b.compare(Comparison::Less, next.vector, best.vector);
    let tied = l.b.and(equal, earlier);
    let take = l.b.or(less, tied);
    l.b.name(["take_a", "take_c", "take_b"][order], take);
    let vector = l.b.select(take, next.vector, best.vector);
    l.b.name(["best_a", "best_c", "best_b"][order], vector);
    let score = l.b.select(take, next.score, best.score);
    l.b.name(
        ["best_score_a", "best_score_c", "best_score_b"][order],
        score,
    );
    Candidate { vector, score }
}

/// The nominal pair vector of the greatest line voltage and that voltage.
fn greatest_line(l: &mut Lowering<'_>, u: [Value; 3]) -> (Value, Value) {
    let mut best: Option<Candidate> = None;
    for (order, (_, plus, minus)) in PAIRS.into_iter().enumerate() {
        let (vector, size) = better_of_two(l, order, u, plus, minus);
        let score = l.b.neg(size);
        l.b.name(["score_a", "score_c", "score_b"][order], score);
        let next = Candidate { vector, score };
        best = Some(match best {
            None => next,
            Some(best) => first_least(l, order, best, next),
        });
    }
    match best {
        Some(best) => {
            let size = l.b.neg(best.score);
            (best.vector, l.b.name("line_largest", size))
        }
        None => (u[0], u[0]),
    }
}

fn pair_stage(l: &mut Lowering<'_>) {
    l.b.stage(
        "nearest_pair",
        &[
            "The pair vector nearest to the deadbeat voltage: the one of the greatest line voltage, and the zero vector while",
            "that is at most half the bus. Ties go to the vector that stands first in V12 to V61.",
        ],
    );
}

fn nearest_nominal(l: &mut Lowering<'_>, front: &Front, u: [Value; 3]) -> Value {
    let idle = zero_vector(l, front.sector);
    let lines = PAIRS.map(|(_, plus, minus)| l.b.sub(u[plus], u[minus]));
    for (name, line) in ["line_a", "line_c", "line_b"].into_iter().zip(lines) {
        l.b.name(name, line);
    }
    // The order of the phase voltages is that of the vector's legs. Equal phases are in the order that the first of
    // the tied vectors has: a above b, c above b unless a is below both, and a above c where b is above both.
    let [line_a, line_c, line_b] = lines;
    let a_below_b = is_negative(l, "a_below_b", line_c);
    let c_over_b = lowered_by(l, line_a, a_below_b);
    let c_below_b = is_negative(l, "c_below_b", c_over_b);
    let b_not_above = l.b.not(a_below_b);
    let a_over_c = lowered_by(l, line_b, b_not_above);
    let a_below_c = is_negative(l, "a_below_c", a_over_c);
    let order = index_of_flags(l, "order", [a_below_b, c_below_b, a_below_c]);
    let table = l.b.program.table(
        "pair_of_order",
        vec![8, 0, 9, 10, 7, 12, 0, 11],
        &["Pair vector of an order of the phase voltages, from the highest to the lowest: bit 0 a below b, bit 1 c below b, bit 2 a below c (two patterns are none).".to_owned()],
    );
    let active = l.b.lookup(table, order);
    let beyond = any_beyond_half(l, lines, front.bus.volts);
    l.b.select(beyond, active, idle)
}

fn nearest_of_all(
    l: &mut Lowering<'_>,
    front: &Front,
    u: [Value; 3],
    three: Value,
    largest: Value,
) -> Value {
    pair_stage(l);
    let (vector, line) = greatest_line(l, u);
    // Scores over the bus: three-phase 4 V - 12 u or 0, pair 3 V - 6 line.
    let four = l.b.shift_left(front.bus.volts, 2);
    let twelve = l.b.mul_by(12, largest);
    let of_three = l.b.sub(four, twelve);
    let zero = l.zero();
    let of_three = l.b.min(of_three, zero);
    let three_bus = l.b.mul_by(3, front.bus.volts);
    let six = l.b.mul_by(6, line);
    let of_pair = l.b.sub(three_bus, six);
    let better = l.b.compare(Comparison::Less, of_pair, of_three);
    l.b.select(better, vector, three)
}
