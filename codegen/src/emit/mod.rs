//! Emitters: from a verified graph and its interface to text or tokens.
//!
//! Each knows the graph, its tables and its naming, never the specification and never another
//! emitter, and none can fail.

mod comment;
pub mod datasheet;
mod expression;
pub mod gappa;
mod names;
mod path;
mod plan;
mod rows;
pub mod rust;
mod set_point;
mod signal;
mod texts;

pub use names::module_name;

#[cfg(test)]
mod tests;

pub struct C99Sources { pub name: String, pub header: String, pub source: String }

/// Stands in for the emitter of C99 until that follows the runtime.
pub mod c99 {
    pub use super::C99Sources as Sources;

    /// None yet.
    pub fn emit_c99(_: &crate::ir::VerifiedGraph, _: &crate::interface::Interface, _: &str) -> Sources {
        unimplemented!("C99 does not follow the runtime yet")
    }
}
