//! Access to the fields of a section under their rules, and the checks of its names.
//!
//! Values, checked one by one and in SI units, are read in `values`.

mod other_names;
mod values;

pub(crate) use values::{Given, quantity_text};

use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, Location, nearest};
use crate::spec::ast::{Field, Section, Value};
use crate::spec::field_rule::FieldRule;
use crate::spec::rule::Rule;
use crate::spec::value::plain_number;

/// One section's fields under their rules.
pub(crate) struct Reader<'a> {
    name: &'static str,
    section: &'a Section,
    rules: Vec<&'static Rule>,
    /// Where missing fields are reported.
    at: Location,
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

    /// Reports missing fields of a section, each with an example, that the `value` of another one needs.
    pub fn require_beside(
        &self,
        errors: &mut Collector,
        [of, value]: [&str; 2],
        (section, fields): (&str, &[(&str, &str)]),
    ) {
        for (name, example) in fields {
            if self.may_lack(name) {
                let at = self.field(of).map_or(&self.at, |field| &field.location);
                let setting = format!("{of}: {value}");
                errors.push(catalogue::needed_field(
                    at,
                    &setting,
                    [section, name, example],
                ));
            }
        }
    }

    /// Reports fields that have an effect only with another `setting`.
    pub fn refuse_without(&self, errors: &mut Collector, setting: &str, names: &[&str]) {
        let contrary = setting.split_once(": ");
        let contrary = contrary.and_then(|(name, _)| self.field(name));
        let contrary = contrary.map(|field| (field, field.value.to_string()));
        for name in names {
            if let Some(field) = self.field(name) {
                let (at, given) = (&field.location, shortened(&field.value.to_string()));
                let contrary = contrary.as_ref();
                let contrary = contrary
                    .map(|(other, value)| (other.name.as_str(), value.as_str(), &other.location));
                errors.push(catalogue::needless_field(
                    at, name, &given, setting, contrary,
                ));
            }
        }
    }

    /// Reports a missing field whose words are a matter of the hardware; each with its meaning.
    pub fn require_choice(&self, errors: &mut Collector, name: &str, words: &[(&str, &str)]) {
        if self.may_lack(name) {
            errors.push(catalogue::missing_choice(&self.at, self.name, name, words));
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
            let rules = names.iter().map(|name| self.field_rule(name));
            let fields: Vec<(&str, String)> = rules.map(|rule| (rule.name, rule.form())).collect();
            errors.push(catalogue::missing_alternative(&self.at, self.name, &fields));
        }
    }

    /// Whether the field is missing without another error that says why.
    pub fn may_lack(&self, name: &str) -> bool {
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
                && !other_names::is_unused(&field.name)
                && other_names::meant(&field.name).or_else(|| nearest(&field.name, &known))
                    == Some(name)
        })
    }

    /// What to do about a field of this section that is given under another name, or that nothing takes.
    fn remedy(&self, field: &Field) -> Option<String> {
        if other_names::is_unused(&field.name) {
            return Some("no controller needs this value; leave it out".to_owned());
        }
        if field.name == "controller" {
            let kind = match &field.value {
                Value::Word(word) => word,
                _ => "pdcc",
            };
            return Some(format!(
                "the controller stands elsewhere: in a file it is the `kind` of the section `controller`, in a call it stands beside `motor`, and `hexagen new` takes `kind={kind}`"
            ));
        }
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
        // Up to the first in error: what one value lacks, such as its unit, the others mostly lack, too.
        values.into_iter().map(read_one).collect()
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

    /// Free text.
    pub fn text(&self, name: &str) -> Option<&'a str> {
        match &self.field(name)?.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }
}

/// The beginning of a long value, as of a list of samples.
fn shortened(value: &str) -> String {
    const MOST: usize = 40;
    if value.chars().count() <= MOST {
        return value.to_owned();
    }
    let mut begin: String = value.chars().take(MOST).collect();
    begin.push('…');
    begin
}
