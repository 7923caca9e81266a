//! How names, numbers and documentation look in emitted Rust.

use super::super::names::module_name;
use crate::ir::Word;
use proc_macro2::{Ident, Literal, Span, TokenStream, TokenTree};
use quote::{format_ident, quote};
use std::collections::BTreeSet;

/// Functions of `hexagen::arith`; emitted code imports those that it uses.
pub(super) const HELPERS: [&str; 13] = [
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
    "row",
    "select",
    "turn_over",
];

/// What else a local name would hide: names that the emitted functions use themselves.
const RESERVED: [&str; 3] = ["rest", "state", "step"];

/// The identifier of a signal, state word, input or stage: its own name, with an underscore behind
/// it where that name is taken.
pub(super) fn snake(name: &str) -> Ident {
    if RESERVED.contains(&name) || HELPERS.contains(&name) || is_keyword(name) {
        Ident::new(&format!("{name}_"), Span::call_site())
    } else {
        Ident::new(name, Span::call_site())
    }
}

/// The words that the language keeps for itself, as edition 2024 has them. (A parser knows them, too, but it is asked
/// for thousands of names, and macros run unoptimised.)
const KEYWORDS: [&str; 53] = [
    "Self", "_", "abstract", "as", "async", "await", "become", "box", "break", "const", "continue",
    "crate", "do", "dyn", "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if",
    "impl", "in", "let", "loop", "macro", "match", "mod", "move", "mut", "override", "priv", "pub",
    "ref", "return", "self", "static", "struct", "super", "trait", "true", "try", "type", "typeof",
    "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

/// Whether the language keeps the word for itself.
fn is_keyword(name: &str) -> bool {
    KEYWORDS.binary_search(&name).is_ok()
}

/// The identifier of a type's module: `loop_` for `Loop`.
pub(super) fn module_ident(type_name: &str) -> Ident {
    let name = module_name(type_name);
    if is_keyword(&name) {
        format_ident!("{name}_")
    } else {
        format_ident!("{name}")
    }
}

/// The identifier of a constant or table.
pub(super) fn screaming(name: &str) -> Ident {
    Ident::new(&name.to_uppercase(), Span::call_site())
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

/// A number with its thousands apart: `-1_234_567`.
pub(super) fn number(value: i64) -> TokenStream {
    let magnitude = value.unsigned_abs();
    let literal = if magnitude < 10_000 {
        Literal::u64_unsuffixed(magnitude)
    } else {
        let digits = magnitude.to_string();
        let mut text = String::new();
        for (index, digit) in digits.chars().enumerate() {
            if index > 0 && (digits.len() - index).is_multiple_of(3) {
                text.push('_');
            }
            text.push(digit);
        }
        text.parse()
            .unwrap_or_else(|_| Literal::u64_unsuffixed(magnitude))
    };
    if value < 0 {
        quote!(-#literal)
    } else {
        quote!(#literal)
    }
}

/// A text that keeps its line breaks: a raw string literal.
pub(super) fn raw_text(text: &str) -> Literal {
    // No quote in the text is followed by as many hashes as the longest run of them.
    let longest = text
        .split(|letter| letter != '#')
        .map(str::len)
        .max()
        .unwrap_or(0);
    let hashes = "#".repeat(longest + 1);
    format!("r{hashes}\"{text}\"{hashes}")
        .parse()
        .unwrap_or_else(|_| Literal::string(text))
}

/// Documentation lines of an item.
pub(super) fn docs<T: AsRef<str>>(lines: &[T]) -> TokenStream {
    lines.iter().map(|line| doc(line.as_ref())).collect()
}

/// One documentation line of an item.
pub(super) fn doc(line: &str) -> TokenStream {
    let text = doc_text(line);
    quote!(#[doc = #text])
}

/// Documentation lines of the module around them.
pub(super) fn inner_docs<T: AsRef<str>>(lines: &[T]) -> TokenStream {
    lines
        .iter()
        .map(|line| {
            let text = doc_text(line.as_ref());
            quote!(#![doc = #text])
        })
        .collect()
}

fn doc_text(line: &str) -> String {
    if line.is_empty() {
        String::new()
    } else {
        format!(" {line}")
    }
}

/// The type that stores a word.
pub(super) fn storage_type(word: &Word) -> TokenStream {
    if word.storage_bits == 16 {
        quote!(u16)
    } else {
        quote!(Word)
    }
}

/// `value`, a word expression that binds tighter than a method call, as stored.
pub(super) fn stored(word: &Word, value: &TokenStream) -> TokenStream {
    if word.storage_bits == 16 {
        quote!(#value.to_u16())
    } else {
        value.clone()
    }
}

/// A word read from where it is stored.
pub(super) fn loaded(word: &Word, place: &TokenStream) -> TokenStream {
    if word.storage_bits == 16 {
        quote!(Word::from(#place))
    } else {
        place.clone()
    }
}

/// All identifiers in `tokens`.
pub(super) fn identifiers(tokens: &TokenStream) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    collect(tokens.clone(), &mut found);
    found
}

fn collect(tokens: TokenStream, found: &mut BTreeSet<String>) {
    for token in tokens {
        match token {
            TokenTree::Ident(ident) => {
                found.insert(ident.to_string());
            }
            TokenTree::Group(group) => collect(group.stream(), found),
            TokenTree::Punct(_) | TokenTree::Literal(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{KEYWORDS, camel, is_keyword, module_ident, number, raw_text};

    #[test]
    fn names_convert_between_cases() {
        assert_eq!(module_ident("Loop"), "loop_");
        assert_eq!(camel("track_rotor"), "TrackRotor");
    }

    #[test]
    fn keywords_are_the_words_that_are_no_identifiers() {
        assert!(KEYWORDS.is_sorted());
        for word in KEYWORDS {
            assert!(is_keyword(word), "{word}");
            // `gen` is a keyword since edition 2024, which the parser does not ask for.
            let is_identifier = syn::parse_str::<syn::Ident>(word).is_ok();
            assert_eq!(is_identifier, word == "gen", "{word}");
        }
        for name in ["hub", "union", "default", "auto", "raw", "safe", "selfish"] {
            assert!(!is_keyword(name), "{name}");
        }
    }

    #[test]
    fn numbers_group_their_digits() {
        assert_eq!(number(1234).to_string(), "1234");
        assert_eq!(number(1_234_567).to_string(), "1_234_567");
        assert_eq!(number(i64::from(i32::MIN)).to_string(), "- 2_147_483_648");
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
