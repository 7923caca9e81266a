//! The variants of the result table: what is run for each of them.
//!
//! The rows are those of the design document; for other motors than the paper's the same variants
//! run with the generator's own discretisation, and nothing is expected of them.

use super::accuracy::{OneStep, one_step};
use crate::cli::{Emit, Failure};
use crate::closed_loop::{LimitOptions, RunOptions, measure, speed_limit};
use crate::engine::{Model, Prepared, SetPoint, plant_of, run_of};
use crate::plant::PlantParams;
use crate::report::{
    Capture, DesignRow, Expected, GeneratedTexts, Parameter, Record, Run, RunPoint, SignalError,
    Stability, StabilityCheck, Variant,
};
use hexagen_codegen::controllers::ControllerSpec;
use hexagen_codegen::controllers::pdcc::{EmfSource, PdccDesign, StableRange};
use hexagen_codegen::emit::datasheet::emit_datasheet;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Speeds of the result table, in parts of rated speed.
pub const SPEEDS: [f64; 2] = [0.2, 0.75];

/// True over stated inductance or resistance of the runs that check the stable range.
const OFF_INDUCTANCE: [f64; 8] = [0.7, 0.75, 0.78, 0.85, 1.2, 1.25, 1.28, 1.3];
const OFF_RESISTANCE: [f64; 4] = [0.2, 0.5, 2.0, 5.0];

/// Their speed in parts of rated speed: so low that commutations, which wrong parameters disturb
/// in stable loops, too, take no share of the ripple.
const STABILITY_SPEED: f64 = 0.02;

/// RMS ripple, in percent of the mean torque, above which such a run counts as unstable. A stable
/// loop stays below 1 there; an unstable one swings between the limits of voltage at 3 and more.
pub const UNSTABLE_RIPPLE: f64 = 2.0;

/// One row of the table before it runs: the same variant with both ways of reading Hall edges.
#[derive(Debug)]
pub struct Planned {
    /// The row of the design document.
    pub row: DesignRow,
    /// Drive with captured edges.
    pub timer: Prepared,
    /// Drive with sampled edges.
    pub sampled: Prepared,
    /// Whether the design document's figures are about this motor.
    pub is_expected: bool,
}

/// A model with a way of reading Hall edges: one line of the table.
struct Line<'p> {
    drive: &'p Prepared,
    model: Model,
    capture: Capture,
    expected: Option<Expected>,
}

impl Planned {
    /// Runs every line of the row at rated torque, and what the page shows of it besides.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn run(&self, shows_texts: bool) -> Result<Variant, Failure> {
        let lines = self.lines();
        let runs = lines
            .par_iter()
            .map(Line::run)
            .collect::<Result<Vec<_>, _>>()?;
        let drive = &self.timer;
        let conditions = Conditions::of(drive);
        let records = SPEEDS
            .par_iter()
            .filter_map(|part| {
                let record = conditions.record(drive, part * drive.rated_rpm());
                record.transpose()
            })
            .collect::<Result<Vec<_>, _>>()?;
        let torque_speed = runs
            .first()
            .and_then(|run| run.limit.as_ref())
            .map(|limit| limit.curve.clone())
            .unwrap_or_default();
        Ok(Variant {
            label: format!("PDCC {}", self.row.label),
            variant: self.timer.variant.clone(),
            runs,
            records,
            torque_speed,
            signal_errors: conditions.signal_errors(drive)?,
            stability: conditions.stability(drive)?,
            generated: shows_texts.then(|| texts(drive)),
        })
    }

    fn lines(&self) -> Vec<Line<'_>> {
        let timer = self.is_expected.then(|| self.row.timer.clone());
        let sampled = self.row.sampled.clone().filter(|_| self.is_expected);
        [
            (Model::Fixed, Capture::Timer),
            (Model::Ideal, Capture::Timer),
            (Model::Fixed, Capture::Sampled),
            (Model::Ideal, Capture::Sampled),
        ]
        .into_iter()
        .map(|(model, capture)| {
            let (drive, expected) = match capture {
                Capture::Timer => (&self.timer, &timer),
                Capture::Sampled => (&self.sampled, &sampled),
            };
            Line {
                drive,
                model,
                capture,
                expected: expected.clone().filter(|_| model == Model::Fixed),
            }
        })
        .collect()
    }
}

