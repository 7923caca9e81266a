//! The instructions of an ELF as the toolchain's disassembler prints them.

use crate::BenchError;
use crate::targets::Target;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Heads of mnemonics of instructions that write several registers.
const SEVERAL_RESULTS: [&str; 8] = [
    "ldm", "pop", "ldrd", "strex", "umull", "smull", "umlal", "smlal",
];

/// Instructions that write no register.
const NO_RESULT: [&str; 10] = [
    "str", "strb", "strh", "strd", "cmp", "cmn", "tst", "sw", "sh", "sb",
];

/// Instructions and data by address.
#[derive(Debug, Default)]
pub struct Listing {
    lines: BTreeMap<u32, Line>,
}

/// An instruction, or data, whose mnemonic begins with a full stop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Mnemonic, without the mark of its width (`.n`, `.w`).
    pub mnemonic: String,
    /// Operands, with the disassembler's comment.
    pub operands: String,
}

impl Listing {
    /// Disassembles an ELF.
    ///
    /// # Errors
    /// If the disassembler, which is installed with the target's C compiler, fails.
    pub fn of(elf: &Path, target: Target) -> Result<Self, BenchError> {
        let program = target.disassembler();
        let output = Command::new(program)
            .args(["--disassemble", "--no-show-raw-insn"])
            .arg(elf)
            .output()
            .map_err(|error| {
                BenchError::Failed(format!("`{program}` does not run, install it: {error}"))
            })?;
        if output.status.success() {
            return Ok(Self::parse(&String::from_utf8_lossy(&output.stdout)));
        }
        let reason = String::from_utf8_lossy(&output.stderr).into_owned();
        Err(BenchError::Failed(format!("`{program}` failed: {reason}")))
    }

    /// Reads the disassembler's lines: an address and a colon, a mnemonic, its operands, with tabs
    /// between them.
    pub fn parse(text: &str) -> Self {
        let line = |line: &str| {
            let (address, rest) = line.split_once(":\t")?;
            let address = u32::from_str_radix(address.trim(), 16).ok()?;
            let (mnemonic, operands) = rest.split_once('\t').unwrap_or((rest, ""));
            let mnemonic = mnemonic.trim();
            let width = mnemonic.strip_suffix(".n").or(mnemonic.strip_suffix(".w"));
            let line = Line {
                mnemonic: width.unwrap_or(mnemonic).to_owned(),
                operands: operands.trim().to_owned(),
            };
            Some((address, line))
        };
        Self {
            lines: text.lines().filter_map(line).collect(),
        }
    }

    /// The line at an address.
    pub fn at(&self, at: u32) -> Option<&Line> {
        self.lines.get(&at)
    }

    /// The address of the line behind.
    pub fn after(&self, at: u32) -> Option<u32> {
        let (&next, _) = self.lines.range(at.checked_add(1)?..).next()?;
        Some(next)
    }

    /// The line before, and its address.
    pub fn before(&self, at: u32) -> Option<(u32, &Line)> {
        let (&before, line) = self.lines.range(..at).next_back()?;
        Some((before, line))
    }

    /// The addresses of all lines.
    pub fn addresses(&self) -> impl Iterator<Item = u32> {
        self.lines.keys().copied()
    }

    /// The first instruction behind an address, past data.
    pub fn code_after(&self, at: u32) -> Option<u32> {
        let mut behind = self.lines.range(at.checked_add(1)?..);
        let (&next, _) = behind.find(|(_, line)| !line.is_data())?;
        Some(next)
    }
}

impl Line {
    /// Whether it is data.
    pub fn is_data(&self) -> bool {
        self.mnemonic.starts_with('.')
    }

    /// Whether it can write a register: its first operand, or any where there may be several
    /// results.
    pub fn may_write(&self, register: &str) -> bool {
        let mnemonic = self.mnemonic.as_str();
        let has_several = SEVERAL_RESULTS
            .iter()
            .any(|head| mnemonic.starts_with(head));
        let writes_back = self.operands.contains('!') || self.operands.contains("], ");
        let results = if has_several || writes_back {
            usize::MAX
        } else {
            usize::from(!NO_RESULT.contains(&mnemonic))
        };
        let is_named = |part: &str| part.trim_matches(['{', '}', '[', ']', '!']) == register;
        self.operands().take(results).any(is_named)
    }

    /// Its operands without the comment, from the first.
    pub fn operands(&self) -> impl Iterator<Item = &str> {
        let ends = ['@', ';', '#'];
        let comment = self
            .operands
            .match_indices(ends)
            .find(|&(at, mark)| mark != "#" || self.operands[at..].starts_with("# "));
        let end = comment.map_or(self.operands.len(), |(at, _)| at);
        self.operands[..end].split(',').map(str::trim)
    }
}

/// The address at the head of `12ac <symbol+0x10>`.
pub fn address(text: &str) -> Option<u32> {
    u32::from_str_radix(text.split_whitespace().next()?, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_both_disassemblers_are_read() {
        let listing = Listing::parse(
            "000000c0 <f>:\n\
             \x20     c0:\tbeq.n\td2 <f+0x12>\n\
             \x20     c2:\tldr\tr0, [pc, #32]\t@ (e8 <f+0x28>)\n\
             \x20     c4:\t.word\t0x20000000\n\
             80000004:\tjr\t8(ra) # 80000008 <g>\n\
             80000008:\tret\n",
        );
        let operands = |at| listing.at(at).map(|line| line.operands().collect());
        assert_eq!(operands(0xc0), Some(vec!["d2 <f+0x12>"]));
        assert_eq!(operands(0xc2), Some(vec!["r0", "[pc", "#32]"]));
        assert_eq!(operands(0x8000_0004), Some(vec!["8(ra)"]));
        assert_eq!(listing.at(0xc0).expect("a branch").mnemonic, "beq");
        assert_eq!(listing.after(0xc2), Some(0xc4));
        assert_eq!(listing.code_after(0xc2), Some(0x8000_0004));
        assert_eq!(address("d2 <f+0x12>"), Some(0xd2));
    }
}
