//! How far fixed point is from floating point: in one step from the same state, and in the merits
//! of a closed loop.

use crate::cli::Failure;
use crate::closed_loop::{ClosedLoop, CurrentLoop, Measurement, Merits, RunOptions, Trace};
use crate::engine::{Engine, Model, Prepared, SetPoint};
use crate::plant::{Plant, PlantError, PlantParams, Truth};
use hexagen::{Legs, Sample};
use hexagen_reference::{BitTrue, Duties, Ideal};
use rayon::prelude::*;
use serde::Serialize;

/// Distance of the bit-true from the ideal model after one step from the same state and sample.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct OneStep {
    /// Steps that were compared: in control, and with the same decisions in both.
    pub steps: u64,
    /// Steps on which the two decided differently (sector, commutation, reach, leg states): a tie
    /// that rounding broke.
    pub other_decisions: u64,
    /// Largest distance of a phase's deadbeat voltage before limiting, volt.
    pub u_largest_v: f64,
    /// Root mean square of the same, volt.
    pub u_rms_v: f64,
    /// Largest distance of a compare value from the exact duty, timer counts; its own rounding
    /// makes up to half a count.
    pub duty_largest_counts: f64,
    /// Root mean square of the same, timer counts.
    pub duty_rms_counts: f64,
    /// Deadbeat voltage over its error, decibel.
    pub snr_db: f64,
    /// Share of compare values equal to the ideal ones after rounding, percent.
    pub equal_compares_pct: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    steps: u64,
    other_decisions: u64,
    u_largest: f64,
    u_error: f64,
    u_signal: f64,
    duty_largest: f64,
    duty_error: f64,
    equal: u64,
}

impl Sums {
    /// Takes in a step of both models from the same state.
    fn add(&mut self, found: &BitTrue, legs: &Legs, exact: &Ideal, duties: &Duties, period: u16) {
        let (found, exact) = (found.trace(), *exact.trace());
        if !found.run {
            return;
        }
        let same = found.sector_eff == exact.sector_eff
            && found.commutating == exact.commutating
            && found.reach == exact.reach
            && legs.state == duties.state;
        if !same {
            self.other_decisions += 1;
            return;
        }
        self.steps += 1;
        let phases = |u: [f64; 2]| [u[0], u[1], -u[0] - u[1]];
        for (found, exact) in phases(found.u_unsat).into_iter().zip(phases(exact.u_unsat)) {
            let error = (found - exact).abs();
            self.u_largest = self.u_largest.max(error);
            self.u_error += error * error;
            self.u_signal += exact * exact;
        }
        let rounded = duties.to_legs(period);
        for phase in 0..3 {
            let exact = duties.duty[phase] * f64::from(period);
            let error = (f64::from(legs.compare[phase]) - exact).abs();
            self.duty_largest = self.duty_largest.max(error);
            self.duty_error += error * error;
            self.equal += u64::from(legs.compare[phase] == rounded.compare[phase]);
        }
    }

    /// Both together.
    fn and(&self, other: &Self) -> Self {
        Self {
            steps: self.steps + other.steps,
            other_decisions: self.other_decisions + other.other_decisions,
            u_largest: self.u_largest.max(other.u_largest),
            u_error: self.u_error + other.u_error,
            u_signal: self.u_signal + other.u_signal,
            duty_largest: self.duty_largest.max(other.duty_largest),
            duty_error: self.duty_error + other.duty_error,
            equal: self.equal + other.equal,
        }
    }
}

/// The ideal model on the samples that the fixed-point drive read on its own plant, from the same
/// state at every step.
struct SameWords {
    bit_true: BitTrue,
    ideal: Ideal,
    samples: std::vec::IntoIter<Sample>,
    timer_period: u16,
    sums: Sums,
}

impl CurrentLoop for SameWords {
    fn step(&mut self, sample: &Sample, _: &Truth) -> Legs {
        let words = self.samples.next().unwrap_or(*sample);
        self.ideal.rebuild_from(&self.bit_true.physical_state());
        let legs = self.bit_true.step(&words);
        let duties = self.ideal.step(&words);
        let (sums, period) = (&mut self.sums, self.timer_period);
        sums.add(&self.bit_true, &legs, &self.ideal, &duties, period);
        duties.to_legs(period)
    }
}

/// A drive that notes what it reads.
struct Noting<'g> {
    engine: Engine<'g>,
    samples: Vec<Sample>,
}

impl CurrentLoop for Noting<'_> {
    fn step(&mut self, sample: &Sample, truth: &Truth) -> Legs {
        self.samples.push(*sample);
        self.engine.step(sample, truth)
    }
}

/// The fixed-point drive and the ideal model on the words that it read.
#[derive(Clone, Debug)]
pub struct SideBySide {
    /// The fixed-point drive in its own loop.
    pub fixed: Measurement,
    /// The ideal model on its own plant, from the same starts.
    pub ideal: Measurement,
    sums: Sums,
}

