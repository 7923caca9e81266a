//! `hexagen simulate`: one controller on the simulated motor.

use crate::cli::{
    Failure, RunArguments, TextTable, parse_rpm, print_json, print_text, significant, spinner,
    write_file,
};
use crate::closed_loop::{Measurement, Merits, RunOptions, Trip, measure};
use crate::engine::{EngineKind, Model, Prepared};
use crate::plant::PlantParams;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

/// Options of `simulate`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor, controller and plant.
    #[command(flatten)]
    pub run: RunArguments,
    /// Mechanical speed in rpm; negative is backward
    #[arg(long, value_name = "RPM", value_parser = parse_rpm, allow_hyphen_values = true)]
    pub rpm: f64,
    /// Write the measured window of the first start, one row per period
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// What a run was and what came out: the merits' keys and what they are about.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Motor.
    pub motor: String,
    /// Controller variant.
    pub controller: String,
    /// Model that ran.
    pub model: Model,
    /// What ran the fixed-point program; none for the references.
    pub engine: Option<EngineKind>,
    /// Mechanical speed, rpm.
    pub rpm: f64,
    /// Demanded torque, Nm.
    pub torque_nm: f64,
    /// What tripped the drive; none if nothing did.
    pub tripped: Option<Trip>,
    /// What was measured.
    #[serde(flatten)]
    pub merits: Merits,
}

/// Runs and measures.
///
/// # Errors
/// Diagnostics, or a plant option out of range.
pub fn collect(options: &Options) -> Result<(Prepared, RunOptions, Measurement), Failure> {
    let arguments = &options.run;
    let drive = arguments.prepare()?;
    let torque = arguments.torque(&drive);
    let plant = arguments.plant.plant(&drive)?;
    let run = arguments.plant.run(&drive, options.rpm, torque);
    check_duration(&run, &plant, options.rpm)?;
    let set_point = arguments.plant.set_point(&drive, torque);
    let progress = spinner("simulating");
    let measured = measure(&plant, &run, drive.maker(arguments.model, set_point));
    progress.finish_and_clear();
    Ok((drive, run, measured?))
}

/// Most control periods of a run: their record takes a few hundred megabytes.
const MOST_PERIODS: usize = 2_000_000;

/// Fewest control periods of an electrical turn: one per sector.
const LEAST_PERIODS_PER_TURN: f64 = 6.0;

/// Whether the run's electrical turns fit into the record of a run.
fn check_duration(run: &RunOptions, plant: &PlantParams, rpm: f64) -> Result<(), Failure> {
    let pole_pairs = f64::from(plant.pole_pairs);
    let most = 60.0 / (LEAST_PERIODS_PER_TURN * plant.t_s * pole_pairs);
    if rpm.abs() > most {
        return Err(Failure::Argument(format!(
            "--rpm {rpm:e}: an electrical turn takes less than {LEAST_PERIODS_PER_TURN} control periods, so that angles and speeds cannot be told from samples; give at most {most:.0} rpm"
        )));
    }
    let (settling, measured) = run.periods(plant);
    let periods = settling.saturating_add(measured);
    if periods <= MOST_PERIODS {
        return Ok(());
    }
    let least = rpm.abs() * periods as f64 / MOST_PERIODS as f64;
    Err(Failure::Argument(format!(
        "--rpm {rpm}: its electrical turns take {:.0} s; give 0 or at least {} rpm",
        periods as f64 * plant.t_s,
        significant(least * 1.01, 3)
    )))
}

/// Runs the command.
///
/// # Errors
/// As [`collect`], a file that cannot be written, or a drive that tripped.
pub fn run(options: &Options) -> Result<(), Failure> {
    let (drive, run, measured) = collect(options)?;
    if let Some(path) = &options.csv {
        let mut csv = Vec::new();
        let trace = measured.traces.first();
        if let Some(trace) = trace {
            trace
                .write_csv(&mut csv, run.current, run.commutation_threshold)
                .map_err(|error| Failure::Write {
                    path: path.clone(),
                    reason: error.to_string(),
                })?;
        }
        write_file(path, &csv)?;
    }
    let model = options.run.model;
    let outcome = Outcome {
        motor: drive.motor.clone(),
        controller: drive.variant.clone(),
        model,
        engine: (model == Model::Fixed).then(|| drive.engine_kind()),
        rpm: options.rpm,
        torque_nm: options.run.torque(&drive),
        tripped: measured.tripped,
        merits: measured.merits,
    };
    if options.run.json {
        print_json(&outcome)?;
    } else {
        print_table(&outcome)?;
    }
    Failure::of_trip(outcome.tripped)
}

fn print_table(outcome: &Outcome) -> Result<(), Failure> {
    let engine = outcome
        .engine
        .map_or(String::new(), |engine| format!(", {}", engine.name()));
    print_text(&format!(
        "{}, {} ({:?}{engine}): {} Nm at {} rpm",
        outcome.motor,
        outcome.controller,
        outcome.model,
        significant(outcome.torque_nm, 4),
        outcome.rpm
    ))?;
    let mut table = TextTable::new(1, ["merit", "value", "unit"]);
    for (name, value, unit) in rows(&outcome.merits) {
        table.row([name.to_owned(), significant(value, 4), unit.to_owned()]);
    }
    print_text(&table.render())
}

/// Names, values and units of merits, in the order of their keys.
pub fn rows(merits: &Merits) -> [(&'static str, f64, &'static str); 14] {
    [
        ("mean torque", merits.mean_torque_nm, "Nm"),
        ("torque ripple, peak to peak", merits.ripple_pp_pct, "%"),
        ("torque ripple, rms", merits.ripple_rms_pct, "%"),
        ("torque harmonic 6", merits.h6_pct, "%"),
        ("torque harmonic 12", merits.h12_pct, "%"),
        ("current harmonic 5", merits.i5_pct, "%"),
        ("current harmonic 7", merits.i7_pct, "%"),
        ("current harmonic 11", merits.i11_pct, "%"),
        ("current harmonic 13", merits.i13_pct, "%"),
        ("current distortion", merits.thd_pct, "%"),
        ("tracking error, rms", merits.tracking_rms_a, "A"),
        ("commutation", merits.commutation_us, "us"),
        ("switching per device", merits.switching_hz, "Hz"),
        ("saturated periods", merits.saturated_pct, "%"),
    ]
}
