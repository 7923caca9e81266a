//! The report: one self-contained HTML page about a motor and its controllers.

mod data;
mod expected;

pub use data::{
    Capture, GeneratedTexts, Model, Parameter, Record, ReportData, Run, RunPoint, SignalError,
    SpeedMark, Stability, StabilityCheck, Variant, Verification,
};
pub use expected::{
    Band, DesignRow, Expected, ExpectedPoint, Judged, design_table, judge_limit, judge_mean,
    judge_pp, judge_rms,
};
