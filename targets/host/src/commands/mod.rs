//! The commands, one module each.
//!
//! Each has its options, a function that collects plain data, and one that prints them as a table
//! or as JSON.

pub mod advise;
pub mod boards;
pub mod check;
pub mod compare;
pub mod completions;
mod cut;
pub mod explain;
pub mod faults;
pub mod generate;
pub mod halls;
pub mod limit;
pub mod motors;
pub mod new;
pub mod prove;
pub mod ran;
pub mod replay;
pub mod report;
pub mod reproduce;
pub mod selected;
pub mod simulate;
pub mod verify;
