//! Hall codes and edge angles from a log of a shorted motor that is turned by hand.
//!
//! The currents of a shorted motor tell its EMF and so the rotor's angle, without its Hall sensors and
//! without a step of the controller. Whatever the codes do at that angle is then the sensors' order and
//! their places.

mod edges;
mod flux;

pub use edges::Edge;

use crate::engine::Prepared;
use crate::log::{Call, LogError, LogRow, rows};
use edges::{edges, passes};
use flux::{Circle, Vector};
use hexagen_codegen::spec::Spec;
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::io::Read;

/// Least peak of the currents, in counts of the first sensor.
const LEAST_COUNTS: f64 = 20.0;

/// Least turns, so that every edge is passed twice in one direction.
const LEAST_TURNS: f64 = 2.0;

/// Most turn between two samples, radian.
const MOST_TURN: f64 = PI / 18.0;

/// Least roundness of the currents of sound sensors.
const LEAST_ROUNDNESS: f64 = 0.8;

/// A code that is seen on less of the turn is none of a sector.
const LEAST_SHARE: f64 = 0.04;

/// Error of the inductance whose effect is told.
const INDUCTANCE_ERROR: f64 = 0.3;

/// A sample of the shorted motor.
struct Reading {
    /// Ampere.
    current: Vector,
    hall: u8,
}

/// What a log says of the Hall sensors.
#[derive(Clone, Debug, Serialize)]
pub struct Halls {
    /// Codes of sectors S1 to S6, Ha in bit 2.
    pub codes: [u8; 6],
    /// The edges at which sectors S1 to S6 begin in forward rotation.
    pub edges: [Edge; 6],
    /// Electrical turns forward, and backward.
    pub turns: [f64; 2],
    /// Whether the first whole electrical turn is forward.
    pub begins_forward: bool,
    /// Narrowest over widest current of the phases: 1 for like gains.
    pub roundness: f64,
    /// Mean mechanical speed, rpm.
    pub rpm: f64,
    /// Samples with a code that stood for less than three.
    pub glitches: usize,
    /// Peak phase EMF over mechanical speed by the stated resistance, V s/rad.
    pub emf_constant: f64,
    /// How far an inductance wrong by 30 % moves all edges, electrical degrees.
    pub inductance_effect: f64,
}

/// Finds codes and edges in a log of a drive. `log`: as [`crate::replay::replay`] takes it, with a row every `row_time`
/// seconds; the rows from a `brake` to the next other call count, or all where there is no call.
///
/// # Errors
/// A row that cannot be read, by its line; a log that does not tell the angle: too short, too small currents, or
/// currents that are not those of three phases; codes that are not those of six sectors.
pub fn find(drive: &Prepared, log: impl Read, row_time: f64) -> Result<Halls, LogError> {
    let spec = &drive.spec;
    let (readings, glitches) = edges::without_glitches(shorted(spec, log)?);
    let passes = passes(&readings);
    let mut flux = flux::integrated(&spec.motor, row_time, &readings);
    flux::without_drift(&mut flux, &passes.repeated());
    if swing(&readings) < LEAST_COUNTS * spec.inverter.adc_gain.abs() {
        return Err(small(spec, &readings));
    }
    let circle = Circle::of(&flux).ok_or_else(|| flat(0.0))?;
    if circle.roundness < LEAST_ROUNDNESS {
        return Err(flat(circle.roundness));
    }
    let angles: Vec<f64> = flux.iter().map(|point| circle.angle(*point)).collect();
    let turned = Turned::of(&angles, &circle.apart);
    if turned.forward + turned.backward < LEAST_TURNS * TAU {
        return Err(LogError(format!(
            "the rotor turns by {:.1} electrical turns; turn it farther, by at least {LEAST_TURNS}",
            (turned.forward + turned.backward) / TAU
        )));
    }
    if turned.most > MOST_TURN {
        return Err(LogError(format!(
            "the rotor turns by {:.0} electrical degrees between two samples; turn it slower, or log more often",
            turned.most.to_degrees()
        )));
    }
    let codes = codes(&readings, &angles, &circle.apart)?;
    let (codes, edges) = edges(codes, &passes, &angles)?;
    let time = readings.len() as f64 * row_time;
    let speed = (turned.forward + turned.backward) / time;
    let poles = f64::from(spec.motor.pole_pairs);
    let effect = INDUCTANCE_ERROR * speed * spec.motor.inductance / spec.motor.resistance;
    Ok(Halls {
        codes,
        edges,
        turns: [turned.forward / TAU, turned.backward / TAU],
        begins_forward: turned.begins_forward,
        roundness: circle.roundness,
        rpm: speed / poles * 60.0 / TAU,
        glitches,
        emf_constant: circle.radius * poles / spec.motor.emf_shape.fundamental(),
        inductance_effect: effect.atan().to_degrees(),
    })
}

