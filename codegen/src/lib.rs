//! hexagen-codegen: from a motor's data sheet to a verified fixed-point current controller.

pub mod controllers;
pub mod design;
pub mod diagnostics;
pub mod interface;
pub mod ir;
pub mod lower;
pub mod pipeline;
pub mod scaling;
pub mod spec;
