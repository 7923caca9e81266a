//! Results as text, JSON and files.

use super::Failure;
use crate::files::write_whole;
use crate::render::terminal;
use hexagen_lab::engine::Prepared;
use hexagen_lab::report::{Block, Table};
use serde::Serialize;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Prints text to stdout, with a line end. A closed pipe is not an error.
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

/// Most columns of a line.
pub(super) const COLUMNS: usize = 100;

/// A row in lines of at most 100 columns, the further ones below its text.
pub fn wrapped_row(row: &str) -> String {
    filled(row, "            ")
}

/// A paragraph in such lines.
pub fn paragraph(text: &str) -> String {
    filled(text, "")
}

/// A word that is longer than a line stays whole.
fn filled(text: &str, indent: &str) -> String {
    let options = textwrap::Options::new(COLUMNS)
        .subsequent_indent(indent)
        .break_words(false)
        .word_splitter(textwrap::WordSplitter::NoHyphenation);
    textwrap::fill(&glued(text), options).replace(GLUE, " ")
}

/// A space at which no line ends.
const GLUE: char = '\u{a0}';

/// The text with its numbers glued to their units.
fn glued(text: &str) -> String {
    let letters: Vec<char> = text.chars().collect();
    let is_unit = |letter: &char| letter.is_alphabetic() || *letter == '%';
    let glue = |(place, &letter): (usize, &char)| {
        let before = place.checked_sub(1).map(|before| letters[before]);
        let is_behind_number = before.is_some_and(|before| before.is_ascii_digit());
        if letter == ' ' && is_behind_number && letters.get(place + 1).is_some_and(is_unit) {
            GLUE
        } else {
            letter
        }
    };
    letters.iter().enumerate().map(glue).collect()
}

/// Prints lines to stderr, with colours on a terminal (unless `NO_COLOR` is set). There is no place
/// to tell that this failed.
pub fn note(text: &str) {
    let lines: Vec<String> = text.lines().map(coloured).collect();
    let _ = writeln!(anstream::stderr().lock(), "{}", lines.join("\n"));
}

/// A message's line with its severity in colour: `file:1:2: error[HX0205]: …`, `warning: …`.
fn coloured(line: &str) -> String {
    const SEVERITIES: [(&str, &str); 2] = [("error", "\x1b[1;31m"), ("warning", "\x1b[1;33m")];
    let found = SEVERITIES.iter().find_map(|(word, colour)| {
        let begin = if line.starts_with(word) {
            0
        } else {
            line.find(&format!(": {word}["))? + 2
        };
        let end = begin + line[begin..].find(':')?;
        Some((begin, end, colour))
    });
    let Some((begin, end, colour)) = found else {
        return line.to_owned();
    };
    format!(
        "{}{colour}{}\x1b[0m{}",
        &line[..begin],
        &line[begin..end],
        &line[end..]
    )
}

/// Prints one JSON object to stdout.
///
/// # Errors
/// A value that JSON cannot represent, or as [`print_text`].
pub fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::Argument(format!("cannot write JSON: {error}")))?;
    print_text(&text)
}

/// Prints parts of a page.
///
/// # Errors
/// As [`print_text`].
pub fn print_blocks(blocks: &[Block]) -> Result<(), Failure> {
    print_text(&terminal::text(blocks))
}

/// Prints a table.
///
/// # Errors
/// As [`print_text`].
pub fn print_table(table: &Table) -> Result<(), Failure> {
    print_text(&terminal::table(table))
}

/// A warning on stderr.
pub fn warn(text: &str) {
    note(&format!("warning: {text}"));
}

/// The generator's warnings on stderr.
pub fn tell_warnings(drive: &Prepared) {
    for warning in &drive.warnings {
        note(warning);
    }
    if drive.regulates_speed {
        note("the speed loop is left out: this command sets the torque");
    }
}

/// Writes a file completely or not at all.
///
/// # Errors
/// When the file cannot be written.
pub fn write_file(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    write_whole(path, contents).map_err(|error| Failure::Write {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_severity_alone_is_coloured() {
        for (line, expected) in [
            (
                "hub.toml:3:1: error[HX0205]: no error: none",
                "hub.toml:3:1: \x1b[1;31merror[HX0205]\x1b[0m: no error: none",
            ),
            ("warning: slow", "\x1b[1;33mwarning\x1b[0m: slow"),
            ("errors are none of this", "errors are none of this"),
            ("a note", "a note"),
        ] {
            assert_eq!(coloured(line), expected);
        }
    }

    #[test]
    fn no_line_ends_between_a_number_and_its_unit() {
        let text = format!("{} 0.27 % and 12 V", "x".repeat(94));
        let told = paragraph(&text);
        assert_eq!(told.lines().nth(1), Some("0.27 % and 12 V"), "{told}");
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
