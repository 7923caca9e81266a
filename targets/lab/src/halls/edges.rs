//! The edges of the Hall codes at the rotor's angle.

use super::{Reading, mean, signed};
use crate::log::LogError;
use hexagen_codegen::spec::HALL_ANGLES;
use serde::Serialize;
use std::collections::BTreeMap;

/// A code that stands for fewer samples is a glitch.
const LEAST_RUN: usize = 3;

/// An edge between two sectors, electrical degrees.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Edge {
    /// Where it is, in the mean of both directions.
    pub angle: f64,
    /// Forward less backward, where it was passed both ways.
    pub hysteresis: Option<f64>,
    /// Greatest distance of a pass from the mean of its direction.
    pub spread: f64,
    /// How often it was passed.
    pub passes: usize,
}

/// The readings with short-lived codes replaced by the ones before, and how many those were.
pub(super) fn without_glitches(mut readings: Vec<Reading>) -> (Vec<Reading>, usize) {
    let mut glitches = 0;
    let mut begin = 0;
    let mut standing = None;
    while begin < readings.len() {
        let code = readings[begin].hall;
        let run = readings[begin..]
            .iter()
            .take_while(|next| next.hall == code)
            .count();
        match standing {
            Some(before) if run < LEAST_RUN => {
                for reading in &mut readings[begin..begin + run] {
                    reading.hall = before;
                }
                glitches += run;
            }
            _ => standing = Some(code),
        }
        begin += run;
    }
    (readings, glitches)
}

/// Changes of the code: the readings behind each, by the codes before and behind it.
pub(super) struct Passes(BTreeMap<[u8; 2], Vec<usize>>);

/// All changes of the code.
pub(super) fn passes(readings: &[Reading]) -> Passes {
    let mut passes: BTreeMap<[u8; 2], Vec<usize>> = BTreeMap::new();
    for (place, pair) in readings.windows(2).enumerate() {
        let codes = [pair[0].hall, pair[1].hall];
        if codes[0] != codes[1] {
            passes.entry(codes).or_default().push(place + 1);
        }
    }
    Passes(passes)
}

impl Passes {
    /// The first and the last pass of each edge in each direction: the rotor is at one angle in both.
    pub(super) fn repeated(&self) -> Vec<[usize; 2]> {
        let pairs = self
            .0
            .values()
            .map(|places| [places[0], places[places.len() - 1]]);
        pairs.filter(|[first, last]| first < last).collect()
    }

    /// Angles of the passes from one code to another, radians: halfway between two readings.
    fn at(&self, codes: [u8; 2], angles: &[f64]) -> Vec<f64> {
        let places = self.0.get(&codes).map_or(&[][..], Vec::as_slice);
        let halfway = |place: &usize| {
            let [before, behind] = [angles[place - 1], angles[*place]];
            before + 0.5 * signed(behind - before)
        };
        places.iter().map(halfway).collect()
    }
}

/// The codes with that of S1 first, and the edges at which they begin. `codes`: of six sectors in the order of their angles.
pub(super) fn edges(
    codes: [u8; 6],
    passes: &Passes,
    angles: &[f64],
) -> Result<([u8; 6], [Edge; 6]), LogError> {
    let mut found = [Edge {
        angle: 0.0,
        hysteresis: None,
        spread: 0.0,
        passes: 0,
    }; 6];
    for (place, edge) in found.iter_mut().enumerate() {
        let [before, behind] = [codes[(place + 5) % 6], codes[place]];
        let forward = passes.at([before, behind], angles);
        let backward = passes.at([behind, before], angles);
        *edge = Edge::of(&forward, &backward).ok_or_else(|| {
            LogError(format!(
                "the edge between the codes {before:03b} and {behind:03b} is not passed; turn the rotor farther"
            ))
        })?;
    }
    // The turn of the six that puts the edges nearest to their places.
    let off = |first: usize| {
        let errors = (0..6).map(|k| from_place(found[(first + k) % 6].angle, k).to_radians());
        mean(errors).abs()
    };
    let first = (0..6)
        .min_by(|one, other| off(*one).total_cmp(&off(*other)))
        .unwrap_or(0);
    let mut edges: [Edge; 6] = std::array::from_fn(|k| found[(first + k) % 6]);
    for (k, edge) in edges.iter_mut().enumerate() {
        edge.angle = HALL_ANGLES[k] + from_place(edge.angle, k);
    }
    Ok((std::array::from_fn(|k| codes[(first + k) % 6]), edges))
}

/// Degrees from the place of the edge at which the sector of this place begins, -180 to 180.
fn from_place(angle: f64, sector: usize) -> f64 {
    signed((angle - HALL_ANGLES[sector]).to_radians()).to_degrees()
}

impl Edge {
    /// An edge that was passed at these angles, radians.
    fn of(forward: &[f64], backward: &[f64]) -> Option<Self> {
        let own = |angles: &[f64]| (!angles.is_empty()).then(|| mean(angles.iter().copied()));
        let (there, back) = (own(forward), own(backward));
        let angle = match (there, back) {
            (Some(there), Some(back)) => back + 0.5 * signed(there - back),
            (one, other) => one.or(other)?,
        };
        let spread = |angles: &[f64], mean: Option<f64>| {
            let distances = angles
                .iter()
                .map(|angle| signed(angle - mean.unwrap_or(0.0)).abs());
            distances.fold(0.0, f64::max)
        };
        Some(Self {
            angle: angle.to_degrees(),
            hysteresis: there
                .zip(back)
                .map(|(there, back)| signed(there - back).to_degrees()),
            spread: spread(forward, there)
                .max(spread(backward, back))
                .to_degrees(),
            passes: forward.len() + backward.len(),
        })
    }
}
