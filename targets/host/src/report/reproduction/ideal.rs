//! Figures that need no run: 2, 3, 9, 12 and 13.

use super::tables::{emf, emf_corner, twelfth};
use crate::report::ReportError;
use crate::report::plot::{
    Bars, Group, Level, Named, Path, Plane, Wave, bars, corners, levels, palette, plane, wave,
};
use crate::report::sections::waves::ideal_phase;
use crate::report::sections::{figure, legend, swatch};
use crate::report::window::{Columns, FIRST_DEG};
use hexagen_codegen::design::vectors::{THREE_PHASE, TWO_PHASE, leg_vector};
use hexagen_lab::closed_loop::{harmonic_of_quasi_square, hexagon};
use hexagen_lab::reproduction::Reproduction;
use maud::{Markup, html};
use std::f64::consts::FRAC_PI_6;

/// Orders of the ideal spectrum.
const ORDERS: [usize; 9] = [1, 5, 7, 11, 13, 17, 19, 23, 25];

/// Width of a picture of the plane in CSS pixels.
const WIDTH: f64 = 380.0;

/// A signal without ripple.
fn columns(points: impl IntoIterator<Item = (f64, f64)>) -> Columns {
    let (angle, mean): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    Columns {
        least: mean.clone(),
        most: mean.clone(),
        angle,
        mean,
    }
}

fn phase_legend() -> Markup {
    let [a, b, c] = palette::PHASES.map(|color| swatch(color, 2.5, (0.0, 0.0)));
    legend([
        (a, "phase a, Ha".to_owned()),
        (b, "phase b, Hb".to_owned()),
        (c, "phase c, Hc".to_owned()),
    ])
}

/// Figure 2: EMF, ideal currents and Hall signals over a turn.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn figure_2(data: &Reproduction) -> Result<Markup, ReportError> {
    let shape = data.motor.emf_shape;
    let emf = |phase: usize| {
        let degrees = (0..=360).map(|k| FIRST_DEG + f64::from(k));
        columns(degrees.map(move |degrees| {
            let theta = degrees - 120.0 * phase as f64;
            (degrees, shape.at(theta.to_radians()))
        }))
    };
    let signals = |of: &dyn Fn(usize) -> Columns| {
        let phases = palette::PHASES.into_iter().enumerate();
        phases.map(|(phase, color)| (color, of(phase))).collect()
    };
    let emf_plot = wave(&Wave {
        description: "EMF of the three phases over an electrical turn",
        title: "EMF in E",
        range: -1.2..1.2,
        signals: signals(&emf),
        ideal: Vec::new(),
        demand: None,
    })?;
    let current_plot = wave(&Wave {
        description: "Ideal currents of the three phases over an electrical turn",
        title: "ideal current in I",
        range: -1.2..1.2,
        signals: signals(&|phase| columns(ideal_phase(1.0, phase))),
        ideal: Vec::new(),
        demand: None,
    })?;
    let names = ["Ha", "Hb", "Hc"];
    let codes = data.motor.hall_codes;
    let hall: Vec<Level> = (0..3)
        .map(|sensor| Level {
            name: names[sensor],
            color: palette::PHASES[sensor],
            values: codes.map(|code| code >> (2 - sensor) & 1 == 1),
        })
        .collect();
    let hall_plot = levels(&hall, "Hall signals over an electrical turn")?;
    Ok(html! {
        (phase_legend())
        div.plots.one {
            (figure(&html! { "EMF, in units of the phase amplitude E" }, &emf_plot))
            (figure(&html! { "Ideal quasi-square currents, in units of I" }, &current_plot))
            (figure(&html! { "Hall signals" }, &hall_plot))
        }
    })
}

/// Figure 3: trajectories of EMF and ideal current.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn figure_3(data: &Reproduction) -> Result<Markup, ReportError> {
    let turn = (0..=360).map(|k| emf(data, f64::from(k).to_radians()));
    let emf_plot = plane(&Plane {
        description: "Trajectory of the EMF in the alpha-beta plane",
        titles: ["e_alpha in E", "e_beta in E"],
        reach: 1.7,
        width: WIDTH,
        paths: vec![Path::solid(turn.collect(), palette::variant(0), 1.6)],
        points: (0..6)
            .map(|k| Named {
                at: emf_corner(data, k),
                name: format!("E{}", k + 1),
                is_marked: true,
            })
            .collect(),
    })?;
    let current_plot = plane(&Plane {
        description: "Trajectory of the ideal current in the alpha-beta plane",
        titles: ["i_alpha in I", "i_beta in I"],
        reach: 1.7,
        width: WIDTH,
        paths: vec![Path::solid(hexagon(1.0), palette::variant(1), 1.6)],
        points: corners(1.0, "I"),
    })?;
    Ok(html! {
        div.plots.three {
            (figure(&html! { "EMF: it runs along the edges; E1 to E6 at the entries of S1 to S6" }, &emf_plot))
            (figure(&html! { "Current: it stays on I1 to I6 in S1 to S6, and takes the edges in commutation" }, &current_plot))
        }
    })
}

