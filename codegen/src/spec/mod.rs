//! Specification: syntax tree, units and checks.

pub mod ast;
pub(crate) mod check;
mod emf_shape;
mod load;
mod macro_syntax;
mod model;
mod normalised;
pub(crate) mod schema;
mod toml_syntax;
pub mod units;
mod value;
mod variant;

pub use ast::SpecAst;
pub use check::{Origin, Origins, check};
pub use load::load_motor_file;
pub use macro_syntax::{MacroInput, MotorFile, parse_macro};
pub use model::{BusSource, EmfShape, HallCapture, InverterSpec, MotorSpec, Spec};
pub use toml_syntax::parse_toml;
pub use variant::apply_variant;
