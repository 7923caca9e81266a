//! `hexagen motors`: the library, and how well each motor's default drive does.

use crate::cli::{Bar, Failure, note, paragraph, print_json, print_table, print_text};
use clap::Args;
use hexagen_lab::engine::{PlantOptions, SelectedMotor};
use hexagen_lab::motors::{
    COARSE, LibraryMotor, Limit, RIPPLE, RatedPoint, SPEEDS, TORQUE, further, library_at_rating,
};
use hexagen_lab::report::{Cell, Table, Tone};
use hexagen_lab::text::significant;
use serde::Serialize;
use std::f64::consts::PI;

/// Options of `motors`.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
    /// A motor of the library: print its file, to be copied
    #[arg(value_name = "MOTOR", conflicts_with = "all")]
    pub motor: Option<String>,
    /// Print every column: periods, and torque and ripple over speed
    #[arg(long)]
    pub all: bool,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// When the library cannot be read.
pub fn run(options: &Options) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Library {
        motors: Vec<LibraryMotor>,
    }
    if let Some(name) = &options.motor {
        return print_motor(name, options.json);
    }
    let motors = library_at_rating(&Bar::default())?;
    if options.json {
        return print_json(&Library { motors });
    }
    let [fine, coarse] = RIPPLE;
    let right = format!(
        "torque within {TORQUE} %, ripple at most {fine} % up to {COARSE} electrical degrees in a control period, {coarse} % above"
    );
    if options.all {
        print_table(&all_columns(&motors))?;
        print_text(&paragraph(&format!(
            "The default drive at rated torque and nominal bus voltage, by share of the rated speed: the worst of both directions, motoring and braking. Deg/Ts: electrical degrees in a control period at rated speed. Whole to: speed up to which the bus drives the rating's whole current. Bus allows: torque at rated speed, up to that of the greatest set-point. Starts: those on a free shaft that reach rated speed, of the bare rotor, where its inertia is known, and of one that the rated torque takes to rated speed in a quarter of a second, from twelve angles each, in both directions. Sampled Halls: ripple at rated speed that the generator tells of where no timer captures the Hall edges. Limited by: - where the drive is right ({right})."
        )))?;
    } else {
        print_table(&table(&motors))?;
        print_text(&paragraph(&format!(
            "Each with the default drive, at rated torque, simulated. Torque, the furthest from the demand, and ripple, the greatest, are those of 5, 25, 60 and 100 % of rated speed in both directions, motoring and braking. Limited by: - where the drive is right ({right}). A name is the maker's and its word for the type. `hexagen check MOTOR` says more of one, `hexagen motors MOTOR` prints its file with the source; --all has every column."
        )))?;
    }
    for motor in &motors {
        if let Some(reason) = &motor.reason {
            note(reason);
        }
    }
    Ok(())
}

fn print_motor(name: &str, as_json: bool) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct MotorFile<'a> {
        name: &'a str,
        text: &'a str,
    }
    let motor = SelectedMotor::find(name, &PlantOptions::default())?.source;
    if as_json {
        return print_json(&MotorFile {
            name: &motor.name,
            text: &motor.text,
        });
    }
    print_text(&motor.text)
}

/// What a reader looks for first.
fn table(motors: &[LibraryMotor]) -> Table {
    let numbers = [
        "bus V",
        "rated A",
        "rated Nm",
        "rated rpm",
        "W",
        "torque %",
        "ripple %",
        "limited by",
    ];
    let mut table = Table::listed(["motor"], numbers);
    for motor in motors {
        let power = motor.rated_torque_nm.zip(motor.rated_rpm);
        let power = power.map(|(torque, rpm)| torque * rpm * PI / 30.0);
        let torques = motor.points.iter().filter_map(|point| point.torque_pct);
        let ripples = motor.points.iter().filter_map(|point| point.ripple_pct);
        let cells = [
            motor.name.clone(),
            cell(motor.v_bus_v, 1.0),
            cell(motor.rated_current_a, 1.0),
            cell(motor.rated_torque_nm, 1.0),
            cell(motor.rated_rpm, 1.0),
            cell(power, 1.0),
            tenths(torques.reduce(|one, other| further((one, other)))),
            tenths(ripples.reduce(f64::max)),
        ];
        table.row(cells.map(Cell::from).into_iter().chain([limit(motor)]));
    }
    table
}

/// A percentage with one digit behind the point.
fn tenths(percent: Option<f64>) -> String {
    percent.map_or("-".to_owned(), |value| format!("{value:.1}"))
}

/// A number times a scale.
fn cell(value: Option<f64>, scale: f64) -> String {
    value.map_or("-".to_owned(), |value| significant(value * scale, 3))
}

fn all_columns(motors: &[LibraryMotor]) -> Table {
    let speeds = SPEEDS.map(|share| share.to_string()).join(", ");
    let (torque, ripple) = (
        format!("torque % at {speeds} %"),
        format!("ripple % at {speeds} %"),
    );
    let mut table = Table::listed(
        ["motor"],
        [
            "pole pairs",
            "bus V",
            "Ts us",
            "rated A",
            "rated Nm",
            "rated rpm",
            "deg/Ts",
            "whole to %",
            "bus allows Nm",
            "starts",
            &torque,
            &ripple,
            "sampled Halls %",
            "limited by",
        ],
    );
    for motor in motors {
        let points = |of: fn(&RatedPoint) -> Option<f64>| {
            let points = motor.points.iter().map(|point| tenths(of(point)));
            points.collect::<Vec<_>>().join(", ")
        };
        let cells = [
            motor.name.clone(),
            motor
                .pole_pairs
                .map_or("-".to_owned(), |pairs| pairs.to_string()),
            cell(motor.v_bus_v, 1.0),
            cell(motor.t_s, 1e6),
            cell(motor.rated_current_a, 1.0),
            cell(motor.rated_torque_nm, 1.0),
            cell(motor.rated_rpm, 1.0),
            cell(motor.degrees_per_period, 1.0),
            cell(motor.envelope_pct, 1.0),
            cell(motor.envelope_torque_nm, 1.0),
            motor.starts.map_or("-".to_owned(), |[all, reached]| {
                format!("{reached} of {all}")
            }),
            points(|point| point.torque_pct),
            points(|point| point.ripple_pct),
            tenths(motor.sampled_ripple_pct),
        ];
        table.row(cells.map(Cell::from).into_iter().chain([limit(motor)]));
    }
    table
}

/// What limits a motor's drive, where it is not right.
fn limit(motor: &LibraryMotor) -> Cell {
    let (text, tone) = match motor.limit {
        _ if motor.is_right => ("-", Tone::None),
        Some(Limit::BusVoltage) => ("bus voltage", Tone::Slight),
        Some(Limit::ControlPeriod) => ("control period", Tone::Slight),
        Some(Limit::Start) => ("start", Tone::Broken),
        Some(Limit::Trip) => ("trips", Tone::Broken),
        None => ("not generated", Tone::Broken),
    };
    Cell::from(text).toned(tone)
}
