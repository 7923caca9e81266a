//! `hexagen boards`: the library of boards, and which motors of the library fit each.

use crate::cli::{Bar, Failure, print_json, print_table, print_text};
use clap::Args;
use hexagen_lab::boards::{Fit, LibraryBoard, library_of_boards};
use hexagen_lab::report::Table;
use serde::Serialize;

/// Options of `boards`.
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
        boards: Vec<LibraryBoard>,
    }
    let boards = library_of_boards(&Bar::default())?;
    if options.json {
        return print_json(&Library { boards });
    }
    print_table(&table(&boards))?;
    for board in &boards {
        for Fit { motor, reason, .. } in &board.motors {
            // What stands first decides: the rest often follows from it.
            if let Some(reason) = reason.as_deref().and_then(|text| text.lines().next()) {
                print_text(&format!("{motor} on {}: {reason}", board.name))?;
            }
        }
    }
    Ok(())
}

fn table(boards: &[LibraryBoard]) -> Table {
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
