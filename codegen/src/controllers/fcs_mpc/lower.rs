//! FCS-MPC as IR: the shared step, the choice of a vector, and its legs.

use crate::controllers::current_loop::{CurrentLoop, EmfUse, LoopDesign, Needs, lower_with};
use crate::lower::Scale;
use crate::scaling::Lowered;
use crate::spec::{FcsMpcSpec, Spec};

/// Lowers the controller at a scale.
pub fn lower(spec: &Spec, options: &FcsMpcSpec, design: &LoopDesign, scale: Scale) -> Lowered {
    lower_with(spec, scale, design.k_di, |lowering, set_point| {
        let mut step = CurrentLoop {
            lowering,
            options: &options.common,
            design,
            needs: Needs {
                commutation: options.pairs(),
                off_leg: options.floating(),
                emf: EmfUse::Prediction,
                integral: false,
            },
        };
        let front = step.front(set_point);
        let u = step.deadbeat(&front, false).u;
        let choice = step.choose(options, &front, u);
        if options.modulated {
            step.apply_two_vectors(&front, &choice);
        } else {
            step.apply_vector(&front, choice.vector, vec![]);
        }
    })
}
