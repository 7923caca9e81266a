//! Code of a program: where control goes from each instruction, and the constants in registers.

use super::flow::Flow;
use super::listing::{Line, Listing};
use super::{riscv, thumb};
use crate::cost::elf::{Image, Isa};
use std::collections::{BTreeMap, BTreeSet};

/// Instructions before a call among which its constant arguments are looked for.
const CONSTANT_WITHIN: u32 = 40;

/// Code of a program: its image and its disassembly.
#[derive(Debug)]
pub struct Code<'a> {
    pub image: &'a Image,
    pub listing: Listing,
    /// Where jumps come from.
    sources: BTreeMap<u32, Vec<u32>>,
}

impl<'a> Code<'a> {
    pub fn new(image: &'a Image, listing: Listing) -> Self {
        let mut code = Self {
            image,
            listing,
            sources: BTreeMap::new(),
        };
        let mut sources = BTreeMap::<u32, Vec<u32>>::new();
        for at in code.listing.addresses() {
            let jumps = code.flow(at).map(|flow| flow.jumps);
            for to in jumps.unwrap_or_default() {
                sources.entry(to).or_default().push(at);
            }
        }
        code.sources = sources;
        code
    }

    /// Where control goes from an instruction.
    ///
    /// # Errors
    /// Why that is not known.
    pub fn flow(&self, at: u32) -> Result<Flow, String> {
        let line = match self.listing.at(at) {
            Some(line) if !line.is_data() => line,
            _ => return Err("the disassembler shows no instruction here".to_owned()),
        };
        match self.image.isa() {
            Isa::Thumb => thumb::flow(self.image, &self.listing, at, line),
            Isa::RiscV => riscv::flow(&self.listing, at, line),
        }
    }

    /// Whether control can go from an instruction to another, a return to anywhere.
    pub fn leads(&self, from: u32, to: u32) -> bool {
        self.flow(from).is_ok_and(|flow| {
            let is_skipped = flow.calls.is_none() || flow.condition.is_some();
            let goes_on = flow.goes_on && is_skipped;
            goes_on && self.listing.after(from) == Some(to)
                || flow.jumps.contains(&to)
                || flow.calls == Some(to)
                || flow.returns
        })
    }

    /// Whether an instruction can load from the memory with code and constants: any load but from
    /// the stack.
    pub fn loads_constants(&self, at: u32) -> bool {
        self.listing.at(at).is_some_and(|line| {
            let is_load = line.mnemonic.starts_with('l');
            let is_of_stack = line.operands.contains("[sp") || line.operands.starts_with("sp!");
            is_load && !is_of_stack
        })
    }

    /// The largest value of an argument's register at a call, if it is made of constants on every
    /// way to it.
    pub fn constant_argument(&self, call: u32, argument: usize) -> Option<u32> {
        let register = match self.image.isa() {
            Isa::Thumb => format!("r{argument}"),
            Isa::RiscV => format!("a{argument}"),
        };
        self.constants(call, &register, CONSTANT_WITHIN)?
            .last()
            .copied()
    }

    /// The values of a register in front of an instruction, if all are set at most `within`
    /// instructions before.
    fn constants(&self, at: u32, register: &str, within: u32) -> Option<BTreeSet<u32>> {
        let within = within.checked_sub(1)?;
        let before = self.before(at);
        if before.is_empty() || self.image.is_function(at) {
            return None;
        }
        let mut all = BTreeSet::new();
        for (before, line) in before {
            let operands: Vec<&str> = line.operands().collect();
            let values = |operand: &str| match operand.trim_start_matches('#').parse::<u32>() {
                Ok(number) => Some(BTreeSet::from([number])),
                Err(_) => self.constants(before, operand, within),
            };
            let both = |of, and, combine: fn(u32, u32) -> u32| {
                let (left, right) = (values(of)?, values(and)?);
                let pairs = left
                    .iter()
                    .flat_map(|l| right.iter().map(|r| combine(*l, *r)));
                Some(pairs.collect())
            };
            let found: BTreeSet<u32> = match (line.mnemonic.as_str(), operands.as_slice()) {
                ("li" | "mv" | "mov" | "movs", &[to, of]) if to == register => values(of)?,
                ("adds", &[to, and]) if to == register => both(to, and, u32::wrapping_add)?,
                ("adds", &[to, of, and]) if to == register => both(of, and, u32::wrapping_add)?,
                ("subs", &[to, and]) if to == register => both(to, and, u32::wrapping_sub)?,
                ("subs", &[to, of, and]) if to == register => both(of, and, u32::wrapping_sub)?,
                _ if line.may_write(register) || self.flow(before).ok()?.calls.is_some() => {
                    return None;
                }
                _ => values(register)?,
            };
            all.extend(found);
        }
        Some(all)
    }

    /// The instructions from which control comes.
    fn before(&self, at: u32) -> Vec<(u32, &Line)> {
        let jumps = self.sources.get(&at).into_iter().flatten();
        let jumps = jumps.filter_map(|&from| Some((from, self.listing.at(from)?)));
        let before = self.listing.before(at);
        let before = before.filter(|&(before, _)| self.flow(before).is_ok_and(|flow| flow.goes_on));
        jumps.chain(before).collect()
    }
}
