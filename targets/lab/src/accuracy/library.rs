//! 16-bit words over the motor library: formats chosen per motor against one saturating format of
//! SI units for all motors.

use super::{OneStep, Uniform16, uniform_format, with_word};
use crate::LabError;
use crate::engine::{PlantOptions, Prepared, SelectedMotor};
use crate::results::SPEEDS;
use rayon::prelude::*;
use serde::Serialize;

/// The compared law: predictive deadbeat with a quasi-square current, which needs no table.
pub const LAW: &str = "pdcc:reference=quasi_square";

/// One motor.
#[derive(Clone, Debug, Serialize)]
pub struct LibraryRow {
    /// The motor.
    pub motor: String,
    /// Why its 16-bit drive cannot be generated.
    pub refused: Option<String>,
    /// Results of its own formats.
    pub one_step: Option<OneStep>,
    /// Signal-to-noise ratio in the common format, decibel.
    pub uniform_snr_db: Option<f64>,
    /// Gain of its own formats, decibel.
    pub better_by_db: Option<f64>,
}

/// All motors.
#[derive(Clone, Debug, Serialize)]
pub struct Library {
    /// Fraction bits of the common format.
    pub uniform_frac_bits: i32,
    /// Mean of the rows' `better_by_db`.
    pub better_by_db: f64,
    /// One row per motor.
    pub rows: Vec<LibraryRow>,
}

/// Compares every motor of the library at rated torque, or the most that its set-point limit
/// allows.
///
/// # Errors
/// A plant option out of range.
pub fn compare_library(plant: &PlantOptions) -> Result<Library, LabError> {
    let motors = SelectedMotor::library(plant)?;
    let variant = with_word(LAW, 16);
    let drives: Vec<(String, Result<Prepared, LabError>)> = motors
        .into_iter()
        .map(|motor| {
            let drive = motor.prepare_for_torque(variant.as_deref());
            (motor.source.name, drive)
        })
        .collect();
    let specs = drives
        .iter()
        .filter_map(|(_, drive)| Some(&drive.as_ref().ok()?.reference));
    let frac_bits = uniform_format(specs).map_err(|error| LabError::Argument(error.to_string()))?;
    let rows = drives
        .into_par_iter()
        .map(|(motor, drive)| row(motor, drive, plant, frac_bits))
        .collect::<Result<Vec<_>, _>>()?;
    let better = rows.iter().filter_map(|row| row.better_by_db);
    let better_by_db = better.clone().sum::<f64>() / better.count() as f64;
    Ok(Library {
        uniform_frac_bits: frac_bits,
        better_by_db,
        rows,
    })
}

fn row(
    motor: String,
    drive: Result<Prepared, LabError>,
    plant: &PlantOptions,
    frac_bits: i32,
) -> Result<LibraryRow, LabError> {
    let (refused, reached) = match drive {
        Err(failure) => (Some(failure.to_string()), None),
        Ok(drive) => {
            let (params, torque) = (plant.plant(&drive)?, drive.demand());
            let runs = SPEEDS.map(|part| plant.run(&drive, part * drive.rated_rpm(), torque));
            let set_point = plant.set_point(&drive, torque);
            let reached = Uniform16::measure(&drive, &params, &runs, set_point, frac_bits)?;
            (None, reached)
        }
    };
    let uniform_snr_db = reached.as_ref().map(|reached| reached.uniform_snr_db);
    let one_step = reached.map(|reached| reached.one_step);
    let better_by_db = one_step
        .as_ref()
        .zip(uniform_snr_db)
        .map(|(own, uniform)| own.snr_db - uniform);
    Ok(LibraryRow {
        motor,
        refused,
        one_step,
        uniform_snr_db,
        better_by_db,
    })
}
