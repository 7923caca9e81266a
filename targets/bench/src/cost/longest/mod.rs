//! The longest path of a step: instructions on the longest way through the control-flow graph of
//! the linked function, its callees included.
//!
//! It is at least as long as any step on any input. It can be longer, because a path whose
//! conditions contradict each other counts too, except where they are the same condition flags.
//! The largest such path has a drive trip anew and then control all the same, or trip for several
//! reasons at once; so the longest path of a step in control is searched, too.
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

use super::count::Counts;
use super::elf::Image;
use crate::BenchError;
use crate::targets::Target;
use flow::Code;
use listing::Listing;
use path::Search;
use std::path::Path;

/// What a step calls when it does not control: in start-up, calibration and pre-charge, in trips,
/// coasting and braking, and where it bridges a disturbed Hall code.
const AT_REST: [&str; 3] = ["5drive4rest", "5drive4trip", "step_at_rest"];

/// Code of a program, ready for the search.
#[derive(Debug)]
pub struct Program<'a>(Code<'a>);

/// Instructions of a step, from its entry to its return, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Longest {
    /// Of the longest path of all.
    pub of_all: u32,
    /// Of the longest path of a step that controls.
    pub in_control: u32,
}

impl<'a> Program<'a> {
    /// Disassembles an ELF, given its image.
    ///
    /// # Errors
    /// If the disassembler fails.
    pub fn read(elf: &Path, target: Target, image: &'a Image) -> Result<Self, BenchError> {
        Ok(Self(Code::new(image, Listing::of(elf, target)?)))
    }

    /// The longest paths of a step function.
    ///
    /// # Errors
    /// What the search refuses.
    pub fn longest(&self, symbol: &str) -> Result<Longest, BenchError> {
        Ok(Longest {
            of_all: self.longest_without(symbol, &[])?,
            in_control: self.longest_without(symbol, &AT_REST)?,
        })
    }

    /// The longest path through no function with one of these parts in its name.
    fn longest_without(
        &self,
        symbol: &str,
        without: &'static [&'static str],
    ) -> Result<u32, BenchError> {
        let entry = self.0.image.function(symbol)?.start;
        let longest = Search::new(&self.0, without).longest((entry, None))?;
        longest.ok_or_else(|| BenchError::Failed(format!("`{symbol}` never returns")))
    }
}

impl Longest {
    /// Checks that no step that was counted is longer.
    ///
    /// # Errors
    /// If one is: the search missed its path.
    pub fn check(self, symbol: &str, counts: &Counts) -> Result<(), BenchError> {
        let (longest, counted) = (self.of_all, counts.largest());
        if longest < counted {
            return Err(BenchError::Failed(format!(
                "{symbol}: a step of {counted} instructions was counted, and the longest path has \
                 {longest}: the search in targets/bench/src/cost/longest misses a path"
            )));
        }
        Ok(())
    }
}
