//! The choice where the cost has weights (semantics, step 10w).
//!
//! A weight of switching alone is folded as the plain choice is: over the three-phase set it gives each leg's sign a
//! hysteresis, and of two pair vectors with the same leg off the better one is told exactly. The weight of the torque
//! couples the legs: its list is enumerated.

use super::choose::{
    Candidate, OffLegs, PAIRS, SCORE, first_least, state_score_over_bus, zero_of_pair,
};
use crate::controllers::current_loop::{CurrentLoop, Front};
use crate::controllers::whole_vectors::vector_legs;
use crate::diagnostics::engineering;
use crate::ir::{Comparison, StateId, Value};
use crate::lower::{Coefficient, Lowering};
use crate::spec::{Candidates, FcsMpcSpec};

/// Three-phase vectors in the order of their gate patterns, bit 0 leg a, bit 1 leg b, bit 2 leg c.
const BY_GATES: [usize; 6] = [3, 5, 4, 1, 2, 6];

/// What the change of each leg to high, low and off costs, in multiples of the bus.
pub(super) struct Changes([[Value; 3]; 3]);

/// A vector's score as products.
struct Weighed {
    vector: Value,
    /// Number, for names.
    number: usize,
    /// At most two, rounded as one.
    products: Vec<[Value; 2]>,
    torque: Torque,
}

/// What the torque's error adds to a score.
enum Torque {
    /// The line of the pair has no voltage.
    Nothing,
    /// The product of these.
    Factors([Value; 2]),
    /// By the phase that is out: 1 the pair's line has the bus, -1 the bus reversed, 0 none.
    Lines([i32; 3]),
}

impl Weighed {
    fn all_products(&self) -> impl Iterator<Item = &[Value; 2]> {
        let of_torque = match &self.torque {
            Torque::Factors(factors) => Some(factors),
            Torque::Nothing | Torque::Lines(_) => None,
        };
        self.products.iter().chain(of_torque)
    }
}

/// The line of the conducting pair.
struct TorqueLine {
    weight: Coefficient,
    is_out: [Value; 2],
    twice_u: Value,
}

impl CurrentLoop<'_, '_> {
    /// The allowed vector of least weighted cost.
    pub(super) fn choose_weighted(
        &mut self,
        options: &FcsMpcSpec,
        front: &Front,
        u: [Value; 2],
        memory: Option<StateId>,
    ) -> Value {
        let (stiffness, v_bus) = (self.design.k_di, self.lowering.spec.inverter.v_bus);
        let l = &mut *self.lowering;
        let changes = memory.map(|memory| {
            let volts = 9.0 * (stiffness * options.switching_weight).powi(2) / v_bus;
            changes(l, memory, volts, options.switching_weight)
        });
        l.b.stage("third_phase", &["The deadbeat voltage of the third phase."]);
        let u_c = l.third_phase("u_c_unsat", u[0], u[1]);
        let phases = [u[0], u[1], u_c];
        let off_legs = self.predict_off_legs(options, front, phases);
        let vector = match changes {
            Some(changes) if options.torque_weight <= 0.0 => {
                self.fewest_changes(options, front, phases, off_legs.as_ref(), &changes)
            }
            changes => self.try_all(options, front, phases, off_legs.as_ref(), changes.as_ref()),
        };
        self.lowering.b.name("vector", vector)
    }

