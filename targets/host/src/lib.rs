//! The host target: a simulated plant, closed loops of any model of a controller, and the
//! `hexagen` program on top of them.

pub mod checker;
pub mod cli;
pub mod closed_loop;
pub mod commands;
pub mod counted;
pub mod engine;
mod files;
pub mod plant;
pub mod report;
