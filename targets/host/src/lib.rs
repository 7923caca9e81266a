//! Under construction.

pub mod closed_loop;
pub mod plant;
