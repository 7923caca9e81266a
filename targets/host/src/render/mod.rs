//! Renderers of the laboratory's reports for HTML and terminals; JSON needs none.

mod html;
mod inline;
pub mod lines;
mod linked;
mod plot;
mod table;
pub mod terminal;
mod texts;

pub use html::html;

use crate::files::write_whole;
use hexagen_lab::report::Page;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Error of a page.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The file could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// A plot could not be written as JSON.
    #[error("cannot write a plot: {0}")]
    Plot(#[from] serde_json::Error),
    /// Emitted code could not be highlighted.
    #[error("cannot highlight code: {0}")]
    Highlight(String),
}

/// Writes a page as HTML into a folder, which is created where it is missing, and returns its path.
/// A page of that name is replaced at once or not at all.
///
/// # Errors
/// A file that cannot be written, or as [`html()`].
pub fn write(page: &Page, dir: &Path) -> Result<PathBuf, RenderError> {
    let path = dir.join(format!("{}.html", page.file));
    match write_whole(&path, html(page)?.as_bytes()) {
        Ok(()) => Ok(path),
        Err(source) => Err(RenderError::Write { path, source }),
    }
}

/// Creates the folder of a page if it is missing, and checks before the long run that files can be
/// written into it.
///
/// # Errors
/// A folder that cannot be created or written into.
pub fn prepare_folder(dir: &Path) -> Result<(), RenderError> {
    let tried = fs::create_dir_all(dir).and_then(|()| tempfile::tempfile_in(dir));
    tried.map(|_| ()).map_err(|source| RenderError::Write {
        path: dir.to_owned(),
        source,
    })
}
