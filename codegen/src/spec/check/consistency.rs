//! The EMF constant against rated torque, rated current and torque constant.
//!
//! All of them state the same constant. Where they disagree, a basis or the EMF shape is usually
//! wrong: the checks try the others and name those that would fit.

use super::motor::{Motor, Winding, is_line_to_line, phase_constant};
use super::reader::Given;
use crate::diagnostics::{Collector, catalogue};
use crate::spec::EmfShape;
use crate::spec::units::Dimension;
use std::f64::consts::SQRT_2;

/// Accepted deviation: data sheets round, and rate torque with iron losses.
const TOLERANCE: f64 = 0.15;

pub(super) fn check(motor: &Motor, errors: &mut Collector) {
    let Some(constants) = Constants::of(motor) else {
        return;
    };
    check_rated_torque(motor, &constants, errors);
    check_torque_constant(motor, &constants, errors);
}

/// The EMF constant and how it is stated.
struct Constants<'a> {
    back_emf: &'a Given<'a>,
    line_to_line: bool,
    winding: Winding,
    shape: EmfShape,
    pole_pairs: u32,
}

/// One reading of the EMF constant: the change, and the torque per peak ampere, Nm/A.
struct Reading {
    change: String,
    quasi_square: f64,
    sinusoidal: f64,
}

impl<'a> Constants<'a> {
    fn of(motor: &'a Motor) -> Option<Self> {
        // An implausible constant is an error of its own.
        motor.emf_constant?;
        let (back_emf, winding) = (motor.back_emf.as_ref()?, motor.winding?);
        Some(Self {
            back_emf,
            line_to_line: is_line_to_line(back_emf, winding),
            winding,
            shape: motor.emf_shape?,
            pole_pairs: motor.pole_pairs?,
        })
    }

    fn reading(&self, change: &str, line_to_line: bool, shape: EmfShape, factor: f64) -> Reading {
        let phase = factor * phase_constant(self.back_emf, line_to_line, shape, self.pole_pairs);
        Reading {
            change: change.to_owned(),
            quasi_square: phase * shape.quasi_square_factor(),
            sinusoidal: phase * 1.5,
        }
    }

    fn stated(&self) -> Reading {
        self.reading("", self.line_to_line, self.shape, 1.0)
    }

    /// The other basis, the other shape, rms for peak, then two changes at once: one mistake is
    /// likelier than two.
    fn others(&self) -> Vec<Reading> {
        let basis = !self.line_to_line;
        let basis_text = if basis {
            "`back_emf` as `line_to_line`"
        } else {
            "`back_emf` as `phase`"
        };
        let (shape, shape_text) = match self.shape {
            EmfShape::Trapezoidal { .. } => (EmfShape::Sinusoidal, "`emf_shape: sinusoidal`"),
            EmfShape::Sinusoidal => (
                EmfShape::Trapezoidal {
                    flat_top_deg: 120.0,
                },
                "`emf_shape: trapezoidal`",
            ),
        };
        let rms = "`back_emf` taken as rms";
        let mut readings = vec![
            self.reading(shape_text, self.line_to_line, shape, 1.0),
            self.reading(rms, self.line_to_line, self.shape, SQRT_2),
            self.reading(
                &format!("{shape_text} and {rms}"),
                self.line_to_line,
                shape,
                SQRT_2,
            ),
        ];
        // Flux linkages and speed constants have a fixed basis.
        if self.back_emf.dimension == Some(Dimension::EmfConstant) && self.winding == Winding::Star
        {
            readings.insert(0, self.reading(basis_text, basis, self.shape, 1.0));
            let both = format!("{basis_text} and {shape_text}");
            readings.push(self.reading(&both, basis, shape, 1.0));
            readings.push(self.reading(
                &format!("{basis_text} and {rms}"),
                basis,
                self.shape,
                SQRT_2,
            ));
        }
        readings
    }
}

fn fits(expected: f64, given: f64) -> bool {
    (expected / given - 1.0).abs() <= TOLERANCE
}

/// The readings that fit; two changes only where no single one fits.
fn fitting(candidates: Vec<(String, f64)>, given: f64) -> Vec<(String, f64)> {
    let (single, double): (Vec<_>, Vec<_>) = candidates
        .into_iter()
        .filter(|(_, expected)| fits(*expected, given))
        .partition(|(change, _)| !change.contains(" and "));
    if single.is_empty() { double } else { single }
}

