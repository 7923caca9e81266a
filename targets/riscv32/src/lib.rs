//! Firmware for RISC-V (RV32IMC): drives of two motors and the board.
#![no_std]

pub mod board;
pub mod control;
pub mod drives;
