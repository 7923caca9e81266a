//! Plots as inline SVG, drawn by plotters.
//!
//! plotters draws on whole pixels, so everything is drawn four times as large as it appears.
//! The root element is written anew: it scales with its column, names itself for screen readers,
//! and needs no namespace inside HTML.

use super::RenderError;
use hexagen_lab::report::plot::{Axis, Element, Label, Plot, Side, Stroke};
use hexagen_lab::report::{AXIS, Color, GRID, INK};
use maud::{Markup, PreEscaped};
use plotters::chart::ChartContext;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::prelude::*;
use plotters::style::Color as _;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::fmt::Display;
use std::ops::Range;

/// Drawn pixels per CSS pixel.
const SCALE: f64 = 4.0;

/// Font size of labels in CSS pixels.
const FONT: f64 = 12.0;

/// A linear axis whose ticks are given.
struct Coordinate {
    range: Range<f64>,
    ticks: Vec<f64>,
}

impl Coordinate {
    fn of(axis: &Axis) -> Self {
        Self {
            range: axis.range.0..axis.range.1,
            ticks: axis.ticks.iter().map(|(at, _)| *at).collect(),
        }
    }
}

impl Ranged for Coordinate {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (value - self.range.start) / (self.range.end - self.range.start);
        from + (f64::from(to - from) * share).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        // Light lines are never drawn.
        if hint.weight().allow_light_points() {
            Vec::new()
        } else {
            self.ticks.clone()
        }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Coordinate, Coordinate>>;

fn failed(error: impl Display) -> RenderError {
    RenderError::Plot(error.to_string())
}

/// A length in CSS pixels as drawn pixels.
fn px(length: f64) -> i32 {
    (length * SCALE).round() as i32
}

fn rgb(Color(red, green, blue): Color) -> RGBColor {
    RGBColor(red, green, blue)
}

fn style(stroke: &Stroke) -> ShapeStyle {
    let color = rgb(stroke.color).mix(stroke.opacity);
    color.stroke_width(px(stroke.width) as u32)
}

fn solid(color: Color, width: f64) -> ShapeStyle {
    style(&Stroke::solid(color, width))
}

/// Text of the ticks' size, or of another relative to it.
fn text(color: Color, relative: f64) -> TextStyle<'static> {
    // plotters divides sizes by 1.24 when it writes SVG.
    let font = ("sans-serif", FONT * SCALE * 1.24 * relative).into_font();
    font.color(&rgb(color))
}

/// A plot as a picture.
///
/// # Errors
/// An error of plotters.
pub fn svg(plot: &Plot) -> Result<Markup, RenderError> {
    let mut drawn = String::new();
    let (width, height) = (px(plot.size.0) as u32, px(plot.size.1) as u32);
    {
        let area = SVGBackend::with_string(&mut drawn, (width, height)).into_drawing_area();
        let mut chart = axes(&area, plot)?;
        for element in &plot.elements {
            draw(&mut chart, element)?;
        }
        area.present().map_err(failed)?;
    }
    let body = drawn.split_once('>').map_or("", |(_, body)| body);
    let label = maud::html! { (plot.description) }.into_string();
    Ok(PreEscaped(format!(
        "<svg class=\"plot\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{label}\">{body}"
    )))
}

/// Grid, ticks and titles.
fn axes<'a, 'b>(area: &'a Area<'b>, plot: &Plot) -> Result<Chart<'a, 'b>, RenderError> {
    let margins = plot.margins;
    let mut chart = ChartBuilder::on(area)
        .margin_top(px(margins.top))
        .margin_right(px(margins.right))
        // Upright titles would touch the edge.
        .margin_left(px(2.0))
        .set_label_area_size(LabelAreaPosition::Bottom, px(margins.bottom))
        .set_label_area_size(LabelAreaPosition::Left, px(margins.left - 2.0))
        .build_cartesian_2d(Coordinate::of(&plot.x), Coordinate::of(&plot.y))
        .map_err(failed)?;
    let label = |axis: &Axis, at: f64| {
        let tick = axis.ticks.iter().find(|(place, _)| *place == at);
        tick.map_or_else(String::new, |(_, label)| label.clone())
    };
    chart
        .configure_mesh()
        .bold_line_style(solid(GRID, 1.0))
        .light_line_style(TRANSPARENT)
        .axis_style(solid(AXIS, 1.0))
        .set_all_tick_mark_size(px(4.0))
        .label_style(text(INK, 1.0))
        .axis_desc_style(text(INK, 1.0))
        .x_label_formatter(&|at| label(&plot.x, *at))
        .y_label_formatter(&|at| label(&plot.y, *at))
        .x_desc(&plot.x.title)
        .y_desc(&plot.y.title)
        .draw()
        .map_err(failed)?;
    Ok(chart)
}

fn draw(chart: &mut Chart<'_, '_>, element: &Element) -> Result<(), RenderError> {
    let area = chart.plotting_area();
    match element {
        Element::Line { points, stroke } => {
            return line(chart, points, stroke);
        }
        Element::Area {
            points,
            color,
            opacity,
        } => area.draw(&Polygon::new(points.clone(), rgb(*color).mix(*opacity))),
        Element::Dot {
            at,
            radius,
            color,
            width,
        } => {
            let style = width.map_or(rgb(*color).filled(), |width| solid(*color, width));
            area.draw(&Circle::new(*at, px(*radius), style))
        }
        Element::Cross { at, color } => area.draw(&Cross::new(*at, px(4.0), solid(*color, 2.0))),
        Element::Rule { at, length } => {
            let rule = PathElement::new([(0, 0), (0, -px(*length))], solid(AXIS, 1.0));
            area.draw(&(EmptyElement::at(*at) + rule))
        }
        Element::Label(label) => return write(chart, label),
    }
    .map_err(failed)
}

fn line(
    chart: &mut Chart<'_, '_>,
    points: &[(f64, f64)],
    stroke: &Stroke,
) -> Result<(), RenderError> {
    let (dash, gap) = stroke.dash;
    if gap > 0.0 {
        let (dash, gap) = (px(dash) as u32, px(gap) as u32);
        let series = DashedLineSeries::new(points.to_vec(), dash, gap, style(stroke));
        chart.draw_series(series).map_err(failed)?;
        return Ok(());
    }
    let line = PathElement::new(points.to_vec(), style(stroke));
    chart.plotting_area().draw(&line).map_err(failed)
}

fn write(chart: &Chart<'_, '_>, label: &Label) -> Result<(), RenderError> {
    let (across, upright) = label.anchor;
    let across = match across {
        Side::Start => HPos::Left,
        Side::Middle => HPos::Center,
        Side::End => HPos::Right,
    };
    let upright = match upright {
        Side::Start => VPos::Top,
        Side::Middle => VPos::Center,
        Side::End => VPos::Bottom,
    };
    let style = text(label.color, label.size).pos(Pos::new(across, upright));
    let area = chart.plotting_area();
    let (x, y) = area.map_coordinate(&label.at);
    let absolute = area.strip_coord_spec();
    let (x0, y0) = absolute.get_base_pixel();
    let (right, down) = (px(label.offset.0), px(label.offset.1));
    let at = (x - x0 + right, y - y0 + down);
    absolute.draw_text(&label.text, &style, at).map_err(failed)
}
