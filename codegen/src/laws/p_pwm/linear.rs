//! The proportional loop as a linear system.

use crate::design::DiscretePlant;
use crate::laws::current_loop::{LinearLoop, LoopDesign, estimate};
use crate::spec::{EmfSource, PPwmSpec};
use nalgebra::DVector;

/// The proportional loop; state i, i_prev, v_now, v_prev, e_prev.
#[derive(Clone, Copy, Debug)]
pub struct ProportionalLoop<'d> {
    /// Options.
    pub options: &'d PPwmSpec,
    /// Proportional gain, V/A.
    pub gain: f64,
    /// Coefficients of the EMF estimate.
    pub design: &'d LoopDesign,
}

impl LinearLoop for ProportionalLoop<'_> {
    fn order(&self) -> usize {
        5
    }

    fn advance(&self, real: DiscretePlant, x: &DVector<f64>) -> DVector<f64> {
        let [i, i_prev, v_now, v_prev, e_prev] = [x[0], x[1], x[2], x[3], x[4]];
        let common = &self.options.common;
        let share = match common.emf {
            EmfSource::Estimated => common.emf_filter,
            EmfSource::Model | EmfSource::Held => 0.0,
        };
        let e = estimate(share, self.design, [i, i_prev], v_prev, e_prev);
        let u = e - self.gain * i;
        let (applied, v_next, v_last) = if common.delay == 1 {
            (v_now, u, v_now)
        } else {
            (u, 0.0, u)
        };
        let next = real.pole * i + real.gain * applied;
        DVector::from_vec(vec![next, i, v_next, v_last, e])
    }
}
