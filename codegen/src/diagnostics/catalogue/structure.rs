//! Texts about the structure of a specification: syntax, sections, fields, files.

use super::part::{Part, with_parts};
use crate::diagnostics::{
    Code, Diagnostic, Location, did_you_mean_one, enumerated, list, nearest, significant, similar,
};
use std::f64::consts::PI;

/// The macro call or the file does not parse; `what` is the parser's message.
pub fn syntax(at: &Location, what: &str) -> Diagnostic {
    Diagnostic::new(Code::Syntax, at, what)
}

/// A section that does not exist; `of_fields`: the one whose fields it has.
pub fn unknown_section(
    at: &Location,
    name: &str,
    known: &[&str],
    of_fields: Option<&str>,
) -> Diagnostic {
    let mut advice = did_you_mean(name, known);
    if let Some(right) = of_fields.filter(|_| advice.is_empty()) {
        advice =
            format!("; its fields are those of `{right}`, so call it that, or move them there");
        if name == "board" && right == "inverter" {
            advice.push_str(
                ", or name a board of the library above the sections, as `board: vesc-4`",
            );
        }
    }
    Diagnostic::new(
        Code::UnknownSection,
        at,
        format!(
            "unknown section `{name}`; the sections are {}{advice}",
            list(known, "and"),
        ),
    )
}

/// An option of a board's file that is not its core's.
pub fn option_of_board(at: &Location, name: &str, of_core: &[&str]) -> Diagnostic {
    Diagnostic::new(
        Code::MisplacedField,
        at,
        format!(
            "a board's `controller` has no field `{name}`, only {}; move it to a motor's",
            list(of_core, "and")
        ),
    )
}

/// A board's file in place of a motor's.
pub fn board_for_motor(at: &Location) -> Diagnostic {
    Diagnostic::new(
        Code::UnknownSection,
        at,
        "this is a board's file, without a motor; name it as `board` of a motor's file, or give it as `--board` beside a motor",
    )
}

/// A section's name with a value instead of fields.
pub fn not_a_section(at: &Location, name: &str) -> Diagnostic {
    Diagnostic::new(
        Code::Syntax,
        at,
        format!("`{name}` is a section; write `[{name}]` and its fields below"),
    )
}

/// An assumed value without value or reason; `values` are examples of the value.
pub fn assumption(at: &Location, field: &str, values: &[String]) -> Diagnostic {
    let examples: Vec<String> = values
        .iter()
        .map(|value| {
            format!("{field}: {{ value = \"{value}\", reason = \"not in the data sheet\" }}")
        })
        .collect();
    Diagnostic::new(
        Code::MalformedValue,
        at,
        format!(
            "`{field}`: an assumption needs a value and a reason; write it like {}",
            list(&examples, "or")
        ),
    )
}

/// A field that does not exist in its section.
pub fn unknown_field(at: &Location, section: &str, name: &str, known: &[&str]) -> Diagnostic {
    /// More names than a reader looks through.
    const MANY: usize = 16;
    let mut advice = did_you_mean(name, known);
    if advice.is_empty() {
        advice = if known.len() > MANY {
            "; `hexagen new FILE` writes a file that names the fields, and `hexagen::specification` in the documentation explains each".to_owned()
        } else {
            format!("; it takes {}", list(known, "and"))
        };
    }
    Diagnostic::new(
        Code::UnknownField,
        at,
        format!("`{section}` has no field `{name}`{advice}"),
    )
}

/// A field under another name common in data sheets; `remedy` is a clause.
pub fn other_name(at: &Location, section: &str, name: &str, remedy: &str) -> Diagnostic {
    Diagnostic::new(
        Code::UnknownField,
        at,
        format!("`{section}` has no field `{name}`; {remedy}"),
    )
}

/// A field that belongs to another section.
pub fn misplaced_field(at: &Location, section: &str, name: &str, right: &str) -> Diagnostic {
    let message = match at {
        // Nothing but a controller and its options can be given there.
        Location::Variant { .. } => {
            let of_board = if right == "inverter" {
                ", or in the board's"
            } else {
                ""
            };
            format!(
                "`{name}` is a field of `{right}`, not an option of the controller; state it in the motor's file{of_board}"
            )
        }
        Location::Macro(_) | Location::File { .. } => {
            format!("`{section}` has no field `{name}`; move it to `{right}`")
        }
    };
    Diagnostic::new(Code::MisplacedField, at, message)
}

