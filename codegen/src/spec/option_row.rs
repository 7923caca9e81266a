//! A row of the tables of options: the options of a controller are `OWN` of its file in
//! [`controller`](super::controller), those that all share are in `controller::common`.
//!
//! Reader, normalised specification, reference page, help and the tests' covering arrays use the
//! same rows. Relations between options are in the checks of their controller.

use super::rule::Rule;
use super::words::Words;
use std::fmt::Debug;

/// An option among those of `S`.
#[derive(Debug)]
pub(crate) struct Row<S: 'static> {
    /// Name, kind of value, limits, default and meaning.
    pub rule: Rule,
    /// Its value in the normalised specification; none where it has no line.
    pub line: fn(&S) -> Option<String>,
}

impl<S> Row<S> {
    /// A row of the table.
    pub const fn of(rule: Rule, line: fn(&S) -> Option<String>) -> Self {
        Self { rule, line }
    }
}

/// The lines of these options in the normalised specification.
pub(crate) fn lines<S>(rows: &'static [Row<S>], options: &S) -> Vec<(&'static Rule, String)> {
    let line = |row: &'static Row<S>| Some((&row.rule, (row.line)(options)?));
    rows.iter().filter_map(line).collect()
}

/// A number in the normalised specification: `Debug` of a float is the shortest text that reads
/// back the same.
pub(crate) fn number(value: impl Debug) -> String {
    format!("{value:?}")
}

/// A word in the normalised specification.
pub(crate) fn word(choice: impl Words) -> String {
    format!("\"{}\"", choice.word())
}

/// A flag that has a line only where it is on.
pub(crate) fn if_on(flag: bool) -> Option<String> {
    flag.then(|| word(flag))
}

/// A number that has a line only where it is not 0.
pub(crate) fn if_any(value: f64) -> Option<String> {
    (value > 0.0).then(|| number(value))
}
