//! Accuracy of fixed against floating point: errors of single steps, and figures of merit in closed
//! loop.

mod compare;
mod library;
mod one_step;
mod uniform;

pub use compare::{Accuracy, AtSpeed, Row, WORDS, accuracy, at_speeds, compare, with_word};
pub use library::{LAW, Library, LibraryRow, compare_library};
pub use one_step::{BINS, Compared, OneStep};
pub use uniform::{Uniform16, uniform_format};

use crate::LabError;
use crate::closed_loop::{
    ClosedLoop, CurrentLoop, FiguresOfMerit, Measurement, RunOptions, Trace, Trip, percent,
    share_of_allowance,
};
use crate::engine::{Engine, Model, Prepared, SetPoint};
use crate::plant::{Plant, PlantError, PlantParams, Truth};
use hexagen::{Fault, Sample};
use hexagen_codegen::spec::Reference;
use hexagen_reference::{AnyCommand, BitTrue, Ideal};
use one_step::{Step, Sums};
use rayon::prelude::*;
use serde::Serialize;

/// The ideal model on the fixed-point drive's samples, starting every step from the drive's state.
struct SameWords {
    bit_true: BitTrue,
    ideal: Ideal,
    samples: std::vec::IntoIter<Sample>,
    timer_period: u16,
    sums: Sums,
}

impl CurrentLoop for SameWords {
    fn step(&mut self, sample: &Sample, _: &Truth) -> AnyCommand {
        let words = self.samples.next().unwrap_or(*sample);
        let before = self.bit_true.physical_state();
        self.ideal.rebuild_from(&before);
        let command = self.bit_true.step(&words);
        let duties = self.ideal.step(&words);
        let step = Step::of(&before, (&self.bit_true, command), (&self.ideal, duties));
        self.sums.add(&step, self.timer_period);
        duties.to_command(self.timer_period)
    }

    /// Follows the drive into a trip, too.
    fn fault(&self) -> Option<Fault> {
        self.bit_true.fault()
    }
}

/// A drive that records its samples.
struct Noting<'g> {
    engine: Engine<'g>,
    samples: Vec<Sample>,
}

impl CurrentLoop for Noting<'_> {
    fn step(&mut self, sample: &Sample, truth: &Truth) -> AnyCommand {
        self.samples.push(*sample);
        self.engine.step(sample, truth)
    }

    fn fault(&self) -> Option<Fault> {
        self.engine.fault()
    }
}

/// The fixed-point drive, and the ideal model on its samples.
#[derive(Clone, Debug)]
pub struct SideBySide {
    /// The fixed-point drive in its own closed loop.
    pub fixed: Measurement,
    /// The ideal model on its own plant, from the same starts.
    pub ideal: Measurement,
    sums: Sums,
}

/// Errors of single steps along a measured run, start-up included, and their histogram: [`BINS`]
/// equal parts of the range from the negative to the positive bound.
pub fn one_step<'a>(
    drive: &Prepared,
    measured: impl IntoIterator<Item = &'a SideBySide>,
) -> (OneStep, Vec<u64>) {
    let none = Sums::new(Compared::of(drive));
    let parts = measured.into_iter();
    let total = parts.fold(none, |sum, part| sum.and(&part.sums));
    (total.one_step(), total.histogram())
}

/// Measures the fixed-point drive, and the ideal model from the same starts, with the same ADC
/// counts, Hall codes and applied voltages, so that only arithmetic differs: in a loop of its own,
/// one ADC count can lead to another trajectory. (Without the applied voltages, a model with an EMF
/// estimator would drift away.)
///
/// # Errors
/// A plant parameter out of range.
pub fn side_by_side(
    drive: &Prepared,
    plant: &PlantParams,
    run: &RunOptions,
    set_point: SetPoint,
) -> Result<SideBySide, LabError> {
    let (settling, measured) = run.periods(plant);
    let none = Sums::new(Compared::of(drive));
    let starts = run.starts.par_iter().map(|&start| {
        let motor = Plant::new(plant.clone(), start, run.omega_m)?;
        let noting = Noting {
            engine: drive.engine(Model::Fixed, set_point),
            samples: Vec::with_capacity(settling + measured),
        };
        let (fixed, fixed_trip, noting) = settled(motor.clone(), noting, run, settling, measured);
        let (bit_true, ideal) = drive.references(set_point);
        let same_words = SameWords {
            bit_true,
            ideal,
            samples: noting.samples.into_iter(),
            timer_period: plant.timer_period,
            sums: none.clone(),
        };
        let (ideal, ideal_trip, same_words) = settled(motor, same_words, run, settling, measured);
        Ok(((fixed, fixed_trip), (ideal, ideal_trip), same_words.sums))
    });
    let starts = starts.collect::<Result<Vec<_>, PlantError>>()?;
    let sums = starts
        .iter()
        .fold(none.clone(), |sum, start| sum.and(&start.2));
    let (fixed, ideal): (Vec<_>, Vec<_>) = starts.into_iter().map(|(f, i, _)| (f, i)).unzip();
    let measurement = |starts: Vec<(Trace, Option<Trip>)>| {
        let (traces, trips): (Vec<_>, Vec<_>) = starts.into_iter().unzip();
        Measurement::of(traces, trips.into_iter().flatten().next(), run)
    };
    Ok(SideBySide {
        fixed: measurement(fixed),
        ideal: measurement(ideal),
        sums,
    })
}