impl SideBySide {
    /// The distance of single steps over several measurements, start-up included.
    pub fn one_step<'a>(measured: impl IntoIterator<Item = &'a Self>) -> OneStep {
        let none = Sums::default();
        let all = measured.into_iter();
        let total = all.fold(none, |sum, part| sum.and(&part.sums));
        let values = 3.0 * total.steps as f64;
        OneStep {
            steps: total.steps,
            other_decisions: total.other_decisions,
            u_largest_v: total.u_largest,
            u_rms_v: (total.u_error / values).sqrt(),
            duty_largest_counts: total.duty_largest,
            duty_rms_counts: (total.duty_error / values).sqrt(),
            snr_db: 10.0 * (total.u_signal / total.u_error).log10(),
            equal_compares_pct: 100.0 * total.equal as f64 / values,
        }
    }
}

/// Measures the fixed-point drive, and the ideal model from the same starts, on the same ADC and
/// Hall words and with the same last samples and applied voltages: what differs is arithmetic
/// alone, not the course that the last bit of an ADC gives to a loop of its own. (Left to itself on
/// foreign words, a model that estimates the EMF from its own voltages would drift away.)
///
/// # Errors
/// A plant parameter out of range.
pub fn side_by_side(
    drive: &Prepared,
    plant: &PlantParams,
    run: &RunOptions,
    set_point: SetPoint,
) -> Result<SideBySide, Failure> {
    let (settling, measured) = run.periods(plant);
    let starts = run.starts.par_iter().map(|&start| {
        let motor = Plant::new(plant.clone(), start, run.omega_m)?;
        let noting = Noting {
            engine: drive.engine(Model::Fixed, set_point),
            samples: Vec::with_capacity(settling + measured),
        };
        let (fixed, noting) = settled(motor.clone(), noting, run, settling, measured);
        let (bit_true, ideal) = drive.references(set_point, true);
        let same_words = SameWords {
            bit_true,
            ideal,
            samples: noting.samples.into_iter(),
            timer_period: plant.timer_period,
            sums: Sums::default(),
        };
        let (ideal, same_words) = settled(motor, same_words, run, settling, measured);
        Ok((fixed, ideal, same_words.sums))
    });
    let starts = starts.collect::<Result<Vec<_>, PlantError>>()?;
    let sums = starts
        .iter()
        .fold(Sums::default(), |sum, start| sum.and(&start.2));
    let (fixed, ideal) = starts.into_iter().map(|(f, i, _)| (f, i)).unzip();
    Ok(SideBySide {
        fixed: Measurement::of(fixed, run),
        ideal: Measurement::of(ideal, run),
        sums,
    })
}

/// Settles a loop and records its measured window; gives the controller back.
fn settled<C: CurrentLoop>(
    motor: Plant,
    controller: C,
    run: &RunOptions,
    settling: usize,
    measured: usize,
) -> (Trace, C) {
    let mut closed = ClosedLoop::new(motor, controller, run.delay);
    closed.run(settling, &mut ());
    let mut trace = Trace::new(closed.plant(), measured);
    closed.run(measured, &mut trace);
    (trace, closed.into_controller())
}

/// A merit of the fixed-point drive beside the ideal model's.
#[derive(Clone, Debug, Serialize)]
pub struct MeritDifference {
    /// The merit.
    pub merit: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Of the fixed-point drive.
    pub fixed: f64,
    /// Of the ideal model on the same words.
    pub ideal: f64,
    /// Of the ideal model in a loop of its own.
    pub ideal_alone: f64,
    /// Whether `fixed` and `ideal` differ by less than 1 %, or 0.05 points where the unit is %.
    pub close: bool,
}

/// Largest relative difference that counts as close.
const RELATIVE: f64 = 0.01;

/// Largest difference in points that counts as close.
const POINTS: f64 = 0.05;

/// Compares merits one by one.
pub fn differences(fixed: &Merits, ideal: &Merits, alone: &Merits) -> Vec<MeritDifference> {
    let rows = super::simulate::rows;
    rows(fixed)
        .into_iter()
        .zip(rows(ideal).into_iter().zip(rows(alone)))
        .map(
            |((merit, fixed, unit), ((_, ideal, _), (_, ideal_alone, _)))| {
                let distance = (fixed - ideal).abs();
                // Merits that do not exist (percent of a zero torque) agree when both do not.
                let close = distance <= RELATIVE * ideal.abs()
                    || unit == "%" && distance <= POINTS
                    || fixed.is_nan() && ideal.is_nan();
                MeritDifference {
                    merit,
                    unit,
                    fixed,
                    ideal,
                    ideal_alone,
                    close,
                }
            },
        )
        .collect()
}
