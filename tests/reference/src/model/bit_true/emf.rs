//! The EMF estimated from the last period (section 8).

use super::constants::Constants;
use super::state::State;
use crate::exact::{Word, both, halve, within, word, wrap32};
use crate::model::sector::OUT_PHASE;

/// `volts` of phases a, b less the drop across inductance and resistance, of a period that began with the currents
/// `i_prev` and ends with `i`.
#[inline]
fn behind<W: Word>(k: &Constants<W>, i_prev: [W; 2], i: [W; 2], volts: [W; 2]) -> [W; 2] {
    both(|x| {
        let d = within(i[x] - i_prev[x], -k.di_limit, k.di_limit - 1.0);
        volts[x] - k.k_di.mul(d) - k.k_r.mul(i_prev[x])
    })
}

/// EMF of phases a, b in the period that ends with the currents `i`.
#[inline]
pub fn estimate<W: Word>(k: &Constants<W>, state: &State<W>, i: [W; 2]) -> [W; 2] {
    let (seen, e_prev) = (behind(k, state.i_prev, i, state.v_prev), &state.e_prev);
    both(|x| {
        let e = if k.filtered {
            e_prev[x] + k.k_filter.mul(seen[x] - e_prev[x])
        } else {
            seen[x]
        };
        within(e, -k.v_largest, k.v_largest)
    })
}

/// Observed EMF of phases a, b less the expected one.
#[inline]
pub fn residual<W: Word>(k: &Constants<W>, state: &State<W>, i: [W; 2]) -> [W; 2] {
    let beyond = behind(k, state.i_prev, i, state.net_prev);
    let most = k.emf_error_limit;
    beyond.map(|volts| within(volts, -most, most - 1.0))
}

/// Error of the modelled EMF, q and d, corrected by the residual of the period that has ended.
#[inline]
pub fn corrected_error<W: Word>(
    k: &Constants<W>,
    state: &State<W>,
    [x, y]: [W; 2],
    shape: [W; 2],
) -> [W; 2] {
    if state.timing.edges < 2 {
        return state.emf_error;
    }
    let believed = |volts: W| within(volts, -k.emf_error_limit, k.emf_error_limit - 1.0);
    let ([a, b], [line_a, line_b]) = (shape, lines(shape));
    let along = k.observer.floor_sum_of_products([x, line_a], [y, line_b]);
    let across = k.observer.floor_sum_of_products([y, a], [-x, b]);
    [
        believed(state.emf_error[0] + along),
        believed(state.emf_error[1] + across),
    ]
}

/// The modelled EMF of phases a, b plus its error, by the shape at the angle `theta`.
#[inline]
pub fn corrected<W: Word>(
    k: &Constants<W>,
    e: [W; 2],
    [q, across]: [W; 2],
    (theta, shape): (W, [W; 2]),
) -> [W; 2] {
    let ([a, b], [line_a, line_b]) = (shape, lines(shape));
    let along = match &k.stretch {
        Some((table, product)) => q + product.floor_product(table.at(wrap32(theta)), q),
        None => q,
    };
    let turned = [
        k.shape_product
            .floor_sum_of_products([along, a], [-across, line_b]),
        k.shape_product
            .floor_sum_of_products([along, b], [across, line_a]),
    ];
    let most = 2.0 * k.emf_error_limit;
    both(|x| within(e[x] + turned[x], -most, most - 1.0))
}

/// Phase a less c, and b less c.
#[inline]
fn lines<W: Word>([a, b]: [W; 2]) -> [W; 2] {
    [a * 2.0 + b, b * 2.0 + a]
}

/// The estimate `seen` with the EMF of a floating leg replaced by that of the sector.
#[inline]
pub fn with_floated<W: Word>(
    k: &Constants<W>,
    state: &State<W>,
    sector_eff: usize,
    seen: [W; 2],
) -> [W; 2] {
    let believed = |e: W| within(e, -k.v_largest, k.v_largest);
    let Some(off) = state.off_prev.checked_sub(1).filter(|leg| *leg < 3) else {
        return seen;
    };
    let [a, b] = seen;
    let e = [a, b, believed(-(a + b))];
    let [i_a, i_b] = state.i_prev;
    let i_off = [i_a, i_b, -(i_a + i_b)][off];
    let outgoing = OUT_PHASE[sector_eff];
    let half = if outgoing == off {
        halve(-e[off])
    } else if i_off.abs() > k.i_comm {
        word(0.0)
    } else {
        k.k_third.mul(e[outgoing] - e[off])
    };
    both(|x| {
        if x == off {
            e[x] + half * 2.0
        } else {
            e[x] - half
        }
    })
}
