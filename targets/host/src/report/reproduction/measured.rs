//! Figures of runs: 4 and 14 to 20.

use crate::report::ReportError;
use crate::report::plot::{
    Bars, Curve, Group, Path, Plane, TorqueSpeed, Wave, bars, corners, dash, means, palette, plane,
    torque_speed, trajectory, wave,
};
use crate::report::sections::waves::{COLUMNS, ideal_phase, torque_range};
use crate::report::sections::{field, figure, legend, number, ripple, swatch};
use crate::report::window::{Columns, columns};
use hexagen_lab::closed_loop::{Held, LimitOutcome};
use hexagen_lab::closed_loop::{harmonic_of_quasi_square, harmonics_of_current, hexagon};
use hexagen_lab::reproduction::{Method, Point, Reading, Reproduction};
use hexagen_lab::results::SpeedMark;
use maud::{Markup, html};
use plotters::style::RGBColor;
use std::f64::consts::TAU;

/// Orders of the current's spectrum.
const ORDERS: [usize; 8] = [5, 7, 11, 13, 17, 19, 23, 25];

/// Highest order that is computed.
const HIGHEST: usize = 25;

/// A record in a figure.
struct Panel<'a> {
    method: Method,
    reading: Reading,
    point: &'a Point,
}

impl Panel<'_> {
    fn color(&self) -> RGBColor {
        color(self.reading)
    }

    fn caption(&self) -> Markup {
        html! {
            (swatch(self.color(), 3.0, (0.0, 0.0)))
            span { "(" (self.method.letter()) ") " (self.method.name()) ", " strong { (self.reading.name()) } }
        }
    }

    fn describe(&self, what: &str) -> String {
        let rpm = number(self.point.rpm, 0);
        let (method, reading) = (self.method.name(), self.reading.name());
        format!("{what} of {method}, {reading} reading, at {rpm} rpm")
    }

    /// The plot below its caption; of a tripped drive, what happened.
    fn figure(
        &self,
        plot: impl FnOnce() -> Result<maud::PreEscaped<String>, ReportError>,
    ) -> Result<Markup, ReportError> {
        Ok(match &self.point.trip {
            None => figure(&self.caption(), &plot()?),
            Some(trip) => html! {
                figure.nothing {
                    figcaption { (self.caption()) }
                    p.note { "Nothing to show: " (trip) "." }
                }
            },
        })
    }
}

fn color(reading: Reading) -> RGBColor {
    match reading {
        Reading::Literal => palette::variant(1),
        Reading::Corrected => palette::variant(0),
    }
}

fn panels(data: &Reproduction, speed: usize) -> Vec<Panel<'_>> {
    let methods = Method::ALL.into_iter();
    methods
        .flat_map(|method| {
            Reading::ALL.map(|reading| Panel {
                method,
                reading,
                point: &data.methods[method.index()].of(reading).points[speed],
            })
        })
        .collect()
}

fn reading_swatches() -> [(Markup, String); 2] {
    Reading::ALL.map(|reading| {
        let sign = swatch(color(reading), 3.0, (0.0, 0.0));
        (sign, format!("{} reading", reading.name()))
    })
}

fn reading_fields() -> [(Markup, String); 2] {
    Reading::ALL.map(|reading| {
        let sign = field(color(reading), 1.0);
        (sign, format!("{} reading", reading.name()))
    })
}

