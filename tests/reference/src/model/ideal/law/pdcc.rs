//! Predictive deadbeat control: the deadbeat voltage, limited and pulsed.

use super::common_mode::CommonModeRule;
use super::dead_time::{DeadTime, kept_by_deadbeat};
use super::intervals::{Modulated, Table2};
use super::{Decision, Inputs, deadbeat, pulses};
use crate::model::ideal::vector::{clarke, phases, to_ab};
use crate::{Error, Modulation, Spec};
use nalgebra::Vector2;

#[derive(Clone, Copy, Debug)]
pub struct Pdcc {
    options: crate::Pdcc,
    dead_time: DeadTime,
    common_mode: CommonModeRule,
    /// One leg of a pair is low throughout, as of vectors.
    of_pair: CommonModeRule,
    table2: Option<Table2>,
    /// Largest plausible EMF, volt.
    v_largest: f64,
}

impl Pdcc {
    pub fn new(spec: &Spec, options: &crate::Pdcc) -> Result<Self, Error> {
        Ok(Self {
            options: *options,
            dead_time: DeadTime::new(spec, options.modulation == Modulation::ThreePhase),
            common_mode: CommonModeRule::new(spec, options.common_mode)?,
            of_pair: CommonModeRule::of_vectors(spec)?,
            table2: Table2::of(spec, options.modulation, (options.saturation, options.zero))?,
            v_largest: spec.inverter.v_bus_max()?,
        })
    }

    pub fn decide(&self, now: &Inputs) -> Decision {
        let u_unsat = deadbeat::voltage(now);
        let e = deadbeat::emf(now, self.v_largest);
        let Modulated { u, reach, command } = match &self.table2 {
            Some(table2) => table2.modulate(now, &u_unsat, &e),
            None => self.pulses(now, &u_unsat, &e),
        };
        Decision {
            u_unsat,
            u,
            reach,
            vector: 0,
            command,
            integral: to_ab(&now.integral),
            rises: now.rises,
            past: deadbeat::past(now, &u),
        }
    }

    /// The limited voltage by pulses.
    fn pulses(&self, now: &Inputs, u_unsat: &Vector2<f64>, e: &Vector2<f64>) -> Modulated {
        let options = &self.options;
        let limited = self
            .common_mode
            .limited(now, options.saturation, u_unsat, e);
        let shifts = self
            .dead_time
            .shifts(now, kept_by_deadbeat(now), limited.spread);
        let command = if options.modulation == Modulation::Pair && !now.commutating {
            pulses::pair(now, &phases(u_unsat), &shifts, self.of_pair)
        } else {
            pulses::three(now, &limited.u, &shifts, self.common_mode)
        };
        Modulated {
            u: clarke(&limited.u),
            reach: limited.reach,
            command,
        }
    }
}
