//! Tests of the specification as a whole.

mod boards;
mod data_sheets;
mod diagnostics;
mod emf_shapes;
mod explanations;
mod front_ends;
mod inverter;
mod motors;
mod sensing;
mod spelling;
