//! Mean torque over speed, all variants in one plot, with the demand and marks of interest.

use super::canvas::{
    self, Axis, Chart, Margins, anchored, chart, dashed, decimals, failed, line, polyline, px,
    text, tick_text, ticks, write_at,
};
use super::palette::{AXIS, DEMAND, INK};
use crate::report::{ReportError, SpeedMark};
use maud::PreEscaped;
use plotters::prelude::*;
use plotters::style::FontTransform;
use plotters::style::text_anchor::{HPos, VPos};
use std::ops::Range;

/// Least distance in CSS pixels between texts of neighbouring marks.
const TEXT_DISTANCE: f64 = 15.0;

/// Dash patterns of the variants in CSS pixels, so that curves on top of each other and prints
/// without colour can be told apart.
const DASHES: [(f64, f64); 4] = [(0.0, 0.0), (9.0, 3.0), (4.0, 3.0), (1.5, 2.5)];

/// One variant's curve.
pub struct Curve {
    /// Colour.
    pub color: RGBColor,
    /// Place in the legend; chooses the dash pattern.
    pub index: usize,
    /// Speed in rpm and mean torque in newton metres, ascending.
    pub points: Vec<(f64, f64)>,
    /// Speed limit in rpm, marked on the curve.
    pub limit_rpm: Option<f64>,
}

/// The plot.
pub struct TorqueSpeed<'a> {
    /// Demanded torque in newton metres.
    pub torque: f64,
    /// Rated speed in rpm.
    pub rated_rpm: f64,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Marks along the speed axis.
    pub marks: &'a [SpeedMark],
    /// Fraction of the demand that counts as held.
    pub held: f64,
}

/// Dash and gap of the curve at a place in the legend, in CSS pixels; no gap means a solid line.
pub fn dash(index: usize) -> (f64, f64) {
    DASHES[index % DASHES.len()]
}

/// Draws the plot.
pub fn torque_speed(plot: &TorqueSpeed<'_>) -> Result<PreEscaped<String>, ReportError> {
    let size = (1120.0, 440.0);
    let margins = Margins {
        top: 24.0,
        right: 16.0,
        ..Margins::USUAL
    };
    let x_range = speed_range(plot);
    let y_range = torque_range(plot);
    let width = size.0 - margins.left - margins.right;
    let description = "Mean torque over speed of all variants";
    canvas::svg(size, description, |area| {
        let step = canvas::step(&y_range, 8);
        let digits = decimals(step);
        let x_step = canvas::step(&x_range, 12);
        let mut chart = chart(
            area,
            margins,
            Axis {
                range: x_range.clone(),
                ticks: ticks(&x_range, x_step),
                label: &|rpm| tick_text(*rpm, 0),
                title: "speed in rpm",
            },
            Axis {
                range: y_range.clone(),
                ticks: ticks(&y_range, step),
                label: &|torque| tick_text(*torque, digits),
                title: "mean torque in Nm",
            },
        )?;
        draw_marks(&mut chart, plot, &x_range, &y_range, width)?;
        let demand = [(x_range.start, plot.torque), (x_range.end, plot.torque)];
        polyline(&mut chart, demand, line(DEMAND, 1.0))?;
        let held = demand.map(|(rpm, torque)| (rpm, plot.held * torque));
        dashed(&mut chart, held, line(DEMAND, 1.0), (6.0, 4.0))?;
        let name = text(INK, 0.95);
        let above = anchored(&name, HPos::Left, VPos::Bottom);
        write_at(&chart, "demand", demand[0], (6.0, -3.0), &above)?;
        let below = anchored(&name, HPos::Left, VPos::Top);
        let percent = format!("{:.0} % of it", 100.0 * plot.held);
        write_at(&chart, &percent, held[0], (6.0, 3.0), &below)?;
        for curve in &plot.curves {
            draw_curve(&mut chart, curve)?;
        }
        Ok(())
    })
}

