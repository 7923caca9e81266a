//! Words of 16 bits over the library: the formats that the generator chooses for each motor, against one saturating
//! format of SI units that holds them all.

use super::with_word;
use crate::cli::{
    Failure, PlantArguments, SelectedMotor, TextTable, print_json, print_text, significant, spinner,
};
use crate::commands::accuracy::{OneStep, Uniform16, uniform_format};
use crate::commands::results::SPEEDS;
use hexagen_lab::engine::Prepared;
use rayon::prelude::*;
use serde::Serialize;

/// The law that is compared: predictive deadbeat, which has the deadbeat voltage for its own.
const LAW: &str = "pdcc";

/// One motor.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The motor.
    pub motor: String,
    /// Why its drive of 16-bit words does not generate.
    pub refused: Option<String>,
    /// What the formats of its own reach.
    pub one_step: Option<OneStep>,
    /// Signal over error in the one format, decibel.
    pub uniform_snr_db: Option<f64>,
    /// By how much its own formats are better, decibel.
    pub better_by_db: Option<f64>,
}

/// All motors.
#[derive(Clone, Debug, Serialize)]
pub struct Library {
    /// Fraction bits of the one format.
    pub uniform_frac_bits: i32,
    /// Mean of the rows' `better_by_db`.
    pub better_by_db: f64,
    /// One row per motor.
    pub rows: Vec<Row>,
}

/// Compares every motor of the library at rated torque, as far as its set-point reaches.
///
/// # Errors
/// A plant option out of range.
pub fn collect(plant: &PlantArguments) -> Result<Library, Failure> {
    let motors = SelectedMotor::library(plant)?;
    let variant = with_word(LAW, 16);
    let drives: Vec<(String, Result<Prepared, Failure>)> = motors
        .into_iter()
        .map(|motor| {
            let drive = motor.prepare(variant.as_deref());
            (motor.source.name, drive)
        })
        .collect();
    let specs = drives
        .iter()
        .filter_map(|(_, drive)| Some(&drive.as_ref().ok()?.reference));
    let frac_bits = uniform_format(specs).map_err(|error| Failure::Argument(error.to_string()))?;
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
    drive: Result<Prepared, Failure>,
    plant: &PlantArguments,
    frac_bits: i32,
) -> Result<Row, Failure> {
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
    Ok(Row {
        motor,
        refused,
        one_step,
        uniform_snr_db,
        better_by_db,
    })
}

/// Prints the comparison.
///
/// # Errors
/// As [`collect`].
pub fn run(plant: &PlantArguments, json: bool) -> Result<(), Failure> {
    let progress = spinner("comparing");
    let library = collect(plant);
    progress.finish_and_clear();
    let library = library?;
    if json {
        return print_json(&library);
    }
    let mut table = TextTable::new(
        1,
        [
            "motor",
            "SNR dB",
            "largest V",
            "bound V",
            "ratio",
            "one format",
            "better by dB",
        ],
    );
    for row in &library.rows {
        let Some(own) = &row.one_step else {
            table.row([row.motor.as_str(), "refused"]);
            continue;
        };
        let decibel = |db: Option<f64>| db.map_or_else(String::new, |db| format!("{db:.1}"));
        table.row([
            row.motor.clone(),
            format!("{:.1}", own.snr_db),
            significant(own.largest_v, 3),
            significant(own.bound_v, 3),
            format!("{:.3}", own.seen_to_bound),
            decibel(row.uniform_snr_db),
            decibel(row.better_by_db),
        ]);
    }
    print_text(&table.render())?;
    for reason in library.rows.iter().filter_map(|row| row.refused.as_ref()) {
        print_text(reason)?;
    }
    print_text(&format!(
        "Deadbeat voltage of {LAW} with 16-bit words, one step from the same state, 20 and 75 % of rated speed: signal over error in the \
         formats that the generator chose, and in one saturating 16-bit format of SI units with {} fraction bits, which just holds bus \
         voltages, currents and coefficients of all of these motors. Better by {:.1} dB in the mean.",
        library.uniform_frac_bits, library.better_by_db
    ))
}
