//! `hexagen simulate`: one controller on the simulated motor.

use super::ran::Ran;
use crate::cli::{
    self, Failure, RunArguments, parse_rpm, print_json, print_text, spinner, warn, write_file,
};
use clap::Args;
use hexagen_codegen::diagnostics::engineering;
use hexagen_lab::closed_loop::{
    Aim, FiguresOfMerit, MOST_RECORDED, Measurement, RunOptions, SETTLED, Speed, Trip, measure,
};
use hexagen_lab::engine::{Prepared, run_of};
use hexagen_lab::envelope::envelope_on;
use hexagen_lab::plant::PlantParams;
use hexagen_lab::report::Table;
use hexagen_lab::text::significant;
use serde::Serialize;
use std::f64::consts::TAU;
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
    /// Speed set-point in rpm, with `speed_loop=on`: the run starts at --rpm, --torque is the limit
    /// of the speed loop, and the measurement begins after the run-up; warns if the speed has not
    /// settled within 2 %
    #[arg(long, value_name = "RPM", value_parser = parse_rpm, allow_hyphen_values = true, requires = "inertia")]
    pub speed_set: Option<f64>,
    /// Write the measurement of the first run, one row per period
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// A run and its figures of merit.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Motor, controller and model.
    #[serde(flatten)]
    pub ran: Ran,
    /// Mechanical speed, rpm.
    pub rpm: f64,
    /// Torque demand, Nm.
    pub torque_nm: f64,
    /// Trip of the drive, if any. A drive that tripped has no figures of merit.
    pub tripped: Option<Trip>,
    /// Speed reached by a free shaft.
    #[serde(flatten)]
    pub speed: Option<Speed>,
    /// Figures of merit; null where one does not exist.
    #[serde(flatten)]
    pub figures: FiguresOfMerit,
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
    let mut run = arguments.plant.options().run(&drive, options.rpm, torque);
    run.aim = aim(options, &drive, &plant, torque)?;
    check_duration(&run, &plant, options)?;
    let mut set_point = arguments.plant.set_point(&drive, torque);
    set_point.rpm = options.speed_set;
    let progress = spinner("simulating");
    let measured = measure(&plant, &run, drive.maker(arguments.model(), set_point));
    progress.finish_and_clear();
    let mut measured = measured?;
    if let (Some(_), Some(mean)) = (run.aim, measured.figures.mean_torque_nm) {
        // The reference is the speed loop's current, not its limit.
        run.current = run_of(&drive.spec, run.omega_m, mean).current;
        measured = Measurement::of(measured.traces, measured.tripped, &run);
    }
    Ok((drive, run, measured))
}

/// The speed set-point and the time until it is reached: settling of the integral to the load,
/// run-up at the remaining torque, settling of the loop.
fn aim(
    options: &Options,
    drive: &Prepared,
    plant: &PlantParams,
    torque: f64,
) -> Result<Option<Aim>, Failure> {
    let wrong = |text: &str| Err(Failure::Argument(text.to_owned()));
    match (
        options.speed_set,
        drive.spec.controller.common().speed,
        plant.mechanics,
    ) {
        (None, None, _) => Ok(None),
        (Some(_), None, _) => {
            wrong("--speed-set: the drive has no speed loop; set `speed_loop=on` in --controller")
        }
        (None, Some(_), _) | (_, _, None) => wrong(
            "`speed_loop: on`: the drive controls its speed; add --speed-set and --inertia, or set `speed_loop=off` in --controller",
        ),
        (Some(rpm), Some(speed), Some(mechanics)) => {
            let most = drive.spec.inverter.maximum_speed * 60.0 / TAU;
            if rpm.abs() > most {
                warn(&format!(
                    "--speed-set {rpm}: the drive limits its speed to maximum_speed = {most:.0} rpm"
                ));
            }
            let speeds = (options.rpm * TAU / 60.0, rpm * TAU / 60.0);
            Ok(Some(Aim::of(&speed, &mechanics, torque, speeds)))
        }
    }
}

/// Most control periods of a run, with settling: minutes of computing time.
const MOST_PERIODS: usize = 2_000_000;

/// Fewest control periods per electrical turn: one per sector.
const LEAST_PERIODS_PER_TURN: f64 = 6.0;

