//! Learning of the Hall sensors (section "Learning of the Hall sensors").

use super::sectors::SIXTH;
use crate::exact::{Word, both, either, floor_shift, lesser, pow2, within, word};
use crate::model::hall::STEADY_RISE;
use crate::model::sector::{HallEvent, crossed_edge, ends};

/// Limit of a learnt displacement.
const MOST: f64 = 178_956_970.0;

/// Learnt displacements of the edges, and what follows for the present sector; angle words.
#[derive(Clone, Copy, Debug)]
pub struct Learnt<W: Word> {
    /// `shift_1`, `shift_2`.
    pub shifts: [W; 2],
    /// `sector_shift`.
    pub begin: W,
    /// `sector_width`.
    pub width: W,
}

impl<W: Word> Default for Learnt<W> {
    fn default() -> Self {
        Self {
            shifts: [word(0.0); 2],
            begin: word(0.0),
            width: word(SIXTH - 1.0),
        }
    }
}

/// The last turn at an edge.
#[derive(Clone, Copy, Debug)]
pub struct Turn<W> {
    /// It was measured whole.
    pub is_whole: bool,
    /// Ticks since the edge before.
    pub interval: W,
    pub rate: W,
    pub rise: W,
}

impl<W: Word> Learnt<W> {
    /// The words behind an edge; `last`: last word of the sector with all sensors in their places.
    #[inline]
    pub fn at_edge(self, event: &HallEvent, sector_prev: usize, turn: &Turn<W>, last: f64) -> Self {
        let crossed = crossed_edge(event, sector_prev);
        let limit = STEADY_RISE * pow2(32);
        let mut on = word(0.0);
        if turn.is_whole && turn.rise >= -limit && turn.rise <= limit {
            let wider = lesser(turn.rate * turn.interval, 2.0 * SIXTH) - self.width;
            let wider = either(event.forward, wider, -wider);
            on = floor_shift(within(wider, -MOST, MOST), 2);
        }
        let back = -floor_shift(on, 1);
        let shifts = both(|x| {
            let moved = either(crossed == x, on, back);
            within(self.shifts[x] + moved, -MOST, MOST)
        });
        let all = [shifts[0], shifts[1], -(shifts[0] + shifts[1])];
        let [begin, end] = ends(crossed, event.forward).map(|edge| all[edge]);
        let width = within(end - begin + last, 0.0, 2.0 * SIXTH);
        Self {
            shifts,
            begin,
            width,
        }
    }
}
