//! Phase currents at the largest set-point without a fault, for the checks of the trip level.

use super::{ControllerSpec, EmfShape, Spec};

/// Default trip level over the largest set-point: above any overshoot, and safe for switches and
/// magnets chosen for the motor. Whole vectors may need more.
pub(crate) const TRIP_BY_DEFAULT: f64 = 2.0;

/// Trip level over the largest set-point's peak below which a warning is given: a step overshoots by 5 %, a current
/// ripples by up to 7 %, and the zeros of the sensors drift.
pub(crate) const TRIP_AT_LEAST: f64 = 1.15;

/// Values that the currents of a drive depend on, SI.
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
    /// Values that the currents of this drive depend on.
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

    /// Greatest change of a phase current by one vector in a control period, at standstill, ampere.
    pub fn vector_stride(&self) -> f64 {
        self.drive().stride(1.0)
    }
}

impl Drive<'_> {
    /// Greatest phase current of the reference at the largest set-point, ampere.
    pub fn peak(&self) -> f64 {
        let reference = self.controller.common().reference;
        self.max_current * self.emf_shape.current_peak(reference)
    }

    /// Largest set-point of such a drive that leaves room below the `trip` level, ampere.
    pub fn largest_below(&self, trip: f64) -> f64 {
        trip / TRIP_AT_LEAST * self.max_current / self.peak()
    }

    /// Greatest change of a phase current by one vector applied for `periods`, at standstill,
    /// ampere.
    pub fn stride(&self, periods: f64) -> f64 {
        let decay = self.resistance * periods * self.t_s / self.inductance;
        2.0 / 3.0 * self.v_bus * -(-decay).exp_m1() / self.resistance
    }

    /// Greatest phase current without a fault, ampere: the reference's peak plus the overshoot.
    pub fn reach(&self) -> f64 {
        self.peak() + self.controller.overshoot(self)
    }

    /// Peak of the phase currents in commutations at low speed, ampere; 0 where it is not above
    /// [`Self::reach`].
    pub fn swing(&self) -> f64 {
        self.controller.swing(self)
    }
}
