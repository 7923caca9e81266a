//! Emitted tokens as text for readers.
//!
//! `prettyplease` formats, the same on every machine. Two things are added: blank lines between
//! items, and array patterns on one line.

use proc_macro2::TokenStream;
use std::io::Write as _;
use std::process::{Command, Stdio};

/// Emitted tokens as formatted text.
pub fn format_rust(tokens: &TokenStream) -> String {
    match syn::parse2(tokens.clone()) {
        Ok(file) => separate_items(&join_patterns(&prettyplease::unparse(&file))),
        // Cannot happen for emitted code; the tokens are still the code.
        Err(_) => tokens.to_string(),
    }
}

/// Emitted tokens for readers: formatted by `rustfmt` if it is there, else by [`format_rust`].
pub fn readable_rust(tokens: &TokenStream) -> String {
    let text = format_rust(tokens);
    rustfmt(&text).unwrap_or(text)
}

/// The text formatted by `rustfmt`, in lines of up to 100 columns; `None` without `rustfmt`.
pub fn rustfmt(text: &str) -> Option<String> {
    let mut process = Command::new("rustfmt")
        .args(["--edition", "2024", "--emit", "stdout", "--quiet"])
        .args(["--config", "use_small_heuristics=Max"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .ok()?;
    // rustfmt reads all of its input before it writes.
    process.stdin.take()?.write_all(text.as_bytes()).ok()?;
    let output = process.wait_with_output().ok()?;
    output
        .status
        .success()
        .then(|| String::from_utf8(output.stdout).ok())
        .flatten()
}

/// `[i_a,⏎ i_b,⏎ ]` becomes `[i_a, i_b]`.
fn join_patterns(text: &str) -> String {
    let mut joined = String::with_capacity(text.len());
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        joined.push_str(line);
        let begins = line
            .trim_start()
            .strip_prefix('[')
            .and_then(|rest| rest.strip_suffix(','))
            .is_some_and(is_name);
        if begins {
            for next in lines.by_ref() {
                let next = next.trim_start();
                if next.strip_suffix(',').is_some_and(is_name) {
                    joined.push(' ');
                    joined.push_str(next);
                } else {
                    joined.truncate(joined.trim_end_matches(',').len());
                    joined.push_str(next);
                    break;
                }
            }
        }
        joined.push('\n');
    }
    joined
}

fn is_name(text: &str) -> bool {
    !text.is_empty()
        && text
            .chars()
            .all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
}

/// A blank line before every item, except between imports and between constants, and before the
/// last part of a step.
fn separate_items(text: &str) -> String {
    let mut separated = String::with_capacity(text.len());
    let lines: Vec<&str> = text.lines().collect();
    let (mut before, mut last) = ("", "");
    for (index, line) in lines.iter().enumerate() {
        let item = if begins_item(line) {
            item_of(&lines[index..])
        } else {
            ""
        };
        if ends_item(before)
            && (!item.is_empty() && (before.ends_with('}') || !stays_close(last, item))
                || begins_ending(before, line))
        {
            separated.push('\n');
        }
        if !item.is_empty() {
            last = item;
        }
        separated.push_str(line);
        separated.push('\n');
        before = line;
    }
    separated
}

/// Whether a line begins an item at the top level or in an `impl` there.
fn begins_item(line: &str) -> bool {
    let code = line.trim_start();
    let depth = line.len() - code.len();
    let words = [
        "///", "#[", "pub ", "fn ", "impl", "struct ", "const ", "static ", "use ",
    ];
    [0, 4, 8].contains(&depth) && words.iter().any(|word| code.starts_with(word))
}

/// The first line of an item after its documentation and attributes.
fn item_of<'t>(lines: &[&'t str]) -> &'t str {
    let is_before = |line: &str| line.starts_with("///") || line.starts_with("#[");
    let mut code = lines.iter().map(|line| line.trim_start());
    code.find(|line| !is_before(line)).unwrap_or_default()
}

/// Whether a line begins the last part of a step, the stores.
fn begins_ending(before: &str, line: &str) -> bool {
    let stores = |line: &str| line.trim_start().starts_with("state.");
    stores(line) && !stores(before) || line.trim_start().starts_with("Legs::new(")
}

fn ends_item(line: &str) -> bool {
    if line.trim_start().starts_with("///") {
        return false;
    }
    line.ends_with(';') || line.ends_with('}') || line.trim_start().starts_with("//!")
}

fn stays_close(before: &str, item: &str) -> bool {
    let bare = |line: &str| line.strip_prefix("pub ").unwrap_or(line).to_owned();
    let (before, item) = (bare(before), bare(item));
    ["use ", "const ", "type "]
        .iter()
        .any(|word| item.starts_with(word) && before.starts_with(word))
        && !item.starts_with("const fn")
}

#[cfg(test)]
mod tests {
    use super::format_rust;
    use quote::quote;

    #[test]
    fn text_reads_as_if_written_by_hand() {
        let tokens = quote! {
            pub mod drive {
                use a::B;
                use c::D;
                /// One.
                const ONE: Word = Word(1);
                fn limit_torque_priority([e_a, e_b]: [Word; 2], [u_a_unsat, u_b_unsat, u_c_unsat]: [Word; 3], middle_unsat: Word) -> Word {
                    e_a
                }
                fn other() {}
            }
        };
        let expected = "\
pub mod drive {
    use a::B;
    use c::D;

    /// One.
    const ONE: Word = Word(1);

    fn limit_torque_priority(
        [e_a, e_b]: [Word; 2],
        [u_a_unsat, u_b_unsat, u_c_unsat]: [Word; 3],
        middle_unsat: Word,
    ) -> Word {
        e_a
    }

    fn other() {}
}
";
        assert_eq!(format_rust(&tokens), expected);
    }
}
