//! Control flow of RV32IMC.

use super::flow::Flow;
use super::listing::{Line, Listing, address};

/// Conditional branches, as the disassembler spells them.
const BRANCHES: [&str; 16] = [
    "beq", "bne", "blt", "bge", "bltu", "bgeu", "beqz", "bnez", "blez", "bgez", "bltz", "bgtz",
    "bgt", "ble", "bgtu", "bleu",
];

/// Where control goes from an instruction.
///
/// # Errors
/// Why that is not known.
pub fn flow(listing: &Listing, at: u32, line: &Line) -> Result<Flow, String> {
    let target = || {
        let last = line.operands().last().and_then(address);
        last.ok_or_else(|| format!("no target in `{} {}`", line.mnemonic, line.operands))
    };
    Ok(match line.mnemonic.as_str() {
        "ret" => Flow::back(),
        "j" => Flow::jump(target()?),
        "jal" if line.operands().count() == 1 => Flow::call(target()?),
        "jalr" => Flow::call(far_target(listing, at, line)?),
        "jr" => Flow::jump(far_target(listing, at, line)?),
        // The upper bits of an address for the instruction behind, which names the target.
        "unimp" | "c.unimp" => Flow::default(),
        mnemonic if BRANCHES.contains(&mnemonic) => Flow::jump(target()?).or_on(),
        "jal" | "mret" => return Err(format!("`{}` is not followed", line.mnemonic)),
        _ => Flow::on(),
    })
}

/// The target of `jalr 10(ra) # 800012ac <symbol>`, or `jalr ra # ...` where the offset is 0, behind `auipc ra`.
fn far_target(listing: &Listing, at: u32, line: &Line) -> Result<u32, String> {
    let unknown = || {
        format!(
            "`{} {}` jumps to an address from memory or through a table, which is not followed",
            line.mnemonic, line.operands
        )
    };
    let (operand, comment) = line.operands.split_once(" # ").ok_or_else(unknown)?;
    let register = operand
        .split_once('(')
        .map_or(operand, |(_, of)| of.trim_end_matches(')'));
    let (_, upper) = listing.before(at).ok_or_else(unknown)?;
    if upper.mnemonic == "auipc" && upper.operands().next() == Some(register) {
        return address(comment).ok_or_else(unknown);
    }
    Err(unknown())
}
