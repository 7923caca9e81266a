#![doc = include_str!("semantics.md")]

mod choose;
mod divide;
mod lower;

pub use lower::lower;

use crate::controllers::Law;
use crate::controllers::current_loop::LoopDesign;
use crate::diagnostics::engineering;
use crate::spec::{FcsMpcSpec, Spec};

/// What the documentation of the type says of the method.
pub fn law(spec: &Spec, options: &FcsMpcSpec, design: &LoopDesign) -> Law {
    let stride = design.plant.gain * 2.0 / 3.0 * spec.inverter.v_bus;
    let begin = if options.modulated {
        "The chosen voltage vector is the"
    } else {
        "One voltage vector per period: the"
    };
    let mut notes = vec![
        format!("{begin} allowed one with the least predicted error |i_ref - i(k+2)|^2. The error of a"),
        "vector v is b |u - v| with u the deadbeat voltage, so the step looks for the vector nearest to u and enumerates nothing.".to_owned(),
        format!("One three-phase vector moves the current by at most {} per period.", engineering(stride, "A")),
    ];
    if options.modulated {
        notes.push("It shares the period with the best other vector with which one pulse per leg can share it, each for the time of the".to_owned());
        notes.push(
            "least predicted error: their mean is the point nearest to u on the line between them."
                .to_owned(),
        );
    }
    Law {
        title: "Finite-control-set model predictive current controller",
        notes,
        stable: None,
        constants: vec![],
    }
}
