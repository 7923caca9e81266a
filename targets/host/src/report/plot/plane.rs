//! Lines and named points in the alpha-beta plane, both axes on the same scale.

use super::canvas::{
    self, Axis, Margins, anchored, chart, dashed, decimals, failed, line, polyline, px, text,
    tick_text, ticks, write_at,
};
use super::palette::{AXIS, INK};
use crate::report::ReportError;
use maud::PreEscaped;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Distance of points' names from the points in CSS pixels.
const NAMES: f64 = 14.0;

/// A line through points of the plane.
pub struct Path {
    /// The points (alpha, beta).
    pub points: Vec<(f64, f64)>,
    /// Colour.
    pub color: RGBColor,
    /// Opacity, 0 to 1.
    pub opacity: f64,
    /// Width in CSS pixels.
    pub width: f64,
    /// Dash and gap in CSS pixels; no gap means a solid line.
    pub dash: (f64, f64),
}

impl Path {
    /// A solid opaque line.
    pub fn solid(points: Vec<(f64, f64)>, color: RGBColor, width: f64) -> Self {
        Self {
            points,
            color,
            opacity: 1.0,
            width,
            dash: (0.0, 0.0),
        }
    }
}

/// A point with its name, which stands outside of it as seen from the origin.
pub struct Named {
    /// Where it is.
    pub at: (f64, f64),
    /// Its name.
    pub name: String,
    /// Whether it is marked by a circle; else its name stands at the place itself.
    pub is_marked: bool,
}

/// What is drawn.
pub struct Plane<'a> {
    /// What a screen reader says.
    pub description: &'a str,
    /// Names and units of the two axes.
    pub titles: [&'a str; 2],
    /// Both axes reach from minus to plus this value.
    pub reach: f64,
    /// Width of the picture in CSS pixels.
    pub width: f64,
    /// Lines, the lowest first.
    pub paths: Vec<Path>,
    /// Points above all lines.
    pub points: Vec<Named>,
}

/// Draws lines and points.
pub fn plane(plane: &Plane<'_>) -> Result<PreEscaped<String>, ReportError> {
    let reach = plane.reach;
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
    let height = plane.width - margins.left - margins.right + margins.top + margins.bottom;
    canvas::svg((plane.width, height), plane.description, |area| {
        let [alpha, beta] = plane.titles;
        let mut chart = chart(area, margins, axis(alpha), axis(beta))?;
        let frame = Rectangle::new([(-reach, reach), (reach, -reach)], line(AXIS, 1.0));
        chart.plotting_area().draw(&frame).map_err(failed)?;
        for path in &plane.paths {
            let points = path.points.iter().copied();
            let style = path
                .color
                .mix(path.opacity)
                .stroke_width(px(path.width) as u32);
            match path.dash {
                (_, 0.0) => polyline(&mut chart, points, style)?,
                pattern => dashed(&mut chart, points, style, pattern)?,
            }
        }
        let name = anchored(&text(INK, 0.95), HPos::Center, VPos::Center);
        for point in &plane.points {
            let mut place = (0.0, 0.0);
            if point.is_marked {
                let dot = Circle::new(point.at, px(3.0), INK.stroke_width(px(1.0) as u32));
                chart.plotting_area().draw(&dot).map_err(failed)?;
                let (sin, cos) = point.at.1.atan2(point.at.0).sin_cos();
                place = (NAMES * cos, -NAMES * sin);
            }
            write_at(&chart, &point.name, point.at, place, &name)?;
        }
        Ok(())
    })
}
