//! The laws: one folder each with semantics, design and expressions, around the step that all share:
//! `semantics.md` here and the folder `current_loop`.
//!
//! A new controller adds a folder here and its options to `spec::controller`; [`Law`] is its
//! interface to the rest of the generator.

mod accuracy;
mod constants;
pub mod current_loop;
pub mod fcs_mpc;
mod interface;
mod law;
mod operation;
pub mod p_pwm;
pub mod pdcc;
pub mod phcc;
pub mod pi_pwm;
mod start;
mod supervision;
mod trust;
mod whole_vectors;
mod word_choice;

pub use accuracy::accuracy_constants;
pub use current_loop::{Allowance, StableRange};
pub use interface::interface;
pub use law::{Cause, Description, Law, Period, Start, law};
pub use trust::{Trust, trust_in_estimate};
pub use word_choice::{narrow_words, wide_words};

use crate::spec::Spec;
use current_loop::LoopDesign;

/// Stable range of true over stated R and L, with exact coefficients; none if the loop is not
/// linear.
pub fn stable_range(spec: &Spec) -> Option<StableRange> {
    let design = LoopDesign::new(spec, spec.controller.common());
    let linear = law(&spec.controller).linear(spec, &design)?;
    Some(linear.stable_range(spec))
}
