//! The EMF's shape over the electrical angle, and the periodic functions derived from it.
//!
//! Convention (`hexagen::conventions`): f_a(0) = 0 and rising, b lags by 120 degrees, unit phase
//! peak.

use std::f64::consts::TAU;

/// A periodic function as parabolas over equal segments of a turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Parabolas {
    /// Per segment the coefficients of 1, t, t^2 with t from -1/2 to 1/2 over the segment.
    pub coefficients: Vec<[f64; 3]>,
    /// Largest distance from the function.
    pub error: f64,
}

impl Parabolas {
    /// Fits with the fewest of 12, 24, 48 or 96 segments whose error is at most `tolerance`, else
    /// 96. Corners of 120-degree trapezoids lie on segment borders, so their integral is fitted
    /// exactly.
    pub fn fit(function: impl Fn(f64) -> f64, tolerance: f64) -> Self {
        let fits = [12, 24, 48].into_iter();
        let mut fits = fits.map(|segments| Self::up_to(tolerance, &function, segments));
        let found = fits.find(|fit| fit.error <= tolerance);
        found.unwrap_or_else(|| Self::with_segments(&function, 96))
    }

    /// Fits with so many segments.
    pub fn with_segments(function: &impl Fn(f64) -> f64, segments: u32) -> Self {
        Self::up_to(f64::INFINITY, function, segments)
    }

    /// Fits with so many segments; ends with the first that is farther off than `tolerance`.
    fn up_to(tolerance: f64, function: &impl Fn(f64) -> f64, segments: u32) -> Self {
        const PROBES: u32 = 16;
        let width = TAU / f64::from(segments);
        let mut error = 0.0_f64;
        let mut coefficients = Vec::with_capacity(segments as usize);
        for segment in 0..segments {
            let middle = (f64::from(segment) + 0.5) * width;
            let [y0, y1, y2] = [-0.5, 0.0, 0.5].map(|t| function(middle + t * width));
            let [c0, c1, c2] = [y1, y2 - y0, 2.0 * (y0 + y2) - 4.0 * y1];
            for probe in 0..=PROBES {
                let t = f64::from(probe) / f64::from(PROBES) - 0.5;
                let fitted = c0 + t * (c1 + t * c2);
                error = error.max((fitted - function(middle + t * width)).abs());
            }
            coefficients.push([c0, c1, c2]);
            if error > tolerance {
                break;
            }
        }
        Self {
            coefficients,
            error,
        }
    }

    /// Steepest slope of any parabola, per segment.
    pub fn steepest(&self) -> f64 {
        let ends = self
            .coefficients
            .iter()
            .flat_map(|[_, c1, c2]| [c1 - c2, c1 + c2]);
        ends.fold(0.0, |most: f64, slope| most.max(slope.abs()))
    }

    /// Largest magnitude of any coefficient.
    pub fn magnitude(&self) -> f64 {
        self.coefficients
            .iter()
            .flatten()
            .fold(0.0, |most: f64, c| most.max(c.abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{EmfShape, zero_sum_integral};

    #[test]
    fn the_flux_of_a_trapezoid_is_exact_in_twelve_parabolas() {
        let shape = EmfShape::Trapezoidal {
            flat_top_deg: 120.0,
        };
        let fit = Parabolas::fit(|theta| zero_sum_integral(shape, theta), 1e-9);
        assert_eq!(fit.coefficients.len(), 12);
        assert!(fit.error < 1e-12);
    }
}