/// The samples of the shorted motor: the longest stretch in which nothing but a `brake` was called.
fn shorted(spec: &Spec, log: impl Read) -> Result<Vec<Reading>, LogError> {
    if spec.angle_sensor().is_some() {
        let error = "the motor has an angle sensor (`rotor: angle`), and no Hall sensors to find";
        return Err(LogError(error.to_owned()));
    }
    let mut stretches: Vec<Vec<Reading>> = vec![Vec::new()];
    let mut has_calls = false;
    let mut is_short = true;
    for row in rows(log)? {
        let (row, line) = row?;
        let at = |what: String| line.error(&what);
        row.check(&spec.inverter).map_err(at)?;
        if let Some(call) = row.call().map_err(at)? {
            // Rows before the first call are of another state; a `brake` again changes nothing.
            let is_first = !std::mem::replace(&mut has_calls, true);
            if is_first {
                stretches.clear();
            }
            let was_short = std::mem::replace(&mut is_short, call == Call::Brake);
            if is_first || !(was_short && is_short) {
                stretches.push(Vec::new());
            }
        }
        if is_short && let Some(stretch) = stretches.last_mut() {
            check_range(spec, &row).map_err(at)?;
            let hall = row.hall.ok_or_else(|| at("`hall` is missing".to_owned()))?;
            let current = flux::current(spec, row.counts());
            stretch.push(Reading { current, hall });
        }
    }
    let longest = stretches.into_iter().max_by_key(Vec::len);
    match longest.filter(|stretch| !stretch.is_empty()) {
        Some(stretch) => Ok(stretch),
        None if has_calls => Err(LogError(
            "no `brake` among the calls: the motor must be shorted while it is turned".to_owned(),
        )),
        None => Err(LogError::empty()),
    }
}

/// Whether the sensors show the currents, and a drive would bear them.
fn check_range(spec: &Spec, row: &LogRow) -> Result<(), String> {
    let inverter = &spec.inverter;
    for (count, sensor) in row.counts().zip(inverter.sensors()) {
        let current = sensor.gain * (f64::from(count) - f64::from(sensor.offset));
        let is_at_end = count == 0 || u32::from(count) == inverter.adc_max();
        if is_at_end || current.abs() > inverter.trip_current {
            return Err(format!(
                "a count of {count} is {current:.1} A, beyond the trip level of {:.1} A or at an end of the range; turn the motor slower",
                inverter.trip_current
            ));
        }
    }
    Ok(())
}

fn small(spec: &Spec, readings: &[Reading]) -> LogError {
    let gain = spec.inverter.adc_gain.abs();
    LogError(format!(
        "the currents swing by {:.0} counts to either side, {LEAST_COUNTS} are needed; short all three phases, or turn the motor faster",
        swing(readings) / gain
    ))
}

/// Half of the larger width of the currents, ampere, free of offsets.
fn swing(readings: &[Reading]) -> f64 {
    let width = |x: usize| {
        let all = || readings.iter().map(|reading| reading.current[x]);
        all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
    };
    0.5 * width(0).max(width(1))
}