    /// The folded choice, with a weight of switching alone.
    fn fewest_changes(
        &mut self,
        options: &FcsMpcSpec,
        front: &Front,
        u: [Value; 3],
        off_legs: Option<&OffLegs>,
        changes: &Changes,
    ) -> Value {
        let three = nearest_by_gains(&mut *self.lowering, u, front.bus.volts, changes);
        if off_legs.is_none() {
            state_score_over_bus(&mut *self.lowering, three.score, 1.0);
        }
        let rival = (options.candidates == Candidates::All).then_some(three);
        let pair = front.commutation.map(|commutation| {
            let vector = match off_legs {
                Some(off_legs) => self.nearest_physical(off_legs, front, u, Some(changes), rival),
                None => nearest_exact(&mut *self.lowering, front, u, changes, rival),
            };
            (commutation.flag, vector)
        });
        match (options.candidates, pair) {
            (Candidates::ThreePhase, _) | (_, None) => three.vector,
            (Candidates::All, Some((_, vector))) => vector,
            (Candidates::Table2, Some((commutating, vector))) => {
                let l = &mut *self.lowering;
                l.b.select(commutating, three.vector, vector)
            }
        }
    }

    /// One candidate after the other, with a weight of the torque.
    fn try_all(
        &mut self,
        options: &FcsMpcSpec,
        front: &Front,
        u: [Value; 3],
        off_legs: Option<&OffLegs>,
        changes: Option<&Changes>,
    ) -> Value {
        let l = &mut *self.lowering;
        l.b.stage(
            "weigh_candidates",
            &[
                "The scores 6 (|v|^2 - 2 u v) of the list, with what the error along the sector's mean EMF, the line of its pair, weighs",
                "on top. Each is a sum of products; the least is taken, the first of equals.",
            ],
        );
        let bus = front.bus.volts;
        let (pair_zero, is_off) = zero_of_pair(l, front.sector);
        let torque = torque_line(l, options, is_off, u);
        let (forward, backward) = line_terms(l, bus, &torque);
        let mut three = vec![zero_of_three(l, bus, changes)];
        let mut pairs = vec![];
        if options.candidates != Candidates::ThreePhase {
            if options.candidates == Candidates::Table2 {
                let products = zero_products(l, front, u, off_legs, changes, is_off);
                pairs.push(Weighed {
                    vector: pair_zero,
                    number: 13,
                    products,
                    torque: Torque::Nothing,
                });
            }
            let beside = beside_pairs(l, bus, off_legs);
            for number in 7..13 {
                pairs.push(pair_vector(l, number, bus, u, &beside, changes, &torque));
            }
        }
        three.extend(BY_GATES.map(|number| three_phase_vector(l, number, bus, u, changes)));
        let widths = three.iter().chain(&pairs).flat_map(Weighed::all_products);
        let widest = widths
            .chain([&forward, &backward])
            .map(|[x, y]| l.b.interval(*x).bits() + l.b.interval(*y).bits())
            .max();
        // Three products of n + m - 1 bits at the most add up to two bits more.
        let shift = widest.unwrap_or(62).saturating_sub(30);
        if shift > 31 {
            l.misfits.push("score".to_owned());
        }
        l.product_format("score", shift, "products of two voltages in scores");
        let terms =
            [("torque_forward", forward), ("torque_backward", backward)].map(|(name, [x, y])| {
                let term = l.b.mul_floor(x, y, shift);
                l.b.name(name, term)
            });
        match (options.candidates, front.commutation) {
            (Candidates::All, _) => {
                three.extend(pairs);
                least(l, three, shift, &torque, terms)
            }
            (Candidates::Table2, Some(commutation)) => {
                let three = least(l, three, shift, &torque, terms);
                let pair = least(l, pairs, shift, &torque, terms);
                l.b.select(commutation.flag, three, pair)
            }
            _ => least(l, three, shift, &torque, terms),
        }
    }
}

