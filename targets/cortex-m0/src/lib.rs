//! Firmware for a Cortex-M0: drives of two motors and the board.
#![no_std]

pub mod board;
// Modules of all targets.
#[path = "../../firmware/on_target/control.rs"]
pub mod control;
#[macro_use]
#[path = "../../firmware/on_target/drives.rs"]
mod listed;

pub mod drives {
    //! All drives of this firmware.
    #![expect(
        deprecated,
        reason = "the generator warns of PHCC near its trip level (HX0610, HX0611), and of steps longer than a period of this core (HX0614)"
    )]
    drives_for!(cortex_m0);
}
