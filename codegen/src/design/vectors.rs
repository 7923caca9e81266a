//! Voltage vectors, sectors and modulation geometry of the two-level inverter (the paper's Table 2,
//! (16)).

use nalgebra::Vector2;
use std::f64::consts::PI;

/// Legs of a phase: plus (+1), minus (-1) or open (0), for a, b, c.
pub type LegSigns = [i32; 3];

/// V1 to V6: legs --+ +-+ +-- ++- -+- -++.
pub const THREE_PHASE: [LegSigns; 6] = [
    [-1, -1, 1],
    [1, -1, 1],
    [1, -1, -1],
    [1, 1, -1],
    [-1, 1, -1],
    [-1, 1, 1],
];

/// V12 to V61: legs 0-+ +-0 +0- 0+- -+0 -0+.
pub const TWO_PHASE: [LegSigns; 6] = [
    [0, -1, 1],
    [1, -1, 0],
    [1, 0, -1],
    [0, 1, -1],
    [-1, 1, 0],
    [-1, 0, 1],
];

/// Sign of the conducting pair's currents in S1 to S6, phases a, b, c.
pub const SECTOR_CURRENT: [LegSigns; 6] = [
    [0, -1, 1],
    [1, -1, 0],
    [1, 0, -1],
    [0, 1, -1],
    [-1, 1, 0],
    [-1, 0, 1],
];

/// Phase that is off in S1 to S6 (0 = a).
pub const OFF_PHASE: [i32; 6] = [0, 2, 1, 0, 2, 1];

/// Sign of the outgoing phase's current on entry of S1 to S6, positive torque, forward rotation.
pub const OUTGOING_SIGN: [i32; 6] = [-1, 1, -1, 1, -1, 1];

/// Amplitude-invariant Clarke transform of three phase quantities.
pub fn clarke(a: f64, b: f64, c: f64) -> Vector2<f64> {
    Vector2::new((2.0 * a - b - c) / 3.0, (b - c) / 3.0_f64.sqrt())
}

/// The vector of a leg pattern on a bus of `v_bus` volt; an open leg sits at the mean of the
/// others.
pub fn leg_vector(legs: LegSigns, v_bus: f64) -> Vector2<f64> {
    let [a, b, c] = legs.map(|sign| f64::from(sign) * v_bus / 2.0);
    clarke(a, b, c)
}

/// Coefficients of (16) for voltage sector `n` (0 to 5, from 60 n degrees): times t_a, t_b as a
/// share of the period, per volt of v_alpha and v_beta.
pub fn svm_coefficients(n: u32, v_bus: f64) -> [Vector2<f64>; 2] {
    let scale = 3.0_f64.sqrt() / v_bus;
    let (start, end) = (f64::from(n) * PI / 3.0, f64::from(n + 1) * PI / 3.0);
    [
        scale * Vector2::new(end.sin(), -end.cos()),
        scale * Vector2::new(-start.sin(), start.cos()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_have_table_2s_lengths_and_angles() {
        for (k, (three, two)) in THREE_PHASE.iter().zip(&TWO_PHASE).enumerate() {
            let three = leg_vector(*three, 48.0);
            let two = leg_vector(*two, 48.0);
            let degrees = |v: Vector2<f64>| v.y.atan2(v.x).to_degrees().rem_euclid(360.0);
            let expected = 60.0 * k as f64;
            assert!((three.norm() - 32.0).abs() < 1e-12);
            assert!((two.norm() - 48.0 / 3.0_f64.sqrt()).abs() < 1e-12);
            let near = |angle: f64, target: f64| {
                ((angle - target + 180.0).rem_euclid(360.0) - 180.0).abs() < 1e-9
            };
            assert!(near(degrees(three), 240.0 + expected));
            assert!(near(degrees(two), 270.0 + expected));
        }
    }

    #[test]
    fn svm_times_rebuild_the_voltage() {
        let v_bus = 48.0;
        for step in 0..360 {
            let angle = f64::from(step).to_radians() + 0.003;
            let v = Vector2::new(angle.cos(), angle.sin()) * 20.0;
            let n = (angle.rem_euclid(2.0 * PI) / (PI / 3.0)) as u32;
            let [t_a, t_b] = svm_coefficients(n, v_bus).map(|c| c.dot(&v));
            let edge = |k: u32| {
                2.0 * v_bus / 3.0
                    * Vector2::new(
                        (f64::from(k) * PI / 3.0).cos(),
                        (f64::from(k) * PI / 3.0).sin(),
                    )
            };
            let rebuilt = t_a * edge(n) + t_b * edge(n + 1);
            assert!((rebuilt - v).norm() < 1e-9 && t_a >= 0.0 && t_b >= 0.0 && t_a + t_b <= 1.0);
        }
    }
}
