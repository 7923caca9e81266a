//! Predictive deadbeat current control: the ideal and the bit-true model.
//!
//! Both follow the same text, `semantics.md` of the generator's `pdcc` folder, whose section
//! numbers the comments cite. What involves no rounding (Hall decoding, edge timing,
//! supervision) is shared; every number that is rounded is computed twice.

mod bit_true;
mod hall;
mod ideal;
mod sector;
mod supervision;
mod trace;

pub use bit_true::{BitTrue, Course};
pub use ideal::{Duties, Ideal};
pub use supervision::Mode;
pub use trace::{PhysicalState, Reach, Trace};