/// Figure 4: a real trajectory at low and at high speed against the ideal one.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn figure_4(data: &Reproduction) -> Result<Markup, ReportError> {
    let run = &data.methods[Method::PiPwm.index()].literal;
    let [low, high] = &run.points;
    let [low_path, high_path] = [low, high].map(|point| means(&point.trace));
    let colors = [palette::variant(2), palette::variant(3)];
    let most = low_path.iter().chain(&high_path);
    let most = most.fold(0.0_f64, |most, (x, y)| most.max(x.abs()).max(y.abs()));
    let plot = plane(&Plane {
        description: "Real trajectories of the current at low and high speed against the ideal one",
        titles: ["i_alpha in A", "i_beta in A"],
        reach: (1.06 * most).max(1.45 * data.current.abs()),
        width: 550.0,
        paths: vec![
            Path::solid(hexagon(data.current), palette::IDEAL, 3.0),
            Path::solid(low_path, colors[0], 1.4),
            Path::solid(high_path, colors[1], 1.4),
        ],
        points: corners(data.current, "S"),
    })?;
    Ok(html! {
        (legend([
            (swatch(colors[0], 2.5, (0.0, 0.0)), format!("(i) low speed, {} rpm", number(low.rpm, 0))),
            (swatch(palette::IDEAL, 5.0, (0.0, 0.0)), "(ii) ideal".to_owned()),
            (swatch(colors[1], 2.5, (0.0, 0.0)), format!("(iii) high speed, {} rpm", number(high.rpm, 0))),
        ]))
        p.note {
            "The figure is about commutation with little voltage to spare; shown is the drive that is nearest to a conventional one, PI-PWM in the literal reading. "
            "At high speed the incoming current rises too slowly, and the trajectory falls inside of the hexagon."
        }
        div.plots.one { (figure(&html! { "Trajectory of the current, means over one control period" }, &plot)) }
    })
}

/// Figures 14 and 15: phase current and its spectrum.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn currents(data: &Reproduction, speed: usize) -> Result<Markup, ReportError> {
    let panels: Vec<(Panel<'_>, Columns)> = panels(data, speed)
        .into_iter()
        .map(|panel| {
            let trace = &panel.point.trace;
            let current = columns(trace, COLUMNS, |k| trace.i_a[k]);
            (panel, current)
        })
        .collect();
    let most = panels
        .iter()
        .flat_map(|(_, columns)| columns.most.iter().chain(&columns.least))
        .fold(1.1 * data.current.abs(), |most, i| most.max(i.abs()));
    let mut waves = Vec::new();
    for (panel, columns) in panels {
        let ideal = vec![ideal_phase(data.current, 0)];
        waves.push(panel.figure(|| {
            wave(&Wave {
                description: &panel.describe("Current of phase a"),
                title: "current of phase a in A",
                range: -most..most,
                signals: vec![(panel.color(), columns)],
                ideal,
                demand: None,
            })
        })?);
    }
    let [literal, corrected] = reading_swatches();
    Ok(html! {
        (legend([
            literal,
            corrected,
            (field(palette::variant(0), 0.22), "ripple of the PWM".to_owned()),
            (swatch(palette::IDEAL, 5.0, (0.0, 0.0)), "ideal quasi-square wave".to_owned()),
        ]))
        div.plots.two { @for wave in waves { (wave) } }
        (current_spectra(data, speed)?)
    })
}

fn current_spectra(data: &Reproduction, speed: usize) -> Result<Markup, ReportError> {
    let spectra: Vec<(Method, [Vec<Option<f64>>; 2])> = Method::ALL
        .into_iter()
        .map(|method| {
            let of = |reading| {
                let point = &data.methods[method.index()].of(reading).points[speed];
                match point.trip {
                    None => harmonics_of_current(&point.trace, HIGHEST),
                    Some(_) => vec![None; HIGHEST + 1],
                }
            };
            (method, Reading::ALL.map(of))
        })
        .collect();
    let values = spectra
        .iter()
        .flat_map(|(_, both)| both)
        .flat_map(|spectrum| ORDERS.map(|order| spectrum[order]));
    let top = 1.06 * values.flatten().fold(22.0, f64::max).min(60.0);
    let mut plots = Vec::new();
    for (method, both) in &spectra {
        let plot = bars(&Bars {
            description: &format!("Spectrum of the phase current of {}", method.name()),
            x_title: "order of the harmonic",
            y_title: "% of the fundamental",
            top,
            colors: Reading::ALL.map(color).to_vec(),
            groups: ORDERS
                .iter()
                .map(|&order| Group {
                    name: order.to_string(),
                    values: both.iter().map(|spectrum| spectrum[order]).collect(),
                    ideal: Some(harmonic_of_quasi_square(order)),
                })
                .collect(),
        })?;
        let caption = html! { "(" (method.letter()) ") " (method.name()) ", spectrum" };
        plots.push(figure(&caption, &plot));
    }
    let [literal, corrected] = reading_fields();
    Ok(html! {
        h3 { "Spectra" }
        (legend([
            literal,
            corrected,
            (swatch(palette::INK, 2.0, (0.0, 0.0)), "ideal quasi-square wave: 100 % divided by the order".to_owned()),
        ]))
        div.plots.two { @for plot in plots { (plot) } }
    })
}

