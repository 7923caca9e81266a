//! Figures without a run: 2, 3, 5, 9, 12 and 13.

use super::tables::{emf, emf_corner};
use crate::closed_loop::{harmonic_of_quasi_square, hexagon};
use crate::report::pages::phase_keys;
use crate::report::pages::shapes::{columns, emf_shape, phases};
use crate::report::pages::spectra::CURRENT_ORDERS;
use crate::report::plot::{
    Bar, Bars, Level, Named, Plane, Point, Stroke, Wave, bars, corners, ideal_phase, levels, plane,
    ray, wave,
};
use crate::report::{Block, Figure, IDEAL, PHASES, Sign, variant};
use crate::reproduction::Reproduction;
use crate::text::{number, quantity};
use hexagen_codegen::design::vectors::{LegSigns, THREE_PHASE, TWO_PHASE, leg_vector};
use std::f64::consts::{FRAC_PI_6, PI};

/// Width of a picture of the plane in CSS pixels.
const WIDTH: f64 = 380.0;

/// Figure 2: EMF, ideal currents and Hall signals over a turn.
pub fn figure_2(data: &Reproduction) -> Vec<Block> {
    let emf = emf_shape(data.motor.emf_shape);
    let currents = phases("Ideal currents", "ideal current in I", |phase| {
        columns(ideal_phase(1.0, phase))
    });
    let (names, codes) = (["Ha", "Hb", "Hc"], data.motor.hall_codes);
    let hall = [0, 1, 2].map(|sensor| Level {
        name: names[sensor],
        color: PHASES[sensor],
        values: codes.map(|code| code >> (2 - sensor) & 1 == 1),
    });
    let hall = levels("Hall signals over an electrical turn".to_owned(), &hall);
    vec![
        Block::Legend(phase_keys(["phase a, Ha", "phase b, Hb", "phase c, Hc"])),
        Block::Figures {
            columns: 1,
            figures: vec![
                Figure::new(None, "EMF, in units of the phase amplitude E", emf),
                Figure::new(None, "Ideal quasi-square currents, in units of I", currents),
                Figure::new(None, "Hall signals", hall),
            ],
        },
    ]
}

/// Figure 3: trajectories of EMF and ideal current.
pub fn figure_3(data: &Reproduction) -> Vec<Block> {
    let line = |index, points: Vec<Point>| vec![(points, Stroke::solid(variant(index), 1.6))];
    let turn = (0..=360).map(|k| emf(data, f64::from(k).to_radians()));
    let emf_corners = (0..6).map(|k| Named {
        at: emf_corner(data, k),
        name: format!("E{}", k + 1),
        is_marked: true,
    });
    let emf = plane(Plane {
        description: "Trajectory of the EMF in the alpha-beta plane".to_owned(),
        titles: ["e_alpha in E", "e_beta in E"],
        reach: 1.7,
        width: WIDTH,
        lines: line(0, turn.collect()),
        points: emf_corners.collect(),
    });
    let current = plane(Plane {
        description: "Trajectory of the ideal current in the alpha-beta plane".to_owned(),
        titles: ["i_alpha in I", "i_beta in I"],
        reach: 1.7,
        width: WIDTH,
        lines: line(1, hexagon(1.0)),
        points: corners(1.0, "I"),
    });
    let of_emf = "The EMF moves along the edges; E1 to E6 are at the entries of S1 to S6";
    let of_current =
        "The current stays at I1 to I6 in S1 to S6, and moves along the edges in commutation";
    vec![Block::Figures {
        columns: 3,
        figures: vec![
            Figure::new(None, of_emf, emf),
            Figure::new(None, of_current, current),
        ],
    }]
}

/// Figure 5: the vectors.
pub fn figure_5(data: &Reproduction) -> Vec<Block> {
    let description = "The voltage vectors in the alpha-beta plane";
    let caption = "V1 to V6 are 2V_{d}/3 long, V12 to V61 V_{d}/\u{221a}3";
    vectors(data, description, caption, false)
}

/// Figure 9: the plane in twelve sectors, with the vectors at their boundaries.
pub fn figure_9(data: &Reproduction) -> Vec<Block> {
    let description = "The alpha-beta plane in twelve sectors with the voltage vectors";
    let caption = "The vectors divide the plane into twelve sectors of 30\u{b0}, numbered from the alpha axis";
    vectors(data, description, caption, true)
}

