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

/// `file:line:col`, as editors and terminals recognise it; a macro call is named `macro`.
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
            Self::Variant { text, column } => write!(out, "{text}:1:{column}"),
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
