//! Values of fields, each checked by itself and in SI units.

use super::{Reader, other_names};
use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, engineering, percent, rpm, significant};
use crate::spec::ast::{Basis, Number, Value};
use crate::spec::rule::{Kind, Preset, Rule};
use crate::spec::units::Dimension;
use crate::spec::value::parse_value;
use crate::spec::words::Words;

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

/// Few motors have so many volts to a rad/s between two terminals: it makes a kilovolt at 1000 rpm.
const MOST_EMF: f64 = 10.0;

impl<'a> Reader<'a> {
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
                catalogue::out_of_range(at, name, text, [&low_text, &high_text], None)
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
                Some(_) => {
                    let unit = given.number.unit.as_ref();
                    let other =
                        unit.and_then(|unit| unit.of_other_prefix(given.number.value, [low, high]));
                    let words: Vec<&str> = given.basis.iter().map(|basis| basis.word()).collect();
                    let meant = other.map(|other| {
                        [&given.number.digits, other, &words.join(" ")]
                            .join(" ")
                            .trim_end()
                            .to_owned()
                    });
                    let limits = [low_text.as_str(), high_text.as_str()];
                    catalogue::out_of_range(at, name, text, limits, meant.as_deref())
                }
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
        let (at, text, right) = (
            &given.part.location,
            &given.part.given,
            self.field_rule(name).unit_to_give(given.basis),
        );
        let Some(dimension) = given.dimension else {
            errors.push(catalogue::missing_unit(at, name, text, &right));
            return None;
        };
        if !dimensions.contains(&dimension) {
            let (got, wanted) = (dimension.name(), dimensions[0].name());
            let is_absurd = dimension == Dimension::EmfConstant && given.si > MOST_EMF;
            let of_one_rpm = is_absurd.then(|| catalogue::emf_of_one_rpm(at, name, text));
            errors.push(
                match (of_one_rpm.flatten(), other_names::of_emf(name, dimension)) {
                    (Some(error), Some(_)) => error,
                    (None, Some(meant)) => {
                        catalogue::quantity_of_other_field(at, name, text, got, meant)
                    }
                    (_, None) => catalogue::wrong_dimension(at, name, text, got, wanted, &right),
                },
            );
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

    /// Reads a number by its rule for its errors alone.
    pub fn read_number(&self, errors: &mut Collector, rule: &Rule) {
        match rule.kind {
            Kind::Quantity { .. } => drop(self.plain_quantity(errors, rule.name)),
            Kind::Plain { .. } => drop(self.plain(errors, rule.name)),
            Kind::Integer { .. } | Kind::OneOf(_) => drop(self.integer(errors, rule.name)),
            _ => {}
        }
    }

    /// A time or a number of control periods (bare or with its unit), without limits.
    pub fn timespan(&self, errors: &mut Collector, name: &'static str) -> Option<Given<'a>> {
        let (given, _) = self.number(errors, name)?;
        let (at, text) = (&given.part.location, &given.part.given);
        if let Some(dimension) = given.dimension
            && !matches!(dimension, Dimension::Time | Dimension::Periods)
        {
            let wanted = "a time or a number of periods";
            let (got, right) = (dimension.name(), self.field_rule(name).unit_to_give(&[]));
            errors.push(catalogue::wrong_dimension(
                at, name, text, got, wanted, &right,
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
            Value::Number(number) if choices.iter().all(|(word, _)| *word != number.digits) => {
                let words: Vec<String> =
                    choices.iter().map(|(word, _)| (*word).to_owned()).collect();
                let (at, given) = (&field.location, number.to_string());
                errors.push(catalogue::wrong_kind(at, name, &given, "a word", &words));
                return None;
            }
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
                other_names::kin(&plain, &known),
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
}

/// Reports basis words where none can be; returns whether there are none.
fn refuse_basis(errors: &mut Collector, given: &Given, remedy: &str) -> bool {
    if let Some(basis) = given.basis.first() {
        // Without the word the number would be another quantity.
        let is_other = matches!(basis, Basis::Rms | Basis::PeakToPeak | Basis::BlockMean);
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
        Dimension::Sensitivity => engineering(si, "V/A"),
        Dimension::CurrentRate => engineering(si, "A/s"),
        Dimension::SpeedRate => format!("{}/s", rpm(si)),
        Dimension::Periods if si == 1.0 => "1 period".to_owned(),
        Dimension::Periods => format!("{} periods", significant(si)),
    }
}
