//! The unit shape of the phase EMF and the torque factors that follow from it.
//!
//! Conventions of `hexagen::conventions`: phase a rises through zero at theta_e = 0, b lags by a
//! third of a turn; shapes have half-wave symmetry and amplitude 1.

use super::{EmfShape, Reference};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_6, PI, SQRT_2, TAU};

const THIRD: f64 = TAU / 3.0;

/// Angles of a scan over a sixth of a turn, with which the lengths of all shapes repeat.
const ANGLES: u32 = 600;

/// Every tenth of a degree of a sixth of a turn, radians.
fn angles() -> impl Iterator<Item = f64> {
    (0..ANGLES).map(|step| f64::from(step).to_radians() / 10.0)
}

impl EmfShape {
    /// Unit EMF of phase a at the electrical angle `theta_e` (radian), from -1 to 1.
    pub fn at(self, theta_e: f64) -> f64 {
        match self {
            Self::Sinusoidal => theta_e.sin(),
            Self::Trapezoidal { flat_top_deg } => {
                let ramp = (180.0 - flat_top_deg).to_radians() / 2.0;
                let angle = theta_e.rem_euclid(TAU);
                let (sign, half) = if angle < PI {
                    (1.0, angle)
                } else {
                    (-1.0, angle - PI)
                };
                sign * (half.min(PI - half) / ramp).clamp(0.0, 1.0)
            }
            Self::Harmonics(series) => series.at(theta_e),
        }
    }

    /// Integral of the unit EMF of phase a over the angle, with zero mean over a turn, radian.
    pub fn integral(self, theta_e: f64) -> f64 {
        match self {
            Self::Sinusoidal => -theta_e.cos(),
            Self::Trapezoidal { flat_top_deg } => {
                let ramp = (PI - flat_top_deg.to_radians()) / 2.0;
                // From the positive zero crossing the integral rises by `area` over half a turn and
                // falls over the other half.
                let rise = |x: f64| {
                    if x <= ramp {
                        x * x / (2.0 * ramp)
                    } else {
                        x - ramp / 2.0
                    }
                };
                let area = 2.0 * rise(FRAC_PI_2);
                let turned = theta_e.rem_euclid(TAU);
                let (half, sign) = if turned < PI {
                    (turned, 1.0)
                } else {
                    (turned - PI, -1.0)
                };
                let risen = if half <= FRAC_PI_2 {
                    rise(half)
                } else {
                    area - rise(PI - half)
                };
                sign * (risen - area / 2.0)
            }
            Self::Harmonics(series) => series.integral(theta_e),
        }
    }

    /// The part of the three unit EMFs that drives current: each less their mean.
    pub fn zero_sum(self, theta_e: f64) -> [f64; 3] {
        let [a, b, c] = phases(|theta| self.at(theta), theta_e);
        let mean = (a + b + c) / 3.0;
        [a - mean, b - mean, c - mean]
    }

    /// f_alpha^2 + f_beta^2 of the unit EMF: 2/3 of the sum of the squared zero-sum phases.
    pub fn squared_length(self, theta_e: f64) -> f64 {
        squared(self.zero_sum(theta_e))
    }

    /// The shape that a rotor shows which turns backward, phases b and c exchanged.
    #[must_use]
    pub fn reversed(self) -> Self {
        match self {
            Self::Sinusoidal | Self::Trapezoidal { .. } => self,
            Self::Harmonics(series) => Self::Harmonics(series.reversed()),
        }
    }

    /// Squares of the length of the unit EMF in the plane, at the [`angles`].
    fn squared_lengths(self) -> impl Iterator<Item = f64> {
        angles().map(move |theta_e| self.squared_length(theta_e))
    }

    /// Least length of the unit EMF in the plane.
    pub fn least_length(self) -> f64 {
        self.squared_lengths().fold(f64::INFINITY, f64::min).sqrt()
    }

    /// Greatest relative change per radian of the length of the unit EMF in the plane, whichever way.
    pub fn steepness(self) -> f64 {
        const STEP: f64 = 1e-3;
        let length = |theta_e: f64| self.squared_length(theta_e).sqrt();
        let slopes =
            angles().map(|theta_e| (length(theta_e + STEP) / length(theta_e)).ln().abs() / STEP);
        slopes.fold(0.0, f64::max)
    }

