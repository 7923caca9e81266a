//! One vector for a whole period: its legs, and its stored voltage (sections 11 and 12 of FCS-MPC).

use super::common_mode::CommonModeRule;
use super::{Command, Inputs};
use crate::exact::{Coefficient, Word, floor, word};
use crate::model::bit_true::scale::Scale;
use crate::model::vectors;
use crate::{Error, Spec};
use hexagen::{LegState, Legs};

/// How far the high legs of vectors reach, and the unit of the vectors' phase voltages.
#[derive(Clone, Debug)]
pub struct Whole<W> {
    rule: CommonModeRule<W>,
    /// `None` if the voltage is only traced.
    k_sixth: Option<Coefficient<W>>,
}

impl<W: Word> Whole<W> {
    pub fn new(spec: &Spec, scale: &Scale) -> Result<Self, Error> {
        let variant = &scale.variant;
        let is_kept = !variant.floating && !variant.pulsed() && variant.applied();
        let k_sixth = is_kept.then(|| scale.coefficient("k_sixth", 1.0 / 6.0));
        Ok(Self {
            // A leg of each vector is low throughout.
            rule: CommonModeRule::of_vectors(spec, scale)?,
            k_sixth: k_sixth.transpose()?,
        })
    }

    /// Largest compare value.
    pub fn top(&self) -> f64 {
        self.rule.top
    }

    /// V: the voltage of a high leg.
    #[inline]
    pub fn reach(&self, now: &Inputs<W>) -> W {
        self.rule.reach(now.v_bus)
    }

    /// The command of a vector; in variants without off legs, low legs are pulsed with 0.
    #[inline]
    pub fn command(&self, now: &Inputs<W>, vector: usize, turns_off: bool) -> Command<W> {
        let legs = vectors::LEGS[vector];
        let (on, reach) = (self.rule.top as u16, self.reach(now));
        Command {
            legs: Legs::new(
                legs.map(|leg| if leg > 0 { on } else { 0 }),
                if turns_off {
                    vectors::states(vector)
                } else {
                    [LegState::Pulsed; 3]
                },
            )
            .into(),
            terminal: legs.map(|leg| if leg > 0 { reach } else { word(0.0) }),
            off: vectors::off_leg(vector).map_or(0, |leg| leg + 1),
        }
    }

    /// Phase voltages a, b of a vector without floating legs.
    #[inline]
    pub fn voltage(&self, now: &Inputs<W>, vector: usize) -> [W; 2] {
        let reach = self.reach(now);
        let sixth = match &self.k_sixth {
            Some(k_sixth) => k_sixth.mul(reach),
            None => floor(reach / 6.0),
        };
        let [a, b, _] = vectors::sixths(vector);
        [sixth * a, sixth * b]
    }
}
