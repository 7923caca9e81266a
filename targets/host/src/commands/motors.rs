//! `hexagen motors`: the library, and whether each motor's default drive holds its rating.

use crate::cli::{
    Failure, PlantArguments, SelectedMotor, TextTable, bar, note, print_json, print_text,
    significant,
};
use clap::Args;
use hexagen_lab::closed_loop::{Held, RunOptions, STARTS, TOLERANCE, Trip, mean_torque};
use hexagen_lab::engine::{Model, Prepared, plant_of, run_of};
use rayon::prelude::*;
use serde::Serialize;

/// The controller that is asked for the rating.
const CONTROLLER: &str = "pdcc";

/// Options of `motors`.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// One motor of the library; per phase of the star, SI units, speeds in rpm.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
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
    /// Whether the controller of its file generates.
    pub generates: bool,
    /// Why not.
    pub reason: Option<String>,
    /// Whether PDCC with its defaults holds rated torque at rated speed from the nominal bus: within
    /// 3 % on either side.
    pub holds_rating: Option<bool>,
    /// Mean torque that it reaches there, in percent of the rated one; none of a drive that trips.
    pub rated_speed_torque_pct: Option<f64>,
    /// What trips it there.
    pub tripped: Option<Trip>,
}

/// The library, by name.
///
/// # Errors
/// When a file of the library cannot be read.
pub fn collect() -> Result<Vec<Entry>, Failure> {
    let motors = SelectedMotor::library(&PlantArguments::default())?;
    // A motor that cannot have this controller holds nothing with it.
    let drives: Vec<Option<Prepared>> = motors
        .iter()
        .map(|motor| motor.prepare(Some(CONTROLLER)).ok())
        .collect();
    let progress = bar(motors.len() as u64, "running at the rating");
    let ratings = drives.par_iter().map(|drive| {
        let rating = drive.as_ref().map(at_rating).transpose();
        progress.inc(1);
        rating
    });
    let ratings = ratings.collect::<Result<Vec<_>, _>>();
    progress.finish_and_clear();
    let entries = motors.iter().zip(ratings?);
    Ok(entries
        .map(|(motor, rating)| entry(motor, rating))
        .collect())
}

/// Runs a drive at rated speed with the set-point of rated torque, as far as that reaches, on the
/// plant of its motor's file: the mean torque in newton metres, or what tripped it.
fn at_rating(drive: &Prepared) -> Result<Result<f64, Trip>, Failure> {
    let plant = plant_of(&drive.spec);
    let set_point = drive.set_point(drive.demand());
    let rated = RunOptions {
        starts: vec![STARTS[0]],
        ..run_of(&drive.spec, drive.spec.motor.rated_speed, drive.demand())
    };
    let maker = drive.maker(Model::Fixed, set_point);
    Ok(mean_torque(&plant, &rated, &maker)?)
}

fn entry(motor: &SelectedMotor, rating: Option<Result<f64, Trip>>) -> Entry {
    let none = Entry {
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
            Entry {
                description: Some(spec.description.clone()),
                pole_pairs: Some(spec.pole_pairs),
                resistance_ohm: Some(spec.resistance),
                inductance_h: Some(spec.inductance),
                emf_constant_v_s: Some(spec.emf_constant),
                v_bus_v: Some(inverter.v_bus),
                rated_current_a: Some(spec.rated_current),
                rated_torque_nm: Some(rated),
                rated_rpm: Some(spec.rated_speed * 30.0 / std::f64::consts::PI),
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
        Err(failure) => Entry {
            reason: Some(failure.to_string()),
            ..none
        },
    }
}

/// Runs the command.
///
/// # Errors
/// When the library cannot be read.
pub fn run(options: &Options) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Library {
        motors: Vec<Entry>,
    }
    let motors = collect()?;
    if options.json {
        return print_json(&Library { motors });
    }
    let mut table = TextTable::new(
        1,
        [
            "motor",
            "pole pairs",
            "R ohm",
            "L mH",
            "EMF V s/rad",
            "bus V",
            "Ts us",
            "rated A",
            "rated Nm",
            "rated rpm",
            "generates",
            "reached %",
            "holds",
        ],
    );
    for motor in &motors {
        let number = |value: Option<f64>, scale: f64| {
            value.map_or("-".to_owned(), |value| significant(value * scale, 3))
        };
        table.row([
            motor.name.clone(),
            motor
                .pole_pairs
                .map_or("-".to_owned(), |pairs| pairs.to_string()),
            number(motor.resistance_ohm, 1.0),
            number(motor.inductance_h, 1e3),
            number(motor.emf_constant_v_s, 1.0),
            number(motor.v_bus_v, 1.0),
            number(motor.t_s, 1e6),
            number(motor.rated_current_a, 1.0),
            number(motor.rated_torque_nm, 1.0),
            number(motor.rated_rpm, 1.0),
            if motor.generates { "yes" } else { "no" }.to_owned(),
            motor
                .rated_speed_torque_pct
                .map_or("-".to_owned(), |percent| format!("{percent:.1}")),
            match (motor.holds_rating, motor.tripped) {
                (_, Some(_)) => "trips",
                (Some(true), None) => "yes",
                (Some(false), None) => "no",
                (None, None) => "-",
            }
            .to_owned(),
        ]);
    }
    print_text(&table.render())?;
    print_text(&format!(
        "R, L per phase of the star; EMF: phase peak per mechanical rad/s. Reached: mean torque of the default PDCC at rated \
         speed from the nominal bus, in percent of the rated one; it holds it within {:.0} % on either side.",
        100.0 * TOLERANCE
    ))?;
    for motor in &motors {
        if let Some(reason) = &motor.reason {
            note(reason);
        }
    }
    Ok(())
}
