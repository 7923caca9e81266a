//! Two vectors in one period: the point nearest to the demand on the line between them.

use super::off_leg::{TIE, floats, rail, with_off_leg};
use super::whole::Whole;
use super::{Command, Inputs};
use crate::FcsMpc;
use crate::model::ideal::Duties;
use crate::model::ideal::vector::{clarke, phases};
use crate::model::vectors;
use hexagen::LegState;
use nalgebra::{Vector2, Vector3};

/// The shared period of the chosen vector and its partner: mean voltage and command.
pub fn command(
    options: &FcsMpc,
    whole: Whole,
    now: &Inputs,
    u: &Vector2<f64>,
    vector: usize,
) -> (Vector2<f64>, Command) {
    let off = vectors::off_leg(vector);
    let terminal = match off {
        _ if now.sector_eff == 0 => Vector3::zeros(),
        None => neighbours(whole, now, u, vector),
        Some(off) => pair(options, whole, now, u, off),
    };
    let mean = match off {
        Some(off) if floats(options) => with_off_leg(options, now, terminal, off),
        Some(off) => {
            let mut midway = terminal;
            midway[off] = terminal.sum() / 2.0;
            clarke(&midway)
        }
        None => clarke(&terminal),
    };
    let state = [0, 1, 2].map(|x| {
        if off == Some(x) {
            LegState::Off
        } else if terminal[x] > TIE * now.v_bus {
            LegState::Pulsed
        } else {
            LegState::Low
        }
    });
    let duties = Duties {
        duty: (terminal / now.v_bus).into(),
        state,
        later: None,
    };
    let command = Command {
        duties,
        terminal,
        off,
    };
    (mean, command)
}

/// The fraction of the first of two voltages at the point nearest to `u` between them.
fn share(u: &Vector2<f64>, first: &Vector2<f64>, second: &Vector2<f64>) -> f64 {
    let along = first - second;
    ((u - second).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
}

/// Terminals between a three-phase vector and the nearest of the others.
fn neighbours(whole: Whole, now: &Inputs, u: &Vector2<f64>, vector: usize) -> Vector3<f64> {
    let tie = TIE * (u.norm() + now.v_bus).powi(2);
    let mut best: Option<(usize, f64)> = None;
    for other in (0..vectors::FIRST_PAIR).filter(|other| *other != vector) {
        let cost = (u - whole.voltage(now, other)).norm_squared();
        if best.is_none_or(|(_, least)| cost < least - tie) {
            best = Some((other, cost));
        }
    }
    let other = best.map_or(0, |(other, _)| other);
    let share = share(u, &whole.voltage(now, vector), &whole.voltage(now, other));
    whole.terminals(now, vector) * share + whole.terminals(now, other) * (1.0 - share)
}

/// Terminals between the better pair vector with that leg off and its zero.
fn pair(
    options: &FcsMpc,
    whole: Whole,
    now: &Inputs,
    u: &Vector2<f64>,
    off: usize,
) -> Vector3<f64> {
    let reach = whole.reach(now);
    // Held at a rail, or following the two others: its own EMF moves both ends equally, across the
    // line.
    let held = rail(options, now, off).filter(|_| floats(options));
    let ends = |high: usize| {
        let mut on = Vector3::zeros();
        on[high] = reach;
        let mut zero = Vector3::zeros();
        on[off] = held.unwrap_or(reach / 2.0);
        zero[off] = held.unwrap_or(0.0);
        (clarke(&on), clarke(&zero))
    };
    let mut vectors = (vectors::FIRST_PAIR..vectors::FIRST_PAIR_ZERO)
        .filter(|v| vectors::off_leg(*v) == Some(off));
    let first = vectors.next().unwrap_or(vectors::FIRST_PAIR);
    let find = |wanted: i8| {
        let mut legs = vectors::LEGS[first].iter();
        legs.position(|leg| *leg == wanted).unwrap_or(0)
    };
    let (p, q) = (find(1), find(-1));
    let volts = phases(u);
    let high = if volts[p] >= volts[q] { p } else { q };
    let (on, zero) = ends(high);
    let mut terminal = Vector3::zeros();
    terminal[high] = share(u, &on, &zero) * reach;
    terminal
}
