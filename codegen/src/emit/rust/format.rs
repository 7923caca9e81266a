//! Emitted tokens as text for readers.
//!
//! `prettyplease` does the work, the same on every machine. Two things it leaves undone are put
//! right here: blank lines between items, and array patterns that it breaks into one name per line.

use proc_macro2::TokenStream;
use std::io::Write as _;
use std::process::{Command, Stdio};

/// Emitted tokens as formatted text.
pub fn format_rust(tokens: &TokenStream) -> String {
    match syn::parse2(tokens.clone()) {
        Ok(file) => separate_items(&join_patterns(&prettyplease::unparse(&file))),
        // Cannot happen for what this module emits; the tokens are still the code.
        Err(_) => tokens.to_string(),
    }
}

/// The text as `rustfmt` lays it out, for files that are committed; `None` where there is no
/// `rustfmt`. Only white space changes.
pub fn rustfmt(text: &str) -> Option<String> {
    let mut process = Command::new("rustfmt")
        .args(["--edition", "2024", "--emit", "stdout", "--quiet"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .ok()?;
    // The text is written before the output is read: rustfmt reads all of it first.
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

/// A blank line before every item, but not between imports or between plain constants, and before
/// the last part of a step.
fn separate_items(text: &str) -> String {
    let mut separated = String::with_capacity(text.len());
    let mut before = "";
    for line in text.lines() {
        if ends_item(before)
            && (begins_item(line) && !stays_close(before, line) || begins_ending(before, line))
        {
            separated.push('\n');
        }
        separated.push_str(line);
        separated.push('\n');
        before = line;
    }
    separated
}

/// Items stand at the top, in the module or in an `impl` of it.
fn begins_item(line: &str) -> bool {
    let code = line.trim_start();
    let depth = line.len() - code.len();
    let words = [
        "///", "#[", "pub ", "fn ", "impl", "struct ", "const ", "static ", "use ",
    ];
    [0, 4, 8].contains(&depth) && words.iter().any(|word| code.starts_with(word))
}

/// What a step leaves behind stands apart from what it computes.
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

fn stays_close(before: &str, line: &str) -> bool {
    ["use ", "const "]
        .iter()
        .any(|word| line.trim_start().starts_with(word) && before.trim_start().starts_with(word))
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
