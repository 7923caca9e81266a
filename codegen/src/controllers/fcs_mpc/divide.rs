//! A second vector in the period of the chosen one (semantics, step 10a): the nearest point between the two.
//!
//! Of three-phase vectors the two nearest to u are corners of one triangle of the hexagon, so the point lies on
//! its nearest edge: per leg a clamp. A pair vector shares its period with the zero that has the same leg off.

use super::choose::Choice;
use crate::controllers::current_loop::{CurrentLoop, Front};
use crate::controllers::whole_vectors::off_leg_table;
use crate::ir::{Comparison, Value};
use crate::lower::{Applied, Command, Lowering};

/// Terminal voltages of the legs: the share of the period for which they are high, of the bus.
type Terminals = [Value; 3];

/// The pair whose line voltage is pulsed.
struct Pair {
    /// Flags: the leg that is off.
    is_off: [Value; 3],
    /// The leg that it turns off, 1 to 3; 0 where no pair is pulsed.
    off: Value,
    /// Flag: a pair is pulsed.
    pulsed: Value,
    /// The terminal of its high leg.
    volts: Value,
    terminals: Terminals,
}

impl CurrentLoop<'_, '_> {
    /// Divides the period between the chosen vector and its partner, and closes the step.
    pub(super) fn apply_two_vectors(&mut self, front: &Front, choice: &Choice) {
        let l = &mut *self.lowering;
        let three = nearest_edge(l, front, choice);
        let pair = front.commutation.map(|_| divide_pair(l, front, choice));
        l.b.stage(
            "share_period",
            &["The share of the period for which each leg is high, of the bus; without a sector all legs are low."],
        );
        let zero = l.zero();
        let known = l.b.compare(Comparison::NotEqual, front.sector, zero);
        l.b.name("sector_is_known", known);
        let terminals = [0, 1, 2].map(|x| {
            let own = match &pair {
                Some(pair) => l.b.select(pair.pulsed, pair.terminals[x], three[x]),
                None => three[x],
            };
            let zero = l.zero();
            let own = l.b.select(known, own, zero);
            l.b.name(["t_a_chosen", "t_b_chosen", "t_c_chosen"][x], own)
        });
        l.b.stage(
            "drive_legs",
            &["Legs of the two vectors: a leg is pulsed for its share of the period, and low without any."],
        );
        let command = Command {
            compares: [0, 1, 2].map(|x| {
                let name = ["compare_a_chosen", "compare_b_chosen", "compare_c_chosen"][x];
                l.compare_of(name, terminals[x], front.bus, None)
            }),
            legs: [0, 1, 2].map(|x| {
                let zero = l.zero();
                let is_pulsed = l.b.compare(Comparison::Less, zero, terminals[x]);
                let (pulsed, low) = (l.b.literal(0), l.b.literal(1));
                let leg = l.b.select(is_pulsed, pulsed, low);
                let leg = match &pair {
                    Some(pair) => {
                        let off = l.b.literal(2);
                        l.b.select(pair.is_off[x], off, leg)
                    }
                    None => leg,
                };
                l.b.name(["leg_a_chosen", "leg_b_chosen", "leg_c_chosen"][x], leg)
            }),
        };
        let v_cmd = (!self.needs.off_leg).then(|| mean_voltage(l, front, terminals, pair.as_ref()));
        let applied = pair.filter(|_| self.needs.off_leg).map(|pair| Applied {
            terminals,
            off: pair.off,
        });
        self.remember(front, &command, v_cmd, applied, vec![]);
    }
}

/// The point nearest to u on the edge between the two nearest of V0 to V6.
fn nearest_edge(l: &mut Lowering<'_>, front: &Front, choice: &Choice) -> Terminals {
    let bus = front.bus.volts;
    l.b.stage(
        "nearest_edge",
        &[
            "Two three-phase vectors and the time of each: the point nearest to the deadbeat voltage on the nearest edge of its",
            "triangle. While no neighbour of the nearest of V1 to V6 is nearer than V0, V0 shares its period, and its legs are high for",
            "3/2 of the phase voltage; else that neighbour does, and each leg is at (V + 3 u)/2, within the rails.",
        ],
    );
    let second = l.b.min(choice.heights[0], choice.heights[1]);
    let triple = l.b.mul_by(3, second);
    let beside_zero = l.b.compare(Comparison::LessEqual, triple, bus);
    l.b.name("beside_zero", beside_zero);
    let triple = l.b.mul_by(3, choice.largest);
    let height = l.b.shift_right(triple, 1);
    let zero = l.zero();
    let height = l.b.clamp(height, zero, bus);
    l.b.name("t_beside_zero", height);
    [0, 1, 2].map(|x| {
        let zero = l.zero();
        let lone = l.b.select(choice.is_low[x], zero, height);
        let triple = l.b.mul_by(3, choice.u[x]);
        let twice = l.b.add(bus, triple);
        let edge = l.b.shift_right(twice, 1);
        let zero = l.zero();
        let edge = l.b.clamp(edge, zero, bus);
        let terminal = l.b.select(beside_zero, lone, edge);
        l.b.name(["t_a_three", "t_b_three", "t_c_three"][x], terminal)
    })
}

