//! What the cross-crate tests share: the motor library, the options of a drive, covering arrays,
//! planted faults, proofs over programs and of the model's exactness, and what the bit-for-bit test is
//! extended by: the interpreter as a subject, and arbitrary states.

pub mod cases;
/// The drives of the covering arrays, as the build script finds them.
pub mod covering {
    include!(concat!(env!("OUT_DIR"), "/covering_specifications.rs"));
}
pub mod edges;
pub mod equality;
pub mod exactness;
pub mod faults;
pub mod interpreter;
pub mod library;
pub mod mutation;
pub mod options;
pub mod pairwise;
pub mod proof;
pub mod set;
pub mod states;

/// The README's examples, which the documentation tests of this crate run.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

/// The example of the generator's README.
#[cfg(doctest)]
#[doc = include_str!("../../codegen/README.md")]
pub struct GeneratorReadme;
