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

    /// What the currents must be able to reach without a trip, ampere: the reference's peak, and
    /// what whole vectors add. Those of hysteresis carry a current out of its band until the
    /// command that answers takes effect. Those of FCS-MPC miss by one vector's change, and by the
    /// error that a change of state may weigh as much as.
    pub fn reach(&self) -> f64 {
        let own = match self.controller {
            ControllerSpec::FcsMpc(options) if !options.modulated => {
                self.stride(1.0) + options.switching_weight
            }
            ControllerSpec::Phcc(options) => {
                let answered = 1.0 + f64::from(options.common.delay);
                phase_band(options.band) + self.stride(answered)
            }
            _ => 0.0,
        };
        self.peak() + own
    }

    /// What PHCC reaches in the commutations of a rotor that turns slowly, ampere; 0 for the
    /// others. The reference's corner goes by 2/sqrt(3) I along beta, and until it is reached the
    /// vector at 60 degrees to it, V/3 on alpha and V/sqrt(3) on beta, takes the one phase current
    /// up by 2/3 I, less what its resistance takes of V/3. The band comes on top, and most of a
    /// period's change: with three quarters of it the library's motors, simulated, reach 94 to 111
    /// % of this.
    pub fn swing(&self) -> f64 {
        let ControllerSpec::Phcc(options) = self.controller else {
            return 0.0;
        };
        let left = 1.0 - 3.0 * self.resistance * self.max_current / self.v_bus;
        self.max_current * (1.0 + 2.0 / 3.0 * left.max(0.0))
            + phase_band(options.band)
            + 0.75 * self.stride(1.0)
    }
}

/// By how much bands of this half width on alpha and beta let a phase current be off: b = -alpha/2
/// + sqrt(3)/2 beta.
fn phase_band(band: f64) -> f64 {
    f64::midpoint(1.0, 3_f64.sqrt()) * band
}
