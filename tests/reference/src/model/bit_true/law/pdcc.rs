//! Predictive deadbeat control: the deadbeat voltage, limited and pulsed.

use super::dead_time::DeadTime;
use super::deadbeat::Deadbeat;
use super::{Decision, Inputs, pulses};
use crate::model::bit_true::constants::Scale;
use crate::model::bit_true::limit;
use crate::{Error, Modulation, Saturation, Spec};

#[derive(Clone, Debug)]
pub struct Pdcc {
    pair: bool,
    saturation: Saturation,
    deadbeat: Deadbeat,
    dead_time: DeadTime,
}

impl Pdcc {
    pub fn new(spec: &Spec, options: &crate::Pdcc, scale: &Scale) -> Result<Self, Error> {
        Ok(Self {
            pair: options.modulation == Modulation::Pair,
            saturation: options.saturation,
            deadbeat: Deadbeat::new(scale)?,
            dead_time: DeadTime::new(spec, scale)?,
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs) -> Decision {
        let u_unsat = self.deadbeat.voltage(now);
        let (u, reach) = limit::limit(self.saturation, now.k, now.v_bus, u_unsat, now.e);
        let shifts = self.dead_time.shifts(now, self.deadbeat.held(now));
        let command = if self.pair && !now.commutating {
            pulses::pair(now, u_unsat, shifts)
        } else {
            pulses::three(now, u, shifts, self.pair)
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
