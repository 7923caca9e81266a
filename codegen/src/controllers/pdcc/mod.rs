#![doc = include_str!("semantics.md")]

mod spec;

pub use spec::{EmfSource, Modulation, PdccSpec, Reference, Saturation};
