//! The deadbeat voltage (section 9): in its two-step form, or with the EMF of the last period held.

use super::{Inputs, held};
use crate::DiscretePhase;
use crate::model::trace::Past;
use nalgebra::Vector2;

/// Current at the beginning of the period in which the command takes effect.
pub fn current_then(now: &Inputs) -> Vector2<f64> {
    let DiscretePhase { a, b } = now.phase;
    if now.delayed {
        now.i * a + now.net * b
    } else {
        now.i
    }
}

/// The voltage that brings the current to its reference at the end of that period.
pub fn voltage(now: &Inputs) -> Vector2<f64> {
    if now.emf_is_held {
        return held::voltage(now);
    }
    let DiscretePhase { a, b } = now.phase;
    (now.i_ref - current_then(now) * a) / b + now.e
}

/// The EMF within the limits; an observed one within `limit` per phase.
pub fn emf(now: &Inputs, limit: f64) -> Vector2<f64> {
    if now.emf_is_held {
        held::emf(now, limit)
    } else {
        now.e
    }
}

/// Contributions of this step's current and voltage `u` to the next steps.
pub fn past(now: &Inputs, u: &Vector2<f64>) -> Past {
    if now.emf_is_held {
        held::past(now, u)
    } else {
        now.past
    }
}
