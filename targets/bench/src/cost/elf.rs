//! The ELF: addresses, sizes and calls of functions.

use crate::BenchError;
use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::ops::Range;
use std::path::Path;

/// Instruction set of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// Thumb, 16 and 32 bits.
    Thumb,
    /// RISC-V, 16 and 32 bits.
    RiscV,
}

/// Code of a firmware.
#[derive(Debug)]
pub struct Image {
    isa: Isa,
    /// Functions by start address, with their ends.
    functions: BTreeMap<u32, u32>,
    /// Their names, of which C's `static` functions can share one.
    names_by_start: BTreeMap<u32, String>,
    names: BTreeMap<String, u32>,
    sections: Vec<(u32, Vec<u8>)>,
}

/// Bytes of a function's code, literals included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// Of the function itself.
    pub own: u32,
    /// Of all functions that it can call, libraries included.
    pub called: u32,
}

impl Image {
    /// Reads an ELF.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn read(path: &Path, isa: Isa) -> Result<Self, BenchError> {
        let bytes = fs::read(path)?;
        let file = object::File::parse(bytes.as_slice())?;
        let mut image = Self {
            isa,
            functions: BTreeMap::new(),
            names_by_start: BTreeMap::new(),
            names: BTreeMap::new(),
            sections: vec![],
        };
        for symbol in file.symbols() {
            if symbol.kind() == SymbolKind::Text && symbol.size() > 0 {
                // The lowest bit of a Thumb address marks Thumb code.
                let begin = symbol.address() as u32 & !1;
                image.functions.insert(begin, begin + symbol.size() as u32);
                image
                    .names_by_start
                    .insert(begin, symbol.name()?.to_owned());
                image.names.insert(symbol.name()?.to_owned(), begin);
            }
        }
        for section in file.sections() {
            if section.kind() == object::SectionKind::Text {
                let begin = section.address() as u32;
                image.sections.push((begin, section.data()?.to_vec()));
            }
        }
        Ok(image)
    }

    /// An image of these functions, and of code at an address, for tests.
    #[cfg(test)]
    pub fn of_functions(isa: Isa, functions: &[(&str, Range<u32>)], code: (u32, Vec<u8>)) -> Self {
        let named = || functions.iter().map(|(name, at)| ((*name).to_owned(), at));
        Self {
            isa,
            functions: named().map(|(_, at)| (at.start, at.end)).collect(),
            names_by_start: named().map(|(name, at)| (at.start, name)).collect(),
            names: named().map(|(name, at)| (name, at.start)).collect(),
            sections: vec![code],
        }
    }

    /// Address of a function.
    ///
    /// # Errors
    /// If there is none of this name.
    pub fn function(&self, name: &str) -> Result<Range<u32>, BenchError> {
        let missing = || BenchError::Failed(format!("the ELF has no function `{name}`"));
        let begin = *self.names.get(name).ok_or_else(missing)?;
        Ok(begin..self.functions[&begin])
    }

    /// The instruction set.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Whether a function begins at an address.
    pub fn is_function(&self, at: u32) -> bool {
        self.functions.contains_key(&at)
    }

    /// Name of the function that an address is in.
    pub fn name_around(&self, at: u32) -> &str {
        let name = self.names_by_start.range(..=at).next_back();
        name.map_or("no function", |(_, name)| name.as_str())
    }

    /// Code size of a function and of its callees.
    ///
    /// # Errors
    /// If there is no such function.
    pub fn code(&self, name: &str) -> Result<Code, BenchError> {
        let own = self.function(name)?;
        let mut reached = BTreeSet::from([own.start]);
        let mut left = vec![own.start];
        while let Some(begin) = left.pop() {
            for target in self.targets(begin) {
                if self.functions.contains_key(&target) && reached.insert(target) {
                    left.push(target);
                }
            }
        }
        let all: u32 = reached
            .iter()
            .map(|begin| self.functions[begin] - begin)
            .sum();
        let own = own.end - own.start;
        Ok(Code {
            own,
            called: all - own,
        })
    }

    /// Branch targets of a function.
    fn targets(&self, begin: u32) -> Vec<u32> {
        let end = self.functions[&begin];
        let mut targets = vec![];
        let mut at = begin;
        while at < end {
            let Some(instruction) = self.instruction(at) else {
                break;
            };
            let next = at + instruction.length();
            let target = match self.isa {
                Isa::Thumb => instruction.thumb_target(at),
                Isa::RiscV => instruction
                    .riscv_target(at)
                    .or_else(|| instruction.riscv_far_target(at, self.instruction(next)?)),
            };
            targets.extend(target);
            at = next;
        }
        targets
    }

    /// The instruction at an address.
    pub fn instruction(&self, at: u32) -> Option<Instruction> {
        Some(Instruction {
            isa: self.isa,
            first: self.half(at)?,
            second: self.half(at + 2).unwrap_or(0),
        })
    }

    /// The 16 bits of code at an address.
    pub fn half(&self, at: u32) -> Option<u16> {
        let (begin, bytes) = self
            .sections
            .iter()
            .find(|(begin, bytes)| (*begin..*begin + bytes.len() as u32).contains(&at))?;
        let place = (at - begin) as usize;
        let bytes = bytes.get(place..place + 2)?;
        Some(u16::from_le_bytes([bytes[0], bytes[1]]))
    }
}

