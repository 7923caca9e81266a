//! Reads the text of one value: `135 mohm per_phase`, `star`, `0.1648 V/(rad/s) line_to_line peak`.
//!
//! Both front ends and the command line use this one reader; the macro's tokens are joined to text
//! first. White space never matters.

use super::ast::{Basis, Number, Value};
use super::schema;
use super::units::Unit;
use crate::diagnostics::{Diagnostic, Location, catalogue};

#[derive(Clone, Debug, PartialEq)]
enum Lexeme {
    Number(String),
    Word(String),
    Symbol(char),
}

/// Reads the value of `field` (for its example in messages) from `text`.
pub(super) fn parse_value(field: &str, text: &str, at: &Location) -> Value {
    if schema::is_text(field) {
        return Value::Text(text.split_whitespace().collect::<Vec<_>>().join(" "));
    }
    read(field, text, at).unwrap_or_else(|error| Value::Malformed(Box::new(error)))
}

/// A number of the given digits without unit.
pub(super) fn plain_number(field: &str, digits: &str, at: &Location) -> Value {
    if schema::is_text(field) {
        return no_text(field, digits, at);
    }
    match number(digits) {
        Some(value) => Value::Number(Number {
            digits: digits.to_owned(),
            value,
            unit: None,
            basis: Vec::new(),
        }),
        None => Value::Malformed(Box::new(malformed(field, digits, at))),
    }
}

/// Something else where the field takes text.
pub(super) fn no_text(field: &str, given: &str, at: &Location) -> Value {
    let example = schema::example(field);
    Value::Malformed(Box::new(catalogue::wrong_kind(
        at, field, given, "text", example,
    )))
}

/// What no value is written like.
pub(super) fn unreadable(field: &str, text: &str, at: &Location) -> Value {
    Value::Malformed(Box::new(malformed(field, text, at)))
}

fn read(field: &str, text: &str, at: &Location) -> Result<Value, Diagnostic> {
    let lexemes = lex(text);
    let (sign, unsigned) = match lexemes.as_slice() {
        [Lexeme::Symbol('-'), rest @ ..] => ("-", rest),
        all => ("", all),
    };
    match unsigned {
        [Lexeme::Number(digits), rest @ ..] => {
            let digits = format!("{sign}{digits}");
            let value = number(&digits).ok_or_else(|| malformed(field, text, at))?;
            let (unit, basis) = read_unit(field, &digits, rest, at)?;
            Ok(Value::Number(Number {
                digits,
                value,
                unit,
                basis,
            }))
        }
        [Lexeme::Symbol('['), list @ .., Lexeme::Symbol(']')] if sign.is_empty() => read_list(list)
            .map(Value::Integers)
            .ok_or_else(|| malformed(field, text, at)),
        words if sign.is_empty() => read_word(words)
            .map(Value::Word)
            .ok_or_else(|| malformed(field, text, at)),
        _ => Err(malformed(field, text, at)),
    }
}

fn malformed(field: &str, text: &str, at: &Location) -> Diagnostic {
    catalogue::malformed_value(at, field, text, schema::example(field))
}

fn number(digits: &str) -> Option<f64> {
    digits
        .replace('_', "")
        .parse()
        .ok()
        .filter(|value: &f64| value.is_finite())
}

