//! An estimated EMF moved on (section 8).

use super::constants::Constants;
use crate::exact::{floor_shift, within};
use crate::model::sector::{CORNER_A, CORNER_B};

/// The estimate `e` of the period that just ended, in the target period and in the present one.
#[inline]
pub fn ahead(k: &Constants, delayed: bool, sector: usize, e: [f64; 2]) -> ([f64; 2], [f64; 2]) {
    let factor = |line: f64| {
        let line = within(line, -k.line_max, k.line_max);
        floor_shift(line * k.line_scale, k.line_shift)
    };
    let product = |y: f64, z: f64| k.line_product.floor_product(y, z);
    // The pair's EMF with c as minus the sum of a and b.
    let [p, q] = [CORNER_A[sector], CORNER_B[sector]];
    let [line_a, line_b] = [2.0 * p + q, p + 2.0 * q];
    let y = factor(line_a * e[0] + line_b * e[1]);
    let motion = if k.emf_turns {
        [
            k.k_slope.mul(product(y, factor(-(e[0] + 2.0 * e[1])))),
            k.k_slope.mul(product(y, factor(2.0 * e[0] + e[1]))),
        ]
    } else {
        let square = product(y, y);
        [
            -k.k_slope.mul(line_b * square),
            k.k_slope.mul(line_a * square),
        ]
    };
    let moved = |e: [f64; 2]| [e[0] + motion[0], e[1] + motion[1]];
    let present = moved(e);
    (if delayed { moved(present) } else { present }, present)
}
