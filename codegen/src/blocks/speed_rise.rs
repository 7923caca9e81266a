//! Rise of the speed from the last turn to the coming sector, from the intervals of Hall edges (semantics, step 4).

use super::Lowering;
use crate::diagnostics::significant;
use crate::ir::{Exact, Expr, Real, named};
use crate::spec::{RotorSensing, Spec};

/// Whether the intervals tell the speed's rise: between opposite edges, which are a sensor's own, the rotor
/// turns by half a turn wherever the sensor stands. At samples the intervals are too coarse.
pub(super) fn tells_rise(spec: &Spec) -> bool {
    let angles = spec.motor.hall_angles;
    let opposite = |k: usize| (angles[k + 3] - angles[k] - 180.0).abs() < 1e-6;
    matches!(spec.inverter.rotor_sensing, RotorSensing::TimedHalls { .. }) && (0..3).all(opposite)
}

/// The speed in the middle of the coming sector over that in the middle of the last turn, less 1, over the
/// change of half a turn's time relative to a turn's, at constant acceleration: 4 (1/2 + 1/12).
const RISE: f64 = 7.0 / 3.0;
/// The change of half a turn's time is limited to 2^-3 of a turn's.
const CHANGE_BITS: u32 = 3;
/// Limit of the rise, by that of the change.
pub(super) const GREATEST_RISE: f64 = RISE / (1 << CHANGE_BITS) as f64;

/// Rise of the speed from the last turn to the coming sector, by the change of half a turn's time; added to the
/// open stage.
pub(super) fn speed_rise<'b>(
    l: &Lowering<'b>,
    intervals: [Expr<'b>; 6],
    [rev, rate]: [Expr<'b>; 2],
) -> Expr<'b> {
    let [last, middle, first, third, second, oldest] = intervals;
    // The least shift with which the product of all changes and all rates fits a word, and its limit, too.
    let turn = f64::from(l.spec.age_max()) * 6.0;
    let greatest = turn * (32_f64.exp2() / f64::from(l.spec.rev_min()));
    let shift = (greatest.log2().floor() as u32 + 1)
        .saturating_sub(31)
        .max(2);
    let limit = 1 << (32 - shift);
    let bits = f64::from(shift) - f64::from(CHANGE_BITS);
    let factor = RISE * bits.exp2();
    let k_rise = l.coefficient(
        "k_rise",
        factor,
        32,
        "Rise of the speed to the coming sector, over the change of half a turn's time over a turn's.",
        &format!("7/3 2^{bits} = {}", significant(factor)),
    );
    let doc = "Half a unit of the rate of a turn, which is rounded down, in its double.";
    let half = l.rounded_number("rate_half", 1, Exact::Number(Real::of(0.0)), doc);
    // At constant speed the counted half turns differ by up to a tick, which would be heard in the EMF.
    named! {
        let difference = (third + second + oldest) - (last + middle + first);
        let shortened = difference - difference.clamp(-1, 1);
        let eighths = (shortened << CHANGE_BITS).within(rev);
        let change = eighths.mul_floor((rate << 1) + half, shift + 1).clamp(-limit, limit);
        let rise_seen = k_rise * change;
    }
    rise_seen
}

/// An angle at the mean speed of the last turn, at this sector's.
pub(super) fn risen<'b>(angle: Expr<'b>, rise: Expr<'b>) -> Expr<'b> {
    angle + angle.mul_floor(rise, 32)
}
