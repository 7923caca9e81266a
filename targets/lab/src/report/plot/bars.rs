//! Bar charts: groups of harmonics, and histograms of errors.

use super::super::palette::{AXIS, Color, DEMAND, INK, PHASES};
use super::{Axis, Plot, Stroke, multiples, tick_text};

/// Share of a group's width that its bars fill.
const FILLED: f64 = 0.8;

/// Groups of bars.
#[derive(Debug)]
pub struct Bars<'a> {
    /// Description for screen readers.
    pub description: String,
    /// Name of the horizontal axis.
    pub x_title: &'a str,
    /// Name and unit of the vertical axis.
    pub y_title: &'a str,
    /// Greatest value of the vertical axis; positive.
    pub top: f64,
    /// Colour of each bar in a group.
    pub colors: Vec<Color>,
    /// The groups: text below, a value per bar, and the ideal value, marked across.
    pub groups: Vec<(String, Vec<Option<f64>>, Option<f64>)>,
}

/// Groups of bars side by side. A bar taller than the plot ends at its edge with its value above.
pub fn bars(bars: Bars<'_>) -> Plot {
    let top = bars.top;
    let names = bars.groups.iter().enumerate();
    let x = Axis {
        title: bars.x_title.to_owned(),
        range: (0.0, bars.groups.len() as f64),
        ticks: names
            .map(|(k, (name, ..))| (k as f64 + 0.5, name.clone()))
            .collect(),
    };
    let y = Axis::new(bars.y_title, &(0.0..top), 6);
    let mut plot = Plot::new(bars.description, (550.0, 270.0), x, y);
    let width = FILLED / bars.colors.len().max(1) as f64;
    for (k, (_, values, ideal)) in bars.groups.into_iter().enumerate() {
        let start = k as f64 + (1.0 - FILLED) / 2.0;
        for (bar, (value, color)) in values.into_iter().zip(&bars.colors).enumerate() {
            let Some(value) = value else {
                continue;
            };
            let left = start + bar as f64 * width;
            plot.block(
                (left, 0.0),
                (left + 0.88 * width, value.min(top)),
                (*color, 1.0),
            );
            if value > top {
                let at = (left + 0.44 * width, top);
                plot.write_above(tick_text(value, 0), at, (AXIS, 0.8));
            }
        }
        if let Some(ideal) = ideal {
            let (from, to) = (k as f64 + 0.04, k as f64 + 0.96);
            plot.line([(from, ideal), (to, ideal)], Stroke::solid(INK, 1.6));
        }
    }
    plot
}

/// Margin of a histogram beyond the bound on either side, relative to the bound.
const BEYOND: f64 = 0.12;

/// Powers of ten with their SI prefixes.
const PREFIXES: [(f64, &str); 4] = [(1.0, ""), (1e-3, "m"), (1e-6, "\u{b5}"), (1e-9, "n")];

/// Histogram of errors in volts over the range from the negative to the positive bound, on a
/// logarithmic scale, so that rare errors are visible.
pub fn histogram(description: String, bound: f64, counts: &[u64]) -> Plot {
    let total: u64 = counts.iter().sum();
    let percent = |count: u64| 100.0 * count as f64 / total.max(1) as f64;
    // Down to half the share of a single error.
    let floor = percent(1).log10() - 0.3;
    let of_prefix = |&&(power, _): &&(f64, &str)| bound >= power;
    let &(power, prefix) = PREFIXES.iter().find(of_prefix).unwrap_or(&PREFIXES[3]);
    let ends = bound / power;
    let beyond = (1.0 + BEYOND) * ends;
    let x = Axis::new(format!("error in {prefix}V"), &(-beyond..beyond), 7);
    let powers = multiples(&(floor..2.0), 1.0).into_iter();
    let y = Axis {
        title: "share of errors in %".to_owned(),
        range: (floor, 2.0),
        ticks: powers.map(|power| (power, power_text(power))).collect(),
    };
    let mut plot = Plot::new(description, (360.0, 210.0), x, y);
    let width = 2.0 * ends / counts.len().max(1) as f64;
    for (place, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let left = place as f64 * width - ends;
        let height = percent(count).log10();
        plot.block((left, floor), (left + width, height), (PHASES[0], 1.0));
    }
    for (edge, name) in [(-ends, "\u{2212}bound"), (ends, "bound")] {
        plot.line([(edge, floor), (edge, 2.0)], Stroke::solid(PHASES[2], 1.6));
        plot.write_above(name, (edge, 2.0), (DEMAND, 0.85));
    }
    plot
}

/// A power of ten as plain text: "100", "0.01".
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
