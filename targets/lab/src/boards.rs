//! The library of boards, and which motors of the library fit each.

use crate::engine::{PlantOptions, SelectedMotor};
use crate::{LabError, Progress};
use hexagen_codegen::spec::{BOARDS, parse_board};
use rayon::prelude::*;
use serde::Serialize;

/// One board of the library.
#[derive(Clone, Debug, Serialize)]
pub struct LibraryBoard {
    /// Name.
    pub name: String,
    /// One line of description.
    pub description: Option<String>,
    /// Where its numbers come from.
    pub source: Option<String>,
    /// Every motor of the library on it.
    pub motors: Vec<Fit>,
}

/// A motor on a board.
#[derive(Clone, Debug, Serialize)]
pub struct Fit {
    /// Name of the motor.
    pub motor: String,
    /// Whether the controller of its file generates for the board.
    pub fits: bool,
    /// Why not: all diagnostics.
    pub reason: Option<String>,
}

/// The library, by name, each board with every motor.
///
/// # Errors
/// When a file of the library cannot be read.
pub fn library_of_boards(progress: &dyn Progress) -> Result<Vec<LibraryBoard>, LabError> {
    progress.begin("putting motors on boards", BOARDS.len() as u64);
    let boards = BOARDS.par_iter().map(|board| {
        let file = parse_board(board.text, board.name)?;
        let on_board = PlantOptions {
            board: Some(board.name.to_owned()),
            ..PlantOptions::default()
        };
        let motors = SelectedMotor::library(&on_board)?;
        progress.advance(1);
        Ok(LibraryBoard {
            name: board.name.to_owned(),
            description: file.description,
            source: file
                .source
                .into_iter()
                .find(|(key, _)| key == "text")
                .map(|(_, text)| text),
            motors: motors.iter().map(fit).collect(),
        })
    });
    boards.collect()
}

fn fit(motor: &SelectedMotor) -> Fit {
    let reason = motor.prepare(None).err().map(|error| error.to_string());
    Fit {
        motor: motor.source.name.clone(),
        fits: reason.is_none(),
        reason,
    }
}