/// Looks up what the changes cost: `volts` each, in multiples of the bus.
fn changes(l: &mut Lowering<'_>, memory: StateId, volts: f64, weight: f64) -> Changes {
    l.b.stage(
        "cost_of_changes",
        &["What it costs to turn each leg high, low and off, by the vector of the last step."],
    );
    let cost = l.volts_word(volts);
    if i32::try_from(cost).is_err() {
        l.misfits.push("switching_weight".to_owned());
    }
    let doc = format!(
        "by the vector of the last step: 0, or 9 (K {})^2/v_bus = {} in scores over the bus, words of voltage.",
        engineering(weight, "A"),
        engineering(volts, "V")
    );
    let last = l.b.state(memory);
    Changes([0, 1, 2].map(|x| {
        let phase = ["a", "b", "c"][x];
        [("high", 1), ("low", -1), ("off", 0)].map(|(state, sign)| {
            let name = format!("change_to_{state}_{phase}");
            let costs = vector_legs().map(|legs| if legs[x] == sign { 0 } else { cost as i32 });
            let doc = format!("What turning leg {phase} {state} costs {doc}");
            let table = l.b.program.table(&name, costs.to_vec(), &[doc]);
            let found = l.b.lookup(table, last);
            l.b.name(&format!("to_{state}_{phase}"), found)
        })
    }))
}

impl Changes {
    /// What it costs to go to a vector.
    pub fn of(&self, l: &mut Lowering<'_>, number: usize) -> Value {
        let legs = vector_legs()[number];
        let own = |x: usize| match legs[x] {
            1 => self.0[x][0],
            -1 => self.0[x][1],
            _ => self.0[x][2],
        };
        let sum = l.b.add(own(0), own(1));
        l.b.add(sum, own(2))
    }
}

/// The best of V0 to V6, with its exact score over the bus.
fn nearest_by_gains(
    l: &mut Lowering<'_>,
    u: [Value; 3],
    bus: Value,
    changes: &Changes,
) -> Candidate {
    l.b.stage(
        "nearest_vector",
        &[
            "The three-phase vector of least cost: a leg is high where twelve times its phase voltage gains more than its change costs",
            "over staying low. Not all three can be: then the one that gains least is not. V0 while the gains are at most four times the bus.",
        ],
    );
    let gains = [0, 1, 2].map(|x| {
        let twelve = l.b.mul_by(12, u[x]);
        let spared = l.b.sub(changes.0[x][1], changes.0[x][0]);
        let gain = l.b.add(twelve, spared);
        l.b.name(["gain_a", "gain_b", "gain_c"][x], gain)
    });
    let mut gates = l.zero();
    let mut sum = l.zero();
    for (x, gain) in gains.into_iter().enumerate() {
        let zero = l.zero();
        let is_high = l.b.compare(Comparison::Less, zero, gain);
        let (on, off) = (l.b.literal(1 << x), l.zero());
        let bit = l.b.select(is_high, on, off);
        let zero = l.zero();
        let raised = l.b.max(gain, zero);
        (gates, sum) = if x == 0 {
            (bit, raised)
        } else {
            (l.b.add(gates, bit), l.b.add(sum, raised))
        };
    }
    l.b.name("gates_gained", gates);
    let least = l.b.min(gains[0], gains[1]);
    let least = l.b.min(least, gains[2]);
    l.b.name("gain_least", least);
    let zero = l.zero();
    let spare = l.b.max(least, zero);
    let gained = l.b.sub(sum, spare);
    l.b.name("gained", gained);
    let c_is_least = l.b.compare(Comparison::LessEqual, gains[2], least);
    let b_is_least = l.b.compare(Comparison::LessEqual, gains[1], least);
    let (without_a, without_b, without_c) = (l.b.literal(6), l.b.literal(5), l.b.literal(3));
    let two = l.b.select(b_is_least, without_b, without_a);
    let two = l.b.select(c_is_least, without_c, two);
    let zero = l.zero();
    let all = l.b.compare(Comparison::Less, zero, least);
    let gates = l.b.select(all, two, gates);
    l.b.name("gates", gates);
    let table = l.b.program.table(
        "vector_of_gates",
        vec![0, 3, 5, 4, 1, 2, 6, 0],
        &[
            "Three-phase vector of a gate pattern: bit 0 leg a high, bit 1 leg b, bit 2 leg c."
                .to_owned(),
        ],
    );
    let active = l.b.lookup(table, gates);
    let four = l.b.shift_left(bus, 2);
    let idle = l.b.compare(Comparison::LessEqual, gained, four);
    let zero = l.zero();
    let vector = l.b.select(idle, zero, active);
    l.b.name("vector_three", vector);
    let four = l.b.shift_left(bus, 2);
    let along = l.b.sub(four, gained);
    let zero = l.zero();
    let along = l.b.min(along, zero);
    let lowered = changes.of(l, 0);
    let score = l.b.add(along, lowered);
    l.b.name("along_three", score);
    Candidate { vector, score }
}

