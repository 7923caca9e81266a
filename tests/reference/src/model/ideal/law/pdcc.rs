//! Predictive deadbeat control: the deadbeat voltage, limited and pulsed.

use super::common_mode::CommonModeRule;
use super::dead_time::{DeadTime, kept_by_deadbeat};
use super::intervals::{Modulated, Table2};
use super::{Decision, Inputs, deadbeat, pulses};
use crate::model::ideal::limit;
use crate::model::ideal::vector::{clarke, phases, to_ab};
use crate::{Error, Modulation, Spec};

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
            dead_time: DeadTime::new(spec),
            common_mode: CommonModeRule::new(spec, options.common_mode)?,
            of_pair: CommonModeRule::of_vectors(spec)?,
            table2: (options.modulation == Modulation::Table2)
                .then(|| Table2::new(spec, (options.saturation, options.zero)))
                .transpose()?,
            v_largest: spec.inverter.v_bus_max()?,
        })
    }

    pub fn decide(&self, now: &Inputs) -> Decision {
        let options = &self.options;
        let shifts = self.dead_time.shifts(now, kept_by_deadbeat(now));
        let u_unsat = deadbeat::voltage(now);
        let e = deadbeat::emf(now, self.v_largest);
        if let Some(table2) = &self.table2 {
            let Modulated { u, reach, command } = table2.modulate(now, &u_unsat, &e);
            return Decision {
                u_unsat,
                u,
                reach,
                vector: 0,
                command,
                integral: to_ab(&now.integral),
                rises: now.rises,
                past: deadbeat::past(now, &u),
            };
        }
        let limited = limit::limit(
            options.saturation,
            &phases(&u_unsat),
            &phases(&e),
            self.common_mode.reach(now.v_bus),
        );
        let legs = self.common_mode.readable(&limited.u, now.v_bus);
        let command = if options.modulation == Modulation::Pair && !now.commutating {
            pulses::pair(now, &phases(&u_unsat), &shifts, self.of_pair)
        } else {
            pulses::three(now, &legs, &shifts, self.common_mode)
        };
        let u = clarke(&legs);
        Decision {
            u_unsat,
            u,
            reach: limited.reach,
            vector: 0,
            command,
            integral: to_ab(&now.integral),
            rises: now.rises,
            past: deadbeat::past(now, &u),
        }
    }
}
