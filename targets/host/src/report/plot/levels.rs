//! Two-valued signals over one electrical turn, one above the other, with the sectors named.

use super::canvas::{
    self, Axis, CHARACTER, Margins, anchored, chart, failed, line, polyline, px, text, tick_text,
    write_at,
};
use super::palette::AXIS;
use crate::report::ReportError;
use crate::report::window::FIRST_DEG;
use maud::PreEscaped;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Height of a signal's step; the signals are 1 apart.
const STEP: f64 = 0.6;

/// A signal: its name, its colour, and its value in sectors S1 to S6.
pub struct Level {
    /// Name beside its line.
    pub name: &'static str,
    /// Colour.
    pub color: RGBColor,
    /// Whether it is 1, per sector.
    pub values: [bool; 6],
}

/// Draws the signals, the first at the top.
pub fn levels(signals: &[Level], description: &str) -> Result<PreEscaped<String>, ReportError> {
    let count = signals.len() as f64;
    let base = |index: usize| count - 1.0 - index as f64;
    canvas::svg((550.0, 190.0), description, |area| {
        let names = |position: &f64| {
            let index = (count - 1.0 - (position - STEP / 2.0)).round().max(0.0) as usize;
            signals
                .get(index)
                .map_or("", |signal| signal.name)
                .to_owned()
        };
        let y = Axis {
            range: -0.2..count,
            ticks: (0..signals.len()).map(|k| base(k) + STEP / 2.0).collect(),
            label: &names,
            title: "0 below, 1 above",
        };
        let margins = Margins {
            top: 22.0,
            // As wide as beside the labels of a signal from -1.0 to 1.0.
            left: 30.0 + 4.0 * CHARACTER,
            ..Margins::fitting(&y)
        };
        let mut chart = chart(
            area,
            margins,
            Axis {
                range: FIRST_DEG..FIRST_DEG + 360.0,
                ticks: (0..=6).map(|k| FIRST_DEG + 60.0 * f64::from(k)).collect(),
                label: &|degrees| tick_text(*degrees, 0),
                title: "electrical angle in degrees",
            },
            y,
        )?;
        let name = anchored(&text(AXIS, 0.95), HPos::Center, VPos::Bottom);
        for sector in 1..=6 {
            let middle = FIRST_DEG + 60.0 * (f64::from(sector) - 0.5);
            write_at(
                &chart,
                &format!("S{sector}"),
                (middle, count),
                (0.0, -3.0),
                &name,
            )?;
        }
        for (index, signal) in signals.iter().enumerate() {
            let points = (0..6).zip(signal.values).flat_map(|(sector, is_high)| {
                let from = FIRST_DEG + 60.0 * f64::from(sector);
                let height = base(index) + if is_high { STEP } else { 0.0 };
                [(from, height), (from + 60.0, height)]
            });
            polyline(&mut chart, points, line(signal.color, 2.0))?;
        }
        let corners = [(FIRST_DEG, count), (FIRST_DEG + 360.0, -0.2)];
        let frame = Rectangle::new(corners, AXIS.stroke_width(px(1.0) as u32));
        chart.plotting_area().draw(&frame).map_err(failed)?;
        Ok(())
    })
}
