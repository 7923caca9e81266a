//! Largest turn of the EMF per control period at which its estimate is usable.

use super::law;
use crate::spec::{EmfShape, EmfSource, Spec};

/// Largest turns, electrical degrees per period, at which simulated PDCC drives with the default
/// filter keep rated torque within 5 %. A sine loses 5 % at 9 degrees on any motor: 1 % by the
/// estimate, the rest by the late quasi-square reference. The advance of a 120-degree trapezoid
/// follows its ramps and misses their corners; the error grows with the current that the EMF drives
/// in a period over the rated one. At 9 times, more than on any other motor of the library, torque
/// is 2 % high at 8 degrees, with a proportional reference 5 %.
const SINE: f64 = 9.0;
const TRAPEZOID: f64 = 8.0;

/// The ramps of other flat tops differ from those of 120 degrees: with 60 to 150 degrees of flat
/// top and 20 degrees or more off, 5 % are reached at 3 to 4 degrees.
const OTHER: f64 = 3.0;
const OTHER_PER_DEGREE: f64 = 0.25;

/// Turn in radian over the filter's share at which an estimate that takes its speed from its own
/// length lags the EMF for good: simulated with filters from 0.02 to 0.25.
const SINE_PER_FILTER: f64 = 2.0;
pub(super) const TRAPEZOID_PER_FILTER: f64 = 1.1;

/// Turn of the EMF at rated speed and its limit, electrical degrees per period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trust {
    /// At rated speed.
    pub turn: f64,
    /// Limit.
    pub limit: f64,
    /// Whether the limit comes from the filter.
    pub filtered: bool,
}

/// The turn and its limit; none without an EMF estimate.
pub fn trust_in_estimate(spec: &Spec) -> Option<Trust> {
    let (motor, options) = (&spec.motor, spec.controller.common());
    if !law(&spec.controller).uses_emf() || options.emf != EmfSource::Estimated {
        return None;
    }
    let (shaped, per_filter) = match motor.emf_shape {
        EmfShape::Sinusoidal => (SINE, SINE_PER_FILTER),
        // It is turned as a sine, which it is not.
        EmfShape::Harmonics(_) => (OTHER, SINE_PER_FILTER),
        EmfShape::Trapezoidal { flat_top_deg } => {
            let lost = OTHER_PER_DEGREE * (flat_top_deg - 120.0).abs();
            ((TRAPEZOID - lost).max(OTHER), TRAPEZOID_PER_FILTER)
        }
    };
    let followed = (per_filter * options.emf_filter).to_degrees();
    Some(Trust {
        turn: motor.rated_turn(spec.inverter.t_s),
        limit: shaped.min(followed),
        filtered: followed < shaped,
    })
}
