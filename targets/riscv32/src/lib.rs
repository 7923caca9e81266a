//! Firmware for RISC-V (RV32IMC): drives of two motors and the board.
#![no_std]

pub mod board;
// What is the same on every target.
#[path = "../../firmware/on_target/control.rs"]
pub mod control;
#[macro_use]
#[path = "../../firmware/on_target/drives.rs"]
mod listed;

pub mod drives {
    //! All drives of this firmware.
    drives_for!(portable);
}
