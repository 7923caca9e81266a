//! Greatest set-point of an envelope: by the voltage, by the bus current, and with field weakening over the angles by
//! which the reference turns.

use super::envelope::{ANGLES as SECTOR, Envelope, Line};
use super::torque_share::MOST_TURN;
use std::f64::consts::TAU;

impl Envelope {
    /// Greatest set-point at a speed, ampere.
    pub fn set_point(&self, omega_m: f64) -> f64 {
        let of_voltage = self.of_voltage(omega_m);
        let current = self.max_current.min(of_voltage);
        let current = self
            .bus_current
            .map_or(current, |bus| current.min(self.of_power(omega_m, bus)));
        let turned = self.weakening.filter(|_| of_voltage < self.max_current);
        let turned = turned.map_or(0.0, |share| {
            // Backward, a skewed shape is another one.
            let backward = Self {
                emf_shape: self.emf_shape.reversed(),
                ..*self
            };
            let of_backward = if backward == *self {
                f64::INFINITY
            } else {
                turned_set_point(&backward, share, omega_m)
            };
            turned_set_point(self, share, omega_m).min(of_backward)
        });
        current.max(turned).max(0.0)
    }

    /// By the voltages between all legs.
    fn of_voltage(&self, omega_m: f64) -> f64 {
        let reach = self.line_voltage();
        let bound = |least: f64, line: Line| {
            let left = reach - line.emf * line.drop.signum();
            least.min(left / line.drop.abs())
        };
        self.lines(omega_m).into_iter().fold(f64::INFINITY, bound)
    }

    /// By the power that a bus current brings: torque times speed and copper losses.
    fn of_power(&self, omega_m: f64, bus_current: f64) -> f64 {
        let power = self.v_bus * bus_current;
        let torque = self.torque_constant() * omega_m;
        let loss = self.resistance * self.squared_currents();
        // The positive root of loss I^2 + torque I = power, without cancellation.
        2.0 * power / (torque + (torque * torque + 4.0 * loss * power).sqrt())
    }
}

/// Greatest set-point of a drive at a speed in mechanical rad/s, ampere, over the angles by which the reference
/// turns: at each of them flows the greatest current, less what the set-point does not ask of its part along the
/// EMF. Negative where no angle keeps the voltages within what the legs reach.
fn turned_set_point(drive: &Envelope, share: [f64; 2], omega_m: f64) -> f64 {
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
        let (mut least, mut greatest) =
            (f64::NEG_INFINITY, top.min(turned_of_power(drive, omega_m)));
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
fn turned_of_power(drive: &Envelope, omega_m: f64) -> f64 {
    drive.bus_current.map_or(f64::INFINITY, |bus| {
        let most = drive.max_current;
        let loss = drive.resistance * drive.squared_currents() * most * most;
        (drive.v_bus * bus - loss) / (drive.torque_constant() * omega_m)
    })
}
