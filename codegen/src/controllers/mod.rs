//! The controllers: one folder each, with its options, design and lowering.
//!
//! Adding a controller adds a folder here and a variant to [`ControllerSpec`].

pub mod pdcc;

/// A controller and its options.
#[derive(Clone, Debug, PartialEq)]
pub enum ControllerSpec {
    /// Predictive deadbeat current control.
    Pdcc(pdcc::PdccSpec),
}
