//! Drives emitted as C99 and compiled by the target's C compiler, for the test bench: the step
//! function in the ELF is the C function itself.
#![no_std]
#![expect(
    unsafe_code,
    reason = "the functions are in C; the build script checks the size of their types"
)]

#[macro_use]
mod drive;

use drive::StatusInC;
use hexagen_firmware::hexagen::{Fault, Supervisor};
use hexagen_firmware::session::replay;
use hexagen_firmware::wire::Stop;
use hexagen_firmware::{Drives, LegsInC, Listed, SampleInC, StepFn, Subject};

include!(concat!(env!("OUT_DIR"), "/drives.rs"));
