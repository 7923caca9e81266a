//! Firmware for RISC-V (RV32IMC): drives of two motors and the board.
#![no_std]

pub mod board;
// What is the same on every target.
#[path = "../../firmware/on_target/control.rs"]
pub mod control;
#[path = "../../firmware/on_target/drives.rs"]
pub mod drives;
