//! The `hexagen` program: commands on top of the laboratory (`hexagen-lab`), and the pages that they
//! write.

pub mod checker;
pub mod cli;
pub mod commands;
mod files;
pub mod report;
