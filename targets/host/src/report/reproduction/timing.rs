//! Table 5's times, from operations: a stated clock and stated cycles per operation.
//!
//! The operations are those of the generator's integer graph. A compiler makes instructions of
//! them that depend on the target; what a target really takes is counted with its firmware.

use hexagen_codegen::ir::Cost;

/// Clock of the processor in hertz: that of the motor file's timer.
pub const CLOCK_HZ: f64 = 72e6;

/// Cycles per operation on a 32-bit core with a single-cycle multiplier: a product is rounded and
/// shifted down from 64 bits; a comparison decides a selection; a look-up reads flash.
const ADDITION: u32 = 1;
const MULTIPLICATION: u32 = 4;
const COMPARISON: u32 = 2;
const LOOKUP: u32 = 3;
const DIVISION: u32 = 12;

/// Cycles of so many operations.
pub fn cycles(cost: &Cost) -> u32 {
    ADDITION * cost.additions
        + MULTIPLICATION * cost.multiplications
        + COMPARISON * cost.comparisons
        + LOOKUP * cost.lookups
        + DIVISION * cost.divisions
}

/// The stated cycles, in words.
pub fn cycles_text() -> String {
    format!(
        "{ADDITION} cycle per addition or shift, {MULTIPLICATION} per multiplication with its rounding, \
         {COMPARISON} per comparison or selection, {LOOKUP} per look-up, {DIVISION} per division"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_operation_counts() {
        let cost = Cost {
            additions: 10,
            multiplications: 5,
            comparisons: 7,
            lookups: 2,
            divisions: 1,
        };
        assert_eq!(cycles(&cost), 10 + 20 + 14 + 6 + 12);
    }
}