fn draw_curve(chart: &mut Chart<'_, '_>, curve: &Curve) -> Result<(), ReportError> {
    let style = line(curve.color, 2.0);
    let points = curve.points.iter().copied();
    match dash(curve.index) {
        (_, 0.0) => polyline(chart, points, style)?,
        pattern => dashed(chart, points, style, pattern)?,
    }
    let at_limit = curve
        .limit_rpm
        .and_then(|rpm| interpolated(&curve.points, rpm).map(|torque| (rpm, torque)));
    if let Some(at) = at_limit {
        let dot = Circle::new(at, px(4.0), curve.color.filled());
        chart.plotting_area().draw(&dot).map_err(failed)?;
    }
    Ok(())
}

fn draw_marks(
    chart: &mut Chart<'_, '_>,
    plot: &TorqueSpeed<'_>,
    x_range: &Range<f64>,
    y_range: &Range<f64>,
    width: f64,
) -> Result<(), ReportError> {
    let per_rpm = width / (x_range.end - x_range.start);
    let rated = SpeedMark {
        label: "rated".to_owned(),
        percent: 100.0,
    };
    let mut marks: Vec<&SpeedMark> = plot.marks.iter().chain([&rated]).collect();
    marks.sort_by(|a, b| a.percent.total_cmp(&b.percent));
    let mut free_from = f64::NEG_INFINITY;
    let upright = text(INK, 0.95).transform(FontTransform::Rotate270);
    let upright = anchored(&upright, HPos::Left, VPos::Bottom);
    for mark in marks {
        let rpm = mark.percent / 100.0 * plot.rated_rpm;
        if !(x_range.start..=x_range.end).contains(&rpm) {
            continue;
        }
        let from_top = [(rpm, y_range.end), (rpm, y_range.start)];
        dashed(chart, from_top, line(AXIS, 1.0), (2.0, 3.0))?;
        let label = format!("{}: {:.0} %", mark.label, mark.percent);
        // Texts stand upright, left of their lines, from the bottom up; one that would meet the
        // text before it moves to the right of its line.
        let line_at = (rpm - x_range.start) * per_rpm;
        let offset = if line_at - TEXT_DISTANCE < free_from {
            TEXT_DISTANCE
        } else {
            -3.0
        };
        free_from = line_at + offset.max(0.0);
        write_at(
            chart,
            &label,
            (rpm, y_range.start),
            (offset, -6.0),
            &upright,
        )?;
    }
    Ok(())
}

/// Torque on a curve at a speed, linear between its points.
fn interpolated(points: &[(f64, f64)], rpm: f64) -> Option<f64> {
    points.windows(2).find_map(|pair| {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        (x0..=x1)
            .contains(&rpm)
            .then(|| y0 + (y1 - y0) * (rpm - x0) / (x1 - x0).max(f64::MIN_POSITIVE))
    })
}

/// From the curves' first to their last speed, and to the marks.
fn speed_range(plot: &TorqueSpeed<'_>) -> Range<f64> {
    let speeds = plot
        .curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(|point| point.0));
    let marks = plot
        .marks
        .iter()
        .map(|mark| mark.percent / 100.0 * plot.rated_rpm);
    let (least, most) = speeds
        .chain(marks)
        .fold((plot.rated_rpm, plot.rated_rpm), |(least, most), rpm| {
            (least.min(rpm), most.max(rpm))
        });
    let pad = 0.02 * (most - least).max(1.0);
    least..most + pad
}

/// Holds every curve; at least 15 % of the demand high.
fn torque_range(plot: &TorqueSpeed<'_>) -> Range<f64> {
    let torques = plot
        .curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(|point| point.1));
    let span = 0.1 * plot.torque.abs();
    let start = (plot.torque - span, plot.torque + 0.5 * span);
    let (least, most) = torques
        .filter(|torque| torque.is_finite())
        .fold(start, |(least, most), torque| {
            (least.min(torque), most.max(torque))
        });
    let step = canvas::step(&(least..most), 8);
    (least / step).floor() * step..(most / step).ceil() * step
}
