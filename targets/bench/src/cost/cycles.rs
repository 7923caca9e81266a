//! Estimated cycles of a step: the instructions that the emulator executes, weighted by kind.
//!
//! A load or store takes two cycles, of n words 1 + n, a taken branch three, a division as in the
//! table, all others one: as in the Cortex-M4 and Cortex-M0 manuals for memory without wait states.
//! RISC-V cores differ; the same weights suit a short in-order pipeline.

use super::elf::{Class, Image};
use crate::targets::Target;
use std::ops::Range;

/// Cycles of a division. The Cortex-M4 takes 2 to 12; the Cortex-M0 has none.
fn division(target: Target) -> u32 {
    match target {
        Target::CortexM4 | Target::CortexM0 => 12,
        Target::Riscv32 => 33,
    }
}

/// One executed call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Executed {
    /// Instructions from the function's entry to its return.
    pub instructions: u32,
    /// Cycles, estimated.
    pub cycles: u32,
}

/// All calls of a function in the emulator's log of single instructions. A call ends when `caller`
/// continues.
pub fn executed(
    log: &str,
    image: &Image,
    target: Target,
    function: &Range<u32>,
    caller: &Range<u32>,
) -> Vec<Executed> {
    let mut calls = vec![];
    let mut call: Option<Executed> = None;
    let mut addresses = log.lines().filter_map(address).peekable();
    while let Some(at) = addresses.next() {
        if at == function.start && call.is_none() {
            call = Some(Executed {
                instructions: 0,
                cycles: 0,
            });
        }
        if caller.contains(&at) {
            calls.extend(call.take());
        }
        if let (Some(call), Some(instruction)) = (&mut call, image.instruction(at)) {
            let next = addresses.peek().copied();
            let is_taken = next.is_some_and(|next| next != at + instruction.length());
            call.instructions += 1;
            call.cycles += match instruction.class() {
                Class::Memory(words) if is_taken => 3 + words,
                Class::Memory(words) => 1 + words,
                Class::Divide => division(target),
                Class::Plain if is_taken => 3,
                Class::Plain => 1,
            };
        }
    }
    calls
}

/// The address of a line `Trace 0: 0x7f… [00000000/000012ac/…] …`.
fn address(line: &str) -> Option<u32> {
    let (_, fields) = line.split_once('[')?;
    u32::from_str_radix(fields.split('/').nth(1)?, 16).ok()
}
