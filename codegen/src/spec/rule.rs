//! Rules of the fields: rows of the tables.

use super::units::Dimension as D;
use super::words::{Word, Words};

/// A field: name, kind of value, example for messages; for an option also default and meaning.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// Name of the field.
    pub name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) example: &'static str,
    pub(crate) preset: Preset,
    /// Meaning of an option; empty for fields of motor and inverter, which the reference page
    /// explains.
    pub about: &'static str,
}

/// A value of a default that follows from other fields, or "" for any, and why it is chosen: a phrase
/// behind a colon.
pub(crate) type Reason = (&'static str, &'static str);

/// The default of a field.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Preset {
    /// This value, as it would be written.
    Value(&'static str),
    /// Computed by the checks; the text says how, and the reasons why.
    Rule(&'static str, &'static [Reason]),
    /// None: the option is off, with this effect.
    Off(&'static str),
    /// Stated in the checks and in the reference page of motor and inverter.
    Checked,
}

impl Rule {
    pub(crate) const fn of(name: &'static str, kind: Kind, example: &'static str) -> Self {
        Self {
            name,
            kind,
            example,
            preset: Preset::Checked,
            about: "",
        }
    }

    /// Sets the default value.
    pub(crate) const fn preset(self, value: &'static str) -> Self {
        let preset = Preset::Value(value);
        Self { preset, ..self }
    }

    /// Sets a default that follows from other fields, with the reason for each of its values.
    pub(crate) const fn by_default(self, rule: &'static str, reasons: &'static [Reason]) -> Self {
        let preset = Preset::Rule(rule, reasons);
        Self { preset, ..self }
    }

    /// Leaves the option off by default, with this effect.
    pub(crate) const fn off(self, effect: &'static str) -> Self {
        let preset = Preset::Off(effect);
        Self { preset, ..self }
    }

    /// The words of a choice; none for other kinds.
    pub fn words(&self) -> &'static [Word] {
        match self.kind {
            Kind::Choice(words) | Kind::ChoiceOrList(words) => words,
            _ => &[],
        }
    }

    /// The default value as it would be written; none where it follows from other fields.
    pub fn preset_value(&self) -> Option<&'static str> {
        match self.preset {
            Preset::Value(value) => Some(value),
            Preset::Rule(..) | Preset::Off(_) | Preset::Checked => None,
        }
    }

    /// Why a default that follows from other fields has this value, as the normalised
    /// specification writes it; none for an option without such a rule.
    pub fn reason(&self, value: &str) -> Option<&'static str> {
        let Preset::Rule(_, reasons) = self.preset else {
            return None;
        };
        let value = value.trim_matches('"');
        let (_, reason) = reasons
            .iter()
            .find(|(of, _)| of.is_empty() || *of == value)?;
        Some(reason)
    }

    /// Whether the option is one of some words or numbers.
    pub fn is_choice(&self) -> bool {
        matches!(
            self.kind,
            Kind::Choice(_) | Kind::ChoiceOrList(_) | Kind::OneOf(_)
        )
    }

    /// Sets the meaning, a sentence without full stop.
    pub(crate) const fn about(self, about: &'static str) -> Self {
        Self { about, ..self }
    }
}

/// Kind of value of a field.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    /// A number with one of the units; limits in SI units of the first. A `low` of 0 allows 0.
    Quantity {
        dimensions: &'static [D],
        low: f64,
        high: f64,
    },
    /// A number without unit. A `low` of 0 allows 0.
    Plain { low: f64, high: f64 },
    /// A whole number without unit.
    Integer { low: u32, high: u32 },
    /// One of these whole numbers, without unit.
    OneOf(&'static [u32]),
    /// One of the words in the checks.
    Word,
    /// One of these words.
    Choice(&'static [Word]),
    /// One of these words, or a list of whole numbers.
    ChoiceOrList(&'static [Word]),
    /// A list of integers.
    Integers,
    /// Free text.
    Text,
}

pub(crate) const fn quantity(
    name: &'static str,
    dimensions: &'static [D],
    low: f64,
    high: f64,
    example: &'static str,
) -> Rule {
    let kind = Kind::Quantity {
        dimensions,
        low,
        high,
    };
    Rule::of(name, kind, example)
}

pub(crate) const fn integer(
    name: &'static str,
    low: u32,
    high: u32,
    example: &'static str,
) -> Rule {
    Rule::of(name, Kind::Integer { low, high }, example)
}

pub(crate) const fn one_of(
    name: &'static str,
    numbers: &'static [u32],
    example: &'static str,
) -> Rule {
    Rule::of(name, Kind::OneOf(numbers), example)
}

pub(crate) const fn plain(name: &'static str, low: f64, high: f64, example: &'static str) -> Rule {
    Rule::of(name, Kind::Plain { low, high }, example)
}

pub(crate) const fn word(name: &'static str, example: &'static str) -> Rule {
    Rule::of(name, Kind::Word, example)
}

/// A choice of which `example` is one word.
pub(crate) const fn choice<T: Words>(name: &'static str, example: &'static str) -> Rule {
    Rule::of(name, Kind::Choice(T::WORDS), example)
}

/// A choice, or a list of whole numbers in its place.
pub(crate) const fn choice_or_list<T: Words>(name: &'static str, example: &'static str) -> Rule {
    Rule::of(name, Kind::ChoiceOrList(T::WORDS), example)
}

pub(crate) const fn text(name: &'static str, example: &'static str) -> Rule {
    Rule::of(name, Kind::Text, example)
}