    /// Greatest over least square of the length of the unit EMF in the plane, less 1: 0 of a sine, 1/3 of a trapezoid of
    /// 120 degrees.
    pub fn unevenness(self) -> f64 {
        let none = (f64::INFINITY, 0.0);
        let (least, most) = self
            .squared_lengths()
            .fold(none, |(least, most): (f64, f64), square| {
                (least.min(square), most.max(square))
            });
        most / least - 1.0
    }

    /// Mean of 1/s^2, s the length of the unit EMF in the plane, over 600 angles of a turn.
    pub fn mean_inverse_square(self) -> f64 {
        let inverses = self.squared_lengths().map(f64::recip);
        inverses.sum::<f64>() / f64::from(ANGLES)
    }

    /// Amplitude of the fundamental.
    pub fn fundamental(self) -> f64 {
        match self {
            Self::Sinusoidal => 1.0,
            Self::Trapezoidal { flat_top_deg } => {
                let ramp = (180.0 - flat_top_deg).to_radians() / 2.0;
                4.0 / PI * ramp.sin() / ramp
            }
            Self::Harmonics(series) => series.fundamental(),
        }
    }

    /// Peak of the line-to-line EMF over the peak of the phase EMF: 2 for a flat top of at least
    /// 60 degrees, sqrt(3) for a sine.
    pub fn line_to_line_peak(self) -> f64 {
        match self {
            // f is concave over its half wave, so f(x) + f(120 degrees - x) peaks in the middle.
            Self::Sinusoidal | Self::Trapezoidal { .. } => 2.0 * self.at(PI / 3.0),
            Self::Harmonics(series) => series.line_peak(),
        }
    }

    /// Mean torque per ampere of a quasi-square current over the phase constant: the mean of
    /// f_p - f_q over a sector. 2 for a flat top of at least 120 degrees, 3 sqrt(3)/pi for a sine.
    pub fn quasi_square_factor(self) -> f64 {
        match self {
            Self::Sinusoidal => 3.0 * 3f64.sqrt() / PI,
            Self::Trapezoidal { flat_top_deg } => {
                // Twice the mean of f from 30 to 90 degrees; the ramp ends at `ramp` degrees.
                let ramp = (180.0 - flat_top_deg) / 2.0;
                if ramp <= 30.0 {
                    2.0
                } else {
                    ((ramp * ramp - 900.0) / (2.0 * ramp) + 90.0 - ramp) / 30.0
                }
            }
            Self::Harmonics(series) => {
                let line =
                    |theta_e| series.integral(theta_e) - series.integral(theta_e - TAU / 3.0);
                (line(FRAC_PI_2) - line(FRAC_PI_6)) * 3.0 / PI
            }
        }
    }

    /// Mean torque per ampere of the rated current's peak over the phase constant: that of a quasi-square
    /// current with a trapezoidal EMF, else of a sinusoidal one.
    pub fn rated_factor(self) -> f64 {
        match self {
            Self::Sinusoidal | Self::Harmonics(_) => self.sine_factor(),
            Self::Trapezoidal { .. } => self.quasi_square_factor(),
        }
    }

    /// Peak of the rated current over its root mean square: with a trapezoidal EMF of a quasi-square
    /// wave, which is 0 in a third of the turn, else of a sine.
    pub fn rated_peak(self) -> f64 {
        match self {
            Self::Sinusoidal | Self::Harmonics(_) => SQRT_2,
            Self::Trapezoidal { .. } => 1.5_f64.sqrt(),
        }
    }

    /// Mean torque per ampere of a sinusoidal current's peak over the phase constant: 1.5 times the
    /// fundamental of the phase EMF.
    pub fn sine_factor(self) -> f64 {
        1.5 * self.fundamental()
    }

    /// Root mean square of the phase EMF over its peak: 1/sqrt(2) for a sine, 0.882 for a flat top
    /// of 120 degrees.
    pub fn phase_rms(self) -> f64 {
        match self {
            Self::Sinusoidal => FRAC_1_SQRT_2,
            Self::Trapezoidal { flat_top_deg } => {
                // Of the ramps' squares a third is left.
                (1.0 - 2.0 / 3.0 * (180.0 - flat_top_deg) / 180.0).sqrt()
            }
            Self::Harmonics(series) => series.rms(),
        }
    }

