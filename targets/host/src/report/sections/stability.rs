//! Stable ranges of the motor's parameters, computed and simulated.

use super::{figure, legend, nothing, number, swatch, variant_swatch};
use crate::report::ReportError;
use crate::report::plot::{SEARCH, palette, stability};
use hexagen_lab::results::{Results, Variant};
use hexagen_lab::stability::{Parameter, Stability, StabilityCheck};
use maud::{Markup, html};

/// Table of the ranges, and plots of the simulated runs.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn section(data: &Results) -> Result<Markup, ReportError> {
    let known: Vec<(usize, &Variant, &Stability)> = data
        .variants
        .iter()
        .enumerate()
        .filter_map(|(index, variant)| Some((index, variant, variant.stability.as_ref()?)))
        .collect();
    if known.is_empty() {
        return Ok(nothing("stable ranges"));
    }
    let mut plots = Vec::new();
    for &(index, variant, known) in &known {
        for parameter in [Parameter::Inductance, Parameter::Resistance] {
            plots.extend(parameter_plots(index, variant, known, parameter)?);
        }
    }
    Ok(html! {
        p.note { "True over stated value within which the closed loop's poles, with the emitted coefficients, lie inside the unit circle; one parameter off at a time, searched from 10 % to 1000 %." }
        div.scroll {
            table {
                thead {
                    tr {
                        th { "Variant" }
                        th.number { "Inductance, % of stated" }
                        th.number { "Resistance, % of stated" }
                    }
                }
                tbody {
                    @for (index, variant, known) in &known {
                        tr {
                            td { (variant_swatch(*index)) " " (variant.label) }
                            td.number { (range_text(known.range.inductance)) }
                            td.number { (range_text(known.range.resistance)) }
                        }
                    }
                }
            }
        }
        @if !plots.is_empty() {
            h3 { "Simulated with one parameter off" }
            p.note { "Runs just inside and just outside of each edge and one well inside of it, judged by the rule of the robustness sheet. Resistances beyond those shown leave the bus too little voltage for the current." }
            (legend([
                (swatch(palette::PHASES[0], 3.0, (0.0, 0.0)), "edges of the computed stable range, tinted".to_owned()),
                (dot(), "run that stays stable".to_owned()),
                (cross(), "run that does not (ripple beyond the axis is drawn at its end)".to_owned()),
            ]))
            div.plots.two { @for plot in plots { (plot) } }
        }
    })
}

/// One plot per speed at which the parameter was varied.
fn parameter_plots(
    index: usize,
    variant: &Variant,
    known: &Stability,
    parameter: Parameter,
) -> Result<Vec<Markup>, ReportError> {
    let (name, range) = match parameter {
        Parameter::Inductance => ("inductance", known.range.inductance),
        Parameter::Resistance => ("resistance", known.range.resistance),
    };
    let mut checks: Vec<&StabilityCheck> = known
        .checks
        .iter()
        .filter(|check| check.parameter == parameter)
        .collect();
    checks.sort_by(|a, b| a.rpm.total_cmp(&b.rpm).then(a.factor.total_cmp(&b.factor)));
    checks
        .chunk_by(|a, b| a.rpm == b.rpm)
        .map(|checks| {
            let rpm = number(checks[0].rpm, 0);
            let plot = stability(
                checks,
                range,
                &format!("true over stated {name}"),
                &format!("Ripple of {} over {name} at {rpm} rpm", variant.label),
            )?;
            let caption = html! {
                (variant_swatch(index))
                span { (variant.label) ", " (name) ", " strong { (rpm) "\u{a0}rpm" } }
            };
            Ok(figure(&caption, &plot))
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

fn dot() -> Markup {
    let color = palette::css(palette::PHASES[0]);
    html! { svg.swatch viewBox="0 0 30 12" aria-hidden="true" { circle cx="15" cy="6" r="4" fill=(color) {} } }
}

fn cross() -> Markup {
    let color = palette::css(palette::PHASES[2]);
    html! {
        svg.swatch viewBox="0 0 30 12" aria-hidden="true" {
            line x1="11" y1="2" x2="19" y2="10" stroke=(color) stroke-width="2" {}
            line x1="11" y1="10" x2="19" y2="2" stroke=(color) stroke-width="2" {}
        }
    }
}
