//! Under construction.

pub mod closed_loop;
pub mod plant;
pub mod report;
