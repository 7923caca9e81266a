//! Deadbeat control with the EMF of the last period held, its terms collected by age (section 9,
//! `emf: held`).

use super::Inputs;
use crate::DiscretePhase;
use crate::model::ideal::vector::{from_ab, to_ab};
use crate::model::trace::Past;
use nalgebra::Vector2;

fn vector([a, b]: [f64; 2]) -> Vector2<f64> {
    from_ab(a, b)
}

/// The demanded voltage.
pub fn voltage(now: &Inputs) -> Vector2<f64> {
    let DiscretePhase { a, b } = now.phase;
    let weight = if now.delayed {
        1.0 + a + a * a
    } else {
        1.0 + a
    };
    (now.i_ref - now.i * weight) / b + vector(now.past.due)
}

/// The error predicted for the end of this period, ampere.
pub fn deviation(now: &Inputs) -> Vector2<f64> {
    let DiscretePhase { a, b } = now.phase;
    now.i_ref - now.i * (1.0 + a) + vector(now.past.due) * b
}

/// Contributions of this step's current and its voltage `u` to the next two predictions.
pub fn past_of_prediction(now: &Inputs, u: &Vector2<f64>) -> Past {
    let DiscretePhase { a, b } = now.phase;
    Past {
        due: to_ab(&(vector(now.past.later) - u + now.i * (a / b))),
        later: to_ab(u),
    }
}

/// The observed EMF of the last period, each phase within `limit`.
pub fn emf(now: &Inputs, limit: f64) -> Vector2<f64> {
    let DiscretePhase { a, b } = now.phase;
    let (due, later) = (vector(now.past.due), vector(now.past.later));
    let known = if now.delayed {
        (due + later * (a / (1.0 + a))) / (1.0 + a)
    } else {
        due
    };
    vector(to_ab(&(known - now.i / b)).map(|e| e.clamp(-limit, limit)))
}

/// Contributions of this step's current and voltage `u` to the next two.
pub fn past(now: &Inputs, u: &Vector2<f64>) -> Past {
    let DiscretePhase { a, b } = now.phase;
    if now.delayed {
        let sampled = now.i * (a * (1.0 + a) / b);
        Past {
            due: to_ab(&(vector(now.past.later) - u * a + sampled)),
            later: to_ab(&(u * (1.0 + a))),
        }
    } else {
        Past {
            due: to_ab(&(u + now.i * (a / b))),
            later: [0.0; 2],
        }
    }
}