/// Currents that are not those of three sound sensors.
fn flat(roundness: f64) -> LogError {
    LogError(format!(
        "the currents are not those of three equal phases: their ellipse is {:.0} % as wide as long; a sensor has the wrong sign (`adc_inverted`), \
         gain or phase (`sensed_phases`), its offset drifts, a phase is open, or the rotor was turned too little",
        100.0 * roundness
    ))
}

/// How far the rotor turns, radians.
struct Turned {
    forward: f64,
    backward: f64,
    /// Whether the rotor is first a whole turn ahead of where it was, not behind.
    begins_forward: bool,
    /// Between two samples at most.
    most: f64,
}

impl Turned {
    fn of(angles: &[f64], apart: &[usize]) -> Self {
        let mut turned = Self {
            forward: 0.0,
            backward: 0.0,
            begins_forward: true,
            most: 0.0,
        };
        let (mut ahead, mut is_begun) = (0.0, false);
        for pair in apart.windows(2) {
            let [first, last] = [pair[0], pair[1]];
            let step = signed(angles[last] - angles[first]);
            if step > 0.0 {
                turned.forward += step;
            } else {
                turned.backward -= step;
            }
            ahead += step;
            if !is_begun && ahead.abs() >= TAU {
                is_begun = true;
                turned.begins_forward = ahead > 0.0;
            }
            turned.most = turned.most.max(step.abs() / (last - first) as f64);
        }
        turned
    }
}

/// An angle in radians from -pi to pi.
fn signed(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// Mean of angles in radians; 0 without any.
fn mean(angles: impl Iterator<Item = f64>) -> f64 {
    let (sin, cos) = angles.fold((0.0, 0.0), |(sin, cos), angle: f64| {
        (sin + angle.sin(), cos + angle.cos())
    });
    f64::atan2(sin, cos)
}

/// The codes of the six sectors in the order of their mean angles.
fn codes(readings: &[Reading], angles: &[f64], apart: &[usize]) -> Result<[u8; 6], LogError> {
    let mut of_code: BTreeMap<u8, Vec<f64>> = BTreeMap::new();
    for place in apart {
        let seen = of_code.entry(readings[*place].hall).or_default();
        seen.push(angles[*place]);
    }
    let least = LEAST_SHARE * apart.len() as f64;
    of_code.retain(|_, seen| seen.len() as f64 >= least);
    let mut ordered: Vec<(u8, f64)> = (of_code.iter())
        .map(|(code, seen)| (*code, mean(seen.iter().copied())))
        .collect();
    ordered.sort_by(|(_, one), (_, other)| one.total_cmp(other));
    let codes: Vec<u8> = ordered.iter().map(|(code, _)| *code).collect();
    let Ok(six) = <[u8; 6]>::try_from(codes.clone()) else {
        return Err(LogError(format!(
            "{} Hall codes in a turn, not six: {}{}",
            codes.len(),
            listed(&codes),
            stuck(&codes)
        )));
    };
    let changes = |place: usize| (six[place] ^ six[(place + 1) % 6]).count_ones();
    if (0..6).any(|place| changes(place) != 1) {
        return Err(LogError(format!(
            "the codes {} follow each other, but at an edge one sensor changes: two inputs may be one pin, or a code was read while it changed",
            listed(&six)
        )));
    }
    Ok(six)
}

/// Which sensors never change, as a clause.
fn stuck(codes: &[u8]) -> String {
    let never = |bit: u8| codes.windows(2).all(|pair| (pair[0] ^ pair[1]) & bit == 0);
    let names: Vec<&str> = [("Ha", 4), ("Hb", 2), ("Hc", 1)]
        .into_iter()
        .filter(|(_, bit)| never(*bit))
        .map(|(name, _)| name)
        .collect();
    if names.is_empty() {
        return String::new();
    }
    format!(
        "; never changing: {}; look at wire, supply and pull-up",
        names.join(", ")
    )
}

/// Codes in binary.
fn listed(codes: &[u8]) -> String {
    let texts: Vec<String> = codes.iter().map(|code| format!("{code:03b}")).collect();
    texts.join(" ")
}
