//! The EMF's shape as a Taylor series in time, and the times of its corners.

use super::segment::{PER_ORDER, Series, TERMS};
use super::{EmfShape, floor, wrap};
use std::f64::consts::{PI, TAU};

/// Angle ahead of the present one at which the shape is evaluated, so that a corner just reached
/// counts as passed in spite of rounding.
const AHEAD: f64 = 1e-9;

/// Electrical angle by which phases a, b, c lag phase a.
const LAG: [f64; 3] = [0.0, TAU / 3.0, 2.0 * TAU / 3.0];

/// Cosine and sine of those angles.
const TURNS: [[f64; 2]; 3] = [[1.0, 0.0], [-0.5, HALF_ROOT], [-0.5, -HALF_ROOT]];

/// sqrt(3)/2.
const HALF_ROOT: f64 = 0.866_025_403_784_438_6;

/// A wave of the shape: its order, and the factors of sine and cosine.
type Wave = (usize, [f64; 2]);

/// Shape values (-1 to 1) of the phases. `windings` are the places of their windings, 0 to 2 for those of a, b and c.
pub(super) fn values(shape: EmfShape, theta_e: f64, windings: [usize; 3]) -> [f64; 3] {
    if let EmfShape::Trapezoidal { flat_top_deg } = shape {
        return windings.map(|winding| trapezoid(flat_top_deg, theta_e - LAG[winding]));
    }
    let mut sums = [0.0; 3];
    for (order, factors) in waves(&shape) {
        let at = (order as f64 * theta_e).sin_cos();
        for (sum, winding) in sums.iter_mut().zip(windings) {
            *sum += wave(factors, at, order * winding)[0];
        }
    }
    sums
}

/// The waves of a smooth shape.
fn waves(shape: &EmfShape) -> impl Iterator<Item = Wave> {
    let (sines, cosines): (&[f64], &[f64]) = match shape {
        EmfShape::Harmonics { sines, cosines } => (sines, cosines),
        EmfShape::Sinusoidal => (&[1.0], &[0.0]),
        EmfShape::Trapezoidal { .. } => (&[], &[]),
    };
    let factors = sines.iter().zip(cosines).enumerate();
    factors
        .map(|(place, (&s, &c))| (2 * place + 1, [s, c]))
        .filter(|(_, factors)| *factors != [0.0; 2])
}

/// Value and slope of s sin + c cos at an angle of the given sine and cosine, less `thirds` thirds of a turn.
fn wave([s, c]: [f64; 2], (sin, cos): (f64, f64), thirds: usize) -> [f64; 2] {
    let [turn_cos, turn_sin] = TURNS[thirds % 3];
    let (sin, cos) = (
        sin * turn_cos - cos * turn_sin,
        cos * turn_cos + sin * turn_sin,
    );
    [s * sin + c * cos, s * cos - c * sin]
}

/// Half the width of a trapezoid's ramp in radians.
fn half_ramp(flat_top_deg: f64) -> f64 {
    (180.0 - flat_top_deg).to_radians() / 2.0
}

/// Value of a trapezoid (-1 to 1) at an electrical angle of the phase itself.
fn trapezoid(flat_top_deg: f64, angle: f64) -> f64 {
    let from_zero = wrap(angle + PI / 2.0) - PI / 2.0;
    let folded = if from_zero > PI / 2.0 {
        PI - from_zero
    } else {
        from_zero
    };
    (folded / half_ramp(flat_top_deg)).clamp(-1.0, 1.0)
}

/// Electrical angle from `theta_e` to the next corner of any phase in the direction of
/// `omega_e`; infinite for smooth shapes or at standstill.
pub(super) fn angle_to_corner(shape: EmfShape, theta_e: f64, omega_e: f64) -> f64 {
    let EmfShape::Trapezoidal { flat_top_deg } = shape else {
        return f64::INFINITY;
    };
    if omega_e == 0.0 {
        return f64::INFINITY;
    }
    let half = half_ramp(flat_top_deg);
    // All corners of the three phases: +-half modulo 60 degrees, as 180 and 120 are multiples.
    let pitch = PI / 3.0;
    let forward = |angle: f64| {
        let turns = (angle - AHEAD) / pitch;
        AHEAD + (turns - floor(turns)) * pitch
    };
    if omega_e > 0.0 {
        forward(half - theta_e).min(forward(-half - theta_e))
    } else {
        forward(theta_e - half).min(forward(theta_e + half))
    }
}