/// The better vector with the leg off that the chosen vector turns off, for the time of the least error.
fn divide_pair(l: &mut Lowering<'_>, front: &Front, choice: &Choice) -> Pair {
    let (bus, [u_a, u_b, u_c]) = (front.bus.volts, choice.u);
    l.b.stage(
        "divide_pair",
        &[
            "A pair vector and the zero with the same leg off: the line voltage counts while that leg floats, and the voltage of the",
            "pulsed leg alone while a diode holds it at a rail.",
        ],
    );
    let table = off_leg_table(l);
    let off = l.b.lookup(table, choice.vector);
    l.b.name("off_chosen", off);
    let zero = l.zero();
    let pulsed = l.b.compare(Comparison::NotEqual, off, zero);
    l.b.name("pair_is_pulsed", pulsed);
    let is_off = [0, 1, 2].map(|x| {
        let number = l.b.literal(x + 1);
        let flag = l.b.compare(Comparison::Equal, off, number);
        l.b.name(
            ["a_is_off_leg", "b_is_off_leg", "c_is_off_leg"][x as usize],
            flag,
        )
    });
    let [is_a, is_b, _] = is_off;
    // High and low in the first of the two vectors with that leg off.
    let plus = l.b.select(is_a, u_c, u_a);
    l.b.name("u_plus", plus);
    let minus = l.b.select(is_b, u_c, u_b);
    l.b.name("u_minus", minus);
    let back = l.b.compare(Comparison::Less, plus, minus);
    l.b.name("pair_is_back", back);
    let line = l.b.sub(plus, minus);
    let size = l.b.abs(line);
    let volts = match choice.conducting {
        None => size,
        Some(flags) => {
            l.b.name("line_size", size);
            let inward = l.pick(is_a, is_b, flags.map(|pair| pair[0]));
            let outward = l.pick(is_a, is_b, flags.map(|pair| pair[1]));
            l.b.name("off_outward", outward);
            let zero = l.zero();
            let rail = l.b.select(outward, bus, zero);
            let own = l.b.select(back, minus, plus);
            l.b.name("u_pulsed", own);
            let lifted = l.b.add(rail, own);
            let half = l.b.shift_right(lifted, 1);
            let held = l.b.add(own, half);
            let is_held = l.b.or(inward, outward);
            l.b.select(is_held, held, size)
        }
    };
    let zero = l.zero();
    let volts = l.b.clamp(volts, zero, bus);
    l.b.name("t_pair", volts);
    // Forward, a is high with b or c off and c with a off; back, b is high with a or c off and c with b off.
    let forward = l.b.not(back);
    l.b.name("pair_is_forward", forward);
    let either = l.b.select(is_b, back, forward);
    let terminals = [forward, back, either].into_iter().zip(is_off).enumerate();
    let terminals = terminals.map(|(x, (sense, is_off))| {
        let is_driven = l.b.not(is_off);
        let is_high = l.b.and(is_driven, sense);
        let zero = l.zero();
        let terminal = l.b.select(is_high, volts, zero);
        l.b.name(["t_a_pair", "t_b_pair", "t_c_pair"][x], terminal)
    });
    let terminals: Vec<Value> = terminals.collect();
    Pair {
        is_off,
        off,
        pulsed,
        volts,
        terminals: [terminals[0], terminals[1], terminals[2]],
    }
}

/// Mean phase voltages a, b of the terminals; an off leg lies midway between the two others.
fn mean_voltage(
    l: &mut Lowering<'_>,
    front: &Front,
    terminals: Terminals,
    pair: Option<&Pair>,
) -> [Value; 2] {
    let midway = pair.map(|pair| {
        let half = l.b.shift_right(pair.volts, 1);
        (pair.is_off, l.b.name("t_midway", half))
    });
    let terminals = [0, 1, 2].map(|x| match midway {
        Some((is_off, half)) => {
            let terminal = l.b.select(is_off[x], half, terminals[x]);
            l.b.name(["t_a_mean", "t_b_mean", "t_c_mean"][x], terminal)
        }
        None => terminals[x],
    });
    let sum = l.b.add(terminals[0], terminals[1]);
    let sum = l.b.add(sum, terminals[2]);
    let mean = l.times(front.third, sum);
    l.b.name("t_mean", mean);
    [0, 1].map(|x| {
        let volts = l.b.sub(terminals[x], mean);
        l.b.name(["v_a_chosen", "v_b_chosen"][x], volts)
    })
}
