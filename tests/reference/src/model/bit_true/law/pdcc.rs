//! Predictive deadbeat control: the deadbeat voltage, limited and pulsed.

use super::deadbeat::Deadbeat;
use super::{Decision, Inputs, pulses};
use crate::model::bit_true::constants::Scale;
use crate::model::bit_true::limit;
use crate::{Error, Modulation, Saturation};

#[derive(Clone, Debug)]
pub struct Pdcc {
    pair: bool,
    saturation: Saturation,
    deadbeat: Deadbeat,
}

impl Pdcc {
    pub fn new(options: &crate::Pdcc, scale: &Scale) -> Result<Self, Error> {
        Ok(Self {
            pair: options.modulation == Modulation::Pair,
            saturation: options.saturation,
            deadbeat: Deadbeat::new(scale)?,
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs) -> Decision {
        let u_unsat = self.deadbeat.voltage(now);
        let (u, reach) = limit::limit(self.saturation, now.k, now.v_bus, u_unsat, now.e);
        let command = if self.pair && !now.commutating {
            pulses::pair(now, u_unsat)
        } else {
            pulses::three(now, u, self.pair)
        };
        Decision {
            u_unsat,
            u,
            reach,
            vector: 0,
            command,
            integral: now.integral,
            rises: now.rises,
        }
    }
}
