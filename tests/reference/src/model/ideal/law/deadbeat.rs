//! The deadbeat voltage (section 9), in its two-step form.

use super::Inputs;
use crate::DiscretePhase;
use nalgebra::Vector2;

/// Current at the beginning of the period that the command takes effect in.
pub fn current_then(now: &Inputs) -> Vector2<f64> {
    let DiscretePhase { a, b } = now.phase;
    if now.delayed {
        now.i * a + (now.v_now - now.e_now) * b
    } else {
        now.i
    }
}

/// The voltage that brings the current to its reference at the end of that period.
pub fn voltage(now: &Inputs) -> Vector2<f64> {
    let DiscretePhase { a, b } = now.phase;
    (now.i_ref - current_then(now) * a) / b + now.e
}
