//! The robustness sheet as CSV: one row per controller, disturbance and speed.

use super::{DisturbedFigures, Robustness};
use serde::Serialize;

/// A row; fields that a refused cell or a tripped drive lacks are empty.
#[derive(Serialize)]
struct Row<'s>(
    &'s str,
    &'s str,
    Option<f64>,
    [Option<f64>; 6],
    [Option<String>; 4],
    Option<&'s str>,
);

const HEADER: [&str; 14] = [
    "controller",
    "disturbance",
    "rpm",
    "expected_torque_nm",
    "mean_torque_nm",
    "ripple_pp_pct",
    "ripple_rms_pct",
    "swing_voltage_pct",
    "tripped_s",
    "engine",
    "outcome",
    "fault",
    "heat",
    "refused",
];

/// The sheet as CSV. A controller that does not generate has one row, with the reason.
///
/// # Errors
/// An error of the writer.
pub fn csv(sheet: &Robustness) -> Result<Vec<u8>, csv::Error> {
    let mut bytes = Vec::new();
    {
        let mut writer = csv::Writer::from_writer(&mut bytes);
        writer.write_record(HEADER)?;
        for column in &sheet.controllers {
            let name = &column.controller;
            if let Some(reason) = &column.refused {
                let none = [const { None }; 4];
                writer.serialize(Row(name, "", None, [None; 6], none, Some(reason)))?;
            }
            for cell in &column.cells {
                let (numbers, words) = values(cell.figures.as_ref());
                let refused = cell.refused.as_deref();
                let rpm = Some(cell.rpm);
                writer.serialize(Row(name, &cell.disturbance, rpm, numbers, words, refused))?;
            }
        }
        writer.flush()?;
    }
    Ok(bytes)
}

fn values(figures: Option<&DisturbedFigures>) -> ([Option<f64>; 6], [Option<String>; 4]) {
    let Some(figures) = figures else {
        return ([None; 6], [const { None }; 4]);
    };
    let numbers = [
        Some(figures.expected_torque_nm),
        figures.mean_torque_nm,
        figures.ripple_pp_pct,
        figures.ripple_rms_pct,
        figures.swing_voltage_pct,
        figures.tripped.map(|trip| trip.time_s),
    ];
    let words = [
        Some(figures.engine.name().to_owned()),
        Some(figures.outcome.name().to_owned()),
        figures.tripped.map(|trip| trip.fault.to_string()),
        Some(figures.heat.name().to_owned()),
    ];
    (numbers, words)
}