/// Of the two vectors that leave one leg off, the one of the lesser score over the bus, and that score.
pub(super) fn better_with_changes(
    l: &mut Lowering<'_>,
    order: usize,
    bus: Value,
    u: [Value; 3],
    changes: &Changes,
) -> Candidate {
    let (_, plus, minus) = PAIRS[order];
    let name = ["a", "c", "b"][order];
    let line = l.b.sub(u[plus], u[minus]);
    let six = l.b.mul_by(6, line);
    l.b.name(&format!("line_{name}"), six);
    let scores = [7 + order, 10 + order].map(|number| {
        let gain = l.b.mul_by(3, bus);
        let along = if number < 10 {
            l.b.sub(gain, six)
        } else {
            l.b.add(gain, six)
        };
        let cost = changes.of(l, number);
        let along = l.b.add(along, cost);
        let side = if number < 10 { "forward" } else { "back" };
        l.b.name(&format!("{side}_{name}"), along)
    });
    let is_back = l.b.compare(Comparison::Less, scores[1], scores[0]);
    let (first, second) = (
        l.b.literal(7 + order as i32),
        l.b.literal(10 + order as i32),
    );
    let vector = l.b.select(is_back, second, first);
    l.b.name(&format!("pair_{name}"), vector);
    let score = l.b.min(scores[0], scores[1]);
    l.b.name(&format!("along_{name}"), score);
    Candidate { vector, score }
}

/// What it costs to go to the zero vector of the sector's pair; flags: leg a, leg b is off in it.
pub(super) fn zero_with_changes(
    l: &mut Lowering<'_>,
    [is_a, is_b]: [Value; 2],
    changes: &Changes,
) -> Value {
    let costs = [13, 14, 15].map(|number| changes.of(l, number));
    let cost = l.pick(is_a, is_b, costs);
    l.b.name("change_to_zero", cost)
}

/// The best pair vector with off legs midway, against the zero vector or the best of V0 to V6: exactly, over the bus.
fn nearest_exact(
    l: &mut Lowering<'_>,
    front: &Front,
    u: [Value; 3],
    changes: &Changes,
    three_phase: Option<Candidate>,
) -> Value {
    l.b.stage(
        "nearest_pair",
        &[
            "The pair vector of least cost against the vector without a pair. Ties go to the vector that stands first in V12 to V61.",
        ],
    );
    let mut best: Option<Candidate> = None;
    for order in 0..PAIRS.len() {
        let next = better_with_changes(l, order, front.bus.volts, u, changes);
        best = Some(match best {
            None => next,
            Some(best) => first_least(l, order, best, next),
        });
    }
    let rival = three_phase.unwrap_or_else(|| {
        let (vector, is_off) = zero_of_pair(l, front.sector);
        let score = zero_with_changes(l, is_off, changes);
        Candidate { vector, score }
    });
    let Some(best) = best else {
        return rival.vector;
    };
    state_score_over_bus(l, best.score, 1.0);
    let better = l.b.compare(Comparison::Less, best.score, rival.score);
    l.b.select(better, best.vector, rival.vector)
}

