//! What holds between the crates: arithmetic, emitted code, proofs, bounds, models and texts.
//!
//! One program compiles and links faster than one for each file.

mod arithmetic;
mod codes_in_texts;
mod decisions;
mod drives_by_macro;
mod emitted_code;
mod error_bounds;
mod exactness;
mod faults_in_ir;
mod layers;
mod learnt_hall_edges;
mod low_legs;
mod no_panic_path;
mod over_speed;
mod safety;
mod sensors;
mod signals;
mod stm32;
mod total;