/// An instruction, or the first of two short ones.
#[derive(Clone, Copy, Debug)]
pub struct Instruction {
    isa: Isa,
    first: u16,
    second: u16,
}

/// Kinds of instructions by execution time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Loads or stores this many words.
    Memory(u32),
    /// Divides.
    Divide,
    /// Everything else.
    Plain,
}

impl Instruction {
    /// Bytes.
    pub fn length(self) -> u32 {
        let is_short = match self.isa {
            Isa::Thumb => self.first < 0xe800,
            Isa::RiscV => self.first & 3 != 3,
        };
        if is_short { 2 } else { 4 }
    }

    fn word(self) -> u32 {
        u32::from(self.first) | u32::from(self.second) << 16
    }

    /// Target of BL and of the unconditional B.W.
    fn thumb_target(self, at: u32) -> Option<u32> {
        let (first, second) = (u32::from(self.first), u32::from(self.second));
        if first & 0xf800 != 0xf000 || second & 0x9000 != 0x9000 {
            return None;
        }
        let sign = first >> 10 & 1;
        let j = [13, 11].map(|bit| !(second >> bit & 1 ^ sign) & 1);
        let offset =
            sign << 24 | j[0] << 23 | j[1] << 22 | (first & 0x3ff) << 12 | (second & 0x7ff) << 1;
        // 25 bits, signed.
        let offset = (offset << 7) as i32 >> 7;
        Some(at.wrapping_add(4).wrapping_add_signed(offset))
    }

    /// Target of JAL, C.JAL and C.J.
    fn riscv_target(self, at: u32) -> Option<u32> {
        let word = self.word();
        if self.length() == 4 {
            if word & 0x7f != 0x6f {
                return None;
            }
            let offset = (word as i32 >> 31) as u32 & 0xfff0_0000
                | word & 0x000f_f000
                | word >> 9 & 0x800
                | word >> 20 & 0x7fe;
            return Some(at.wrapping_add(offset));
        }
        let half = u32::from(self.first);
        if half & 3 != 1 || !matches!(half >> 13, 1 | 5) {
            return None;
        }
        let bit = |from: u32, to: u32| (half >> from & 1) << to;
        let offset = bit(12, 11)
            | bit(11, 4)
            | bit(10, 9)
            | bit(9, 8)
            | bit(8, 10)
            | bit(7, 6)
            | bit(6, 7)
            | bit(5, 3)
            | bit(4, 2)
            | bit(3, 1)
            | bit(2, 5);
        let offset = (offset << 20) as i32 >> 20;
        Some(at.wrapping_add_signed(offset))
    }

    /// Target of AUIPC and JALR in turn.
    fn riscv_far_target(self, at: u32, next: Self) -> Option<u32> {
        let (upper, lower) = (self.word(), next.word());
        let is_pair = self.length() == 4 && upper & 0x7f == 0x17 && lower & 0x7f == 0x67;
        let offset = (lower as i32 >> 20) as u32;
        is_pair.then(|| at.wrapping_add(upper & 0xffff_f000).wrapping_add(offset))
    }

    /// Whether it keeps interrupts from a Cortex-M: `cpsid i`.
    pub fn masks_interrupts(self) -> bool {
        self.isa == Isa::Thumb && self.first == 0xb672
    }

    /// Its kind.
    pub fn class(self) -> Class {
        match (self.isa, self.length()) {
            (Isa::Thumb, 2) => self.short_thumb_class(),
            (Isa::Thumb, _) => self.long_thumb_class(),
            (Isa::RiscV, 2) => match (self.first & 3, self.first >> 13) {
                (0 | 2, 2 | 6) => Class::Memory(1),
                _ => Class::Plain,
            },
            (Isa::RiscV, _) => match self.word() & 0x7f {
                0x03 | 0x23 => Class::Memory(1),
                0x33 if self.word() >> 25 == 1 && self.word() >> 14 & 1 == 1 => Class::Divide,
                _ => Class::Plain,
            },
        }
    }

    fn short_thumb_class(self) -> Class {
        let first = self.first;
        match first >> 11 {
            // LDR literal; loads and stores with register, immediate and stack offsets.
            0b01001..=0b10011 => Class::Memory(1),
            // PUSH and POP.
            0b10110 | 0b10111 if first & 0x0600 == 0x0400 => {
                Class::Memory((first & 0x1ff).count_ones())
            }
            0b11000 | 0b11001 => Class::Memory((first & 0xff).count_ones()),
            _ => Class::Plain,
        }
    }

    fn long_thumb_class(self) -> Class {
        let (first, second) = (self.first, self.second);
        match () {
            () if first & 0xfe40 == 0xe800 => Class::Memory(second.count_ones()),
            () if first & 0xfe40 == 0xe840 => Class::Memory(2),
            () if first & 0xfe00 == 0xf800 => Class::Memory(1),
            () if first & 0xffd0 == 0xfb90 && second & 0xf0 == 0xf0 => Class::Divide,
            // VFP: VLDR and VSTR; VLDM and VSTM, with the number of words; VDIV.
            () if first & 0xff20 == 0xed00 && second & 0x0e00 == 0x0a00 => Class::Memory(1),
            () if first & 0xfe00 == 0xec00 && second & 0x0e00 == 0x0a00 => {
                Class::Memory(u32::from(second & 0xff))
            }
            () if first & 0xffb0 == 0xee80 && second & 0x0e50 == 0x0a00 => Class::Divide,
            () => Class::Plain,
        }
    }
}
