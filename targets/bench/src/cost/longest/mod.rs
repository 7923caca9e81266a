//! The longest path of a step: instructions on the longest way through the control-flow graph of
//! the linked function, its callees included.
//!
//! It is at least as long as any step on any input. It can be longer, because a path whose
//! conditions contradict each other counts too, except where they are the same condition flags.
//! Jumps to addresses from memory, except Thumb's table branches, calls through pointers, recursion
//! and unbounded loops are refused with the function's name.

mod flow;
mod listing;
mod loops;
mod path;
mod riscv;
#[cfg(test)]
mod tests;
mod thumb;

use super::elf::Image;
use crate::BenchError;
use crate::targets::Target;
use flow::Code;
use listing::Listing;
use path::Search;
use std::path::Path;

/// Code of a program, ready for the search.
#[derive(Debug)]
pub struct Program<'a>(Code<'a>);

impl<'a> Program<'a> {
    /// Disassembles an ELF, given its image.
    ///
    /// # Errors
    /// If the disassembler fails.
    pub fn read(elf: &Path, target: Target, image: &'a Image) -> Result<Self, BenchError> {
        Ok(Self(Code::new(image, Listing::of(elf, target)?)))
    }

    /// Instructions of a function's longest path, from its entry to its return, both included.
    ///
    /// # Errors
    /// What the search refuses.
    pub fn longest(&self, symbol: &str) -> Result<u32, BenchError> {
        let entry = self.0.image.function(symbol)?.start;
        let longest = Search::new(&self.0).longest((entry, None))?;
        longest.ok_or_else(|| BenchError::Failed(format!("`{symbol}` never returns")))
    }
}
