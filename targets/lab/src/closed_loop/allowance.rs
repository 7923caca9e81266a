//! Tolerances for comparing figures of merit.

/// Relative tolerance.
pub const RELATIVE: f64 = 0.005;

/// Tolerance of percentages, in points, whatever their ratio.
pub const POINTS: f64 = 0.05;

/// Difference of a figure of merit from its expected value, relative to the tolerance. Two
/// undefined figures (percent of a zero torque) are equal; one undefined figure is infinitely far
/// off.
pub fn share_of_allowance(found: Option<f64>, expected: Option<f64>, is_percentage: bool) -> f64 {
    let (found, expected) = match (found, expected) {
        (None, None) => return 0.0,
        (Some(found), Some(expected)) => (found, expected),
        _ => return f64::INFINITY,
    };
    let distance = (found - expected).abs();
    if distance == 0.0 {
        return 0.0;
    }
    if !distance.is_finite() {
        return f64::INFINITY;
    }
    let relative = distance / (RELATIVE * expected.abs());
    if is_percentage {
        relative.min(distance / POINTS)
    } else {
        relative
    }
}

#[cfg(test)]
mod tests {
    use super::share_of_allowance;

    #[test]
    fn percentages_have_an_absolute_tolerance_too() {
        for (found, expected, is_percentage, share) in [
            (Some(100.5), Some(100.0), false, 1.0),
            (Some(0.1), Some(0.05), true, 1.0),
            (Some(0.1), Some(0.05), false, 200.0),
            (Some(40.1), Some(40.0), true, 0.5),
            (Some(0.0), Some(0.0), false, 0.0),
            (None, None, true, 0.0),
            (None, Some(1.0), true, f64::INFINITY),
            (Some(1.0), None, true, f64::INFINITY),
            (Some(1.0), Some(0.0), false, f64::INFINITY),
        ] {
            let got = share_of_allowance(found, expected, is_percentage);
            assert!(
                got == share || (got - share).abs() < 1e-9,
                "{found:?}, {expected:?}: {got}"
            );
        }
    }
}