/// Accepted: torque within 15 % of k_t times the current, whether the current is quasi-square or
/// sinusoidal (of the same peak).
fn check_rated_torque(motor: &Motor, constants: &Constants, errors: &mut Collector) -> Option<()> {
    let (torque, current) = (motor.rated_torque.as_ref()?, motor.rated_current.as_ref()?);
    let stated = constants.stated();
    let expected = stated.quasi_square * current.si;
    let sinusoidal_machine = constants.shape == EmfShape::Sinusoidal;
    if fits(expected, torque.si)
        || (sinusoidal_machine && fits(stated.sinusoidal * current.si, torque.si))
    {
        return Some(());
    }
    let mut candidates: Vec<(String, f64)> = constants
        .others()
        .into_iter()
        .map(|reading| (reading.change, reading.quasi_square * current.si))
        .collect();
    candidates.insert(
        0,
        ("`rated_current` taken as rms".to_owned(), SQRT_2 * expected),
    );
    errors.push(catalogue::torque_contradiction(
        &torque.part,
        &current.part,
        &constants.back_emf.part,
        torque.si,
        expected,
        &fitting(candidates, torque.si),
    ));
    Some(())
}

/// Accepted: a torque constant within 15 % of what the EMF constant gives with either shape of
/// current.
fn check_torque_constant(
    motor: &Motor,
    constants: &Constants,
    errors: &mut Collector,
) -> Option<()> {
    let constant = motor.torque_constant.as_ref()?;
    let stated = constants.stated();
    if fits(stated.quasi_square, constant.si) || fits(stated.sinusoidal, constant.si) {
        return Some(());
    }
    let mut candidates: Vec<(String, f64)> = constants
        .others()
        .into_iter()
        .map(|reading| (reading.change, reading.quasi_square))
        .collect();
    let rms = "`torque_constant` taken per rms ampere".to_owned();
    candidates.insert(0, (rms, SQRT_2 * stated.sinusoidal));
    errors.push(catalogue::torque_constant_contradiction(
        &constant.part,
        &constants.back_emf.part,
        constant.si,
        stated.quasi_square,
        stated.sinusoidal,
        &fitting(candidates, constant.si),
    ));
    Some(())
}

#[cfg(test)]
mod tests {
    use crate::diagnostics::Code;
    use crate::spec::{check, parse_toml};

    /// Codes of what is wrong with the paper's motor, its shape of EMF and one more line in its
    /// file.
    fn codes(shape: &str, line: &str) -> Vec<Code> {
        let text = include_str!("../../example.toml");
        let text = text.replace("\"trapezoidal\"", &format!("\"{shape}\""));
        let lines = text
            .lines()
            .filter(|line| !line.starts_with("rated_torque"));
        let text = lines.collect::<Vec<_>>().join("\n");
        let text = text.replacen("[motor]\n", &format!("[motor]\n{line}\n"), 1);
        let checked = parse_toml(&text, "motor.toml").and_then(|ast| check(&ast).map(drop));
        let errors = checked.err().into_iter().flatten();
        errors.map(|error| error.code).collect()
    }

    /// The first and the last value that are accepted, to a millionth.
    fn check_edges(shape: &str, field: &str, unit: &str, [first, last]: [f64; 2], code: Code) {
        for (edge, outward) in [(first, -1.0), (last, 1.0)] {
            let line =
                |share: f64| format!("{field} = \"{:.9} {unit}\"", edge * (1.0 + share * outward));
            assert_eq!(codes(shape, &line(-1e-6)), [], "{shape}: {}", line(-1e-6));
            assert_eq!(codes(shape, &line(1e-6)), [code], "{shape}: {}", line(1e-6));
        }
    }

    #[test]
    fn torque_and_torque_constant_may_be_fifteen_percent_off_what_the_emf_gives() {
        // 0.1648 V/(rad/s) between two lines: phases of half of it with a flat top, of 1/sqrt 3 of
        // it without.
        let (flat, sine) = (0.1648 / 2.0, 0.1648 / 3.0_f64.sqrt());
        let quasi_square = |phase: f64, share: f64| phase * share;
        let (of_flat, of_sine) = (
            quasi_square(flat, 2.0),
            // The mean of a sine over the 60 degrees about the crossing of two phases' tops.
            quasi_square(sine, 3.0 * 3.0_f64.sqrt() / std::f64::consts::PI),
        );
        // What follows from the EMF is 15 % more than the least and 15 % less than the greatest.
        let range = |least: f64, greatest: f64| [least / 1.15, greatest / 0.85];
        let torque = Code::TorqueContradiction;
        let times =
            |[least, greatest]: [f64; 2], current: f64| [least * current, greatest * current];
        check_edges(
            "trapezoidal",
            "rated_torque",
            "Nm",
            times(range(of_flat, of_flat), 20.0),
            torque,
        );
        check_edges(
            "sinusoidal",
            "rated_torque",
            "Nm",
            times(range(1.5 * sine, of_sine), 20.0),
            torque,
        );
        let constant = Code::TorqueConstantContradiction;
        // Per ampere of a sine wave, too, of the same peak.
        check_edges(
            "trapezoidal",
            "torque_constant",
            "Nm/A",
            range(1.5 * flat, of_flat),
            constant,
        );
        check_edges(
            "sinusoidal",
            "torque_constant",
            "Nm/A",
            range(1.5 * sine, of_sine),
            constant,
        );
    }
}
