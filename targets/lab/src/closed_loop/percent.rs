//! Percentages of measured values, and when they are undefined.
//!
//! A torque or current below the resolution of the drive's ADCs is no reference: its ripple and
//! harmonics exceed it whatever the controller does.

/// A part in percent of the magnitude of a whole. `None` if that is not above `floor`
/// ([`super::Trace::current_floor`], [`super::Trace::torque_floor`]) in the same unit, or if either
/// is not finite.
pub fn percent(part: f64, whole: f64, floor: f64) -> Option<f64> {
    let percent = 100.0 * part / whole.abs();
    (whole.abs() > floor && percent.is_finite()).then_some(percent)
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn a_whole_below_the_floor_has_no_percentages() {
        assert_eq!(percent(0.5, -2.0, 0.1), Some(25.0));
        for (part, whole, floor) in [
            (1.0, 0.0, 0.0),
            (0.0, 0.0, 0.0),
            (1.0, 0.1, 0.1),
            (1.0, 1e-18, 1e-3),
            (1.0, f64::NAN, 0.0),
            (f64::NAN, 1.0, 0.0),
            (1.0, 1e-310, 0.0),
        ] {
            assert_eq!(percent(part, whole, floor), None, "{part} {whole} {floor}");
        }
    }
}
