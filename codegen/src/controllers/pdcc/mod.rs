#![doc = include_str!("semantics.md")]

mod design;
mod interface;
mod lower;
mod options;
mod spec;

pub use design::PdccDesign;
pub use interface::{StableRange, interface};
pub use lower::lower;
pub(crate) use options::{OPTIONS, Surroundings, check_options};
pub use spec::{EmfSource, Modulation, PdccSpec, Reference, Saturation};