/// Figures 16 and 17: torque with its 6th and 12th harmonic.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn torques(data: &Reproduction, speed: usize) -> Result<Markup, ReportError> {
    let panels: Vec<(Panel<'_>, Columns)> = panels(data, speed)
        .into_iter()
        .map(|panel| {
            let trace = &panel.point.trace;
            let torque = columns(trace, COLUMNS, |k| trace.torque[k]);
            (panel, torque)
        })
        .collect();
    let running = panels
        .iter()
        .filter(|(panel, _)| panel.point.trip.is_none());
    let range = torque_range(data.torque, running.map(|(_, columns)| columns));
    let mut waves = Vec::new();
    for (panel, columns) in panels {
        waves.push(panel.figure(|| {
            wave(&Wave {
                description: &panel.describe("Torque"),
                title: "torque in Nm",
                range: range.clone(),
                signals: vec![(panel.color(), columns)],
                ideal: Vec::new(),
                demand: Some(data.torque),
            })
        })?);
    }
    let [literal, corrected] = reading_swatches();
    Ok(html! {
        (legend([
            literal,
            corrected,
            (field(palette::variant(0), 0.22), "ripple of the PWM".to_owned()),
            (swatch(palette::DEMAND, 1.5, (6.0, 4.0)), "demand".to_owned()),
        ]))
        p.note { "Lines are means over one control period. The vertical axis does not begin at zero." }
        div.plots.two { @for wave in waves { (wave) } }
        (torque_harmonics(data, speed)?)
        (torque_table(data, speed))
    })
}

fn torque_harmonics(data: &Reproduction, speed: usize) -> Result<Markup, ReportError> {
    let value = |method: Method, reading, order| {
        let point = &data.methods[method.index()].of(reading).points[speed];
        match order {
            6 => point.figures.h6_pct,
            _ => point.figures.h12_pct,
        }
    };
    let orders = [6, 12];
    let values = Method::ALL
        .into_iter()
        .flat_map(|method| {
            orders.map(|order| Reading::ALL.map(|reading| value(method, reading, order)))
        })
        .flatten();
    let top = 1.06 * values.flatten().fold(1.0, f64::max).min(60.0);
    let mut plots = Vec::new();
    for order in orders {
        let plot = bars(&Bars {
            description: &format!("Harmonic {order} of the torque of all methods"),
            x_title: "method",
            y_title: "% of mean torque",
            top,
            colors: Reading::ALL.map(color).to_vec(),
            groups: Method::ALL
                .iter()
                .map(|&method| Group {
                    name: format!("({}) {}", method.letter(), method.name()),
                    values: Reading::ALL
                        .map(|reading| value(method, reading, order))
                        .to_vec(),
                    ideal: None,
                })
                .collect(),
        })?;
        plots.push(figure(
            &html! { (order) "th harmonic of the torque" },
            &plot,
        ));
    }
    Ok(html! {
        (legend(reading_fields()))
        div.plots.two { @for plot in plots { (plot) } }
    })
}

