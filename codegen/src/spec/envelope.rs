//! The envelope: the greatest current and torque over speed for which the bus drives the whole shape of
//! the drive's current reference. Beyond it the legs cut the shape: the torque ripples, then falls.
//!
//! At a steady speed a proportional reference needs, from an angle theta to that a period later,
//!
//! v = (i(theta + d) - A i(theta))/B + e, A = exp(-R Ts/L), B = (1 - A)/R, d = omega_e Ts,
//!
//! with e the mean of the EMF in between. That is linear in the set-point, so each angle and each pair of
//! legs bounds it by the voltage that the legs reach. A quasi-square reference needs 2 R I and the EMF of
//! its two phases; its commutations take more and are left out. Vectors of pairs (`modulation: table2`) make half
//! the bus as a phase voltage: 2 R I and twice the greatest EMF of a phase, less the mean of the three, are within
//! the bus. Field weakening turns the reference where the
//! voltage ends: the envelope is that of the best angle at which the bus drives the whole turned shape. Beyond it a
//! trapezoid still makes torque, with its shape cut.

use super::emf_shape::{phases, proportional_currents, zero_sum_integral};
use super::torque_share::share_of_torque;
use super::{EmfShape, Reference, Spec};
use std::f64::consts::FRAC_PI_3;

/// Angles of a sector at which the voltage is looked at. The shapes' symmetries repeat the rest of a turn.
pub(super) const ANGLES: u32 = 60;

/// Steps of the search for a speed: to a millionth of the greatest.
const HALVINGS: u32 = 20;

/// Greatest speed at which field weakening is looked at, over that at which the EMF takes all that the legs reach.
const FASTEST: f64 = 4.0;

/// What the greatest current of a drive depends on, SI units; motor values per phase of the star.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope {
    /// Shape of the phase EMF.
    pub emf_shape: EmfShape,
    /// Shape of the current reference.
    pub reference: Reference,
    /// Pole pairs.
    pub pole_pairs: f64,
    /// Ohm.
    pub resistance: f64,
    /// Henry.
    pub inductance: f64,
    /// Peak phase EMF over mechanical speed, V s/rad.
    pub emf_constant: f64,
    /// Control period, second.
    pub t_s: f64,
    /// Bus voltage, volt.
    pub v_bus: f64,
    /// Share of the bus voltage that two legs reach between them, 0 to 1.
    pub reach: f64,
    /// Whether vectors of pairs make the voltage, one leg off, as with `modulation: table2`.
    pub pairs: bool,
    /// Largest set-point, ampere.
    pub max_current: f64,
    /// Greatest current drawn from the bus, ampere.
    pub bus_current: Option<f64>,
    /// With field weakening, what a turned current keeps of its torque: c2 and c4 of [`share_of_torque`].
    pub weakening: Option<[f64; 2]>,
}

/// Voltage between two legs over one period: volt per ampere of set-point, and volt.
pub(super) struct Line {
    pub drop: f64,
    pub emf: f64,
}

impl Envelope {
    /// What the voltage allows where no limit of the bus current cuts it.
    #[must_use]
    pub fn without_bus_limit(self) -> Self {
        Self {
            bus_current: None,
            ..self
        }
    }

    /// Of a drive at its nominal bus voltage.
    pub fn of(spec: &Spec) -> Self {
        let (motor, inverter) = (&spec.motor, &spec.inverter);
        let weakens = spec.controller.common().field_weakening;
        Self {
            emf_shape: motor.emf_shape,
            reference: spec.controller.common().reference,
            pole_pairs: f64::from(motor.pole_pairs),
            resistance: motor.resistance,
            inductance: motor.inductance,
            emf_constant: motor.emf_constant,
            t_s: inverter.t_s,
            v_bus: inverter.v_bus,
            reach: spec.reach_share(),
            pairs: spec.controller.has_intervals(),
            max_current: inverter.max_current,
            bus_current: inverter.bus_currents.drawn,
            weakening: weakens.then(|| share_of_torque(motor.emf_shape)),
        }
    }

    /// Torque per ampere of set-point, Nm/A.
    pub fn torque_constant(&self) -> f64 {
        self.emf_constant * self.emf_shape.torque_factor(self.reference)
    }

    /// Greatest motoring torque at a speed in mechanical rad/s, Nm; 0 where the EMF takes more than the legs reach, with
    /// field weakening at every angle.
    pub fn torque(&self, omega_m: f64) -> f64 {
        self.torque_constant() * self.set_point(omega_m)
    }

