//! One electrical turn of a record, from the start of sector S1, cut into plot columns.
//!
//! A column has the mean over one control period around its middle, to which a controller can
//! respond, and the least and greatest value in the same period, the PWM ripple.

use super::Point;
use crate::closed_loop::Trace;
use std::ops::Range;

/// Electrical angle in degrees at which sector S1 begins.
pub const FIRST_DEG: f64 = -30.0;

/// The plotted turn, in degrees.
pub const TURN: Range<f64> = FIRST_DEG..FIRST_DEG + 360.0;

/// A signal over one turn, a value per column.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    /// Electrical angle of each column's middle in degrees within [`TURN`], ascending.
    pub angle: Vec<f64>,
    /// Mean over one control period.
    pub mean: Vec<f64>,
    /// Least value.
    pub least: Vec<f64>,
    /// Greatest value.
    pub most: Vec<f64>,
}

/// Electrical angle of a bin in degrees within [`TURN`].
fn angle(theta_e: f64) -> f64 {
    (theta_e.to_degrees() - FIRST_DEG).rem_euclid(360.0) + FIRST_DEG
}

/// Bins of the first whole turn in a record, or all of it if the shaft turns less. Half a control
/// period is reserved at either end for means.
fn first_turn(trace: &Trace) -> Range<usize> {
    let half = trace.bins_per_period;
    let bins = trace.theta_e.len();
    let wraps: Vec<usize> = (half.max(1)..bins.saturating_sub(half))
        .filter(|&k| (angle(trace.theta_e[k]) - angle(trace.theta_e[k - 1])).abs() > 180.0)
        .take(2)
        .collect();
    match wraps[..] {
        [first, second] => first..second,
        _ => 0..bins,
    }
}

/// A signal of the record over its first turn in at most `columns` columns; `of` gives the signal
/// at a bin.
pub fn columns(trace: &Trace, columns: usize, of: impl Fn(usize) -> f64) -> Columns {
    cut(trace, &first_turn(trace), columns, of)
}

/// As [`columns`], of the part of the turn between two angles in degrees.
pub fn columns_between(
    trace: &Trace,
    degrees: &Range<f64>,
    columns: usize,
    of: impl Fn(usize) -> f64,
) -> Columns {
    let turn = first_turn(trace);
    let mut inside = turn.filter(|&k| degrees.contains(&angle(trace.theta_e[k])));
    let first = inside.next().unwrap_or(0);
    let end = inside.next_back().map_or(first, |last| last + 1);
    cut(trace, &(first..end), columns, of)
}

/// A signal over some bins of the record.
fn cut(trace: &Trace, turn: &Range<usize>, columns: usize, of: impl Fn(usize) -> f64) -> Columns {
    let bins = trace.theta_e.len();
    let count = columns.clamp(1, turn.len().max(1));
    let mut result = Columns::default();
    if turn.is_empty() {
        return result;
    }
    for column in 0..count {
        let from = turn.start + column * turn.len() / count;
        let to = turn.start + (column + 1) * turn.len() / count;
        let middle = usize::midpoint(from, to);
        let half = trace.bins_per_period / 2;
        let period = middle.saturating_sub(half)
            ..(middle.saturating_sub(half) + trace.bins_per_period).min(bins);
        let around = from.min(period.start)..to.max(period.end);
        let mean = period.clone().map(&of).sum::<f64>() / period.len() as f64;
        result.angle.push(angle(trace.theta_e[middle]));
        result.mean.push(mean);
        result
            .least
            .push(around.clone().map(&of).fold(f64::INFINITY, f64::min));
        result
            .most
            .push(around.map(&of).fold(f64::NEG_INFINITY, f64::max));
    }
    if result.angle.len() > 1 && result.angle[0] > result.angle[1] {
        // Backward rotation: the plot's axis is the angle, not time.
        for values in [
            &mut result.angle,
            &mut result.mean,
            &mut result.least,
            &mut result.most,
        ] {
            values.reverse();
        }
    }
    result
}

/// Maximum number of points of a turn.
const POINTS: usize = 2400;

fn stride(turn: &Range<usize>) -> usize {
    (turn.len() / POINTS).max(1)
}

/// The current in the alpha-beta plane over the first turn of a record, with its ripple.
pub(super) fn with_ripple(trace: &Trace) -> Vec<Point> {
    let turn = first_turn(trace);
    let stride = stride(&turn);
    turn.step_by(stride)
        .map(|k| trace.i_alpha_beta(k))
        .collect()
}

/// The current in the alpha-beta plane over the first turn of a record, means over one control
/// period.
pub fn means(trace: &Trace) -> Vec<Point> {
    let mean = |middle: usize| {
        let from = middle.saturating_sub(trace.bins_per_period / 2);
        let bins = from..(from + trace.bins_per_period).min(trace.theta_e.len());
        let count = bins.len() as f64;
        let sum = bins
            .map(|k| trace.i_alpha_beta(k))
            .fold((0.0, 0.0), |(alpha, beta), (a, b)| (alpha + a, beta + b));
        (sum.0 / count, sum.1 / count)
    };
    let turn = first_turn(trace);
    let stride = stride(&turn);
    turn.step_by(stride).map(mean).collect()
}
