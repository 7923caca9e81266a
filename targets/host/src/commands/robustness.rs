//! The robustness sheet in the terminal: a heat table per speed.

use crate::cli::{Failure, Ground, TextTable, print_text};
use hexagen_lab::robustness::{Cell, Heat, Outcome, Robustness, SWING_RULE};
use hexagen_lab::text::significant;

/// Grounds of the cells, from pale to dark, in the 256 colours of terminals; the pale ones bear
/// dark ink.
fn ground(heat: Heat) -> Option<Ground> {
    let ground = |color, ink| Some(Ground { color, ink });
    match heat {
        Heat::None => None,
        Heat::Slight => ground(230, 16),
        Heat::Marked => ground(221, 16),
        Heat::Strong => ground(208, 16),
        Heat::Broken => ground(124, 231),
    }
}

/// Prints the sheet.
///
/// # Errors
/// When it cannot be written.
pub fn print(sheet: &Robustness) -> Result<(), Failure> {
    for (speed, rpm) in sheet.speeds_rpm.iter().enumerate() {
        print_text(&format!("{rpm:.0} rpm:"))?;
        print_text(&table(sheet, speed))?;
        print_text("")?;
    }
    print_text(
        "Mean torque in Nm, its ripple peak to peak / RMS in % of it. Colours: within 1, 3, 10 points of the run without \
         disturbance (torque in % of what the current should give on this plant, RMS ripple), and beyond.",
    )?;
    print_text(SWING_RULE)?;
    for reason in reasons(sheet) {
        print_text(&reason)?;
    }
    Ok(())
}

fn table(sheet: &Robustness, speed: usize) -> String {
    let names = sheet
        .controllers
        .iter()
        .map(|column| column.controller.replace(',', ",\n"));
    let header = ["disturbance".to_owned()].into_iter().chain(names);
    let mut table = TextTable::new(1, header);
    for (place, name) in sheet.disturbances.iter().enumerate() {
        let cells = sheet
            .controllers
            .iter()
            .map(|column| match sheet.cell(column, place, speed) {
                Some(cell) => text(cell),
                None => ("refused".to_owned(), None),
            });
        let name = (name.clone(), None);
        table.painted_row([name].into_iter().chain(cells));
    }
    table.render()
}

/// A cell's text and ground.
fn text(cell: &Cell) -> (String, Option<Ground>) {
    let Some(figures) = &cell.figures else {
        return ("refused".to_owned(), None);
    };
    let text = match figures.outcome {
        Outcome::Trips | Outcome::Oscillates => figures.outcome.name().to_owned(),
        Outcome::Runs => format!(
            "{} Nm {} / {} %",
            significant(figures.mean_torque_nm, 3),
            significant(figures.ripple_pp_pct, 2),
            significant(figures.ripple_rms_pct, 2)
        ),
    };
    (text, ground(figures.heat))
}

/// Why controllers or disturbances were refused, each reason once.
fn reasons(sheet: &Robustness) -> Vec<String> {
    let mut reasons: Vec<String> = Vec::new();
    for column in &sheet.controllers {
        let of_cells = column.cells.iter().filter_map(|cell| cell.refused.as_ref());
        for reason in column.refused.iter().chain(of_cells) {
            let reason = format!("{}: {reason}", column.controller);
            if !reasons.contains(&reason) {
                reasons.push(reason);
            }
        }
    }
    reasons
}
