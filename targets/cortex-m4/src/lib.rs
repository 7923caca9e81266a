//! Firmware for a Cortex-M4: drives of two motors and the board.
#![no_std]

pub mod board;
pub mod control;
pub mod drives;
