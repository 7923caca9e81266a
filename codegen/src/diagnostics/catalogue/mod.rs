//! The texts of all diagnostics, one constructor each.
//!
//! Wording: quantity, given value with unit, limit, what to change. Given values are quoted as
//! written; computed numbers have four significant digits, limits rounded to the accepted side
//! (`at_most`, `at_least`). Field names stand in backticks.

mod controller;
mod currents;
mod design;
mod drive;
mod part;
mod structure;
mod timing;
mod values;

pub use controller::*;
pub use currents::*;
pub use design::*;
pub use drive::*;
pub use part::Part;
pub use structure::*;
pub use timing::*;
pub use values::*;