    /// Root mean square of the line-to-line EMF over the peak of the phase EMF: sqrt(1.5) for a
    /// sine, 1.491 for a flat top of 120 degrees.
    pub fn line_to_line_rms(self) -> f64 {
        const STEPS: u32 = 36_000;
        match self {
            Self::Sinusoidal => return 1.5_f64.sqrt(),
            Self::Harmonics(series) => return series.line_rms(),
            Self::Trapezoidal { .. } => {}
        }
        let sum: f64 = (0..STEPS)
            .map(|step| {
                let theta_e = PI * (f64::from(step) + 0.5) / f64::from(STEPS);
                (self.at(theta_e) - self.at(theta_e - TAU / 3.0)).powi(2)
            })
            .sum();
        (sum / f64::from(STEPS)).sqrt()
    }

    /// Torque per ampere of a current parallel to the EMF over the phase constant, the ampere
    /// being the phase current at theta_e = 90 degrees, where the phase's EMF peaks.
    ///
    /// i = (2/3) k_t/k_phase s/|s|^2 with s the zero-sum shape. At 90 degrees f = (1, -y, -y) with
    /// y = f(30 degrees) of a trapezoid or a sine, so s_a/|s|^2 = 1.5/(1 + y). 2 for a flat top of at
    /// least 120 degrees, 1.5 for a sine.
    pub fn proportional_factor(self) -> f64 {
        match self {
            Self::Sinusoidal | Self::Trapezoidal { .. } => 1.0 + self.at(FRAC_PI_6),
            Self::Harmonics(_) => {
                let [of_a, ..] = self.zero_sum(FRAC_PI_2);
                1.5 * self.squared_length(FRAC_PI_2) / of_a
            }
        }
    }

    /// Torque per ampere of set-point over the phase constant, for a shape of the current reference.
    pub fn torque_factor(self, reference: Reference) -> f64 {
        match reference {
            Reference::QuasiSquare => self.quasi_square_factor(),
            Reference::Proportional => self.proportional_factor(),
        }
    }

    /// Greatest phase current per ampere of set-point, for a shape of the current reference.
    pub fn current_peak(self, reference: Reference) -> f64 {
        match reference {
            Reference::QuasiSquare => 1.0,
            Reference::Proportional => self.proportional_peak(),
        }
    }

    /// Greatest phase current of the reference parallel to the EMF, per ampere of set-point:
    /// 1 for a sine, 1.077 for a flat top of 120 degrees (between two corners).
    pub fn proportional_peak(self) -> f64 {
        // Steps of a twentieth of a degree over a sixth of a turn, in which the three phases show all of a half wave.
        const STEPS: u32 = 1200;
        let greatest = (0..STEPS)
            .map(|step| {
                let theta_e = TAU / 6.0 * f64::from(step) / f64::from(STEPS);
                let phases = self.zero_sum(theta_e);
                let [a, b, c] = phases;
                a.abs().max(b.abs()).max(c.abs()) / squared(phases)
            })
            .fold(0.0, f64::max);
        2.0 / 3.0 * self.proportional_factor() * greatest
    }
}

/// f_alpha^2 + f_beta^2 of three phases without a mean.
fn squared([a, b, c]: [f64; 3]) -> f64 {
    (a * a + b * b + c * c) * 2.0 / 3.0
}

/// Integral over the angle of the part of phase a's unit EMF that drives current, zero mean, radians.
pub fn zero_sum_integral(shape: EmfShape, theta: f64) -> f64 {
    let [a, b, c] = phases(|theta| shape.integral(theta), theta);
    a - (a + b + c) / 3.0
}

/// A function of phase a for the three phases.
pub fn phases(of_a: impl Fn(f64) -> f64, theta: f64) -> [f64; 3] {
    [of_a(theta), of_a(theta - THIRD), of_a(theta - 2.0 * THIRD)]
}

/// Phase-a current per ampere of set-point, parallel to the EMF and of constant torque:
/// (2/3) (k_t/k_phase) s_a / |f|^2 with `ratio` = k_t/k_phase.
pub fn proportional_current(shape: EmfShape, ratio: f64, theta: f64) -> f64 {
    let [of_a, ..] = proportional_currents(shape, ratio, theta);
    of_a
}

/// The same for the three phases.
pub fn proportional_currents(shape: EmfShape, ratio: f64, theta: f64) -> [f64; 3] {
    let phases = shape.zero_sum(theta);
    let length = squared(phases);
    phases.map(|value| 2.0 / 3.0 * ratio * value / length)
}

