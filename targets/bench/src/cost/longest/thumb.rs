//! Control flow of ARMv6-M and ARMv7E-M.

use super::flow::{Flags, Flow};
use super::listing::{Line, Listing, address};
use crate::cost::elf::Image;

/// Instructions that can leave the straight path.
const LEAVING: [&str; 12] = [
    "b", "bl", "bx", "blx", "cbz", "cbnz", "tbb", "tbh", "udf", "pop", "ldmia", "ldr",
];

/// Instructions that keep all flags, if no `s` is behind them.
const KEEPING: [&str; 38] = [
    "add", "and", "asr", "b", "bfc", "bfi", "bic", "cbnz", "cbz", "clz", "eor", "ldmia", "ldr",
    "ldrb", "ldrd", "ldrh", "ldrsb", "ldrsh", "lsl", "lsr", "mov", "movt", "movw", "mul", "mvn",
    "nop", "orr", "pop", "push", "rsb", "stmia", "str", "strb", "strd", "strh", "sub", "sxth",
    "uxth",
];

/// Conditions, and which of the 16 combinations of flags satisfy them: bit `8 N + 4 Z + 2 C + V`.
const CONDITIONS: [(&str, Flags); 14] = [
    ("eq", 0xf0f0),
    ("ne", 0x0f0f),
    ("cs", 0xcccc),
    ("cc", 0x3333),
    ("mi", 0xff00),
    ("pl", 0x00ff),
    ("vs", 0xaaaa),
    ("vc", 0x5555),
    ("hi", 0x0c0c),
    ("ls", 0xf3f3),
    ("ge", 0xaa55),
    ("lt", 0x55aa),
    ("gt", 0x0a05),
    ("le", 0xf5fa),
];

/// Which of these instructions a mnemonic names, and the condition behind it.
fn split(mnemonic: &str, of: &[&'static str]) -> Option<(&'static str, Option<Flags>)> {
    of.iter().find_map(|&base| {
        let rest = mnemonic.strip_prefix(base)?;
        if rest.is_empty() {
            return Some((base, None));
        }
        let (_, flags) = CONDITIONS
            .iter()
            .find(|(condition, _)| *condition == rest)?;
        Some((base, Some(*flags)))
    })
}

/// Where control goes from an instruction.
///
/// # Errors
/// Why that is not known.
pub fn flow(image: &Image, listing: &Listing, at: u32, line: &Line) -> Result<Flow, String> {
    let mnemonic = line.mnemonic.as_str();
    let flow = match split(mnemonic, &LEAVING) {
        Some((base, None)) => leaving(image, listing, at, line, base)?,
        Some((base, Some(condition))) => Flow {
            condition: Some(condition),
            ..leaving(image, listing, at, line, base)?.or_on()
        },
        None if mnemonic == "mov" && line.operands().next() == Some("pc") => {
            addresses(image, listing, at, line)?
        }
        None => plain(line)?,
    };
    Ok(Flow {
        // The conditions of an IT block are those of the instructions in it.
        keeps_flags: mnemonic.starts_with("it") || split(mnemonic, &KEEPING).is_some(),
        ..flow
    })
}

/// Where control goes from an instruction that can leave the straight path, its condition
/// fulfilled.
fn leaving(
    image: &Image,
    listing: &Listing,
    at: u32,
    line: &Line,
    base: &str,
) -> Result<Flow, String> {
    let first = line.operands().next().unwrap_or_default();
    let target = || {
        let last = line.operands().last().and_then(address);
        last.ok_or_else(|| unknown(line))
    };
    Ok(match base {
        "b" => Flow::jump(target()?),
        // GCC jumps further than B reaches by BL, in functions that keep LR on the stack.
        "bl" if !image.is_function(target()?) => Flow::jump(target()?),
        "bl" => Flow::call(target()?),
        "bx" if first == "lr" => Flow::back(),
        "bx" | "blx" => return Err(unknown(line)),
        "cbz" | "cbnz" => Flow::jump(target()?).or_on(),
        "tbb" => table(image, listing, at, 1)?,
        "tbh" => table(image, listing, at, 2)?,
        "udf" => Flow::default(),
        "pop" | "ldmia" if line.operands.contains("pc}") => Flow::back(),
        "ldr" if first == "pc" && line.operands.contains("[sp], #") => Flow::back(),
        _ => return plain(line),
    })
}

/// An instruction that is no branch by its name.
fn plain(line: &Line) -> Result<Flow, String> {
    let writes = !["cmp", "cmn", "tst", "teq", "str"]
        .iter()
        .any(|reads| line.mnemonic.starts_with(reads));
    if writes && line.operands().next() == Some("pc") || line.operands.contains("pc}") {
        return Err(unknown(line));
    }
    Ok(Flow::on())
}

fn unknown(line: &Line) -> String {
    format!(
        "`{} {}` jumps to an address from memory or a register, which is not followed",
        line.mnemonic, line.operands
    )
}

/// Targets of a jump to a register, which ARMv6-M loads from a table of addresses behind the instruction.
fn addresses(image: &Image, listing: &Listing, at: u32, line: &Line) -> Result<Flow, String> {
    let begin = (at + 2).next_multiple_of(4);
    let end = listing
        .code_after(at)
        .ok_or("no instruction behind the table")?;
    let jumps = (begin..end).step_by(4).map(|entry| {
        let [low, high] = [entry, entry + 2].map(|at| image.half(at).map(u32::from));
        // The lowest bit tells Thumb.
        Some((low? | high? << 16) & !1)
    });
    let jumps: Option<Vec<u32>> = jumps.collect();
    let jumps = jumps.filter(|jumps| !jumps.is_empty());
    Ok(Flow {
        jumps: jumps.ok_or_else(|| unknown(line))?,
        ..Flow::default()
    })
}

/// Targets of TBB and TBH, whose table of half distances, in entries of `width` bytes, lies behind
/// the instruction.
fn table(image: &Image, listing: &Listing, at: u32, width: u32) -> Result<Flow, String> {
    let begin = at + 4;
    let behind = listing.code_after(at);
    let end = behind.ok_or("no instruction behind the table")?;
    let mut jumps = vec![];
    for entry in (begin..end).step_by(width as usize) {
        let word = image.half(entry).ok_or("the table cannot be read")?;
        let distance = if width == 1 { word & 0xff } else { word };
        // A table of an odd number of bytes is filled up by a zero.
        if distance != 0 {
            jumps.push(begin + 2 * u32::from(distance));
        }
    }
    Ok(Flow {
        jumps,
        ..Flow::default()
    })
}
