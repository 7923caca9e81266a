//! Texts about the options: the program's help, and the page `options.md`, which a test writes.

use super::controller::{self, KINDS};
use super::reader::quantity_text;
use super::rule::{Kind, Preset, Rule};
use super::words::Word;
use crate::diagnostics::significant;

/// The options of all controllers, a line each, for a terminal.
pub fn help() -> String {
    let line = |rule: &Rule| {
        format!(
            "    {}={}  [default: {}]\n",
            rule.name,
            spelt(rule),
            plain(&default(rule))
        )
    };
    let mut text = String::new();
    for kind in &KINDS {
        text.extend([format!("  {}: {}\n", kind.name, kind.title)]);
        text.extend(
            kind.notes
                .lines()
                .map(|note| format!("    {}\n", plain(note))),
        );
        text.extend((kind.own)().into_iter().map(line));
    }
    for (_, rules) in shared() {
        let takers = takers(&rules);
        let takers = if takers.len() == KINDS.len() {
            "all".to_owned()
        } else {
            takers.join(", ")
        };
        text.extend([format!("  {takers}:\n")]);
        text.extend(rules.into_iter().map(line));
    }
    text
}

/// The groups of shared options, with what each is for.
fn shared() -> impl Iterator<Item = (&'static str, Vec<&'static Rule>)> {
    let groups = controller::common::SHARED.into_iter();
    groups.map(|(what, rows)| (what, rows.iter().map(|row| &row.rule).collect()))
}

/// The controllers that take all of these.
fn takers(rules: &[&Rule]) -> Vec<&'static str> {
    let takes = |kind: &&controller::Kind| {
        let names: Vec<&str> = kind.rules().iter().map(|rule| rule.name).collect();
        rules.iter().all(|rule| names.contains(&rule.name))
    };
    KINDS.iter().filter(takes).map(|kind| kind.name).collect()
}

/// The words with their meanings, or the range.
pub(super) fn values(rule: &Rule) -> String {
    let listed = |words: &[Word]| {
        let words = words.iter().map(|word| match word.meaning {
            "" => format!("`{}`", word.word),
            meaning => format!("`{}` ({meaning})", word.word),
        });
        words.collect::<Vec<_>>().join(", ")
    };
    match rule.kind {
        Kind::Choice(words) => listed(words),
        Kind::ChoiceOrList(words) => format!("{}, or a list of whole numbers", listed(words)),
        Kind::Plain { low, high } => format!("{} to {}", significant(low), significant(high)),
        Kind::Integer { low, high } if high == low + 1 => format!("{low} or {high}"),
        Kind::Integer { low, high } => format!("{low} to {high}"),
        Kind::OneOf(numbers) => {
            let numbers: Vec<String> = numbers.iter().map(u32::to_string).collect();
            numbers.join(" or ")
        }
        Kind::Quantity {
            dimensions,
            low,
            high,
        } => {
            let names: Vec<&str> = dimensions
                .iter()
                .map(|dimension| dimension.name())
                .collect();
            let [low, high] = [low, high].map(|limit| quantity_text(limit, dimensions[0]));
            format!("{}, {low} to {high}", names.join(" or "))
        }
        Kind::Word | Kind::Integers | Kind::Text => format!("`{}`", rule.example),
    }
}

/// The values as they are written.
fn spelt(rule: &Rule) -> String {
    match rule.kind {
        Kind::Choice(words) => alternatives(words),
        Kind::ChoiceOrList(words) => format!("{}|[...]", alternatives(words)),
        _ => format!("<{}>", plain(&values(rule))),
    }
}

fn alternatives(words: &[Word]) -> String {
    let words: Vec<&str> = words.iter().map(|word| word.word).collect();
    words.join("|")
}

/// The default, in Markdown.
pub(super) fn default(rule: &Rule) -> String {
    match rule.preset {
        Preset::Value(value) => format!("`{value}`"),
        Preset::Rule(text, _) => text.to_owned(),
        Preset::Off(effect) => format!("none: {effect}"),
        Preset::Checked => "needed".to_owned(),
    }
}

/// A phrase as a sentence begins.
pub(super) fn sentence(phrase: &str) -> String {
    let mut letters = phrase.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}

fn plain(markdown: &str) -> String {
    markdown.replace('`', "")
}

#[cfg(test)]
mod tests {
    use super::{KINDS, controller, default, help, sentence, shared, takers, values};
    use crate::diagnostics::Location;
    use crate::spec::ast::Value;
    use crate::spec::fields;
    use crate::spec::rule::{Kind, Preset, Rule};
    use crate::spec::value::parse_value;
    use std::path::Path;

