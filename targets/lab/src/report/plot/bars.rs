//! Bar charts: groups of harmonics, and histograms of errors.

use super::super::palette::{Color, DEMAND, INK, PHASES};
use super::{Axis, Plot, Series, Shape, Stroke, multiples, tick_text};

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
    /// What stands below each group.
    pub groups: Vec<String>,
    /// The bars that each group has, from left to right.
    pub bars: Vec<Bar>,
    /// The ideal value of each group, marked across it; empty for none.
    pub ideal: Vec<f64>,
}

/// One bar in each group.
#[derive(Debug)]
pub struct Bar {
    /// Its name.
    pub name: String,
    /// Index of the variant that it belongs to, if it belongs to one.
    pub variant: Option<usize>,
    /// Its colour.
    pub color: Color,
    /// Its value in each group; none where it is not defined.
    pub values: Vec<Option<f64>>,
}

/// Groups of bars side by side. Bars are signals with a value in the middle of each group.
pub fn bars(bars: Bars<'_>) -> Plot {
    let groups = bars.groups.into_iter().enumerate();
    let ticks: Vec<_> = groups.map(|(k, name)| (middle(k), name)).collect();
    let end = ticks.len() as f64;
    let x = Axis::ticked(bars.x_title, (0.0, end), ticks);
    let y = Axis::new(bars.y_title, &(0.0..bars.top), 6);
    let mut plot = Plot::new(bars.description, (550.0, 270.0), x, y);
    let width = FILLED / bars.bars.len().max(1) as f64;
    for (place, bar) in bars.bars.into_iter().enumerate() {
        let left = place as f64 * width - FILLED / 2.0;
        let values = bar.values.iter().enumerate();
        let points = values.filter_map(|(k, value)| Some((middle(k), (*value)?)));
        plot.series(Series {
            variant: bar.variant,
            shape: Shape::Bars(left, left + 0.88 * width),
            ..Series::new(bar.name, points.collect(), Stroke::solid(bar.color, 0.0))
        });
    }
    if !bars.ideal.is_empty() {
        let values = bars.ideal.into_iter().enumerate();
        let points = values.map(|(k, value)| (middle(k), value)).collect();
        plot.series(Series {
            shape: Shape::Levels(-0.46, 0.46),
            ..Series::new("ideal", points, Stroke::solid(INK, 1.6))
        });
    }
    plot
}

/// Middle of a group by its place.
fn middle(place: usize) -> f64 {
    place as f64 + 0.5
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
    let ticks = powers.map(|power| (power, power_text(power))).collect();
    let y = Axis {
        is_logarithmic: true,
        ..Axis::ticked("share of errors in %", (floor, 2.0), ticks)
    };
    let mut plot = Plot::new(description, (360.0, 210.0), x, y);
    let width = 2.0 * ends / counts.len().max(1) as f64;
    let seen = counts.iter().enumerate().filter(|(_, count)| **count > 0);
    let points = seen.map(|(place, &count)| (middle(place) * width - ends, percent(count).log10()));
    plot.series(Series {
        shape: Shape::Bars(-width / 2.0, width / 2.0),
        ..Series::new(
            "share in %",
            points.collect(),
            Stroke::solid(PHASES[0], 0.0),
        )
    });
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
