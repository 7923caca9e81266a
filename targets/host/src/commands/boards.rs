//! `hexagen boards`: the library of boards, what each states, which motors of the library fit it, and why
//! the others do not.

use crate::cli::{Bar, Failure, paragraph, print_json, print_table, print_text};
use clap::Args;
use hexagen_lab::boards::{BoardField, BoardWithMotors, Fit, board_with_motors, library_of_boards};
use hexagen_lab::report::Table;
use serde::Serialize;

/// Options of `boards`.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
    /// A board, a name of the library or a file: its fields, and why the other motors do not fit it
    #[arg(value_name = "BOARD")]
    pub board: Option<String>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// When there is no such board, or its file cannot be read.
pub fn run(options: &Options) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Library {
        boards: Vec<BoardWithMotors>,
    }
    let boards = match &options.board {
        Some(board) => vec![board_with_motors(board)?],
        None => library_of_boards(&Bar::default())?,
    };
    if options.json {
        return print_json(&Library { boards });
    }
    print_table(&table(&boards))?;
    if options.board.is_none() {
        return print_text(
            "`hexagen boards BOARD` lists a board's fields, and says why the other motors do not fit it.",
        );
    }
    for board in &boards {
        print_table(&table_of_fields(board))?;
    }
    print_text(&paragraph(UNSTATED))?;
    let motors = boards.iter().flat_map(|board| &board.motors);
    for Fit { motor, reason, .. } in motors {
        // What stands first decides: the rest often follows from it.
        if let Some(reason) = reason.as_deref().and_then(|text| text.lines().next()) {
            print_text(&format!("{motor}: {reason}"))?;
        }
    }
    Ok(())
}

/// What a reader may expect of a board and does not find.
const UNSTATED: &str = "No board states what its switches stand: compare `max_current` and `trip_current` with their data sheet yourself.";

fn table(boards: &[BoardWithMotors]) -> Table {
    let mut table = Table::listed(["board", "description", "motors that fit"], []);
    for board in boards {
        let fitting = board.motors.iter().filter(|motor| motor.fits);
        let fitting: Vec<&str> = fitting.map(|fit| fit.motor.as_str()).collect();
        table.row([
            board.name.clone(),
            board.description.clone().unwrap_or_default(),
            fitting.join(", "),
        ]);
    }
    table
}

fn table_of_fields(board: &BoardWithMotors) -> Table {
    let mut table = Table::listed(["field", "value", "from"], []);
    for BoardField {
        field,
        value,
        source,
    } in &board.fields
    {
        table.row([
            field.clone(),
            value.clone(),
            source.clone().unwrap_or_default(),
        ]);
    }
    table
}
