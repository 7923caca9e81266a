//! Proofs about a slice of a program: every path through it, with exact linear arithmetic over all
//! integers.
//!
//! [`linear`] has the forms, [`simplex`] decides whether linear facts have a common point,
//! [`paths`] follows every possible sequence of decisions, and [`slice`](mod@slice) computes a
//! program's values along a path. Of products of two words and of floors only the definition is
//! known, so the proof holds for any of their values.

pub mod linear;
pub mod paths;
pub mod simplex;
pub mod slice;
