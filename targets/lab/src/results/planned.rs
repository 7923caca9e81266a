//! The variants of the result table, with their runs.
//!
//! The rows are those of the design document; for motors other than the paper's, the same variants
//! run with the generator's default discretisation, without expectations.

use super::{
    Capture, DesignRow, Expected, GeneratedTexts, Record, Run, RunPoint, SPEEDS, SameWords,
    SignalError, Variant,
};
use crate::LabError;
use crate::accuracy::{OneStep, SideBySide, one_step, side_by_side};
use crate::closed_loop::{
    Held, LimitOptions, Measurement, RunOptions, measure, speed_limit_knowing,
};
use crate::engine::{Model, Prepared, SetPoint, plant_of, run_of};
use crate::plant::PlantParams;
use crate::stability;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// One row of the table before it runs: the same variant with each Hall capture.
#[derive(Debug)]
pub struct Planned {
    /// The row of the design document.
    pub row: DesignRow,
    /// A drive for each Hall capture that the motor's file allows, the best first; at least one.
    pub drives: Vec<(Capture, Prepared)>,
    /// Whether the design document's figures are for this motor.
    pub is_expected: bool,
}

/// A model with a Hall capture: one line of the table.
struct Line<'p> {
    drive: &'p Prepared,
    model: Model,
    capture: Capture,
    expected: Option<Expected>,
    held: Held,
}

/// Results of one Hall capture at the table's speeds.
struct AtSpeeds {
    /// The fixed-point drive, and the ideal model on its samples.
    both: Vec<SideBySide>,
    /// The ideal model in its own closed loop.
    alone: Vec<Measurement>,
}

impl AtSpeeds {
    fn measure(drive: &Prepared) -> Result<Self, LabError> {
        let conditions = Conditions::of(drive);
        let measured = SPEEDS.par_iter().map(|part| {
            let run = conditions.at(drive, part * drive.rated_rpm());
            let (plant, set_point) = (&conditions.plant, conditions.set_point);
            let both = side_by_side(drive, plant, &run, set_point)?;
            let alone = measure(plant, &run, drive.maker(Model::Ideal, set_point))?;
            Ok((both, alone))
        });
        let measured = measured.collect::<Result<Vec<_>, LabError>>()?;
        let (both, alone) = measured.into_iter().unzip();
        Ok(Self { both, alone })
    }

    /// Results of a model in its own closed loop, at each speed.
    fn points(&self, drive: &Prepared, model: Model) -> Vec<RunPoint> {
        let of_model: Vec<&Measurement> = match model {
            Model::Ideal => self.alone.iter().collect(),
            Model::Fixed | Model::BitTrue => self.both.iter().map(|both| &both.fixed).collect(),
        };
        let at_speeds = SPEEDS.into_iter().zip(of_model);
        at_speeds
            .map(|(part, measured)| RunPoint {
                rpm: part * drive.rated_rpm(),
                figures: measured.figures,
                tripped: measured.tripped,
            })
            .collect()
    }
}

impl Planned {
    /// Runs every line of the row at rated torque, and the further contents of the page. `shown`: the drive whose code
    /// and data sheet are to be shown beside the row.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn run(&self, shown: Option<&Prepared>) -> Result<Variant, LabError> {
        let measured = self
            .drives
            .par_iter()
            .map(|(_, drive)| AtSpeeds::measure(drive))
            .collect::<Result<Vec<_>, _>>()?;
        let lines: Vec<(Line, &AtSpeeds)> = self
            .drives
            .iter()
            .zip(&measured)
            .flat_map(|((capture, drive), at)| {
                [Model::Fixed, Model::Ideal].map(|model| (self.line(model, *capture, drive), at))
            })
            .collect();
        let runs = lines
            .par_iter()
            .map(|(line, at)| line.run(at.points(line.drive, line.model)))
            .collect::<Result<Vec<_>, _>>()?;
        let drive = self.best();
        let rpm = SPEEDS.map(|part| part * drive.rated_rpm());
        let same_words = self.drives.iter().zip(&measured);
        let same_words = same_words.flat_map(|((capture, _), at)| {
            rpm.iter().zip(&at.both).map(|(rpm, both)| SameWords {
                capture: *capture,
                rpm: *rpm,
                fixed: both.fixed.figures,
                ideal: both.ideal.figures,
            })
        });
        let same_words = same_words.collect();
        let torque_speed = runs
            .first()
            .and_then(|run| run.limit.as_ref())
            .map(|limit| limit.curve.clone())
            .unwrap_or_default();
        let of_best = measured.into_iter().next().map(|at| at.both);
        let of_best = of_best.unwrap_or_default();
        let signal_errors = signal_errors(drive, &of_best);
        let running = rpm.into_iter().zip(of_best);
        let running = running.filter(|(_, both)| both.fixed.tripped.is_none());
        let records = running.filter_map(|(rpm, both)| {
            let trace = both.fixed.traces.into_iter().next()?;
            Some(Record { rpm, trace })
        });
        Ok(Variant {
            label: self.row.label.to_owned(),
            variant: drive.variant.clone(),
            chooses_vectors: !drive.spec.controller.modulates(),
            runs,
            records: records.filter(|_| self.row.is_plotted).collect(),
            torque_speed,
            reach: self.reach(),
            reference: drive.spec.controller.common().reference,
            set_point: drive.set_point(drive.demand()).current,
            same_words,
            signal_errors,
            stability: stability::checked(drive)?,
            generated: shown.map(texts),
        })
    }

    /// The torque of the row's measurement, if its set-point limit is below the rated one.
    pub fn reach(&self) -> Option<f64> {
        let (demand, rated) = (self.best().demand(), self.best().rated_torque());
        (demand < rated * (1.0 - 1e-9)).then_some(demand)
    }

    /// The drive with the best Hall capture.
    pub fn best(&self) -> &Prepared {
        &self.drives[0].1
    }

    fn line<'p>(&self, model: Model, capture: Capture, drive: &'p Prepared) -> Line<'p> {
        let expected = match capture {
            Capture::Timer => Some(self.row.timer.clone()),
            Capture::Sampled => self.row.sampled.clone(),
            Capture::Angle => None,
        };
        Line {
            drive,
            model,
            capture,
            expected: expected.filter(|_| self.is_expected && model == Model::Fixed),
            held: held(self.is_expected),
        }
    }
}