/// Shapes of the tests.
#[cfg(test)]
pub(super) const SHAPES: [EmfShape; 3] = [
    EmfShape::Sinusoidal,
    EmfShape::Trapezoidal {
        flat_top_deg: 120.0,
    },
    EmfShape::Trapezoidal { flat_top_deg: 97.0 },
];

#[cfg(test)]
mod tests {
    use super::{EmfShape, PI, SHAPES, TAU, proportional_current, zero_sum_integral};
    use crate::spec::Harmonics;

    fn trapezoid(flat_top_deg: f64) -> EmfShape {
        EmfShape::Trapezoidal { flat_top_deg }
    }

    fn shapes() -> [EmfShape; 7] {
        // Sixth parts of a turn differ in their halves where a phase is not 0.
        let skewed = [
            (3, 0.15, 0.4),
            (5, 0.06, 0.7),
            (7, -0.03, 0.0),
            (23, 0.01, 1.0),
        ];
        [
            EmfShape::Sinusoidal,
            trapezoid(120.0),
            trapezoid(150.0),
            trapezoid(80.0),
            trapezoid(20.0),
            EmfShape::Harmonics(Harmonics::of([])),
            EmfShape::Harmonics(Harmonics::of(skewed)),
        ]
    }

    const STEPS: usize = 200_000;

    fn near(left: f64, right: f64) -> bool {
        (left - right).abs() < 1e-4
    }

    /// Midpoints of `STEPS` equal parts of `low..high` degrees, in radian.
    fn angles(low: f64, high: f64) -> impl Iterator<Item = f64> {
        (0..STEPS).map(move |k| (low + (high - low) * (k as f64 + 0.5) / STEPS as f64).to_radians())
    }

    #[test]
    fn the_trapezoid_follows_the_convention() {
        let shape = EmfShape::Trapezoidal {
            flat_top_deg: 120.0,
        };
        for (degrees, value) in [
            (0.0, 0.0),
            (15.0, 0.5),
            (30.0, 1.0),
            (150.0, 1.0),
            (165.0, 0.5),
            (270.0, -1.0),
        ] {
            assert!(near(shape.at(f64::to_radians(degrees)), value), "{degrees}");
        }
    }

    #[test]
    fn factors_agree_with_integration() {
        for shape in shapes() {
            let line = |theta: f64| shape.at(theta) - shape.at(theta - TAU / 3.0);
            let peak = angles(0.0, 360.0).map(line).fold(0.0, f64::max);
            assert!(near(peak, shape.line_to_line_peak()), "{shape:?} {peak}");
            let wave = |theta: f64| 2.0 * shape.at(theta) * theta.sin();
            let fundamental = angles(0.0, 360.0).map(wave).sum::<f64>() / STEPS as f64;
            assert!(near(fundamental, shape.fundamental()), "{shape:?}");
            let mean = angles(30.0, 90.0).map(line).sum::<f64>() / STEPS as f64;
            assert!(near(mean, shape.quasi_square_factor()), "{shape:?} {mean}");
        }
    }

    #[test]
    fn integrals_and_currents_follow_the_shape() {
        for shape in shapes() {
            let mut sum = 0.0;
            for theta in angles(0.0, 360.0).step_by(STEPS / 800) {
                let rise = shape.integral(theta + 1e-5) - shape.integral(theta - 1e-5);
                assert!((rise / 2e-5 - shape.at(theta)).abs() < 1e-4, "{shape:?}");
                sum += shape.integral(theta);
            }
            assert!(sum.abs() < 0.1, "{shape:?} {sum}");
            // The current of an ampere of set-point is an ampere where the EMF peaks.
            let [of_a, ..] = shape.zero_sum(PI / 2.0);
            let current = 2.0 / 3.0 * shape.proportional_factor() * of_a;
            assert!(near(current, shape.squared_length(PI / 2.0)), "{shape:?}");
        }
        // A series of the fundamental alone is a sine.
        let (sine, series) = (EmfShape::Sinusoidal, EmfShape::Harmonics(Harmonics::of([])));
        for factor in [
            EmfShape::line_to_line_peak,
            EmfShape::quasi_square_factor,
            EmfShape::proportional_factor,
            EmfShape::proportional_peak,
            EmfShape::phase_rms,
            EmfShape::rated_peak,
        ] {
            assert!((factor(sine) - factor(series)).abs() < 1e-6);
        }
    }

