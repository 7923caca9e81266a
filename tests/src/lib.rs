//! Common parts of the cross-crate tests: motor library, options of a drive, covering arrays,
//! planted faults, proofs over programs and of the model's exactness, and extensions of the
//! bit-for-bit test: the interpreter as a subject, and arbitrary states.

/// Whether tests have the sizes of the nightly run: the environment's `HEXAGEN_WHOLE_PRODUCTS` is set.
pub fn is_whole() -> bool {
    std::env::var_os("HEXAGEN_WHOLE_PRODUCTS").is_some()
}

pub mod cases;
/// The drives of the covering arrays, from the build script.
pub mod covering {
    /// A row of a covering array.
    #[derive(Clone, Copy, Debug)]
    pub struct Row {
        /// Kind of controller.
        pub kind: &'static str,
        /// Type name, motor and options.
        pub what: &'static str,
        /// Its specification.
        pub toml: &'static str,
        /// Its emitted code is compiled in this run.
        pub is_compiled: bool,
    }

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
pub mod random_motor;
pub mod sensors;
pub mod set;
pub mod states;

/// The README's examples, run as documentation tests of this crate.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

/// The example of the generator's README.
#[cfg(doctest)]
#[doc = include_str!("../../codegen/README.md")]
pub struct GeneratorReadme;
