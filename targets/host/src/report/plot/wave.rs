//! Signals over one electrical turn, with the sectors named above.

use super::canvas::{
    self, Axis, Margins, anchored, chart, dashed, decimals, failed, line, polyline, px, text,
    tick_text, ticks, write_at,
};
use super::palette::{AXIS, DEMAND, IDEAL};
use crate::report::ReportError;
use crate::report::window::{Columns, FIRST_DEG};
use maud::PreEscaped;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::ops::Range;

/// Signals to draw over the electrical angle.
pub struct Wave<'a> {
    /// What a screen reader says.
    pub description: &'a str,
    /// Name and unit of the vertical axis.
    pub title: &'a str,
    /// Vertical range.
    pub range: Range<f64>,
    /// Each signal with its colour.
    pub signals: Vec<(RGBColor, Columns)>,
    /// Ideal waves, drawn broad below the signals: corners (angle in degrees, value).
    pub ideal: Vec<Vec<(f64, f64)>>,
    /// A demand, drawn dashed across.
    pub demand: Option<f64>,
}

/// Draws the signals: ripple as a pale band, mean over one control period as a line.
pub fn wave(wave: &Wave<'_>) -> Result<PreEscaped<String>, ReportError> {
    canvas::svg((550.0, 250.0), wave.description, |area| {
        let x_ticks: Vec<f64> = (0..=6).map(|k| FIRST_DEG + 60.0 * f64::from(k)).collect();
        let step = canvas::step(&wave.range, 8);
        let digits = decimals(step);
        let y = Axis {
            range: wave.range.clone(),
            ticks: ticks(&wave.range, step),
            label: &|value| tick_text(*value, digits),
            title: wave.title,
        };
        let margins = Margins {
            top: 22.0,
            ..Margins::fitting(&y)
        };
        let mut chart = chart(
            area,
            margins,
            Axis {
                range: FIRST_DEG..FIRST_DEG + 360.0,
                ticks: x_ticks,
                label: &|degrees| tick_text(*degrees, 0),
                title: "electrical angle in degrees",
            },
            y,
        )?;
        let name = anchored(&text(AXIS, 0.95), HPos::Center, VPos::Bottom);
        for sector in 1..=6 {
            let middle = FIRST_DEG + 60.0 * (f64::from(sector) - 0.5);
            let at = (middle, wave.range.end);
            write_at(&chart, &format!("S{sector}"), at, (0.0, -3.0), &name)?;
        }
        for corners in &wave.ideal {
            polyline(&mut chart, corners.iter().copied(), line(IDEAL, 3.0))?;
        }
        if wave.range.start < 0.0 {
            let zero = [(FIRST_DEG, 0.0), (FIRST_DEG + 360.0, 0.0)];
            polyline(&mut chart, zero, line(AXIS, 0.5))?;
        }
        for (color, columns) in &wave.signals {
            let there = columns.angle.iter().zip(&columns.most);
            let back = columns.angle.iter().zip(&columns.least).rev();
            let band: Vec<_> = there.chain(back).map(|(x, y)| (*x, *y)).collect();
            chart
                .plotting_area()
                .draw(&Polygon::new(band, color.mix(0.22)))
                .map_err(failed)?;
        }
        for (color, columns) in &wave.signals {
            let points = columns.angle.iter().zip(&columns.mean);
            polyline(&mut chart, points.map(|(x, y)| (*x, *y)), line(*color, 1.4))?;
        }
        if let Some(demand) = wave.demand {
            let across = [(FIRST_DEG, demand), (FIRST_DEG + 360.0, demand)];
            dashed(&mut chart, across, line(DEMAND, 1.0), (6.0, 4.0))?;
        }
        let corners = [
            (FIRST_DEG, wave.range.end),
            (FIRST_DEG + 360.0, wave.range.start),
        ];
        let frame = Rectangle::new(corners, AXIS.stroke_width(px(1.0) as u32));
        chart.plotting_area().draw(&frame).map_err(failed)?;
        Ok(())
    })
}
