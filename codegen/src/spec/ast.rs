//! The syntax tree of a specification: what was written, where, in which unit.
//!
//! Macro tokens, TOML files and command-line variants all become this tree; nothing in it is
//! checked beyond the spelling of values. What could not be read is kept as a diagnostic, so that
//! the checks report it together with everything else.

use super::alternatives::same_quantity;
pub use super::basis::Basis;
use super::units::{Dimension, Unit};
use crate::diagnostics::{Diagnostic, Location, catalogue, nearest};
use std::fmt;

/// A specification as written.
#[derive(Clone, Debug)]
pub struct SpecAst {
    /// Name of the drive's type.
    pub name: Name,
    /// The motor's fields.
    pub motor: Section,
    /// The board that has the inverter's other fields.
    pub board: Option<Board>,
    /// The inverter's own fields.
    pub inverter: Section,
    /// The controller's fields; its kind is the field `kind`.
    pub controller: Section,
    /// Where the data come from, free text: key and text, from `[source]`.
    pub source: Vec<(String, String)>,
    /// What could not be read.
    pub malformed: Vec<Diagnostic>,
}

/// A name and where it was written.
#[derive(Clone, Debug)]
pub struct Name {
    /// The name.
    pub text: String,
    /// Where it was written; for a file's default name, the start of the file.
    pub location: Location,
}

/// The fields of one section, in the order in which they were written.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Where the section begins; none if it was not written.
    pub location: Option<Location>,
    /// The fields; duplicates are kept.
    pub fields: Vec<Field>,
    /// Part of the section could not be read: missing fields are not reported.
    pub incomplete: bool,
}

/// `name: value`.
#[derive(Clone, Debug)]
pub struct Field {
    /// The field's name.
    pub name: String,
    /// Where the name was written.
    pub name_location: Location,
    /// The value.
    pub value: Value,
    /// Where the value was written, unit and basis included.
    pub location: Location,
    /// Why the value was assumed, where the data sheet does not give it.
    pub assumed: Option<String>,
}

/// A value as written.
#[derive(Clone, Debug)]
pub enum Value {
    /// A number, with its unit and basis words.
    Number(Number),
    /// A single word, e.g. `star`, `on`, `fcs-mpc`.
    Word(String),
    /// Free text (descriptions only).
    Text(String),
    /// A list of integers.
    Integers(Vec<i64>),
    /// A list of other values.
    List(Vec<Value>),
    /// Unreadable; the diagnostic says why.
    Malformed(Box<Diagnostic>),
}

impl Value {
    /// Whether it is the sensitivity of current sensors, or a list with one.
    pub(crate) fn is_sensitivity(&self) -> bool {
        match self {
            Self::Number(number) => {
                let unit = number.unit.as_ref();
                unit.is_some_and(|unit| unit.dimension == Dimension::Sensitivity)
            }
            Self::List(values) => values.iter().any(Self::is_sensitivity),
            _ => false,
        }
    }
}

/// A number with unit and basis.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// The number's digits as written.
    pub digits: String,
    /// The number as written, before the unit's factor.
    pub value: f64,
    /// The unit, if any.
    pub unit: Option<Unit>,
    /// Basis words in the order in which they were written.
    pub basis: Vec<Basis>,
}

impl Number {
    /// The value in SI units (as it stands without a unit).
    pub fn si(&self) -> f64 {
        let unit = self.unit.as_ref();
        unit.map_or(self.value, |unit| unit.to_si(self.value))
    }
}

/// A board as a specification names it.
#[derive(Clone, Debug)]
pub struct Board {
    /// The name or path, and where it was written.
    pub name: Name,
    /// What stands in its file; none while that was not read.
    pub file: Option<BoardFile>,
}

/// Options of a controller that a board may state: they are those of its core.
pub const OF_CORE: [&str; 2] = [TARGET, "core_clock"];

/// The option that names the core.
pub const TARGET: &str = "target";

/// What stands in a board's file.
#[derive(Clone, Debug, Default)]
pub struct BoardFile {
    /// One line.
    pub description: Option<String>,
    /// Its fields.
    pub inverter: Section,
    /// Its core: [`OF_CORE`].
    pub core: Section,
    /// Where the data come from: key and text.
    pub source: Vec<(String, String)>,
    /// What could not be read.
    pub malformed: Vec<Diagnostic>,
}

impl BoardFile {
    /// What the file says of where a field's value comes from.
    pub fn source_of(&self, field: &str) -> Option<&str> {
        let (_, text) = self.source.iter().find(|(name, _)| name == field)?;
        Some(text)
    }
}

/// A name that no file holds: of a command line, or of a build script.
impl From<&str> for Name {
    fn from(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            location: Location::Variant {
                text: text.to_owned(),
                column: 1,
            },
        }
    }
}

