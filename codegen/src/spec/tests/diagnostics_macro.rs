//! The wording of every error in a macro call. The inputs are the macro calls of `tests/ui`, where
//! the compiler's rendering of the same errors is tested; here their texts, places and notes.

use crate::diagnostics::{Code, Diagnostics};
use crate::spec::{check, parse_macro};
use proc_macro2::{TokenStream, TokenTree};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Name and tokens of every case.
fn cases() -> Vec<(String, TokenStream)> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/ui"));
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("the cases are there")
        .map(|entry| entry.expect("readable entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect();
    files.sort();
    files
        .iter()
        .map(|path| (file_stem(path), macro_call(path)))
        .collect()
}

fn file_stem(path: &Path) -> String {
    path.file_stem()
        .expect("is a file")
        .to_string_lossy()
        .into_owned()
}

/// The tokens inside `controller! { … }` of a file.
fn macro_call(path: &Path) -> TokenStream {
    let text = std::fs::read_to_string(path).expect("readable file");
    let tokens: Vec<TokenTree> = text
        .parse::<TokenStream>()
        .expect("lexes")
        .into_iter()
        .collect();
    let bang = tokens
        .iter()
        .position(|token| matches!(token, TokenTree::Punct(punct) if punct.as_char() == '!'))
        .expect("has a macro call");
    match &tokens[bang + 1] {
        TokenTree::Group(group) => group.stream(),
        other => panic!("{other} after the bang"),
    }
}

fn errors(tokens: TokenStream) -> Option<Diagnostics> {
    parse_macro(tokens)
        .and_then(|input| input.load(Path::new("nowhere")))
        .and_then(|ast| check(&ast))
        .err()
}

#[test]
fn texts_and_places() {
    let mut text = String::new();
    for (name, tokens) in cases() {
        let errors = errors(tokens).unwrap_or_else(|| panic!("{name} is without error"));
        writeln!(text, "# {name}\n{errors}\n").expect("writes to a string");
    }
    insta::assert_snapshot!("macro_diagnostics", text);
}

/// Codes that do not come from the checks of a macro call, and the stages they come from.
fn other_stages() -> BTreeSet<Code> {
    [
        // Names of files and command lines.
        Code::InvalidName,
        Code::Variant,
        // Design, scaling and verification.
        Code::VectorTooStrong,
        Code::InductanceOutsideStableRange,
        Code::ResistanceOutsideStableRange,
        Code::Unstable,
        Code::WordTooNarrow,
        Code::SwitchingTableLosesCurrent,
        Code::EstimateTurnsTooFar,
        Code::TripFarAbove,
        Code::SwingAboveTrip,
        Code::Internal,
    ]
    .into()
}

#[test]
fn every_kind_of_error_has_a_case() {
    let mut seen = BTreeSet::new();
    for (_, tokens) in cases() {
        let errors = errors(tokens).map(Diagnostics::into_iter);
        seen.extend(errors.into_iter().flatten().map(|error| error.code));
    }
    let missing: Vec<&Code> = Code::ALL
        .iter()
        .filter(|code| !seen.contains(code) && !other_stages().contains(code))
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn errors_are_told_at_once_and_in_order() {
    let (_, tokens) = cases()
        .into_iter()
        .find(|(name, _)| name == "several_errors")
        .expect("the case is there");
    let codes: Vec<Code> = errors(tokens)
        .expect("has errors")
        .into_iter()
        .map(|error| error.code)
        .collect();
    assert_eq!(
        codes,
        [
            Code::NotPositive,
            Code::MissingBasis,
            Code::UnknownWord,
            Code::MissingUnit,
            Code::OutOfRange
        ]
    );
}

/// Text that was pasted together at random must never panic, whatever it says.
#[test]
fn garbage_is_refused_without_a_panic() {
    let pieces = [
        "motor",
        ":",
        "{",
        "}",
        "pole_pairs",
        "4",
        ",",
        "-",
        "\"x\"",
        "[1]",
        "controller",
        "pdcc",
        "1e400",
        "V/(rad/s)",
        "per_phase",
        "pub",
        "Hub",
        "(",
        ")",
        "'a'",
        "0x1F",
        "1.5.2",
    ];
    let mut state = 12_345_u64;
    for _ in 0..4000 {
        let mut text = String::from("Hub { ");
        for _ in 0..12 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            text.push_str(pieces[(state >> 33) as usize % pieces.len()]);
            text.push(' ');
        }
        text.push('}');
        if let Ok(tokens) = text.parse::<TokenStream>() {
            assert!(errors(tokens).is_some(), "{text}");
        }
    }
}
