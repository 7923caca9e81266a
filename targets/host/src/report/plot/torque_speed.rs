//! Mean torque over speed, all variants in one plot, with the demand and marks of interest.

use super::canvas::{
    self, Axis, CHARACTER, Chart, Drawn, Margins, anchored, chart, dashed, decimals, failed, line,
    polyline, px, rule_above, text, tick_text, ticks, write_at,
};
use super::palette::{AXIS, DEMAND, INK};
use crate::report::ReportError;
use hexagen_lab::closed_loop::{Held, Side, TOLERANCE};
use hexagen_lab::results::SpeedMark;
use maud::PreEscaped;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::ops::Range;

/// Height of a row of marks in CSS pixels.
const ROW: f64 = 17.0;

/// Share of the demand below which curves are cut off: how they fall further tells nothing.
const LEAST: f64 = 0.8;

/// Dash patterns of the variants in CSS pixels, so that curves on top of each other and prints
/// without colour can be told apart.
const DASHES: [(f64, f64); 4] = [(0.0, 0.0), (9.0, 3.0), (4.0, 3.0), (1.5, 2.5)];

/// One variant's curve.
pub struct Curve {
    /// Colour.
    pub color: RGBColor,
    /// Place in the legend; chooses the dash pattern.
    pub index: usize,
    /// Speed in rpm and mean torque, ascending.
    pub points: Vec<(f64, f64)>,
    /// Speed limit in rpm, marked on the curve.
    pub limit_rpm: Option<f64>,
}

/// The plot.
pub struct TorqueSpeed<'a> {
    /// Unit of torque.
    pub unit: &'static str,
    /// Demanded torque.
    pub torque: f64,
    /// Rated speed in rpm.
    pub rated_rpm: f64,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Marks along the speed axis.
    pub marks: &'a [SpeedMark],
    /// Which mean torques count as held.
    pub held: Held,
}

/// Dash and gap of the curve at a place in the legend, in CSS pixels; no gap means a solid line.
pub fn dash(index: usize) -> (f64, f64) {
    DASHES[index % DASHES.len()]
}

/// Draws the plot.
pub fn torque_speed(plot: &TorqueSpeed<'_>) -> Result<PreEscaped<String>, ReportError> {
    let size = (1120.0, 440.0);
    let (x_range, y_range) = (speed_range(plot), torque_range(plot));
    let step = canvas::step(&y_range, 8);
    let digits = decimals(step);
    let title = format!("mean torque in {}", plot.unit);
    let y = Axis {
        range: y_range.clone(),
        ticks: ticks(&y_range, step),
        label: &|torque| tick_text(*torque, digits),
        title: &title,
    };
    let fitting = Margins {
        right: 16.0,
        ..Margins::fitting(&y)
    };
    let width = size.0 - fitting.left - fitting.right;
    let marks = place_marks(plot, &x_range, width / (x_range.end - x_range.start));
    let rows = marks.iter().map(|mark| mark.row + 1).max().unwrap_or(0);
    let margins = Margins {
        top: ROW * rows as f64 + 8.0,
        ..fitting
    };
    let description = "Mean torque over speed of all variants";
    canvas::svg(size, description, |area| {
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
            y,
        )?;
        draw_marks(&mut chart, &marks, &y_range)?;
        let demand = [(x_range.start, plot.torque), (x_range.end, plot.torque)];
        polyline(&mut chart, demand, line(DEMAND, 1.0))?;
        let name = text(INK, 0.95);
        let above = anchored(&name, HPos::Left, VPos::Bottom);
        write_at(&chart, "demand", demand[0], (6.0, -3.0), &above)?;
        let below = anchored(&name, HPos::Left, VPos::Top);
        for side in plot.held.sides() {
            let held = demand.map(|(rpm, torque)| (rpm, side.edge() * torque));
            dashed(&mut chart, held, line(DEMAND, 1.0), (6.0, 4.0))?;
            let percent = format!("{:.0} % of demand", 100.0 * side.edge());
            // Beside the name of the demand, however near its line is.
            let (offset, style) = match side {
                Side::Below => ((6.0, 3.0), &below),
                Side::Above => ((66.0, -3.0), &above),
            };
            write_at(&chart, &percent, held[0], offset, style)?;
        }
        for curve in &plot.curves {
            draw_curve(&mut chart, curve, y_range.start)?;
        }
        Ok(())
    })
}

