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

/// Prints lines of which the first ends in a verdict, whose word has a colour on a terminal.
///
/// # Errors
/// As [`print_text`].
pub fn print_verdict(lines: &[String]) -> Result<(), Failure> {
    let text = lines.join("\n");
    print_text(&if terminal::is_coloured() {
        verdict_coloured(&text)
    } else {
        text
    })
}

/// A text with the verdict behind the name that it begins with in colour.
fn verdict_coloured(text: &str) -> String {
    const VERDICTS: [(&str, &str); 4] = [
        ("does not work", RED),
        ("does not hold its rating", RED),
        ("works, but", YELLOW),
        ("works", GREEN),
    ];
    let found = text.match_indices(": ").find_map(|(at, colon)| {
        let begin = at + colon.len();
        let is_next = |word: &&str| {
            let next = text.get(begin..begin + word.len());
            next.is_some_and(|next| next.eq_ignore_ascii_case(word))
        };
        let (word, colour) = VERDICTS.iter().find(|(word, _)| is_next(word))?;
        Some((begin, begin + word.len(), colour))
    });
    found.map_or_else(
        || text.to_owned(),
        |(begin, end, colour)| painted(text, begin, end, colour),
    )
}

const RED: &str = "\x1b[1;31m";
const YELLOW: &str = "\x1b[1;33m";
const GREEN: &str = "\x1b[1;32m";

/// A text with a part of it in colour.
fn painted(text: &str, begin: usize, end: usize, colour: &str) -> String {
    format!(
        "{}{colour}{}\x1b[0m{}",
        &text[..begin],
        &text[begin..end],
        &text[end..]
    )
}

/// Prints lines to stderr, with colours on a terminal (unless `NO_COLOR` is set). There is no place
/// to tell that this failed.
pub fn note(text: &str) {
    let lines: Vec<String> = text.lines().map(coloured).collect();
    let _ = writeln!(anstream::stderr().lock(), "{}", lines.join("\n"));
}

/// A message's line with its severity in colour: `file:1:2: error[HX0205]: …`, `warning: …`.
fn coloured(line: &str) -> String {
    const SEVERITIES: [(&str, &str); 2] = [("error", RED), ("warning", YELLOW)];
    let found = SEVERITIES.iter().find_map(|(word, colour)| {
        let begin = if line.starts_with(word) {
            0
        } else {
            line.find(&format!(": {word}["))? + 2
        };
        let end = begin + line[begin..].find(':')?;
        Some((begin, end, colour))
    });
    found.map_or_else(
        || line.to_owned(),
        |(begin, end, colour)| painted(line, begin, end, colour),
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
    if drive.left_out.is_some() {
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
    fn the_word_of_a_verdict_alone_is_coloured() {
        for (line, expected) in [
            (
                "hub: works: it holds its torque\nmotor",
                "hub: \x1b[1;32mworks\x1b[0m: it holds its torque\nmotor",
            ),
            (
                "hub: Works, but slowly.",
                "hub: \x1b[1;33mWorks, but\x1b[0m slowly.",
            ),
            (
                "hub: does not work: no",
                "hub: \x1b[1;31mdoes not work\x1b[0m: no",
            ),
            ("hub.toml: nothing works", "hub.toml: nothing works"),
        ] {
            assert_eq!(verdict_coloured(line), expected);
        }
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
