//! Figures with runs: 4 and 14 to 20.

use super::verdicts::lettered;
use crate::closed_loop::{
    Held, LimitOutcome, harmonic_of_quasi_square, harmonics_of_current, hexagon,
};
use crate::report::pages::spectra::{CURRENT_ORDERS, HIGHEST, Spectrum, top, values};
use crate::report::pages::waves::{
    Panel, current_figures, demand_key, ideal_key, phase_current, ripple_key, torque_figures,
    trajectory_figures,
};
use crate::report::plot::{
    Bar, Bars, Curve, Plane, Stroke, TorqueSpeed, bars, corners, dash, ideal_phase, means, plane,
    torque_speed,
};
use crate::report::{Block, Color, Column, Figure, IDEAL, INK, Key, Label, Sign, Table, variant};
use crate::reproduction::{Method, Point, Reading, Reproduction, Run};
use crate::results::SpeedMark;
use crate::text::{number, ripple};
use std::f64::consts::TAU;

fn color(reading: Reading) -> Color {
    match reading {
        Reading::Literal => variant(1),
        Reading::Corrected => variant(0),
    }
}

fn point(data: &Reproduction, (method, reading, speed): (Method, Reading, usize)) -> &Point {
    &data.methods[method.index()].of(reading).points[speed]
}

/// A panel per method and reading, with its point.
fn panels(data: &Reproduction, speed: usize) -> (Vec<Panel<'_>>, Vec<&Point>) {
    let both = |method| Reading::ALL.map(|reading| (method, reading));
    let panels = Method::ALL
        .into_iter()
        .flat_map(both)
        .map(|(method, reading)| {
            let point = point(data, (method, reading, speed));
            let (name, rpm) = (method.name(), number(point.rpm, 0));
            let panel = Panel {
                variant: None,
                color: color(reading),
                of: format!("{name}, {} reading, at {rpm} rpm", reading.name()),
                caption: format!("{}, **{}**", lettered(method), reading.name()),
                demand: data.torque,
                ideal: vec![ideal_phase(data.current, 0)],
                trace: &point.trace,
                nothing: point.trip.as_ref().map(ToString::to_string),
            };
            (panel, point)
        });
    panels.unzip()
}

/// Key of the readings' colours and other lines.
fn legend(sign: fn(Color) -> Sign, more: impl IntoIterator<Item = Key>) -> Block {
    let readings = Reading::ALL.map(|reading| {
        let text = format!("{} reading", reading.name());
        sign(color(reading)).means(text)
    });
    Block::Legend(readings.into_iter().chain(more).collect())
}

fn line(color: Color) -> Sign {
    Sign::line(color, 3.0)
}

fn field(color: Color) -> Sign {
    Sign::Field(color, 1.0)
}

/// Figure 4: a real trajectory at low and at high speed against the ideal one.
pub fn figure_4(data: &Reproduction) -> Vec<Block> {
    let [low, high] = &data.methods[Method::PiPwm.index()].corrected.points;
    let paths = [low, high].map(|point| means(&point.trace));
    let colors = [variant(2), variant(3)];
    let most = paths.iter().flatten();
    let most = most.fold(0.0_f64, |most, (x, y)| most.max(x.abs()).max(y.abs()));
    let ideal = (hexagon(data.current), Stroke::solid(IDEAL, 3.0));
    let strokes = colors.map(|color| Stroke::solid(color, 1.4));
    let plot = plane(Plane {
        description: "Real trajectories of the current at low and high speed against the ideal one"
            .to_owned(),
        titles: ["i_alpha in A", "i_beta in A"],
        reach: (1.06 * most).max(1.45 * data.current.abs()),
        width: 550.0,
        lines: [ideal]
            .into_iter()
            .chain(paths.into_iter().zip(strokes))
            .collect(),
        points: corners(data.current, "S"),
    });
    let [low, high] = [low, high].map(|point| number(point.rpm, 0));
    let note = "The figure shows commutation with little voltage reserve, here of the drive nearest to a conventional one, \
                PI-PWM in the corrected reading. At high speed the incoming current rises too slowly, and the trajectory falls inside \
                the hexagon.";
    let caption = "Trajectory of the current, means over one control period";
    vec![
        Block::Legend(vec![
            Sign::line(colors[0], 2.5).means(format!("(i) low speed, {low} rpm")),
            ideal_key("(ii) ideal"),
            Sign::line(colors[1], 2.5).means(format!("(iii) high speed, {high} rpm")),
        ]),
        Block::Note(note.to_owned()),
        Block::Figures {
            columns: 1,
            figures: vec![Figure::new(None, caption, plot)],
        },
    ]
}

