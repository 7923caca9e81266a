//! The deadbeat loop as a linear system.

use crate::controllers::current_loop::{LinearLoop, LoopDesign, estimate};
use crate::design::DiscretePlant;
use crate::spec::LoopOptions;
use nalgebra::DVector;

/// The deadbeat loop; state i, i_prev, v_now, v_prev, e_prev.
#[derive(Clone, Copy, Debug)]
pub struct DeadbeatLoop<'d> {
    /// Options.
    pub options: &'d LoopOptions,
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
        let e = estimate(options, design, [i, i_prev], v_prev, e_prev);
        if options.delay == 1 {
            let u = -design.k_hold * i + design.k_decay * (v_now - e) + 2.0 * e - v_now;
            DVector::from_vec(vec![real.pole * i + real.gain * v_now, i, u, v_now, e])
        } else {
            let u = -design.k_hold * i + e;
            DVector::from_vec(vec![real.pole * i + real.gain * u, i, 0.0, u, e])
        }
    }
}
