//! The deadbeat loop as a linear system.

use crate::design::DiscretePlant;
use crate::laws::current_loop::{EMF_INTEGRAL_SHARE, LinearLoop, LoopDesign, estimate};
use crate::spec::{EmfSource, PdccSpec};
use nalgebra::DVector;

/// The deadbeat loop; state i, i_prev, v_now, v_prev, e_prev.
#[derive(Clone, Copy, Debug)]
pub struct DeadbeatLoop<'d> {
    /// Options.
    pub options: &'d PdccSpec,
    /// Coefficients, rounded or not.
    pub design: &'d LoopDesign,
}

impl LinearLoop for DeadbeatLoop<'_> {
    fn order(&self) -> usize {
        5
    }

    fn advance(&self, real: DiscretePlant, x: &DVector<f64>) -> DVector<f64> {
        let [i, i_prev, v_now, v_prev, e_prev] = [x[0], x[1], x[2], x[3], x[4]];
        let Self { options, design } = *self;
        let share = match options.common.emf {
            EmfSource::Estimated => options.common.emf_filter,
            // Folding does not change the loop.
            EmfSource::Held => 1.0,
            // At standstill the modelled EMF is 0, so the integral alone holds the EMF.
            EmfSource::Model if options.integral => EMF_INTEGRAL_SHARE,
            EmfSource::Model => 0.0,
        };
        let e = estimate(share, design, [i, i_prev], v_prev, e_prev);
        if options.common.delay == 1 {
            let u = -design.k_hold * i + design.k_decay * (v_now - e) + 2.0 * e - v_now;
            DVector::from_vec(vec![real.pole * i + real.gain * v_now, i, u, v_now, e])
        } else {
            let u = -design.k_hold * i + e;
            DVector::from_vec(vec![real.pole * i + real.gain * u, i, 0.0, u, e])
        }
    }
}
