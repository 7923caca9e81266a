//! Proofs about a slice of a program: every path through it, with exact linear arithmetic over all integers.
//!
//! [`linear`] has the forms, [`simplex`] says whether linear facts have a common point, [`paths`] follows every
//! sequence of decisions that is possible, and [`slice`](mod@slice) computes a program's values along a path. Products of two words and
//! floors are numbers of which only their definition is known, so what is proven holds whatever they are.

pub mod linear;
pub mod paths;
pub mod simplex;
pub mod slice;
