//! A drive with 16-bit words against the same law in one common format for all motors.

use super::one_step::{Compared, OneStep, Step, Sums};
use crate::LabError;
use crate::closed_loop::{ClosedLoop, CurrentLoop, RunOptions};
use crate::engine::{Prepared, SetPoint};
use crate::plant::{Plant, PlantParams, Truth};
use hexagen::Sample;
use hexagen_reference::{AnyCommand, BitTrue, Ideal, Spec, Uniform};

/// Fraction bits of the saturating 16-bit format of SI units that covers all of these motors.
///
/// # Errors
/// An inconsistent specification.
pub fn uniform_format<'a>(
    specs: impl IntoIterator<Item = &'a Spec>,
) -> Result<i32, hexagen_reference::Error> {
    let mut largest = f64::MIN_POSITIVE;
    for spec in specs {
        largest = Uniform::largest(spec)?.max(largest);
    }
    Ok((f64::from(i16::MAX) / largest).log2().floor() as i32)
}

/// A drive's bit-true model in closed loop, with the ideal model and the law in the common format
/// from the same states.
struct Shadowed {
    bit_true: BitTrue,
    ideal: Ideal,
    uniform: Uniform,
    set_point: f64,
    timer_period: u16,
    sums: Sums,
    uniform_error: f64,
    signal: f64,
}

impl CurrentLoop for Shadowed {
    fn step(&mut self, sample: &Sample, _: &Truth) -> AnyCommand {
        let before = self.bit_true.physical_state();
        self.ideal.rebuild_from(&before);
        let legs = self.bit_true.step(sample);
        let duties = self.ideal.step(sample);
        let step = Step::of(&before, (&self.bit_true, legs), (&self.ideal, duties));
        self.sums.add(&step, self.timer_period);
        let exact = step.exact;
        if exact.run {
            let found = self.uniform.voltage(&before, &exact, self.set_point);
            let all = |[a, b]: [f64; 2]| a * a + b * b + (a + b) * (a + b);
            self.signal += all(exact.u_unsat);
            self.uniform_error += all([found[0] - exact.u_unsat[0], found[1] - exact.u_unsat[1]]);
        }
        legs
    }
}

/// Signal-to-noise ratios of both.
#[derive(Clone, Debug)]
pub struct Uniform16 {
    /// The generated formats.
    pub one_step: OneStep,
    /// Signal-to-noise ratio of the deadbeat voltage in the common format, decibel.
    pub uniform_snr_db: f64,
}

impl Uniform16 {
    /// Runs a drive at each operating point, from its first start; `None` for a law other than
    /// [`Uniform`]'s.
    ///
    /// # Errors
    /// A plant parameter out of range, or an inconsistent specification.
    pub fn measure(
        drive: &Prepared,
        plant: &PlantParams,
        runs: &[RunOptions],
        set_point: SetPoint,
        frac_bits: i32,
    ) -> Result<Option<Self>, LabError> {
        let uniform = Uniform::new(&drive.reference, frac_bits)
            .map_err(|error| LabError::Argument(error.to_string()))?;
        let Some(uniform) = uniform else {
            return Ok(None);
        };
        let none = Sums::new(Compared::of(drive));
        let (mut sums, mut uniform_error, mut signal) = (none.clone(), 0.0, 0.0);
        for run in runs {
            let (settling, measured) = run.periods(plant);
            let motor = Plant::new(plant.clone(), run.starts[0], run.omega_m)?;
            let (bit_true, ideal) = drive.references(set_point);
            let shadowed = Shadowed {
                set_point: bit_true.set_point_amps(),
                bit_true,
                ideal,
                uniform: uniform.clone(),
                timer_period: plant.timer_period,
                sums: none.clone(),
                uniform_error: 0.0,
                signal: 0.0,
            };
            let mut closed = ClosedLoop::new(motor, shadowed, run.delay);
            closed.run(settling + measured, &mut ());
            let shadowed = closed.into_controller();
            sums = sums.and(&shadowed.sums);
            uniform_error += shadowed.uniform_error;
            signal += shadowed.signal;
        }
        Ok(Some(Self {
            one_step: sums.one_step(),
            uniform_snr_db: 10.0 * (signal / uniform_error).log10(),
        }))
    }
}
