#![doc = include_str!("semantics.md")]

mod options;
mod spec;

pub(crate) use options::{OPTIONS, Surroundings, check_options};
pub use spec::{EmfSource, Modulation, PdccSpec, Reference, Saturation};
