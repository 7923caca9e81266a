//! `hexagen motors`: the library, and whether each motor's default drive reaches its rating.

use crate::cli::{Bar, Failure, note, print_json, print_table, print_text};
use clap::Args;
use hexagen_lab::closed_loop::TOLERANCE;
use hexagen_lab::motors::{LibraryMotor, library_at_rating};
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
    print_text(&format!(
        "R, L: per phase, star; EMF: phase peak per mechanical rad/s. Reached: mean torque of the default PDCC at rated \
         speed and nominal bus voltage, in percent of the rated torque; holds: within {:.0} % of it.",
        100.0 * TOLERANCE
    ))?;
    for motor in &motors {
        if let Some(reason) = &motor.reason {
            note(reason);
        }
    }
    Ok(())
}

fn table(motors: &[LibraryMotor]) -> Table {
    let mut table = Table::listed(
        ["motor"],
        [
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
    for motor in motors {
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
    table
}
