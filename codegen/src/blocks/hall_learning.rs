//! Places of the Hall sensors, learnt from the times between their edges (shared semantics page,
//! "Learning of the Hall sensors").
//!
//! While the rotor turns steadily, the part of a turn's time that a sector takes is its width. A sector that
//! is wider than believed tells that the edge at its end stands farther on: the edge is moved by a quarter of
//! the difference, and the other two back by half of that each, because the times tell how the edges stand to
//! each other, not to the rotor: the sensor between the others is taken to be in its place, so that one that
//! stands out of place is found. How all three stand is told by the EMF. An inductance off its stated value
//! turns the modelled EMF in proportion to the current; with little current its error across the rotor's
//! shape is that of the angle.

use super::Lowering;
use super::measure::{Hall, SIXTH};
use crate::ir::{Expr, Flag, Interval, Memory, Named as _, Phases, named, pick};
use std::f64::consts::PI;

/// State words of the learnt displacements: of the edges at which sectors 1 and 4, and 2 and 5, begin, and of all edges.
pub const HALL_SHIFTS: [&str; 3] = ["shift_1", "shift_2", "shift_all"];

/// Limit of the displacement of the first and of the second edge, and of what one sector tells: 15 degrees. The third
/// is minus their sum.
const MOST: i64 = SIXTH / 4;

/// Greatest angle of a sector: 120 degrees.
const WIDEST: i64 = 2 * SIXTH;

/// Edges in a row, in one direction, behind which all six intervals are measured. (The one that the last of them
/// replaces stood for all six.)
const WHOLE_TURN: i32 = 7;

/// A rotor turns steadily where a turn takes as long as the one that ended an edge before, but for 2^-6 of it.
const STEADY_SHIFT: u32 = 6;

/// Angle by which all edges are moved at one of them: a 1024th of a sector, so 5 degrees take 14 turns.
const OFFSET_STEP: i64 = SIXTH >> 10;

/// Error of the angle that is left, rad: half a degree.
const SMALL_ANGLE: f64 = PI / 360.0;

/// Currents that turn the EMF's error little, over `max_current`.
const SMALL_CURRENT: f64 = 0.1;

/// The learnt words, and what follows from them for the sector that the rotor is in.
#[derive(Clone, Copy, Debug)]
pub(super) struct HallLearning<'b> {
    /// Displacement of the edges at which sectors 1 and 4, and 2 and 5, begin.
    shifts: [Memory<'b>; 2],
    /// Displacement of all edges.
    offset: Memory<'b>,
    /// Displacement of the edge at which the sector begins.
    begin: Memory<'b>,
    /// Width of the sector.
    width: Memory<'b>,
    /// Edges in a row in one direction.
    steady: Memory<'b>,
}

/// Values of every period that learning uses at an edge.
#[derive(Clone, Copy)]
pub(super) struct Seen<'b> {
    /// Last angle of the sector, from its first, with all sensors in their places.
    pub last: Expr<'b>,
    /// Currents of phases a and b.
    pub currents: Phases<'b>,
    /// Error of the modelled EMF across the shape, in the last period.
    pub across: Expr<'b>,
    /// Angle per period up to now, signed.
    pub step_angle: Expr<'b>,
}

/// What is known at an edge.
pub(super) struct Edge<'b> {
    /// To the next sector, not to the previous one.
    pub forward: Flag<'b>,
    /// In the direction of the one before.
    pub again: Flag<'b>,
    /// Ticks since the last edge.
    pub interval: Expr<'b>,
    /// Angle per tick, mean of the turn.
    pub rate: Expr<'b>,
    /// Ticks of the turn, and of the one that ended an edge before.
    pub rev: Expr<'b>,
    pub rev_before: Expr<'b>,
}

/// The new and the old words of an edge.
pub(super) struct Learnt<'b>([(&'static str, Memory<'b>, [Expr<'b>; 2]); 6]);

/// Where the sector begins, beyond its place, and its last angle from there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<'b> {
    pub begin: Expr<'b>,
    pub width: Expr<'b>,
    /// The latter with all sensors in their places.
    pub last: Expr<'b>,
}

impl<'b> HallLearning<'b> {
    /// Declares the words; `None` without `hall_learning`.
    pub fn new(l: &Lowering<'b>) -> Option<Self> {
        if !l.spec.controller.common().learning.halls {
            return None;
        }
        let shift = |name, sectors| {
            let doc = format!(
                "Learnt displacement of the Hall edges at which sectors {sectors} begin, 2^32 a turn."
            );
            l.b.memory(name, 0, Interval::symmetric(MOST), &doc)
        };
        let [first, second, all] = HALL_SHIFTS;
        let shifts = [shift(first, "1 and 4"), shift(second, "2 and 5")];
        let doc = "Learnt displacement of all Hall edges, 2^32 a turn.";
        let offset = l.b.memory(all, 0, Interval::symmetric(MOST), doc);
        let doc = "Learnt displacement of the Hall edge at which the sector begins, 2^32 a turn.";
        let begin =
            l.b.memory("sector_shift", 0, Interval::symmetric(4 * MOST), doc);
        let doc = "Last angle of the sector, from where it begins, 2^32 a turn.";
        let width = l.b.memory(
            "sector_width",
            SIXTH as i32 - 1,
            Interval::new(0, WIDEST),
            doc,
        );
        let doc = "Hall edges in a row in this direction, at most 7.";
        Some(Self {
            shifts,
            offset,
            begin,
            width,
            steady: l
                .b
                .memory("steady_edges", 0, Interval::new(0, WHOLE_TURN.into()), doc),
        })
    }

