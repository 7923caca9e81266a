//! Mean torque over speed, all variants.

use super::{legend, nothing, number, swatch};
use crate::report::plot::{Curve, TorqueSpeed, dash, palette, torque_speed};
use crate::report::{ReportData, ReportError, Variant};
use maud::{Markup, html};
use std::f64::consts::TAU;

/// Fraction of the demand that counts as held.
const HELD: f64 = 0.97;

fn limit_rpm(variant: &Variant) -> Option<f64> {
    let run = variant.runs.first()?;
    run.limit.as_ref()?.limit_rpm
}

/// The plot and its legend.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn section(data: &ReportData) -> Result<Markup, ReportError> {
    let variants: Vec<(usize, &Variant)> = data
        .variants
        .iter()
        .enumerate()
        .filter(|(_, variant)| !variant.torque_speed.is_empty())
        .collect();
    if variants.is_empty() {
        return Ok(nothing("torque-speed curves"));
    }
    let plot = torque_speed(&TorqueSpeed {
        torque: data.torque,
        rated_rpm: data.motor.rated_speed * 60.0 / TAU,
        curves: variants
            .iter()
            .map(|&(index, variant)| Curve {
                color: palette::variant(index),
                index,
                points: variant.torque_speed.clone(),
                limit_rpm: limit_rpm(variant),
            })
            .collect(),
        marks: &data.marks,
        held: HELD,
    })?;
    Ok(html! {
        (legend(variants.iter().map(|&(index, variant)| {
            let limit = limit_rpm(variant).map_or_else(String::new, |rpm| format!(" ({} rpm)", number(rpm, 0)));
            (swatch(palette::variant(index), 3.0, dash(index)), format!("{}{limit}", variant.label))
        })))
        p.note { "Dots and the speeds in the legend mark where mean torque falls below 97 % of the demand. Curves end where the search for this limit ended." }
        (plot)
    })
}