    /// Greatest speed at which a motoring torque in Nm is within the envelope, mechanical rad/s; `None` if it
    /// is not even at standstill.
    pub fn speed(&self, torque: f64) -> Option<f64> {
        // Bounds without their noise: a torque on the largest set-point is held.
        let torque = torque * (1.0 - 1e-9);
        if self.torque(0.0) < torque {
            return None;
        }
        let mut held = 0.0;
        let beyond = if self.weakening.is_some() {
            FASTEST
        } else {
            1.0
        };
        let mut lost = beyond * self.idle_speed();
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(held, lost);
            if self.torque(middle) < torque {
                lost = middle;
            } else {
                held = middle;
            }
        }
        Some(held)
    }

    /// Speed at which the EMF takes all that the legs reach, mechanical rad/s.
    pub fn idle_speed(&self) -> f64 {
        self.line_voltage() / self.emf_peak()
    }

    /// Bus voltage that a set-point in ampere takes at a speed in mechanical rad/s, volt.
    pub fn bus_voltage(&self, omega_m: f64, set_point: f64) -> f64 {
        let lines = self.lines(omega_m).into_iter();
        let most = lines.map(|line| (set_point * line.drop + line.emf).abs());
        most.fold(0.0, f64::max) / self.reach
    }

    /// What EMF, resistance and inductance take between two legs of a set-point in ampere at a speed in mechanical
    /// rad/s, volt: the inductance what the others leave of the whole.
    pub fn voltages(&self, omega_m: f64, set_point: f64) -> [f64; 3] {
        let whole = |omega_m| self.reach * self.bus_voltage(omega_m, set_point);
        let drop = whole(0.0);
        let emf = omega_m * self.emf_peak();
        [emf, drop, (whole(omega_m) - emf - drop).max(0.0)]
    }

    /// Greatest phase current of the largest set-point, ampere.
    pub fn peak_current(&self) -> f64 {
        self.max_current * self.emf_shape.current_peak(self.reference)
    }

    /// Voltage that the legs reach between two of them, volt.
    pub fn line_voltage(&self) -> f64 {
        self.v_bus * self.reach
    }

    /// exp(-R Ts/L), and the voltage per ampere that a change of the current takes, ohm.
    pub(super) fn discrete(&self) -> (f64, f64) {
        let decay = (-self.resistance * self.t_s / self.inductance).exp();
        (decay, self.resistance / (1.0 - decay))
    }

    /// Greatest EMF between two legs, or with vectors of pairs twice that of a phase, over mechanical speed, V s/rad.
    fn emf_peak(&self) -> f64 {
        if !self.pairs {
            return self.emf_constant * self.emf_shape.line_to_line_peak();
        }
        let of_phases = sector().flat_map(|theta| self.mean_emf(theta, 0.0));
        2.0 * of_phases.fold(0.0, |most, emf| f64::max(most, emf.abs()))
    }

    /// What a set-point of one ampere and the EMF take between two legs over a sector.
    pub(super) fn lines(&self, omega_m: f64) -> Vec<Line> {
        match self.reference {
            // Two phases carry one current, at worst where their EMF is greatest.
            Reference::QuasiSquare => vec![Line {
                drop: 2.0 * self.resistance,
                emf: omega_m * self.emf_peak(),
            }],
            Reference::Proportional => self.lines_of_three(omega_m),
        }
    }

    fn lines_of_three(&self, omega_m: f64) -> Vec<Line> {
        let turn = omega_m * self.pole_pairs * self.t_s;
        let (decay, gain) = self.discrete();
        let lines = |from: [f64; 3], to: [f64; 3], emf: [f64; 3]| {
            [(0, 1), (1, 2), (2, 0)].map(|(p, q)| Line {
                drop: gain * ((to[p] - to[q]) - decay * (from[p] - from[q])),
                emf: omega_m * (emf[p] - emf[q]),
            })
        };
        let mut all = Vec::new();
        // Backward, currents and EMF change their signs both.
        let is_skewed = self.emf_shape != self.emf_shape.reversed();
        for theta in sector() {
            let (from, to) = (self.unit_currents(theta), self.unit_currents(theta + turn));
            let emf = self.mean_emf(theta, turn);
            all.extend(lines(from, to, emf));
            if is_skewed {
                all.extend(lines(to, from, emf));
            }
        }
        all
    }

    /// Mean of the phase currents' squares, summed, per squared ampere of set-point.
    pub(super) fn squared_currents(&self) -> f64 {
        match self.reference {
            Reference::QuasiSquare => 2.0,
            Reference::Proportional => {
                let squares = sector().map(|theta| {
                    let currents = self.unit_currents(theta);
                    currents
                        .iter()
                        .map(|current| current * current)
                        .sum::<f64>()
                });
                squares.sum::<f64>() / f64::from(ANGLES)
            }
        }
    }

    /// Phase currents of a proportional reference per ampere of set-point.
    pub(super) fn unit_currents(&self, theta: f64) -> [f64; 3] {
        let ratio = self.emf_shape.torque_factor(self.reference);
        proportional_currents(self.emf_shape, ratio, theta)
    }

    /// Mean EMF of the phases, less their mean, over a turn of `turn` electrical radians from `theta` on, volt
    /// per mechanical rad/s.
    pub fn mean_emf(&self, theta: f64, turn: f64) -> [f64; 3] {
        let mean = if turn < 1e-6 {
            self.emf_shape.zero_sum(theta)
        } else {
            let integral = |theta| zero_sum_integral(self.emf_shape, theta);
            let (from, to) = (phases(integral, theta), phases(integral, theta + turn));
            [0, 1, 2].map(|phase| (to[phase] - from[phase]) / turn)
        };
        mean.map(|value| self.emf_constant * value)
    }
}

