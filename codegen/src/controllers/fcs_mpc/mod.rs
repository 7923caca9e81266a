#![doc = include_str!("semantics.md")]

mod choose;
mod lower;

pub use lower::lower;

use crate::controllers::Law;
use crate::controllers::current_loop::LoopDesign;
use crate::diagnostics::engineering;
use crate::spec::Spec;

/// What the documentation of the type says of the method.
pub fn law(spec: &Spec, design: &LoopDesign) -> Law {
    let stride = design.plant.gain * 2.0 / 3.0 * spec.inverter.v_bus;
    Law {
        title: "Finite-control-set model predictive current controller",
        notes: vec![
            "One voltage vector per period: the allowed one with the least predicted error |i_ref - i(k+2)|^2. The error of a".to_owned(),
            "vector v is b |u - v| with u the deadbeat voltage, so the step looks for the vector nearest to u and enumerates nothing.".to_owned(),
            format!("One three-phase vector moves the current by at most {} per period.", engineering(stride, "A")),
        ],
        stable: None,
        constants: vec![],
    }
}
