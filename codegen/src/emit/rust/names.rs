//! Names, numbers and documentation in emitted Rust.

use super::super::comment::comments;
use super::source::{Source, quote};
use crate::emit::signal::Leg;
use crate::ir::Word;
use std::collections::HashSet;

/// Functions of `hexagen::arith` that emitted code may import.
pub(super) const HELPERS: [&str; 14] = [
    "angle_fraction",
    "angle_index",
    "divide",
    "divide_narrow",
    "lookup",
    "mul_add_floor",
    "mul_floor",
    "mul_limited",
    "mul_round",
    "mul_round_narrow",
    "remainder",
    "row",
    "select",
    "turn_over",
];

/// Other names that a local name would shadow: those of the emitted functions' parameters.
const RESERVED: [&str; 4] = ["rotor", "sample", "set_point", "state"];

/// The identifier of a signal, state word, input or stage: its name, with an underscore appended if
/// that is taken.
pub(super) fn snake(name: &str) -> Source {
    if RESERVED.contains(&name) || HELPERS.contains(&name) || is_keyword(name) {
        Source::of(format!("{name}_"))
    } else {
        Source::of(name)
    }
}

/// Keywords of edition 2024. (A parser knows them, too, but is slow for thousands of names in
/// macros, which run unoptimised.)
const KEYWORDS: [&str; 53] = [
    "Self", "_", "abstract", "as", "async", "await", "become", "box", "break", "const", "continue",
    "crate", "do", "dyn", "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if",
    "impl", "in", "let", "loop", "macro", "match", "mod", "move", "mut", "override", "priv", "pub",
    "ref", "return", "self", "static", "struct", "super", "trait", "true", "try", "type", "typeof",
    "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

/// Whether the word is a keyword.
fn is_keyword(name: &str) -> bool {
    KEYWORDS.binary_search(&name).is_ok()
}

/// The identifier of a constant or table.
pub(super) fn screaming(name: &str) -> Source {
    Source::of(name.to_uppercase())
}

/// `HubDrive` of `hub_drive`.
pub(super) fn camel(name: &str) -> String {
    name.split('_')
        .map(|part| {
            let mut letters = part.chars();
            letters
                .next()
                .map(|first| first.to_uppercase().chain(letters).collect::<String>())
                .unwrap_or_default()
        })
        .collect()
}

/// A number with separators: `-1_234_567`.
pub(super) fn number(value: i64) -> Source {
    let digits = value.unsigned_abs().to_string();
    let mut text = String::new();
    if value < 0 {
        text.push('-');
    }
    for (index, digit) in digits.chars().enumerate() {
        if digits.len() > 4 && index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('_');
        }
        text.push(digit);
    }
    Source::of(text)
}

/// A raw string literal, which keeps line breaks.
pub(super) fn raw_text(text: &str) -> Source {
    // One hash more than the longest run in the text.
    let longest = text
        .split(|letter| letter != '#')
        .map(str::len)
        .max()
        .unwrap_or(0);
    let hashes = "#".repeat(longest + 1);
    Source::of(format!("r{hashes}\"{text}\"{hashes}"))
}

