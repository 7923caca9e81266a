//! The result table of a motor, and other results of its controllers.

mod collect;
mod data;
mod expected;
mod links;
mod planned;
mod unstated;

pub use collect::Plan;
pub use data::{
    Capture, ErrorsSeen, GeneratedTexts, Own, Record, Results, Run, RunPoint, SameWords,
    SignalError, SpeedMark, Variant, Verification,
};
pub use expected::{
    Band, DesignRow, Expectation, Expected, ExpectedPoint, Judged, design_table, judge_limit,
    judge_mean, judge_pp, judge_rms, own_row, rows_of,
};
pub use links::{FieldLinks, Item, Origin, items, links};
pub use planned::{Planned, held};

/// The motor of the paper.
pub const PAPER_MOTOR: &str = "trivedi-keshri-660w";

/// Speeds of the result table, relative to rated speed.
pub const SPEEDS: [f64; 2] = [0.2, 0.75];
