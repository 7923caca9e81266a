//! The unit EMF of phase a over the electrical angle, its zero-sum part, and their integrals.
//!
//! Phase a rises through zero at angle 0; b lags by a third of a turn (`hexagen::conventions`).

use crate::Error;
use crate::spec::{EmfShapeKind, Motor};
use nalgebra::Vector2;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A third of a turn, radians.
pub const THIRD: f64 = TAU / 3.0;

/// Shape of a phase's EMF with unit peak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EmfShape {
    /// Linear ramps of the given half width (radians) through zero, and flat tops.
    Trapezoidal {
        /// From the zero crossing to the flat top, radians.
        ramp: f64,
    },
    /// A sine.
    Sinusoidal,
    /// A Fourier series of orders 1, 3, ... 23: per order the amplitude of its sine, and of its cosine.
    Harmonics {
        /// Of sin(n theta).
        sines: [f64; 12],
        /// Of cos(n theta).
        cosines: [f64; 12],
    },
}

impl EmfShape {
    /// The motor's shape.
    ///
    /// # Errors
    /// When a trapezoid's flat top is missing or not within 0 to 180 degrees, or coefficients of a
    /// series are missing or its greatest value is not 1.
    pub fn new(motor: &Motor) -> Result<Self, Error> {
        match (motor.emf_shape, motor.flat_top_deg) {
            (EmfShapeKind::Sinusoidal, _) => Ok(Self::Sinusoidal),
            (EmfShapeKind::Trapezoidal, None) => Err(Error::Missing {
                field: "motor.flat_top_deg",
                reason: "the EMF is trapezoidal",
            }),
            (EmfShapeKind::Trapezoidal, Some(flat)) if (0.0..180.0).contains(&flat) => {
                Ok(Self::Trapezoidal {
                    ramp: (90.0 - flat / 2.0).to_radians(),
                })
            }
            (EmfShapeKind::Trapezoidal, Some(flat)) => Err(Error::Field {
                field: "motor.flat_top_deg",
                value: flat.to_string(),
                expected: "expected 0 to less than 180 degrees",
            }),
            (EmfShapeKind::Harmonics, _) => Self::series(motor),
        }
    }

    fn series(motor: &Motor) -> Result<Self, Error> {
        let reason = "the EMF is a series of harmonics";
        let coefficients =
            |field, list: Option<[f64; 12]>| list.ok_or(Error::Missing { field, reason });
        let shape = Self::Harmonics {
            sines: coefficients("motor.emf_sines", motor.emf_sines)?,
            cosines: coefficients("motor.emf_cosines", motor.emf_cosines)?,
        };
        let angles = (0..720).map(|step| f64::from(step) * PI / 720.0);
        let peak = angles.fold(0.0, |most: f64, theta| most.max(shape.unit(theta).abs()));
        if (peak - 1.0).abs() < 1e-3 {
            Ok(shape)
        } else {
            Err(Error::Field {
                field: "motor.emf_sines",
                value: peak.to_string(),
                expected: "expected a series with a greatest value of 1",
            })
        }
    }

    /// Whether an estimate of such an EMF is turned from period to period (else its off phase ramps).
    pub fn turns(self) -> bool {
        !matches!(self, Self::Trapezoidal { .. })
    }

    /// The shape in the mirror: -f(-theta), which a rotor shows that turns backward.
    #[must_use]
    pub fn mirrored(self) -> Self {
        match self {
            Self::Harmonics { sines, cosines } => Self::Harmonics {
                sines,
                cosines: cosines.map(|cosine| -cosine),
            },
            symmetrical => symmetrical,
        }
    }

    /// Unit EMF of phase a at `theta` radians.
    pub fn unit(self, theta: f64) -> f64 {
        let theta = wrap_pi(theta);
        match self {
            Self::Sinusoidal => theta.sin(),
            Self::Trapezoidal { ramp } => {
                let x = theta.abs();
                ((PI - x).min(x) / ramp).min(1.0).copysign(theta)
            }
            Self::Harmonics { sines, cosines } => orders(sines, cosines, |n, s, c| {
                s * (n * theta).sin() + c * (n * theta).cos()
            }),
        }
    }

    /// Antiderivative of [`Self::unit`] with zero mean, radians.
    pub fn integral(self, theta: f64) -> f64 {
        let x = wrap_pi(theta).abs();
        match self {
            Self::Harmonics { sines, cosines } => orders(sines, cosines, |n, s, c| {
                (c * (n * theta).sin() - s * (n * theta).cos()) / n
            }),
            Self::Sinusoidal => -x.cos(),
            // Odd about a quarter turn.
            Self::Trapezoidal { .. } if x > FRAC_PI_2 => -self.integral(PI - x),
            Self::Trapezoidal { ramp } if x >= ramp => x - FRAC_PI_2,
            Self::Trapezoidal { ramp } => ramp - FRAC_PI_2 - (ramp * ramp - x * x) / (2.0 * ramp),
        }
    }

