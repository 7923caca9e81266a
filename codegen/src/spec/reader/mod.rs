//! Typed access to the fields of a section: checks single fields, and returns values in SI units.

mod other_names;

use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, Location, engineering, percent, rpm, significant};
use crate::spec::ast::{Basis, Field, Number, Section, Value};
use crate::spec::field_rule::FieldRule;
use crate::spec::rule::{Kind, Preset, Rule};
use crate::spec::units::Dimension;
use crate::spec::value::{parse_value, plain_number};
use crate::spec::words::Words;

/// One section's fields under their rules.
pub(crate) struct Reader<'a> {
    name: &'static str,
    section: &'a Section,
    rules: Vec<&'static Rule>,
    /// Where missing fields are reported.
    at: Location,
}

/// A number that was read.
#[derive(Clone, Debug)]
pub(crate) struct Given<'a> {
    /// The value in SI units.
    pub si: f64,
    /// The unit's quantity; none for plain numbers.
    pub dimension: Option<Dimension>,
    /// Basis words.
    pub basis: &'a [Basis],
    /// The number as written.
    pub number: &'a Number,
    /// Name, text and place for messages.
    pub part: Part,
}

impl<'a> Reader<'a> {
    /// Of two rules with one name the first applies. `fallback`: where to report a missing section.
    pub fn new(
        name: &'static str,
        section: &'a Section,
        rules: impl IntoIterator<Item = &'static Rule>,
        fallback: &Location,
    ) -> Self {
        let at = section.location.as_ref().unwrap_or(fallback).clone();
        Self {
            name,
            section,
            rules: rules.into_iter().collect(),
            at,
        }
    }

    /// Where the section begins.
    pub fn location(&self) -> &Location {
        &self.at
    }

    /// Reports a missing section, unknown and repeated fields, and unreadable values.
    ///
    /// `elsewhere` may report a field that has no rule; it returns whether it did.
    pub fn check_fields(
        &self,
        errors: &mut Collector,
        elsewhere: impl Fn(&Field, &mut Collector) -> bool,
    ) {
        if self.section.location.is_none() && !self.section.incomplete {
            errors.push(catalogue::missing_section(&self.at, self.name));
        }
        let known: Vec<&str> = self.rules.iter().map(|rule| rule.name).collect();
        for (index, field) in self.section.fields.iter().enumerate() {
            let at = &field.name_location;
            if let Some(first) = self.section.fields[..index]
                .iter()
                .find(|f| f.name == field.name)
            {
                errors.push(catalogue::duplicate_field(
                    at,
                    &first.name_location,
                    &field.name,
                ));
            } else if known.contains(&field.name.as_str()) {
                if let Value::Malformed(error) = &field.value {
                    errors.push((**error).clone());
                }
            } else if elsewhere(field, errors) {
                // Reported.
            } else if let Some(remedy) = self.remedy(field) {
                errors.push(catalogue::other_name(at, self.name, &field.name, &remedy));
            } else {
                errors.push(catalogue::unknown_field(at, self.name, &field.name, &known));
            }
        }
    }

    /// Reports missing fields of a section that exists.
    pub fn require(&self, errors: &mut Collector, names: &[&str]) {
        for name in names {
            if self.may_lack(name) {
                errors.push(catalogue::missing_field(
                    &self.at,
                    self.name,
                    name,
                    &self.field_rule(name).examples(&[]),
                ));
            }
        }
    }

    /// Reports when neither or both of two fields are given.
    pub fn require_one_of(&self, errors: &mut Collector, names: [&str; 2]) {
        match names.map(|name| self.section.field(name)) {
            [Some(one), Some(other)] => errors.push(catalogue::exclusive_fields(
                &other.name_location,
                &other.name,
                &one.name_location,
                &one.name,
            )),
            [None, None] => self.require_any_of(errors, &names),
            _ => {}
        }
    }

    /// Reports when none of some fields is given.
    pub fn require_any_of(&self, errors: &mut Collector, names: &[&str]) {
        if names.iter().all(|name| self.may_lack(name)) {
            let fields: Vec<(&str, &str)> = names
                .iter()
                .map(|name| (*name, self.field_rule(name).example()))
                .collect();
            errors.push(catalogue::missing_alternative(&self.at, self.name, &fields));
        }
    }

