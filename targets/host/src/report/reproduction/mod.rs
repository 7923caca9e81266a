//! The paper's experiment as one page: its tables, figures and claims, in its order.
//!
//! [`Reproduction`] says what was run; [`write()`] makes
//! the page, under the same rules as the report's: no script, nothing from outside the file, the
//! same bytes for the same data.

mod ideal;
mod measured;
mod page;
mod tables;
mod verdicts;

use super::ReportError;
use hexagen_lab::reproduction::Reproduction;
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
