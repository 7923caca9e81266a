//! Mean torque over speed, all variants in one plot, with the demand and marks.

use super::super::palette::{AXIS, Color, DEMAND, INK};
use super::{Axis, CHARACTER, Element, Label, Plot, Point, Side, Stroke, step};
use crate::closed_loop::{self, Held, TOLERANCE};
use crate::results::SpeedMark;
use std::ops::Range;

/// Height of a row of marks in CSS pixels.
const ROW: f64 = 17.0;

/// Share of the demand at which curves are cut off.
const LEAST: f64 = 0.8;

/// Dash patterns of the variants in CSS pixels, to distinguish coinciding curves and prints without
/// colour.
const DASHES: [(f64, f64); 4] = [(0.0, 0.0), (9.0, 3.0), (4.0, 3.0), (1.5, 2.5)];

/// One variant's curve.
#[derive(Debug)]
pub struct Curve {
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
    plot.margins.right = 16.0;
    let width = plot.size.0 - plot.margins.left - plot.margins.right;
    let marks = place_marks(plan, &x_range, width / (x_range.end - x_range.start));
    let rows = marks.iter().map(|mark| mark.row + 1).max().unwrap_or(0);
    plot.margins.top = ROW * rows as f64 + 8.0;
    for mark in &marks {
        draw_mark(&mut plot, mark, &y_range);
    }
    draw_demand(&mut plot, plan, &x_range);
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
    plot.line(points, Stroke::dashed(curve.color, 2.0, dash(curve.index)));
    let at_limit = curve
        .limit_rpm
        .and_then(|rpm| interpolated(&curve.points, rpm).map(|torque| (rpm, torque)));
    if let Some(at) = at_limit {
        plot.add(dot(at, None));
    }
}

/// A mark above the plot: its text ends at its line, in a row without any other text or line.
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
        // Above all earlier marks whose lines cross the text.
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

fn draw_mark(plot: &mut Plot, mark: &Placed, y_range: &Range<f64>) {
    let top = (mark.rpm, y_range.end);
    let foot = (mark.rpm, y_range.start);
    plot.line([top, foot], Stroke::dashed(AXIS, 1.0, (2.0, 3.0)));
    let height = ROW * mark.row as f64;
    plot.add(Element::Rule {
        at: top,
        length: height + ROW,
    });
    plot.add(Element::Label(Label {
        at: top,
        offset: (-4.0, -height - 3.0),
        text: mark.text.clone(),
        color: INK,
        size: 0.95,
        anchor: (Side::End, Side::End),
    }));
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
