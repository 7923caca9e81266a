//! Distance of a current from the ideal hexagon's outline.

use crate::closed_loop::Trace;
use crate::closed_loop::hexagon;

/// RMS distance in amperes of a record's current, as a moving mean over one control period, from
/// the outline of the hexagon between the quasi-square reference's corners of amplitude `current`.
pub fn distance_rms(trace: &Trace, current: f64) -> f64 {
    let corners = hexagon(current);
    let period = trace.bins_per_period;
    let bins = trace.theta_e.len();
    if period == 0 || bins < period {
        return f64::NAN;
    }
    let mut sum = (0.0, 0.0);
    let mut squares = 0.0;
    for k in 0..bins {
        let (alpha, beta) = trace.i_alpha_beta(k);
        sum = (sum.0 + alpha, sum.1 + beta);
        if k + 1 < period {
            continue;
        }
        let mean = (sum.0 / period as f64, sum.1 / period as f64);
        squares += distance(mean, &corners).powi(2);
        let (alpha, beta) = trace.i_alpha_beta(k + 1 - period);
        sum = (sum.0 - alpha, sum.1 - beta);
    }
    (squares / (bins + 1 - period) as f64).sqrt()
}

/// Distance of a point from a polygon's outline; its corners with the first repeated at the end.
fn distance((x, y): (f64, f64), corners: &[(f64, f64)]) -> f64 {
    let edges = corners.windows(2).map(|edge| {
        let ((x0, y0), (x1, y1)) = (edge[0], edge[1]);
        let (dx, dy) = (x1 - x0, y1 - y0);
        let length = (dx * dx + dy * dy).max(f64::MIN_POSITIVE);
        let along = (((x - x0) * dx + (y - y0) * dy) / length).clamp(0.0, 1.0);
        (x - x0 - along * dx).hypot(y - y0 - along * dy)
    });
    edges.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_is_to_the_nearest_edge_or_corner() {
        // Corners at the radius of sqrt(3) 2/sqrt(3) = 2; edges at sqrt(3) from the centre.
        let corners = hexagon(3.0_f64.sqrt());
        let root = 3.0_f64.sqrt();
        for (point, want) in [
            ((0.0, 0.0), root),
            ((0.0, -2.0), 0.0),
            ((0.0, -3.0), 1.0),
            ((root, 0.0), 0.0),
            ((root + 0.25, 0.5), 0.25),
        ] {
            let got = distance(point, &corners);
            assert!((got - want).abs() < 1e-12, "{point:?}: {got}");
        }
    }
}