fn draw_curve(chart: &mut Chart<'_, '_>, curve: &Curve, floor: f64) -> Drawn {
    let style = line(curve.color, 2.0);
    let points = above(&curve.points, floor);
    if let [alone] = points[..] {
        let dot = Circle::new(alone, px(4.0), style);
        chart.plotting_area().draw(&dot).map_err(failed)?;
    }
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

/// A mark above the plot: its text ends at its line, in a row that no other text or line meets.
struct Placed {
    rpm: f64,
    text: String,
    row: usize,
}

/// Places the marks within a range of speeds; `per_rpm` is in CSS pixels.
fn place_marks(plot: &TorqueSpeed<'_>, x_range: &Range<f64>, per_rpm: f64) -> Vec<Placed> {
    let rated = SpeedMark {
        label: "rated".to_owned(),
        percent: 100.0,
    };
    let mut marks: Vec<&SpeedMark> = plot.marks.iter().chain([&rated]).collect();
    marks.sort_by(|a, b| a.percent.total_cmp(&b.percent));
    let mut placed: Vec<Placed> = Vec::new();
    for mark in marks {
        let rpm = mark.percent / 100.0 * plot.rated_rpm;
        if !(x_range.start..=x_range.end).contains(&rpm) {
            continue;
        }
        let text = format!("{} {:.0} %", mark.label, mark.percent);
        let text_from = rpm - text.chars().count() as f64 * CHARACTER / per_rpm;
        // Above all earlier marks whose line stands where the text shall be.
        let row = placed
            .iter()
            .filter(|earlier| earlier.rpm > text_from)
            .map(|earlier| earlier.row + 1)
            .max();
        placed.push(Placed {
            rpm,
            text,
            row: row.unwrap_or(0),
        });
    }
    placed
}

fn draw_marks(chart: &mut Chart<'_, '_>, marks: &[Placed], y_range: &Range<f64>) -> Drawn {
    let style = anchored(&text(INK, 0.95), HPos::Right, VPos::Bottom);
    for mark in marks {
        let top = (mark.rpm, y_range.end);
        dashed(
            chart,
            [top, (mark.rpm, y_range.start)],
            line(AXIS, 1.0),
            (2.0, 3.0),
        )?;
        let height = ROW * mark.row as f64;
        rule_above(chart, top, height + ROW, line(AXIS, 1.0))?;
        write_at(chart, &mark.text, top, (-4.0, -height - 3.0), &style)?;
    }
    Ok(())
}

/// A curve down to where it first falls below a torque.
fn above(points: &[(f64, f64)], floor: f64) -> Vec<(f64, f64)> {
    let mut kept = Vec::new();
    for &(x, y) in points {
        if y >= floor {
            kept.push((x, y));
            continue;
        }
        if let Some(&(x0, y0)) = kept.last() {
            kept.push((x0 + (x - x0) * (y0 - floor) / (y0 - y), floor));
        }
        break;
    }
    kept
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

/// Holds every curve as far down as [`LEAST`] of the demand; at least 12 % of the demand high.
fn torque_range(plot: &TorqueSpeed<'_>) -> Range<f64> {
    let torques = plot
        .curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(|point| point.1));
    let span = TOLERANCE * plot.torque.abs();
    let start = (plot.torque - 2.0 * span, plot.torque + 2.0 * span);
    let (least, most) = torques
        .filter(|torque| torque.is_finite())
        .fold(start, |(least, most), torque| {
            (least.min(torque), most.max(torque))
        });
    let least = least.max(LEAST * plot.torque);
    let step = canvas::step(&(least..most), 8);
    (least / step).floor() * step..(most / step).ceil() * step
}
