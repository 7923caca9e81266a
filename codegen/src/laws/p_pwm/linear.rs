//! The proportional loop as a linear system.

use crate::design::DiscretePlant;
use crate::laws::current_loop::{LinearLoop, LoopDesign, SeenEmf};
use crate::spec::PPwmSpec;
use nalgebra::DVector;

/// The proportional loop as a linear system of the state (i, i_prev, v_now, v_prev, e_prev, e_next).
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
        6
    }

    fn advance(&self, real: DiscretePlant, x: &DVector<f64>) -> DVector<f64> {
        let [i, i_prev, v_now, v_prev, e_prev, e_next] = [x[0], x[1], x[2], x[3], x[4], x[5]];
        let common = &self.options.common;
        let e = SeenEmf::new(common, self.design, [i, i_prev], v_prev, [e_prev, e_next]);
        let u = e.target - self.gain * i;
        let (applied, v_next, v_last) = if common.delay == 1 {
            (v_now, u, v_now)
        } else {
            (u, 0.0, u)
        };
        let next = real.pole * i + real.gain * applied;
        DVector::from_vec(vec![next, i, v_next, v_last, e.present, e.target])
    }
}
