//! Reads the text of one value: `135 mohm per_phase`, `star`, `0.1648 V/(rad/s) line_to_line peak`.
//!
//! Both front ends and the command line use this one reader; the macro's tokens are joined to text
//! first. White space never matters.

use super::SensedPhases;
use super::ast::{Basis, Number, Value};
use super::field_rule::FieldRule;
use super::units::{Dimension, Unit, in_letters};
use super::words::Words;
use crate::diagnostics::{Diagnostic, Location, catalogue};
use std::slice;

#[derive(Clone, Debug, PartialEq)]
enum Lexeme {
    Number(String),
    Word(String),
    Symbol(char),
}

/// Reads the value of `field` from `text`.
pub(super) fn parse_value(field: FieldRule, text: &str, at: &Location) -> Value {
    if field.is_text() {
        return match free_text(field, text, at) {
            Ok(text) => Value::Text(text),
            Err(error) => Value::Malformed(Box::new(error)),
        };
    }
    if field.name == "poles"
        && let Some([slots, poles]) = slots_and_poles(text)
    {
        return if slots.is_multiple_of(PHASES) && slots > 0 {
            plain_number(field, &poles.to_string(), at)
        } else {
            let error = catalogue::slots_of_three_phases(at, text.trim(), [slots, poles]);
            Value::Malformed(Box::new(error))
        };
    }
    read(field, text, at).unwrap_or_else(|error| Value::Malformed(Box::new(error)))
}

/// Phases of a motor: each has as many teeth of its stator.
const PHASES: u32 = 3;

/// The slots and the poles of `12N14P` or `14P12N`, as makers of outrunners write them.
fn slots_and_poles(text: &str) -> Option<[u32; 2]> {
    let upper = text.trim().to_uppercase();
    let number = |digits: &str| {
        let is_number = digits.bytes().all(|digit| digit.is_ascii_digit());
        digits.parse().ok().filter(|_| is_number)
    };
    let (slots, poles) = if let Some(slots_first) = upper.strip_suffix('P') {
        slots_first.split_once('N')?
    } else {
        let (poles, slots) = upper.strip_suffix('N')?.split_once('P')?;
        (slots, poles)
    };
    Some([number(slots)?, number(poles)?])
}

/// Free text in one line. Texts become comments of emitted code, so characters that compilers
/// reject there are rejected here: control characters and those that change the direction of
/// writing (rustc's lint `text_direction_codepoint_in_literal`).
pub(super) fn free_text(field: FieldRule, text: &str, at: &Location) -> Result<String, Diagnostic> {
    let is_forbidden = |c: char| {
        matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
            || (c.is_control() && !c.is_whitespace())
    };
    match (1..).zip(text.chars()).find(|(_, c)| is_forbidden(*c)) {
        Some((position, c)) => Err(catalogue::forbidden_character(at, field.name, c, position)),
        None => Ok(text.split_whitespace().collect::<Vec<_>>().join(" ")),
    }
}