    fn may_lack(&self, name: &str) -> bool {
        self.section.location.is_some()
            && !self.section.incomplete
            && self.section.field(name).is_none()
            && !self.is_misspelt(name)
    }

    /// Whether an unknown field, which is reported by itself, was probably meant to be this one.
    fn is_misspelt(&self, name: &str) -> bool {
        let known: Vec<&str> = self.rules.iter().map(|rule| rule.name).collect();
        self.section.fields.iter().any(|field| {
            !known.contains(&field.name.as_str())
                && other_names::meant(&field.name)
                    .or_else(|| catalogue::nearest(&field.name, &known))
                    == Some(name)
        })
    }

    /// What to write for a field of this section that is given under another name.
    fn remedy(&self, field: &Field) -> Option<String> {
        let meant = other_names::meant(&field.name)?;
        let is_here = self.rules.iter().any(|rule| rule.name == meant);
        is_here.then(|| other_names::remedy(meant, field))
    }

    /// The field of this name, if it was written.
    pub fn field(&self, name: &str) -> Option<&'a Field> {
        self.section.field(name)
    }

    /// The field for messages: as written, or with its default.
    pub fn part(&self, name: &'static str, default: impl FnOnce() -> String) -> Part {
        match self.field(name) {
            Some(field) => Part {
                field: name,
                given: field.value.to_string(),
                location: field.location.clone(),
            },
            None => Part {
                field: name,
                given: format!("{} (default)", default()),
                location: self.at.clone(),
            },
        }
    }

    /// What `read` makes of each value of a list, or of the one value that stands for all; none where one is in
    /// error. `read` takes a reader in which that value stands alone.
    pub fn each<T>(
        &self,
        name: &'static str,
        mut read: impl FnMut(&Reader) -> Option<T>,
    ) -> Option<Vec<T>> {
        let field = self.field(name)?;
        let values = match &field.value {
            Value::List(values) => values.clone(),
            Value::Integers(numbers) => {
                let number = |number: &i64| {
                    plain_number(self.field_rule(name), &number.to_string(), &field.location)
                };
                numbers.iter().map(number).collect()
            }
            value => vec![value.clone()],
        };
        let read_one = |value| {
            let field = Field {
                value,
                ..field.clone()
            };
            let section = Section {
                location: Some(self.at.clone()),
                fields: vec![field],
                incomplete: true,
            };
            read(&Reader::new(
                self.name,
                &section,
                self.rules.clone(),
                &self.at,
            ))
        };
        // All are read, so that all errors are told at once.
        let read: Vec<Option<T>> = values.into_iter().map(read_one).collect();
        read.into_iter().collect()
    }

    fn field_rule<'n>(&self, name: &'n str) -> FieldRule<'n> {
        let rule = self.rules.iter().find(|rule| rule.name == name);
        FieldRule {
            name,
            rule: rule.copied(),
        }
    }

    fn rule(&self, name: &str) -> Option<(&'a Field, &'static Rule)> {
        let field = self.field(name)?;
        Some((field, self.field_rule(name).rule?))
    }

    /// The number of a field that takes one.
    fn number(&self, errors: &mut Collector, name: &'static str) -> Option<(Given<'a>, Kind)> {
        let (field, rule) = self.rule(name)?;
        let wanted = match rule.kind {
            Kind::Quantity { .. } => "a number with a unit",
            Kind::Plain { .. } => "a number",
            Kind::Integer { .. } | Kind::OneOf(_) => "a whole number",
            _ => return None,
        };
        match &field.value {
            Value::Number(number) => {
                let part = Part {
                    field: name,
                    given: number.to_string(),
                    location: field.location.clone(),
                };
                let given = Given {
                    si: number.si(),
                    dimension: number.unit.as_ref().map(|unit| unit.dimension),
                    basis: &number.basis,
                    number,
                    part,
                };
                Some((given, rule.kind))
            }
            Value::Malformed(_) => None,
            other => {
                let given = other.to_string();
                let (at, examples) = (&field.location, self.field_rule(name).examples(&[]));
                errors.push(catalogue::wrong_kind(at, name, &given, wanted, &examples));
                None
            }
        }
    }

    /// Reports a value outside its limits; returns whether it is inside.
    fn within(
        &self,
        errors: &mut Collector,
        given: &Given,
        [low, high]: [f64; 2],
        [low_text, high_text]: [String; 2],
    ) -> bool {
        // A decimal limit and the same value in another unit may differ in the last bit.
        let slack = 1e-9;
        let (at, name, text) = (&given.part.location, given.part.field, &given.part.given);
        if low >= 0.0 && (given.si < 0.0 || (given.si == 0.0 && low > 0.0)) {
            // Limits that only exclude zero are not shown.
            let bounded = high < f64::MAX;
            let error = if low > 0.0 && bounded {
                catalogue::not_positive(at, name, text, &low_text, &high_text)
            } else if bounded {
                catalogue::out_of_range(at, name, text, &low_text, &high_text)
            } else {
                catalogue::not_above_zero(
                    at,
                    name,
                    text,
                    &self.field_rule(name).examples(given.basis),
                )
            };
            errors.push(error);
            return false;
        }
        let inside = given.si >= low - slack * low.abs() && given.si <= high * (1.0 + slack);
        if !inside {
            // Only a number with a unit can have a wrong one.
            let error = match given.dimension {
                Some(_) => catalogue::out_of_range(at, name, text, &low_text, &high_text),
                None => catalogue::out_of_limits(at, name, text, &low_text, &high_text),
            };
            errors.push(error);
        }
        inside
    }

    /// A number with a unit, in SI, within its limits.
    pub fn quantity(&self, errors: &mut Collector, name: &'static str) -> Option<Given<'a>> {
        let (given, kind) = self.number(errors, name)?;
        let Kind::Quantity {
            dimensions,
            low,
            high,
        } = kind
        else {
            return None;
        };
        let (at, text, examples) = (
            &given.part.location,
            &given.part.given,
            self.field_rule(name).examples(given.basis),
        );
        let Some(dimension) = given.dimension else {
            errors.push(catalogue::missing_unit(at, name, text, &examples));
            return None;
        };
        if !dimensions.contains(&dimension) {
            let (got, wanted) = (dimension.name(), dimensions[0].name());
            errors.push(catalogue::wrong_dimension(
                at, name, text, got, wanted, &examples,
            ));
            return None;
        }
        self.within(
            errors,
            &given,
            [low, high],
            [
                quantity_text(low, dimension),
                quantity_text(high, dimension),
            ],
        )
        .then_some(given)
    }

    /// A quantity without basis words.
    pub fn plain_quantity(&self, errors: &mut Collector, name: &'static str) -> Option<Given<'a>> {
        let given = self.quantity(errors, name)?;
        refuse_basis(errors, &given, "remove the word").then_some(given)
    }

    /// A time or a number of control periods (bare or with its unit), without limits.
    pub fn timespan(&self, errors: &mut Collector, name: &'static str) -> Option<Given<'a>> {
        let (given, _) = self.number(errors, name)?;
        let (at, text) = (&given.part.location, &given.part.given);
        if let Some(dimension) = given.dimension
            && !matches!(dimension, Dimension::Time | Dimension::Periods)
        {
            let wanted = "a time or a number of periods";
            let (got, examples) = (dimension.name(), self.field_rule(name).examples(&[]));
            errors.push(catalogue::wrong_dimension(
                at, name, text, got, wanted, &examples,
            ));
            return None;
        }
        refuse_basis(errors, &given, "remove the word").then_some(given)
    }

    /// As [`Self::plain_quantity`], or the default.
    pub fn plain_quantity_or_preset(&self, errors: &mut Collector, name: &'static str) -> f64 {
        let given = self.plain_quantity(errors, name);
        given.map_or_else(|| self.preset_number(name), |given| given.si)
    }

    /// A number without unit, within its limits.
    pub fn plain(&self, errors: &mut Collector, name: &'static str) -> Option<Given<'a>> {
        let (given, kind) = self.number(errors, name)?;
        let Kind::Plain { low, high } = kind else {
            return None;
        };
        (refuse_unit(errors, &given)
            && self.within(
                errors,
                &given,
                [low, high],
                [significant(low), significant(high)],
            ))
        .then_some(given)
    }

    /// A whole number without unit, within its limits.
    pub fn integer(&self, errors: &mut Collector, name: &'static str) -> Option<u32> {
        let (given, kind) = self.number(errors, name)?;
        if !matches!(kind, Kind::Integer { .. } | Kind::OneOf(_)) || !refuse_unit(errors, &given) {
            return None;
        }
        if given.number.digits.contains(['.', 'e', 'E']) {
            let (at, text, examples) = (
                &given.part.location,
                &given.part.given,
                self.field_rule(name).examples(&[]),
            );
            errors.push(catalogue::wrong_kind(
                at,
                name,
                text,
                "a whole number",
                &examples,
            ));
            return None;
        }
        let is_taken = match kind {
            Kind::OneOf(numbers) => is_one_of(errors, &given, numbers),
            Kind::Integer { low, high } => {
                let limits = [f64::from(low), f64::from(high)];
                self.within(errors, &given, limits, [low.to_string(), high.to_string()])
            }
            _ => false,
        };
        is_taken.then_some(given.si as u32)
    }

    /// As [`Self::integer`], or the default.
    pub fn integer_or_preset(&self, errors: &mut Collector, name: &'static str) -> u32 {
        self.integer(errors, name)
            .unwrap_or_else(|| self.preset_number(name) as u32)
    }

    /// A word that is `on` or `off`.
    pub fn switch(&self, errors: &mut Collector, name: &'static str) -> Option<bool> {
        self.choice(errors, name, &[])
    }

    /// A word of the option's table. `planned`: words that are known but not available.
    pub fn choice<T: Words>(
        &self,
        errors: &mut Collector,
        name: &'static str,
        planned: &[&str],
    ) -> Option<T> {
        let words: Vec<&str> = T::WORDS.iter().map(|known| known.word).collect();
        if let Some(field) = self.field(name)
            && let Value::Word(given) = &field.value
            && planned.contains(&given.as_str())
        {
            errors.push(catalogue::option_unavailable(
                &field.location,
                name,
                given,
                &words,
            ));
            return None;
        }
        let choices: Vec<(&str, T)> = words.into_iter().zip(T::CHOICES.iter().copied()).collect();
        self.word(errors, name, &choices)
    }

    /// As [`Self::choice`], or the default.
    pub fn choice_or_preset<T: Words>(
        &self,
        errors: &mut Collector,
        name: &'static str,
        planned: &[&str],
    ) -> T {
        self.choice(errors, name, planned)
            .unwrap_or_else(|| match self.preset(name) {
                Some(Preset::Value(word)) => T::from_word(word).unwrap_or(T::CHOICES[0]),
                _ => T::CHOICES[0],
            })
    }

    fn preset(&self, name: &str) -> Option<Preset> {
        Some(self.field_rule(name).rule?.preset)
    }

    /// The default of a number, in SI units; NaN where the table has none (excluded by a test).
    pub fn preset_number(&self, name: &'static str) -> f64 {
        let Some(Preset::Value(text)) = self.preset(name) else {
            return f64::NAN;
        };
        match parse_value(self.field_rule(name), text, &self.at) {
            Value::Number(number) => number.si(),
            _ => f64::NAN,
        }
    }

    /// One of some words.
    pub fn word<T: Copy>(
        &self,
        errors: &mut Collector,
        name: &'static str,
        choices: &[(&str, T)],
    ) -> Option<T> {
        let (field, _) = self.rule(name)?;
        let given = match &field.value {
            Value::Malformed(_) => return None,
            Value::Word(word) => word.clone(),
            other => other.to_string(),
        };
        let plain = given.replace('-', "_").to_lowercase();
        let other = other_names::word(&plain);
        let found = choices
            .iter()
            .find(|(word, _)| *word == plain || Some(*word) == other)
            .map(|(_, choice)| *choice);
        if found.is_none() {
            let known: Vec<&str> = choices.iter().map(|(word, _)| *word).collect();
            errors.push(catalogue::unknown_word(
                &field.location,
                name,
                &given,
                &known,
            ));
        }
        found
    }

    /// A list of integers.
    pub fn integers(
        &self,
        errors: &mut Collector,
        name: &'static str,
    ) -> Option<(&'a [i64], Part)> {
        let (field, _) = self.rule(name)?;
        let part = Part {
            field: name,
            given: field.value.to_string(),
            location: field.location.clone(),
        };
        match &field.value {
            Value::Integers(list) => Some((list, part)),
            Value::Malformed(_) => None,
            _ => {
                let wanted = "a list of whole numbers";
                let (at, examples) = (&part.location, self.field_rule(name).examples(&[]));
                errors.push(catalogue::wrong_kind(
                    at,
                    name,
                    &part.given,
                    wanted,
                    &examples,
                ));
                None
            }
        }
    }

    /// Free text.
    pub fn text(&self, name: &str) -> Option<&'a str> {
        match &self.field(name)?.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }
}

/// Reports basis words where none can be; returns whether there are none.
fn refuse_basis(errors: &mut Collector, given: &Given, remedy: &str) -> bool {
    if let Some(basis) = given.basis.first() {
        // Without the word the number would be another quantity.
        let is_other = matches!(basis, Basis::Rms | Basis::BlockMean);
        let remedy = if is_other { "give the peak" } else { remedy };
        let (at, text) = (&given.part.location, &given.part.given);
        errors.push(catalogue::wrong_basis(
            at,
            given.part.field,
            text,
            basis.word(),
            remedy,
        ));
    }
    given.basis.is_empty()
}

/// Reports unit and basis on a plain number; returns whether there are none.
fn refuse_unit(errors: &mut Collector, given: &Given) -> bool {
    let plain = given.dimension.is_none() && given.basis.is_empty();
    if !plain {
        let (at, text) = (&given.part.location, &given.part.given);
        let digits = &given.number.digits;
        errors.push(catalogue::unwanted_unit(at, given.part.field, text, digits));
    }
    plain
}

/// Reports a number that is not in the list; returns whether it is.
fn is_one_of(errors: &mut Collector, given: &Given, numbers: &[u32]) -> bool {
    let found = numbers.iter().any(|number| f64::from(*number) == given.si);
    if !found {
        let numbers: Vec<String> = numbers.iter().map(u32::to_string).collect();
        let numbers: Vec<&str> = numbers.iter().map(String::as_str).collect();
        let part = &given.part;
        errors.push(catalogue::not_one_of(
            &part.location,
            part.field,
            &part.given,
            &numbers,
        ));
    }
    found
}

/// A limit for messages, in the field's usual unit.
pub(crate) fn quantity_text(si: f64, dimension: Dimension) -> String {
    match dimension {
        Dimension::Resistance => engineering(si, "ohm"),
        Dimension::Inductance => engineering(si, "H"),
        Dimension::Current => engineering(si, "A"),
        Dimension::Voltage => engineering(si, "V"),
        Dimension::Time => engineering(si, "s"),
        Dimension::Frequency => engineering(si, "Hz"),
        Dimension::Speed => rpm(si),
        Dimension::EmfConstant => engineering(si, "V/(rad/s)"),
        Dimension::SpeedConstant => engineering(si, "(rad/s)/V"),
        Dimension::FluxLinkage => engineering(si, "Wb"),
        Dimension::Torque => engineering(si, "Nm"),
        Dimension::TorqueConstant => engineering(si, "Nm/A"),
        Dimension::Inertia => format!("{} kg m2", significant(si)),
        Dimension::Angle => format!("{} deg", significant(si)),
        Dimension::Ratio => percent(si),
        Dimension::CurrentPerCount => engineering(si, "A/count"),
        Dimension::CurrentRate => engineering(si, "A/s"),
        Dimension::Periods if si == 1.0 => "1 period".to_owned(),
        Dimension::Periods => format!("{} periods", significant(si)),
    }
}