/// Criterion of a held torque for the limits of a table: the design document's, if compared with
/// it.
pub fn held(is_expected: bool) -> Held {
    if is_expected {
        Held::AtLeast
    } else {
        Held::Within
    }
}

impl Line<'_> {
    /// Finds the limit; `points` are those at the table's speeds.
    fn run(&self, points: Vec<RunPoint>) -> Result<Run, LabError> {
        let conditions = Conditions::of(self.drive);
        let known: Vec<(f64, f64)> = points
            .iter()
            .filter_map(|point| Some((point.rpm, point.figures.mean_torque_nm?)))
            .collect();
        let scan = LimitOptions {
            held: self.held,
            ..LimitOptions::new(self.drive.rated_rpm(), conditions.torque)
        };
        let run = conditions.at(self.drive, self.drive.rated_rpm());
        let maker = self.drive.maker(self.model, conditions.set_point);
        let limit = speed_limit_knowing(&conditions.plant, &run, &scan, &known, maker)?;
        Ok(Run {
            model: self.model,
            capture: self.capture,
            points,
            limit: Some(limit),
            expected: self.expected.clone(),
        })
    }
}

/// Errors of single steps along the measured runs.
fn signal_errors(drive: &Prepared, measured: &[SideBySide]) -> Vec<SignalError> {
    let (found, _) = one_step(drive, measured);
    let OneStep {
        largest_v,
        bound_v,
        rms_v,
        duty_rms_counts,
        ..
    } = found;
    let largest_counts = found.duty_largest_counts.max(found.duty_limited_counts);
    let bound_counts = found.duty_bound_counts.max(found.duty_limited_bound_counts);
    let error = |signal: &str, unit: &str, [largest, rms]: [f64; 2], bound| SignalError {
        signal: signal.to_owned(),
        unit: unit.to_owned(),
        largest,
        rms,
        bound,
    };
    vec![
        error("u_unsat", "V", [largest_v, rms_v], Some(bound_v)),
        error(
            "compare",
            "counts",
            [largest_counts, duty_rms_counts],
            bound_counts.is_finite().then_some(bound_counts),
        ),
    ]
}

/// The nominal plant and the demand of rated torque.
struct Conditions {
    plant: PlantParams,
    torque: f64,
    set_point: SetPoint,
}

impl Conditions {
    fn of(drive: &Prepared) -> Self {
        let torque = drive.demand();
        Self {
            plant: plant_of(&drive.spec),
            torque,
            set_point: drive.set_point(torque),
        }
    }

    fn at(&self, drive: &Prepared, rpm: f64) -> RunOptions {
        run_of(&drive.spec, rpm * TAU / 60.0, self.torque)
    }
}

fn texts(drive: &Prepared) -> GeneratedTexts {
    let interface = &drive.generated.interface;
    GeneratedTexts {
        formats: interface.formats.clone(),
        rust: drive.rust(),
        data_sheet: drive.data_sheet(),
        spec_toml: interface.spec_toml.clone(),
    }
}
