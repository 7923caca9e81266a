//! The program as its users run it, and the figures that its report promises.

mod faults;
mod generate;
mod input;
mod lines;
mod newcomer;
mod output;
mod reproduce;
mod robustness;
mod rows;
mod simulate;
mod support;
mod verify;
