//! One vector for a whole period.

use super::common_mode::CommonModeRule;
use super::{Command, Inputs};
use crate::model::ideal::Duties;
use crate::model::ideal::vector::clarke;
use crate::model::vectors;
use crate::{Error, Spec};
use hexagen::LegState;
use nalgebra::{Vector2, Vector3};

/// How far the high legs of vectors reach.
#[derive(Clone, Copy, Debug)]
pub struct Whole(CommonModeRule);

impl Whole {
    pub fn new(spec: &Spec) -> Result<Self, Error> {
        // A leg of each vector is low throughout.
        Ok(Self(CommonModeRule::of_vectors(spec)?))
    }

    /// The voltage of a high leg.
    pub fn reach(self, now: &Inputs) -> f64 {
        self.0.reach(now.v_bus)
    }

    /// Terminal voltages of a vector, 0 of an off leg.
    pub fn terminals(self, now: &Inputs, vector: usize) -> Vector3<f64> {
        let reach = self.reach(now);
        Vector3::from(vectors::LEGS[vector].map(|leg| if leg > 0 { reach } else { 0.0 }))
    }

    /// The command of a vector; in variants without off legs, low legs are pulsed with 0.
    pub fn command(self, now: &Inputs, vector: usize, turns_off: bool) -> Command {
        let duties = Duties {
            duty: vectors::LEGS[vector].map(|leg| if leg > 0 { self.0.top } else { 0.0 }),
            state: if turns_off {
                vectors::states(vector)
            } else {
                [LegState::Pulsed; 3]
            },
            later: None,
        };
        Command {
            duties,
            terminal: self.terminals(now, vector),
            off: vectors::off_leg(vector),
        }
    }

    /// A vector's voltage, with an off leg in the middle of the others.
    pub fn voltage(self, now: &Inputs, vector: usize) -> Vector2<f64> {
        clarke(&Vector3::from(vectors::sixths(vector))) * (self.reach(now) / 6.0)
    }
}