/// Splits text into numbers, words and single symbols.
fn lex(text: &str) -> Vec<Lexeme> {
    let mut lexemes = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = if first.is_ascii_digit() {
            number_length(rest)
        } else if is_word(first) {
            rest.find(|c| !is_word(c)).unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        let (lexeme, tail) = rest.split_at(length);
        lexemes.push(if first.is_ascii_digit() {
            Lexeme::Number(lexeme.to_owned())
        } else if is_word(first) {
            Lexeme::Word(lexeme.to_owned())
        } else {
            Lexeme::Symbol(first)
        });
        rest = tail.trim_start();
    }
    lexemes
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Bytes of the number at the start of `text`; an `e` counts only before an exponent.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| {
        text[from..]
            .find(|c: char| !c.is_ascii_digit() && c != '_')
            .map_or(text.len(), |n| from + n)
    };
    let mut end = digits(0);
    if text[end..].starts_with('.') {
        end = digits(end + 1);
    }
    if text[end..].starts_with(['e', 'E']) {
        let sign = usize::from(text[end + 1..].starts_with(['+', '-']));
        let exponent = digits(end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    end
}

/// Unit and basis words behind a number.
fn read_unit(
    field: &str,
    digits: &str,
    lexemes: &[Lexeme],
    at: &Location,
) -> Result<(Option<Unit>, Vec<Basis>), Diagnostic> {
    let mut basis = Vec::new();
    let mut symbol = String::new();
    let mut after_word = false;
    for lexeme in lexemes {
        let word = match lexeme {
            Lexeme::Word(word) => word.as_str(),
            Lexeme::Number(digits) => digits.as_str(),
            // Products may be written with a sign, powers with a caret.
            Lexeme::Symbol('*' | '·' | '^') => continue,
            Lexeme::Symbol(sign) => {
                symbol.push(*sign);
                after_word = false;
                continue;
            }
        };
        if let Some(found) = Basis::ALL.into_iter().find(|basis| basis.word() == word) {
            basis.push(found);
            continue;
        }
        let power = word.starts_with(|c: char| c.is_ascii_digit());
        if after_word && !power {
            symbol.push(' ');
        }
        symbol.push_str(word);
        after_word = true;
    }
    if symbol.is_empty() {
        return Ok((None, basis));
    }
    let unit = Unit::from_symbol(&symbol).ok_or_else(|| {
        let given = format!("{digits} {symbol}");
        let nearest = Unit::nearest(&symbol, schema::dimensions(field));
        catalogue::unknown_unit(at, field, &given, &symbol, nearest, schema::example(field))
    })?;
    Ok((Some(unit), basis))
}

/// `[1, 5, 4, 6, 2, 3]` without its brackets; a comma behind the last one is fine.
fn read_list(lexemes: &[Lexeme]) -> Option<Vec<i64>> {
    lexemes
        .split(|lexeme| *lexeme == Lexeme::Symbol(','))
        .filter(|item| !item.is_empty())
        .map(|item| match item {
            [Lexeme::Number(digits)] => digits.parse().ok(),
            _ => None,
        })
        .collect()
}

/// A word, or words joined by hyphens.
fn read_word(lexemes: &[Lexeme]) -> Option<String> {
    let words: Option<Vec<&str>> = lexemes
        .split(|lexeme| *lexeme == Lexeme::Symbol('-'))
        .map(|item| match item {
            [Lexeme::Word(word)] => Some(word.as_str()),
            _ => None,
        })
        .collect();
    words.map(|words| words.join("-"))
}

#[cfg(test)]
mod tests {
    use super::parse_value;
    use crate::diagnostics::Location;
    use crate::spec::ast::Value;

    fn parse(field: &str, text: &str) -> Value {
        parse_value(
            field,
            text,
            &Location::File {
                file: "t".into(),
                line: 1,
                column: 1,
            },
        )
    }

    #[test]
    fn values_print_as_written() {
        for (text, canonical) in [
            ("135 mohm per_phase", "135 mohm per_phase"),
            ("135mohm per_phase", "135 mohm per_phase"),
            (
                "0.1648 V / ( rad / s ) line_to_line peak",
                "0.1648 V/(rad/s) line_to_line peak",
            ),
            ("0.1648 V s/rad phase peak", "0.1648 V s/rad phase peak"),
            ("2.40e-6 kg*m^2", "2.40e-6 kg m2"),
            ("24 g cm2", "24 g cm2"),
            ("135 m\u{3a9} per_phase", "135 mohm per_phase"),
            ("220\u{b5}H", "220 uH"),
            ("120 \u{b0}", "120 deg"),
            ("3.3 N\u{b7}m", "3.3 N m"),
            ("2.4 g\u{b7}cm\u{b2}", "2.4 g cm2"),
            ("1e3us", "1e3 us"),
            ("- 5 mA/count", "-5 mA/count"),
            ("10%", "10 %"),
            ("1_000 rpm", "1_000 rpm"),
            ("fcs - mpc", "fcs-mpc"),
            ("[1, 5, 4,]", "[1, 5, 4]"),
            ("three_phase", "three_phase"),
            ("4", "4"),
        ] {
            assert_eq!(parse("resistance", text).to_string(), canonical, "{text}");
        }
    }

    #[test]
    fn unreadable_values_say_why() {
        for (text, message) in [
            (
                "",
                "`resistance`: cannot read ``; write it like `135 mohm per_phase`",
            ),
            (
                "star delta",
                "`resistance`: cannot read `star delta`; write it like `135 mohm per_phase`",
            ),
            (
                "135 mOhm",
                "`resistance`: 135 mOhm has the unknown unit `mOhm`; did you mean `mohm`?",
            ),
            (
                "1e999 ohm",
                "`resistance`: cannot read `1e999 ohm`; write it like `135 mohm per_phase`",
            ),
            (
                "[1, x]",
                "`resistance`: cannot read `[1, x]`; write it like `135 mohm per_phase`",
            ),
        ] {
            match parse("resistance", text) {
                Value::Malformed(error) => assert_eq!(error.message, message),
                value => panic!("{text} was read as {value}"),
            }
        }
    }

    #[test]
    fn si_values() {
        let Value::Number(number) = parse("inductance", "0.22mH per_phase") else {
            panic!("no number");
        };
        assert_eq!(number.si(), 0.00022);
    }
}
