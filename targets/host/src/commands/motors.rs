//! `hexagen motors`: the library.

use crate::cli::{Failure, SelectedMotor, TextTable, note, print_json, print_text, significant};
use clap::Args;
use serde::Serialize;

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
}

/// The library, by name.
///
/// # Errors
/// When a file of the library cannot be read.
pub fn collect() -> Result<Vec<Entry>, Failure> {
    Ok(SelectedMotor::library()?.iter().map(entry).collect())
}

fn entry(motor: &SelectedMotor) -> Entry {
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
    };
    match motor.prepare(None) {
        Ok(drive) => {
            let (spec, inverter) = (&drive.spec.motor, &drive.spec.inverter);
            Entry {
                description: Some(spec.description.clone()),
                pole_pairs: Some(spec.pole_pairs),
                resistance_ohm: Some(spec.resistance),
                inductance_h: Some(spec.inductance),
                emf_constant_v_s: Some(spec.emf_constant),
                v_bus_v: Some(inverter.v_bus),
                rated_current_a: Some(spec.rated_current),
                rated_torque_nm: Some(drive.rated_torque()),
                rated_rpm: Some(spec.rated_speed * 30.0 / std::f64::consts::PI),
                t_s: Some(inverter.t_s),
                generates: true,
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
            "poles",
            "R ohm",
            "L mH",
            "EMF V s/rad",
            "bus V",
            "Ts us",
            "rated A",
            "rated Nm",
            "rated rpm",
            "generates",
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
                .map_or("-".to_owned(), |pairs| (2 * pairs).to_string()),
            number(motor.resistance_ohm, 1.0),
            number(motor.inductance_h, 1e3),
            number(motor.emf_constant_v_s, 1.0),
            number(motor.v_bus_v, 1.0),
            number(motor.t_s, 1e6),
            number(motor.rated_current_a, 1.0),
            number(motor.rated_torque_nm, 1.0),
            number(motor.rated_rpm, 1.0),
            if motor.generates { "yes" } else { "no" }.to_owned(),
        ]);
    }
    print_text(&table.render())?;
    print_text("R, L per phase of the star; EMF: phase peak per mechanical rad/s.")?;
    for motor in &motors {
        if let Some(reason) = &motor.reason {
            note(reason);
        }
    }
    Ok(())
}
