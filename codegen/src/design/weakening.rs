//! Field weakening: up to which speed it holds the EMF within the bus.

use crate::spec::{Envelope, MOST_TURN, proportional_current};
use nalgebra::Complex;
use std::f64::consts::{PI, TAU};

/// Angles of a turn over which a fundamental is summed.
const ANGLES: u32 = 120;

/// The last speed, mechanical rad/s, at which the greatest current turned by [`MOST_TURN`] needs no more than six
/// steps of the bus make, if that is below `maximum`; by fundamental phasors, beyond the idle speed.
pub fn last_speed(drive: &Envelope, maximum: f64) -> Option<f64> {
    const HALVINGS: u32 = 40;
    let six_steps = 2.0 / PI * drive.v_bus * drive.reach;
    let emf = drive.emf_constant * fundamental(|theta| drive.emf_shape.zero_sum(theta)[0]);
    let ratio = drive.emf_shape.torque_factor(drive.reference);
    let unit = fundamental(|theta| proportional_current(drive.emf_shape, ratio, theta));
    let most = TAU * MOST_TURN;
    let turned = unit * drive.max_current * Complex::new(most.cos(), most.sin());
    let fits = |omega_m: f64| {
        let impedance = Complex::new(
            drive.resistance,
            omega_m * drive.pole_pairs * drive.inductance,
        );
        (emf * omega_m + impedance * turned).norm_sqr() <= six_steps * six_steps
    };
    let (mut held, mut lost) = (drive.idle_speed(), maximum);
    if lost <= held || fits(lost) {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(held, lost);
        if fits(middle) {
            held = middle;
        } else {
            lost = middle;
        }
    }
    Some(held)
}

/// Fundamental of a phase's function of the angle; real if it is odd.
fn fundamental(of_a: impl Fn(f64) -> f64) -> Complex<f64> {
    let sum: Complex<f64> = (0..ANGLES)
        .map(|angle| {
            let theta = TAU * f64::from(angle) / f64::from(ANGLES);
            Complex::new(theta.sin(), theta.cos()) * of_a(theta)
        })
        .sum();
    sum * 2.0 / f64::from(ANGLES)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{EmfShape, Reference};

    #[test]
    fn the_last_speed_is_that_of_a_simulated_drive() {
        // An outrunner at 24 V and 40 A: a float simulation of another hand makes 0.96 Nm of 2.2 Nm at 4993 rpm,
        // 0.015 Nm at 5825 rpm, and less than nothing beyond.
        let drive = Envelope {
            emf_shape: EmfShape::Sinusoidal,
            reference: Reference::Proportional,
            pole_pairs: 7.0,
            resistance: 0.0389,
            inductance: 23.5e-6,
            emf_constant: 0.0318,
            t_s: 50e-6,
            v_bus: 24.0,
            reach: 1.0,
            pairs: false,
            max_current: 40.0,
            bus_current: None,
            weakening: None,
        };
        let last = last_speed(&drive, 1000.0).expect("is below") * 60.0 / TAU;
        assert!((5300.0..5700.0).contains(&last), "{last}");
        assert_eq!(last_speed(&drive, 500.0), None);
    }
}
