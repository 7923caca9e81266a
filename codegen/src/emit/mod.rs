//! Emitters: from a verified graph and its interface to text or tokens.
//!
//! Each knows the graph, its tables and its naming, never the specification and never another
//! emitter, and none can fail.

pub mod datasheet;
mod expression;
pub mod gappa;
mod plan;
pub mod rust;
mod set_point;
mod signal;

#[cfg(test)]
mod tests;
