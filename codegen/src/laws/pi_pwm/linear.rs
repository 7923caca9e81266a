//! The PI loop as a linear system.

use crate::design::DiscretePlant;
use crate::laws::current_loop::{LinearLoop, LoopDesign, estimate};
use crate::spec::{EmfSource, PiPwmSpec, Spec};
use nalgebra::DVector;

/// Whether the loop would be stable with the default integral time, L/R.
pub fn is_stable_with_winding_time(spec: &Spec, options: &PiPwmSpec) -> bool {
    let integral_time = spec.motor.inductance / spec.motor.resistance;
    let linear = PiLoop {
        options: &PiPwmSpec {
            integral_time,
            ..*options
        },
        design: &LoopDesign::new(spec, &options.common),
        spec,
    };
    linear.spectral_radius(spec) < 1.0
}

/// The PI loop; state i, i_prev, v_now, v_prev, e_prev, integral.
#[derive(Clone, Copy, Debug)]
pub struct PiLoop<'d> {
    /// Options.
    pub options: &'d PiPwmSpec,
    /// Coefficients of the EMF estimate.
    pub design: &'d LoopDesign,
    /// The drive.
    pub spec: &'d Spec,
}

impl LinearLoop for PiLoop<'_> {
    fn order(&self) -> usize {
        6
    }

    fn advance(&self, real: DiscretePlant, x: &DVector<f64>) -> DVector<f64> {
        let [i, i_prev, v_now, v_prev, e_prev, integral] = [x[0], x[1], x[2], x[3], x[4], x[5]];
        let common = &self.options.common;
        let share = if self.options.feed_forward && common.emf == EmfSource::Estimated {
            common.emf_filter
        } else {
            0.0
        };
        let e = estimate(share, self.design, [i, i_prev], v_prev, e_prev);
        let proportional = -self.options.proportional_gain(&self.spec.motor) * i;
        let u = proportional + integral + e;
        let integral = integral + self.options.integral_share(self.spec) * proportional;
        let (applied, v_next, v_last) = if common.delay == 1 {
            (v_now, u, v_now)
        } else {
            (u, 0.0, u)
        };
        let next = real.pole * i + real.gain * applied;
        DVector::from_vec(vec![next, i, v_next, v_last, e, integral])
    }
}
