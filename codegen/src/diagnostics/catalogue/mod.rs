//! The texts of all diagnostics, one constructor each.
//!
//! Wording: quantity, given value with unit, limit, what to change. Given values are quoted as
//! written; computed numbers have four significant digits. Field names stand in backticks.

mod design;

pub use design::{
    coefficient_out_of_range, inductance_outside_stable_range, internal,
    resistance_outside_stable_range, unstable_loop, word_too_narrow,
};
