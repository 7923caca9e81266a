//! Documentation of each field where an editor shows it, in Markdown: that of a motor's or
//! inverter's field is its row of the reference page, that of an option its row of the table.

use super::controller::{KINDS, Kind, common};
use super::fields::{INVERTER, MOTOR};
use super::option_texts::{default, sentence, values};
use super::rule::Rule;

/// The page that explains the fields of motor and inverter.
const REFERENCE: &str = include_str!("reference.md");

/// A field with its documentation.
#[derive(Clone, Debug)]
pub(crate) struct FieldText {
    /// The field's name.
    pub name: &'static str,
    /// A value that it takes.
    pub example: &'static str,
    /// Its documentation.
    pub text: String,
}

/// The fields of `motor` or `inverter`.
pub(crate) fn section_texts(section: &str) -> Vec<FieldText> {
    let rules = if section == "motor" { MOTOR } else { INVERTER };
    let text = |rule: &Rule| FieldText {
        name: rule.name,
        example: rule.example,
        text: field_text(section, rule),
    };
    rules.iter().map(text).collect()
}

/// The options that several kinds of controllers share.
pub(crate) fn shared_texts() -> Vec<FieldText> {
    let rows = common::SHARED.into_iter().flat_map(|(_, rows)| rows);
    let rules = rows.map(|row| &row.rule);
    rules.map(|rule| option_text("controller", rule)).collect()
}

/// The options of one kind alone.
pub(crate) fn own_texts(kind: &Kind) -> Vec<FieldText> {
    let rules = (kind.own)().into_iter();
    rules.map(|rule| option_text(kind.name, rule)).collect()
}

/// The kinds of controllers.
pub(crate) fn kind_texts() -> Vec<FieldText> {
    let text = |kind: &Kind| FieldText {
        name: kind.name,
        example: kind.name,
        text: paragraphs([format!("{}.", sentence(kind.title)), kind.notes.to_owned()]),
    };
    KINDS.iter().map(text).collect()
}

fn field_text(section: &str, rule: &Rule) -> String {
    let example = format!("Example: `{}: {}`.", rule.name, rule.example);
    let Some([names, value, default]) = row_of(section, rule.name) else {
        return paragraphs([format!("`{}` of the {section}.", rule.name), example]);
    };
    let default = match default {
        "" => String::new(),
        needed if needed.contains("needed") => format!("Default: none, {needed}."),
        default => format!("Default: {default}."),
    };
    let value = without_links(value);
    paragraphs([
        format!("{names} of the {section}: {value}."),
        default,
        example,
    ])
}

fn option_text(of: &str, rule: &Rule) -> FieldText {
    let text = paragraphs([
        format!("`{}` of `{of}`: {}.", rule.name, rule.about),
        format!("Values: {}.", values(rule)),
        format!("Default: {}.", default(rule)),
        format!("Example: `{}: {}`.", rule.name, rule.example),
    ]);
    FieldText {
        name: rule.name,
        example: rule.example,
        text,
    }
}

fn paragraphs<const N: usize>(paragraphs: [String; N]) -> String {
    let mut paragraphs = Vec::from(paragraphs);
    paragraphs.retain(|text| !text.is_empty());
    paragraphs.join("\n\n")
}

/// The row of the reference page that has a field in its first column: names, value, default.
fn row_of(section: &str, name: &str) -> Option<[&'static str; 3]> {
    let (_, part) = REFERENCE.split_once(&format!("\n## {section}\n"))?;
    let part = part.split("\n## ").next()?;
    let name = format!("`{name}`");
    part.lines().find_map(|line| {
        let cells = line.strip_prefix("| ")?.strip_suffix('|')?;
        let cells: Vec<&'static str> = cells.split(" | ").map(str::trim).collect();
        let row: [&str; 3] = cells.try_into().ok()?;
        row[0].contains(&name).then_some(row)
    })
}

/// Links lead to other parts of the page, which an editor does not show: their words are left.
fn without_links(text: &str) -> String {
    let mut rest = text;
    let mut plain = String::new();
    while let Some((before, target)) = rest.split_once("](#") {
        let (words, behind) = (before, target.split_once(')').map_or("", |(_, rest)| rest));
        plain.extend(words.rsplitn(2, '[').collect::<Vec<_>>().into_iter().rev());
        rest = behind;
    }
    plain + rest
}

#[cfg(test)]
mod tests {
    use super::{row_of, section_texts, shared_texts, without_links};

    /// A drive's name is the type's in a macro call; the page says it in its text.
    #[test]
    fn the_reference_page_has_a_row_for_every_field() {
        for section in ["motor", "inverter"] {
            for field in section_texts(section) {
                let row = row_of(section, field.name);
                assert!(row.is_some() || field.name == "name", "{}", field.name);
            }
        }
    }

    #[test]
    fn fields_say_value_default_and_example() {
        let motor = section_texts("motor");
        let resistance = motor.iter().find(|field| field.name == "resistance");
        let text = &resistance.expect("is a field").text;
        assert!(
            text.starts_with("`resistance` of the motor: ohm with `per_phase`"),
            "{text}"
        );
        assert!(
            text.ends_with(
                "\n\nDefault: none, needed.\n\nExample: `resistance: 135 mohm per_phase`."
            ),
            "{text}"
        );
        let emf = &shared_texts()[0].text;
        assert!(
            emf.contains("\n\nValues: `estimated` (from the voltage"),
            "{emf}"
        );
    }

    #[test]
    fn links_to_the_page_become_words() {
        let text = "one or [one of each](#current-sensors), [too](#too)";
        assert_eq!(without_links(text), "one or one of each, too");
    }
}
