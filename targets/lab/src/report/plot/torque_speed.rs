//! Mean torque over speed, all variants in one plot, with the demand and marks.

use super::super::palette::{Color, DEMAND, INK};
use super::{Axis, Element, Label, Plot, Point, Series, Side, Stroke, step};
use crate::closed_loop::{self, Held, TOLERANCE};
use crate::results::SpeedMark;
use std::ops::Range;

/// Share of the demand at which curves are cut off.
const LEAST: f64 = 0.8;

/// Dash patterns of the variants in CSS pixels, to distinguish coinciding curves and prints without
/// colour.
const DASHES: [(f64, f64); 4] = [(0.0, 0.0), (9.0, 3.0), (4.0, 3.0), (1.5, 2.5)];

/// One variant's curve.
#[derive(Debug)]
pub struct Curve {
    /// Name.
    pub name: String,
    /// Colour.
    pub color: Color,
    /// Index in the legend, which selects the dash pattern.
    pub index: usize,
    /// Speed in rpm and mean torque, ascending.
    pub points: Vec<Point>,
    /// Speed limit in rpm, marked on the curve.
    pub limit_rpm: Option<f64>,
}

/// What is drawn.
#[derive(Debug)]
pub struct TorqueSpeed<'a> {
    /// Unit of torque.
    pub unit: &'static str,
    /// Demanded torque.
    pub torque: f64,
    /// Rated speed in rpm.
    pub rated_rpm: f64,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Bounds by name, in the curves' units.
    pub bounds: Vec<(&'static str, Vec<Point>)>,
    /// Marks along the speed axis.
    pub marks: &'a [SpeedMark],
    /// Criterion for a mean torque that is held.
    pub held: Held,
}

/// Dash and gap of the curve with this index in the legend, in CSS pixels; no gap means a solid
/// line.
pub fn dash(index: usize) -> (f64, f64) {
    DASHES[index % DASHES.len()]
}

/// The curves, the demand, its tolerance, and the marks.
pub fn torque_speed(plan: &TorqueSpeed<'_>) -> Plot {
    let (x_range, y_range) = (speed_range(plan), torque_range(plan));
    let x = Axis::new("speed in rpm", &x_range, 12);
    let y = Axis::new(format!("mean torque in {}", plan.unit), &y_range, 8);
    let description = "Mean torque over speed of all variants";
    let mut plot = Plot::new(description, (1120.0, 440.0), x, y);
    for mark in marks(plan, &x_range) {
        plot.add(mark);
    }
    draw_demand(&mut plot, plan, &x_range);
    for (name, points) in &plan.bounds {
        draw_bound(&mut plot, name, points, [&x_range, &y_range]);
    }
    for curve in &plan.curves {
        draw_curve(&mut plot, curve, y_range.start);
    }
    plot
}

/// The demand and its tolerance.
fn draw_demand(plot: &mut Plot, plan: &TorqueSpeed<'_>, x_range: &Range<f64>) {
    let demand = [(x_range.start, plan.torque), (x_range.end, plan.torque)];
    plot.line(demand, Stroke::solid(DEMAND, 1.0));
    let label = |at, offset, text: String, upright| {
        Element::Label(Label {
            at,
            offset,
            text,
            color: INK,
            size: 0.95,
            anchor: (Side::Start, upright),
        })
    };
    plot.add(label(
        demand[0],
        (6.0, -3.0),
        "demand".to_owned(),
        Side::End,
    ));
    for side in plan.held.sides() {
        let held = demand.map(|(rpm, torque)| (rpm, side.edge() * torque));
        plot.line(held, Stroke::dashed(DEMAND, 1.0, (6.0, 4.0)));
        let percent = format!("{:.0} % of demand", 100.0 * side.edge());
        // Next to the name of the demand, however near its line is.
        let (offset, upright) = match side {
            closed_loop::Side::Below => ((6.0, 3.0), Side::Start),
            closed_loop::Side::Above => ((66.0, -3.0), Side::End),
        };
        plot.add(label(held[0], offset, percent, upright));
    }
}

/// The part of a bound within ranges of speed and torque.
fn draw_bound(plot: &mut Plot, name: &str, points: &[Point], ranges: [&Range<f64>; 2]) {
    let [x_range, y_range] = ranges;
    let is_seen =
        |&&(x, y): &&Point| y <= y_range.end && (x_range.start..=x_range.end).contains(&x);
    let points: Vec<Point> = points.iter().filter(is_seen).copied().collect();
    let stroke = Stroke::dashed(DEMAND, 1.5, (1.5, 3.0));
    plot.series(Series::new(name, above(&points, y_range.start), stroke));
}

fn draw_curve(plot: &mut Plot, curve: &Curve, floor: f64) {
    let points = above(&curve.points, floor);
    let dot = |at, width| Element::Dot {
        at,
        radius: 4.0,
        color: curve.color,
        width,
    };
    if let [alone] = points[..] {
        plot.add(dot(alone, Some(2.0)));
    }
    let stroke = Stroke::dashed(curve.color, 2.0, dash(curve.index));
    plot.series(Series {
        variant: Some(curve.index),
        ..Series::new(curve.name.clone(), points, stroke)
    });
    let at_limit = curve
        .limit_rpm
        .and_then(|rpm| interpolated(&curve.points, rpm).map(|torque| (rpm, torque)));
    if let Some(at) = at_limit {
        plot.add(dot(at, None));
    }
}

/// A curve down to its first value below a torque.
fn above(points: &[(f64, f64)], floor: f64) -> Vec<Point> {
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

/// The marks within a range of speeds, the rated speed among them, from the slowest.
fn marks(plan: &TorqueSpeed<'_>, x_range: &Range<f64>) -> Vec<Element> {
    let rated = SpeedMark {
        label: "rated".to_owned(),
        percent: 100.0,
    };
    let mut marks: Vec<&SpeedMark> = plan.marks.iter().chain([&rated]).collect();
    marks.sort_by(|a, b| a.percent.total_cmp(&b.percent));
    let placed = marks.into_iter().map(|mark| Element::Mark {
        at: mark.percent / 100.0 * plan.rated_rpm,
        text: format!("{} {:.0} %", mark.label, mark.percent),
    });
    let is_inside = |mark: &Element| matches!(mark, Element::Mark { at, .. } if (x_range.start..=x_range.end).contains(at));
    placed.filter(is_inside).collect()
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

/// Contains every curve down to [`LEAST`] of the demand; at least 12 % of the demand high.
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
    let step = step(&(least..most), 8);
    (least / step).floor() * step..(most / step).ceil() * step
}
