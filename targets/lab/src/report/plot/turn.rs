//! Signals over one electrical turn, with the sectors named above.

use super::super::palette::{AXIS, Color, DEMAND, IDEAL};
use super::window::{Columns, FIRST_DEG, TURN};
use super::{Axis, Plot, Point, Series, Stroke};
use crate::closed_loop::quasi_square;
use hexagen_codegen::spec::{EmfShape, Reference, proportional_current};
use std::ops::Range;

/// Signals to plot over the electrical angle.
#[derive(Debug)]
pub struct Wave {
    /// Description for screen readers.
    pub description: String,
    /// Name and unit of the vertical axis.
    pub title: String,
    /// Vertical range.
    pub range: Range<f64>,
    /// Each signal with its name and colour.
    pub signals: Vec<(String, Color, Columns)>,
    /// Ideal waves, drawn wide below the signals: corners (angle in degrees, value).
    pub ideal: Vec<Vec<Point>>,
    /// A demand, drawn as a dashed line across.
    pub demand: Option<f64>,
}

/// Title of the horizontal axis.
pub const ANGLE: &str = "electrical angle in degrees";

/// An empty plot over one electrical turn.
fn over_a_turn(description: String, height: f64, y: Axis) -> Plot {
    let mut x = Axis::stepped(ANGLE, &(0.0..360.0), 60.0);
    for (at, label) in &mut x.ticks {
        *at += FIRST_DEG;
        *label = super::tick_text(*at, 0);
    }
    x.range = (TURN.start, TURN.end);
    let top = y.range.1;
    let mut plot = Plot::new(description, (550.0, height), x, y);
    for sector in 1..=6 {
        let middle = FIRST_DEG + 60.0 * (f64::from(sector) - 0.5);
        plot.write_above(format!("S{sector}"), (middle, top), (AXIS, 0.95));
    }
    plot
}

/// Signals: ripple as a pale band, mean over one control period as a line.
pub fn wave(wave: Wave) -> Plot {
    let y = Axis::new(wave.title, &wave.range, 8);
    let mut plot = over_a_turn(wave.description, 250.0, y);
    for corners in wave.ideal {
        plot.line(corners, Stroke::solid(IDEAL, 3.0));
    }
    let across = |height: f64| [(TURN.start, height), (TURN.end, height)];
    if wave.range.start < 0.0 {
        plot.line(across(0.0), Stroke::solid(AXIS, 0.5));
    }
    for (name, color, columns) in wave.signals {
        plot.series(Series::of_columns(name, columns, Stroke::solid(color, 1.4)));
    }
    if let Some(demand) = wave.demand {
        plot.line(across(demand), Stroke::dashed(DEMAND, 1.0, (6.0, 4.0)));
    }
    plot
}

/// Step height of a two-valued signal; signals are 1 apart.
const STEP: f64 = 0.6;

/// A two-valued signal: its name, its colour, and its value in sectors S1 to S6.
#[derive(Debug)]
pub struct Level {
    /// Name next to its line.
    pub name: &'static str,
    /// Colour.
    pub color: Color,
    /// Whether it is 1, per sector.
    pub values: [bool; 6],
}

/// Two-valued signals, the first at the top.
pub fn levels(description: String, signals: &[Level]) -> Plot {
    let count = signals.len() as f64;
    let base = |index: usize| count - 1.0 - index as f64;
    let names = signals.iter().enumerate();
    let ticks = names.map(|(k, signal)| (base(k) + STEP / 2.0, signal.name.to_owned()));
    let y = Axis::ticked("0 below, 1 above", (-0.2, count), ticks.collect());
    let mut plot = over_a_turn(description, 190.0, y);
    for (index, signal) in signals.iter().enumerate() {
        let points = (0..6).zip(signal.values).flat_map(|(sector, is_high)| {
            let from = FIRST_DEG + 60.0 * f64::from(sector);
            let height = base(index) + if is_high { STEP } else { 0.0 };
            [(from, height), (from + 60.0, height)]
        });
        plot.line(points, Stroke::solid(signal.color, 2.0));
    }
    plot
}

