//! The drawing surface: plotters' SVG, made to fit into a page.
//!
//! plotters draws on whole pixels, so everything is drawn four times as large as it appears.
//! The root element is written anew: it scales with its column, names itself for screen readers,
//! and needs no namespace inside HTML.

use super::palette::{AXIS, GRID, INK};
use crate::report::ReportError;
use maud::PreEscaped;
use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// Drawn pixels per CSS pixel.
const SCALE: f64 = 4.0;

/// Font size of labels in CSS pixels.
const FONT: f64 = 12.0;

/// Width of a label's character in CSS pixels, rather too wide than too narrow.
pub const CHARACTER: f64 = 7.2;

/// A drawing area of the page's plots.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A linear axis whose ticks are given.
pub struct Coordinate {
    range: Range<f64>,
    ticks: Vec<f64>,
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

/// A plot with axes.
pub type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Coordinate, Coordinate>>;

/// What drawing may yield: plotters' error, as text.
pub type Drawn<T = ()> = Result<T, ReportError>;

/// Turns plotters' error into the report's.
pub fn failed(error: impl std::fmt::Display) -> ReportError {
    ReportError::Plot(error.to_string())
}

/// A length in CSS pixels as drawn pixels.
pub fn px(length: f64) -> i32 {
    (length * SCALE).round() as i32
}

/// An opaque line of a width in CSS pixels.
pub fn line(color: RGBColor, width: f64) -> ShapeStyle {
    color.stroke_width(px(width) as u32)
}

/// Text of the labels' size, or of another relative to it.
pub fn text(color: RGBColor, relative: f64) -> TextStyle<'static> {
    // plotters divides sizes by 1.24 when it writes SVG.
    ("sans-serif", FONT * SCALE * 1.24 * relative)
        .into_font()
        .color(&color)
}

