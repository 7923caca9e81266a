//! Bounds of a drive on a plant: its envelope, and that of any current profile.

use crate::any_profile;
use crate::plant::PlantParams;
use hexagen_codegen::design::Envelope;
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
