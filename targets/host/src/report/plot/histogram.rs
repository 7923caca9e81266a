//! How often errors of which size were seen, against the bound that is proven of them.

use super::canvas::{
    self, Axis, Margins, anchored, chart, decimals, failed, line, polyline, text, tick_text, ticks,
    write_at,
};
use super::palette::{DEMAND, PHASES};
use crate::report::ReportError;
use maud::PreEscaped;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Room beyond the bound at either side, in parts of it.
const BEYOND: f64 = 0.12;

/// Powers of ten by which engineers write small numbers, and what they put before the unit.
const PREFIXES: [(f64, &str); 4] = [(1.0, ""), (1e-3, "m"), (1e-6, "\u{b5}"), (1e-9, "n")];

/// Errors and their bound.
pub struct Histogram<'a> {
    /// What a screen reader says.
    pub description: &'a str,
    /// Unit of errors and bound.
    pub unit: &'a str,
    /// The proven bound, positive.
    pub bound: f64,
    /// How many errors lie in each of equal parts of the range from the negative to the positive bound.
    pub counts: &'a [u64],
}

/// Draws the share of each part on a scale of powers of ten, so that rare errors show, too.
pub fn histogram(histogram: &Histogram<'_>) -> Result<PreEscaped<String>, ReportError> {
    let total: u64 = histogram.counts.iter().sum();
    let percent = |count: u64| 100.0 * count as f64 / total.max(1) as f64;
    // Down to half of what a single error makes.
    let floor = percent(1).log10() - 0.3;
    let y_range = floor..2.0;
    let bound = histogram.bound;
    let of_prefix = |&&(power, _): &&(f64, &str)| bound >= power;
    let &(power, prefix) = PREFIXES.iter().find(of_prefix).unwrap_or(&PREFIXES[3]);
    let ends = bound / power;
    let x_range = -(1.0 + BEYOND) * ends..(1.0 + BEYOND) * ends;
    canvas::svg((360.0, 210.0), histogram.description, |area| {
        let x_step = canvas::step(&x_range, 7);
        let x_digits = decimals(x_step);
        let y = Axis {
            range: y_range.clone(),
            ticks: ticks(&y_range, 1.0),
            label: &|power| power_text(*power),
            title: "share of errors in %",
        };
        let margins = Margins {
            top: 20.0,
            ..Margins::fitting(&y)
        };
        let mut chart = chart(
            area,
            margins,
            Axis {
                range: x_range.clone(),
                ticks: ticks(&x_range, x_step),
                label: &|error| tick_text(*error, x_digits),
                title: &format!("error in {prefix}{}", histogram.unit),
            },
            y,
        )?;
        let width = 2.0 * ends / histogram.counts.len().max(1) as f64;
        for (place, &count) in histogram.counts.iter().enumerate() {
            if count == 0 {
                continue;
            }
            let left = place as f64 * width - ends;
            let corners = [(left, percent(count).log10()), (left + width, floor)];
            let bar = Rectangle::new(corners, PHASES[0].filled());
            chart.plotting_area().draw(&bar).map_err(failed)?;
        }
        let above = anchored(&text(DEMAND, 0.85), HPos::Center, VPos::Bottom);
        for (edge, name) in [(-ends, "\u{2212}bound"), (ends, "bound")] {
            polyline(
                &mut chart,
                [(edge, floor), (edge, 2.0)],
                line(PHASES[2], 1.6),
            )?;
            write_at(&chart, name, (edge, 2.0), (0.0, -3.0), &above)?;
        }
        Ok(())
    })
}

/// Ten to a whole power, in words that fit beside an axis: "100", "0.01".
fn power_text(power: f64) -> String {
    tick_text(10.0_f64.powf(power), (-power).max(0.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::power_text;

    #[test]
    fn powers_of_ten_are_written_out() {
        for (power, text) in [(2.0, "100"), (0.0, "1"), (-1.0, "0.1"), (-3.0, "0.001")] {
            assert_eq!(power_text(power), text);
        }
    }
}
