//! The report: one HTML page about a motor and its controllers, complete in itself.
//!
//! [`Results`] says what there is to show; [`write()`] makes the page: no script, no reference to
//! anything outside the file, and the same bytes for the same data.

mod document;
mod highlight;
mod page;
mod plot;
pub mod reproduction;
mod sections;
mod window;

use crate::files::write_whole;
use hexagen_lab::results::Results;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The file could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// A plot could not be drawn.
    #[error("cannot draw a plot: {0}")]
    Plot(String),
    /// Emitted code could not be highlighted.
    #[error("cannot highlight code: {0}")]
    Highlight(String),
}

/// Writes the page into a folder, which is created where it is missing, and returns its path:
/// `report-<motor file>.html`. A page of that name is replaced at once or not at all.
///
/// # Errors
/// A file that cannot be written, or a plot that cannot be drawn.
pub fn write(data: &Results, dir: &Path) -> Result<PathBuf, ReportError> {
    let html = page::render(data)?;
    write_page(
        &html,
        dir,
        &format!("report-{}.html", file_stem(&data.file)),
    )
}

/// Writes a page as a whole or not at all.
fn write_page(html: &str, dir: &Path, name: &str) -> Result<PathBuf, ReportError> {
    let path = dir.join(name);
    match write_whole(&path, html.as_bytes()) {
        Ok(()) => Ok(path),
        Err(source) => Err(ReportError::Write { path, source }),
    }
}

/// Makes the folder of a page where it is missing, and sees whether files can be made in it: a
/// reason to stop is better known before the work than after it.
///
/// # Errors
/// A folder that cannot be made or written into.
pub fn prepare_folder(dir: &Path) -> Result<(), ReportError> {
    let tried = fs::create_dir_all(dir).and_then(|()| tempfile::tempfile_in(dir));
    tried.map(|_| ()).map_err(|source| ReportError::Write {
        path: dir.to_owned(),
        source,
    })
}

/// The page as text.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn render(data: &Results) -> Result<String, ReportError> {
    page::render(data)
}

/// A name as part of a file name: what is neither letter nor digit of any script, `-`, `_` nor `.`
/// becomes `-`.
fn file_stem(name: &str) -> String {
    let kept = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    let stem: String = name
        .chars()
        .map(|c| if kept(c) { c } else { '-' })
        .collect();
    let stem = stem.trim_matches(['-', '.']);
    if stem.is_empty() { "motor" } else { stem }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::file_stem;

    #[test]
    fn names_become_file_names() {
        for (name, stem) in [
            ("trivedi-keshri-660w", "trivedi-keshri-660w"),
            ("Hub_2.1", "Hub_2.1"),
            ("../etc/x", "etc-x"),
            ("", "motor"),
            ("A B", "A-B"),
        ] {
            assert_eq!(file_stem(name), stem);
        }
    }
}
