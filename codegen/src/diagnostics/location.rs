//! Places in the input of a specification.

use proc_macro2::TokenStream;
use std::fmt;

/// Where a value, a field or a section was written.
#[derive(Clone, Debug)]
pub enum Location {
    /// Tokens of a macro call; an error spans all of them, so value and unit together.
    Macro(TokenStream),
    /// A place in a TOML file.
    File {
        /// The file's name as it was given, never made absolute.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
    },
    /// A place in a controller variant such as `pdcc:modulation=pair`.
    Variant {
        /// The whole variant text.
        text: String,
        /// Column in characters, from 1.
        column: usize,
    },
}

impl Location {
    /// The place of byte `offset` in the text of `file`.
    pub fn in_file(file: &str, text: &str, offset: usize) -> Self {
        let before = text.get(..offset).unwrap_or(text);
        let line = before.matches('\n').count() + 1;
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let column = before[line_start..].chars().count() + 1;
        Self::File {
            file: file.to_owned(),
            line,
            column,
        }
    }
}

impl Location {
    /// A text for people with its settings as they are written at this place. Texts say them as the
    /// macro does, in backticks: `word: 32`; a file takes `word = 32`, a variant `word=32`.
    pub(super) fn in_its_words(&self, text: &str) -> String {
        if matches!(self, Self::Macro(_)) {
            return text.to_owned();
        }
        let mut pieces: Vec<String> = text.split('`').map(str::to_owned).collect();
        for (index, piece) in pieces.iter_mut().enumerate() {
            // Between two backticks.
            if index % 2 == 1
                && let Some((name, value)) = piece.split_once(": ")
                && !name.is_empty()
                && name.chars().all(|c| c.is_ascii_lowercase() || c == '_')
            {
                *piece = self.setting(name, value);
            }
        }
        pieces.join("`")
    }

    fn setting(&self, name: &str, value: &str) -> String {
        match self {
            Self::Macro(_) => format!("{name}: {value}"),
            Self::Variant { .. } => format!("{name}={}", value.replace(' ', "")),
            Self::File { .. } => {
                let name = if name == "controller" { "kind" } else { name };
                let list = value
                    .strip_prefix('[')
                    .and_then(|list| list.strip_suffix(']'));
                match list {
                    Some(list) => {
                        let items: Vec<String> = list.split(", ").map(quoted).collect();
                        format!("{name} = [{}]", items.join(", "))
                    }
                    None => format!("{name} = {}", quoted(value)),
                }
            }
        }
    }
}

/// A value in a file: numbers are bare, all else is in quotes.
fn quoted(value: &str) -> String {
    let is_bare = value.starts_with(['"', '{']) || value.parse::<f64>().is_ok_and(f64::is_finite);
    if is_bare {
        value.to_owned()
    } else {
        format!("\"{value}\"")
    }
}

/// `file:line:col`, as editors and terminals recognise it; a macro call is named `macro`; of a command's argument,
/// ``argument `text`, character n``.
impl fmt::Display for Location {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Macro(tokens) => match tokens.clone().into_iter().next() {
                Some(first) => {
                    let start = first.span().start();
                    write!(out, "macro:{}:{}", start.line, start.column + 1)
                }
                None => out.write_str("macro"),
            },
            Self::File { file, line, column } => write!(out, "{file}:{line}:{column}"),
            Self::Variant { text, column: 1 } => write!(out, "argument `{text}`"),
            Self::Variant { text, column } => {
                write!(out, "argument `{text}`, character {column}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Location;

    #[test]
    fn columns_count_characters() {
        let text = "a\nµ = 1\n";
        assert_eq!(
            Location::in_file("m.toml", text, 2).to_string(),
            "m.toml:2:1"
        );
        let offset = text.find('=').expect("has an equals sign");
        assert_eq!(
            Location::in_file("m.toml", text, offset).to_string(),
            "m.toml:2:3"
        );
    }

    #[test]
    fn a_macro_place_is_its_first_token() {
        let tokens: proc_macro2::TokenStream = " 135 mohm".parse().expect("lexes");
        assert_eq!(Location::Macro(tokens).to_string(), "macro:1:2");
    }
}
