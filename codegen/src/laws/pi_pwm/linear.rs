//! The PI loop as a linear system.

use crate::design::DiscretePlant;
use crate::laws::current_loop::{LinearLoop, LoopDesign, SeenEmf};
use crate::spec::{PiPwmSpec, Spec};
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

/// The PI loop as a linear system of the state (i, i_prev, v_now, v_prev, e_prev, e_next, integral).
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
        7
    }

    fn advance(&self, real: DiscretePlant, x: &DVector<f64>) -> DVector<f64> {
        let [i, i_prev, v_now, v_prev, e_prev, e_next, integral] =
            [x[0], x[1], x[2], x[3], x[4], x[5], x[6]];
        let common = &self.options.common;
        let e = if self.options.feed_forward {
            SeenEmf::new(common, self.design, [i, i_prev], v_prev, [e_prev, e_next])
        } else {
            SeenEmf::default()
        };
        let proportional = -self.options.proportional_gain(&self.spec.motor) * i;
        let u = proportional + integral + e.target;
        let integral = integral + self.options.integral_share(self.spec) * proportional;
        let (applied, v_next, v_last) = if common.delay == 1 {
            (v_now, u, v_now)
        } else {
            (u, 0.0, u)
        };
        let next = real.pole * i + real.gain * applied;
        DVector::from_vec(vec![next, i, v_next, v_last, e.present, e.target, integral])
    }
}
