//! The paper's experiment as one page: its tables, figures and claims, in its order.
//!
//! [`Reproduction`] says what was run; [`claims`] judges the paper's claims by it; [`write()`] makes
//! the page, under the same rules as the report's: no script, nothing from outside the file, the
//! same bytes for the same data.

mod claims;
mod data;
mod experiment;
mod ideal;
mod judge;
mod measured;
mod outline;
mod page;
mod tables;
mod timing;
mod verdicts;

pub use claims::claims;
pub use data::{BothReadings, Method, Point, Reading, Reproduction, Run, SwitchingTables};
pub use experiment::{AtSpeed, Experiment, Figures, Setting};
pub use judge::{Claim, Finding, Statement, Verdict};
pub use outline::distance_rms;
pub use timing::{CLOCK_HZ, TIMES_TEXT, Times};

use super::ReportError;
use std::path::{Path, PathBuf};

/// Name of the page's file.
pub const FILE: &str = "reproduction.html";

/// Writes the page into a folder, which is created where it is missing, and returns its path. A
/// page of that name is replaced at once or not at all.
///
/// # Errors
/// A file that cannot be written, or a plot that cannot be drawn.
pub fn write(data: &Reproduction, dir: &Path) -> Result<PathBuf, ReportError> {
    super::write_page(&page::render(data)?, dir, FILE)
}

/// The page as text.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn render(data: &Reproduction) -> Result<String, ReportError> {
    page::render(data)
}