/// Figure 9: the plane in twelve sectors, with the vectors that bound them.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn figure_9(data: &Reproduction) -> Result<Markup, ReportError> {
    let v_bus = data.inverter.v_bus;
    let reach = 0.85 * v_bus;
    let vectors = |legs: &[[i32; 3]; 6]| legs.map(|legs| leg_vector(legs, v_bus));
    let (three, two) = (vectors(&THREE_PHASE), vectors(&TWO_PHASE));
    let ray = |k: usize| {
        let (sin, cos) = (k as f64 * FRAC_PI_6).sin_cos();
        let length = reach / cos.abs().max(sin.abs());
        Path {
            dash: (3.0, 3.0),
            ..Path::solid(
                vec![(0.0, 0.0), (length * cos, length * sin)],
                palette::AXIS,
                0.8,
            )
        }
    };
    let mut paths: Vec<Path> = (0..12).map(ray).collect();
    let outline = (0..=6).map(|k| (three[k % 6].x, three[k % 6].y)).collect();
    paths.push(Path::solid(outline, palette::IDEAL, 2.0));
    let tips = |vectors: &[nalgebra::Vector2<f64>; 6], color| {
        vectors.map(|v| Path::solid(vec![(0.0, 0.0), (v.x, v.y)], color, 2.2))
    };
    paths.extend(tips(&three, palette::variant(0)));
    paths.extend(tips(&two, palette::variant(1)));
    let name = |(k, v): (usize, &nalgebra::Vector2<f64>), name: String| Named {
        at: (v.x, v.y),
        name: name.replace("{k}", &(k + 1).to_string()),
        is_marked: true,
    };
    let mut points: Vec<Named> = three
        .iter()
        .enumerate()
        .map(|one| name(one, "V{k}".to_owned()))
        .collect();
    points.extend(two.iter().enumerate().map(|(k, v)| {
        let next = (k + 1) % 6 + 1;
        name((k, v), format!("V{{k}}{next}"))
    }));
    points.extend((0..12).map(|k| {
        let (sin, cos) = twelfth(k).sin_cos();
        Named {
            at: (0.33 * v_bus * cos, 0.33 * v_bus * sin),
            name: (k + 1).to_string(),
            is_marked: false,
        }
    }));
    let plot = plane(&Plane {
        description: "The alpha-beta plane in twelve sectors with the voltage vectors",
        titles: ["v_alpha in V", "v_beta in V"],
        reach,
        width: 550.0,
        paths,
        points,
    })?;
    Ok(html! {
        (legend([
            (swatch(palette::variant(0), 2.5, (0.0, 0.0)), "three-phase vectors V1 to V6".to_owned()),
            (swatch(palette::variant(1), 2.5, (0.0, 0.0)), "two-phase vectors V12 to V61".to_owned()),
            (swatch(palette::IDEAL, 3.0, (0.0, 0.0)), "reach of three driven legs".to_owned()),
        ]))
        div.plots.one { (figure(&html! { "The vectors part the plane into twelve sectors of 30\u{b0}, numbered from the alpha axis" }, &plot)) }
    })
}

/// Figures 12 and 13: the ideal quasi-square current and its spectrum.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn figures_12_13(data: &Reproduction) -> Result<Markup, ReportError> {
    let most = 1.2 * data.current.abs();
    let current = wave(&Wave {
        description: "Ideal quasi-square current of phase a over an electrical turn",
        title: "ideal current of phase a in A",
        range: -most..most,
        signals: vec![(palette::PHASES[0], columns(ideal_phase(data.current, 0)))],
        ideal: Vec::new(),
        demand: None,
    })?;
    let spectrum = bars(&Bars {
        description: "Spectrum of the ideal quasi-square current",
        x_title: "order of the harmonic",
        y_title: "% of the fundamental",
        top: 105.0,
        colors: vec![palette::PHASES[0]],
        groups: ORDERS
            .iter()
            .map(|&order| Group {
                name: order.to_string(),
                values: vec![Some(harmonic_of_quasi_square(order))],
                ideal: None,
            })
            .collect(),
    })?;
    let fundamental = 2.0 * 3.0_f64.sqrt() / std::f64::consts::PI * data.current;
    Ok(html! {
        div.plots.two {
            (figure(&html! { "Figure 12: ideal quasi-square current" }, &current))
            (figure(&html! { "Figure 13: its spectrum; orders that are even or multiples of three are absent" }, &spectrum))
        }
        p.note {
            "The fundamental is 2\u{221a}3/\u{3c0} I = " (crate::report::sections::quantity(fundamental, "A"))
            "; harmonic n is 1/n of it: 5th " (crate::report::sections::number(harmonic_of_quasi_square(5), 1))
            "\u{a0}%, 7th " (crate::report::sections::number(harmonic_of_quasi_square(7), 1)) "\u{a0}%."
        }
    })
}