    #[test]
    fn means_of_whole_turns_agree_with_integration() {
        let mean = |values: &dyn Fn(f64) -> f64| {
            angles(0.0, 360.0).map(values).sum::<f64>() / STEPS as f64
        };
        for shape in shapes() {
            let line = |theta: f64| shape.at(theta) - shape.at(theta - TAU / 3.0);
            let phase_rms = mean(&|theta| shape.at(theta).powi(2)).sqrt();
            assert!(near(phase_rms, shape.phase_rms()), "{shape:?} {phase_rms}");
            let line_rms = mean(&|theta| line(theta).powi(2)).sqrt();
            assert!(near(line_rms, shape.line_to_line_rms()), "{shape:?}");
            let torque = mean(&|theta| 3.0 * shape.at(theta) * theta.sin());
            assert!(near(torque, shape.sine_factor()), "{shape:?} {torque}");
        }
        let trapezoid = trapezoid(120.0);
        // Of 120 degrees: between two lines 60 degrees of 2 E and ramps to 1 E and on to 0.
        assert!(near(trapezoid.line_to_line_rms(), (20.0_f64 / 9.0).sqrt()));
    }

    #[test]
    fn factors_of_the_two_standard_shapes() {
        let trapezoid = trapezoid(120.0);
        assert!(near(trapezoid.quasi_square_factor(), 2.0));
        assert!(near(trapezoid.proportional_factor(), 2.0));
        assert!(near(
            trapezoid.proportional_peak(),
            (2.0 + 3f64.sqrt()) / (2.0 * 3f64.sqrt())
        ));
        let sine = EmfShape::Sinusoidal;
        assert!(near(sine.quasi_square_factor(), 3.0 * 3f64.sqrt() / PI));
        assert!(near(sine.proportional_factor(), 1.5));
        assert!(near(sine.proportional_peak(), 1.0));
    }

    /// A current turned for field weakening is up to 5 % greater, and limited at 4 times the set-point.
    #[test]
    fn no_likely_shape_has_a_peak_near_four() {
        let amplitudes = || (-6..=6).map(|step| 0.05 * f64::from(step));
        let pairs = [(5, 7), (5, 11), (7, 11), (11, 13)];
        let series = pairs.into_iter().flat_map(|(one, other)| {
            let of_one = move |first: f64| {
                amplitudes()
                    .map(move |second| Harmonics::of([(one, first, 0.0), (other, second, 0.0)]))
            };
            amplitudes().flat_map(of_one)
        });
        let accepted = series.filter(|series| series.least_along() >= 0.5);
        let shapes = accepted.map(EmfShape::Harmonics);
        let peaks = shapes
            .filter(|shape| shape.steepness() <= 8.0)
            .map(EmfShape::proportional_peak);
        let most = peaks.fold(0.0, f64::max);
        assert!((2.0..3.0).contains(&most), "{most}");
    }

    #[test]
    fn the_integral_is_the_integral_of_the_shape() {
        for shape in SHAPES {
            let mut mean = 0.0;
            for step in 0..720 {
                let theta = f64::from(step) * TAU / 720.0 + 0.001;
                let slope = (zero_sum_integral(shape, theta + 1e-5)
                    - zero_sum_integral(shape, theta - 1e-5))
                    / 2e-5;
                assert!(
                    (slope - shape.zero_sum(theta)[0]).abs() < 1e-4,
                    "{shape:?} at {theta}"
                );
                mean += zero_sum_integral(shape, theta) / 720.0;
            }
            assert!(mean.abs() < 1e-5, "{shape:?}: mean {mean}");
        }
    }

    #[test]
    fn a_trapezoid_has_the_corners_of_table_1() {
        let shape = EmfShape::Trapezoidal {
            flat_top_deg: 120.0,
        };
        // Entry of S3 (90 degrees): (4/3, 0) E; entry of S2 (30 degrees): (2/3, -2/sqrt3) E.
        assert!((shape.zero_sum(PI / 2.0)[0] - 4.0 / 3.0).abs() < 1e-12);
        assert!((shape.zero_sum(PI / 6.0)[0] - 2.0 / 3.0).abs() < 1e-12);
        assert!((shape.squared_length(PI / 6.0).sqrt() - 4.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn the_proportional_current_is_the_set_point_where_the_emf_peaks() {
        for shape in SHAPES {
            let current = proportional_current(shape, shape.proportional_factor(), PI / 2.0);
            assert!((current - 1.0).abs() < 1e-12, "{shape:?}: {current}");
        }
    }
}
