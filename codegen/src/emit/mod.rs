//! Emitters: from a verified graph and its interface to text or tokens.
//!
//! Each uses the graph and the interface, never the specification or another emitter. None can
//! fail.

pub mod c99;
mod comment;
pub mod datasheet;
mod expression;
pub mod gappa;
mod names;
mod path;
mod plan;
mod rows;
pub mod rust;
mod signal;
mod texts;
mod times;

pub use names::module_name;

#[cfg(test)]
mod tests;