    /// Unit EMF of phase a minus the mean of the three phases: the part that drives current in a
    /// star without neutral.
    pub fn zero_sum(self, theta: f64) -> f64 {
        let [a, b, c] = [theta, theta - THIRD, theta + THIRD].map(|theta| self.unit(theta));
        a - (a + b + c) / 3.0
    }

    /// Antiderivative of [`Self::zero_sum`] with zero mean, radians.
    pub fn zero_sum_integral(self, theta: f64) -> f64 {
        let [a, b, c] = [theta, theta - THIRD, theta + THIRD].map(|theta| self.integral(theta));
        a - (a + b + c) / 3.0
    }

    /// |f|^2 at the 600 angles 0, 0.1, ..., 59.9 degrees, f = [`Self::alpha_beta`].
    pub fn squared_lengths(self) -> impl Iterator<Item = f64> {
        (0..600)
            .map(|step| f64::from(step).to_radians() / 10.0)
            .map(move |theta| self.alpha_beta(theta).norm_squared())
    }

    /// Mean of 1/|f|^2 over [`Self::squared_lengths`].
    pub fn mean_inverse_square(self) -> f64 {
        self.squared_lengths().map(f64::recip).sum::<f64>() / 600.0
    }

    /// Part by which the EMF is longer than along the current parallel to it, at `theta` radians: |f|^2 times `mean`, the
    /// mean of 1/|f|^2, less 1.
    pub fn stretch(self, mean: f64, theta: f64) -> f64 {
        self.alpha_beta(theta).norm_squared() * mean - 1.0
    }

    /// Amplitude-invariant Clarke transform of the three unit EMFs at `theta` radians.
    pub fn alpha_beta(self, theta: f64) -> Vector2<f64> {
        let (a, b) = (self.zero_sum(theta), self.zero_sum(theta - THIRD));
        Vector2::new(a, (a + 2.0 * b) / 3f64.sqrt())
    }
}

/// The sum over the odd orders of a term of the order and its coefficients.
fn orders(sines: [f64; 12], cosines: [f64; 12], term: impl Fn(f64, f64, f64) -> f64) -> f64 {
    let coefficients = sines.into_iter().zip(cosines);
    let terms = (0..).zip(coefficients);
    terms
        .map(|(k, (s, c))| term(f64::from(2 * k + 1), s, c))
        .sum()
}

/// `theta` within half a turn of zero.
fn wrap_pi(theta: f64) -> f64 {
    theta - TAU * (theta / TAU).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [EmfShape; 5] = [
        EmfShape::Harmonics {
            sines: [
                0.9, 0.1, 0.05, -0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.01,
            ],
            cosines: [0.0, 0.02, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        },
        EmfShape::Sinusoidal,
        EmfShape::Trapezoidal { ramp: PI / 6.0 },
        EmfShape::Trapezoidal { ramp: PI / 4.0 },
        EmfShape::Trapezoidal { ramp: FRAC_PI_2 },
    ];

    #[test]
    fn integral_is_the_antiderivative() {
        for shape in SHAPES {
            let mut mean = 0.0;
            for step in 0..3600 {
                let theta = f64::from(step) * TAU / 3600.0 - 3.0;
                let h = 1e-4;
                let slope = (shape.integral(theta + h) - shape.integral(theta - h)) / (2.0 * h);
                assert!(
                    (slope - shape.unit(theta)).abs() < 2e-4,
                    "{shape:?} at {theta}"
                );
                let slope = (shape.zero_sum_integral(theta + h)
                    - shape.zero_sum_integral(theta - h))
                    / (2.0 * h);
                assert!(
                    (slope - shape.zero_sum(theta)).abs() < 2e-4,
                    "{shape:?} at {theta}"
                );
                mean += shape.integral(theta) / 3600.0;
            }
            assert!(mean.abs() < 1e-9, "{shape:?} has mean {mean}");
        }
    }

    #[test]
    fn trapezoid_has_its_corners() {
        let shape = EmfShape::Trapezoidal { ramp: PI / 6.0 };
        for (deg, value) in [
            (0.0, 0.0),
            (15.0, 0.5),
            (30.0, 1.0),
            (150.0, 1.0),
            (165.0, 0.5),
            (-30.0, -1.0),
            (270.0, -1.0),
        ] {
            assert!(
                (shape.unit(f64::to_radians(deg)) - value).abs() < 1e-12,
                "{deg} degrees"
            );
        }
    }
}
