//! Boards, and which motors of the library fit each.

use crate::engine::{PlantOptions, SelectedMotor};
use crate::{LabError, Progress};
use hexagen_codegen::spec::BOARDS;
use rayon::prelude::*;
use serde::Serialize;

/// A board.
#[derive(Clone, Debug, Serialize)]
pub struct BoardWithMotors {
    /// Name or file.
    pub name: String,
    /// One line of description.
    pub description: Option<String>,
    /// Where its numbers come from.
    pub source: Option<String>,
    /// What it states of the inverter.
    pub fields: Vec<BoardField>,
    /// Every motor of the library on it.
    pub motors: Vec<Fit>,
}

/// A field of a board.
#[derive(Clone, Debug, Serialize)]
pub struct BoardField {
    /// Its name.
    pub field: String,
    /// Its value as written.
    pub value: String,
    /// Where it comes from, or why it was assumed.
    pub source: Option<String>,
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
pub fn library_of_boards(progress: &dyn Progress) -> Result<Vec<BoardWithMotors>, LabError> {
    progress.begin("putting motors on boards", BOARDS.len() as u64);
    let boards = BOARDS.par_iter().map(|board| {
        let board = board_with_motors(board.name);
        progress.advance(1);
        board
    });
    boards.collect()
}

/// A board of the library, or of a file, with every motor of the library.
///
/// # Errors
/// When there is no such board, or its file cannot be read.
pub fn board_with_motors(given: &str) -> Result<BoardWithMotors, LabError> {
    let motors = SelectedMotor::library(&PlantOptions::on_board(Some(given)))?;
    let board = motors.first().and_then(|motor| motor.ast.board.as_ref());
    let file = board.and_then(|board| board.file.clone());
    let file = file.unwrap_or_default();
    let source_of = |name: &str| file.source_of(name).map(str::to_owned);
    let fields = file
        .inverter
        .fields
        .iter()
        .chain(&file.core.fields)
        .map(|field| BoardField {
            field: field.name.clone(),
            value: field.value.to_string(),
            source: (field.assumed.clone())
                .map(|why| format!("assumed: {why}"))
                .or_else(|| source_of(&field.name)),
        })
        .collect();
    let source = source_of("text");
    Ok(BoardWithMotors {
        name: given.to_owned(),
        description: file.description,
        source,
        fields,
        motors: motors.iter().map(fit).collect(),
    })
}

fn fit(motor: &SelectedMotor) -> Fit {
    let reason = motor.prepare(None).err().map(|error| error.to_string());
    Fit {
        motor: motor.source.name.clone(),
        fits: reason.is_none(),
        reason,
    }
}
