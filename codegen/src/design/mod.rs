//! From the checked specification to the numbers of the control law, in f64 and SI units.

pub mod emf;
mod plant;
pub mod vectors;
pub mod weakening;

pub use plant::DiscretePlant;