/// Settles a loop and records its measured window; returns the trip and the controller, too.
fn settled<C: CurrentLoop>(
    motor: Plant,
    controller: C,
    run: &RunOptions,
    settling: usize,
    measured: usize,
) -> (Trace, Option<Trip>, C) {
    let mut closed = ClosedLoop::new(motor, controller, run.delay);
    closed.run(settling, &mut ());
    let mut trace = Trace::of_run(closed.plant(), run, measured);
    closed.run(measured, &mut trace);
    (trace, closed.tripped(), closed.into_controller())
}

/// A figure of merit of the fixed-point drive and of the ideal model.
#[derive(Clone, Debug, Serialize)]
pub struct FigureDifference {
    /// The figure of merit.
    pub figure: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Of the fixed-point drive; null if undefined, as after a trip.
    pub fixed: Option<f64>,
    /// Of the ideal model on the same samples.
    pub ideal: Option<f64>,
    /// Of the ideal model in its own closed loop.
    pub ideal_alone: Option<f64>,
    /// Difference between `fixed` and `ideal`, relative to the tolerance: 0.5 %, or 0.05 points for
    /// percentages; infinite (in JSON null) if only one exists or `ideal` alone is zero.
    pub of_allowance: f64,
    /// Whether the difference is at most 1.
    pub close: bool,
}

impl FigureDifference {
    /// The difference to the ideal model on the same samples, with its unit: points for percentages, else percent.
    pub fn text(&self) -> String {
        self.text_against(self.ideal)
    }

    /// The difference between the two closed loops, relative to the tolerance and as [`Self::text`] says it.
    pub fn in_closed_loop(&self) -> (f64, String) {
        let share = share_of_allowance(self.fixed, self.ideal_alone, self.unit == "%");
        (share, self.text_against(self.ideal_alone))
    }

    fn text_against(&self, ideal: Option<f64>) -> String {
        let both = self.fixed.zip(ideal);
        let (value, unit) = match both.map(|(fixed, ideal)| ((fixed - ideal).abs(), ideal)) {
            None => (None, if self.unit == "%" { "points" } else { "%" }),
            Some((distance, _)) if self.unit == "%" => (Some(distance), "points"),
            Some((0.0, _)) => (Some(0.0), "%"),
            Some((distance, ideal)) => (percent(distance, ideal, 0.0), "%"),
        };
        format!("{} {unit}", crate::text::significant(value, 2))
    }
}

/// Compares figures of merit one by one, those that belong to a drive whose current has this shape.
pub fn differences(
    reference: Reference,
    fixed: &FiguresOfMerit,
    ideal: &FiguresOfMerit,
    alone: &FiguresOfMerit,
) -> Vec<FigureDifference> {
    let rows = |of: &FiguresOfMerit| of.rows_of(reference);
    rows(fixed)
        .zip(rows(ideal).zip(rows(alone)))
        .map(
            |((figure, fixed, unit), ((_, ideal, _), (_, ideal_alone, _)))| {
                let of_allowance = share_of_allowance(fixed, ideal, unit == "%");
                FigureDifference {
                    figure,
                    unit,
                    fixed,
                    ideal,
                    ideal_alone,
                    of_allowance,
                    close: of_allowance <= 1.0,
                }
            },
        )
        .collect()
}
