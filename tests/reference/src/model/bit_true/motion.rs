//! An estimated EMF moved on (section 8).

use super::constants::Constants;
use crate::exact::{floor_shift, floor_weighted, within};
use crate::model::sector::{CORNER_A, CORNER_B};

/// 2^-15.
const FACTOR: f64 = 1.0 / 32_768.0;

/// The estimate `e` of the period that just ended, in the target period and in the present one.
#[inline]
pub fn ahead(k: &Constants, delayed: bool, sector: usize, e: [f64; 2]) -> ([f64; 2], [f64; 2]) {
    let factor = |line: f64| floor_shift(within(line, -k.line_max, k.line_max), k.line_shift);
    let product = |y: f64, z: f64| k.k_slope.mul(floor_weighted(y * z, FACTOR));
    // The pair's EMF with c as minus the sum of a and b.
    let [p, q] = [CORNER_A[sector], CORNER_B[sector]];
    let [line_a, line_b] = [2.0 * p + q, p + 2.0 * q];
    let y = factor(line_a * e[0] + line_b * e[1]);
    let motion = if k.emf_turns {
        [
            product(y, factor(-(e[0] + 2.0 * e[1]))),
            product(y, factor(2.0 * e[0] + e[1])),
        ]
    } else {
        let third = product(y, y);
        [-(line_b * third), line_a * third]
    };
    let moved = |e: [f64; 2]| [e[0] + motion[0], e[1] + motion[1]];
    let present = moved(e);
    (if delayed { moved(present) } else { present }, present)
}
