//! Errors and warnings as text; in macros errors as `compile_error!` and warnings as uses of a
//! deprecated constant.

use super::{Diagnostic, Diagnostics, Location};
use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;
use std::fmt;

/// One line per diagnostic and note: `file:line:col: error[HX0203]: message`.
impl fmt::Display for Diagnostic {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = if self.code.is_warning() {
            "warning"
        } else {
            "error"
        };
        write!(
            out,
            "{}: {severity}[{}]: {}",
            self.location, self.code, self.message
        )?;
        for note in &self.notes {
            write!(out, "\n{}: note: {}", note.location, note.message)?;
        }
        Ok(())
    }
}

/// All errors, each on its own lines.
impl fmt::Display for Diagnostics {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, error) in self.as_slice().iter().enumerate() {
            if index > 0 {
                out.write_str("\n")?;
            }
            write!(out, "{error}")?;
        }
        Ok(())
    }
}

/// What is marked in a macro call for places outside of it.
#[derive(Clone, Debug, Default)]
pub struct Anchors {
    /// The tokens for all files but the one below.
    pub other: TokenStream,
    /// A file that has tokens of its own.
    pub file: Option<(String, TokenStream)>,
}

impl Anchors {
    /// The tokens of a place.
    fn of<'a>(&'a self, place: &'a Location) -> &'a TokenStream {
        match (place, &self.file) {
            (Location::Macro(tokens), _) => tokens,
            (Location::File { file, .. }, Some((name, tokens))) if file == name => tokens,
            _ => &self.other,
        }
    }
}

impl Diagnostics {
    /// One `compile_error!` per error and one per note in the macro call, so that every field
    /// involved is marked: the compiler has no stable way to attach notes.
    ///
    /// Places outside the macro call (in files) are marked at `anchors`, the files' literals or the
    /// type name, and named `file:line:col` in the message.
    pub fn to_compile_errors(&self, anchors: &Anchors) -> TokenStream {
        self.as_slice()
            .iter()
            .flat_map(|error| error.to_compile_errors(anchors))
            .collect()
    }
}

impl Diagnostic {
    /// A compiler warning. On stable Rust a macro can warn only by using something deprecated.
    pub fn to_compile_warning(&self, anchors: &Anchors) -> TokenStream {
        let name = self.code.to_string();
        let tokens = anchors.of(&self.location);
        let message = match &self.location {
            Location::Macro(_) => self.message.clone(),
            place => format!("{place}: {}", self.message),
        };
        let span = tokens.clone().into_iter().next().map(|token| token.span());
        let name = Ident::new(&name, span.unwrap_or_else(Span::call_site));
        quote! {
            const _: () = {
                #[deprecated(note = #message)]
                const #name: () = ();
                #name
            };
        }
    }

    fn to_compile_errors(&self, anchors: &Anchors) -> TokenStream {
        let mut message = format!("[{}] {}", self.code, self.message);
        if !matches!(self.location, Location::Macro(_)) {
            message = format!("{}: {message}", self.location);
        }
        let mut marked = Vec::new();
        for note in &self.notes {
            match &note.location {
                Location::Macro(tokens) => {
                    marked.push((
                        tokens,
                        format!("[{}] also here: {}", self.code, note.message),
                    ));
                }
                place => {
                    message = format!("{message}\n{place}: {}", note.message);
                }
            }
        }
        let mut errors = compile_error(anchors.of(&self.location), &message);
        errors.extend(
            marked
                .into_iter()
                .map(|(tokens, text)| compile_error(tokens, &text)),
        );
        errors
    }
}

/// Spans from the first to the last of `tokens` (the whole call if there are none).
fn compile_error(tokens: &TokenStream, message: &str) -> TokenStream {
    syn::Error::new_spanned(tokens, message).to_compile_error()
}

#[cfg(test)]
mod tests {
    use crate::diagnostics::{Anchors, Code, Collector, Diagnostic, Location};
    use proc_macro2::TokenStream;

    fn tokens(text: &str) -> TokenStream {
        text.parse().expect("lexes")
    }

    #[test]
    fn text_names_place_code_and_notes() {
        let place = |line| Location::File {
            file: "motors/hub.toml".into(),
            line,
            column: 3,
        };
        let error = Diagnostic::new(Code::DuplicateField, &place(9), "`resistance` twice")
            .with_note(&place(4), "first here");
        assert_eq!(
            error.to_string(),
            "motors/hub.toml:9:3: error[HX0104]: `resistance` twice\nmotors/hub.toml:4:3: note: first here"
        );
    }

    #[test]
    fn every_macro_place_is_marked_and_files_are_named() {
        let mut errors = Collector::new();
        errors.push(
            Diagnostic::new(
                Code::DuplicateField,
                &Location::Macro(tokens("1 ohm")),
                "twice",
            )
            .with_note(&Location::Macro(tokens("2 ohm")), "first here"),
        );
        let file = Location::File {
            file: "hub.toml".into(),
            line: 2,
            column: 1,
        };
        errors.push(Diagnostic::new(Code::MissingField, &file, "missing"));
        let rendered = errors
            .finish()
            .expect("has errors")
            .to_compile_errors(&Anchors {
                other: tokens("\"hub.toml\""),
                file: None,
            })
            .to_string();
        assert_eq!(rendered.matches("compile_error").count(), 3);
        assert!(
            rendered.contains("hub.toml:2:1: [HX0105] missing"),
            "{rendered}"
        );
    }
}
