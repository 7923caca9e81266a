//! From the checked specification to the numbers of the control law, in f64 and SI units.

mod plant;

pub use plant::{Discretisation, DiscretePlant};
