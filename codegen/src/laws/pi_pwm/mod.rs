#![doc = include_str!("semantics.md")]

mod lower;
mod stability;

pub use lower::lower;
pub use stability::{PiLoop, is_stable_with_winding_time};

use crate::diagnostics::engineering;
use crate::laws::{Law, StableRange};
use crate::spec::{PiPwmSpec, Spec};

/// What the documentation of the type says of the method.
pub fn law(spec: &Spec, options: &PiPwmSpec, stable: StableRange) -> Law {
    let gain = options.proportional_gain(&spec.motor);
    Law {
        title: if options.six_step {
            "Six-step PI current controller"
        } else {
            "PI current controller in the stationary plane"
        },
        notes: vec![
            format!(
                "Tuning: the proportional gain 2 pi f L = {} puts the crossover of the current loop at {};",
                engineering(gain, "V/A"),
                engineering(options.bandwidth, "Hz"),
            ),
            format!(
                "the integral time of {} (L/R = {}) cancels the winding's pole where the two are equal. The anti-windup tracks",
                engineering(options.integral_time, "s"),
                engineering(spec.motor.inductance / spec.motor.resistance, "s"),
            ),
            "with the same time.".to_owned(),
        ],
        stable: Some(stable),
        constants: vec![],
    }
}