/// Taylor coefficients in time of the phases' shapes times `k`, valid up to the next corner. `windings` are the
/// places of the phases' windings, 0 to 2 for those of a, b and c. Returns the number of coefficients that may
/// be non-zero, at most `terms`.
pub(super) fn series(
    shape: EmfShape,
    k: [f64; 3],
    windings: [usize; 3],
    [theta_e, omega_e]: [f64; 2],
    terms: usize,
    out: &mut [Series; 3],
) -> usize {
    debug_assert!(terms <= TERMS);
    for series in out.iter_mut() {
        series[..terms].fill(0.0);
    }
    if let EmfShape::Trapezoidal { flat_top_deg } = shape {
        for ((series, k), winding) in out.iter_mut().zip(k).zip(windings) {
            let [level, slope] = trapezoid_ahead(flat_top_deg, theta_e - LAG[winding], omega_e);
            (series[0], series[1]) = (k * level, k * slope * omega_e);
        }
        return 2;
    }
    for (order, factors) in waves(&shape) {
        let at = (order as f64 * theta_e).sin_cos();
        let cycles: [[f64; 4]; 3] = std::array::from_fn(|x| {
            let [value, slope] = wave(factors, at, order * windings[x]).map(|part| k[x] * part);
            [value, slope, -value, -slope]
        });
        let mut scale = 1.0;
        for n in 0..terms {
            for (series, cycle) in out.iter_mut().zip(&cycles) {
                series[n] += scale * cycle[n % 4];
            }
            scale *= order as f64 * omega_e * PER_ORDER[n];
        }
    }
    terms
}

/// Level and slope (per radian) of a trapezoid just ahead of an angle of the phase itself.
fn trapezoid_ahead(flat_top_deg: f64, phase_angle: f64, omega_e: f64) -> [f64; 2] {
    let half = half_ramp(flat_top_deg);
    let ahead = AHEAD.copysign(omega_e);
    let from_zero = wrap(phase_angle + ahead + PI / 2.0) - PI / 2.0;
    if from_zero < -half {
        [-1.0, 0.0]
    } else if from_zero < half {
        [(from_zero - ahead) / half, 1.0 / half]
    } else if from_zero <= PI - half {
        [1.0, 0.0]
    } else if from_zero < PI + half {
        [(PI - from_zero + ahead) / half, -1.0 / half]
    } else {
        [-1.0, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACES: [usize; 3] = [0, 1, 2];

    const SHAPES: [EmfShape; 5] = [
        EmfShape::Harmonics {
            sines: [
                1.1, 0.1, 0.05, -0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
            ],
            cosines: [0.0, 0.02, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        },
        EmfShape::Trapezoidal {
            flat_top_deg: 120.0,
        },
        EmfShape::Trapezoidal {
            flat_top_deg: 100.0,
        },
        EmfShape::Trapezoidal { flat_top_deg: 0.0 },
        EmfShape::Sinusoidal,
    ];

    #[test]
    fn trapezoid_has_the_published_corners() {
        let shape = SHAPES[1];
        for (degrees, expected) in [
            (0.0, 0.0),
            (15.0, 0.5),
            (30.0, 1.0),
            (150.0, 1.0),
            (180.0, 0.0),
            (270.0, -1.0),
            (345.0, -0.5),
        ] {
            assert!(
                (values(shape, f64::to_radians(degrees), PLACES)[0] - expected).abs() < 1e-12,
                "{degrees}"
            );
        }
    }

    /// Phase x is phase a, later by a third of a turn for each place of its winding.
    #[test]
    fn windings_lie_a_third_of_a_turn_apart() {
        for shape in SHAPES {
            for step in 0..360 {
                let theta = f64::from(step).to_radians();
                for windings in [PLACES, [2, 0, 1], [1, 0, 2]] {
                    let found = values(shape, theta, windings);
                    for (value, winding) in found.into_iter().zip(windings) {
                        let [alone, ..] = values(shape, theta - LAG[winding], PLACES);
                        assert!((value - alone).abs() < 1e-14, "{shape:?} {step} {winding}");
                    }
                }
            }
        }
    }

    #[test]
    fn series_follows_the_shape_between_corners_in_both_directions() {
        const K: [f64; 3] = [2.0, 3.0, 5.0];
        for (shape, windings) in SHAPES
            .into_iter()
            .zip([PLACES, [1, 0, 2], [2, 0, 1]].into_iter().cycle())
        {
            for omega_e in [800.0, -800.0] {
                for step in 0..3600 {
                    let theta = step as f64 * 0.1_f64.to_radians();
                    let ahead = 0.2 / shape.highest_order().max(1) as f64;
                    let angle = angle_to_corner(shape, theta, omega_e).min(ahead);
                    let mut out = [[0.0; TERMS]; 3];
                    let rotor = [theta, omega_e];
                    series(shape, K, windings, rotor, TERMS, &mut out);
                    let t = angle * 0.999 / omega_e.abs();
                    let values = values(shape, theta + omega_e * t, windings);
                    for ((series, value), k) in out.iter().zip(values).zip(K) {
                        let got = series.iter().rev().fold(0.0, |sum, c| sum * t + c);
                        assert!(
                            (got - k * value).abs() < 1e-7,
                            "{shape:?} {omega_e} {step}: {got} {value}"
                        );
                    }
                }
            }
        }
    }
}
