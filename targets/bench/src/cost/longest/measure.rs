//! What is added up along a path: instructions, or cycles of a named chip at most.
//!
//! Cycles are those of the core's own table for memory without wait states, each instruction at
//! its most, and every wait state of the chip's memory: for each line of code that control enters,
//! for a line that the core had begun to fetch behind a jump, and for each word loaded that is not
//! on the stack, since tables and literals are in the same memory. Nothing is deducted for
//! prefetch, caches, or overlap of both. Where in a line a function begins is the linker's choice,
//! so that each place is tried.

use super::code::Code;
use super::flow::Flow;
use crate::cost::elf::{Class, Instruction};
use crate::targets::Target;

/// A chip, with its core's times in cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chip {
    /// Name.
    pub name: &'static str,
    /// Highest clocks at which the memory with code and constants takes 0, 1, 2 … wait states, MHz; the last is
    /// that of the chip.
    pub clocks_of_waits: &'static [u32],
    /// What the figures assume.
    pub assumed: &'static str,
    /// A division.
    division: u32,
    /// What a jump, a call or a return takes beyond one cycle.
    refill: u32,
    /// What a conditional branch that is not taken takes beyond one cycle.
    not_taken: u32,
    /// Bytes of a line of this memory.
    line: u32,
    /// Bytes by which code is moved from where the linker placed it.
    moved: u32,
}

/// What is added up along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Instructions.
    Instructions,
    /// Cycles of a chip, at most.
    Cycles(Chip),
}

/// The chip whose cycles are bounded on a target.
pub fn chip(target: Target) -> Chip {
    match target {
        // Core: Cortex-M4 Technical Reference Manual, 100166_0001_00, Table 3-1: loads and stores
        // of n words 1 + n, SDIV and UDIV 2 to 12, a pipeline refill P of 1 to 3 cycles. Flash:
        // RM0440, "Read access latency": the clocks of range 1 without boost, which allow less at
        // each number of wait states than those with boost, and 170 MHz with it; category 2
        // devices read 64 bits.
        Target::CortexM4 => Chip {
            name: "STM32G431",
            clocks_of_waits: &[30, 60, 90, 120, 170],
            assumed: "code in flash, voltage range 1",
            division: 12,
            refill: 3,
            not_taken: 0,
            line: 8,
            moved: 0,
        },
        // Core: Cortex-M0 Technical Reference Manual, DDI 0432C, Table 3-1, with the multiplier of
        // one cycle: loads and stores of n words 1 + n, B 3 when taken, BX 3, BL 4, POP with PC
        // 4 + n. No division. Flash: RM0360, FLASH_ACR, one wait state above 24 MHz; "Flash memory
        // organization", cells of 32 bits.
        Target::CortexM0 => Chip {
            name: "STM32F030",
            clocks_of_waits: &[24, 48],
            assumed: "multiplier of one cycle, code in flash",
            division: 0,
            refill: 3,
            not_taken: 0,
            line: 4,
            moved: 0,
        },
        // Core: Hazard3's manual, "Instruction Cycle Counts": a load 2 if the next instruction
        // needs it, MUL and MULH 1, DIV 18 or 19, a jump or mispredicted branch 2, one more to a
        // 32-bit instruction across a word. SRAM has no wait states; the code's bank and those of
        // data and stack are used by nothing else.
        Target::Riscv32 => Chip {
            name: "RP2350",
            clocks_of_waits: &[150],
            assumed: "core Hazard3, code in a bank of SRAM of its own",
            division: 19,
            refill: 2,
            not_taken: 2,
            line: 4,
            moved: 0,
        },
    }
}

impl Measure {
    /// This measure for each place in a line where a function can begin.
    pub fn of_all_places(self) -> Vec<Self> {
        match self {
            Self::Cycles(chip) if chip.waits() > 0 => (0..chip.line)
                .step_by(2)
                .map(|moved| Self::Cycles(Chip { moved, ..chip }))
                .collect(),
            Self::Cycles(_) | Self::Instructions => vec![self],
        }
    }

    /// An instruction itself, without what it calls and without the way to the next one.
    pub fn of_instruction(self, code: &Code, at: u32) -> u32 {
        let Self::Cycles(chip) = self else {
            return 1;
        };
        let class = code.image.instruction(at).map(Instruction::class);
        match class {
            Some(Class::Memory(words)) if code.loads_constants(at) => {
                1 + words * (1 + chip.waits())
            }
            Some(Class::Memory(words)) => 1 + words,
            Some(Class::Divide) => chip.division,
            Some(Class::Plain) | None => 1,
        }
    }

    /// The way to the instruction behind.
    pub fn of_going_on(self, code: &Code, at: u32, next: u32, flow: &Flow) -> u32 {
        let Self::Cycles(chip) = self else {
            return 0;
        };
        let entered = chip
            .last_line(code, next)
            .saturating_sub(chip.last_line(code, at));
        let is_branch = !flow.jumps.is_empty();
        chip.waits() * entered + if is_branch { chip.not_taken } else { 0 }
    }

    /// The way to another instruction by a jump or a call.
    pub fn of_jump(self, code: &Code, to: u32) -> u32 {
        let Self::Cycles(chip) = self else {
            return 0;
        };
        let first = (to + chip.moved) / chip.line;
        let entered = 1 + chip.last_line(code, to).saturating_sub(first);
        chip.refill + chip.waits() * (entered + 1)
    }

    /// The way back to a caller, whose next instruction can be in two lines.
    pub fn of_return(self) -> u32 {
        match self {
            Self::Instructions => 0,
            Self::Cycles(chip) => chip.refill + chip.waits() * 3,
        }
    }
}

impl Chip {
    /// Highest clock, MHz.
    pub fn clock(&self) -> u32 {
        self.clocks_of_waits.last().copied().unwrap_or_default()
    }

    /// Wait states that are counted for each line: those at the highest clock.
    fn waits(&self) -> u32 {
        self.clocks_of_waits.len() as u32 - 1
    }

    /// The chip up to the clock at which its memory takes no wait states.
    pub fn without_waits(self) -> Self {
        Self {
            clocks_of_waits: &self.clocks_of_waits[..1],
            ..self
        }
    }

    /// Number of the line with an instruction's last byte.
    fn last_line(&self, code: &Code, at: u32) -> u32 {
        let length = code.image.instruction(at).map_or(2, Instruction::length);
        (at + self.moved + length - 1) / self.line
    }
}