/// Corners of the ideal quasi-square current of a phase over the plotted turn.
pub fn ideal_phase(current: f64, phase: usize) -> Vec<Point> {
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

/// The reference of a phase's current at a set-point, ampere, over a part of the plotted turn in degrees.
pub fn reference_phase(
    (reference, set_point): (Reference, f64),
    shape: EmfShape,
    phase: usize,
    part: &Range<f64>,
) -> Vec<Point> {
    /// Points of a curve.
    const POINTS: u32 = 180;
    match reference {
        Reference::QuasiSquare => {
            // Its lines are level: clamped ones end at the edge.
            let corners = ideal_phase(set_point, phase).into_iter();
            let corners = corners.map(|(x, y)| (x.clamp(part.start, part.end), y));
            corners.collect()
        }
        Reference::Proportional => {
            let ratio = shape.torque_factor(reference);
            let shift = 120.0 * phase as f64;
            let at = |point: u32| {
                let share = f64::from(point) / f64::from(POINTS);
                let degrees = part.start + share * (part.end - part.start);
                let theta = (degrees - shift).to_radians();
                (
                    degrees,
                    set_point * proportional_current(shape, ratio, theta),
                )
            };
            (0..=POINTS).map(at).collect()
        }
    }
}

/// A range that contains the demand and every signal, with a margin.
pub fn torque_range<'a>(demand: f64, signals: impl Iterator<Item = &'a Columns>) -> Range<f64> {
    let span = 0.1 * demand.abs().max(1e-9);
    let (least, most) = signals
        .flat_map(|columns| columns.least.iter().chain(&columns.most))
        .fold((demand - span, demand + span), |(least, most), &torque| {
            (least.min(torque), most.max(torque))
        });
    let pad = 0.04 * (most - least);
    least - pad..most + pad
}

#[cfg(test)]
mod tests {
    use super::{TURN, reference_phase};
    use hexagen_codegen::spec::{EmfShape, Reference};

    const SET_POINT: f64 = 20.0;

    fn phases(reference: Reference, shape: EmfShape) -> [Vec<(f64, f64)>; 3] {
        [0, 1, 2].map(|phase| reference_phase((reference, SET_POINT), shape, phase, &TURN))
    }

    /// At every angle proportional currents make the set-point's torque, and add up to 0.
    #[test]
    fn a_proportional_reference_makes_constant_torque() {
        for shape in [
            EmfShape::Sinusoidal,
            EmfShape::Trapezoidal {
                flat_top_deg: 120.0,
            },
        ] {
            let [a, b, c] = phases(Reference::Proportional, shape);
            let torque = SET_POINT * shape.torque_factor(Reference::Proportional);
            assert_eq!([a[0].0, a[a.len() - 1].0], [TURN.start, TURN.end]);
            for ((a, b), c) in a.iter().zip(&b).zip(&c) {
                let currents = [a.1, b.1, c.1];
                let emf = [0.0, 120.0, 240.0].map(|lag: f64| shape.at((a.0 - lag).to_radians()));
                let made: f64 = currents.iter().zip(emf).map(|(i, e)| i * e).sum();
                assert!(currents.iter().sum::<f64>().abs() < 1e-9, "{currents:?}");
                assert!((made - torque).abs() < 1e-9 * torque, "{}: {made}", a.0);
            }
        }
    }

    /// Blocks of 120 degrees, and within a part of the turn none beyond its ends.
    #[test]
    fn a_quasi_square_reference_is_blocks_that_end_at_the_edge() {
        let shape = EmfShape::Sinusoidal;
        let [a, ..] = phases(Reference::QuasiSquare, shape);
        let inner = |middle: f64| {
            let pair = a
                .windows(2)
                .find(|pair| pair[0].0 < middle && middle < pair[1].0);
            pair.map(|pair| pair[0].1.round())
        };
        let levels = [0.0, 60.0, 120.0, 180.0, 240.0, 300.0].map(inner);
        let block = [0.0, 20.0, 20.0, 0.0, -20.0, -20.0].map(Some);
        assert_eq!(levels, block);
        let part = 10.0..80.0;
        let cut = reference_phase((Reference::QuasiSquare, SET_POINT), shape, 0, &part);
        assert!(
            cut.iter().all(|(x, _)| (10.0..=80.0).contains(x)),
            "{cut:?}"
        );
    }
}
