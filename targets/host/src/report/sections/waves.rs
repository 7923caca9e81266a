//! What happens over one electrical turn: phase currents, trajectory, torque.

use super::{TorqueScale, field, figure, legend, nothing, number, plotted, swatch, variant_swatch};
use crate::report::ReportError;
use crate::report::plot::{Wave, palette, trajectory, wave};
use crate::report::window::{Columns, FIRST_DEG, columns};
use hexagen_lab::closed_loop::quasi_square;
use hexagen_lab::results::{Record, Results, Variant};
use maud::{Markup, html};
use std::ops::Range;

/// Columns of a plot over one turn.
pub(in crate::report) const COLUMNS: usize = 480;

/// A plot of one record of one variant.
struct Panel<'a> {
    /// Place of the variant in the table.
    index: usize,
    variant: &'a Variant,
    record: &'a Record,
}

impl Panel<'_> {
    fn caption(&self) -> Markup {
        html! {
            (variant_swatch(self.index))
            span { (self.variant.label) ", " strong { (number(self.record.rpm, 0)) "\u{a0}rpm" } }
        }
    }

    /// On two lines, for narrow plots.
    fn tall_caption(&self) -> Markup {
        html! {
            (variant_swatch(self.index))
            span { (self.variant.label) br; strong { (number(self.record.rpm, 0)) "\u{a0}rpm" } }
        }
    }

    fn describe(&self, what: &str) -> String {
        let rpm = number(self.record.rpm, 0);
        format!("{what} of {} at {rpm} rpm", self.variant.label)
    }
}

/// One panel per variant and speed, variants in rows.
fn panels(data: &Results) -> Vec<Panel<'_>> {
    plotted(data)
        .flat_map(|(index, variant)| {
            variant.records.iter().map(move |record| Panel {
                index,
                variant,
                record,
            })
        })
        .collect()
}

/// Phase currents over one turn, against the ideal quasi-square wave.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn currents(data: &Results) -> Result<Markup, ReportError> {
    let panels: Vec<_> = panels(data)
        .into_iter()
        .map(|panel| {
            let trace = &panel.record.trace;
            let phases = [
                columns(trace, COLUMNS, |k| trace.i_a[k]),
                columns(trace, COLUMNS, |k| trace.i_b[k]),
                columns(trace, COLUMNS, |k| -trace.i_a[k] - trace.i_b[k]),
            ];
            (panel, phases)
        })
        .collect();
    if panels.is_empty() {
        return Ok(nothing("records"));
    }
    let most = panels
        .iter()
        .flat_map(|(_, phases)| phases)
        .flat_map(|columns| columns.most.iter().chain(&columns.least))
        .fold(1.1 * data.current.abs(), |most, i| most.max(i.abs()));
    let ideal: Vec<Vec<(f64, f64)>> = (0..3)
        .map(|phase| ideal_phase(data.current, phase))
        .collect();
    let mut plots = Vec::new();
    for (panel, phases) in panels {
        let plot = wave(&Wave {
            description: &panel.describe("Phase currents"),
            title: "phase current in A",
            range: -most..most,
            signals: palette::PHASES.into_iter().zip(phases).collect(),
            ideal: ideal.clone(),
            demand: None,
        })?;
        plots.push(figure(&panel.caption(), &plot));
    }
    let [a, b, c] = palette::PHASES.map(|color| swatch(color, 2.5, (0.0, 0.0)));
    Ok(html! {
        (legend([
            (a, "phase a".to_owned()),
            (b, "phase b".to_owned()),
            (c, "phase c".to_owned()),
            (field(palette::PHASES[0], 0.22), "ripple of the PWM".to_owned()),
            (swatch(palette::IDEAL, 5.0, (0.0, 0.0)), "ideal quasi-square wave".to_owned()),
        ]))
        p.note { "Lines are means over one control period. Sectors S1 to S6 are those of the true rotor angle; the pair that conducts changes at their borders." }
        div.plots.two { @for plot in plots { (plot) } }
    })
}

