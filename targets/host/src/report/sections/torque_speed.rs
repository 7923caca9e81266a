//! Mean torque over speed, all variants.

use super::{TorqueScale, legend, nothing, number, swatch};
use crate::report::ReportError;
use crate::report::plot::{Curve, TorqueSpeed, dash, palette, torque_speed};
use hexagen_lab::closed_loop::{Held, LimitOutcome, Side};
use hexagen_lab::results::{Results, Variant};
use maud::{Markup, html};
use std::f64::consts::TAU;

fn limit_rpm(variant: &Variant) -> Option<f64> {
    let run = variant.runs.first()?;
    run.limit.as_ref()?.limit_rpm
}

/// The limit as the legend has it, with the space before it.
fn limit_text(variant: &Variant, scale: &TorqueScale) -> String {
    let Some(limit) = variant.runs.first().and_then(|run| run.limit.as_ref()) else {
        return String::new();
    };
    let speed = match (limit.outcome, limit.limit_rpm) {
        (LimitOutcome::NeverHeld, _) => "never held".to_owned(),
        (LimitOutcome::NotReached, Some(rpm)) => format!("above {} rpm", number(rpm, 0)),
        (_, Some(rpm)) => format!("{} rpm", number(rpm, 0)),
        (_, None) => return String::new(),
    };
    let at = variant.reach.map_or_else(String::new, |torque| {
        let torque = scale.text(torque, 0);
        format!(" at {torque}\u{a0}{}, its most", scale.unit)
    });
    // That it falls off is the rule, and what the note below says.
    let why = limit.why().filter(|_| limit.lost != Some(Side::Below));
    let why = why.map_or_else(String::new, |why| format!(": {why}"));
    format!(" ({speed}{at}{why})")
}

/// The plot and its legend.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn section(data: &Results) -> Result<Markup, ReportError> {
    let variants: Vec<(usize, &Variant)> = data
        .variants
        .iter()
        .enumerate()
        .filter(|(_, variant)| !variant.torque_speed.is_empty())
        .collect();
    if variants.is_empty() {
        return Ok(nothing("torque-speed curves"));
    }
    let scale = TorqueScale::of(data);
    let plot = torque_speed(&TorqueSpeed {
        torque: scale.per_nm * data.torque,
        unit: scale.unit,
        rated_rpm: data.motor.rated_speed * 60.0 / TAU,
        curves: variants
            .iter()
            .map(|&(index, variant)| Curve {
                color: palette::variant(index),
                index,
                points: variant
                    .torque_speed
                    .iter()
                    .map(|&(rpm, torque)| (rpm, scale.per_nm * torque))
                    .collect(),
                limit_rpm: limit_rpm(variant),
            })
            .collect(),
        marks: &data.marks,
        held: data.held,
    })?;
    Ok(html! {
        (legend(variants.iter().map(|&(index, variant)| {
            let text = format!("{}{}", variant.label, limit_text(variant, &scale));
            (swatch(palette::variant(index), 3.0, dash(index)), text)
        })))
        p.note { "Dots and the speeds in the legend mark where mean torque "
            (match data.held {
                Held::AtLeast => "falls below 97 %",
                Held::Within => "is no longer within 3 %",
            })
            " of the demand (of the torque given in the legend, where a limited set-point cannot ask for more). Curves end where the search for this limit ended." }
        (plot)
    })
}