/// Text with its anchor.
pub fn anchored(style: &TextStyle<'static>, h: HPos, v: VPos) -> TextStyle<'static> {
    style.pos(Pos::new(h, v))
}

/// Draws a picture of a size in CSS pixels and wraps it for the page. `description` is what a
/// screen reader says.
pub fn svg(
    (width, height): (f64, f64),
    description: &str,
    draw: impl FnOnce(&Area<'_>) -> Drawn,
) -> Drawn<PreEscaped<String>> {
    let mut drawn = String::new();
    let size = (px(width) as u32, px(height) as u32);
    {
        let area = SVGBackend::with_string(&mut drawn, size).into_drawing_area();
        draw(&area)?;
        area.present().map_err(failed)?;
    }
    let body = drawn.split_once('>').map_or("", |(_, body)| body);
    let label = maud::html! { (description) }.into_string();
    Ok(PreEscaped(format!(
        "<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{label}\">{body}",
        size.0, size.1
    )))
}

/// One axis: its range, where ticks are, and what stands beside it.
pub struct Axis<'a> {
    /// From and to.
    pub range: Range<f64>,
    /// Positions of ticks and grid lines.
    pub ticks: Vec<f64>,
    /// Text of a tick.
    pub label: &'a dyn Fn(&f64) -> String,
    /// Name and unit.
    pub title: &'a str,
}

/// Room around the plotted area in CSS pixels.
#[derive(Clone, Copy)]
pub struct Margins {
    /// Above.
    pub top: f64,
    /// To the right.
    pub right: f64,
    /// Below, for ticks and title.
    pub bottom: f64,
    /// To the left, for ticks and title.
    pub left: f64,
}

impl Margins {
    /// Room that fits the labels of a vertical axis, and beside the longest its title.
    pub fn fitting(y: &Axis<'_>) -> Self {
        let longest = y.ticks.iter().map(|tick| (y.label)(tick).chars().count());
        let labels = CHARACTER * longest.max().unwrap_or(0) as f64;
        Self {
            top: 8.0,
            right: 12.0,
            bottom: 40.0,
            left: (30.0 + labels).max(52.0),
        }
    }
}

/// Draws the frame, grid, ticks and titles.
pub fn chart<'a, 'b>(
    area: &'a Area<'b>,
    margins: Margins,
    x: Axis<'_>,
    y: Axis<'_>,
) -> Drawn<Chart<'a, 'b>> {
    let mut chart = ChartBuilder::on(area)
        .margin_top(px(margins.top))
        .margin_right(px(margins.right))
        // Upright titles would touch the edge.
        .margin_left(px(2.0))
        .set_label_area_size(LabelAreaPosition::Bottom, px(margins.bottom))
        .set_label_area_size(LabelAreaPosition::Left, px(margins.left - 2.0))
        .build_cartesian_2d(
            Coordinate {
                range: x.range,
                ticks: x.ticks,
            },
            Coordinate {
                range: y.range,
                ticks: y.ticks,
            },
        )
        .map_err(failed)?;
    chart
        .configure_mesh()
        .bold_line_style(line(GRID, 1.0))
        .light_line_style(TRANSPARENT)
        .axis_style(line(AXIS, 1.0))
        .set_all_tick_mark_size(px(4.0))
        .label_style(text(INK, 1.0))
        .axis_desc_style(text(INK, 1.0))
        .x_label_formatter(x.label)
        .y_label_formatter(y.label)
        .x_desc(x.title)
        .y_desc(y.title)
        .draw()
        .map_err(failed)?;
    Ok(chart)
}

/// Draws a line through points.
pub fn polyline(
    chart: &mut Chart<'_, '_>,
    points: impl IntoIterator<Item = (f64, f64)>,
    style: impl Into<ShapeStyle>,
) -> Drawn {
    let element = PathElement::new(points.into_iter().collect::<Vec<_>>(), style);
    chart.plotting_area().draw(&element).map_err(failed)
}

/// Draws a dashed line through points.
pub fn dashed(
    chart: &mut Chart<'_, '_>,
    points: impl IntoIterator<Item = (f64, f64)>,
    style: ShapeStyle,
    (dash, gap): (f64, f64),
) -> Drawn {
    let points: Vec<_> = points.into_iter().collect();
    let series = DashedLineSeries::new(points, px(dash) as u32, px(gap) as u32, style);
    chart.draw_series(series).map(|_| ()).map_err(failed)
}

/// Writes at a point of the plot, moved by CSS pixels to the right and down.
pub fn write_at(
    chart: &Chart<'_, '_>,
    content: &str,
    at: (f64, f64),
    (right, down): (f64, f64),
    style: &TextStyle<'static>,
) -> Drawn {
    let area = chart.plotting_area();
    let (x, y) = area.map_coordinate(&at);
    let absolute = area.strip_coord_spec();
    let (x0, y0) = absolute.get_base_pixel();
    absolute
        .draw_text(content, style, (x - x0 + px(right), y - y0 + px(down)))
        .map_err(failed)
}

/// Draws an upright line from a point of the plot upwards, so many CSS pixels long; it may leave
/// the plotted area.
pub fn rule_above(chart: &Chart<'_, '_>, at: (f64, f64), length: f64, style: ShapeStyle) -> Drawn {
    let rule = EmptyElement::at(at) + PathElement::new([(0, 0), (0, -px(length))], style);
    chart.plotting_area().draw(&rule).map_err(failed)
}

/// Steps of 1, 2 or 5 times a power of ten that part a range into at most `most` pieces.
pub fn step(range: &Range<f64>, most: usize) -> f64 {
    let least = (range.end - range.start) / most as f64;
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|digit| digit * power)
        .find(|&step| step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// The multiples of a step within a range.
pub fn ticks(range: &Range<f64>, step: f64) -> Vec<f64> {
    let first = (range.start / step - 1e-9).ceil() as i64;
    let last = (range.end / step + 1e-9).floor() as i64;
    (first..=last).map(|k| k as f64 * step).collect()
}

/// A number for a tick: so many decimals, a true minus sign, no negative zero.
pub fn tick_text(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let zero = text.chars().all(|c| c == '0' || c == '.');
    if value < 0.0 && !zero {
        format!("\u{2212}{text}")
    } else {
        text
    }
}

/// Decimals that tell apart ticks of a step.
pub fn decimals(step: f64) -> usize {
    (-step.log10() - 1e-9).ceil().clamp(0.0, 9.0) as usize
}
