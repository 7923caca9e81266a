//! One vector for a whole period.

use super::{Command, Inputs};
use crate::model::ideal::Duties;
use crate::model::ideal::vector::clarke;
use crate::model::vectors;
use nalgebra::{Vector2, Vector3};

/// The command of a vector.
pub fn command(now: &Inputs, vector: usize) -> Command {
    let duties = Duties {
        duty: vectors::LEGS[vector].map(|leg| if leg > 0 { 1.0 } else { 0.0 }),
        state: vectors::states(vector),
    };
    Command {
        duties,
        terminal: Vector3::from(duties.duty) * now.v_bus,
        off: vectors::off_leg(vector),
    }
}

/// A vector's voltage, a leg that is off in the middle of the others.
pub fn voltage(now: &Inputs, vector: usize) -> Vector2<f64> {
    clarke(&Vector3::from(vectors::sixths(vector))) * (now.v_bus / 6.0)
}
