//! The table of options: a row per option of a controller says all that is known of it.
//!
//! The reader takes its words, limits and defaults from a row, the normalised specification its lines, the reference page and
//! the program's help their text, and the tests' covering arrays their values. What an option means together with
//! others stands with its controller's checks.

use super::rule::Rule;
use super::words::Words;
use std::fmt::Debug;

/// An option among those of `S`.
#[derive(Debug)]
pub(crate) struct Row<S: 'static> {
    /// Name, kind of value, limits, default and meaning.
    pub rule: Rule,
    /// Its value in the normalised specification; none where the line is left out.
    pub line: fn(&S) -> Option<String>,
}

impl<S> Row<S> {
    /// A row of the table.
    pub const fn of(rule: Rule, line: fn(&S) -> Option<String>) -> Self {
        Self { rule, line }
    }
}

/// The lines that these options have in the normalised specification.
pub(crate) fn lines<S>(rows: &'static [Row<S>], options: &S) -> Vec<(&'static Rule, String)> {
    let line = |row: &'static Row<S>| Some((&row.rule, (row.line)(options)?));
    rows.iter().filter_map(line).collect()
}

/// A number as the normalised specification has it: `Debug` of a float is the shortest text that reads back the same.
pub(crate) fn number(value: impl Debug) -> String {
    format!("{value:?}")
}

/// A word as the normalised specification has it.
pub(crate) fn word(choice: impl Words) -> String {
    format!("\"{}\"", choice.word())
}

/// A flag whose line is left out where it is off.
pub(crate) fn if_on(flag: bool) -> Option<String> {
    flag.then(|| word(flag))
}

/// A number whose line is left out where it is 0.
pub(crate) fn if_any(value: f64) -> Option<String> {
    (value > 0.0).then(|| number(value))
}