/// A number of the given digits without unit.
pub(super) fn plain_number(field: FieldRule, digits: &str, at: &Location) -> Value {
    if field.is_text() {
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

/// Another kind of value where the field takes text.
pub(super) fn no_text(field: FieldRule, given: &str, at: &Location) -> Value {
    let examples = field.examples(&[]);
    Value::Malformed(Box::new(catalogue::wrong_kind(
        at, field.name, given, "text", &examples,
    )))
}

/// A value that cannot be read.
pub(super) fn unreadable(field: FieldRule, text: &str, at: &Location) -> Value {
    Value::Malformed(Box::new(malformed(field, text, at)))
}

fn read(field: FieldRule, text: &str, at: &Location) -> Result<Value, Diagnostic> {
    let lexemes = lex(&in_letters(text));
    let (sign, unsigned) = match lexemes.as_slice() {
        [Lexeme::Symbol('-'), rest @ ..] => ("-", rest),
        all => ("", all),
    };
    match unsigned {
        [Lexeme::Number(zero), Lexeme::Word(word), ..] if is_based(zero, word) => {
            Err(malformed(field, text, at))
        }
        [Lexeme::Number(digits), rest @ ..] => {
            let digits = format!("{sign}{digits}");
            let value = number(&digits).ok_or_else(|| malformed(field, text, at))?;
            let (unit, basis) = read_unit(field, text, &digits, rest, at)?;
            Ok(Value::Number(Number {
                digits,
                value,
                unit,
                basis,
            }))
        }
        [Lexeme::Symbol('['), list @ .., Lexeme::Symbol(']')] if sign.is_empty() => {
            match read_list(list) {
                Some(integers) => Ok(Value::Integers(integers)),
                None if field.takes_each() => read_each(field, list, at),
                None => Err(malformed(field, text, at)),
            }
        }
        words if sign.is_empty() => read_word(words)
            .map(Value::Word)
            .ok_or_else(|| malformed(field, text, at)),
        _ => Err(malformed(field, text, at)),
    }
}

fn malformed(field: FieldRule, text: &str, at: &Location) -> Diagnostic {
    if text.starts_with('"') && matches!(at, Location::Macro(_)) {
        return catalogue::quoted(at, field.name, text);
    }
    let phases = (field.name == "sensed_phases").then(|| phases_of_list(text));
    let examples = phases
        .flatten()
        .map_or_else(|| field.examples(&[]), |word| vec![word.to_owned()]);
    catalogue::malformed_value(at, field.name, text, &examples)
}

/// The word of `sensed_phases` for phases in a list: `abc` of `a, b, c`.
fn phases_of_list(text: &str) -> Option<&'static str> {
    let is_named = |word: &&str| {
        let other = text
            .chars()
            .filter(|c| c.is_alphanumeric())
            .any(|c| !word.contains(c));
        !other && word.chars().all(|phase| text.contains(phase))
    };
    SensedPhases::WORDS
        .iter()
        .map(|known| known.word)
        .find(is_named)
}

/// The value with a point in place of a decimal comma, and without the comma if that may part thousands.
fn without_comma(digits: &str, lexemes: &[Lexeme]) -> Option<Vec<String>> {
    let [Lexeme::Symbol(','), Lexeme::Number(fraction), unit @ ..] = lexemes else {
        return None;
    };
    let is_whole = |digits: &str| digits.bytes().all(|digit| digit.is_ascii_digit());
    let is_list = unit.contains(&Lexeme::Symbol(','));
    if is_list || !is_whole(digits.trim_start_matches('-')) || !is_whole(fraction) {
        return None;
    }
    let unit = spelt(unit);
    let value = |point: &str| {
        format!("{digits}{point}{fraction} {unit}")
            .trim_end()
            .to_owned()
    };
    let mut values = vec![value(".")];
    if fraction.len() == 3 && digits != "0" {
        values.push(value(""));
    }
    Some(values)
}

/// Whether a number is of another base than ten, such as `0x1F`.
fn is_based(zero: &str, word: &str) -> bool {
    let digits = word.strip_prefix(['x', 'X', 'o', 'O', 'b', 'B']);
    zero == "0" && digits.is_some_and(|digits| digits.starts_with(|c: char| c.is_ascii_hexdigit()))
}

/// The value of a decimal number; underscores only between two digits.
fn number(digits: &str) -> Option<f64> {
    let groups: Vec<&str> = digits.split('_').collect();
    let is_between_digits = |pair: &[&str]| {
        pair[0].ends_with(|c: char| c.is_ascii_digit())
            && pair[1].starts_with(|c: char| c.is_ascii_digit())
    };
    if !groups.windows(2).all(is_between_digits) {
        return None;
    }
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

/// Unit and basis words behind a number: the longest known unit, then basis words.
fn read_unit(
    field: FieldRule,
    text: &str,
    digits: &str,
    lexemes: &[Lexeme],
    at: &Location,
) -> Result<(Option<Unit>, Vec<Basis>), Diagnostic> {
    let given = |lexemes: &[Lexeme]| format!("{digits} {}", spelt(lexemes));
    if let Some(meant) = voltage_over_speed(field, digits, lexemes) {
        return Err(catalogue::voltage_at_speed(at, field.name, text, &meant));
    }
    if let Some(values) = without_comma(digits, lexemes) {
        let given = text.replace(", ", ",");
        return Err(catalogue::decimal_comma(at, field.name, &given, &values));
    }
    if let Some(signs) = stray_signs(lexemes) {
        let examples = field.examples(&named(lexemes));
        return Err(catalogue::stray_signs(
            at, field.name, text, &signs, &examples,
        ));
    }
    let longest = (1..=lexemes.len())
        .rev()
        .find_map(|end| Some((unit_of(field, &written(&lexemes[..end]))?, &lexemes[end..])));
    let (unit, rest) = match longest {
        Some((unit, rest)) => (Some(unit), rest),
        None => (None, lexemes),
    };
    if let Some(mut basis) = basis_words(rest) {
        let (unit, amplitude) =
            unit.map_or((None, None), |(unit, amplitude)| (Some(unit), amplitude));
        basis.extend(amplitude.filter(|amplitude| !basis.contains(amplitude)));
        return Ok((unit, basis));
    }
    let unknown = &lexemes[..lexemes.len() - basis_at_end(lexemes).0];
    let symbol = spelt(unknown);
    if field.name == "poles" && symbol.contains("pair") {
        return Err(catalogue::pairs_of_poles(at, &given(unknown), digits));
    }
    if field.name == "pole_pairs" && symbol.contains("pole") && !symbol.contains("pair") {
        return Err(catalogue::poles_of_pairs(at, &given(unknown), digits));
    }
    if let Some(readings) = Unit::readings(&written(unknown)) {
        return Err(catalogue::ambiguous_unit(
            at,
            field.name,
            &given(unknown),
            &symbol,
            readings,
        ));
    }
    let takes_basis = !field.references().is_empty();
    let is_whole = unit
        .as_ref()
        .is_some_and(|(unit, _)| takes_basis || field.dimensions().contains(&unit.dimension));
    if is_whole && !field.bases().is_empty() && rest.iter().all(is_part_of_word) {
        let (word, remedy) = basis_remedy(field, rest);
        return Err(catalogue::unknown_basis(
            at,
            field.name,
            &given(lexemes),
            &word,
            &remedy,
        ));
    }
    let inverse = number(digits)
        .and_then(|value| Unit::of_inverse(value, &written(unknown), field.dimensions()));
    if let Some(inverse) = inverse {
        let given = given(unknown);
        return Err(catalogue::inverse_unit(at, field.name, &given, &inverse));
    }
    let nearest = Unit::nearest(&symbol, field.dimensions());
    let right = field.unit_to_give(&named(lexemes));
    Err(catalogue::unknown_unit(
        at,
        field.name,
        &given(unknown),
        &symbol,
        nearest,
        &right,
    ))
}

/// `3.6 Vpp/200 rpm` of `3.6 Vpp at 200 rpm`.
fn voltage_over_speed(field: FieldRule, digits: &str, lexemes: &[Lexeme]) -> Option<String> {
    let is_at = |lexeme: &Lexeme| match lexeme {
        Lexeme::Word(word) => word == "at",
        Lexeme::Symbol(sign) => *sign == '@',
        Lexeme::Number(_) => false,
    };
    let place = lexemes.iter().position(is_at)?;
    let (voltage, basis) = lexemes[..place].split_first()?;
    let [number @ Lexeme::Number(_), unit, further @ ..] = &lexemes[place + 1..] else {
        return None;
    };
    let is_speed = |unit: Unit| unit.dimension == Dimension::Speed;
    let speed = slice::from_ref(unit);
    let is_speed = Unit::from_symbol(&spelt(speed)).is_some_and(is_speed);
    if !is_speed || !field.dimensions().contains(&Dimension::EmfConstant) {
        return None;
    }
    let divided = [slice::from_ref(number), speed].map(spelt).join(" ");
    let voltage = spelt(slice::from_ref(voltage));
    let words = [basis, further].map(spelt).join(" ");
    Some(
        format!("{digits} {voltage}/{divided} {}", words.trim())
            .trim_end()
            .to_owned(),
    )
}

/// The unit of a spelling, and the basis that it says. `KV`, in any case, is what makers of
/// outrunners call rpm/V; but `kV` is a kilovolt where no speed constant is asked for by name.
fn unit_of(field: FieldRule, symbol: &str) -> Option<(Unit, Option<Basis>)> {
    let is_speed_constant = field.dimensions().contains(&Dimension::SpeedConstant);
    let is_kilovolt = symbol == "kV" && field.name != "speed_constant";
    let is_kv = symbol.eq_ignore_ascii_case("kv") && !is_kilovolt;
    if is_speed_constant && is_kv {
        let mut unit = Unit::from_symbol("rpm/V")?;
        symbol.clone_into(&mut unit.symbol);
        return Some((unit, None));
    }
    Unit::parse(symbol)
}

/// The first signs that mean nothing where they stand: a product's stands between two words, a
/// power's before its number, a hyphen within a word, a product or before a power.
fn stray_signs(lexemes: &[Lexeme]) -> Option<String> {
    let is_word = |lexeme: Option<&Lexeme>| matches!(lexeme, Some(Lexeme::Word(_)));
    let is_basis = |lexeme: &Lexeme| basis_words(std::slice::from_ref(lexeme)).is_some();
    let is_factor = |lexeme: Option<&Lexeme>| is_word(lexeme) && !lexeme.is_some_and(is_basis);
    let is_number = |lexeme: Option<&Lexeme>| matches!(lexeme, Some(Lexeme::Number(_)));
    let first = lexemes.iter().enumerate().position(|(index, lexeme)| {
        let before = index.checked_sub(1).and_then(|before| lexemes.get(before));
        let after = lexemes.get(index + 1);
        match lexeme {
            Lexeme::Symbol('*' | '\u{b7}' | '.') => {
                !(is_word(before) || is_number(before)) || !is_factor(after)
            }
            Lexeme::Symbol('^') => {
                let is_negative = matches!(after, Some(Lexeme::Symbol('-')));
                !is_word(before) || !(is_number(after) || is_negative)
            }
            Lexeme::Symbol('-') if matches!(before, Some(Lexeme::Symbol('^'))) => !is_number(after),
            Lexeme::Symbol('-') => !is_word(before) || !(is_word(after) || is_number(after)),
            Lexeme::Symbol(sign) => !matches!(sign, '/' | '(' | ')' | '%'),
            Lexeme::Word(_) | Lexeme::Number(_) => false,
        }
    })?;
    let signs = lexemes[first..].iter().map_while(|lexeme| match lexeme {
        Lexeme::Symbol(sign) => Some(*sign),
        _ => None,
    });
    Some(signs.collect())
}

/// A unit's spelling: products with a space, powers without a caret.
fn spelt(lexemes: &[Lexeme]) -> String {
    let kept: Vec<Lexeme> = lexemes
        .iter()
        .filter(|lexeme| !matches!(lexeme, Lexeme::Symbol('*' | '\u{b7}' | '.' | '^')))
        .cloned()
        .collect();
    written(&kept)
}

/// The lexemes as text, with spaces between words alone.
fn written(lexemes: &[Lexeme]) -> String {
    let mut text = String::new();
    let mut after_word = false;
    for lexeme in lexemes {
        match lexeme {
            Lexeme::Symbol(sign) => text.push(*sign),
            Lexeme::Number(digits) => text.push_str(digits),
            Lexeme::Word(word) => {
                if after_word {
                    text.push(' ');
                }
                text.push_str(word);
            }
        }
        after_word = !matches!(lexeme, Lexeme::Symbol(_));
    }
    text
}

/// How data sheets name a basis, words apart.
const PHRASES: &[(&[&str], Basis)] = &[
    (&["per", "phase"], Basis::PerPhase),
    (&["line", "to", "line"], Basis::LineToLine),
    (&["line", "line"], Basis::LineToLine),
    (&["l", "to", "l"], Basis::LineToLine),
    (&["l", "l"], Basis::LineToLine),
    (&["ll"], Basis::LineToLine),
    (&["phase", "to", "phase"], Basis::LineToLine),
    (&["phase", "phase"], Basis::LineToLine),
    (&["terminal", "to", "terminal"], Basis::LineToLine),
    (&["terminal"], Basis::LineToLine),
    (&["terminals"], Basis::LineToLine),
    (&["lead", "to", "lead"], Basis::LineToLine),
    (&["phase"], Basis::Phase),
    (&["peak"], Basis::Peak),
    (&["pk"], Basis::Peak),
    (&["peak", "to", "peak"], Basis::PeakToPeak),
    (&["peak", "peak"], Basis::PeakToPeak),
    (&["pk", "pk"], Basis::PeakToPeak),
    (&["p", "p"], Basis::PeakToPeak),
    (&["pp"], Basis::PeakToPeak),
    (&["amplitude"], Basis::Peak),
    (&["rms"], Basis::Rms),
    (&["block", "mean"], Basis::BlockMean),
    (&["per", "peak", "ampere"], Basis::PerPeakAmpere),
    (&["per", "rms", "ampere"], Basis::PerRmsAmpere),
];

/// The basis that words say as a whole, joined by spaces, hyphens or underscores, in any case.
fn basis_words(lexemes: &[Lexeme]) -> Option<Vec<Basis>> {
    let mut words = Vec::new();
    for lexeme in lexemes {
        match lexeme {
            Lexeme::Word(word) => words.extend(word.split('_').map(str::to_lowercase)),
            Lexeme::Symbol('-') => {}
            _ => return None,
        }
    }
    let mut rest = words.as_slice();
    let mut basis = Vec::new();
    while !rest.is_empty() {
        let starts = |phrase: &[&str]| {
            phrase.len() <= rest.len() && rest.iter().zip(phrase).all(|(word, known)| word == known)
        };
        let (phrase, meant) = PHRASES
            .iter()
            .filter(|(phrase, _)| starts(phrase))
            .max_by_key(|(phrase, _)| phrase.len())?;
        basis.push(*meant);
        rest = &rest[phrase.len()..];
    }
    Some(basis)
}

/// The longest end of the lexemes that is basis words: how many, and which.
fn basis_at_end(lexemes: &[Lexeme]) -> (usize, Vec<Basis>) {
    (0..lexemes.len())
        .find_map(|begin| Some((lexemes.len() - begin, basis_words(&lexemes[begin..])?)))
        .unwrap_or_default()
}

/// The basis words at the end of the lexemes.
fn named(lexemes: &[Lexeme]) -> Vec<Basis> {
    basis_at_end(lexemes).1
}

fn is_part_of_word(lexeme: &Lexeme) -> bool {
    matches!(lexeme, Lexeme::Word(_) | Lexeme::Symbol('-'))
}

/// What is unknown of the words behind a unit, and the choice that there is.
fn basis_remedy(field: FieldRule, lexemes: &[Lexeme]) -> (String, String) {
    let words: Vec<(&str, &str)> = field
        .bases()
        .iter()
        .map(|(basis, meaning)| (basis.word(), *meaning))
        .collect();
    let mut remedy = format!("write {}", catalogue::with_meanings(&words));
    if field.name == "back_emf" {
        remedy.push_str(", with `peak` (the amplitude) or `rms`");
    }
    let unknown: Vec<Lexeme> = lexemes
        .iter()
        .filter(|lexeme| {
            basis_words(std::slice::from_ref(lexeme)).is_none_or(|basis| basis.is_empty())
        })
        .cloned()
        .collect();
    let whole = written(lexemes);
    let is_word = |lexeme: &Lexeme| matches!(lexeme, Lexeme::Word(_));
    (
        if unknown.iter().any(is_word) {
            written(&unknown)
        } else {
            whole
        },
        remedy,
    )
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

/// `[19.5 mA/count, 19.7 mA/count]` without its brackets: a value of each sensed phase.
fn read_each(field: FieldRule, lexemes: &[Lexeme], at: &Location) -> Result<Value, Diagnostic> {
    let items = lexemes.split(|lexeme| *lexeme == Lexeme::Symbol(','));
    let items = items.filter(|item| !item.is_empty());
    let values = items.map(|item| match read(field, &written(item), at)? {
        value @ (Value::Number(_) | Value::Word(_)) => Ok(value),
        _ => Err(malformed(field, &written(item), at)),
    });
    values.collect::<Result<_, _>>().map(Value::List)
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
    use crate::spec::fields;

    fn parse(field: &str, text: &str) -> Value {
        parse_value(
            fields::field(field),
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
            ("24 oz-in-s2", "24 oz-in-s2"),
            ("17.3 V/1000rpm", "17.3 V/1000rpm"),
            ("5Arms", "5 A rms"),
            (
                "12.2 Vrms/krpm line-to-line",
                "12.2 V/krpm line_to_line rms",
            ),
            ("3000 1/min", "3000 1/min"),
            ("3000/min", "3000 /min"),
            ("3000 min - 1", "3000 min-1"),
            ("3000 min\u{207b}\u{b9}", "3000 min-1"),
            ("3.3 N.m", "3.3 N m"),
            ("135 mohm Phase-to-Phase", "135 mohm line_to_line"),
            ("36.9 mNm/A block mean", "36.9 mNm/A block_mean"),
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
                "`resistance`: cannot read ``; write it like `resistance = \"135 mohm per_phase\"` or `resistance = \"135 mohm line_to_line\"`",
            ),
            (
                "star delta",
                "`resistance`: cannot read `star delta`; write it like `resistance = \"135 mohm per_phase\"` or `resistance = \"135 mohm line_to_line\"`",
            ),
            (
                "135 mOHM",
                "`resistance`: 135 mOHM has the unknown unit `mOHM`; did you mean `mohm`?",
            ),
            (
                "1e999 ohm",
                "`resistance`: cannot read `1e999 ohm`; write it like `resistance = \"135 mohm per_phase\"` or `resistance = \"135 mohm line_to_line\"`",
            ),
            (
                "[1, x]",
                "`resistance`: cannot read `[1, x]`; write it like `resistance = \"135 mohm per_phase\"` or `resistance = \"135 mohm line_to_line\"`",
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
