//! New parts of a text compared with earlier ones: units whole, or lines of known units.

use crate::shape::{Shape, shape, shape_in};
use crate::units::{Unit, balance, units};
use std::collections::{BTreeMap, BTreeSet};

/// A unit's text; of a table the first row of each shape.
pub fn abridged(unit: &Unit) -> String {
    let is_table = |line: &String| line.starts_with("static ") && !line.contains('(');
    if !unit.lines.iter().any(is_table) {
        return unit.text.clone() + "\n";
    }
    let (mut abridged, mut row, mut open) = (String::new(), String::new(), 0);
    let (mut seen, mut cut) = (BTreeSet::new(), 0);
    for line in unit.text.lines() {
        row.extend([line, "\n"]);
        open += balance(line);
        if open > 1 {
            continue;
        }
        let row = std::mem::take(&mut row);
        if seen.insert(shape(&row)) {
            abridged += &row;
        } else {
            cut += 1;
        }
    }
    match cut {
        0 => abridged,
        cut => format!("// Without {cut} rows of the same shapes.\n{abridged}"),
    }
}

/// Units and lines shown by earlier texts of one kind.
#[derive(Debug, Default)]
pub struct Shown {
    names: BTreeSet<String>,
    shapes: BTreeSet<Shape>,
}

impl Shown {
    /// Adds a text that is shown in full.
    pub fn add(&mut self, units: &[Unit]) {
        self.names
            .extend(units.iter().map(|unit| unit.name.clone()));
        self.shapes.extend(units.iter().flat_map(Unit::shapes));
    }

    /// The new parts of a text: units with new names whole, of the others lines with new shapes.
    pub fn extract(&mut self, units: &[Unit]) -> String {
        let mut extract = String::new();
        let mut was_whole = false;
        for unit in units {
            let is_whole = !self.names.contains(&unit.name);
            if is_whole {
                extract += if was_whole { "" } else { "+\n" };
                extract += &abridged(unit);
                self.add(std::slice::from_ref(unit));
            } else {
                let lines = unit.lines.iter().zip(unit.shapes());
                let lines = lines.filter(|(_, shape)| self.shapes.insert(shape.clone()));
                let lines: Vec<&str> = lines.map(|(line, _)| &**line).collect();
                extract += &lines_of(&unit.name, &lines);
                was_whole &= lines.is_empty();
            }
            was_whole |= is_whole;
        }
        extract
    }

    /// Shapes of the units not shown so far, by unit and alphabet; now they count as shown.
    pub fn rest(&mut self, units: impl IntoIterator<Item = Unit>) -> String {
        let mut new: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (name, line) in units
            .into_iter()
            .flat_map(|unit| unit.shapes().collect::<Vec<_>>())
        {
            if self.shapes.insert((name.clone(), line.clone())) {
                new.entry(name).or_default().insert(line);
            }
        }
        let lines = new.iter().map(|(name, lines)| {
            let lines: Vec<&str> = lines.iter().map(|line| &**line).collect();
            lines_of(name, &lines)
        });
        lines.collect()
    }
}

/// Lines of a unit under its name; a single one next to it.
fn lines_of(name: &str, lines: &[&str]) -> String {
    match lines {
        [] => String::new(),
        [line] => format!("~ {name}: {line}\n"),
        lines => format!("~ {name}\n    {}\n", lines.join("\n    ")),
    }
}

/// Shapes of the units that extracts show.
pub fn shapes_of_extracts(kind: &str, extracts: &str) -> BTreeSet<Shape> {
    let mut shown = BTreeSet::new();
    let mut whole = String::new();
    let mut name: Option<String> = None;
    // The last line ends the whole unit.
    for line in extracts.lines().chain(["+"]) {
        let is_head = line == "+" || line.starts_with("= ") || line.starts_with("~ ");
        if is_head {
            let units = units(kind, &std::mem::take(&mut whole));
            shown.extend(units.iter().flat_map(Unit::shapes));
            let head = line.strip_prefix("~ ");
            name = head.map(|head| match head.split_once(": ") {
                Some((name, line)) => {
                    shown.insert((name.to_owned(), shape_in(kind, name, line)));
                    name.to_owned()
                }
                None => head.to_owned(),
            });
        } else if let Some(name) = name.as_ref().filter(|_| line.starts_with("    ")) {
            shown.insert((name.clone(), shape_in(kind, name, line.trim())));
        } else {
            whole += line;
            whole.push('\n');
        }
    }
    shown
}
