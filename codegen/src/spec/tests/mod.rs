//! Tests of the specification as a whole.

mod diagnostics_macro;
mod diagnostics_toml;
mod front_ends;
mod inverter;
mod motors;
mod spelling;
