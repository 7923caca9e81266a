//! Swing of a loop's voltage from period to period, which tells an unstable loop from a disturbed one.
//!
//! If R and L are near their nominal values, unstable poles of a sampled current loop lie at a
//! quarter to half a turn per period: an unstable loop oscillates with a period of two to four
//! samples, and grows until the legs bound its voltage. Commutations, speed and load change the voltage more
//! slowly, or rarely. The second difference extracts the oscillation, and the median rejects single
//! disturbances. The current tells less. With a small inductance, sensors out of place make the current of a
//! stable loop swing by a quarter of its amplitude, and its voltage by a few percent of the bus.

use super::PeriodRow;

/// Median, over the periods of a record, of the second difference of the mean terminal voltage, in percent of
/// the true bus voltage: four times the amplitude of an oscillation that alternates every period. Zero for
/// records of fewer than three periods.
pub fn voltage_swing(periods: &[PeriodRow], v_bus: f64) -> f64 {
    let difference = |at: &[PeriodRow]| {
        let of = |of: fn(&PeriodRow) -> f64| of(&at[2]) - 2.0 * of(&at[1]) + of(&at[0]);
        of(|row| row.v_alpha_mean).hypot(of(|row| row.v_beta_mean))
    };
    let mut differences: Vec<f64> = periods.windows(3).map(difference).collect();
    if differences.is_empty() {
        return 0.0;
    }
    let middle = differences.len() / 2;
    let median = *differences.select_nth_unstable_by(middle, f64::total_cmp).1;
    100.0 * median / v_bus
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A voltage that turns slowly, jumps once a sector, and alternates by a given amplitude.
    fn record(alternating: f64) -> Vec<PeriodRow> {
        let row = |k: usize| {
            let angle = 0.01 * k as f64 + if k.is_multiple_of(33) { 0.8 } else { 0.0 };
            let length = 24.0 + if k.is_multiple_of(2) { 1.0 } else { -1.0 } * alternating;
            PeriodRow {
                v_alpha_mean: length * angle.cos(),
                v_beta_mean: length * angle.sin(),
                ..PeriodRow::default()
            }
        };
        (0..400).map(row).collect()
    }

    #[test]
    fn alternation_is_detected_and_slow_or_rare_changes_are_not() {
        let calm = voltage_swing(&record(0.0), 48.0);
        assert!(calm < 0.02, "{calm}");
        let swinging = voltage_swing(&record(1.2), 48.0);
        assert!((swinging - 10.0).abs() < 0.1, "{swinging}");
        assert_eq!(voltage_swing(&record(1.2)[..2], 48.0), 0.0);
    }
}
