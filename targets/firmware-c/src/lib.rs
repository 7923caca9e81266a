//! Drives that are emitted as C99 and compiled by the target's C compiler, for the test bench: the step function that
//! stands in the ELF is the C function itself.
#![no_std]
#![expect(
    unsafe_code,
    reason = "the functions are in C; the build script checks the size of their types"
)]

#[macro_use]
mod drive;

use core::cell::UnsafeCell;
use core::marker::PhantomData;
use drive::CStatus;
use hexagen_firmware::hexagen::fixed::types::I16F16;
use hexagen_firmware::hexagen::{Drive, DriveLoop, DriveSetPoint, Format, Legs, Sample, Status};
use hexagen_firmware::session::replay;
use hexagen_firmware::{Drives, LegsInC, Listed, StepFn};

/// A drive in C as its control loop.
pub struct Whole<'drive, D>(*mut D, PhantomData<&'drive mut D>);

// SAFETY: it stands for an exclusive reference.
unsafe impl<D: Send> Send for Whole<'_, D> {}

include!(concat!(env!("OUT_DIR"), "/drives.rs"));
