//! Predictive deadbeat control: the deadbeat voltage, limited and pulsed.

use super::{Decision, Inputs, deadbeat, pulses};
use crate::model::ideal::limit;
use crate::model::ideal::vector::{clarke, phases, to_ab};
use crate::{Modulation, Pdcc};

pub fn decide(options: &Pdcc, now: &Inputs) -> Decision {
    let u_unsat = deadbeat::voltage(now);
    let limited = limit::limit(
        options.saturation,
        &phases(&u_unsat),
        &phases(&now.e),
        now.v_bus,
    );
    let command = if options.modulation == Modulation::Pair && !now.commutating {
        pulses::pair(now, &phases(&u_unsat))
    } else {
        pulses::three(now, &limited.u)
    };
    Decision {
        u_unsat,
        u: clarke(&limited.u),
        reach: limited.reach,
        vector: 0,
        command,
        integral: to_ab(&now.integral),
        rises: now.rises,
    }
}
