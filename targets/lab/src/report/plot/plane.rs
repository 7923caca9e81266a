//! Lines and named points in the alpha-beta plane, both axes on the same scale.

use super::super::palette::{AXIS, Color, IDEAL, INK};
use super::window::{means, with_ripple};
use super::{Axis, Element, Label, Plot, Point, Side, Stroke};
use crate::closed_loop::{Trace, hexagon};

/// Distance of names from their points.
const NAMES: f64 = 14.0;

/// Width of a trajectory's plot.
const WIDTH: f64 = 281.0;

/// A point with its name.
#[derive(Clone, Debug)]
pub struct Named {
    /// Where it is.
    pub at: Point,
    /// Its name.
    pub name: String,
    /// Whether it is marked by a circle with its name outside, as seen from the origin; else its
    /// name is at the point itself.
    pub is_marked: bool,
}

/// What is drawn.
#[derive(Debug)]
pub struct Plane<'a> {
    /// Description for screen readers.
    pub description: String,
    /// Names and units of the two axes.
    pub titles: [&'a str; 2],
    /// Both axes range from minus to plus this value.
    pub reach: f64,
    /// Width of the picture.
    pub width: f64,
    /// Lines, the lowest first.
    pub lines: Vec<(Vec<Point>, Stroke)>,
    /// Points above all lines.
    pub points: Vec<Named>,
}

/// Lines and points of the plane.
pub fn plane(plane: Plane<'_>) -> Plot {
    let [x, y] = plane
        .titles
        .map(|title| Axis::new(title, &(-plane.reach..plane.reach), 8));
    let mut plot = Plot::new(plane.description, (plane.width, plane.width), x, y);
    plot.is_square = true;
    for (points, stroke) in plane.lines {
        plot.line(points, stroke);
    }
    for Named {
        at,
        name,
        is_marked,
    } in plane.points
    {
        let mut offset = (0.0, 0.0);
        if is_marked {
            plot.add(Element::Dot {
                at,
                radius: 3.0,
                color: INK,
                width: Some(1.0),
            });
            let (sin, cos) = at.1.atan2(at.0).sin_cos();
            offset = (NAMES * cos, -NAMES * sin);
        }
        plot.add(Element::Label(Label {
            at,
            offset,
            text: name,
            color: INK,
            size: 0.95,
            anchor: (Side::Middle, Side::Middle),
        }));
    }
    plot
}

/// One turn of a record, with ripple pale and the mean over one control period solid, over the
/// hexagon between the corners of the quasi-square reference of amplitude `current`. Both axes
/// range to `reach` amperes on either side.
pub fn trajectory(
    description: String,
    trace: &Trace,
    (current, reach): (f64, f64),
    color: Color,
) -> Plot {
    let pale = Stroke {
        opacity: 0.3,
        ..Stroke::solid(color, 0.8)
    };
    // Names of the corners are outside, where no commutation passes.
    plane(Plane {
        description,
        titles: ["i_alpha in A", "i_beta in A"],
        reach,
        width: WIDTH,
        lines: vec![
            (hexagon(current), Stroke::solid(IDEAL, 3.0)),
            (with_ripple(trace), pale),
            (means(trace), Stroke::solid(color, 1.4)),
        ],
        points: corners(current, "S"),
    })
}

/// Corners of the hexagon of a current, named by `prefix` and sector.
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

/// A dashed ray from the origin.
pub fn ray(to: Point) -> (Vec<Point>, Stroke) {
    let stroke = Stroke::dashed(AXIS, 0.8, (3.0, 3.0));
    (vec![(0.0, 0.0), to], stroke)
}
