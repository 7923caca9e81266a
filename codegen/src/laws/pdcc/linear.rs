//! The deadbeat loop as a linear system.

use crate::design::DiscretePlant;
use crate::laws::current_loop::{LinearLoop, LoopDesign, SeenEmf};
use crate::spec::PdccSpec;
use nalgebra::DVector;

/// The deadbeat loop as a linear system of the state (i, i_prev, v_now, v_prev, e_prev, e_next).
#[derive(Clone, Copy, Debug)]
pub struct DeadbeatLoop<'d> {
    /// Options.
    pub options: &'d PdccSpec,
    /// Coefficients, rounded or not.
    pub design: &'d LoopDesign,
}

impl LinearLoop for DeadbeatLoop<'_> {
    fn order(&self) -> usize {
        6
    }

    fn advance(&self, real: DiscretePlant, x: &DVector<f64>) -> DVector<f64> {
        let [i, i_prev, v_now, v_prev, e_prev, e_next] = [x[0], x[1], x[2], x[3], x[4], x[5]];
        let (common, design) = (&self.options.common, self.design);
        let e = SeenEmf::new(common, design, [i, i_prev], v_prev, [e_prev, e_next]);
        if common.delay == 1 {
            let u =
                -design.k_hold * i + design.k_decay * (v_now - e.present) + e.target + e.present
                    - v_now;
            let next = real.pole * i + real.gain * v_now;
            DVector::from_vec(vec![next, i, u, v_now, e.present, e.target])
        } else {
            let u = -design.k_hold * i + e.target;
            DVector::from_vec(vec![
                real.pole * i + real.gain * u,
                i,
                0.0,
                u,
                e.present,
                0.0,
            ])
        }
    }
}
