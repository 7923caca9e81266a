//! The longest path of a step: instructions on the longest way through the control-flow graph of
//! the linked function, its callees included.
//!
//! It is at least as long as any step on any input. It can be longer, because a path whose
//! conditions contradict each other counts too, except where they are the same condition flags.
//! The longest path of a step that passes the supervisor's check is searched, too.
//! Jumps to addresses from memory, except Thumb's table branches, calls through pointers, recursion
//! and unbounded loops are refused with the function's name.

mod code;
mod flow;
mod listing;
mod loops;
mod measure;
mod path;
mod riscv;
#[cfg(test)]
mod tests;
mod thumb;

use super::elf::Image;
use crate::BenchError;
use crate::targets::Target;
use code::Code;
use hexagen_lab::counted::Longest;
use listing::Listing;
pub use measure::chip;
use measure::{Chip, Measure};
use path::Search;
use std::ops::Range;
use std::path::Path;

/// What a step calls when it is not fit for control: in start-up, calibration and pre-charge, in trips,
/// coasting and braking, and where it bridges a disturbed Hall code.
const UNFIT: &str = "examine";

/// Code of a program, ready for the search, and a chip to run it.
#[derive(Debug)]
pub struct Program<'a> {
    code: Code<'a>,
    chip: Chip,
}

impl<'a> Program<'a> {
    /// Disassembles an ELF, given its image.
    ///
    /// # Errors
    /// If the disassembler fails.
    pub fn read(elf: &Path, target: Target, image: &'a Image) -> Result<Self, BenchError> {
        Ok(Self {
            code: Code::new(image, Listing::of(elf, target)?),
            chip: chip(target),
        })
    }

    /// The longest paths of a step function.
    ///
    /// # Errors
    /// What the search refuses.
    pub fn longest(&self, symbol: &str) -> Result<Longest, BenchError> {
        let cycles = Measure::Cycles(self.chip);
        let core_cycles = Measure::Cycles(self.chip.without_waits());
        Ok(Longest {
            instructions: self.longest_without(symbol, None, Measure::Instructions)?,
            instructions_in_control: self.longest_without(
                symbol,
                Some(UNFIT),
                Measure::Instructions,
            )?,
            cycles: self.longest_without(symbol, None, cycles)?,
            cycles_in_control: self.longest_without(symbol, Some(UNFIT), cycles)?,
            core_cycles: self.longest_without(symbol, None, core_cycles)?,
            core_cycles_in_control: self.longest_without(symbol, Some(UNFIT), core_cycles)?,
        })
    }

    /// Checks that the executed instructions of a function's calls follow the control-flow graph. A
    /// call ends when `caller` continues.
    ///
    /// # Errors
    /// If control went where the graph has no way.
    pub fn check_executed(
        &self,
        executed: impl Iterator<Item = u32>,
        function: &Range<u32>,
        caller: &Range<u32>,
    ) -> Result<(), BenchError> {
        let mut from = None;
        for at in executed {
            if let Some(from) = from
                && !self.code.leads(from, at)
            {
                return Err(BenchError::Failed(format!(
                    "longest path: control went from {from:#x} to {at:#x}, where the graph has no \
                     way: correct the flow of this instruction in targets/bench/src/cost/longest"
                )));
            }
            let is_in_call = from.is_some() || at == function.start;
            from = Some(at).filter(|_| is_in_call && !caller.contains(&at));
        }
        Ok(())
    }

    /// The longest path through no function with this in its name, from the call to the return.
    fn longest_without(
        &self,
        symbol: &str,
        without: Option<&'static str>,
        measure: Measure,
    ) -> Result<u32, BenchError> {
        let entry = self.code.image.function(symbol)?.start;
        let longest = Search::new(&self.code, without, measure).longest((entry, None))?;
        longest.ok_or_else(|| BenchError::Failed(format!("`{symbol}` never returns")))
    }
}

/// Checks that the largest step that was counted is no longer than the longest path, and that what steps call
/// when they do not control was found.
///
/// # Errors
/// If one is: the search missed its path. If nothing was found: it has another name.
pub fn check(symbol: &str, longest: &Longest, counted: u32) -> Result<(), BenchError> {
    let instructions = longest.instructions;
    if instructions < counted {
        return Err(BenchError::Failed(format!(
            "{symbol}: a step of {counted} instructions was counted, and the longest path has \
             {instructions}: the search in targets/bench/src/cost/longest misses a path"
        )));
    }
    if instructions == longest.instructions_in_control {
        return Err(BenchError::Failed(format!(
            "{symbol}: its longest path calls no function with `{UNFIT}` in its name: correct this in \
             targets/bench/src/cost/longest/mod.rs"
        )));
    }
    Ok(())
}
