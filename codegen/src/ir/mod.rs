//! The intermediate representation: integer programs in SSA form, grouped into named stages.
//!
//! [`graph`] defines it, [`op`] its arithmetic, `build` constructs it and computes the
//! [`interval`]s, `rewrite` applies the rewriting rules, `prune` removes dead values, [`verify()`]
//! turns a [`Program`] into a [`VerifiedGraph`] or lists broken invariants, [`bounds`] computes
//! error bounds, [`interpret`] runs it, [`text`] prints it, [`cost`] counts operations. Nothing
//! here depends on motors, units or Rust syntax: physical meaning is text for documentation only.

pub mod bounds;
mod build;
pub mod cost;
mod draft;
pub mod error;
pub mod expr;
pub mod graph;
pub mod interpret;
pub mod interval;
#[cfg(test)]
mod interval_tests;
pub mod op;
mod prune;
mod rewrite;
pub mod role;
pub mod text;
pub mod verify;
#[cfg(test)]
mod verify_tests;

pub use bounds::{Bounds, Case, StatedError, cases, stated_errors};
#[cfg(test)]
pub(crate) use cost::tests::with_rare_product;
pub use cost::{Cost, PathCost, live_words};
pub use draft::ProgramBuilder;
pub use error::{ErrorInterval, Exact, Real};
pub(crate) use expr::named;
pub use expr::{
    Choice, Coefficient, Expr, Flag, Lut, Memory, Named, Operand, Param, Phases, mul_add_floor,
    pick,
};
pub use graph::{
    AtRest, Constant, Function, Guard, Input, Node, Periodic, Program, Quantity, Stage, Table, Word,
};
pub use interpret::{Escape, Machine};
pub use interval::Interval;
pub use op::{Comparison, ConstantId, Kind, Op, ParamId, StateId, TableId, Value};
pub use role::{Demand, Output, Phase, Setter, Told};
pub use verify::{VerifiedGraph, Violation, derived_interval, verify};
