//! The motor library, and whether each motor's default drive holds its rating.

use crate::closed_loop::{Held, RunOptions, STARTS, Trip, mean_torque};
use crate::engine::{Model, PlantOptions, Prepared, SelectedMotor, plant_of, run_of};
use crate::{LabError, Progress};
use rayon::prelude::*;
use serde::Serialize;

/// The controller for the rating.
const CONTROLLER: &str = "pdcc";

/// One motor of the library; per phase of the star, SI units, speeds in rpm.
#[derive(Clone, Debug, Serialize)]
pub struct LibraryMotor {
    /// Name.
    pub name: String,
    /// One line of description.
    pub description: Option<String>,
    /// Pole pairs.
    pub pole_pairs: Option<u32>,
    /// Ohm.
    pub resistance_ohm: Option<f64>,
    /// Henry.
    pub inductance_h: Option<f64>,
    /// Peak phase EMF, V s/rad.
    pub emf_constant_v_s: Option<f64>,
    /// Bus voltage, volt.
    pub v_bus_v: Option<f64>,
    /// Rated current, ampere.
    pub rated_current_a: Option<f64>,
    /// Rated torque, Nm.
    pub rated_torque_nm: Option<f64>,
    /// Rated speed, rpm.
    pub rated_rpm: Option<f64>,
    /// Control period, second.
    pub t_s: Option<f64>,
    /// Whether the controller of its file can be generated.
    pub generates: bool,
    /// Why not.
    pub reason: Option<String>,
    /// Whether PDCC with its defaults holds rated torque at rated speed and nominal bus voltage,
    /// within 3 % on either side.
    pub holds_rating: Option<bool>,
    /// Mean torque there, in percent of the rated one; `None` for a drive that trips.
    pub rated_speed_torque_pct: Option<f64>,
    /// Trip there.
    pub tripped: Option<Trip>,
}

/// The library, by name.
///
/// # Errors
/// If a file of the library cannot be read.
pub fn library_at_rating(progress: &dyn Progress) -> Result<Vec<LibraryMotor>, LabError> {
    let motors = SelectedMotor::library(&PlantOptions::default())?;
    // A motor without this controller cannot hold its rating.
    let drives: Vec<Option<Prepared>> = motors
        .iter()
        .map(|motor| motor.prepare(Some(CONTROLLER)).ok())
        .collect();
    progress.begin("running at the rating", motors.len() as u64);
    let ratings = drives.par_iter().map(|drive| {
        let rating = drive.as_ref().map(at_rating).transpose();
        progress.advance(1);
        rating
    });
    let ratings = ratings.collect::<Result<Vec<_>, _>>();
    let entries = motors.iter().zip(ratings?);
    Ok(entries
        .map(|(motor, rating)| entry(motor, rating))
        .collect())
}

/// Runs a drive at rated speed and rated torque, clamped to the set-point limit, on the plant of
/// its motor's file: the mean torque in newton metres, or the trip.
fn at_rating(drive: &Prepared) -> Result<Result<f64, Trip>, LabError> {
    let plant = plant_of(&drive.spec);
    let set_point = drive.set_point(drive.demand());
    let rated = RunOptions {
        starts: vec![STARTS[0]],
        ..run_of(&drive.spec, drive.spec.motor.rated_speed, drive.demand())
    };
    let maker = drive.maker(Model::Fixed, set_point);
    Ok(mean_torque(&plant, &rated, &maker)?)
}

fn entry(motor: &SelectedMotor, rating: Option<Result<f64, Trip>>) -> LibraryMotor {
    let none = LibraryMotor {
        name: motor.source.name.clone(),
        description: None,
        pole_pairs: None,
        resistance_ohm: None,
        inductance_h: None,
        emf_constant_v_s: None,
        v_bus_v: None,
        rated_current_a: None,
        rated_torque_nm: None,
        rated_rpm: None,
        t_s: None,
        generates: false,
        reason: None,
        holds_rating: None,
        rated_speed_torque_pct: None,
        tripped: None,
    };
    match motor.prepare(None) {
        Ok(drive) => {
            let (spec, inverter) = (&drive.spec.motor, &drive.spec.inverter);
            let torque = rating.and_then(Result::ok);
            let rated = drive.rated_torque();
            LibraryMotor {
                description: Some(spec.description.clone()),
                pole_pairs: Some(spec.pole_pairs),
                resistance_ohm: Some(spec.resistance),
                inductance_h: Some(spec.inductance),
                emf_constant_v_s: Some(spec.emf_constant),
                v_bus_v: Some(inverter.v_bus),
                rated_current_a: Some(spec.rated_current),
                rated_torque_nm: Some(rated),
                rated_rpm: Some(drive.rated_rpm()),
                t_s: Some(inverter.t_s),
                generates: true,
                holds_rating: rating.map(|rating| {
                    rating.is_ok_and(|torque| Held::Within.lost(torque, rated).is_none())
                }),
                rated_speed_torque_pct: torque.map(|torque| 100.0 * torque / rated),
                tripped: rating.and_then(Result::err),
                ..none
            }
        }
        Err(error) => LibraryMotor {
            reason: Some(error.to_string()),
            ..none
        },
    }
}