/// A field or section given twice.
pub fn duplicate_field(at: &Location, first: &Location, name: &str) -> Diagnostic {
    Diagnostic::new(
        Code::DuplicateField,
        at,
        format!("`{name}` is given twice; keep one of the two"),
    )
    .with_note(first, format!("`{name}` is given here first"))
}

/// A field without default is missing.
pub fn missing_field(at: &Location, section: &str, name: &str, examples: &[String]) -> Diagnostic {
    Diagnostic::new(
        Code::MissingField,
        at,
        format!(
            "`{section}` lacks the field `{name}`; add it, for example {}",
            assignments(name, examples)
        ),
    )
}

/// A field without default is missing, of which each word needs its meaning to be chosen.
pub fn missing_choice(
    at: &Location,
    section: &str,
    name: &str,
    words: &[(&str, &str)],
) -> Diagnostic {
    let choices: Vec<String> = words
        .iter()
        .map(|(word, meaning)| format!("`{name}: {word}` ({meaning})"))
        .collect();
    Diagnostic::new(
        Code::MissingField,
        at,
        format!(
            "`{section}` lacks the field `{name}`; add {}",
            choices.join(" or ")
        ),
    )
}

/// A value of one winding without the connection of the windings.
pub fn missing_winding(value: &Part) -> Diagnostic {
    Diagnostic::new(
        Code::MissingField,
        &value.location,
        format!(
            "`{}`: {} is of one winding, and `motor` lacks the field `winding`; add `winding: star` or `winding: delta`, or write `terminal` if it was measured between two terminals",
            value.field, value.given,
        ),
    )
}

/// A field without its value.
pub fn missing_value(at: &Location, name: &str, examples: &[String]) -> Diagnostic {
    Diagnostic::new(
        Code::Syntax,
        at,
        format!(
            "`{name}` has no value; write for example {}",
            assignments(name, examples)
        ),
    )
}

/// `` `name: a` or `name: b` ``.
fn assignments(name: &str, values: &[String]) -> String {
    let all: Vec<String> = values
        .iter()
        .map(|value| format!("{name}: {value}"))
        .collect();
    list(&all, "or")
}

/// None of several alternative fields is given; each with its form, a clause.
pub fn missing_alternative(at: &Location, section: &str, fields: &[(&str, String)]) -> Diagnostic {
    let names: Vec<&str> = fields.iter().map(|(name, _)| *name).collect();
    let forms: Vec<String> = fields.iter().map(|(_, form)| form.clone()).collect();
    Diagnostic::new(
        Code::MissingField,
        at,
        format!(
            "`{section}` lacks the field {}; add one: {}",
            list(&names, "or"),
            enumerated(&forms, "or"),
        ),
    )
}

/// None of the `fields` that state the EMF is given. `constant`: the stated no-load speed over its voltage, rad/s per volt.
pub fn missing_emf_beside_no_load_speed(
    at: &Location,
    fields: &[&str],
    [speed, voltage]: [&Part; 2],
    constant: f64,
) -> Diagnostic {
    let error = Diagnostic::new(
        Code::MissingField,
        at,
        format!(
            "`motor` lacks the field {}; `no_load_speed` over `nominal_voltage` is one: add `speed_constant: {} rpm/V block_mean` (a no-load speed is one of block commutation), or what the data sheet prints",
            list(fields, "or"),
            significant(constant * 30.0 / PI),
        ),
    );
    with_parts(error, &[speed, voltage])
}

/// A section is missing.
pub fn missing_section(at: &Location, name: &str) -> Diagnostic {
    Diagnostic::new(
        Code::MissingSection,
        at,
        match name {
            "controller" => {
                "the section `controller` is missing; choose one, for example `controller: pdcc`"
                    .to_owned()
            }
            _ if matches!(at, Location::File { .. }) => {
                format!("the section `[{name}]` is missing; add it with its fields")
            }
            _ => format!("the section `{name}` is missing; give it here or in a motor file"),
        },
    )
}

/// Two fields that say the same thing.
pub fn exclusive_fields(at: &Location, name: &str, other_at: &Location, other: &str) -> Diagnostic {
    Diagnostic::new(
        Code::ExclusiveFields,
        at,
        format!("`{name}` and `{other}` say the same thing; keep one of the two"),
    )
    .with_note(other_at, format!("`{other}` is given here"))
}

