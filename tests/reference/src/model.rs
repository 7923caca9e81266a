//! The ideal and the bit-true model of every controller.
//!
//! Both follow the same texts, the `semantics.md` of the generator's controllers; section numbers
//! in the comments are those of the `pdcc` text, on which the others build. The common steps are
//! written once per model, steps 9 to 11 once per controller and model in `law`. Parts without
//! rounding (Hall decoding, edge timing, supervision) are common to both models; every rounded
//! number is computed twice.

mod angle;
mod bit_true;
mod hall;
mod ideal;
mod sector;
mod supervision;
mod switching;
mod trace;
mod uniform;
mod variant;
mod vectors;

pub use bit_true::{BitTrue, Course};
pub use ideal::{Duties, Ideal};
pub use supervision::{Mode, Stop};
pub use trace::{PhysicalState, Reach, Trace};
pub use uniform::Uniform;
pub use vectors::sixths;
