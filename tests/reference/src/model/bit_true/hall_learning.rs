//! Learning of the Hall sensors (section "Learning of the Hall sensors").

use super::scale::Scale;
use super::sectors::SIXTH;
use crate::exact::{
    Coefficient, Word, both, either, floor_shift, greater, lesser, pow2, round_half_up, within,
    word,
};
use crate::model::hall::{SMALL_CURRENT, across_at_small_angle};
use crate::model::sector::{HallEvent, crossed_edge, ends};
use crate::{Error, Spec};
use std::f64::consts::TAU;

/// Limit of a learnt displacement.
const MOST: f64 = 178_956_970.0;
/// Angle by which all edges are moved at one of them.
const STEP: f64 = 699_050.0;

/// Learnt displacements of the edges, and what follows for the present sector; angle words.
#[derive(Clone, Copy, Debug)]
pub struct Learnt<W: Word> {
    /// `shift_1`, `shift_2`.
    pub shifts: [W; 2],
    /// `shift_all`.
    pub all: W,
    /// `sector_shift`.
    pub begin: W,
    /// `sector_width`.
    pub width: W,
}

impl<W: Word> Default for Learnt<W> {
    fn default() -> Self {
        Self {
            shifts: [word(0.0); 2],
            all: word(0.0),
            begin: word(0.0),
            width: word(SIXTH - 1.0),
        }
    }
}

/// The last turn at an edge.
#[derive(Clone, Copy, Debug)]
pub struct Turn<W> {
    /// It was whole, at a steady speed.
    pub tells: bool,
    /// Ticks since the edge before.
    pub interval: W,
    pub rate: W,
    /// The currents are small, and the EMF's error across the shape is not.
    pub tells_angle: bool,
    /// That error.
    pub across: W,
}

/// When the EMF tells the angle.
#[derive(Clone, Copy, Debug)]
pub struct Offset<W> {
    per_angle: Coefficient<W>,
    small: f64,
}

impl<W: Word> Offset<W> {
    pub fn new(spec: &Spec, scale: &Scale) -> Result<Self, Error> {
        let small = SMALL_CURRENT * spec.inverter.max_current / scale.g * scale.two_i;
        let volts = across_at_small_angle(&spec.motor) / scale.w * scale.two_v;
        let speed = TAU / pow2(32) / spec.inverter.t_s;
        Ok(Self {
            per_angle: scale.coefficient("k_across", volts * speed)?,
            small: round_half_up(small),
        })
    }

    /// Whether currents are small, and the error across the shape is not.
    #[inline]
    pub fn tells_angle(&self, [i_a, i_b]: [W; 2], across: W, step_angle: W) -> bool {
        let mut currents = [i_a, i_b, i_a + i_b].into_iter();
        let is_light = currents.all(|i| i.abs() <= self.small);
        is_light && across.abs() > self.per_angle.mul(step_angle.abs())
    }
}

impl<W: Word> Learnt<W> {
    /// The words behind an edge; `last`: last word of the sector with all sensors in their places.
    #[inline]
    pub fn at_edge(self, event: &HallEvent, sector_prev: usize, turn: &Turn<W>, last: f64) -> Self {
        let crossed = crossed_edge(event, sector_prev);
        let mut on = word(0.0);
        let mut all = self.all;
        if turn.tells {
            let wider = lesser(turn.rate * turn.interval, 2.0 * SIXTH) - self.width;
            let wider = either(event.forward, wider, -wider);
            on = floor_shift(within(wider, -MOST, MOST), 2);
            if turn.tells_angle {
                let lags = either(event.forward, turn.across, -turn.across) > 0.0;
                all = within(all + if lags { STEP } else { -STEP }, -MOST, MOST);
            }
        }
        let back = -floor_shift(on, 1);
        let shifts = both(|x| {
            let moved = either(crossed == x, on, back);
            within(self.shifts[x] + moved, -MOST, MOST)
        });
        let each = [shifts[0], shifts[1], -(shifts[0] + shifts[1])];
        let [one, two, three] = each;
        let middle = greater(lesser(one, two), lesser(greater(one, two), three));
        let [begin, end] = ends(crossed, event.forward).map(|edge| each[edge]);
        let width = within(end - begin + last, 0.0, 2.0 * SIXTH);
        Self {
            shifts,
            all,
            begin: begin - middle + all,
            width,
        }
    }
}
