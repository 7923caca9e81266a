//! One vector for a whole period: its legs, and its stored voltage (sections 11 and 12 of FCS-MPC).

use super::{Command, Inputs};
use crate::Error;
use crate::exact::{Coefficient, Word, floor, word};
use crate::model::bit_true::constants::Scale;
use crate::model::vectors;
use hexagen::{LegState, Legs};

/// The command of a vector; in variants without off legs, low legs are pulsed with 0.
#[inline]
pub fn command<W: Word>(now: &Inputs<W>, vector: usize, turns_off: bool) -> Command<W> {
    let legs = vectors::LEGS[vector];
    let on = now.k.timer_period as u16;
    Command {
        legs: Legs::new(
            legs.map(|leg| if leg > 0 { on } else { 0 }),
            if turns_off {
                vectors::states(vector)
            } else {
                [LegState::Pulsed; 3]
            },
        ),
        terminal: legs.map(|leg| if leg > 0 { now.v_bus } else { word(0.0) }),
        off: vectors::off_leg(vector).map_or(0, |leg| leg + 1),
    }
}

/// A sixth of the bus, the unit of the vectors' phase voltages without floating legs.
#[derive(Clone, Debug)]
pub struct Sixth<W> {
    /// `None` if the voltage is only traced.
    k_sixth: Option<Coefficient<W>>,
}

impl<W: Word> Sixth<W> {
    pub fn new(scale: &Scale) -> Result<Self, Error> {
        let variant = &scale.variant;
        let is_kept = !variant.floating && !variant.pulsed() && variant.applied();
        let k_sixth = is_kept.then(|| scale.coefficient("k_sixth", 1.0 / 6.0));
        Ok(Self {
            k_sixth: k_sixth.transpose()?,
        })
    }

    /// Phase voltages a, b of a vector.
    #[inline]
    pub fn voltage(&self, now: &Inputs<W>, vector: usize) -> [W; 2] {
        let sixth = match &self.k_sixth {
            Some(k_sixth) => k_sixth.mul(now.v_bus),
            None => floor(now.v_bus / 6.0),
        };
        let [a, b, _] = vectors::sixths(vector);
        [sixth * a, sixth * b]
    }
}
