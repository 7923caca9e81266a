//! What the cross-crate tests share: the motor library, the options of a drive, covering arrays,
//! and the interpreter as a subject of the bit-for-bit test.

pub mod interpreter;
pub mod library;
pub mod options;
pub mod pairwise;
