//! What phase currents a drive in health reaches at its largest set-point, against its trip level.

use super::{ControllerSpec, EmfShape, Reference, Spec};

/// The default trip level over the largest set-point: room for what a current overshoots by, and
/// little enough for switches and magnets that were chosen for the motor. Vectors may need more.
pub(crate) const TRIP_BY_DEFAULT: f64 = 2.0;

/// What the currents of a drive depend on, SI.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive<'a> {
    pub controller: &'a ControllerSpec,
    pub emf_shape: EmfShape,
    pub resistance: f64,
    pub inductance: f64,
    /// Nominal bus voltage.
    pub v_bus: f64,
    pub t_s: f64,
    /// Largest set-point.
    pub max_current: f64,
}

impl Spec {
    /// What the currents of this drive depend on.
    pub(crate) fn drive(&self) -> Drive<'_> {
        Drive {
            controller: &self.controller,
            emf_shape: self.motor.emf_shape,
            resistance: self.motor.resistance,
            inductance: self.motor.inductance,
            v_bus: self.inverter.v_bus,
            t_s: self.inverter.t_s,
            max_current: self.inverter.max_current,
        }
    }
}

impl Drive<'_> {
    /// Greatest phase current of the reference at the largest set-point, ampere.
    pub fn peak(&self) -> f64 {
        self.max_current
            * match self.controller.common().reference {
                Reference::QuasiSquare => 1.0,
                Reference::Proportional => self.emf_shape.proportional_peak(),
            }
    }

    /// Greatest change of a phase current under one vector that lasts so many periods, at
    /// standstill, ampere.
    pub fn stride(&self, periods: f64) -> f64 {
        let decay = self.resistance * periods * self.t_s / self.inductance;
        2.0 / 3.0 * self.v_bus * -(-decay).exp_m1() / self.resistance
    }

    /// What the currents must be able to reach without a trip, ampere: the reference's peak, and what the controller
    /// adds.
    pub fn reach(&self) -> f64 {
        self.peak() + self.controller.overshoot(self)
    }

    /// What the currents reach in the commutations of a rotor that turns slowly, ampere; 0 where that is no more than
    /// [`Self::reach`].
    pub fn swing(&self) -> f64 {
        self.controller.swing(self)
    }
}