/// Figures 14 and 15: phase current and its spectrum.
pub fn currents(data: &Reproduction, speed: usize) -> Vec<Block> {
    let (panels, _) = panels(data, speed);
    let signal = |panel: &Panel<'_>| {
        let current = phase_current(panel.trace, 0);
        vec![("phase a".to_owned(), panel.color, current)]
    };
    let names = ("Current of phase a", "current of phase a in A");
    let more = [ripple_key(variant(0)), ideal_key("ideal quasi-square wave")];
    let ideal_bar = "ideal quasi-square wave: 100 % divided by the order";
    vec![
        legend(line, more),
        Block::Figures {
            columns: 2,
            figures: current_figures(&panels, data.current, names, signal),
        },
        Block::Heading("Spectra".to_owned()),
        legend(field, [Sign::line(INK, 2.0).means(ideal_bar)]),
        Block::Figures {
            columns: 2,
            figures: current_spectra(data, speed),
        },
    ]
}

fn current_spectra(data: &Reproduction, speed: usize) -> Vec<Figure> {
    let spectrum = |method, reading| {
        let point = point(data, (method, reading, speed));
        match point.trip {
            None => harmonics_of_current(&point.trace, HIGHEST),
            Some(_) => vec![None; HIGHEST + 1],
        }
    };
    let spectra: Vec<(Method, [Spectrum; 2])> = Method::ALL
        .into_iter()
        .map(|method| {
            (
                method,
                Reading::ALL.map(|reading| spectrum(method, reading)),
            )
        })
        .collect();
    let all = spectra.iter().flat_map(|(_, both)| both);
    let top = top(all, &CURRENT_ORDERS, (22.0, 60.0));
    let figures = spectra.iter().map(|(method, both)| {
        let plot = bars(Bars {
            description: format!("Spectrum of the phase current of {}", method.name()),
            x_title: "order of the harmonic",
            y_title: "% of the fundamental",
            top,
            groups: CURRENT_ORDERS.map(|order| order.to_string()).to_vec(),
            bars: bar_of_each(|k| values(&both[k], &CURRENT_ORDERS)),
            ideal: CURRENT_ORDERS.map(harmonic_of_quasi_square).to_vec(),
        });
        Figure::new(None, format!("{}, spectrum", lettered(*method)), plot)
    });
    figures.collect()
}

/// A bar for each reading, whose values are given by its place.
fn bar_of_each(values: impl Fn(usize) -> Vec<Option<f64>>) -> Vec<Bar> {
    let readings = Reading::ALL.into_iter().enumerate();
    let bars = readings.map(|(k, reading)| Bar {
        name: reading.name().to_owned(),
        variant: None,
        color: color(reading),
        values: values(k),
    });
    bars.collect()
}

/// Figures 16 and 17: torque with its 6th and 12th harmonic.
pub fn torques(data: &Reproduction, speed: usize) -> Vec<Block> {
    let (panels, _) = panels(data, speed);
    let note = "Lines are means over one control period.";
    vec![
        legend(line, [ripple_key(variant(0)), demand_key()]),
        Block::Note(note.to_owned()),
        Block::Figures {
            columns: 2,
            figures: torque_figures(&panels, data.torque),
        },
        legend(field, []),
        Block::Figures {
            columns: 2,
            figures: torque_harmonics(data, speed),
        },
        Block::Table(torque_table(data, speed)),
    ]
}

fn torque_harmonics(data: &Reproduction, speed: usize) -> Vec<Figure> {
    let at = |method, order| {
        Reading::ALL.map(|reading| {
            let figures = &point(data, (method, reading, speed)).figures;
            if order == 6 {
                figures.h6_pct
            } else {
                figures.h12_pct
            }
        })
    };
    let orders = [6, 12];
    let all = Method::ALL.map(|method| orders.map(|order| at(method, order)));
    let greatest = all.iter().flatten().flatten().flatten();
    let top = 1.06
        * greatest
            .fold(1.0, |most: f64, &value| most.max(value))
            .min(60.0);
    let figures = orders.map(|order| {
        let plot = bars(Bars {
            description: format!("Harmonic {order} of the torque of all methods"),
            x_title: "method",
            y_title: "% of mean torque",
            top,
            groups: Method::ALL.map(lettered).to_vec(),
            bars: bar_of_each(|k| Method::ALL.map(|method| at(method, order)[k]).to_vec()),
            ideal: Vec::new(),
        });
        Figure::new(None, format!("{order}th harmonic of the torque"), plot)
    });
    figures.to_vec()
}

