//! FCS-MPC as a program: the shared step, the choice of a vector, and its legs.

use crate::blocks::Scale;
use crate::blocks::set_point::{Gain, SetPointWords};
use crate::ir::Interval;
use crate::laws::current_loop::{CurrentLoop, EmfUse, LoopDesign, Needs, lower_with};
use crate::laws::whole_vectors::Numbers;
use crate::scaling::Lowered;
use crate::spec::{Candidates, FcsMpcSpec, Spec};

/// Lowers the controller at a scale.
pub(super) fn lower(
    spec: &Spec,
    options: &FcsMpcSpec,
    design: &LoopDesign,
    scale: Scale,
) -> Lowered {
    lower_with(spec, scale, Gain::stiffness(design.k_di), |l, set_point| {
        let step = CurrentLoop {
            l,
            options: &options.common,
            design,
            needs: Needs {
                commutation: options.pairs(),
                off_leg: options.floating(),
                emf: EmfUse::Deadbeat,
                memory: 0,
                rounding: false,
            },
        };
        apply_best(&step, options, set_point);
    })
}

/// Chooses and commands a vector or two, by the options.
fn apply_best(step: &CurrentLoop<'_, '_>, options: &FcsMpcSpec, set_point: &SetPointWords<'_>) {
    let numbers = if options.pairs() {
        Numbers::Vectors
    } else {
        Numbers::WithoutPairs
    };
    let front = step.front_of_vectors(set_point);
    let u = step.deadbeat(&front, false).u;
    if let (2, Some(e)) = (options.horizon, front.e) {
        let vector = step.choose_two_steps(options, &front, e, u);
        step.apply_vector(&front, vector, numbers, vec![]);
        return;
    }
    if options.modulated {
        let choice = step.choose(options, &front, u);
        step.apply_two_vectors(&front, &choice);
        return;
    }
    if options.weighted() {
        let memory = (options.switching_weight > 0.0).then(|| {
            let doc = "Vector of the last step: 0 V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 a pair's zero.";
            step.l.b.memory("vector_prev", 0, Interval::new(0, 15), doc)
        });
        let vector = step.choose_weighted(options, &front, u, memory);
        let remembered = memory.map(|memory| (memory, vector));
        let remembered = remembered.into_iter().collect();
        step.apply_vector(&front, vector, numbers, remembered);
        return;
    }
    match (options.candidates, front.commutation) {
        (Candidates::Table2, Some(commutation)) => {
            let vector = step.choose_of_table2(options, &front, u, commutation.flag);
            step.apply_vector(&front, vector, numbers, vec![]);
        }
        (Candidates::ThreePhase, _) => {
            let pattern = step.choose_low_legs(&front, u);
            step.apply_vector(&front, pattern, Numbers::LowLegs, vec![]);
        }
        _ => {
            let choice = step.choose(options, &front, u);
            step.apply_vector(&front, choice.vector, numbers, vec![]);
        }
    }
}
