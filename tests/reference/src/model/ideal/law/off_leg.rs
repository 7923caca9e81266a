//! The terminal of an off leg, if predicted.

use super::{Inputs, deadbeat};
use crate::model::ideal::vector::{clarke, phases};
use crate::{Candidates, OffLeg};
use nalgebra::{Vector2, Vector3};

/// Fraction of (|u| + bus)^2 below which two costs count as equal: far above the rounding of f64,
/// far below that of any word. Corner references put the demand exactly between two vectors.
pub const TIE: f64 = 1e-12;

/// Whether the voltage of an off leg is predicted.
pub fn floats(options: &crate::FcsMpc) -> bool {
    options.off_leg == OffLeg::Physical && options.candidates != Candidates::ThreePhase
}

/// The rail at which a diode is predicted to hold the leg, if it is off.
pub fn rail(options: &crate::FcsMpc, now: &Inputs, off: usize) -> Option<f64> {
    let current = phases(&deadbeat::current_then(now))[off];
    if current > options.commutation_threshold {
        Some(0.0)
    } else if current < -options.commutation_threshold {
        Some(now.v_bus)
    } else {
        None
    }
}

/// The voltage of driven terminals with the off leg at its predicted position.
pub fn with_off_leg(
    options: &crate::FcsMpc,
    now: &Inputs,
    mut terminal: Vector3<f64>,
    off: usize,
) -> Vector2<f64> {
    terminal[off] = 0.0;
    let floating = || terminal.sum() / 2.0 + 1.5 * phases(&now.e)[off];
    terminal[off] = rail(options, now, off).unwrap_or_else(|| floating().clamp(0.0, now.v_bus));
    clarke(&terminal)
}