fn torque_line(
    l: &mut Lowering<'_>,
    options: &FcsMpcSpec,
    is_out: [Value; 2],
    u: [Value; 3],
) -> TorqueLine {
    // A weight needs few bits, and its product with 16-bit words has few to spare.
    let word = if options.common.word == 16 { 8 } else { 32 };
    let weight = l.coefficient(
        "k_torque_weight",
        3.0 * options.torque_weight,
        word,
        "Weight of the torque's error in scores.",
        &format!("3 torque_weight = {}", 3.0 * options.torque_weight),
    );
    let lines = [(1, 2), (2, 0), (0, 1)].map(|(x, y)| l.b.sub(u[x], u[y]));
    let line = l.pick(is_out[0], is_out[1], lines);
    let twice_u = l.b.shift_left(line, 1);
    l.b.name("line_twice", twice_u);
    TorqueLine {
        weight,
        is_out,
        twice_u,
    }
}

/// The factors of the torque's term where the pair's line has that voltage.
fn torque_factors(l: &mut Lowering<'_>, line: Value, torque: &TorqueLine) -> [Value; 2] {
    let beside = l.b.sub(line, torque.twice_u);
    [line, l.times(torque.weight, beside)]
}

/// The factors where it has the bus, and the bus reversed.
fn line_terms(l: &mut Lowering<'_>, bus: Value, torque: &TorqueLine) -> ([Value; 2], [Value; 2]) {
    let back = l.b.neg(bus);
    l.b.name("bus_reversed", back);
    (
        torque_factors(l, bus, torque),
        torque_factors(l, back, torque),
    )
}

/// V0.
fn zero_of_three(l: &mut Lowering<'_>, bus: Value, changes: Option<&Changes>) -> Weighed {
    let products = changes.map(|changes| [bus, changes.of(l, 0)]);
    Weighed {
        vector: l.zero(),
        number: 0,
        products: products.into_iter().collect(),
        torque: Torque::Nothing,
    }
}

fn three_phase_vector(
    l: &mut Lowering<'_>,
    number: usize,
    bus: Value,
    u: [Value; 3],
    changes: Option<&Changes>,
) -> Weighed {
    let legs = vector_legs()[number];
    let high = legs.iter().filter(|&&leg| leg == 1).count();
    let lone = if high == 1 { 1 } else { -1 };
    let x = legs.iter().position(|&leg| leg == lone).unwrap_or(0);
    let four = l.b.shift_left(bus, 2);
    let twelve = l.b.mul_by(12 * lone, u[x]);
    let mut along = l.b.sub(four, twelve);
    if let Some(changes) = changes {
        let cost = changes.of(l, number);
        along = l.b.add(along, cost);
    }
    Weighed {
        vector: l.b.literal(number as i32),
        number,
        products: vec![[bus, along]],
        torque: Torque::Lines([(1, 2), (2, 0), (0, 1)].map(|(x, y)| (legs[x] - legs[y]) / 2)),
    }
}

/// A leg that is off beside a driven pair.
#[derive(Clone, Copy)]
struct Beside {
    terminal: Value,
    /// Twice that, less the bus; none midway.
    offset: Option<Value>,
}

fn beside_pairs(l: &mut Lowering<'_>, bus: Value, off_legs: Option<&OffLegs>) -> [Beside; 3] {
    let Some(off_legs) = off_legs else {
        let terminal = l.b.shift_right(bus, 1);
        l.b.name("half_bus", terminal);
        let offset = None;
        return [Beside { terminal, offset }; 3];
    };
    [0, 1, 2].map(|x| {
        let offset = off_legs.offsets[x];
        let twice = l.b.add(offset, bus);
        let terminal = l.b.shift_right(twice, 1);
        l.b.name(["tau_a", "tau_b", "tau_c"][x], terminal);
        let offset = Some(offset);
        Beside { terminal, offset }
    })
}

