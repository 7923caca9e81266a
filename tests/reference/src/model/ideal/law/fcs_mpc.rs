//! FCS-MPC: the candidate with the least distance to the deadbeat voltage, found by trying.

use super::{Decision, Inputs, deadbeat, whole};
use crate::model::Reach;
use crate::model::ideal::vector::{clarke, phases};
use crate::model::vectors;
use crate::{Candidates, FcsMpc, OffLeg};
use nalgebra::{Vector2, Vector3};

/// Share of (|u| + bus)^2 below which two costs count as equal: far above the rounding of f64, far
/// below that of any word. Corner references put the demand exactly between two vectors.
const TIE: f64 = 1e-12;

pub fn decide(options: &FcsMpc, now: &Inputs) -> Decision {
    let u_unsat = deadbeat::voltage(now);
    let tie = TIE * (u_unsat.norm() + now.v_bus).powi(2);
    let cost = |vector: usize| (u_unsat - voltage(options, now, vector)).norm_squared();
    let (zero, others) = vectors::candidates(options.candidates, now.commutating, now.sector_eff);
    let (mut vector, mut least) = (zero, cost(zero));
    for other in others {
        let found = cost(other);
        if found < least - tie {
            (vector, least) = (other, found);
        }
    }
    Decision {
        u_unsat,
        u: voltage(options, now, vector),
        reach: Reach::Inside,
        vector,
        command: whole::command(now, vector),
        integral: [0.0; 2],
        rises: now.rises,
    }
}

/// The voltage that a vector is taken to apply.
fn voltage(options: &FcsMpc, now: &Inputs, vector: usize) -> Vector2<f64> {
    let floats =
        options.off_leg == OffLeg::Physical && options.candidates != Candidates::ThreePhase;
    let Some(off) = vectors::off_leg(vector).filter(|_| floats) else {
        return whole::voltage(now, vector);
    };
    let mut terminal =
        Vector3::from(vectors::LEGS[vector].map(|leg| if leg > 0 { now.v_bus } else { 0.0 }));
    let driven = terminal.sum() / 2.0;
    let current = phases(&deadbeat::current_then(now))[off];
    terminal[off] = if current > options.commutation_threshold {
        0.0
    } else if current < -options.commutation_threshold {
        now.v_bus
    } else {
        (driven + 1.5 * phases(&now.e)[off]).clamp(0.0, now.v_bus)
    };
    clarke(&terminal)
}
