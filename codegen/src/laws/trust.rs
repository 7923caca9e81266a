//! How far an EMF may turn in a control period for its estimate to be trusted.

use super::law;
use crate::spec::{EmfShape, EmfSource, Spec};

/// Greatest turns, electrical degrees per period, up to which simulated drives of PDCC with the default filter keep rated
/// torque within 5 %. A sine loses 5 % at 9 degrees, on whatever motor: the estimate is 1 % off there, the rest is a
/// quasi-square reference that comes late. A trapezoid of 120 degrees is moved on along its ramps, and misses their
/// corners, which counts by what the EMF could drive in a period over the rated current. Where that is 9 times, more
/// than on any other motor of the library, it makes 2 % too much at 8 degrees, with a proportional reference 5 %.
const SINE: f64 = 9.0;
const TRAPEZOID: f64 = 8.0;

/// The ramps of other flat tops are not those of 120 degrees; from 20 degrees off 5 % are reached at 3 to 4 degrees,
/// with 60 to 150 degrees of flat top.
const OTHER: f64 = 3.0;
const OTHER_PER_DEGREE: f64 = 0.25;

/// Parts of the filter, as a turn in radian, at which an estimate that learns its speed from its own length falls behind
/// the EMF for good: simulated with filters from 0.02 to 0.25.
const SINE_PER_FILTER: f64 = 2.0;
pub(super) const TRAPEZOID_PER_FILTER: f64 = 1.1;

/// An EMF's turn at rated speed and the greatest that its estimate stands, electrical degrees per period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trust {
    /// At rated speed.
    pub turn: f64,
    /// Greatest one.
    pub limit: f64,
    /// Whether the filter makes the limit.
    pub filtered: bool,
}

/// Of a controller that estimates the EMF; none of another.
pub fn trust_in_estimate(spec: &Spec) -> Option<Trust> {
    let (motor, options) = (&spec.motor, spec.controller.common());
    if !law(&spec.controller).uses_emf() || options.emf != EmfSource::Estimated {
        return None;
    }
    let (shaped, per_filter) = match motor.emf_shape {
        EmfShape::Sinusoidal => (SINE, SINE_PER_FILTER),
        EmfShape::Trapezoidal { flat_top_deg } => {
            let lost = OTHER_PER_DEGREE * (flat_top_deg - 120.0).abs();
            ((TRAPEZOID - lost).max(OTHER), TRAPEZOID_PER_FILTER)
        }
    };
    let followed = (per_filter * options.emf_filter).to_degrees();
    let omega_e = motor.rated_speed * f64::from(motor.pole_pairs);
    Some(Trust {
        turn: (omega_e * spec.inverter.t_s).to_degrees(),
        limit: shaped.min(followed),
        filtered: followed < shaped,
    })
}
