//! Estimated cycles of a step: the instructions that the emulator executes, weighted by kind.
//!
//! A load or store takes two cycles, of n words 1 + n, a taken branch three, a division as in the
//! table, all others one: as in the Cortex-M4 and Cortex-M0 manuals for memory without wait states.
//! RISC-V cores differ; the same weights suit a short in-order pipeline.

use super::elf::{Class, Image};
use crate::targets::Target;
use std::iter;
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
    let mut addresses = executed_addresses(log).peekable();
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

/// The addresses of the instructions that were executed.
///
/// The emulator logs an instruction before it executes it. If another of its threads interrupts the
/// core in between, a line `Stopped execution of TB chain before …` follows, and the instruction is
/// logged once more when the core goes on.
pub fn executed_addresses(log: &str) -> impl Iterator<Item = u32> {
    let mut lines = log.lines().peekable();
    iter::from_fn(move || {
        loop {
            let line = lines.next()?;
            let is_stopped = lines
                .next_if(|next| next.starts_with("Stopped execution"))
                .is_some();
            if let Some(at) = address(line).filter(|_| !is_stopped) {
                return Some(at);
            }
        }
    })
}

/// The address of a line `Trace 0: 0x7f… [00000000/000012ac/…] …`.
fn address(line: &str) -> Option<u32> {
    let (_, fields) = line.split_once('[')?;
    u32::from_str_radix(fields.split('/').nth(1)?, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of the emulator, interrupted before the second instruction.
    const LOG: &str = "\
Trace 0: 0x7fd564020180 [00800400/00004ff2/00000110/ff000201] __addsf3
Trace 0: 0x7fd564020300 [00800400/00004ff4/00000110/ff000201] __addsf3
Stopped execution of TB chain before 0x7fd564020300 [00004ff4] __addsf3
Trace 0: 0x7fd564020300 [00800400/00004ff4/00000110/ff000201] __addsf3
Trace 0: 0x7fd564020440 [00800400/00004ff6/00000110/ff000201] __addsf3
";

    #[test]
    fn an_interrupted_instruction_counts_once() {
        let addresses: Vec<u32> = executed_addresses(LOG).collect();
        assert_eq!(addresses, [0x4ff2, 0x4ff4, 0x4ff6]);
    }
}
