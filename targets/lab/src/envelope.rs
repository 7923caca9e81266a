//! Bounds of a drive on a plant: its envelope, and that of any current profile.

use crate::any_profile;
use crate::plant::PlantParams;
use hexagen_codegen::spec::Envelope;
use hexagen_codegen::spec::Spec;
use serde::Serialize;
use std::f64::consts::TAU;

/// The envelope of a drive with the motor and the bus of a plant.
pub fn envelope_on(spec: &Spec, plant: &PlantParams) -> Envelope {
    let mean = |phases: [f64; 3]| phases.iter().sum::<f64>() / 3.0;
    Envelope {
        resistance: mean(plant.resistance),
        inductance: mean(plant.inductance),
        emf_constant: mean(plant.k_phase),
        v_bus: plant.v_bus,
        ..Envelope::of(spec)
    }
}

/// Greatest torques over speed: rpm and newton metres, ascending.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueBounds {
    /// With the drive's own reference, whole.
    pub envelope: Vec<(f64, f64)>,
    /// With any current profile within the peak of that reference.
    pub any_profile: Vec<(f64, f64)>,
}

impl TorqueBounds {
    /// Speeds of a curve over the rated one: from a fifth of it in steps of 2 %.
    const SHARES: [u32; 2] = [10, 80];

    /// Of an envelope, for speeds up to 160 % of the rated one in mechanical rad/s.
    pub fn of(envelope: &Envelope, rated_speed: f64) -> Self {
        let [first, last] = Self::SHARES;
        let speeds = (first..=last).map(|share| 0.02 * f64::from(share) * rated_speed);
        let curve = |torque: fn(&Envelope, f64) -> f64| {
            let points = speeds.clone();
            let points = points.map(|omega_m| (omega_m * 60.0 / TAU, torque(envelope, omega_m)));
            points.collect()
        };
        Self {
            envelope: curve(Envelope::torque),
            any_profile: curve(any_profile::torque),
        }
    }
}

/// Speeds that bound a motoring torque.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SpeedBounds {
    /// Up to which the bus drives the whole current of the drive's reference, rpm; 0 for a torque beyond
    /// the drive.
    pub envelope_rpm: f64,
    /// Beyond which no current profile within the peak of the drive's reference gives the torque, rpm.
    pub any_profile_rpm: f64,
}

impl SpeedBounds {
    /// Of a torque in Nm; `None` for braking, which the EMF helps.
    pub fn of(envelope: &Envelope, torque: f64) -> Option<Self> {
        (torque > 0.0).then(|| {
            let lasts = envelope.speed(torque).unwrap_or(0.0);
            Self {
                envelope_rpm: lasts * 60.0 / TAU,
                any_profile_rpm: any_profile::speed(envelope, torque, lasts) * 60.0 / TAU,
            }
        })
    }
}