impl SpecAst {
    /// An empty specification of the given name.
    pub fn new(name: Name) -> Self {
        Self {
            name,
            motor: Section::default(),
            board: None,
            inverter: Section::default(),
            controller: Section::default(),
            source: Vec::new(),
            malformed: Vec::new(),
        }
    }

    /// Reports a section that does not exist, and does not report the one meant as missing.
    /// `of_fields`: the section of the fields that stand in it, by which it is known where its own name says nothing.
    pub(super) fn unknown_section(
        &mut self,
        at: &Location,
        name: &str,
        known: &[&str],
        of_fields: Option<&str>,
    ) {
        let of_fields = of_fields.filter(|right| known.contains(right));
        self.malformed
            .push(catalogue::unknown_section(at, name, known, of_fields));
        if let Some(meant) = nearest(name, known).or(of_fields) {
            self.excuse(meant);
        }
    }

    /// Marks a section as present but unreadable.
    pub(super) fn excuse(&mut self, name: &str) {
        match name {
            "motor" => self.motor.incomplete = true,
            // What a board would state is not missing.
            "inverter" | "board" => self.inverter.incomplete = true,
            "controller" => self.controller.incomplete = true,
            _ => {}
        }
    }

    /// Replaces fields by those of `over`, and the name. A controller of another kind replaces the
    /// whole controller.
    /// A board of `over` replaces this tree's, and its fields this tree's own.
    pub fn overlay(&mut self, over: Self) {
        self.name = over.name;
        self.motor.overlay(over.motor);
        if let Some(board) = over.board {
            let file = board.file.as_ref();
            let fields = file.map_or(&[][..], |file| &file.inverter.fields);
            self.inverter.remove_quantities(fields);
            self.board = Some(board);
        }
        self.inverter.overlay(over.inverter);
        self.controller.overlay_controller(over.controller);
        self.source.extend(over.source);
        self.malformed.extend(over.malformed);
    }
}

impl Field {
    /// Whether one is the sensitivity of current sensors and the other a field of the converter that it takes.
    fn goes_with(&self, other: &Self) -> bool {
        const OF_CONVERTER: [&str; 2] = ["adc_reference", "amplifier_swing"];
        let takes = |one: &Self, other: &Self| {
            one.value.is_sensitivity() && OF_CONVERTER.contains(&other.name.as_str())
        };
        takes(self, other) || takes(other, self)
    }
}

impl Section {
    /// The first field of the given name.
    pub fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Replaces fields of the same quantity by those of `over`.
    pub(super) fn overlay(&mut self, over: Self) {
        self.remove_quantities(&over.fields);
        self.fields.extend(over.fields);
        self.incomplete |= over.incomplete;
        if over.location.is_some() {
            self.location = over.location;
        }
    }

    /// Removes what other fields state.
    fn remove_quantities(&mut self, others: &[Field]) {
        self.fields.retain(|field| {
            !others
                .iter()
                .any(|other| same_quantity(&other.name, &field.name) && !field.goes_with(other))
        });
    }

    /// As [`Section::overlay`], but drops the options of another kind of controller.
    pub(super) fn overlay_controller(&mut self, over: Self) {
        let kind = |section: &Self| match section.field("kind").map(|field| &field.value) {
            Some(Value::Word(word)) => Some(word.clone()),
            _ => None,
        };
        if kind(&over).is_some() && kind(&over) != kind(self) {
            self.fields.clear();
            self.incomplete = false;
        }
        self.overlay(over);
    }
}

/// Values are equal when they were written alike; unreadable values never are.
impl PartialEq for Value {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Number(left), Self::Number(right)) => left == right,
            (Self::Word(left), Self::Word(right)) | (Self::Text(left), Self::Text(right)) => {
                left == right
            }
            (Self::Integers(left), Self::Integers(right)) => left == right,
            (Self::List(left), Self::List(right)) => left == right,
            _ => false,
        }
    }
}

/// The value as a user would write it, e.g. `135 mohm per_phase`.
impl fmt::Display for Value {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(out, "{number}"),
            Self::Word(word) => out.write_str(word),
            Self::Text(text) => write!(out, "{text:?}"),
            Self::Integers(list) => write!(out, "{list:?}"),
            Self::List(list) => {
                let texts: Vec<String> = list.iter().map(Self::to_string).collect();
                write!(out, "[{}]", texts.join(", "))
            }
            Self::Malformed(_) => out.write_str("(unreadable)"),
        }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.digits)?;
        if let Some(unit) = &self.unit {
            write!(out, " {}", unit.symbol)?;
        }
        for basis in &self.basis {
            write!(out, " {}", basis.word())?;
        }
        Ok(())
    }
}
