//! Stable ranges of the motor's parameters, computed and simulated.

use super::variant_sign;
use crate::report::plot::{SEARCH, stability};
use crate::report::{Block, Cell, Column, Figure, PHASES, Sign, Table};
use crate::results::{Results, Variant};
use crate::stability::{Parameter, Stability, StabilityCheck};
use crate::text::number;

/// Table of the ranges, and plots of the simulated runs.
pub fn blocks(data: &Results) -> Vec<Block> {
    let variants = data.variants.iter().enumerate();
    let known: Vec<(usize, &Variant, &Stability)> = variants
        .filter_map(|(index, variant)| Some((index, variant, variant.stability.as_ref()?)))
        .collect();
    if known.is_empty() {
        return Block::nothing("stable ranges");
    }
    let mut table = Table::new(
        "",
        [
            Column::text("Variant"),
            Column::number("Inductance", "% of nominal"),
            Column::number("Resistance", "% of nominal"),
        ],
    );
    for (index, variant, known) in &known {
        table.row([
            Cell::from(variant.label.clone()).signed(Some(variant_sign(*index))),
            range_text(known.range.inductance).into(),
            range_text(known.range.resistance).into(),
        ]);
    }
    let mut blocks = vec![
        Block::Note(
            "Range of true over nominal value in which the closed loop's poles, with the emitted coefficients, lie inside the unit circle; one \
             parameter varied at a time, searched from 10 % to 1000 %."
                .to_owned(),
        ),
        Block::Table(table),
    ];
    let figures: Vec<Figure> = known
        .iter()
        .flat_map(|&(index, variant, known)| {
            let parameters = [Parameter::Inductance, Parameter::Resistance].into_iter();
            parameters.flat_map(move |parameter| plots(index, variant, known, parameter))
        })
        .collect();
    if !figures.is_empty() {
        blocks.extend(simulated(figures));
    }
    blocks
}

fn simulated(figures: Vec<Figure>) -> [Block; 4] {
    [
        Block::Heading("Simulation with one parameter varied".to_owned()),
        Block::Note(
            "Runs just inside, just outside and well inside each edge, judged by the criterion of the robustness sheet. \
             Higher resistances would leave too little bus voltage for the current."
                .to_owned(),
        ),
        Block::Legend(vec![
            Sign::line(PHASES[0], 3.0).means("edges of the computed stable range, tinted"),
            Sign::Dot(PHASES[0]).means("stable run"),
            Sign::Cross(PHASES[2])
                .means("unstable run (ripple beyond the axis is drawn at its end)"),
        ]),
        Block::Figures {
            columns: 2,
            figures,
        },
    ]
}

/// One plot per speed at which the parameter was varied.
fn plots(index: usize, variant: &Variant, known: &Stability, parameter: Parameter) -> Vec<Figure> {
    let (name, range) = match parameter {
        Parameter::Inductance => ("inductance", known.range.inductance),
        Parameter::Resistance => ("resistance", known.range.resistance),
    };
    let checks = known.checks.iter();
    let mut checks: Vec<&StabilityCheck> = checks
        .filter(|check| check.parameter == parameter)
        .collect();
    checks.sort_by(|a, b| a.rpm.total_cmp(&b.rpm).then(a.factor.total_cmp(&b.factor)));
    checks
        .chunk_by(|a, b| a.rpm == b.rpm)
        .map(|checks| {
            let rpm = number(checks[0].rpm, 0);
            let label = &variant.label;
            let description = format!("Ripple of {label} over {name} at {rpm} rpm");
            let title = format!("true over nominal {name}");
            let plot = stability(description, checks, range, title);
            let caption = format!("{label}, {name}, **{rpm}\u{a0}rpm**");
            Figure::new(Some(variant_sign(index)), caption, plot)
        })
        .collect()
}

fn range_text((low, high): (f64, f64)) -> String {
    let bound = |ratio: f64, beyond: &str| {
        if (SEARCH.0..SEARCH.1).contains(&ratio) {
            number(100.0 * ratio, 1)
        } else {
            format!("{beyond} {}", number(100.0 * ratio, 0))
        }
    };
    format!("{} to {}", bound(low, "\u{2264}"), bound(high, "\u{2265}"))
}
