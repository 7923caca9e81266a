//! Specification: syntax tree, units and checks.

mod model;

pub use model::{BusSource, EmfShape, HallCapture, InverterSpec, MotorSpec, Spec};
