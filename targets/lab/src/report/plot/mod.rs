//! Plots: two axes and the elements between them. Lengths are in CSS pixels. Margins are the
//! renderer's, which knows the width of the screen.

mod bars;
mod plane;
mod stability;
mod torque_speed;
mod turn;
mod window;

pub use bars::{Bar, Bars, bars, histogram};
pub use plane::{Named, Plane, corners, plane, ray, trajectory};
pub use stability::{SEARCH, stability};
pub use torque_speed::{Curve, TorqueSpeed, dash, torque_speed};
pub use turn::{ANGLE, Level, Wave, ideal_phase, levels, reference_phase, torque_range, wave};
pub use window::{Columns, FIRST_DEG, TURN, columns, columns_between, means};

use super::palette::Color;
use serde::Serialize;
use std::ops::Range;

/// A point of the plotted plane.
pub type Point = (f64, f64);

/// A plot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plot {
    /// Description for screen readers.
    pub description: String,
    /// Width and height where there is room.
    pub size: (f64, f64),
    /// Whether both axes have the same scale.
    pub is_square: bool,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The elements, the lowest first.
    pub elements: Vec<Element>,
}

impl Plot {
    /// A plot without content.
    pub fn new(description: impl Into<String>, size: (f64, f64), x: Axis, y: Axis) -> Self {
        Self {
            description: description.into(),
            size,
            is_square: false,
            x,
            y,
            elements: Vec::new(),
        }
    }

    /// Adds an element on top.
    pub fn add(&mut self, element: Element) {
        self.elements.push(element);
    }

    /// Adds a signal.
    pub fn series(&mut self, series: Series) {
        self.add(Element::Series(series));
    }

    /// Draws a line.
    pub fn line(&mut self, points: impl IntoIterator<Item = Point>, stroke: Stroke) {
        let points = points.into_iter().collect();
        self.add(Element::Line { points, stroke });
    }

    /// Fills a rectangle between two corners.
    pub fn block(&mut self, from: Point, to: Point, (color, opacity): (Color, f64)) {
        let points = vec![from, (from.0, to.1), to, (to.0, from.1)];
        self.add(Element::Area {
            points,
            color,
            opacity,
        });
    }

    /// Adds a text above a point, centred.
    pub fn write_above(&mut self, text: impl Into<String>, at: Point, (color, size): (Color, f64)) {
        self.add(Element::Label(Label {
            at,
            offset: (0.0, -3.0),
            text: text.into(),
            color,
            size,
            anchor: (Side::Middle, Side::End),
        }));
    }
}

/// An axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// Name and unit.
    pub title: String,
    /// From and to.
    pub range: (f64, f64),
    /// Places of ticks and grid lines, with their labels.
    pub ticks: Vec<(f64, String)>,
    /// Whether the places are logarithms to base 10 of what they stand for.
    pub is_logarithmic: bool,
}

impl Axis {
    /// An axis with ticks that divide its range into at most this many parts.
    pub fn new(title: impl Into<String>, range: &Range<f64>, pieces: usize) -> Self {
        Self::stepped(title, range, step(range, pieces))
    }

    /// An axis with ticks at the multiples of a step. If zero is not on it, its title says so.
    pub fn stepped(title: impl Into<String>, range: &Range<f64>, step: f64) -> Self {
        let digits = (-step.log10() - 1e-9).ceil().clamp(0.0, 9.0) as usize;
        let ticks = multiples(range, step).into_iter();
        let mut title = title.into();
        if !(range.start..=range.end).contains(&0.0) {
            title.push_str(" (without 0)");
        }
        Self {
            title,
            range: (range.start, range.end),
            ticks: ticks.map(|at| (at, tick_text(at, digits))).collect(),
            is_logarithmic: false,
        }
    }

    /// An axis whose ticks are stated, and have their own names.
    pub fn ticked(title: impl Into<String>, range: (f64, f64), ticks: Vec<(f64, String)>) -> Self {
        Self {
            title: title.into(),
            range,
            ticks,
            is_logarithmic: false,
        }
    }
}

/// Element of a plot.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Element {
    /// A signal.
    Series(Series),
    /// A line through points.
    Line {
        /// The points.
        points: Vec<Point>,
        /// How it is drawn.
        stroke: Stroke,
    },
    /// A filled polygon.
    Area {
        /// Its corners.
        points: Vec<Point>,
        /// Its colour.
        color: Color,
        /// 0 to 1.
        opacity: f64,
    },
    /// A circle.
    Dot {
        /// Its centre.
        at: Point,
        /// Its radius.
        radius: f64,
        /// Its colour.
        color: Color,
        /// Width of its line; `None` for a filled one.
        width: Option<f64>,
    },
    /// A cross.
    Cross {
        /// Its centre.
        at: Point,
        /// Its colour.
        color: Color,
    },
    /// A dashed line upright through the plot, with its text above.
    Mark {
        /// Its place on the horizontal axis.
        at: f64,
        /// The words.
        text: String,
    },
    /// A short text.
    Label(Label),
}

