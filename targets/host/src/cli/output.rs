//! Results as text, tables, JSON and files.

use super::Failure;
use comfy_table::presets::ASCII_MARKDOWN;
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Table, Width};
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// Prints text to stdout, with a line end. A closed pipe is no error.
pub fn print_text(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{}", text.trim_end_matches('\n'));
}

/// Prints one JSON object to stdout.
///
/// # Errors
/// A value that JSON has no words for.
pub fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::Argument(format!("no JSON: {error}")))?;
    print_text(&text);
    Ok(())
}

/// A note on stderr.
pub fn warn(text: &str) {
    eprintln!("warning: {text}");
}

/// Writes a file beside its place and renames it, so that no reader sees half of it. Makes the
/// folder if it is missing.
///
/// # Errors
/// When the file cannot be written.
pub fn write_file(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    let failed = |error: std::io::Error| Failure::Write {
        path: path.to_owned(),
        reason: error.to_string(),
    };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder).map_err(failed)?;
    let mut beside = tempfile::Builder::new();
    // Results are no secrets: the usual permissions of new files.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        beside.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = beside
        .prefix(".hexagen-")
        .tempfile_in(folder)
        .map_err(failed)?;
    file.write_all(contents).map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}

/// A number with so many significant digits, without exponent where that is readable.
pub fn significant(value: f64, digits: u32) -> String {
    if value.is_nan() {
        return "-".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor() as i32;
    if exponent < -5 {
        return format!("{value:.*e}", digits.saturating_sub(1) as usize);
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

/// A plain table in Markdown; every column but the first `left` ones is right-aligned.
pub struct TextTable {
    table: Table,
    left: usize,
}

impl TextTable {
    /// An empty table with a header.
    pub fn new<T: Into<String>>(left: usize, header: impl IntoIterator<Item = T>) -> Self {
        let mut table = Table::new();
        table.load_style(ASCII_MARKDOWN);
        table.set_header(header.into_iter().map(Into::into).collect::<Vec<String>>());
        Self { table, left }
    }

    /// Adds a row.
    pub fn row<T: Into<String>>(&mut self, cells: impl IntoIterator<Item = T>) {
        self.table
            .add_row(cells.into_iter().map(Into::into).collect::<Vec<String>>());
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
    fn digits() {
        assert_eq!(significant(1234.56, 3), "1235");
        assert_eq!(significant(0.012_345, 3), "0.0123");
        assert_eq!(significant(1.2e-9, 2), "1.2e-9");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(f64::NAN, 3), "-");
    }

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
}
