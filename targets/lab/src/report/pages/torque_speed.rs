//! Mean torque over speed, all variants.

use crate::closed_loop::{Held, LimitOutcome, Side};
use crate::envelope::TorqueBounds;
use crate::report::plot::{Curve, TorqueSpeed, dash, torque_speed};
use crate::report::{Block, Figure, Sign, Switch, variant};
use crate::results::{Results, Variant};
use crate::text::{TorqueScale, number};
use std::f64::consts::TAU;

/// The plot and its legend.
pub fn blocks(data: &Results) -> Vec<Block> {
    let variants = data.variants.iter().enumerate();
    let variants: Vec<(usize, &Variant)> = variants
        .filter(|(_, variant)| !variant.torque_speed.is_empty())
        .collect();
    if variants.is_empty() {
        return Block::nothing("torque-speed curves");
    }
    let scale = TorqueScale::of(data.torque);
    let curves = variants.iter().map(|&(index, of)| Curve {
        name: of.label.clone(),
        color: variant(index),
        index,
        points: of
            .torque_speed
            .iter()
            .map(|&(rpm, torque)| (rpm, scale.per_nm * torque))
            .collect(),
        limit_rpm: limit_rpm(of),
    });
    let own = data.own_variant();
    let demand = own.map_or(data.torque, |own| data.demand(own));
    let plot = torque_speed(&TorqueSpeed {
        torque: scale.per_nm * demand,
        unit: scale.unit,
        rated_rpm: data.motor.rated_speed * 60.0 / TAU,
        curves: curves.collect(),
        bounds: bounds(&data.bounds, &scale),
        marks: &data.marks,
        held: data.held,
    });
    let keys = variants.iter().map(|&(index, of)| {
        let text = format!("{}{}", of.label, limit_text(of, &scale));
        let key = Sign::Line(variant(index), 3.0, dash(index)).means(text);
        Switch {
            variant: index,
            key,
        }
    });
    let held = match data.held {
        Held::AtLeast => "falls below 97 %",
        Held::Within => "is no longer within 3 %",
    };
    let note = format!(
        "Dots, and speeds in the legend, are those at which mean torque {held} of the demand (or of the torque in the legend, for a limited \
         set-point). Curves end where the search for this limit ended. Dotted, where they cross the plot: the envelope, up to which the bus \
         drives the whole current of the own controller's reference, and the bound of any current within that reference's peak."
    );
    vec![
        Block::Switches(keys.collect()),
        Block::Note(note),
        Block::Figures {
            columns: 1,
            figures: vec![Figure::new(None, "", plot)],
        },
    ]
}

/// The bounds by name, in the plot's unit.
fn bounds(bounds: &TorqueBounds, scale: &TorqueScale) -> Vec<(&'static str, Vec<(f64, f64)>)> {
    let curves = [
        ("envelope of the own drive", &bounds.envelope),
        ("bound of any current", &bounds.any_profile),
    ];
    let scaled = |points: &Vec<(f64, f64)>| {
        let points = points.iter();
        points
            .map(|&(rpm, torque)| (rpm, scale.per_nm * torque))
            .collect()
    };
    curves.map(|(name, points)| (name, scaled(points))).to_vec()
}

fn limit_rpm(variant: &Variant) -> Option<f64> {
    let run = variant.runs.first()?;
    run.limit.as_ref()?.limit_rpm
}

/// The limit in the legend, with a leading space.
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
        format!(" at {torque}\u{a0}{} (maximum)", scale.unit)
    });
    // Falling below is the usual case, which the note covers.
    let why = limit.why().filter(|_| limit.lost != Some(Side::Below));
    let why = why.map_or_else(String::new, |why| format!(": {why}"));
    format!(" ({speed}{at}{why})")
}
