#![doc = include_str!("semantics.md")]

mod lower;
mod stability;

pub use lower::lower;
pub use stability::DeadbeatLoop;

use crate::laws::{Law, StableRange};

/// What the documentation of the type says of the method.
pub fn law(stable: StableRange) -> Law {
    Law {
        title: "Predictive deadbeat current controller",
        notes: vec![],
        stable: Some(stable),
        constants: vec![],
    }
}