/// The vectors in the plane, which is divided into twelve sectors or not.
fn vectors(data: &Reproduction, description: &str, caption: &str, is_divided: bool) -> Vec<Block> {
    let v_bus = data.inverter.v_bus;
    let reach = 0.85 * v_bus;
    let tips = |legs: [LegSigns; 6]| legs.map(|legs| leg_vector(legs, v_bus)).map(|v| (v.x, v.y));
    let (three, two) = (tips(THREE_PHASE), tips(TWO_PHASE));
    let sectors = if is_divided { 12 } else { 0 };
    let rays = (0..sectors).map(|k| {
        let (sin, cos) = (f64::from(k) * FRAC_PI_6).sin_cos();
        let length = reach / cos.abs().max(sin.abs());
        ray((length * cos, length * sin))
    });
    let outline = (0..=6).map(|k| three[k % 6]).collect();
    let vectors = |tips: [Point; 6], index| {
        tips.map(|tip| (vec![(0.0, 0.0), tip], Stroke::solid(variant(index), 2.2)))
    };
    let named = |at, name, is_marked| Named {
        at,
        name,
        is_marked,
    };
    let three_names = (1..)
        .zip(three)
        .map(|(k, tip)| named(tip, format!("V{k}"), true));
    let two_names = (1..).zip(two);
    let two_names = two_names.map(|(k, tip)| named(tip, format!("V{k}{}", k % 6 + 1), true));
    let numbers = (1..=sectors).map(|k| {
        let (sin, cos) = ((f64::from(k) - 0.5) * FRAC_PI_6).sin_cos();
        named(
            (0.33 * v_bus * cos, 0.33 * v_bus * sin),
            k.to_string(),
            false,
        )
    });
    let plot = plane(Plane {
        description: description.to_owned(),
        titles: ["v_alpha in V", "v_beta in V"],
        reach,
        width: 550.0,
        lines: rays
            .chain([(outline, Stroke::solid(IDEAL, 2.0))])
            .chain(vectors(three, 0))
            .chain(vectors(two, 1))
            .collect(),
        points: three_names.chain(two_names).chain(numbers).collect(),
    });
    vec![
        Block::Legend(vec![
            Sign::line(variant(0), 2.5).means("three-phase vectors V1 to V6"),
            Sign::line(variant(1), 2.5).means("two-phase vectors V12 to V61"),
            Sign::line(IDEAL, 3.0).means("limit of three driven legs"),
        ]),
        Block::Figures {
            columns: 1,
            figures: vec![Figure::new(None, caption, plot)],
        },
    ]
}

/// Figures 12 and 13: the ideal quasi-square current and its spectrum.
pub fn figures_12_13(data: &Reproduction) -> Vec<Block> {
    let most = 1.2 * data.current.abs();
    let current = wave(Wave {
        description: "Ideal quasi-square current of phase a over an electrical turn".to_owned(),
        title: "ideal current of phase a in A".to_owned(),
        range: -most..most,
        signals: vec![(
            "phase a".to_owned(),
            PHASES[0],
            columns(ideal_phase(data.current, 0)),
        )],
        ideal: Vec::new(),
        demand: None,
    });
    let orders: Vec<usize> = [1].into_iter().chain(CURRENT_ORDERS).collect();
    let values = orders.iter().map(|&order| harmonic_of_quasi_square(order));
    let spectrum = bars(Bars {
        description: "Spectrum of the ideal quasi-square current".to_owned(),
        x_title: "order of the harmonic",
        y_title: "% of the fundamental",
        top: 105.0,
        groups: orders.iter().map(usize::to_string).collect(),
        bars: vec![Bar {
            name: "harmonic".to_owned(),
            variant: None,
            color: PHASES[0],
            values: values.map(Some).collect(),
        }],
        ideal: Vec::new(),
    });
    let fundamental = 2.0 * 3.0_f64.sqrt() / PI * data.current;
    let [fifth, seventh] = [5, 7].map(|order| number(harmonic_of_quasi_square(order), 1));
    let note = format!(
        "The fundamental is 2\u{221a}3/\u{3c0} I = {}; harmonic n is 1/n of it: 5th {fifth}\u{a0}%, 7th {seventh}\u{a0}%.",
        quantity(fundamental, "A")
    );
    let of_spectrum = "Figure 13: its spectrum; without even orders and multiples of three";
    vec![
        Block::Figures {
            columns: 2,
            figures: vec![
                Figure::new(None, "Figure 12: ideal quasi-square current", current),
                Figure::new(None, of_spectrum, spectrum),
            ],
        },
        Block::Note(note),
    ]
}