/// A signal: a function of the horizontal axis, whose values a pointer reads and which can be
/// switched off.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Its name in the plot's legend.
    pub name: String,
    /// Index of the variant that it belongs to, if it belongs to one.
    pub variant: Option<usize>,
    /// Its points, ascending along the horizontal axis.
    pub points: Vec<Point>,
    /// Least and greatest value at each point, drawn as a pale band; empty for none.
    pub band: Vec<Point>,
    /// How it is drawn.
    pub stroke: Stroke,
    /// What is drawn at its points.
    pub shape: Shape,
    /// Whether it is switched off at first.
    pub is_off: bool,
}

/// What is drawn at the points of a signal. Ends are relative to the point, along the horizontal
/// axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// A line through all of them.
    Line,
    /// A bar from the lower edge of the plot up to each. One taller than the plot ends at its edge,
    /// with its value above.
    Bars(f64, f64),
    /// A level line at each.
    Levels(f64, f64),
}

impl Series {
    /// A signal that is drawn at first.
    pub fn new(name: impl Into<String>, points: Vec<Point>, stroke: Stroke) -> Self {
        Self {
            name: name.into(),
            variant: None,
            points,
            band: Vec::new(),
            stroke,
            shape: Shape::Line,
            is_off: false,
        }
    }

    /// A signal in columns, with its ripple as the band; without a band if it has none.
    pub fn of_columns(name: impl Into<String>, columns: Columns, stroke: Stroke) -> Self {
        let has_ripple = columns.least != columns.most;
        let band = columns.least.into_iter().zip(columns.most);
        let points = columns.angle.into_iter().zip(columns.mean);
        Self {
            band: band.filter(|_| has_ripple).collect(),
            ..Self::new(name, points.collect(), stroke)
        }
    }
}

/// A short text at a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Label {
    /// The point.
    pub at: Point,
    /// Offset to the right and down.
    pub offset: (f64, f64),
    /// The words.
    pub text: String,
    /// Their colour.
    pub color: Color,
    /// Their size relative to that of ticks.
    pub size: f64,
    /// The text's anchor, horizontal and vertical.
    pub anchor: (Side, Side),
}

/// Anchor of a text: left or top, the middle, right or bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Left or top.
    Start,
    /// The middle.
    Middle,
    /// Right or bottom.
    End,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stroke {
    /// Its colour.
    pub color: Color,
    /// Its width.
    pub width: f64,
    /// 0 to 1.
    pub opacity: f64,
    /// Dash and gap; no gap means a solid line.
    pub dash: (f64, f64),
}

impl Stroke {
    /// A solid opaque line.
    pub fn solid(color: Color, width: f64) -> Self {
        Self::dashed(color, width, (0.0, 0.0))
    }

    /// An opaque line of dashes.
    pub fn dashed(color: Color, width: f64, dash: (f64, f64)) -> Self {
        Self {
            color,
            width,
            opacity: 1.0,
            dash,
        }
    }
}

/// Steps of 1, 2 or 5 times a power of ten that divide a range into at most this many parts.
fn step(range: &Range<f64>, most: usize) -> f64 {
    let least = (range.end - range.start) / most as f64;
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|digit| digit * power)
        .find(|&step| step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// The multiples of a step within a range.
fn multiples(range: &Range<f64>, step: f64) -> Vec<f64> {
    let first = (range.start / step - 1e-9).ceil() as i64;
    let last = (range.end / step + 1e-9).floor() as i64;
    (first..=last).map(|k| k as f64 * step).collect()
}

/// A number for a tick: fixed decimals, a true minus sign, no negative zero.
fn tick_text(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let is_zero = text.chars().all(|c| c == '0' || c == '.');
    if value < 0.0 && !is_zero {
        format!("\u{2212}{text}")
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::Axis;

    #[test]
    fn an_axis_without_zero_says_so() {
        for (range, title) in [
            (0.0..2.0, "A"),
            (-1.0..1.0, "A"),
            (2.5..4.0, "A (without 0)"),
            (-4.0..-2.0, "A (without 0)"),
        ] {
            assert_eq!(Axis::new("A", &range, 5).title, title);
        }
    }
}
