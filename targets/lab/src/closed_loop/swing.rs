//! Swing of a loop from period to period, which distinguishes an unstable loop from a disturbed
//! one.
//!
//! If R and L are near their nominal values, unstable poles of a sampled current loop lie at a
//! quarter to half a turn per period: an unstable loop oscillates with a period of two to four
//! samples. Commutations, speed and load change the signals more slowly, or rarely. The second
//! difference extracts the oscillation, and the median rejects single disturbances.

use super::{PeriodRow, quasi_square};
use serde::Serialize;

/// Medians, over the periods of a record, of the second difference of vectors: four times the
/// amplitude of an oscillation that alternates every period.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Swing {
    /// Of the sampled current, in percent of the quasi-square reference's length.
    pub current_pct: f64,
    /// Of the mean terminal voltage, in percent of the bus voltage.
    pub voltage_pct: f64,
}

impl Swing {
    /// The swing of a record; `current` is the quasi-square reference's amplitude and `v_bus` the
    /// true bus voltage. Zero for records of fewer than three periods.
    pub fn of(periods: &[PeriodRow], current: f64, v_bus: f64) -> Self {
        let (alpha, beta) = quasi_square(0.0, current);
        let length = alpha.hypot(beta);
        let currents = periods.iter().map(|row| crate::plant::clarke(row.currents));
        let voltages = periods
            .iter()
            .map(|row| (row.v_alpha_mean, row.v_beta_mean));
        Self {
            current_pct: 100.0 * median_second_difference(currents) / length,
            voltage_pct: 100.0 * median_second_difference(voltages) / v_bus,
        }
    }

    /// The larger swing of two records, of current and voltage separately.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self {
            current_pct: self.current_pct.max(other.current_pct),
            voltage_pct: self.voltage_pct.max(other.voltage_pct),
        }
    }
}

fn median_second_difference(vectors: impl Iterator<Item = (f64, f64)>) -> f64 {
    let vectors: Vec<(f64, f64)> = vectors.collect();
    let mut differences: Vec<f64> = vectors
        .windows(3)
        .map(|at| (at[2].0 - 2.0 * at[1].0 + at[0].0).hypot(at[2].1 - 2.0 * at[1].1 + at[0].1))
        .collect();
    if differences.is_empty() {
        return 0.0;
    }
    let middle = differences.len() / 2;
    *differences.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Currents that follow a slowly turning vector, jump once a sector, and alternate by a given
    /// amplitude.
    fn record(alternating: f64) -> Vec<PeriodRow> {
        let row = |k: usize| {
            let angle = 0.01 * k as f64 + if k.is_multiple_of(33) { 0.8 } else { 0.0 };
            let length = 10.0 + if k.is_multiple_of(2) { 1.0 } else { -1.0 } * alternating;
            let (alpha, beta) = (length * angle.cos(), length * angle.sin());
            let b = -0.5 * alpha + 0.75_f64.sqrt() * beta;
            PeriodRow {
                currents: [alpha, b, -alpha - b],
                v_alpha_mean: 2.4 * length,
                ..PeriodRow::default()
            }
        };
        (0..400).map(row).collect()
    }

    #[test]
    fn alternation_is_detected_and_slow_or_rare_changes_are_not() {
        let of = |rows: &[PeriodRow]| Swing::of(rows, 10.0 * 0.75_f64.sqrt(), 48.0);
        let calm = of(&record(0.0));
        assert!(
            calm.current_pct < 0.02 && calm.voltage_pct == 0.0,
            "{calm:?}"
        );
        let swinging = of(&record(0.5));
        assert!((swinging.current_pct - 20.0).abs() < 0.1, "{swinging:?}");
        assert!((swinging.voltage_pct - 10.0).abs() < 1e-9, "{swinging:?}");
        assert_eq!(calm.max(swinging), swinging);
        assert_eq!(of(&record(0.5)[..2]).current_pct, 0.0);
    }
}
