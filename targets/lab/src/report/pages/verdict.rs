//! Verdict on a motor with its file's own controller, and the best of all variants beside it.

use super::sensor_name;
use crate::closed_loop::{LimitOutcome, SpeedLimit};
use crate::report::{Block, Cell, Column, Table};
use crate::results::{Results, Run, Variant};
use crate::text::{grouped, number, quantity, ripple};
use crate::times::sentence;
use std::f64::consts::TAU;

/// The verdict, and what it rests on: name and text of each line.
pub fn verdict(data: &Results) -> Option<(String, Vec<(&'static str, String)>)> {
    let own = data.own.as_ref()?;
    let variant = data.variants.get(own.variant)?;
    let run = variant.runs.first()?;
    let rows = vec![
        ("motor", motor(data)),
        ("controller", controller(data, variant, run)),
        ("limits", own.judgement.bus_limits().unwrap_or_default()),
        ("torque", torque(data, variant, run)),
        ("ripple", ripples(run)),
        ("losses", losses(data, variant)),
        ("step", sentence(&own.times)),
        ("verified", verified(data)),
        ("furthest", furthest(data, own.variant)),
    ];
    let rows = rows.into_iter().filter(|(_, text)| !text.is_empty());
    Some((sentence_of(&own.judgement.verdict), rows.collect()))
}

/// The verdict as the page's first blocks.
pub(super) fn verdict_blocks(data: &Results) -> Vec<Block> {
    let Some((verdict, rows)) = verdict(data) else {
        return Vec::new();
    };
    let columns = [Column::text("What"), Column::text("Found")];
    let mut table = Table::new("verdict", columns);
    for (name, text) in rows {
        table.row([Cell::from(name), Cell::from(text)]);
    }
    let warnings = data.own.iter().flat_map(|own| &own.judgement.warnings);
    let warnings = warnings.map(|warning| Block::Prose(warning.clone()));
    [Block::Prose(format!("**{verdict}**")), Block::Table(table)]
        .into_iter()
        .chain(warnings)
        .collect()
}

/// With a capital and a full stop.
fn sentence_of(verdict: &str) -> String {
    let mut letters = verdict.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    format!("{}.", first.chain(letters).collect::<String>())
}

fn motor(data: &Results) -> String {
    let motor = &data.motor;
    format!(
        "{} pole pairs; rated {}, {}, {} rpm; bus {}",
        motor.pole_pairs,
        quantity(motor.rated_current, "A"),
        quantity(data.torque, "Nm"),
        number(motor.rated_speed * 60.0 / TAU, 0),
        quantity(data.inverter.v_bus, "V"),
    )
}

fn controller(data: &Results, variant: &Variant, run: &Run) -> String {
    format!(
        "{}; {}, {}-bit ADC, {}",
        variant.variant,
        quantity(1.0 / data.inverter.t_s, "Hz"),
        data.inverter.adc_bits,
        sensor_name(run.capture),
    )
}

fn limit_text(limit: &SpeedLimit) -> Option<String> {
    let (rpm, percent) = (limit.limit_rpm?, limit.limit_pct?);
    let beyond = if limit.outcome == LimitOutcome::NotReached {
        "beyond "
    } else {
        ""
    };
    Some(format!(
        "{beyond}{} rpm, {} % of rated speed",
        number(rpm, 0),
        number(percent, 0)
    ))
}

fn torque(data: &Results, variant: &Variant, run: &Run) -> String {
    let torque = quantity(data.demand(variant), "Nm");
    let limit = run.limit.as_ref().and_then(limit_text);
    limit.map_or_else(String::new, |limit| format!("{torque} up to {limit}"))
}

fn ripples(run: &Run) -> String {
    let points = run.points.iter().filter(|point| point.tripped.is_none());
    let all: Vec<String> = points
        .map(|point| {
            format!(
                "{} % at {} rpm",
                ripple(point.figures.ripple_pp_pct),
                number(point.rpm, 0)
            )
        })
        .collect();
    if all.is_empty() {
        return String::new();
    }
    format!("{}, peak to peak", all.join(", "))
}

/// Copper losses of the recorded currents, and the bus current at rated speed.
fn losses(data: &Results, variant: &Variant) -> String {
    let all: Vec<String> = variant
        .records
        .iter()
        .filter(|record| !record.trace.i_a.is_empty())
        .map(|record| {
            let trace = &record.trace;
            let currents = trace.i_a.iter().zip(&trace.i_b);
            let squares = currents.map(|(a, b)| a * a + b * b + (a + b) * (a + b));
            let mean = squares.sum::<f64>() / trace.i_a.len() as f64;
            format!(
                "{} at {} rpm",
                quantity(mean * data.motor.resistance, "W"),
                number(record.rpm, 0)
            )
        })
        .collect();
    if all.is_empty() {
        return String::new();
    }
    let rated = data.own.as_ref().and_then(|own| own.judgement.rated());
    let drawn = rated.and_then(|point| {
        let mean = quantity(point.bus_current_a?, "A");
        let rpm = number(point.rpm, 0);
        Some(format!("; the bus gives a mean of {mean} at {rpm} rpm"))
    });
    format!(
        "{} in the windings{}",
        all.join(", "),
        drawn.unwrap_or_default()
    )
}

fn verified(data: &Results) -> String {
    data.verification
        .as_ref()
        .map_or_else(String::new, |check| {
            let (steps, engine) = (grouped(check.steps), &check.engine);
            match check.mismatches {
                0 => {
                    format!("{steps} steps of {engine} code of all controllers here equal the bit-true model, every bit")
                }
                wrong => {
                    format!("NOT: {engine} code of {wrong} controllers differs from the model")
                }
            }
        })
}

/// The variant that holds the torque to the highest speed, where it is another one.
fn furthest(data: &Results, own: usize) -> String {
    let limit_of = |variant: &Variant| {
        let limit = variant.runs.first()?.limit.as_ref()?;
        limit.limit_pct
    };
    let own_limit = data.variants.get(own).and_then(limit_of).unwrap_or(0.0);
    // Those that make less torque with the same largest set-point are no match.
    let torque_of = |variant: &Variant| data.demand(variant);
    let own_torque = data.variants.get(own).map_or(data.torque, torque_of);
    let best = data
        .variants
        .iter()
        .filter(|variant| torque_of(variant) >= 0.99 * own_torque)
        .filter_map(|variant| Some((limit_of(variant)?, variant)))
        .max_by(|left, right| left.0.total_cmp(&right.0));
    match best {
        // Less is within the tolerance of the search.
        Some((limit, variant)) if limit > own_limit + 1.0 => {
            format!("{}: up to {} %", variant.label, number(limit, 0))
        }
        _ => "no other variant holds the torque further by more than 1 point".to_owned(),
    }
}