/// The angles of a sector, radian.
fn sector() -> impl Iterator<Item = f64> {
    (0..ANGLES).map(|angle| FRAC_PI_3 * f64::from(angle) / f64::from(ANGLES))
}

#[cfg(test)]
mod tests {
    use super::Envelope;
    use crate::spec::{EmfShape, Reference, share_of_torque};

    /// The 660 W motor of the paper at 48 V.
    const DRIVE: Envelope = Envelope {
        emf_shape: EmfShape::Trapezoidal {
            flat_top_deg: 120.0,
        },
        reference: Reference::Proportional,
        pole_pairs: 4.0,
        resistance: 0.135,
        inductance: 0.22e-3,
        emf_constant: 0.0824,
        t_s: 50e-6,
        v_bus: 48.0,
        reach: 1.0,
        pairs: false,
        max_current: 22.0,
        bus_current: None,
        weakening: None,
    };

    fn near(left: f64, right: f64) -> bool {
        (left / right - 1.0).abs() < 1e-3
    }

    #[test]
    fn a_sine_in_short_periods_needs_the_voltage_of_its_phasor() {
        let drive = Envelope {
            emf_shape: EmfShape::Sinusoidal,
            t_s: 1e-7,
            max_current: f64::INFINITY,
            ..DRIVE
        };
        for omega_m in [20.0, 150.0, 300.0] {
            let set_point = drive.set_point(omega_m);
            let reactance = 4.0 * omega_m * drive.inductance;
            let real = drive.resistance * set_point + drive.emf_constant * omega_m;
            let voltage = 3_f64.sqrt() * real.hypot(reactance * set_point);
            assert!(near(voltage, 48.0), "{omega_m}: {voltage}");
        }
    }

    #[test]
    fn a_sine_in_long_periods_needs_the_voltage_of_its_chord() {
        let drive = Envelope {
            emf_shape: EmfShape::Sinusoidal,
            max_current: f64::INFINITY,
            ..DRIVE
        };
        let omega_m = 300.0;
        // In the frame of the angle in the middle of a period: from -half to half of its turn.
        let half: f64 = 4.0 * omega_m * drive.t_s / 2.0;
        let decay = (-drive.resistance * drive.t_s / drive.inductance).exp();
        let gain = drive.resistance / (1.0 - decay);
        let set_point = drive.set_point(omega_m);
        let real = gain * set_point * (1.0 - decay) * half.cos()
            + drive.emf_constant * omega_m * half.sin() / half;
        let imaginary = gain * set_point * (1.0 + decay) * half.sin();
        let voltage = 3_f64.sqrt() * real.hypot(imaginary);
        assert!(near(voltage, 48.0), "{voltage}");
    }