fn torque_table(data: &Reproduction, speed: usize) -> Table {
    let columns = [
        Column::text("Method"),
        Column::text("Reading"),
        Column::number("Mean, Nm", ""),
        Column::number("Ripple pp, %", ""),
        Column::number("RMS, %", ""),
        Column::number("6th, %", ""),
        Column::number("12th, %", ""),
    ];
    let mut table = Table::new("", columns);
    for method in Method::ALL {
        table.group(Label::Beside(lettered(method).into()));
        for reading in Reading::ALL {
            let point = point(data, (method, reading, speed));
            let figures = &point.figures;
            let mean = match point.trip {
                Some(_) => "tripped".to_owned(),
                None => number(figures.mean_torque_nm, 3),
            };
            table.row([
                reading.name().to_owned(),
                mean,
                ripple(figures.ripple_pp_pct),
                ripple(figures.ripple_rms_pct),
                ripple(figures.h6_pct),
                ripple(figures.h12_pct),
            ]);
        }
    }
    table
}

/// Figures 18 and 19: trajectories in the alpha-beta plane, a row per reading.
pub fn trajectories(data: &Reproduction, speed: usize) -> Vec<Block> {
    let (panels, points) = panels(data, speed);
    let mut rows = [Vec::new(), Vec::new()];
    let figures = trajectory_figures(&panels, data.current);
    for (place, (mut figure, point)) in figures.into_iter().zip(points).enumerate() {
        let off = || {
            format!(
                "{}\u{a0}A off the hexagon (RMS)",
                number(point.hexagon_rms_a, 2)
            )
        };
        figure.note = figure.note.or_else(|| Some(off()));
        rows[place % 2].push(figure);
    }
    let ideal = ideal_key("ideal hexagon between the reference corners of S1 to S6");
    let note = "Solid: mean over one control period, with its RMS distance from the hexagon's outline below; pale: with the PWM \
                ripple.";
    let rows = rows.map(|figures| Block::Figures {
        columns: 4,
        figures,
    });
    let first = [legend(line, [ideal]), Block::Note(note.to_owned())];
    first.into_iter().chain(rows).collect()
}

/// Figure 20: torque over speed.
pub fn figure_20(data: &Reproduction) -> Vec<Block> {
    let note = "Dots, and percentages of rated speed in the legend, are the speeds at which mean torque falls below 97 % of the demand. Marks \
                above are the paper's values.";
    let readings = Reading::ALL
        .into_iter()
        .flat_map(|reading| of_reading(data, reading));
    [Block::Note(note.to_owned())]
        .into_iter()
        .chain(readings)
        .collect()
}

fn of_reading(data: &Reproduction, reading: Reading) -> [Block; 3] {
    let runs = Method::ALL.map(|method| (method, data.methods[method.index()].of(reading)));
    let running = runs.iter().filter(|(_, run)| !is_lost(run));
    let plot = torque_speed(&TorqueSpeed {
        torque: data.torque,
        unit: "Nm",
        rated_rpm: data.motor.rated_speed * 60.0 / TAU,
        curves: running
            .map(|(method, run)| Curve {
                name: method.name().to_owned(),
                color: variant(method.index()),
                index: method.index(),
                points: run.curve.clone(),
                limit_rpm: run.limit.limit_rpm,
            })
            .collect(),
        marks: &SpeedMark::of_paper(),
        bounds: Vec::new(),
        held: Held::AtLeast,
    });
    let keys = runs.map(|(method, run)| {
        let index = method.index();
        let text = format!("{} ({})", method.name(), limit_text(run));
        Sign::Line(variant(index), 3.0, dash(index)).means(text)
    });
    [
        Block::Heading(format!("Figure 20, {} reading", reading.name())),
        Block::Legend(keys.to_vec()),
        Block::Figures {
            columns: 1,
            figures: vec![Figure::new(None, "", plot)],
        },
    ]
}

/// Whether a drive trips at both speeds.
fn is_lost(run: &Run) -> bool {
    run.points.iter().all(|point| point.trip.is_some())
}

fn limit_text(run: &Run) -> String {
    match (run.limit.outcome, run.limit.limit_pct) {
        _ if is_lost(run) => "trips".to_owned(),
        (LimitOutcome::Found, Some(percent)) => format!("{} %", number(percent, 0)),
        (LimitOutcome::NotReached, Some(percent)) => format!("above {} %", number(percent, 0)),
        _ => "never held".to_owned(),
    }
}
