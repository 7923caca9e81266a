//! Harmonics of the phase current against the ideal wave, and of the torque.

use super::{figure, legend, nothing, number, plotted, swatch, variant_legend};
use crate::report::ReportError;
use crate::report::plot::{Bars, Group, bars, palette};
use hexagen_lab::closed_loop::{
    harmonic_of_quasi_square, harmonics_of_current, harmonics_of_torque,
};
use hexagen_lab::results::Results;
use maud::{Markup, html};

/// Orders of the current's plot: those that the quasi-square wave has.
const CURRENT_ORDERS: [usize; 8] = [5, 7, 11, 13, 17, 19, 23, 25];

/// Orders of the torque's plot.
const TORQUE_ORDERS: [usize; 4] = [6, 12, 18, 24];

/// Highest order that is computed.
const HIGHEST: usize = 25;

/// Spectra at one speed: a list of harmonics per plotted variant.
struct AtSpeed {
    rpm: f64,
    colors: Vec<plotters::style::RGBColor>,
    current: Vec<Vec<Option<f64>>>,
    torque: Vec<Vec<Option<f64>>>,
}

fn at_speed(data: &Results, rpm: f64) -> AtSpeed {
    let mut result = AtSpeed {
        rpm,
        colors: Vec::new(),
        current: Vec::new(),
        torque: Vec::new(),
    };
    for (index, variant) in plotted(data) {
        let record = variant.records.iter().find(|record| record.rpm == rpm);
        if let Some(record) = record {
            result.colors.push(palette::variant(index));
            result
                .current
                .push(harmonics_of_current(&record.trace, HIGHEST));
            result
                .torque
                .push(harmonics_of_torque(&record.trace, HIGHEST));
        }
    }
    result
}

/// The plots.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn section(data: &Results) -> Result<Markup, ReportError> {
    let speeds: Vec<AtSpeed> = data
        .speeds_rpm
        .iter()
        .map(|&rpm| at_speed(data, rpm))
        .filter(|spectra| !spectra.colors.is_empty())
        .collect();
    if speeds.is_empty() {
        return Ok(nothing("records"));
    }
    let current_top = top(
        speeds.iter().flat_map(|s| &s.current),
        &CURRENT_ORDERS,
        22.0,
    );
    let torque_top = top(speeds.iter().flat_map(|s| &s.torque), &TORQUE_ORDERS, 1.0);
    let mut current = Vec::new();
    let mut torque = Vec::new();
    for spectra in &speeds {
        let rpm = number(spectra.rpm, 0);
        let plot = bars(&Bars {
            description: &format!("Harmonics of the phase current at {rpm} rpm"),
            x_title: "order of the harmonic",
            y_title: "% of the fundamental",
            top: current_top,
            colors: spectra.colors.clone(),
            groups: groups(&spectra.current, &CURRENT_ORDERS, &|order| {
                Some(harmonic_of_quasi_square(order))
            }),
        })?;
        current.push(figure(
            &html! { span { "Phase current, " strong { (rpm) " rpm" } } },
            &plot,
        ));
        let plot = bars(&Bars {
            description: &format!("Harmonics of the torque at {rpm} rpm"),
            x_title: "order of the harmonic",
            y_title: "% of mean torque",
            top: torque_top,
            colors: spectra.colors.clone(),
            groups: groups(&spectra.torque, &TORQUE_ORDERS, &|_| None),
        })?;
        torque.push(figure(
            &html! { span { "Torque, " strong { (rpm) " rpm" } } },
            &plot,
        ));
    }
    Ok(html! {
        (variant_legend(data))
        (legend([(
            swatch(palette::INK, 2.0, (0.0, 0.0)),
            "ideal quasi-square wave: 100 % divided by the order (an ideal torque has no harmonic)".to_owned(),
        )]))
        div.plots.two { @for plot in current { (plot) } }
        div.plots.two { @for plot in torque { (plot) } }
    })
}

fn groups(
    spectra: &[Vec<Option<f64>>],
    orders: &[usize],
    ideal: &dyn Fn(usize) -> Option<f64>,
) -> Vec<Group> {
    let group = |&order: &usize| Group {
        name: order.to_string(),
        values: spectra.iter().map(|spectrum| spectrum[order]).collect(),
        ideal: ideal(order),
    };
    orders.iter().map(group).collect()
}

/// The vertical axis' end: the greatest harmonic, at least `least`, with a little room.
fn top<'a>(
    spectra: impl Iterator<Item = &'a Vec<Option<f64>>>,
    orders: &[usize],
    least: f64,
) -> f64 {
    let values = spectra.flat_map(|spectrum| orders.iter().filter_map(|&order| spectrum[order]));
    1.06 * values.fold(least, f64::max).min(100.0)
}
