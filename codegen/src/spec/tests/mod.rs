//! Tests of the specification as a whole.

mod diagnostics;
mod front_ends;
mod inverter;
mod motors;
mod spelling;
