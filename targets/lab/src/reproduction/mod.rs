//! The paper's experiment, and the verdicts on its claims.
//!
//! [`reproduce`] runs it; [`Reproduction`] has the results, [`claims`] judges the paper's claims by
//! them.

mod claims;
mod data;
mod experiment;
mod judge;
mod outline;
mod run;
mod timing;

pub use claims::claims;
pub use data::{
    BothReadings, Improved, Method, Point, Reading, Reproduction, Run, SwitchingTables,
};
pub use experiment::{AtSpeed, Experiment, Figures, Setting};
pub use judge::{Claim, Finding, Statement, Verdict};
pub use outline::distance_rms;
pub use run::{Effort, counted_drives, reproduce};
pub use timing::{CLOCK_HZ, TIMES_TEXT, Times};
