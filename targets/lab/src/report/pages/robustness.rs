//! The robustness sheet: controllers over disturbances, coloured by distance from the undisturbed
//! run.

use crate::report::{Block, Cell, Column, Label, Sign, Table, Tone};
use crate::robustness::{self, Heat, Outcome, Robustness, SWING_RULE};
use crate::text::{TorqueScale, number, ripple};

/// A table per speed, the key of its colours, the criterion of oscillation, and the refused runs.
pub fn robustness_blocks(sheet: &Robustness) -> Vec<Block> {
    let mut cells = sheet.controllers.iter().flat_map(|column| &column.cells);
    let torque = cells.find_map(|cell| cell.figures.as_ref()?.mean_torque_nm);
    let scale = TorqueScale::of(torque.unwrap_or(1.0));
    let keys = Heat::ALL.map(|heat| Sign::Cell(tone(heat)).means(heat.meaning()));
    let mut blocks = vec![
        Block::Note(format!(
            "Controllers generated for the motor file, run as fixed-point code on plants that differ from it in one parameter: mean torque in \
             {}, and its ripple in percent of the mean, peak to peak / RMS.",
            scale.unit
        )),
        Block::Note(SWING_RULE.to_owned()),
        Block::Legend(keys.to_vec()),
        Block::Note(
            "Points are percent of the plant's torque at the demanded current, or of added RMS ripple.".to_owned(),
        ),
    ];
    for (speed, rpm) in sheet.speeds_rpm.iter().enumerate() {
        blocks.push(Block::Heading(format!("{} rpm", number(*rpm, 0))));
        blocks.push(Block::Table(table(sheet, speed, &scale)));
    }
    blocks.extend(refused(sheet).into_iter().map(Block::Prose));
    blocks
}

fn tone(heat: Heat) -> Tone {
    match heat {
        Heat::None => Tone::None,
        Heat::Slight => Tone::Slight,
        Heat::Marked => Tone::Marked,
        Heat::Strong => Tone::Strong,
        Heat::Broken => Tone::Broken,
    }
}

fn table(sheet: &Robustness, speed: usize, scale: &TorqueScale) -> Table {
    let there = || {
        let columns = sheet.controllers.iter();
        columns.filter(|column| column.refused.is_none())
    };
    let controllers = there().map(|column| Column::number(format!("`{}`", column.controller), ""));
    let columns = [Column::text("Disturbance")].into_iter().chain(controllers);
    let mut table = Table::new("heat", columns);
    for (place, name) in sheet.disturbances.iter().enumerate() {
        let cells = there().map(|column| cell(sheet.cell(column, place, speed), scale));
        table.group(Label::Beside(printed(name).into()));
        table.row(cells);
    }
    table
}

fn cell(cell: Option<&robustness::Cell>, scale: &TorqueScale) -> Cell {
    let Some(figures) = cell.and_then(|cell| cell.figures.as_ref()) else {
        return Cell::from("refused").toned(Tone::Muted);
    };
    let cell = match figures.outcome {
        Outcome::Runs => Cell::from(scale.text(figures.mean_torque_nm, 0)).detail(format!(
            "{} / {}",
            ripple(figures.ripple_pp_pct),
            ripple(figures.ripple_rms_pct)
        )),
        Outcome::Oscillates | Outcome::Trips => figures.outcome.name().into(),
    };
    cell.toned(tone(figures.heat))
}

/// Why controllers or disturbances were refused; each reason once.
fn refused(sheet: &Robustness) -> Vec<String> {
    let speeds = sheet.speeds_rpm.len().max(1);
    let mut reasons = Vec::new();
    for column in &sheet.controllers {
        let name = &column.controller;
        if let Some(reason) = &column.refused {
            reasons.push(format!("`{name}` is missing: {reason}"));
        }
        for cell in column.cells.iter().step_by(speeds) {
            if let Some(reason) = &cell.refused {
                reasons.push(format!(
                    "`{name}`, {}: {reason}",
                    printed(&cell.disturbance)
                ));
            }
        }
    }
    reasons
}

/// A disturbance's name in typographic signs.
fn printed(name: &str) -> String {
    name.replace('-', "\u{2212}")
        .replace("\u{2212}bit", "-bit")
        .replace(" deg", "\u{b0}")
        .replace(" us", " \u{b5}s")
}
