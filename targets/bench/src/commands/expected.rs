//! Expected commands, versioned in `commands.txt`: a line per drive.

use super::run::Commands;
use crate::BenchError;
use crate::firmware::workspace;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

/// Header of the file; lines of this kind are skipped.
const HEAD: &str = "\
# Written by `cargo xtask commands --accept`; commands that differ fail `cargo xtask commands`.
# Symbol, steps, steps in which not all legs are off, digest of all commands, digests of the stretches (8 digits each).
";

/// Digits of a stretch's digest.
const DIGITS: usize = 8;

/// Expectations by symbol of the drive.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Expected(pub BTreeMap<String, Commands>);

fn path() -> PathBuf {
    workspace()
        .join("targets")
        .join("bench")
        .join("commands.txt")
}

impl Expected {
    /// Reads the expectations.
    ///
    /// # Errors
    /// If the file is missing or invalid.
    pub fn read() -> Result<Self, BenchError> {
        let path = path();
        let refused = |reason: &str| {
            BenchError::Failed(format!(
                "{}: {reason}; `cargo xtask commands --accept` writes it",
                path.display()
            ))
        };
        let text = fs::read_to_string(&path).map_err(|error| refused(&error.to_string()))?;
        Self::parse(&text).map_err(|line| refused(&format!("line {line} cannot be read")))
    }

    /// Writes them to a temporary file that replaces the old one.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self) -> Result<(), BenchError> {
        let path = path();
        let beside = path.with_extension("new");
        fs::write(&beside, self.text())?;
        fs::rename(&beside, &path)?;
        Ok(())
    }

    fn text(&self) -> String {
        let mut text = HEAD.to_owned();
        for (symbol, commands) in &self.0 {
            let Commands {
                steps,
                driving,
                digest,
                stretches,
            } = commands;
            // Writing to a string cannot fail.
            let _ = write!(text, "{symbol} {steps} {driving} {digest:016x} ");
            for digest in stretches {
                let _ = write!(text, "{digest:0DIGITS$x}");
            }
            text.push('\n');
        }
        text
    }

    /// Parses the file's text; the error is the number of the invalid line.
    fn parse(text: &str) -> Result<Self, usize> {
        let lines = (1..).zip(text.lines());
        lines
            .filter(|(_, line)| !line.starts_with('#'))
            .map(|(number, line)| parse_line(line).ok_or(number))
            .collect::<Result<_, _>>()
            .map(Self)
    }
}

fn parse_line(line: &str) -> Option<(String, Commands)> {
    let fields: Vec<&str> = line.split(' ').collect();
    let [symbol, steps, driving, digest, stretches] = fields[..] else {
        return None;
    };
    let stretches = stretches.as_bytes().chunks(DIGITS).map(|digits| {
        let digits = std::str::from_utf8(digits).ok()?;
        u32::from_str_radix(digits, 16).ok()
    });
    let commands = Commands {
        steps: steps.parse().ok()?,
        driving: driving.parse().ok()?,
        digest: u64::from_str_radix(digest, 16).ok()?,
        stretches: stretches.collect::<Option<_>>()?,
    };
    Some((symbol.to_owned(), commands))
}

/// The difference between commands and expectation as text; `None` if there is none.
pub fn difference(expected: &Commands, found: &Commands) -> Option<String> {
    if expected == found {
        return None;
    }
    let Commands {
        steps,
        driving,
        digest,
        stretches,
    } = expected;
    let count = stretches.len().max(found.stretches.len());
    let mut differing =
        (0..count).filter(|&place| stretches.get(place) != found.stretches.get(place));
    let place = match differing.next() {
        Some(first) => format!(
            "the first difference is in stretch {first}, {} of {count} stretches differ",
            1 + differing.count()
        ),
        None => "no single stretch differs".to_owned(),
    };
    Some(format!(
        "{place}; expected were {steps} steps, {driving} driving, digest {digest:016x}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn commands() -> Commands {
        Commands {
            steps: 4096,
            driving: 4000,
            digest: 0x0123_4567_89ab_cdef,
            stretches: vec![0x0000_0007, 0xffff_ffff, 0x1234_5678],
        }
    }

    #[test]
    fn expectations_round_trip() {
        let expected = Expected(BTreeMap::from([
            ("step_x".to_owned(), commands()),
            ("step_y".to_owned(), commands()),
        ]));
        let text = expected.text();
        assert!(text.ends_with("step_y 4096 4000 0123456789abcdef 00000007ffffffff12345678\n"));
        assert_eq!(Expected::parse(&text), Ok(expected));
        assert_eq!(
            Expected::parse(&text.replace("step_y 4096", "step_y")),
            Err(4)
        );
        assert_eq!(
            Expected::parse(&text.replace("12345678", "1234567g")),
            Err(3)
        );
    }

    #[test]
    fn a_difference_names_its_first_stretch() {
        assert_eq!(difference(&commands(), &commands()), None);
        let found = Commands {
            stretches: vec![7, 8, 9],
            ..commands()
        };
        let text = difference(&commands(), &found).expect("differs");
        assert!(text.contains("in stretch 1, 2 of 3 stretches"), "{text}");
        let found = Commands {
            digest: 0,
            ..commands()
        };
        let text = difference(&commands(), &found).expect("differs");
        assert!(text.contains("no single stretch differs"), "{text}");
    }
}
