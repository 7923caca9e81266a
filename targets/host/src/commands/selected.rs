//! The drives selected on the command line.

use crate::cli::{Failure, tell_warnings, warn};
use hexagen_lab::engine::{PlantOptions, Prepared, SelectedMotor};
use serde::Serialize;

/// A controller that cannot be generated for a motor.
#[derive(Clone, Debug, Serialize)]
pub struct Refused {
    /// Name of the motor.
    pub motor: String,
    /// The variant.
    pub controller: String,
    /// All diagnostics.
    pub reason: String,
}

/// The motors (none: the library), on another board than their files', with each of the variants
/// (none: that of the motor's file), and the refused ones of `all` controllers. A controller that is
/// named must not be refused.
///
/// # Errors
/// Unknown motors, and all diagnostics.
pub fn select(
    motors: &[String],
    board: Option<&str>,
    variants: &[Option<String>],
    takes_all: bool,
) -> Result<(Vec<Prepared>, Vec<Refused>), Failure> {
    let plant = PlantOptions {
        board: board.map(str::to_owned),
        ..PlantOptions::default()
    };
    let motors = if motors.is_empty() {
        SelectedMotor::library(&plant)?
    } else {
        motors
            .iter()
            .map(|motor| SelectedMotor::find(motor, &plant))
            .collect::<Result<_, _>>()?
    };
    let (mut drives, mut refused) = (vec![], vec![]);
    for motor in &motors {
        for variant in variants {
            match (motor.prepare(variant.as_deref()), variant) {
                (Ok(drive), _) => {
                    tell_warnings(&drive);
                    drives.push(drive);
                }
                (Err(reason), Some(controller)) if takes_all => {
                    warn(&format!("{controller} is skipped: {reason}"));
                    refused.push(Refused {
                        motor: motor.source.name.clone(),
                        controller: controller.clone(),
                        reason: reason.to_string(),
                    });
                }
                (Err(failure), _) => return Err(failure.into()),
            }
        }
    }
    Ok((drives, refused))
}
