//! Share of the torque that a proportional current keeps if it is turned by an angle, as for field weakening.

use super::EmfShape;
use super::emf_shape::proportional_currents;
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::TAU;

/// Greatest angle by which a reference is turned, electrical turns: 75 degrees. A quarter of the torque is
/// left there; beyond, more current would only be lost.
pub const MOST_TURN: f64 = 75.0 / 360.0;

/// Rotor angles and angles of the reference over which the share is fitted.
const ANGLES: u32 = 120;
const TURNS: u32 = 30;

/// c2 and c4 of the share of the torque, 1 - a^2 (c2 - c4 a^2), with a the angle in turns: by least squares over
/// 0 to [`MOST_TURN`], a third of a percent off at most. Of a shape that is skewed, the mean of both directions.
pub fn share_of_torque(shape: EmfShape) -> [f64; 2] {
    let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
    for step in 1..=TURNS {
        let turn = MOST_TURN * f64::from(step) / f64::from(TURNS);
        let square = turn * turn;
        let row = Vector2::new(square, -square * square);
        normal += row * row.transpose();
        right += row * (1.0 - exact_share(shape, turn));
    }
    let fitted = normal.lu().solve(&right).unwrap_or_default();
    // Numbers of a specification, which rounding makes the same on every machine.
    [fitted.x, fitted.y].map(|value| (value * 1e6).round() / 1e6)
}

/// Mean torque of the current turned by `turn` turns over that of the current itself.
fn exact_share(shape: EmfShape, turn: f64) -> f64 {
    let torque = |turn: f64| {
        let at = |angle: u32| {
            let theta = TAU * f64::from(angle) / f64::from(ANGLES);
            let currents = proportional_currents(shape, 1.0, theta + TAU * turn);
            let emf = shape.zero_sum(theta);
            currents.iter().zip(emf).map(|(i, e)| i * e).sum::<f64>()
        };
        (0..ANGLES).map(at).sum::<f64>()
    };
    0.5 * (torque(turn) + torque(-turn)) / torque(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::emf_shape::SHAPES;

    #[test]
    fn the_share_of_a_sine_is_the_cosine() {
        for degrees in [0.0_f64, 20.0, 45.0, 60.0, 75.0] {
            let share = exact_share(EmfShape::Sinusoidal, degrees / 360.0);
            assert!((share - degrees.to_radians().cos()).abs() < 1e-9);
        }
    }

    #[test]
    fn the_fit_is_a_third_of_a_percent_off_at_most() {
        for shape in SHAPES {
            let [c2, c4] = share_of_torque(shape);
            for step in 0..=TURNS {
                let turn = MOST_TURN * f64::from(step) / f64::from(TURNS);
                let fitted = 1.0 - turn * turn * (c2 - c4 * turn * turn);
                let off = fitted - exact_share(shape, turn);
                assert!(off.abs() < 1.0 / 300.0, "{shape:?} at {turn}: {off}");
            }
        }
    }

    /// By convexity in the set-point, the greatest phase current is that of the turned current or of none
    /// along the EMF.
    #[test]
    fn a_turned_reference_is_no_greater_than_the_reference() {
        for shape in SHAPES {
            let [c2, c4] = share_of_torque(shape);
            let current = |theta| shape.zero_sum(theta)[0] / shape.squared_length(theta);
            let thetas = (0..720).map(|step| TAU * f64::from(step) / 720.0);
            let peak = thetas.clone().map(current).fold(0.0, f64::max);
            for step in 0..=TURNS {
                let turn = MOST_TURN * f64::from(step) / f64::from(TURNS);
                let share = 1.0 - turn * turn * (c2 - c4 * turn * turn);
                for theta in thetas.clone() {
                    let idle = current(theta + TAU * turn) - share * current(theta);
                    assert!(idle.abs() <= 1.05 * peak, "{shape:?} at {turn}, {theta}");
                }
            }
        }
    }
}
