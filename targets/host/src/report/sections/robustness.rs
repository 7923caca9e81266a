//! The robustness sheet: controllers over disturbances, coloured by distance from the undisturbed run.

use super::{TorqueScale, legend, nothing, number, ripple, variant_text};
use hexagen_lab::results::Results;
use hexagen_lab::robustness::{Cell, DisturbedFigures, Heat, Outcome, Robustness, SWING_RULE};
use maud::{Markup, html};

/// The table, its legend and the rule by which a run oscillates.
pub fn section(data: &Results) -> Markup {
    let Some(sheet) = &data.robustness else {
        return nothing("robustness sheet");
    };
    let scale = TorqueScale::of(data);
    let columns: Vec<_> = sheet
        .controllers
        .iter()
        .filter(|column| column.refused.is_none())
        .collect();
    let refused = sheet.controllers.iter().filter_map(|column| {
        let reason = column.refused.as_ref()?;
        Some((&column.controller, reason))
    });
    let several = columns.len().to_string();
    html! {
        p.note {
            "Controllers generated for the motor file, run as fixed-point code on plants that differ from it in one point: mean torque in "
            (scale.unit) ", and its ripple in percent of the mean, peak to peak and RMS."
        }
        p.note { (SWING_RULE) }
        (legend(Heat::ALL.map(|heat| (html! { span class={ "heat " (heat.name()) } {} }, heat.meaning().to_owned()))))
        p.note { "Points are percent of the torque that the current should give on this plant, or of RMS ripple added." }
        div.scroll {
            table.heat {
                thead {
                    tr {
                        th rowspan="2" { "Disturbance" }
                        @for rpm in &sheet.speeds_rpm {
                            th.group.edge colspan=(several) { (number(*rpm, 0)) " rpm" }
                        }
                    }
                    tr {
                        @for _ in &sheet.speeds_rpm {
                            @for (place, column) in columns.iter().enumerate() {
                                th.number.edge[place == 0] { (variant_text(&column.controller)) }
                            }
                        }
                    }
                }
                tbody {
                    @for (place, name) in sheet.disturbances.iter().enumerate() {
                        tr.none[place == 0] {
                            th scope="row" { (printed(name)) }
                            @for speed in 0..sheet.speeds_rpm.len() {
                                @for column in &columns {
                                    (entry(sheet.cell(column, place, speed), &scale))
                                }
                            }
                        }
                    }
                }
            }
        }
        @for (controller, reason) in refused {
            p { code { (controller) } " is not there: " (reason) }
        }
        @for (controller, cell, reason) in refused_cells(sheet) {
            p { code { (controller) } ", " (printed(&cell.disturbance)) ": " (reason) }
        }
    }
}

/// Cells that were refused, once per disturbance.
fn refused_cells(sheet: &Robustness) -> impl Iterator<Item = (&str, &Cell, &str)> {
    let speeds = sheet.speeds_rpm.len();
    sheet.controllers.iter().flat_map(move |column| {
        let first = column.cells.iter().step_by(speeds.max(1));
        first.filter_map(|cell| Some((&*column.controller, cell, cell.refused.as_deref()?)))
    })
}

fn entry(cell: Option<&Cell>, scale: &TorqueScale) -> Markup {
    let Some(figures) = cell.and_then(|cell| cell.figures.as_ref()) else {
        return html! { td.number { "\u{2013}" } };
    };
    let DisturbedFigures {
        outcome,
        heat,
        mean_torque_nm: torque,
        ripple_pp_pct: pp,
        ripple_rms_pct: rms,
        ..
    } = *figures;
    html! {
        td class={ "number " (heat.name()) } {
            @if outcome == Outcome::Runs {
                (scale.text(torque, 0)) " " small { (ripple(pp)) " / " (ripple(rms)) }
            } @else {
                (outcome.name())
            }
        }
    }
}

/// A disturbance's name with the signs of print.
fn printed(name: &str) -> String {
    name.replace('-', "\u{2212}")
        .replace("\u{2212}bit", "-bit")
        .replace(" deg", "\u{b0}")
        .replace(" us", " \u{b5}s")
}