impl Line<'_> {
    fn run(&self) -> Result<Run, Failure> {
        let conditions = Conditions::of(self.drive);
        let maker = || self.drive.maker(self.model, conditions.set_point);
        let points = SPEEDS
            .par_iter()
            .map(|part| {
                let rpm = part * self.drive.rated_rpm();
                let run = conditions.at(self.drive, rpm);
                let merits = measure(&conditions.plant, &run, maker())?.merits;
                Ok(RunPoint { rpm, merits })
            })
            .collect::<Result<Vec<_>, Failure>>()?;
        let scan = LimitOptions::new(self.drive.rated_rpm(), conditions.torque);
        let run = conditions.at(self.drive, self.drive.rated_rpm());
        let limit = speed_limit(&conditions.plant, &run, &scan, maker())?;
        Ok(Run {
            model: match self.model {
                Model::Fixed => crate::report::Model::Fixed,
                Model::BitTrue => crate::report::Model::BitTrue,
                Model::Ideal => crate::report::Model::Ideal,
            },
            capture: self.capture,
            points,
            limit: Some(limit),
            expected: self.expected.clone(),
        })
    }
}

/// The plant as specified and the demand of rated torque.
struct Conditions {
    plant: PlantParams,
    torque: f64,
    set_point: SetPoint,
}

impl Conditions {
    fn of(drive: &Prepared) -> Self {
        let torque = drive.rated_torque();
        Self {
            plant: plant_of(&drive.spec),
            torque,
            set_point: SetPoint {
                current: torque / drive.spec.torque_constant(),
                v_bus: drive.spec.inverter.v_bus,
            },
        }
    }

    fn at(&self, drive: &Prepared, rpm: f64) -> RunOptions {
        run_of(&drive.spec, rpm * TAU / 60.0, self.torque)
    }

    /// The measured window of the first start at a speed.
    fn record(&self, drive: &Prepared, rpm: f64) -> Result<Option<Record>, Failure> {
        let mut run = self.at(drive, rpm);
        run.starts.truncate(1);
        let measured = measure(&self.plant, &run, drive.maker(Model::Fixed, self.set_point))?;
        let trace = measured.traces.into_iter().next();
        Ok(trace.map(|trace| Record { rpm, trace }))
    }

    fn signal_errors(&self, drive: &Prepared) -> Result<Vec<SignalError>, Failure> {
        let runs = SPEEDS.map(|part| self.at(drive, part * drive.rated_rpm()));
        let OneStep {
            u_largest_v,
            u_rms_v,
            duty_largest_counts,
            duty_rms_counts,
            ..
        } = one_step(drive, &self.plant, &runs, self.set_point)?;
        let error = |signal: &str, unit: &str, largest, rms| SignalError {
            signal: signal.to_owned(),
            unit: unit.to_owned(),
            largest,
            rms,
            bound: None,
        };
        Ok(vec![
            error("u_unsat", "V", u_largest_v, u_rms_v),
            error("compare", "counts", duty_largest_counts, duty_rms_counts),
        ])
    }

    /// The stable range and runs on both sides of its edges, for loops that have one.
    fn stability(&self, drive: &Prepared) -> Result<Option<Stability>, Failure> {
        let ControllerSpec::Pdcc(options) = &drive.spec.controller;
        if options.emf != EmfSource::Estimated {
            return Ok(None);
        }
        let design = PdccDesign::new(&drive.spec, options);
        let range = StableRange {
            inductance: design.stable_inductance(&drive.spec, options),
            resistance: design.stable_resistance(&drive.spec, options),
        };
        let runs = OFF_INDUCTANCE
            .map(|factor| (Parameter::Inductance, factor))
            .into_iter()
            .chain(OFF_RESISTANCE.map(|factor| (Parameter::Resistance, factor)))
            .collect::<Vec<_>>();
        let rpm = STABILITY_SPEED * drive.rated_rpm();
        let mut run = self.at(drive, rpm);
        run.starts.truncate(1);
        let checks = runs
            .into_par_iter()
            .map(|(parameter, factor)| {
                let plant = match parameter {
                    Parameter::Inductance => self.plant.clone().scaled(1.0, factor, 1.0),
                    Parameter::Resistance => self.plant.clone().scaled(factor, 1.0, 1.0),
                };
                let maker = drive.maker(Model::Fixed, self.set_point);
                let merits = measure(&plant, &run, maker)?.merits;
                Ok(StabilityCheck {
                    parameter,
                    factor,
                    rpm,
                    ripple_rms_pct: merits.ripple_rms_pct,
                    stable: merits.ripple_rms_pct < UNSTABLE_RIPPLE,
                })
            })
            .collect::<Result<Vec<_>, Failure>>()?;
        Ok(Some(Stability { range, checks }))
    }
}

/// The data sheet of a drive, in Markdown.
pub fn data_sheet(drive: &Prepared) -> String {
    emit_datasheet(&drive.generated.graph, &drive.generated.interface)
}

fn texts(drive: &Prepared) -> GeneratedTexts {
    let interface = &drive.generated.interface;
    GeneratedTexts {
        formats: interface.formats.clone(),
        rust: super::generate::text_of(drive, Emit::Rust),
        data_sheet: data_sheet(drive),
        spec_toml: interface.spec_toml.clone(),
    }
}
