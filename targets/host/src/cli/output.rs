//! Results as text, tables, JSON and files.

use super::Failure;
use crate::files::write_whole;
use anstream::{AutoStream, ColorChoice};
use comfy_table::presets::ASCII_MARKDOWN;
use comfy_table::{Cell, CellAlignment, Color, ColumnConstraint, ContentArrangement, Table, Width};
use hexagen_lab::engine::Prepared;
use serde::Serialize;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Prints text to stdout, with a line end. A closed pipe is no error: the reader has enough.
///
/// # Errors
/// When the text cannot be written.
pub fn print_text(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let written = writeln!(out, "{}", text.trim_end_matches('\n')).and_then(|()| out.flush());
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::Write {
            path: "standard output".into(),
            reason: error.to_string(),
        }),
        _ => Ok(()),
    }
}

/// Prints a line to stderr. There is no place to tell that this failed.
pub fn note(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Prints one JSON object to stdout.
///
/// # Errors
/// A value that JSON has no words for, or as [`print_text`].
pub fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::Argument(format!("no JSON: {error}")))?;
    print_text(&text)
}

/// A note on stderr.
pub fn warn(text: &str) {
    note(&format!("warning: {text}"));
}

/// The generator's warnings on stderr.
pub fn tell_warnings(drive: &Prepared) {
    for warning in &drive.warnings {
        note(warning);
    }
}

/// Writes a file as a whole or not at all.
///
/// # Errors
/// When the file cannot be written.
pub fn write_file(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    write_whole(path, contents).map_err(|error| Failure::Write {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

/// Colours of a cell, by their numbers among the 256 of terminals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ground {
    /// Of the cell.
    pub color: u8,
    /// Of its text.
    pub ink: u8,
}

/// A table in Markdown, with colours where a terminal shows them and nobody asked for none; every column but the first `left` ones is right-aligned.
pub struct TextTable {
    table: Table,
    left: usize,
}

impl TextTable {
    /// An empty table with a header.
    pub fn new<T: Into<String>>(left: usize, header: impl IntoIterator<Item = T>) -> Self {
        let mut table = Table::new();
        table.load_style(ASCII_MARKDOWN);
        // NO_COLOR, CLICOLOR and the kind of stdout decide.
        match AutoStream::choice(&std::io::stdout()) {
            ColorChoice::Never => table.force_no_tty(),
            _ => table.enforce_styling(),
        };
        table.set_header(header.into_iter().map(Into::into).collect::<Vec<String>>());
        Self { table, left }
    }

    /// Adds a row.
    pub fn row<T: Into<String>>(&mut self, cells: impl IntoIterator<Item = T>) {
        self.table
            .add_row(cells.into_iter().map(Into::into).collect::<Vec<String>>());
    }

    /// Adds a row of cells that may have a ground.
    pub fn painted_row(&mut self, cells: impl IntoIterator<Item = (String, Option<Ground>)>) {
        let cells = cells.into_iter().map(|(text, ground)| match ground {
            None => Cell::new(text),
            Some(Ground { color, ink }) => Cell::new(text)
                .bg(Color::AnsiValue(color))
                .fg(Color::AnsiValue(ink)),
        });
        self.table.add_row(cells.collect::<Vec<_>>());
    }

    /// Breaks the lines of a column's cells where they are longer than so many characters.
    #[must_use]
    pub fn wrapped(mut self, column: usize, most: u16) -> Self {
        // Without a width of the whole nothing is broken; this one leaves the choice to the column.
        self.table
            .set_content_arrangement(ContentArrangement::Dynamic)
            .set_width(u16::MAX);
        if let Some(column) = self.table.column_mut(column) {
            column.set_constraint(ColumnConstraint::UpperBoundary(Width::Fixed(most)));
        }
        self
    }

    /// The table as text.
    pub fn render(mut self) -> String {
        for (index, column) in self.table.column_iter_mut().enumerate() {
            if index >= self.left {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
        self.table.trim_fmt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_appear_whole_and_replace_what_was_there() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("new/file.txt");
        for text in ["first", "second"] {
            write_file(&path, text.as_bytes()).expect("can be written");
            assert_eq!(std::fs::read_to_string(&path).expect("is there"), text);
        }
        let left = std::fs::read_dir(path.parent().expect("has a folder")).expect("can be listed");
        assert_eq!(left.count(), 1);
    }

    #[test]
    fn a_file_that_cannot_be_written_leaves_no_folders_behind() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::create_dir(folder.path().join("old")).expect("a folder");
        let long = "n".repeat(300);
        // A name that is too long, a folder's name that is, and a folder in place of a file.
        for path in ["old/new/newer/LONG", "old/new/LONG/file", "new/LONG", "old"] {
            let path = folder.path().join(path.replace("LONG", &long));
            write_file(&path, b"text").expect_err("cannot be written");
            let old = folder.path().join("old");
            assert!(std::fs::read_dir(&old).expect("a folder").next().is_none());
            assert_eq!(std::fs::read_dir(&folder).expect("a folder").count(), 1);
        }
    }
}