/// Documentation lines of an item, as attributes: from comments that a macro emits as text, the
/// macro server of rust-analyzer makes lines that begin with `/ `.
pub(super) fn docs<T: AsRef<str>>(lines: &[T]) -> Source {
    let comments = comments(SIGN, COLUMNS, lines);
    let lines = comments.lines().map(|line| &line[SIGN.len()..]);
    quote!(#(#[doc = #lines])*)
}

/// One documentation line of an item.
pub(super) fn doc(line: &str) -> Source {
    docs(&[line])
}

/// Begin of a line of documentation where people read it.
const SIGN: &str = "///";

/// Columns of documentation: 100 with two levels of indentation.
const COLUMNS: usize = 92;

/// The type that stores a word.
pub(super) fn storage_type(word: &Word) -> Source {
    if word.storage_bits == 16 {
        quote!(u16)
    } else {
        quote!(Word)
    }
}

/// `value`, an expression that may be a receiver, in the storage type.
pub(super) fn stored(word: &Word, value: &Source) -> Source {
    if word.storage_bits == 16 {
        quote!(#value.to_u16())
    } else {
        value.clone()
    }
}

/// A word read from its storage.
pub(super) fn loaded(word: &Word, place: &Source) -> Source {
    if word.storage_bits == 16 {
        quote!(Word::from(#place))
    } else {
        place.clone()
    }
}

/// The identifiers in `code` that may name an item, comments and literals left out: capitalised
/// ones (types, constants) and those before `(` or `::` (functions, modules). (In macros, which run
/// unoptimised, collecting all signals as well would take a tenth of the generator's time.)
pub(super) fn item_names(code: &Source) -> HashSet<&str> {
    let (code, mut found, mut at) = (code.as_str(), HashSet::new(), 0);
    let bytes = code.as_bytes();
    while at < bytes.len() {
        let begin = at;
        while at < bytes.len() && LETTERS[usize::from(bytes[at])] {
            at += 1;
        }
        if at > begin && (bytes[begin].is_ascii_uppercase() || is_called(&bytes[at..])) {
            found.insert(&code[begin..at]);
        }
        at += match bytes.get(at) {
            Some(b'/') if code[at..].starts_with("//") => code[at..].find('\n').unwrap_or(1),
            Some(b'"') => text_length(&bytes[at..]),
            Some(b'#') if code[begin..].starts_with("r#") => raw_text_length(&code[at..]),
            _ => 1,
        };
    }
    found
}

/// Whether `behind` begins with a call or a path separator.
fn is_called(behind: &[u8]) -> bool {
    let behind = behind.strip_prefix(b" ").unwrap_or(behind);
    behind.starts_with(b"(") || behind.starts_with(b"::")
}

/// Whether a byte may be part of an identifier, non-ASCII ones included. (A table: this runs for
/// every byte in macros, which are unoptimised.)
const LETTERS: [bool; 256] = {
    let (mut letters, mut byte) = ([false; 256], 0);
    while byte < letters.len() {
        let known = byte as u8;
        letters[byte] = known == b'_' || known.is_ascii_alphanumeric() || !known.is_ascii();
        byte += 1;
    }
    letters
};

/// Length of the string literal that `code` begins with.
fn text_length(code: &[u8]) -> usize {
    let mut at = 1;
    while at < code.len() && code[at] != b'"' {
        at += if code[at] == b'\\' { 2 } else { 1 };
    }
    at + 1
}

/// Length of the raw string literal that `code`, after its `r`, begins with; 1 for a raw
/// identifier.
fn raw_text_length(code: &str) -> usize {
    let inside = code.trim_start_matches('#');
    let hashes = &code[..code.len() - inside.len()];
    if !inside.starts_with('"') {
        return 1;
    }
    let end = format!("\"{hashes}");
    let length = inside[1..].find(&end).unwrap_or(0);
    hashes.len() + 1 + length + end.len()
}

/// The state of a leg by its name.
pub(super) fn leg_state(leg: Leg) -> Source {
    match leg {
        Leg::Pulsed => quote!(LegState::Pulsed),
        Leg::Low => quote!(LegState::Low),
        Leg::Off => quote!(LegState::Off),
    }
}

/// The `fixed` type of 32 bits with `frac_bits`.
pub(super) fn fixed_type(frac_bits: u32) -> Source {
    let integer_bits = 32_u32.saturating_sub(frac_bits);
    Source::of(format!("I{integer_bits}F{frac_bits}"))
}

#[cfg(test)]
mod tests {
    use super::{KEYWORDS, Source, camel, is_keyword, item_names, number, raw_text};

    #[test]
    fn names_convert_between_cases() {
        assert_eq!(camel("track_rotor"), "TrackRotor");
    }

    #[test]
    fn keywords_are_the_words_that_are_no_identifiers() {
        assert!(KEYWORDS.is_sorted());
        for word in KEYWORDS {
            assert!(is_keyword(word), "{word}");
            // `gen` is a keyword of edition 2024 that the parser does not know.
            let is_identifier = syn::parse_str::<syn::Ident>(word).is_ok();
            assert_eq!(is_identifier, word == "gen", "{word}");
        }
        for name in ["hub", "union", "default", "auto", "raw", "safe", "selfish"] {
            assert!(!is_keyword(name), "{name}");
        }
    }

    #[test]
    fn names_are_found_in_code_alone() {
        let code = Source::of(
            "//! A doc.\n# [x] fn f (r#a : B < 'c >) { r#\"d \" e\"# ; \"g\\\"h\" . i_1 m::c }",
        );
        let mut names: Vec<&str> = item_names(&code).into_iter().collect();
        names.sort_unstable();
        assert_eq!(names, ["B", "f", "m"]);
    }

    #[test]
    fn numbers_group_their_digits() {
        assert_eq!(number(1234).to_string(), "1234");
        assert_eq!(number(1_234_567).to_string(), "1_234_567");
        assert_eq!(number(i64::from(i32::MIN)).to_string(), "-2_147_483_648");
    }

    #[test]
    fn raw_texts_hold_any_text() {
        for text in ["a\nb", "say \"#\"", "\"##", ""] {
            let literal: syn::LitStr =
                syn::parse_str(&raw_text(text).to_string()).expect("a literal");
            assert_eq!(literal.value(), text);
        }
    }
}