/// Corners of the ideal quasi-square current of a phase over the plotted turn.
pub(in crate::report) fn ideal_phase(current: f64, phase: usize) -> Vec<(f64, f64)> {
    (0..6)
        .flat_map(|sector| {
            let from = FIRST_DEG + 60.0 * f64::from(sector);
            let (alpha, beta) = quasi_square((from + 30.0).to_radians(), current);
            let half = 3.0_f64.sqrt() / 2.0;
            let value = match phase {
                0 => alpha,
                1 => -alpha / 2.0 + half * beta,
                _ => -alpha / 2.0 - half * beta,
            };
            [(from, value), (from + 60.0, value)]
        })
        .collect()
}

/// Trajectories of the current in the alpha-beta plane.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn trajectories(data: &Results) -> Result<Markup, ReportError> {
    let panels = panels(data);
    if panels.is_empty() {
        return Ok(nothing("records"));
    }
    let most = panels
        .iter()
        .flat_map(|panel| {
            let trace = &panel.record.trace;
            (0..trace.theta_e.len()).map(|k| trace.i_alpha_beta(k))
        })
        .fold(0.0_f64, |most, (alpha, beta)| {
            most.max(alpha.abs()).max(beta.abs())
        });
    // The corners lie 2/sqrt(3) of the current from the centre, their names outside of them.
    let reach = (1.04 * most).max(1.53 * data.current.abs());
    let mut plots = Vec::new();
    for panel in panels {
        let plot = trajectory(
            &panel.record.trace,
            data.current,
            reach,
            palette::variant(panel.index),
            &panel.describe("Current in the alpha-beta plane"),
        )?;
        plots.push(figure(&panel.tall_caption(), &plot));
    }
    Ok(html! {
        (legend([
            (swatch(palette::IDEAL, 5.0, (0.0, 0.0)), "ideal hexagon between the reference corners (circles) of sectors S1 to S6".to_owned()),
            (swatch(palette::variant(0), 2.5, (0.0, 0.0)), "mean over one control period".to_owned()),
            (swatch(palette::variant(0), 1.0, (0.0, 0.0)), "with the ripple of the PWM, pale".to_owned()),
        ]))
        div.plots.four { @for plot in plots { (plot) } }
    })
}

/// Torque over one turn.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn torque(data: &Results) -> Result<Markup, ReportError> {
    let scale = TorqueScale::of(data);
    let demand = scale.per_nm * data.torque;
    let panels: Vec<(Panel<'_>, Columns)> = panels(data)
        .into_iter()
        .map(|panel| {
            let trace = &panel.record.trace;
            let torque = columns(trace, COLUMNS, |k| scale.per_nm * trace.torque[k]);
            (panel, torque)
        })
        .collect();
    if panels.is_empty() {
        return Ok(nothing("records"));
    }
    let range = torque_range(demand, panels.iter().map(|(_, columns)| columns));
    let mut plots = Vec::new();
    for (panel, columns) in panels {
        let plot = wave(&Wave {
            description: &panel.describe("Torque"),
            title: &format!("torque in {}", scale.unit),
            range: range.clone(),
            signals: vec![(palette::variant(panel.index), columns)],
            ideal: Vec::new(),
            demand: Some(demand),
        })?;
        plots.push(figure(&panel.caption(), &plot));
    }
    Ok(html! {
        (legend([
            (swatch(palette::variant(0), 2.5, (0.0, 0.0)), "mean over one control period, which the ripple figures judge".to_owned()),
            (field(palette::variant(0), 0.22), "ripple of the PWM".to_owned()),
            (swatch(palette::DEMAND, 1.5, (6.0, 4.0)), "demand".to_owned()),
        ]))
        p.note { "The vertical axis does not begin at zero." }
        div.plots.two { @for plot in plots { (plot) } }
    })
}

/// Holds the demand and every signal, with a little room.
pub(in crate::report) fn torque_range<'a>(
    demand: f64,
    signals: impl Iterator<Item = &'a Columns>,
) -> Range<f64> {
    let span = 0.1 * demand.abs().max(1e-9);
    let (least, most) = signals
        .flat_map(|columns| columns.least.iter().chain(&columns.most))
        .fold((demand - span, demand + span), |(least, most), &torque| {
            (least.min(torque), most.max(torque))
        });
    let pad = 0.04 * (most - least);
    least - pad..most + pad
}
