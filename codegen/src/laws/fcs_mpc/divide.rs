//! A second vector in the period of the chosen one (semantics, step 10a): the nearest point between
//! the two.
//!
//! The two three-phase vectors nearest to u are corners of one triangle of the hexagon, so the
//! point lies on its nearest edge: a clamp per leg. A pair vector shares its period with the zero
//! vector of the same off leg.

use super::choose::Choice;
use crate::blocks::{Applied, Command, LOW, Lowering, OFF, PULSED, compare_of};
use crate::ir::{Expr, Flag, Named, Phases, named};
use crate::laws::current_loop::{CurrentLoop, Front};
use crate::laws::whole_vectors::off_leg_table;

/// A pulsed pair; the terminal voltage over the bus is the high leg's share of the period.
struct PulsedPair<'b> {
    /// The off leg, as flags.
    is_off: [Flag<'b>; 3],
    /// Its number, 1 to 3; 0 where no pair is pulsed.
    off: Expr<'b>,
    /// Whether a pair is pulsed.
    pulsed: Flag<'b>,
    /// Terminal voltage of its high leg.
    volts: Expr<'b>,
    terminals: Phases<'b, 3>,
}

impl<'b> CurrentLoop<'_, 'b> {
    /// Divides the period between the chosen vector and its partner, and closes the step.
    pub(super) fn apply_two_vectors(&self, front: &Front<'b>, choice: &Choice<'b>) {
        let l = self.l;
        let three = nearest_edge(l, front.reach.volts, choice);
        let pair = front.commutation;
        let pair = pair.map(|_| divide_pair(l, front, choice));
        let doc = "Share of the period for which each leg is high, as a voltage of the bus; without a sector all legs are low.";
        l.b.stage("share_period", &[doc]);
        named! {
            let sector_is_known = front.sector.is_not(0);
            let t_chosen = Phases::<3>::each(|x| {
                let three = three.0[x];
                let own = pair.as_ref().map_or(three, |pair| {
                    pair.pulsed.choose(pair.terminals.0[x], three)
                });
                sector_is_known.choose(own, 0)
            });
        }
        let doc =
            "Legs of the two vectors: each leg is pulsed for its share of the period, or low.";
        l.b.stage("drive_legs", &[doc]);
        named! {
            let compare_chosen = t_chosen.map(|volts| compare_of(l, volts, front.bus, None));
            let leg_chosen = Phases::each(|x| {
                let leg = t_chosen.0[x].is_above(0).choose(PULSED, LOW);
                pair.as_ref().map_or(leg, |pair| pair.is_off[x].choose(OFF, leg))
            });
        }
        let command = Command {
            compares: compare_chosen,
            legs: leg_chosen,
        };
        let off_leg = self.needs.off_leg;
        let v_cmd = (!off_leg).then(|| mean_voltage(front, t_chosen, pair.as_ref()));
        let applied = pair.filter(|_| off_leg).map(|pair| Applied {
            terminals: t_chosen,
            off: pair.off,
        });
        self.remember(front, command, v_cmd, applied, vec![]);
    }
}

/// The point nearest to u on the edge between the two nearest of V0 to V6.
fn nearest_edge<'b>(l: &Lowering<'b>, bus: Expr<'b>, choice: &Choice<'b>) -> Phases<'b, 3> {
    l.b.stage(
        "nearest_edge",
        &[
            "Two three-phase vectors and their times: the point nearest to the deadbeat voltage on the nearest edge of its triangle.",
            "The nearest of V1 to V6 shares the period with V0, its high legs at 3/2 of the phase voltage; or, if that is nearer,",
            "with its neighbour, each leg at (V + 3 u)/2 within the rails.",
        ],
    );
    let second = choice.heights[0].min(choice.heights[1]);
    named! {
        let beside_zero = (3 * second).is_at_most(bus);
        let t_beside_zero = ((3 * choice.largest) >> 1).clamp(0, bus);
        let t_three = Phases::each(|x| {
            let lone = choice.is_low[x].choose(0, t_beside_zero);
            let edge = ((bus + 3 * choice.u.0[x]) >> 1).clamp(0, bus);
            beside_zero.choose(lone, edge)
        });
    }
    t_three
}

/// The better vector with the chosen vector's leg off, for the time of the least error.
fn divide_pair<'b>(l: &Lowering<'b>, front: &Front<'b>, choice: &Choice<'b>) -> PulsedPair<'b> {
    let [u_a, u_b, u_c] = choice.u.0;
    l.b.stage(
        "divide_pair",
        &[
            "A pair vector and the zero vector with the same leg off: the time follows from the line voltage while that leg floats,",
            "and from the pulsed leg's voltage while a diode holds it at a rail.",
        ],
    );
    named! {
        let off_chosen = off_leg_table(l).at(choice.vector);
        let pair_is_pulsed = off_chosen.is_not(0);
    }
    let names = ["a_is_off_leg", "b_is_off_leg", "c_is_off_leg"];
    let is_off = [0, 1, 2].map(|x| off_chosen.is(x + 1).named(names[x as usize]));
    let [is_a, is_b, _] = is_off;
    named! {
        // The high and the low leg in the first of the two vectors.
        let u_plus = is_a.choose(u_c, u_a);
        let u_minus = is_b.choose(u_c, u_b);
        let pair_is_back = u_plus.is_below(u_minus);
    }
    let size = (u_plus - u_minus).abs();
    let volts = match choice.off_legs {
        None => size,
        Some(off_legs) => {
            let [inward, outward] = off_legs.conducting_of([is_a, is_b]);
            named! {
                let line_size = size;
                let off_outward = outward;
                let u_pulsed = pair_is_back.choose(u_minus, u_plus);
            }
            let held = u_pulsed + ((off_outward.choose(front.bus.volts, 0) + u_pulsed) >> 1);
            (inward | off_outward).choose(held, line_size)
        }
    };
    named! {
        let t_pair = volts.clamp(0, front.reach.volts);
        let pair_is_forward = !pair_is_back;
    }
    // Forward, a is high with b or c off, c with a off; backward, b is high with a or c off, c with
    // b off.
    let of_c = is_b.choose_flag(pair_is_back, pair_is_forward);
    let senses = [pair_is_forward, pair_is_back, of_c];
    let volts = t_pair;
    named! {
        let t_pair = Phases::each(|x| (!is_off[x] & senses[x]).choose(volts, 0));
    }
    PulsedPair {
        is_off,
        off: off_chosen,
        pulsed: pair_is_pulsed,
        volts,
        terminals: t_pair,
    }
}

/// Mean phase voltages a, b of the terminals; an off leg counts as midway between the two others.
fn mean_voltage<'b>(
    front: &Front<'b>,
    terminals: Phases<'b, 3>,
    pair: Option<&PulsedPair<'b>>,
) -> Phases<'b> {
    let terminals = match pair {
        None => terminals,
        Some(pair) => {
            named! {
                let t_midway = pair.volts >> 1;
                let t_mean = Phases::each(|x| pair.is_off[x].choose(t_midway, terminals.0[x]));
            }
            t_mean
        }
    };
    named! {
        let t_mean = front.third * terminals.sum();
        let v_chosen = terminals.pair().map(|terminal| terminal - t_mean);
    }
    v_chosen
}
