//! The current in the alpha-beta plane against the ideal hexagon.

use super::palette::IDEAL;
use super::plane::{Named, Path, Plane, plane};
use crate::report::ReportError;
use crate::report::window::first_turn;
use hexagen_lab::closed_loop::{Trace, hexagon};
use maud::PreEscaped;
use plotters::style::RGBColor;

/// Width of the picture in CSS pixels.
const WIDTH: f64 = 281.0;

/// Points drawn of a turn with its ripple, at most.
const RAW_POINTS: usize = 2400;

/// Draws one turn of a record, ripple pale and mean over one control period solid, over the
/// hexagon between the corners of the quasi-square reference of amplitude `current`. Both axes
/// reach to `reach` amperes on either side, on the same scale.
pub fn trajectory(
    trace: &Trace,
    current: f64,
    reach: f64,
    color: RGBColor,
    description: &str,
) -> Result<PreEscaped<String>, ReportError> {
    // The names of the corners stand outside of them, where no commutation passes.
    plane(&Plane {
        description,
        titles: ["i_alpha in A", "i_beta in A"],
        reach,
        width: WIDTH,
        paths: vec![
            Path::solid(hexagon(current), IDEAL, 3.0),
            Path {
                opacity: 0.3,
                ..Path::solid(with_ripple(trace), color, 0.8)
            },
            Path::solid(means(trace), color, 1.4),
        ],
        points: corners(current, "S"),
    })
}

/// Its corners, named by their sectors behind `prefix`.
pub fn corners(current: f64, prefix: &str) -> Vec<Named> {
    let corners = hexagon(current).into_iter().take(6).enumerate();
    corners
        .map(|(k, at)| Named {
            at,
            name: format!("{prefix}{}", k + 1),
            is_marked: true,
        })
        .collect()
}

fn stride(turn: usize) -> usize {
    (turn / RAW_POINTS).max(1)
}

/// The first turn of a record, with its ripple.
fn with_ripple(trace: &Trace) -> Vec<(f64, f64)> {
    let turn = first_turn(trace);
    let stride = stride(turn.len());
    turn.step_by(stride)
        .map(|k| trace.i_alpha_beta(k))
        .collect()
}

/// The first turn of a record, means over one control period.
pub fn means(trace: &Trace) -> Vec<(f64, f64)> {
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
    let stride = stride(turn.len());
    turn.step_by(stride).map(mean).collect()
}