    /// The reference page of the options, in Markdown: `options.md`.
    fn reference() -> String {
        let mut text = String::from("## controller\n");
        for (what, rules) in shared() {
            let takers = takers(&rules);
            let takers = if takers.len() == KINDS.len() {
                "all controllers".to_owned()
            } else {
                format!("`{}`", takers.join("`, `"))
            };
            text.extend([format!("\n{what} that {takers} take:\n\n")]);
            text.push_str(&table(rules));
        }
        for kind in &KINDS {
            text.extend([format!(
                "\n### controller: {}\n\n{}.\n",
                kind.name,
                sentence(kind.title)
            )]);
            if !kind.notes.is_empty() {
                text.extend([format!("{}\n", kind.notes)]);
            }
            text.push('\n');
            text.push_str(&table((kind.own)()));
        }
        text.push_str("\n## Defaults by rule\n\nThese options follow from others where they are not stated. `hexagen check` and the data sheet print why;\n`hexagen advise` compares the choice with others on a motor.\n\n| option | controller | default | why |\n|---|---|---|---|\n");
        let own = KINDS
            .iter()
            .flat_map(|kind| (kind.own)().into_iter().map(|rule| (kind.name, rule)));
        let rules = shared().flat_map(|(_, rules)| rules);
        let all = rules.map(|rule| ("all that take it", rule)).chain(own);
        text.extend(all.filter_map(|(kind, rule)| chosen(kind, rule)));
        text
    }

    /// The row of a default by rule.
    fn chosen(kind: &str, rule: &Rule) -> Option<String> {
        let Preset::Rule(text, reasons) = rule.preset else {
            return None;
        };
        let reasons = reasons.iter().map(|(value, why)| match *value {
            "" => (*why).to_owned(),
            value => format!("`{value}`: {why}"),
        });
        let reasons: Vec<String> = reasons.collect();
        let reasons = reasons.join("; ");
        Some(format!(
            "| `{}` | {kind} | {text} | {reasons} |\n",
            rule.name
        ))
    }

    fn table<'r>(rules: impl IntoIterator<Item = &'r Rule>) -> String {
        let mut text = String::from("| option | value | default | meaning |\n|---|---|---|---|\n");
        for rule in rules {
            let row = format!(
                "| `{}` | {} | {} | {} |\n",
                rule.name,
                values(rule),
                default(rule),
                rule.about
            );
            text.push_str(&row);
        }
        text
    }

    /// `INSTA_UPDATE=always` writes the page, as it does snapshots.
    #[test]
    fn the_reference_page_is_the_table() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/spec/options.md");
        if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
            std::fs::write(&path, reference()).expect("the page can be written");
        }
        let page = std::fs::read_to_string(&path).expect("there is a page");
        assert!(
            page == reference(),
            "run this test with INSTA_UPDATE=always, and look at the difference"
        );
    }

    #[test]
    fn every_option_is_in_the_help_and_on_the_page() {
        for rule in KINDS.iter().flat_map(controller::Kind::rules) {
            let in_help = help().contains(&format!("\n    {}=", rule.name));
            let on_page = reference().contains(&format!("\n| `{}` |", rule.name));
            assert!(in_help && on_page, "{}", rule.name);
        }
    }

    #[test]
    fn every_option_has_a_meaning_and_a_default_that_it_takes() {
        let at = Location::Variant {
            text: String::new(),
            column: 1,
        };
        for rule in KINDS.iter().flat_map(controller::Kind::rules) {
            assert!(!rule.about.is_empty(), "{}", rule.name);
            let value = match rule.preset {
                Preset::Value(text) => parse_value(fields::field(rule.name), text, &at),
                Preset::Rule(text, reasons) => {
                    assert!(!text.is_empty() && !reasons.is_empty(), "{}", rule.name);
                    for (value, why) in reasons {
                        let words = rule.words();
                        let is_known = words.iter().any(|word| word.word == *value);
                        assert!(words.is_empty() || is_known, "{}: {value}", rule.name);
                        assert!(!why.is_empty(), "{}", rule.name);
                    }
                    continue;
                }
                Preset::Off(effect) => {
                    assert!(!effect.is_empty(), "{}", rule.name);
                    continue;
                }
                Preset::Checked => panic!("{} has no default", rule.name),
            };
            let is_taken = match (&value, rule.kind) {
                (Value::Word(word), Kind::Choice(words) | Kind::ChoiceOrList(words)) => {
                    words.iter().any(|known| known.word == word)
                }
                (Value::Word(_), Kind::Word) => true,
                (Value::Number(number), Kind::Plain { low, high }) => {
                    (low..=high).contains(&number.si())
                }
                (
                    Value::Number(number),
                    Kind::Quantity {
                        low,
                        high,
                        dimensions,
                    },
                ) => {
                    let dimension = number.unit.as_ref().map(|unit| unit.dimension);
                    (low..=high).contains(&number.si())
                        && dimension.is_some_and(|given| dimensions.contains(&given))
                }
                (Value::Number(number), Kind::Integer { low, high }) => {
                    (f64::from(low)..=f64::from(high)).contains(&number.si())
                }
                _ => false,
            };
            assert!(is_taken, "{}: {value}", rule.name);
        }
    }
}