/// Checks that the run's electrical turns fit into its record.
fn check_duration(run: &RunOptions, plant: &PlantParams, options: &Options) -> Result<(), Failure> {
    let (name, rpm) = match options.speed_set {
        Some(set) => ("--speed-set", set),
        None => ("--rpm", options.rpm),
    };
    let pole_pairs = f64::from(plant.pole_pairs);
    let most = 60.0 / (LEAST_PERIODS_PER_TURN * plant.t_s * pole_pairs);
    // The limit in the message is accepted in spite of its rounding.
    if rpm.abs() > most * (1.0 + 1e-9) {
        return Err(Failure::Argument(format!(
            "{name} {rpm:e}: an electrical turn takes less than {LEAST_PERIODS_PER_TURN} control periods, too few for angle and speed; give at most {} rpm",
            (most * (1.0 + 1e-9)).floor()
        )));
    }
    let (settling, measured) = run.periods(plant);
    let periods = settling.saturating_add(measured);
    if periods <= MOST_PERIODS && measured <= MOST_RECORDED {
        return Ok(());
    }
    if let Some(aim) = run
        .aim
        .filter(|aim| aim.within > periods as f64 * plant.t_s / 2.0)
    {
        return Err(Failure::Argument(format!(
            "{name} {rpm}: the run-up takes {:.0} s; give a smaller --inertia or --load, a higher --torque, or an --rpm closer to it",
            aim.within
        )));
    }
    let least = rpm.abs() * measured as f64 / MOST_RECORDED as f64;
    Err(Failure::Argument(format!(
        "{name} {rpm}: an electrical turn takes {:.0} s, longer than the {:.1} s of a record; give 0 or at least {} rpm",
        measured as f64 * plant.t_s,
        MOST_RECORDED as f64 * plant.t_s,
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
    let outcome = Outcome {
        ran: Ran::of(&drive, options.run.model()),
        rpm: options.rpm,
        torque_nm: options.run.torque(&drive),
        tripped: measured.tripped,
        speed: options.run.plant.inertia.map(|_| {
            let least_rpm = drive.spec.inverter.minimum_speed * 60.0 / TAU;
            Speed::of(&measured, options.speed_set, least_rpm)
        }),
        figures: measured.figures,
    };
    if let Some(Speed {
        set_rpm: Some(set),
        settled: Some(false),
        ..
    }) = outcome.speed
    {
        warn(&format!(
            "--speed-set {set}: the speed has not settled within {:.0} % of it",
            100.0 * SETTLED
        ));
    }
    let plant = options.run.plant.plant(&drive)?;
    if let Some(text) = beyond_envelope(&drive, &plant, options, &outcome) {
        warn(&text);
    }
    if options.run.json {
        print_json(&outcome)?;
    } else {
        print_table(&outcome)?;
    }
    Failure::of_trip(outcome.tripped)
}

/// A demand over the envelope's torque from which on it is beyond the envelope.
const BEYOND: f64 = 1.001;

/// What a speed or torque beyond the drive's means; none within, and none with a speed loop.
fn beyond_envelope(
    drive: &Prepared,
    plant: &PlantParams,
    options: &Options,
    outcome: &Outcome,
) -> Option<String> {
    if options.speed_set.is_some() {
        return None;
    }
    let rpm = options.rpm;
    let most = drive.spec.inverter.maximum_speed * 60.0 / TAU;
    if rpm.abs() > most * (1.0 + 1e-9) {
        return Some(format!(
            "--rpm {rpm}: beyond maximum_speed = {most:.0} rpm, up to which the drive follows the rotor"
        ));
    }
    let envelope = envelope_on(&drive.spec, plant);
    let omega_m = rpm * TAU / 60.0;
    let greatest = envelope.max_current * envelope.torque_constant();
    let demand = outcome.torque_nm.clamp(-greatest, greatest);
    let within = envelope.torque(omega_m.abs());
    let is_motoring = demand * omega_m > 0.0;
    (is_motoring && demand.abs() > within * BEYOND).then(|| {
        format!(
            "{} Nm at {rpm} rpm: the bus of {} drives the whole current only up to {} Nm there, beyond which it is cut; `hexagen limit {}` prints up to which speed the torque lasts",
            significant(demand, 4),
            engineering(envelope.v_bus, "V"),
            significant(within, 4),
            outcome.ran.motor
        )
    })
}

fn print_table(outcome: &Outcome) -> Result<(), Failure> {
    let engine = outcome
        .ran
        .engine
        .map_or(String::new(), |engine| format!(", {}", engine.name()));
    print_text(&format!(
        "{}, {} ({}{engine}): {} Nm at {} rpm",
        outcome.ran.motor,
        outcome.ran.controller,
        outcome.ran.model.text(),
        significant(outcome.torque_nm, 4),
        outcome.rpm
    ))?;
    if let Some(trip) = outcome.tripped {
        return print_text(&format!("{trip}; it has no figures of merit"));
    }
    if let Some(speed) = outcome.speed {
        let of = speed.set_rpm.map_or("free shaft".to_owned(), |set_rpm| {
            format!("speed set to {set_rpm} rpm")
        });
        let settled = match speed.settled {
            None => "",
            Some(true) => ", settled",
            Some(false) => ", NOT settled",
        };
        print_text(&format!(
            "{of}: {} rpm on average, {} rpm at the end{settled}",
            significant(speed.mean_rpm, 5),
            significant(speed.final_rpm, 5)
        ))?;
    }
    let mut table = Table::listed(["figure of merit"], ["value", "unit"]);
    for (name, value, unit) in outcome.figures.rows() {
        table.row([name.to_owned(), significant(value, 4), unit.to_owned()]);
    }
    cli::print_table(&table)
}
