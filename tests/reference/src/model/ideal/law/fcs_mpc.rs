//! FCS-MPC: the candidate with the least distance to the deadbeat voltage, found by trying.

use super::{Decision, Inputs, deadbeat, divided, whole};
use crate::model::Reach;
use crate::model::ideal::vector::{clarke, phases};
use crate::model::vectors;
use crate::{Candidates, FcsMpc, OffLeg, Switch};
use nalgebra::{Vector2, Vector3};

/// Share of (|u| + bus)^2 below which two costs count as equal: far above the rounding of f64, far
/// below that of any word. Corner references put the demand exactly between two vectors.
pub const TIE: f64 = 1e-12;

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
    let (u, command) = match options.modulated {
        Switch::Off => (voltage(options, now, vector), whole::command(now, vector)),
        Switch::On => divided::command(options, now, &u_unsat, vector),
    };
    Decision {
        u_unsat,
        u,
        reach: Reach::Inside,
        vector,
        command,
        integral: [0.0; 2],
        rises: now.rises,
    }
}

/// The voltage that a vector is taken to apply.
fn voltage(options: &FcsMpc, now: &Inputs, vector: usize) -> Vector2<f64> {
    let Some(off) = vectors::off_leg(vector).filter(|_| floats(options)) else {
        return whole::voltage(now, vector);
    };
    let terminal =
        Vector3::from(vectors::LEGS[vector].map(|leg| if leg > 0 { now.v_bus } else { 0.0 }));
    with_off_leg(options, now, terminal, off)
}

/// Whether the voltage of a leg that is off is predicted.
pub fn floats(options: &FcsMpc) -> bool {
    options.off_leg == OffLeg::Physical && options.candidates != Candidates::ThreePhase
}

/// The rail at which a diode is predicted to hold the leg, if it is off.
pub fn rail(options: &FcsMpc, now: &Inputs, off: usize) -> Option<f64> {
    let current = phases(&deadbeat::current_then(now))[off];
    if current > options.commutation_threshold {
        Some(0.0)
    } else if current < -options.commutation_threshold {
        Some(now.v_bus)
    } else {
        None
    }
}

/// The voltage of driven terminals with the off leg where it is predicted.
pub fn with_off_leg(
    options: &FcsMpc,
    now: &Inputs,
    mut terminal: Vector3<f64>,
    off: usize,
) -> Vector2<f64> {
    terminal[off] = 0.0;
    let floating = || terminal.sum() / 2.0 + 1.5 * phases(&now.e)[off];
    terminal[off] = rail(options, now, off).unwrap_or_else(|| floating().clamp(0.0, now.v_bus));
    clarke(&terminal)
}
