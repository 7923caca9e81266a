//! Field weakening: the torque that a proportional current turned by an angle still makes.

use super::EmfShape;
use super::emf_shape::proportional_currents;
use super::envelope::{ANGLES as SECTOR, Envelope};
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

/// Greatest set-point of a drive at a speed in mechanical rad/s, ampere, over the angles by which the reference
/// turns: at each of them flows the greatest current, less what the set-point does not ask of its part along the
/// EMF. Negative where no angle keeps the voltages within what the legs reach.
pub(super) fn turned_set_point(drive: &Envelope, share: [f64; 2], omega_m: f64) -> f64 {
    let turn = omega_m * drive.pole_pairs * drive.t_s;
    let degrees = 6 * SECTOR;
    // The angles of a sector are whole degrees, so that a turned current is another row of a table.
    let currents = |ahead: f64| -> Vec<[f64; 3]> {
        let angles = (0..degrees).map(|degree| TAU * f64::from(degree) / f64::from(degrees));
        angles
            .map(|theta| drive.unit_currents(theta + ahead))
            .collect()
    };
    let (from, to) = (currents(0.0), currents(turn));
    let (decay, gain) = drive.discrete();
    let drops: Vec<[f64; 3]> = from
        .iter()
        .zip(&to)
        .map(|(from, to)| phase_pairs(|x| gain * (to[x] - decay * from[x])))
        .collect();
    let sector: Vec<[f64; 3]> = (0..SECTOR)
        .map(|degree| {
            let theta = TAU * f64::from(degree) / f64::from(degrees);
            let emf = drive.mean_emf(theta, turn);
            phase_pairs(|x| omega_m * emf[x])
        })
        .collect();
    let [square, fourth] = share;
    let most = (MOST_TURN * f64::from(degrees)).round() as usize;
    let reach = drive.line_voltage();
    let of_turn = |ahead: usize| {
        let angle = ahead as f64 / f64::from(degrees);
        let share = 1.0 - angle * angle * (square - fourth * angle * angle);
        let top = share * drive.max_current;
        let (mut least, mut greatest) = (f64::NEG_INFINITY, top.min(of_power(drive, omega_m)));
        for (at, emf) in sector.iter().enumerate() {
            let turned = drops[(at + ahead) % drops.len()];
            for line in 0..3 {
                // The voltage is fixed + drop j, with j the set-point.
                let drop = drops[at][line];
                let fixed = drive.max_current * turned[line] - top * drop + emf[line];
                let ends = [(reach - fixed) / drop, (-reach - fixed) / drop];
                greatest = greatest.min(ends[0].max(ends[1]));
                least = least.max(ends[0].min(ends[1]));
            }
        }
        if least <= greatest { greatest } else { -1.0 }
    };
    (1..=most).map(of_turn).fold(-1.0, f64::max)
}

/// Differences of the three pairs of phases.
fn phase_pairs(of: impl Fn(usize) -> f64) -> [f64; 3] {
    [of(0) - of(1), of(1) - of(2), of(2) - of(0)]
}

/// Set-point that a bus current allows beside the losses of the greatest current, ampere.
fn of_power(drive: &Envelope, omega_m: f64) -> f64 {
    drive.bus_current.map_or(f64::INFINITY, |bus| {
        let most = drive.max_current;
        let loss = drive.resistance * drive.squared_currents() * most * most;
        (drive.v_bus * bus - loss) / (drive.torque_constant() * omega_m)
    })
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
