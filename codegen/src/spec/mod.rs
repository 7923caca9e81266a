//! Specification: syntax tree, units and checks.

mod emf_shape;
mod model;
mod normalised;

pub use model::{BusSource, EmfShape, HallCapture, InverterSpec, MotorSpec, Spec};