fn torque_table(data: &Reproduction, speed: usize) -> Markup {
    html! {
        div.scroll {
            table {
                thead {
                    tr {
                        th { "Method" } th { "Reading" } th.number { "Mean, Nm" }
                        th.number { "Ripple pp, %" } th.number { "RMS, %" } th.number { "6th, %" } th.number { "12th, %" }
                    }
                }
                tbody {
                    @for panel in panels(data, speed) {
                        @let figures = &panel.point.figures;
                        tr {
                            td { @if panel.reading == Reading::Literal { "(" (panel.method.letter()) ") " (panel.method.name()) } }
                            td { (panel.reading.name()) }
                            td.number { (number(figures.mean_torque_nm, 3)) }
                            @for value in [figures.ripple_pp_pct, figures.ripple_rms_pct, figures.h6_pct, figures.h12_pct] {
                                td.number { (ripple(value)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Figures 18 and 19: trajectories in the alpha-beta plane.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn trajectories(data: &Reproduction, speed: usize) -> Result<Markup, ReportError> {
    let panels = panels(data, speed);
    let most = panels
        .iter()
        .flat_map(|panel| {
            let trace = &panel.point.trace;
            (0..trace.theta_e.len()).map(|k| trace.i_alpha_beta(k))
        })
        .fold(0.0_f64, |most, (x, y)| most.max(x.abs()).max(y.abs()));
    let reach = (1.04 * most).max(1.53 * data.current.abs());
    let mut plots = [Vec::new(), Vec::new()];
    for panel in &panels {
        let plot = panel.figure(|| {
            trajectory(
                &panel.point.trace,
                data.current,
                reach,
                panel.color(),
                &panel.describe("Current in the alpha-beta plane"),
            )
        })?;
        let off = panel.point.trip.is_none().then(|| {
            html! { p.note { (number(panel.point.hexagon_rms_a, 2)) "\u{a0}A off the hexagon (RMS)" } }
        });
        plots[panel.reading as usize]
            .push(html! { div { (plot) @if let Some(off) = off { (off) } } });
    }
    let [literal, corrected] = reading_swatches();
    Ok(html! {
        (legend([
            literal,
            corrected,
            (swatch(palette::IDEAL, 5.0, (0.0, 0.0)), "ideal hexagon between the reference corners of S1 to S6".to_owned()),
        ]))
        p.note { "Solid: mean over one control period, whose RMS distance from the hexagon's outline stands below; pale: with the ripple of the PWM." }
        @for plots in plots { div.plots.four { @for plot in plots { (plot) } } }
    })
}

/// Figure 20: torque over speed.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn figure_20(data: &Reproduction) -> Result<Markup, ReportError> {
    let mark = |label: &str, percent| SpeedMark {
        label: label.to_owned(),
        percent,
    };
    let marks = [
        mark("PI-PWM (paper)", 67.0),
        mark("predictive (paper)", 85.0),
        mark("PDCC (paper)", 87.0),
    ];
    let mut plots = Vec::new();
    for reading in Reading::ALL {
        let runs = Method::ALL.map(|method| (method, data.methods[method.index()].of(reading)));
        let is_lost = |points: &[Point; 2]| points.iter().all(|point| point.trip.is_some());
        let plot = torque_speed(&TorqueSpeed {
            torque: data.torque,
            unit: "Nm",
            rated_rpm: data.motor.rated_speed * 60.0 / TAU,
            curves: runs
                .iter()
                .filter(|(_, run)| !is_lost(&run.points))
                .map(|(method, run)| Curve {
                    color: palette::variant(method.index()),
                    index: method.index(),
                    points: run.curve.clone(),
                    limit_rpm: run.limit.limit_rpm,
                })
                .collect(),
            marks: &marks,
            held: Held::AtLeast,
        })?;
        let items = runs.iter().map(|(method, run)| {
            let limit = match (run.limit.outcome, run.limit.limit_pct) {
                _ if is_lost(&run.points) => "trips".to_owned(),
                (LimitOutcome::Found, Some(percent)) => format!("{} %", number(percent, 0)),
                (LimitOutcome::NotReached, Some(percent)) => {
                    format!("above {} %", number(percent, 0))
                }
                _ => "never held".to_owned(),
            };
            let index = method.index();
            let sign = swatch(palette::variant(index), 3.0, dash(index));
            (sign, format!("{} ({limit})", method.name()))
        });
        plots.push(html! {
            h3 { "Figure 20, " (reading.name()) " reading" }
            (legend(items))
            (plot)
        });
    }
    Ok(html! {
        p.note { "Dots, and the shares of rated speed in the legend, mark where mean torque first falls below 97 % of the demand. The marks above are the paper's figures." }
        @for plot in plots { (plot) }
    })
}
