//! The laboratory, a library without a command line: simulated plant, closed loops with any model
//! of a controller, figures of merit, engines of a generated drive, and reports as data.
//!
//! As the only crate with both generator and runtime, it also converts the generator's tables of
//! formats and limits into the runtime's types.

pub mod accuracy;
pub mod advise;
pub mod any_profile;
pub mod boards;
pub mod closed_loop;
pub mod counted;
pub mod engine;
pub mod envelope;
mod error;
pub mod faults;
pub mod halls;
mod inputs;
mod interpreted;
pub mod judgement;
pub mod log;
pub mod motors;
pub mod plant;
mod progress;
mod readings;
pub mod replay;
pub mod report;
pub mod reproduction;
pub mod results;
pub mod robustness;
pub mod stability;
pub mod standalone;
mod tables;
pub mod text;
pub mod times;
pub mod verification;

pub use error::LabError;
pub use inputs::Inputs;
pub use interpreted::Interpreted;
pub use progress::Progress;
pub use readings::{IMPROVEMENTS, Improvement, READINGS, Readings};
pub use tables::{angle, formats, limits, sensors, state_names};