fn pair_vector(
    l: &mut Lowering<'_>,
    number: usize,
    bus: Value,
    u: [Value; 3],
    beside: &[Beside; 3],
    changes: Option<&Changes>,
    torque: &TorqueLine,
) -> Weighed {
    let legs = vector_legs()[number];
    let place = |sign: i32| legs.iter().position(|&leg| leg == sign).unwrap_or(0);
    let (p, q, off) = (place(1), place(-1), place(0));
    let mut products = vec![];
    if let Some(offset) = beside[off].offset {
        let six = l.b.mul_by(6, u[off]);
        let aside = l.b.sub(offset, six);
        products.push([offset, aside]);
    }
    let line = l.b.sub(u[p], u[q]);
    let gain = l.b.mul_by(3, bus);
    let six = l.b.mul_by(6, line);
    let mut along = l.b.sub(gain, six);
    if let Some(changes) = changes {
        let cost = changes.of(l, number);
        along = l.b.add(along, cost);
    }
    products.push([bus, along]);
    let mut terminals = [beside[off].terminal; 3];
    terminals[p] = bus;
    terminals[q] = l.zero();
    let lines = [(1, 2), (2, 0), (0, 1)].map(|(x, y)| l.b.sub(terminals[x], terminals[y]));
    let [is_a, is_b] = torque.is_out;
    let line = l.pick(is_a, is_b, lines);
    l.b.name(&format!("line_{number}"), line);
    let torque = Torque::Factors(torque_factors(l, line, torque));
    Weighed {
        vector: l.b.literal(number as i32),
        number,
        products,
        torque,
    }
}

/// The zero vector of the sector's pair: its line has no voltage.
fn zero_products(
    l: &mut Lowering<'_>,
    front: &Front,
    u: [Value; 3],
    off_legs: Option<&OffLegs>,
    changes: Option<&Changes>,
    is_off: [Value; 2],
) -> Vec<[Value; 2]> {
    let aside = off_legs.map(|off_legs| off_legs.zero(l, front, u, is_off));
    let cost = changes.map(|changes| {
        let cost = zero_with_changes(l, is_off, changes);
        [front.bus.volts, cost]
    });
    aside.into_iter().chain(cost).collect()
}

/// The first of the least score.
fn least(
    l: &mut Lowering<'_>,
    list: Vec<Weighed>,
    shift: u32,
    torque: &TorqueLine,
    [forward, backward]: [Value; 2],
) -> Value {
    let mut best: Option<Candidate> = None;
    for one in list {
        let mut score = match one.products[..] {
            [] => None,
            [[x, y]] => Some(l.b.mul_floor(x, y, shift)),
            [first, second, ..] => Some(l.b.mul_add_floor(first, second, shift)),
        };
        let term = match one.torque {
            Torque::Nothing => None,
            Torque::Factors([x, y]) => Some(l.b.mul_floor(x, y, shift)),
            Torque::Lines(lines) => {
                let [is_a, is_b] = torque.is_out;
                let terms = lines.map(|line| match line {
                    1 => forward,
                    -1 => backward,
                    _ => l.zero(),
                });
                Some(l.pick(is_a, is_b, terms))
            }
        };
        if let Some(term) = term {
            score = Some(match score {
                None => term,
                Some(score) => l.b.add(score, term),
            });
        }
        let number = one.number;
        let score = match score {
            Some(score) => {
                let word = f64::from(shift).exp2() / l.scale.voltage().powi(2);
                l.b.state_error("score", score, [SCORE, "V^2"], word);
                l.b.name(&format!("score_{number}"), score)
            }
            None => l.zero(),
        };
        let next = Candidate {
            vector: one.vector,
            score,
        };
        best = Some(match best {
            None => next,
            Some(best) => {
                let take = l.b.compare(Comparison::Less, next.score, best.score);
                l.b.name(&format!("take_{number}"), take);
                let vector = l.b.select(take, next.vector, best.vector);
                l.b.name(&format!("best_{number}"), vector);
                let score = l.b.min(next.score, best.score);
                l.b.name(&format!("least_{number}"), score);
                Candidate { vector, score }
            }
        });
    }
    match best {
        Some(best) => best.vector,
        None => l.zero(),
    }
}
