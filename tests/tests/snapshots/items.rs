//! Texts of code in which an item that an earlier drive has letter for letter is a name.

use crate::extracts::abridged;
use crate::units::{Unit, items};
use std::collections::BTreeMap;

/// Begins a line of names.
const SAME: &str = "// As in ";

/// Columns of a line of names.
const WIDTH: usize = 100;

/// Items of earlier drives: by text the first drive that has it.
#[derive(Debug, Default)]
pub struct Earlier(BTreeMap<String, String>);

impl Earlier {
    /// A drive's text: whole for the first one, for others its items in their order, of tables the
    /// first row of each shape.
    pub fn differences(&mut self, drive: &str, kind: &str, text: &str) -> String {
        let is_first = self.0.is_empty();
        let items = items(kind, text);
        let differences = self.of_items(&items);
        for item in items {
            let first = self.0.entry(item.text);
            first.or_insert_with(|| drive.to_owned());
        }
        if is_first {
            text.to_owned()
        } else {
            differences
        }
    }

    fn of_items(&self, items: &[Unit]) -> String {
        let source = |item: &Unit| self.0.get(&item.text);
        let mut text = String::new();
        for run in items.chunk_by(|item, next| source(item) == source(next)) {
            if let Some(drive) = source(&run[0]) {
                text += &names(drive, run);
            } else {
                text.extend(run.iter().map(abridged));
            }
        }
        text
    }
}

/// The names of items, in lines.
fn names(drive: &str, items: &[Unit]) -> String {
    let head = format!("{SAME}{drive}:");
    let mut text = head.clone();
    let mut columns = text.len();
    for item in items {
        if columns + item.name.len() + 1 > WIDTH {
            text = text + "\n" + &head;
            columns = head.len();
        }
        text = text + " " + &item.name;
        columns += item.name.len() + 1;
    }
    text + "\n"
}

/// A text without its lines of names.
pub fn without_names(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with(SAME));
    lines.flat_map(|line| [line, "\n"]).collect()
}
