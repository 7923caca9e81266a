//! The choice over two periods (semantics, step 10h).
//!
//! Of all sequences of two vectors that begin with the same one, the best is told by geometry: what is left for the
//! second period is the nearest vector to a known voltage. So a score per first vector remains, in place of their square.

use super::choose::{Candidate, state_score_over_bus};
use crate::controllers::current_loop::{CurrentLoop, Front};
use crate::controllers::whole_vectors::{sixths, vector_legs};
use crate::ir::{Comparison, Value};
use crate::lower::{Coefficient, Lowering};
use crate::spec::{BusSource, Candidates, FcsMpcSpec};

impl CurrentLoop<'_, '_> {
    /// The first vector of the best sequence of two; `e` is the EMF over the target period.
    pub(super) fn choose_two_steps(
        &mut self,
        options: &FcsMpcSpec,
        front: &Front,
        e: [Value; 2],
        u: [Value; 2],
    ) -> Value {
        let pole = self.design.plant.pole;
        let word = self.options.word;
        // What it is multiplied with has up to three bits more than a deadbeat voltage.
        let narrow = if word == 16 { 12 } else { word };
        let with_pairs = options.candidates == Candidates::All;
        let l = &mut *self.lowering;
        let k_pole = l.coefficient(
            "k_pole",
            pole,
            narrow,
            "Share of the current that is left after one period.",
            &format!("a = {pole:.6}"),
        );
        let k_first = l.coefficient(
            "k_first",
            1.0 + pole * pole,
            word,
            "Weight of the square of the first vector.",
            "1 + a^2",
        );
        let k_pole_sixth = l.coefficient(
            "k_pole_sixth",
            pole / 6.0,
            word,
            "What a sixth of the bus, applied first, takes off the voltage that is wanted second.",
            "a/6",
        );
        l.b.stage(
            "second_period",
            &[
                "The deadbeat voltage of the second period behind a zero vector, y = K (1 - a) i_ref + e + a u: reference and EMF are held.",
                "A first vector v moves it by -a v. z = u + a y is what the first vector is compared with in both periods.",
            ],
        );
        let pairs = [0, 1].map(|x| {
            let open = l.b.sub(u[x], front.reference[x]);
            let left = l.times(k_pole, open);
            let held = l.b.add(front.reference[x], e[x]);
            let y = l.b.add(held, left);
            l.b.name(["y_a", "y_b"][x], y);
            let again = l.times(k_pole, y);
            let z = l.b.add(u[x], again);
            [y, l.b.name(["z_a", "z_b"][x], z)]
        });
        let [y, z] = [0, 1].map(|which| {
            let [a, b] = pairs.map(|pair| pair[which]);
            let c = l.third_phase(["y_c", "z_c"][which], a, b);
            [a, b, c]
        });
        let bus = front.bus.volts;
        let first = share_of_bus(l, k_first, bus, "v_first", "(1 + a^2) times the bus");
        let sixth = share_of_bus(
            l,
            k_pole_sixth,
            bus,
            "v_sixth",
            "a sixth of the bus times a",
        );
        l.b.stage(
            "best_sequence",
            &[
                "Per first vector its own share of the score, and that of the best second vector: 0 of V0, over the bus 4 V - 12 y of the",
                "nearest three-phase vector, 3 V - 6 line of the nearest pair. The least is taken, the first of equals.",
            ],
        );
        let last = if with_pairs { 13 } else { 7 };
        let mut best: Option<Candidate> = None;
        for number in 0..last {
            let own = own_share(l, number, first, z);
            let ahead = share_ahead(l, number, with_pairs, bus, sixth, y);
            let score = match own {
                Some(own) => l.b.add(own, ahead),
                None => ahead,
            };
            state_score_over_bus(l, score, 1.0);
            let name = format!("score_{number}");
            let next = Candidate {
                vector: l.b.literal(number as i32),
                score: if own.is_some() {
                    l.b.name(&name, score)
                } else {
                    score
                },
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
        let vector = match best {
            Some(best) => best.vector,
            None => l.zero(),
        };
        l.b.name("vector", vector)
    }
}

/// `mul(coefficient, V)`.
fn share_of_bus(
    l: &mut Lowering<'_>,
    coefficient: Coefficient,
    bus: Value,
    name: &str,
    doc: &str,
) -> Value {
    match l.spec.inverter.bus {
        BusSource::Fixed => {
            let product = l.rounded_product(coefficient, l.nominal_bus());
            l.voltage(name, product, doc)
        }
        BusSource::Measured { .. } => {
            let product = l.times(coefficient, bus);
            l.b.name(name, product)
        }
    }
}

/// F of a first vector; none for V0.
fn own_share(l: &mut Lowering<'_>, number: usize, first: Value, z: [Value; 3]) -> Option<Value> {
    let legs = vector_legs()[number];
    let place = |sign: i32| legs.iter().position(|&leg| leg == sign);
    let high = legs.iter().filter(|&&leg| leg == 1).count();
    Some(match (place(1)?, place(-1)?, place(0)) {
        (p, q, Some(_)) => {
            let gain = l.b.mul_by(3, first);
            let line = l.b.sub(z[p], z[q]);
            let six = l.b.mul_by(6, line);
            l.b.sub(gain, six)
        }
        (p, q, None) => {
            let (x, factor) = if high == 1 { (p, 12) } else { (q, -12) };
            let four = l.b.shift_left(first, 2);
            let twelve = l.b.mul_by(factor, z[x]);
            l.b.sub(four, twelve)
        }
    })
}

/// The least B of a second vector behind the first one.
fn share_ahead(
    l: &mut Lowering<'_>,
    number: usize,
    with_pairs: bool,
    bus: Value,
    sixth: Value,
    y: [Value; 3],
) -> Value {
    let sixths = sixths(vector_legs()[number]);
    let left = [0, 1, 2].map(|x| {
        if sixths[x] == 0 {
            return y[x];
        }
        let moved = l.b.mul_by(sixths[x], sixth);
        let left = l.b.sub(y[x], moved);
        l.b.name(&format!("y_{}_{number}", ["a", "b", "c"][x]), left)
    });
    let names = [format!("y_max_{number}"), format!("y_min_{number}")];
    let [high, low] = l.extremes([&names[0], &names[1]], left);
    let depth = l.b.neg(low);
    let largest = l.b.max(high, depth);
    let twelve = l.b.mul_by(12, largest);
    let four = l.b.shift_left(bus, 2);
    let mut ahead = l.b.sub(four, twelve);
    if with_pairs {
        let line = l.b.sub(high, low);
        let six = l.b.mul_by(6, line);
        let gain = l.b.mul_by(3, bus);
        let pair = l.b.sub(gain, six);
        ahead = l.b.min(ahead, pair);
    }
    let zero = l.zero();
    let ahead = l.b.min(ahead, zero);
    l.b.name(&format!("ahead_{number}"), ahead)
}
