//! Harmonics as groups of bars: a group per order, a bar per variant, a line for the ideal.

use super::canvas::{
    self, Axis, Margins, anchored, chart, decimals, failed, line, polyline, text, tick_text, ticks,
    write_at,
};
use super::palette::{AXIS, INK};
use crate::report::ReportError;
use maud::PreEscaped;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Share of a group's width that its bars fill.
const FILLED: f64 = 0.8;

/// Bars side by side.
pub struct Group {
    /// Text below.
    pub name: String,
    /// A value per bar, where there is one.
    pub values: Vec<Option<f64>>,
    /// The ideal value, marked across the group.
    pub ideal: Option<f64>,
}

/// Groups of bars.
pub struct Bars<'a> {
    /// What a screen reader says.
    pub description: &'a str,
    /// Name of the horizontal axis.
    pub x_title: &'a str,
    /// Name and unit of the vertical axis.
    pub y_title: &'a str,
    /// Greatest value of the vertical axis; positive.
    pub top: f64,
    /// Colour of each bar in a group.
    pub colors: Vec<RGBColor>,
    /// The groups.
    pub groups: Vec<Group>,
}

/// Draws the groups. A bar that would be taller than the plot ends at its edge with its value above.
pub fn bars(bars: &Bars<'_>) -> Result<PreEscaped<String>, ReportError> {
    canvas::svg((550.0, 270.0), bars.description, |area| {
        let range = 0.0..bars.top;
        let step = canvas::step(&range, 6);
        let digits = decimals(step);
        let count = bars.groups.len();
        let names = |position: &f64| {
            let index = (position - 0.5).round();
            let group = bars.groups.get(index.max(0.0) as usize);
            group.map_or_else(String::new, |group| group.name.clone())
        };
        let y = Axis {
            range: range.clone(),
            ticks: ticks(&range, step),
            label: &|value| tick_text(*value, digits),
            title: bars.y_title,
        };
        let margins = Margins {
            top: 18.0,
            ..Margins::fitting(&y)
        };
        let mut chart = chart(
            area,
            margins,
            Axis {
                range: 0.0..count as f64,
                ticks: (0..count).map(|k| k as f64 + 0.5).collect(),
                label: &names,
                title: bars.x_title,
            },
            y,
        )?;
        let width = FILLED / bars.colors.len().max(1) as f64;
        let above = anchored(&text(AXIS, 0.8), HPos::Center, VPos::Bottom);
        for (k, group) in bars.groups.iter().enumerate() {
            let start = k as f64 + (1.0 - FILLED) / 2.0;
            for (bar, (value, color)) in group.values.iter().zip(&bars.colors).enumerate() {
                let Some(value) = *value else {
                    continue;
                };
                let left = start + bar as f64 * width;
                let corners = [(left, value.min(bars.top)), (left + 0.88 * width, 0.0)];
                let element = Rectangle::new(corners, color.filled());
                chart.plotting_area().draw(&element).map_err(failed)?;
                if value > bars.top {
                    let at = (left + 0.44 * width, bars.top);
                    let label = tick_text(value, 0);
                    write_at(&chart, &label, at, (0.0, -2.0), &above)?;
                }
            }
            if let Some(ideal) = group.ideal {
                let (from, to) = (k as f64 + 0.04, k as f64 + 0.96);
                polyline(&mut chart, [(from, ideal), (to, ideal)], line(INK, 1.6))?;
            }
        }
        Ok(())
    })
}
