//! The laboratory: a simulated plant, closed loops of any model of a controller, what they are
//! judged by, and all ways to run a generated drive. A library without a command line.
//!
//! The generator's tables of formats and limits come over in the runtime's types here: nothing else
//! knows both.

pub mod closed_loop;
pub mod counted;
pub mod engine;
mod inputs;
mod interpreted;
pub mod plant;
mod readings;
pub mod standalone;
mod tables;

pub use inputs::Inputs;
pub use interpreted::Interpreted;
pub use readings::{READINGS, Readings};
pub use tables::{formats, limits, state_names};