/// A field that has an effect only with another setting, `condition`, e.g. ``v_bus: measured``; `contrary`: name, value
/// and place of what is stated in its place.
pub fn needless_field(
    at: &Location,
    name: &str,
    given: &str,
    condition: &str,
    contrary: Option<(&str, &str, &Location)>,
) -> Diagnostic {
    let error = Diagnostic::new(
        Code::DependentField,
        at,
        format!(
            "`{name}`: {given} has an effect only with `{condition}`; set that or remove `{name}`"
        ),
    );
    match contrary {
        Some((other, value, at)) => error.with_note(at, format!("`{other}: {value}`")),
        None => error,
    }
}

/// A field that the value of a second field needs: its section, its name and an example of its value.
pub fn needed_field(
    at: &Location,
    setting: &str,
    [section, name, example]: [&str; 3],
) -> Diagnostic {
    let what = match name {
        "hall_timer_clock" => ", the clock of a timer that captures the edges",
        "adc_reference" => ", the voltage of the converter's full range",
        _ => "",
    };
    Diagnostic::new(
        Code::DependentField,
        at,
        format!(
            "`{setting}` needs the field `{name}` of `{section}`{what}; add it, for example `{name}: {example}`"
        ),
    )
}

/// A motor file cannot be read; `why` is the system's reason.
pub fn unreadable_motor_file(at: &Location, path: &str, why: &str) -> Diagnostic {
    Diagnostic::new(
        Code::MotorFile,
        at,
        format!(
            "`motor`: the file {path:?} cannot be read ({why}); give a path relative to the crate's Cargo.toml"
        ),
    )
}

/// A motor file is not UTF-8; `offset`: first invalid byte, from 0.
pub fn motor_file_is_no_text(at: &Location, byte: u8, offset: usize) -> Diagnostic {
    Diagnostic::new(
        Code::MotorFile,
        at,
        format!("the file is not UTF-8: byte {offset} is 0x{byte:02X}; save it as UTF-8"),
    )
}

/// A motor file's path is absolute.
pub fn absolute_motor_file(at: &Location) -> Diagnostic {
    Diagnostic::new(
        Code::MotorFile,
        at,
        "`motor`: the file's path is absolute; give a path relative to the crate's Cargo.toml, so that the output is the same on every machine",
    )
}

/// A board that is neither one of the library nor a TOML file.
pub fn unknown_board(at: &Location, name: &str, known: &[&str]) -> Diagnostic {
    let quoted = similar(name, known).into_iter();
    let quoted: Vec<_> = quoted.map(|meant| format!("{meant:?}")).collect();
    let meant = did_you_mean_one(&quoted);
    let end = if meant.is_empty() { ";" } else { "" };
    Diagnostic::new(
        Code::UnknownBoard,
        at,
        format!(
            "`board`: the library has no {name:?}{meant}{end} give one of {} or the path of a TOML file, for example \"boards/mine.toml\"",
            known.join(", ")
        ),
    )
}

/// A board file without any of a board's fields.
pub fn not_a_board(at: &Location) -> Diagnostic {
    Diagnostic::new(
        Code::MotorFile,
        at,
        "this is no board: it has neither `[board]` nor `[inverter]`; write the inverter's fields into `[inverter]`"
            .to_owned(),
    )
}

/// A board file cannot be read; `why` is the system's reason.
pub fn unreadable_board_file(at: &Location, path: &str, why: &str) -> Diagnostic {
    Diagnostic::new(
        Code::MotorFile,
        at,
        format!(
            "`board`: the file {path:?} cannot be read ({why}); give a name of the library or a path relative to the file that names it, in a macro to the crate's Cargo.toml"
        ),
    )
}

/// A board file's path is absolute.
pub fn absolute_board_file(at: &Location) -> Diagnostic {
    Diagnostic::new(
        Code::MotorFile,
        at,
        "`board`: the file's path is absolute; give a relative one, so that the output is the same on every machine",
    )
}

/// The drive's name is not a type name.
pub fn invalid_name(at: &Location, name: &str) -> Diagnostic {
    Diagnostic::new(
        Code::InvalidName,
        at,
        format!(
            "`name`: {name:?} is not a type name; use a capital letter first, then letters and digits, for example \"HubDrive\""
        ),
    )
}

/// ``; did you mean `x`?`` for the closest known word. Nothing where only one word is known: the
/// message names it already.
pub(super) fn did_you_mean(word: &str, known: &[&str]) -> String {
    if known.len() < 2 {
        return String::new();
    }
    let near = nearest(word, known).map(|near| format!("`{near}`"));
    did_you_mean_one(near.as_slice())
}
