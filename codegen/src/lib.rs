//! hexagen-codegen: from a motor's data sheet to a verified fixed-point current controller.
//!
//! # Architecture
//!
//! ```text
//! macro tokens ─┐
//!               ├─ parse ─> SpecAst ─ check ─> Spec              (spec: spans end here)
//! TOML, variant ┘             ║ barrier 1: every error of the specification at once
//!   design  ─> gains, vectors, EMF tables, stable range       (design, laws/*/design: f64, SI)
//!   scale   ─> formats: the finest that provably fit          (scaling, blocks: last real numbers)
//!   lower   ─> Program: SSA over 32-bit words, in stages      (laws and blocks, as ir::expr)
//!   rewrite ─> the same program in the form that is emitted   (ir::rewrite: all rules)
//!   verify  ─> VerifiedGraph                                  (ir::verify: intervals, stages, words)
//!                             ║ barrier 2: every error of design and scaling at once
//!   bound   ─> distance of every value from the ideal one     (ir::bounds)
//!   time    ─> instructions and cycles on named chips         (timing: counted or estimated)
//!   emit    ─> Rust │ C99 │ data sheet │ IR text │ Gappa scripts   (emit: cannot fail)
//! ```
//!
//! Each stage imports earlier stages and [`diagnostics`] only. Emitters take a
//! [`ir::VerifiedGraph`] and an [`interface::Interface`], never a specification. Scaling is a
//! search for the finest scale whose program passes the verifier. A new controller adds its options
//! to `spec::controller`, a variant of [`spec::ControllerSpec`] and a folder under [`laws`], built
//! on the shared step ([`laws::current_loop`]) and its [`blocks`] (measurement, rotor angle, EMF,
//! limits, modulation).

mod at_once;
pub mod blocks;
mod builder;
mod derive;
pub mod design;
pub mod diagnostics;
pub mod emit;
mod expand;
mod field_items;
pub mod interface;
pub mod ir;
pub mod laws;
pub mod pipeline;
pub mod scaling;
pub mod spec;
pub mod stopwatch;
pub mod timing;

pub use builder::{BuildError, Builder, Written};
pub use derive::derive_state;
pub use expand::{expand_controller, expand_verify};
pub use field_items::expand_fields;
