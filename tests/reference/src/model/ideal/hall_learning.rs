//! Learning of the Hall sensors (section "Learning of the Hall sensors").

use crate::model::sector::{HallEvent, crossed_edge, ends};
use std::f64::consts::FRAC_PI_3;

/// Limit of a learnt displacement, rad.
const MOST: f64 = FRAC_PI_3 / 4.0;

/// Angle by which all edges are moved at one of them, rad.
const STEP: f64 = FRAC_PI_3 / 1024.0;

/// Learnt displacements of the Hall edges, and what follows for the present sector; rad.
#[derive(Clone, Copy, Debug)]
pub struct PlacedEdges {
    /// Of the edges at which sectors 1 and 4, and 2 and 5, begin.
    pub shifts: [f64; 2],
    /// Of all edges.
    pub all: f64,
    /// Of the one at which the sector begins.
    pub begin: f64,
    /// Width of the sector.
    pub width: f64,
}

impl Default for PlacedEdges {
    fn default() -> Self {
        Self {
            shifts: [0.0; 2],
            all: 0.0,
            begin: 0.0,
            width: FRAC_PI_3,
        }
    }
}

impl PlacedEdges {
    /// Behind an edge; `turned`: the angle since the one before, and the error of the EMF across the shape, where it tells the
    /// angle, if they are to be learnt from; `width`: that of the sector with all sensors in their places.
    pub fn at_edge(
        self,
        event: &HallEvent,
        sector_prev: usize,
        turned: Option<(f64, Option<f64>)>,
        width: f64,
    ) -> Self {
        let crossed = crossed_edge(event, sector_prev);
        let wider = turned.map_or(0.0, |(turned, _)| turned.min(2.0 * FRAC_PI_3) - self.width);
        let on = wider.clamp(-MOST, MOST) / if event.forward { 4.0 } else { -4.0 };
        let shifts = [0, 1].map(|edge| {
            let moved = if crossed == edge { on } else { -on / 2.0 };
            (self.shifts[edge] + moved).clamp(-MOST, MOST)
        });
        let way = if event.forward { 1.0 } else { -1.0 };
        let across = turned.and_then(|(_, across)| across);
        let step = across.map_or(0.0, |across| STEP * f64::signum(way * across));
        let all = (self.all + step).clamp(-MOST, MOST);
        let each = [shifts[0], shifts[1], -(shifts[0] + shifts[1])];
        let [one, two, three] = each;
        let middle = one.min(two).max(one.max(two).min(three));
        let [begin, end] = ends(crossed, event.forward).map(|edge| each[edge]);
        Self {
            shifts,
            all,
            begin: begin - middle + all,
            width: (width + end - begin).clamp(0.0, 2.0 * FRAC_PI_3),
        }
    }
}
