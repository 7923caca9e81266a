//! The `hexagen` program: commands on top of the laboratory (`hexagen-lab`), and renderers of its
//! reports.

pub mod checker;
pub mod cli;
pub mod commands;
mod files;
pub mod render;
