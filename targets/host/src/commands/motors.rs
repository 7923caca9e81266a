//! `hexagen motors`: the library, and how well each motor's default drive does.

use crate::cli::{Bar, Failure, note, print_json, print_table, print_text};
use clap::Args;
use hexagen_lab::motors::{
    COARSE, LibraryMotor, Limit, RIPPLE, RatedPoint, SPEEDS, TORQUE, library_at_rating,
};
use hexagen_lab::report::Table;
use hexagen_lab::text::significant;
use serde::Serialize;

/// Options of `motors`.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
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
    let motors = library_at_rating(&Bar::default())?;
    if options.json {
        return print_json(&Library { motors });
    }
    print_table(&table(&motors))?;
    let [fine, coarse] = RIPPLE;
    print_text(&format!(
        "The default drive at rated torque and nominal bus voltage, by share of the rated speed; deg/Ts: electrical degrees\n\
         in a control period at rated speed; whole to: speed up to which the bus drives the rating's whole current. Right: torque within {TORQUE} %, ripple at most {fine} % up to {COARSE} deg/Ts, {coarse} % above; else\n\
         what limits the drive."
    ))?;
    for motor in &motors {
        if let Some(reason) = &motor.reason {
            note(reason);
        }
    }
    Ok(())
}

fn table(motors: &[LibraryMotor]) -> Table {
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
            &torque,
            &ripple,
            "right",
        ],
    );
    for motor in motors {
        let number = |value: Option<f64>, scale: f64| {
            value.map_or("-".to_owned(), |value| significant(value * scale, 3))
        };
        let points = |of: fn(&RatedPoint) -> Option<f64>| {
            let points = motor.points.iter().map(|point| match of(point) {
                Some(value) => format!("{value:.1}"),
                None => "-".to_owned(),
            });
            points.collect::<Vec<_>>().join(", ")
        };
        table.row([
            motor.name.clone(),
            motor
                .pole_pairs
                .map_or("-".to_owned(), |pairs| pairs.to_string()),
            number(motor.v_bus_v, 1.0),
            number(motor.t_s, 1e6),
            number(motor.rated_current_a, 1.0),
            number(motor.rated_torque_nm, 1.0),
            number(motor.rated_rpm, 1.0),
            number(motor.degrees_per_period, 1.0),
            number(motor.envelope_pct, 1.0),
            points(|point| point.torque_pct),
            points(|point| point.ripple_pct),
            verdict(motor).to_owned(),
        ]);
    }
    table
}

/// Whether a motor's default drive is right, else what limits it.
fn verdict(motor: &LibraryMotor) -> &'static str {
    match motor.limit {
        _ if motor.is_right => "yes",
        Some(Limit::BusVoltage) => "bus voltage",
        Some(Limit::Trip) => "trips",
        Some(Limit::ControlPeriod) => "control period",
        None => "not generated",
    }
}
