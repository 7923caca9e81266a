//! One vector for a whole period.

use super::{Command, Inputs};
use crate::model::ideal::Duties;
use crate::model::ideal::vector::clarke;
use crate::model::vectors;
use hexagen::LegState;
use nalgebra::{Vector2, Vector3};

/// The command of a vector; in variants without off legs, low legs are pulsed with 0.
pub fn command(now: &Inputs, vector: usize, turns_off: bool) -> Command {
    let duties = Duties {
        duty: vectors::LEGS[vector].map(|leg| if leg > 0 { 1.0 } else { 0.0 }),
        state: if turns_off {
            vectors::states(vector)
        } else {
            [LegState::Pulsed; 3]
        },
    };
    Command {
        duties,
        terminal: Vector3::from(duties.duty) * now.v_bus,
        off: vectors::off_leg(vector),
    }
}

/// A vector's voltage, with an off leg in the middle of the others.
pub fn voltage(now: &Inputs, vector: usize) -> Vector2<f64> {
    clarke(&Vector3::from(vectors::sixths(vector))) * (now.v_bus / 6.0)
}