    #[test]
    fn a_quasi_square_current_has_the_bus_less_the_emf_of_two_phases() {
        let drive = Envelope {
            reference: Reference::QuasiSquare,
            ..DRIVE
        };
        // (48 V - 2 * 0.0824 * 209.44 V)/(0.27 ohm) is 49.9 A.
        assert!(near(drive.set_point(209.44), 22.0));
        assert!(near(drive.set_point(270.0), (48.0 - 44.496) / 0.27));
        assert!(near(drive.torque(270.0), 2.0 * 0.0824 * 12.978));
        assert_eq!(drive.torque(292.0), 0.0);
    }

    #[test]
    fn vectors_of_pairs_drive_three_quarters_of_the_emf_of_a_trapezoid() {
        let drive = Envelope {
            reference: Reference::QuasiSquare,
            pairs: true,
            ..DRIVE
        };
        // Beside E and -E the third phase has between -E and E: less their mean, at most 4/3 E.
        let most = 48.0 / (8.0 / 3.0 * 0.0824);
        assert!(near(drive.idle_speed(), most));
        assert!(near(drive.set_point(0.9 * most), 0.1 * 48.0 / 0.27));
    }

    #[test]
    fn the_speed_of_a_torque_is_where_the_torque_ends() {
        for torque in [0.1, 1.0, 3.3, 3.62] {
            let speed = DRIVE.speed(torque).expect("is within");
            assert!(DRIVE.torque(speed) >= torque * (1.0 - 1e-6));
            assert!(DRIVE.torque(speed * 1.0001) < torque);
        }
        assert_eq!(DRIVE.speed(3.64), None);
    }

    #[test]
    fn the_bus_voltage_of_a_point_is_the_bus_on_whose_envelope_it_is() {
        for set_point in [5.0, 20.0] {
            let v_bus = DRIVE.bus_voltage(230.0, set_point);
            let drive = Envelope {
                v_bus,
                max_current: f64::INFINITY,
                ..DRIVE
            };
            assert!(near(drive.set_point(230.0), set_point));
        }
        let window = Envelope {
            reach: 0.9,
            ..DRIVE
        };
        assert!(near(
            0.9 * window.bus_voltage(230.0, 20.0),
            DRIVE.bus_voltage(230.0, 20.0)
        ));
    }

    /// Currents of a sine turned by an angle in short periods, by phasors: the greatest torque of the angles that
    /// the voltage allows.
    #[test]
    fn a_weakened_sine_has_the_torque_of_its_best_phasor() {
        let drive = Envelope {
            emf_shape: EmfShape::Sinusoidal,
            t_s: 1e-7,
            weakening: Some(share_of_torque(EmfShape::Sinusoidal)),
            ..DRIVE
        };
        for omega_m in [260.0, 300.0, 360.0] {
            let (reactance, emf) = (
                4.0 * omega_m * drive.inductance,
                drive.emf_constant * omega_m,
            );
            let most = (0..=750_u32).map(|step| {
                let against = 22.0 * (f64::from(step) / 10.0).to_radians().sin();
                // Voltage of a current along the EMF beside the one against the field.
                let fits = |along: f64| {
                    let real = emf + drive.resistance * along - reactance * against;
                    let imaginary = drive.resistance * against + reactance * along;
                    3_f64.sqrt() * real.hypot(imaginary) <= 48.0
                };
                let top = (22.0_f64.powi(2) - against.powi(2)).sqrt();
                let tried = (0..=2200_u32).map(|along| f64::from(along) / 2200.0 * top);
                tried.filter(|along| fits(*along)).fold(0.0, f64::max)
            });
            let best = most.fold(0.0, f64::max);
            let found = drive.set_point(omega_m);
            assert!(
                (found / best - 1.0).abs() < 0.01,
                "{omega_m}: {found} {best}"
            );
        }
        // At a speed beyond, the whole torque's; without weakening the EMF alone ends it.
        let plain = Envelope {
            weakening: None,
            ..drive
        };
        let (with, without) = (drive.speed(2.0), plain.speed(2.0));
        assert!(
            with > without.map(|speed| 1.15 * speed),
            "{with:?} {without:?}"
        );
        assert_eq!(plain.torque(340.0), 0.0);
    }

    #[test]
    fn a_bus_current_brings_torque_and_losses() {
        let drive = Envelope {
            reference: Reference::QuasiSquare,
            bus_current: Some(5.0),
            ..DRIVE
        };
        let (omega_m, set_point) = (100.0, drive.set_point(100.0));
        let power = drive.torque(omega_m) * omega_m + 2.0 * 0.135 * set_point * set_point;
        assert!(near(power, 48.0 * 5.0), "{power}");
    }
}
