//! Rotation of an estimated EMF (section 8).

use super::constants::Constants;
use crate::exact::{Word, floor_shift, halve, within};
use crate::model::sector::{CORNER_A, CORNER_B};

/// The estimate `e` of the last period, extrapolated to the target period and to the present one.
#[inline]
pub fn ahead<W: Word>(
    k: &Constants<W>,
    delayed: bool,
    sector: usize,
    e: [W; 2],
) -> ([W; 2], [W; 2]) {
    let factor = |line: W| {
        let line = within(line, -k.line_max, k.line_max);
        floor_shift(line * k.line_scale, k.line_shift)
    };
    // The pair's EMF with c as minus the sum of a and b.
    let [p, q] = [CORNER_A[sector], CORNER_B[sector]];
    let [line_a, line_b] = [2.0 * p + q, p + 2.0 * q];
    let y = factor(e[0] * line_a + e[1] * line_b);
    if k.emf_turns {
        let turn = k.k_slope.mul(y);
        let product = |y: W, z: W| k.line_product.round_product(y, z);
        let [across_a, across_b] = [
            product(turn, -(e[0] + e[1] * 2.0)),
            product(turn, e[0] * 2.0 + e[1]),
        ];
        let [bend_a, bend_b] = [
            product(turn, -(across_a + across_b * 2.0)),
            product(turn, across_a * 2.0 + across_b),
        ];
        let once = [across_a + halve(bend_a), across_b + halve(bend_b)];
        let twice = [(across_a + bend_a) * 2.0, (across_b + bend_b) * 2.0];
        let present = moved(e, once);
        let target = if delayed { moved(e, twice) } else { present };
        return (target, present);
    }
    let square = k.line_product.floor_product(y, y);
    let motion = [
        -k.k_slope.mul(square * line_b),
        k.k_slope.mul(square * line_a),
    ];
    let present = moved(e, motion);
    let target = if delayed {
        moved(present, motion)
    } else {
        present
    };
    (target, present)
}

/// The EMF a period later.
#[inline]
#[track_caller]
fn moved<W: Word>(e: [W; 2], motion: [W; 2]) -> [W; 2] {
    let _site = W::here();
    [e[0] + motion[0], e[1] + motion[1]]
}
