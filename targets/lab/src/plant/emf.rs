//! The EMF's shape as a Taylor series in time, and the times of its corners.

use super::segment::{Series, TERMS};
use super::{EmfShape, floor, wrap};
use std::f64::consts::{PI, TAU};

/// Angle ahead of the present one at which the shape is evaluated, so that a corner just reached
/// counts as passed in spite of rounding.
const AHEAD: f64 = 1e-9;

/// Electrical angle by which phases a, b, c lag phase a.
pub(super) const LAG: [f64; 3] = [0.0, TAU / 3.0, 2.0 * TAU / 3.0];

/// Half the width of a trapezoid's ramp in radians.
fn half_ramp(flat_top_deg: f64) -> f64 {
    (180.0 - flat_top_deg).to_radians() / 2.0
}

/// Shape value (-1 to 1) at an electrical angle of the phase itself.
pub(super) fn value(shape: EmfShape, angle: f64) -> f64 {
    match shape {
        EmfShape::Sinusoidal => angle.sin(),
        EmfShape::Trapezoidal { flat_top_deg } => {
            let from_zero = wrap(angle + PI / 2.0) - PI / 2.0;
            let folded = if from_zero > PI / 2.0 {
                PI - from_zero
            } else {
                from_zero
            };
            (folded / half_ramp(flat_top_deg)).clamp(-1.0, 1.0)
        }
        EmfShape::Harmonics { sines, cosines } => {
            let mut sum = 0.0;
            for (place, (s, c)) in sines.into_iter().zip(cosines).enumerate() {
                let (sin, cos) = ((2 * place + 1) as f64 * angle).sin_cos();
                sum += s * sin + c * cos;
            }
            sum
        }
    }
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

/// Taylor coefficients in time of one phase's shape times `k`, valid up to the next corner, with
/// `phase_angle` the angle of the phase itself. Returns the number of coefficients that may be
/// non-zero, at most `terms`.
pub(super) fn series(
    shape: EmfShape,
    k: f64,
    phase_angle: f64,
    omega_e: f64,
    terms: usize,
    out: &mut Series,
) -> usize {
    debug_assert!(terms <= TERMS);
    match shape {
        EmfShape::Sinusoidal => {
            out[..terms].fill(0.0);
            add_wave([k, 0.0], phase_angle, omega_e, &mut out[..terms]);
            terms
        }
        EmfShape::Harmonics { sines, cosines } => {
            out[..terms].fill(0.0);
            for (place, (s, c)) in sines.into_iter().zip(cosines).enumerate() {
                let order = (2 * place + 1) as f64;
                let wave = [k * s, k * c];
                add_wave(
                    wave,
                    order * phase_angle,
                    order * omega_e,
                    &mut out[..terms],
                );
            }
            terms
        }
        EmfShape::Trapezoidal { flat_top_deg } => {
            let half = half_ramp(flat_top_deg);
            let ahead = AHEAD.copysign(omega_e);
            let from_zero = wrap(phase_angle + ahead + PI / 2.0) - PI / 2.0;
            let (level, slope) = if from_zero < -half {
                (-1.0, 0.0)
            } else if from_zero < half {
                ((from_zero - ahead) / half, 1.0 / half)
            } else if from_zero <= PI - half {
                (1.0, 0.0)
            } else if from_zero < PI + half {
                ((PI - from_zero + ahead) / half, -1.0 / half)
            } else {
                (-1.0, 0.0)
            };
            out[..terms].fill(0.0);
            out[0] = k * level;
            out[1] = k * slope * omega_e;
            2
        }
    }
}

/// Adds the Taylor coefficients in time of s sin + c cos at an angle that grows by `omega`.
fn add_wave([s, c]: [f64; 2], angle: f64, omega: f64, out: &mut [f64]) {
    if s == 0.0 && c == 0.0 {
        return;
    }
    let (sin, cos) = angle.sin_cos();
    let (value, slope) = (s * sin + c * cos, s * cos - c * sin);
    let cycle = [value, slope, -value, -slope];
    let mut scale = 1.0;
    for (n, coefficient) in out.iter_mut().enumerate() {
        *coefficient += scale * cycle[n % 4];
        scale *= omega / (n + 1) as f64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
                (value(shape, f64::to_radians(degrees)) - expected).abs() < 1e-12,
                "{degrees}"
            );
        }
    }

    #[test]
    fn series_follows_the_shape_between_corners_in_both_directions() {
        for shape in SHAPES {
            for omega_e in [800.0, -800.0] {
                for step in 0..3600 {
                    let theta = step as f64 * 0.1_f64.to_radians();
                    let ahead = 0.2 / shape.highest_order().max(1) as f64;
                    let angle = angle_to_corner(shape, theta, omega_e).min(ahead);
                    for lag in LAG {
                        let mut out = [0.0; TERMS];
                        series(shape, 2.0, theta - lag, omega_e, TERMS, &mut out);
                        let t = angle * 0.999 / omega_e.abs();
                        let got = out.iter().rev().fold(0.0, |sum, c| sum * t + c);
                        let want = 2.0 * value(shape, theta - lag + omega_e * t);
                        assert!(
                            (got - want).abs() < 1e-7,
                            "{shape:?} {omega_e} {step}: {got} {want}"
                        );
                    }
                }
            }
        }
    }
}