    /// The displacement of all edges behind this one and before it, from the error of the EMF; `limit`: its greatest
    /// magnitude. Added to the open stage of edges.
    fn learn_offset(
        self,
        l: &Lowering<'b>,
        seen: &Seen<'b>,
        [learns, forward]: [Flag<'b>; 2],
        limit: Expr<'b>,
    ) -> [Expr<'b>; 2] {
        let (motor, old) = (&l.spec.motor, self.offset.read());
        // What an angle that is off by so much makes of the EMF, volt per electrical rad/s.
        let across = SMALL_ANGLE * motor.emf_constant / f64::from(motor.pole_pairs)
            * 1.5
            * motor.emf_constant
            / (l.spec.torque_constant() * 3_f64.sqrt());
        let doc =
            "EMF across the shape where the angle is half a degree off, per angle of a period.";
        let k_across = l.voltage_by_turn("k_across", across, doc);
        let doc =
            "Greatest phase current at which the EMF tells the angle, a tenth of `max_current`";
        let most = l.ampere_word(SMALL_CURRENT * l.spec.inverter.max_current);
        let small = l.current("i_small", most, doc);
        let doc = "Angle by which all edges are moved at one of them: a 1024th of a sector.";
        let step = l.number("shift_step", OFFSET_STEP, doc);
        let [a, b] = seen.currents.0;
        named! {
            let is_light_in_c = (a + b).abs().is_at_most(small);
            let is_light = a.abs().is_at_most(small) & (b.abs().is_at_most(small) & is_light_in_c);
            let is_off = seen.across.abs().is_above(k_across * seen.step_angle.abs());
            let lags = forward.sign(seen.across).is_above(0);
            let moves = learns & (is_light & is_off);
            let shift_of_all = lags.sign(step);
            let shift_all_seen = (old + moves.choose(shift_of_all, 0)).clamp(-limit, limit);
        }
        [shift_all_seen, old]
    }

    /// Learns from an edge; added to the open stage of edges.
    pub fn at_edge(
        self,
        l: &Lowering<'b>,
        hall: &Hall<'b>,
        edge: &Edge<'b>,
        seen: &Seen<'b>,
    ) -> Learnt<'b> {
        let steady_edges = self.steady.read();
        let [first, second] = self.shifts.map(Memory::read);
        let (begin, width) = (self.begin.read(), self.width.read());
        let doc = "Greatest angle of a sector: 120 degrees.";
        let widest = l.number("sector_most", WIDEST, doc);
        let doc = "Limit of a learnt displacement: 15 degrees.";
        let most = l.number("shift_most", MOST, doc);
        let doc = "Edge at which a sector begins: 1, 2 or 3; opposite edges are one sensor's.";
        let edges =
            l.b.column("sector", "edge_of", vec![0, 1, 2, 3, 1, 2, 3], doc);
        named! {
            let crossed = edges.at(edge.forward.choose(hall.sector, hall.sector_prev.read()));
            let is_first = crossed.is(1);
            let is_second = crossed.is(2);
            let is_whole = steady_edges.is_at_least(WHOLE_TURN - 1);
            let steady_now = edge.again.choose((steady_edges + 1).min(WHOLE_TURN), 1);
            let is_steady = (edge.rev - edge.rev_before).abs().is_at_most(edge.rev >> STEADY_SHIFT);
            let learns = edge.again & (is_whole & is_steady);
            let turned = edge.rate.mul_limited(edge.interval, widest);
            let wider = edge.forward.sign((turned - width).named("wider_forward"));
            let move_on = learns.choose(wider.clamp(-most, most) >> 2, 0);
            let move_back = -(move_on >> 1);
        }
        let learn = |name: &str, old: Expr<'b>, is_crossed: Flag<'b>| {
            (old + is_crossed.choose(move_on, move_back))
                .clamp(-most, most)
                .named(name)
        };
        let (one, two) = (
            learn("shift_1_seen", first, is_first),
            learn("shift_2_seen", second, is_second),
        );
        let [all, all_before] = self.learn_offset(l, seen, [learns, edge.forward], most);
        named! {
            let three = -(one + two);
            let at_edge = pick([is_first, is_second], [one, two, three]);
            let behind = pick([is_first, is_second], [two, three, one]);
            let before = pick([is_first, is_second], [three, one, two]);
            let begin_alone = edge.forward.choose(at_edge, before);
            let end_seen = edge.forward.choose(behind, at_edge);
            let width_seen = (seen.last + (end_seen - begin_alone)).clamp(0, widest);
            let middle = one.min(two).max(one.max(two).min(three));
            let begin_seen = begin_alone - middle + all;
        }
        Learnt([
            ("shift_1_next", self.shifts[0], [one, first]),
            ("shift_2_next", self.shifts[1], [two, second]),
            ("shift_all_next", self.offset, [all, all_before]),
            ("sector_shift_next", self.begin, [begin_seen, begin]),
            ("sector_width_next", self.width, [width_seen, width]),
            ("steady_edges_next", self.steady, [steady_now, steady_edges]),
        ])
    }
}

impl<'b> Learnt<'b> {
    /// Joins the words of the open guarded stage, which keep their values without an edge.
    pub fn keep(self, l: &Lowering<'b>, last: Expr<'b>) -> Placed<'b> {
        let [_, _, _, begin, width, _] = self.0.map(|(name, word, [seen, old])| {
            let [next] = l.b.join([(name, seen, old)]);
            word.set(next);
            next
        });
        Placed { begin, width, last }
    }
}
