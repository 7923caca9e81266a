//! Every controller in closed loop on plants that deviate from the motor file.
//!
//! Drives are generated for the motor file; only the plant changes. (The ADC resolution is an
//! exception: it changes the drive, too.)

use super::disturbance::{Disturbance, disturbances};
use super::{Cell, Column, Measured, Robustness};
use crate::closed_loop::{RunOptions, measure, voltage_swing};
use crate::engine::{Model, PlantOptions, Prepared, SelectedMotor, SetPoint};
use crate::plant::PlantParams;
use crate::results::SPEEDS;
use crate::{LabError, Progress};
use rayon::prelude::*;

/// Runs every variant under every disturbance.
///
/// # Errors
/// No such motor, no valid variant, or a plant option out of range. A single disturbance that is
/// impossible for this motor is a cell with the reason.
pub fn robustness(
    motor: &str,
    variants: &[String],
    undisturbed: &PlantOptions,
    progress: &dyn Progress,
) -> Result<Robustness, LabError> {
    if undisturbed.inertia.is_some() {
        return Err(LabError::FreeShaft);
    }
    let drive = first_that_generates(&SelectedMotor::find(motor, undisturbed)?, variants)?;
    undisturbed.plant(&drive)?;
    let disturbances = disturbances(undisturbed, &drive.spec.inverter);
    // Syntax trees cannot be sent to other threads: drives are prepared here.
    let motors = motors(motor, &disturbances)?;
    let drives: Vec<Drives> = variants
        .iter()
        .map(|variant| Drives::prepare(&motors, variant))
        .collect();
    let sheet = Sheet {
        speeds_rpm: SPEEDS.map(|part| part * drive.rated_rpm()),
        disturbances,
        progress,
    };
    let cells = variants.len() * sheet.places().count();
    progress.begin("disturbing", cells as u64);
    let controllers = drives.par_iter().map(|drives| sheet.column(drives));
    let controllers = controllers.collect();
    Ok(Robustness {
        speeds_rpm: sheet.speeds_rpm.to_vec(),
        disturbances: sheet
            .disturbances
            .into_iter()
            .map(|disturbance| disturbance.name)
            .collect(),
        controllers,
    })
}

/// The drive of the first valid variant.
///
/// # Errors
/// All diagnostics of the first variant, if none is valid.
fn first_that_generates(motor: &SelectedMotor, variants: &[String]) -> Result<Prepared, LabError> {
    let mut reason = None;
    for variant in variants {
        match motor.prepare_for_torque(Some(variant)) {
            Ok(drive) => return Ok(drive),
            Err(failure) => reason = reason.or(Some(failure)),
        }
    }
    Err(reason.unwrap_or_else(|| LabError::Argument("no controller to compare".to_owned())))
}

/// The motor with each ADC resolution of the disturbances.
fn motors(
    motor: &str,
    disturbances: &[Disturbance],
) -> Result<Vec<(Option<u32>, SelectedMotor)>, LabError> {
    let mut motors: Vec<(Option<u32>, SelectedMotor)> = Vec::new();
    for Disturbance { plant, .. } in disturbances {
        if motors.iter().all(|(bits, _)| *bits != plant.adc_bits) {
            motors.push((plant.adc_bits, SelectedMotor::find(motor, plant)?));
        }
    }
    Ok(motors)
}

/// One controller by ADC resolution; the undisturbed one first.
struct Drives<'v> {
    variant: &'v str,
    by_bits: Vec<(Option<u32>, Result<Prepared, String>)>,
}

impl<'v> Drives<'v> {
    fn prepare(motors: &[(Option<u32>, SelectedMotor)], variant: &'v str) -> Self {
        let by_bits = motors.iter().map(|(bits, motor)| {
            let drive = motor.prepare_for_torque(Some(variant));
            (*bits, drive.map_err(|failure| failure.to_string()))
        });
        Self {
            variant,
            by_bits: by_bits.collect(),
        }
    }

    /// The drive for a plant, or why there is none.
    fn of(&self, plant: &PlantOptions) -> Result<&Prepared, String> {
        let drive = self
            .by_bits
            .iter()
            .find(|(bits, _)| *bits == plant.adc_bits);
        match drive {
            Some((_, drive)) => drive.as_ref().map_err(Clone::clone),
            None => Err("no drive with this resolution".to_owned()),
        }
    }
}

/// Plan of the runs.
struct Sheet<'p> {
    speeds_rpm: [f64; 2],
    disturbances: Vec<Disturbance>,
    progress: &'p dyn Progress,
}

impl Sheet<'_> {
    /// Every disturbance with every speed.
    fn places(&self) -> impl Iterator<Item = (&Disturbance, f64)> {
        self.disturbances
            .iter()
            .flat_map(|disturbance| self.speeds_rpm.map(|rpm| (disturbance, rpm)))
    }

    /// One controller under all disturbances.
    fn column(&self, drives: &Drives) -> Column {
        let places: Vec<(&Disturbance, f64)> = self.places().collect();
        let controller = match drives.by_bits.first() {
            Some((_, Ok(drive))) => drive.variant.clone(),
            Some((_, Err(reason))) => {
                self.progress.advance(places.len() as u64);
                return Column {
                    controller: drives.variant.to_owned(),
                    refused: Some(reason.clone()),
                    cells: Vec::new(),
                };
            }
            None => drives.variant.to_owned(),
        };
        let measured: Vec<Result<Measured, String>> = places
            .par_iter()
            .map(|(Disturbance { plant, .. }, rpm)| {
                let run = drives.of(plant).and_then(|drive| {
                    let run = run(drive, plant, *rpm);
                    run.map_err(|failure| failure.to_string())
                });
                self.progress.advance(1);
                run
            })
            .collect();
        let cells = places.iter().zip(&measured).enumerate();
        let cells = cells.map(|(place, ((disturbance, rpm), run))| {
            let undisturbed = &measured[place % self.speeds_rpm.len()];
            let (figures, refused) = match (run, undisturbed) {
                (Ok(run), Ok(undisturbed)) => (Some(run.judged(undisturbed)), None),
                (Err(reason), _) | (_, Err(reason)) => (None, Some(reason.clone())),
            };
            Cell {
                disturbance: disturbance.name.clone(),
                rpm: *rpm,
                refused,
                figures,
            }
        });
        Column {
            controller,
            refused: None,
            cells: cells.collect(),
        }
    }
}

/// Measures a drive at its default torque.
fn run(drive: &Prepared, plant: &PlantOptions, rpm: f64) -> Result<Measured, LabError> {
    let params = plant.plant(drive)?;
    let torque = drive.demand();
    let run = plant.run(drive, rpm, torque);
    let expected = torque * plant.scale_kb.unwrap_or(1.0);
    measured(
        drive,
        &params,
        &run,
        plant.set_point(drive, torque),
        expected,
    )
}

/// A run of a drive, before its rating. `expected`: its torque in newton metres.
///
/// # Errors
/// An impossible plant.
pub fn measured(
    drive: &Prepared,
    params: &PlantParams,
    run: &RunOptions,
    set_point: SetPoint,
    expected: f64,
) -> Result<Measured, LabError> {
    let measured = measure(params, run, drive.maker(Model::Fixed, set_point))?;
    let swings = measured
        .traces
        .iter()
        .map(|trace| voltage_swing(&trace.periods, params.v_bus));
    Ok(Measured {
        engine: drive.engine_kind(),
        modulates: drive.spec.controller.modulates(),
        expected_torque: expected,
        figures: measured.figures,
        swing: swings.fold(0.0, f64::max),
        tripped: measured.tripped,
    })
}
