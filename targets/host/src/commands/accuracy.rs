//! How far fixed point is from floating point: in one step from the same state, and in the merits
//! of a closed loop.

use crate::cli::Failure;
use crate::closed_loop::{ClosedLoop, CurrentLoop, Measurement, Merits, RunOptions, measure};
use crate::engine::{Engine, Model, Prepared, SetPoint};
use crate::plant::{Plant, PlantParams, Truth};
use hexagen::{Legs, Sample};
use hexagen_reference::{BitTrue, Ideal};
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

/// The bit-true model in the loop, the ideal one beside it.
struct Beside {
    bit_true: BitTrue,
    ideal: Ideal,
    timer_period: f64,
    sums: Sums,
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

impl CurrentLoop for Beside {
    fn step(&mut self, sample: &Sample, _: &Truth) -> Legs {
        self.ideal.rebuild_from(&self.bit_true.physical_state());
        let legs = self.bit_true.step(sample);
        let duties = self.ideal.step(sample);
        let (found, exact) = (self.bit_true.trace(), *self.ideal.trace());
        if !found.run {
            return legs;
        }
        let sums = &mut self.sums;
        let same = found.sector_eff == exact.sector_eff
            && found.commutating == exact.commutating
            && found.reach == exact.reach
            && legs.state == duties.state;
        if !same {
            sums.other_decisions += 1;
            return legs;
        }
        sums.steps += 1;
        let phases = |u: [f64; 2]| [u[0], u[1], -u[0] - u[1]];
        for (found, exact) in phases(found.u_unsat).into_iter().zip(phases(exact.u_unsat)) {
            let error = (found - exact).abs();
            sums.u_largest = sums.u_largest.max(error);
            sums.u_error += error * error;
            sums.u_signal += exact * exact;
        }
        let rounded = duties.to_legs(self.timer_period as u16);
        for phase in 0..3 {
            let error =
                (f64::from(legs.compare[phase]) - duties.duty[phase] * self.timer_period).abs();
            sums.duty_largest = sums.duty_largest.max(error);
            sums.duty_error += error * error;
            sums.equal += u64::from(legs.compare[phase] == rounded.compare[phase]);
        }
        legs
    }
}

/// Measures one-step errors along closed loops of the bit-true model, start-up included.
///
/// # Errors
/// A plant parameter out of range.
pub fn one_step(
    drive: &Prepared,
    plant: &PlantParams,
    runs: &[RunOptions],
    set_point: SetPoint,
) -> Result<OneStep, Failure> {
    let mut total = Sums::default();
    for run in runs {
        let (settling, measured) = run.periods(plant);
        for &start in &run.starts {
            let (bit_true, ideal) = drive.references(set_point, true);
            let beside = Beside {
                bit_true,
                ideal,
                timer_period: f64::from(plant.timer_period),
                sums: total,
            };
            let motor = Plant::new(plant.clone(), start, run.omega_m)?;
            let mut closed = ClosedLoop::new(motor, beside, run.delay);
            closed.run(settling + measured, &mut ());
            total = closed.controller().sums;
        }
    }
    let values = 3.0 * total.steps as f64;
    Ok(OneStep {
        steps: total.steps,
        other_decisions: total.other_decisions,
        u_largest_v: total.u_largest,
        u_rms_v: (total.u_error / values).sqrt(),
        duty_largest_counts: total.duty_largest,
        duty_rms_counts: (total.duty_error / values).sqrt(),
        snr_db: 10.0 * (total.u_signal / total.u_error).log10(),
        equal_compares_pct: 100.0 * total.equal as f64 / values,
    })
}

/// The ideal model on the samples that the fixed-point drive read on its own plant, from the same
/// state at every step.
struct SameWords {
    bit_true: BitTrue,
    ideal: Ideal,
    samples: std::vec::IntoIter<Sample>,
}

impl CurrentLoop for SameWords {
    fn step(&mut self, sample: &Sample, _: &Truth) -> Legs {
        let words = self.samples.next().unwrap_or(*sample);
        self.ideal.rebuild_from(&self.bit_true.physical_state());
        self.bit_true.step(&words);
        self.ideal.step_legs(&words)
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

/// Measures the ideal model from the same starts, on the same ADC and Hall words and with the same
/// last samples and applied voltages as the fixed-point drive: what differs is arithmetic alone,
/// not the course that the last bit of an ADC gives to a loop of its own. (Left to itself on
/// foreign words, a model that estimates the EMF from its own voltages would drift away.)
///
/// # Errors
/// A plant parameter out of range.
pub fn ideal_on_same_words(
    drive: &Prepared,
    plant: &PlantParams,
    run: &RunOptions,
    set_point: SetPoint,
) -> Result<Measurement, Failure> {
    let (settling, measured) = run.periods(plant);
    let make = |initial: &Truth| {
        let (bit_true, ideal) = drive.references(set_point, false);
        let noting = Noting {
            engine: drive.engine(Model::Fixed, set_point),
            samples: Vec::with_capacity(settling + measured),
        };
        // The plant exists already for these parameters, so they are in range.
        let samples = Plant::new(plant.clone(), initial.theta_e, initial.omega_m)
            .map(|motor| {
                let mut closed = ClosedLoop::new(motor, noting, run.delay);
                closed.run(settling + measured, &mut ());
                std::mem::take(&mut closed.controller().samples)
            })
            .unwrap_or_default();
        SameWords {
            bit_true,
            ideal,
            samples: samples.into_iter(),
        }
    };
    Ok(measure(plant, run, make)?)
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
