//! The current in the alpha-beta plane against the ideal hexagon.

use super::canvas::{
    self, Axis, Margins, anchored, chart, decimals, failed, line, polyline, px, text, tick_text,
    ticks, write_at,
};
use super::palette::{AXIS, IDEAL, INK};
use crate::closed_loop::{Trace, quasi_square};
use crate::report::ReportError;
use crate::report::window::first_turn;
use maud::PreEscaped;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::f64::consts::FRAC_PI_3;

/// Width of the picture in CSS pixels.
const WIDTH: f64 = 281.0;

/// Distance of the corners' names from the corners in CSS pixels.
const NAMES: f64 = 14.0;

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
    let range = -reach..reach;
    let step = canvas::step(&range, 8);
    let digits = decimals(step);
    let label = |value: &f64| tick_text(*value, digits);
    let axis = |title| Axis {
        range: range.clone(),
        ticks: ticks(&range, step),
        label: &label,
        title,
    };
    let margins = Margins {
        right: 10.0,
        ..Margins::fitting(&axis(""))
    };
    // The plotted area is a square.
    let height = WIDTH - margins.left - margins.right + margins.top + margins.bottom;
    canvas::svg((WIDTH, height), description, |area| {
        let mut chart = chart(area, margins, axis("i_alpha in A"), axis("i_beta in A"))?;
        let frame = Rectangle::new([(-reach, reach), (reach, -reach)], line(AXIS, 1.0));
        chart.plotting_area().draw(&frame).map_err(failed)?;
        let corners: Vec<(f64, f64)> = (0..=6)
            .map(|k| quasi_square(f64::from(k) * FRAC_PI_3, current))
            .collect();
        polyline(&mut chart, corners.iter().copied(), line(IDEAL, 3.0))?;

        let turn = first_turn(trace);
        let stride = (turn.len() / RAW_POINTS).max(1);
        let raw = turn.clone().step_by(stride).map(|k| trace.i_alpha_beta(k));
        polyline(&mut chart, raw, color.mix(0.3).stroke_width(px(0.8) as u32))?;
        let mean = |middle: usize| {
            let from = middle.saturating_sub(trace.bins_per_period / 2);
            let bins = from..(from + trace.bins_per_period).min(trace.theta_e.len());
            let count = bins.len() as f64;
            let sum = bins
                .map(|k| trace.i_alpha_beta(k))
                .fold((0.0, 0.0), |(alpha, beta), (a, b)| (alpha + a, beta + b));
            (sum.0 / count, sum.1 / count)
        };
        let means = turn.step_by(stride).map(mean);
        polyline(&mut chart, means, line(color, 1.4))?;

        let name = text(INK, 0.95);
        let name = anchored(&name, HPos::Center, VPos::Center);
        for (k, &corner) in corners.iter().take(6).enumerate() {
            let dot = Circle::new(corner, px(3.0), INK.stroke_width(px(1.0) as u32));
            chart.plotting_area().draw(&dot).map_err(failed)?;
            // Outside of the corner, where no commutation passes.
            let (sin, cos) = corner.1.atan2(corner.0).sin_cos();
            let outside = (NAMES * cos, -NAMES * sin);
            write_at(&chart, &format!("S{}", k + 1), corner, outside, &name)?;
        }
        Ok(())
    })
}
