//! Front end: the tokens of `controller! { … }` to a [`SpecAst`].
//!
//! Works on token trees, comma by comma, so that one unreadable entry costs only itself; `syn`
//! reads attributes, visibility and literals.

use super::ast::{Board, Field, Name, Section, SpecAst, Value};
use super::board_library::library_file;
use super::field_rule::FieldRule;
use super::value::{parse_value, plain_number, unreadable};
use super::{fields, load_motor_file};
use crate::diagnostics::{Anchors, Diagnostic, Diagnostics, Location, catalogue};
use proc_macro2::{Delimiter, Literal, Punct, Spacing, TokenStream, TokenTree};
use quote::ToTokens;
use std::path::Path;
use syn::parse::{ParseStream, Parser};

/// A macro call: the type to emit and its specification.
#[derive(Clone, Debug)]
pub struct MacroInput {
    /// Doc comments and other attributes of the type.
    pub attributes: Vec<syn::Attribute>,
    /// Visibility of the type.
    pub visibility: syn::Visibility,
    /// Name of the type.
    pub name: syn::Ident,
    /// The motor file, if the call names one.
    pub motor_file: Option<FileName>,
    /// The board's name or file, if the call names one.
    pub board: Option<FileName>,
    /// The fields of the call alone.
    pub ast: SpecAst,
}

/// `motor: "motors/hub.toml"`, `board: "vesc-4"`.
#[derive(Clone, Debug)]
pub struct FileName {
    /// The literal: a path relative to the crate's root, or of a board its name.
    pub path: syn::LitStr,
}

impl MacroInput {
    /// The whole specification: the motor file under `root` (the crate's folder), if one is named,
    /// with the call's own fields and its board laid over it. Tells the paths of all that was read
    /// in `files`.
    ///
    /// # Errors
    /// If a file cannot be read or is not TOML.
    pub fn load(&self, root: &Path, files: &mut Vec<String>) -> Result<SpecAst, Diagnostics> {
        let mut call = self.ast.clone();
        if let Some(board) = &mut call.board {
            files.extend(board.read(root, Path::new(""))?);
        }
        let Some(file) = &self.motor_file else {
            return Ok(call);
        };
        let location = Location::Macro(file.path.to_token_stream());
        let mut ast = load_motor_file(root, &file.path.value(), &location, files)?;
        ast.overlay(call);
        Ok(ast)
    }

    /// Where errors of files are marked: the literal of the board's file for those in it, else that
    /// of the motor file or, without one, the type's name.
    pub fn anchors(&self) -> Anchors {
        let tokens = |file: &FileName| file.path.to_token_stream();
        let motor = self.motor_file.as_ref().map(tokens);
        let board = self.board.as_ref().map(|board| {
            let name = board.path.value();
            (library_file(&name).unwrap_or(name), tokens(board))
        });
        Anchors {
            other: motor.unwrap_or_else(|| self.name.to_token_stream()),
            file: board,
        }
    }
}

/// Parses the tokens of a macro call.
///
/// # Errors
/// If the call does not have the form `pub Name { … }`. Errors inside the braces are kept in the
/// tree and reported by [`super::check`].
pub fn parse_macro(tokens: TokenStream) -> Result<MacroInput, Diagnostics> {
    let (attributes, visibility, name, body) = header
        .parse2(tokens)
        .map_err(|error| catalogue::syntax(&location_of(&error), &error.to_string()))?;
    let location = Location::Macro(name.to_token_stream());
    let mut input = MacroInput {
        attributes,
        visibility,
        motor_file: None,
        board: None,
        ast: SpecAst::new(Name {
            text: name.to_string(),
            location,
        }),
        name,
    };
    for entry in entries(body) {
        if let Err(error) = read_section(&mut input, &entry) {
            input.ast.malformed.push(error);
            // An unreadable section is not reported as missing.
            if let Some(TokenTree::Ident(name)) = entry.tokens.first() {
                input.ast.excuse(&name.to_string());
            }
        }
    }
    Ok(input)
}

type Header = (
    Vec<syn::Attribute>,
    syn::Visibility,
    syn::Ident,
    TokenStream,
);

fn header(input: ParseStream) -> syn::Result<Header> {
    let attributes = input.call(syn::Attribute::parse_outer)?;
    let visibility = input.parse()?;
    let name: syn::Ident = input.parse().map_err(|error| {
        syn::Error::new(
            error.span(),
            "expected the name of the type, as in `pub HubDrive { motor: { … }, … }`",
        )
    })?;
    let body: proc_macro2::Group = input.parse().map_err(|error| {
        syn::Error::new(
            error.span(),
            "expected braces with `motor`, `inverter` and `controller`",
        )
    })?;
    if body.delimiter() != Delimiter::Brace {
        return Err(syn::Error::new(
            body.span_open(),
            "expected braces with `motor`, `inverter` and `controller`",
        ));
    }
    if !input.is_empty() {
        return Err(
            input.error("nothing may follow the type's braces; write one macro call per drive")
        );
    }
    Ok((attributes, visibility, name, body.stream()))
}

fn location_of(error: &syn::Error) -> Location {
    let mark = proc_macro2::Ident::new("here", error.span());
    Location::Macro(mark.to_token_stream())
}

/// `name: value` as tokens.
struct Entry {
    tokens: Vec<TokenTree>,
}

/// Splits at commas; an empty last part is a trailing comma.
fn entries(tokens: TokenStream) -> Vec<Entry> {
    let all: Vec<TokenTree> = flatten(tokens);
    let mut parts: Vec<Entry> = all
        .split(|token| is_punct(token, ','))
        .map(|part| Entry {
            tokens: part.to_vec(),
        })
        .collect();
    if parts.last().is_some_and(|last| last.tokens.is_empty()) {
        parts.pop();
    }
    parts
}

/// The entries of a section, each with what stands behind a comma inside its value: `0,5 ohm`, `a, b, c`.
fn fields(tokens: TokenStream) -> Vec<Entry> {
    let mut fields: Vec<Entry> = Vec::new();
    for entry in entries(tokens) {
        match (fields.last_mut(), entry.tokens.first()) {
            (Some(before), Some(first)) if before.goes_on(&entry) => {
                let mut comma = Punct::new(',', Spacing::Alone);
                comma.set_span(first.span());
                before.tokens.push(TokenTree::Punct(comma));
                before.tokens.extend(entry.tokens);
            }
            _ => fields.push(entry),
        }
    }
    fields
}

/// Takes the invisible groups away that `macro_rules!` puts around its fragments.
fn flatten(tokens: TokenStream) -> Vec<TokenTree> {
    tokens
        .into_iter()
        .flat_map(|token| match token {
            TokenTree::Group(group) if group.delimiter() == Delimiter::None => {
                flatten(group.stream())
            }
            other => vec![other],
        })
        .collect()
}

fn is_number(literal: &Literal) -> bool {
    literal
        .to_string()
        .starts_with(|c: char| c.is_ascii_digit())
}

fn is_punct(token: &TokenTree, sign: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == sign)
}

fn location(tokens: &[TokenTree]) -> Location {
    Location::Macro(tokens.iter().cloned().collect())
}

impl Entry {
    /// Whether the next entry is a part of this one's value, behind a comma: a number behind a number, or behind a word
    /// another one that is no field's name.
    fn goes_on(&self, next: &Self) -> bool {
        let has_value = matches!(self.tokens.as_slice(), [TokenTree::Ident(_), colon, _, ..] if is_punct(colon, ':'));
        has_value
            && match (self.tokens.last(), next.tokens.as_slice()) {
                (Some(TokenTree::Literal(before)), [TokenTree::Literal(behind), ..]) => {
                    is_number(before) && is_number(behind)
                }
                (Some(TokenTree::Ident(_)), [TokenTree::Ident(word)]) => {
                    fields::section_of(&word.to_string()).is_none()
                }
                _ => false,
            }
    }

    /// Name, its tokens and the value's tokens.
    fn split(&self) -> Result<(String, &[TokenTree], &[TokenTree]), Diagnostic> {
        let (name, value) = match self.tokens.as_slice() {
            [TokenTree::Ident(name), colon, value @ ..] if is_punct(colon, ':') => (name, value),
            [] => {
                return Err(catalogue::syntax(
                    &location(&[]),
                    "expected `name: value` before the comma",
                ));
            }
            tokens => {
                return Err(catalogue::syntax(
                    &location(tokens),
                    "expected `name: value`",
                ));
            }
        };
        let head = &self.tokens[..1];
        if value.is_empty() {
            let name = name.to_string();
            let examples = fields::field(&name).examples(&[]);
            return Err(catalogue::missing_value(&location(head), &name, &examples));
        }
        // `a: 1 ohm b: 2 H`: the comma in between was forgotten.
        if let Some(colon) = value.iter().position(|token| is_punct(token, ':')) {
            if name == "controller" && !follows_a_word(value, colon) {
                return Err(catalogue::syntax(&location(value), OPTIONS));
            }
            let next = &value[colon.saturating_sub(1)..=colon];
            return Err(catalogue::syntax(
                &location(&next[..1]),
                &format!("expected a comma before `{}`", next[0]),
            ));
        }
        Ok((name.to_string(), head, value))
    }
}

/// How a controller takes options; a command line has them as `pdcc:emf=model`.
const OPTIONS: &str =
    "options of a controller stand in braces, as in `controller: pdcc { emf: model }`";

/// Whether the token before a colon stands behind another word, as the next entry does after a forgotten comma.
fn follows_a_word(value: &[TokenTree], colon: usize) -> bool {
    let before = colon.checked_sub(2).and_then(|index| value.get(index));
    before.is_some_and(|token| !matches!(token, TokenTree::Punct(_)))
}

fn read_section(input: &mut MacroInput, entry: &Entry) -> Result<(), Diagnostic> {
    let (name, head, value) = entry.split()?;
    let at = location(head);
    match (name.as_str(), value) {
        ("motor", [TokenTree::Literal(literal)]) => {
            let path: syn::LitStr = syn::parse2(TokenTree::from(literal.clone()).into())
                .map_err(|_| expected_section(value, "motor"))?;
            if input.motor_file.is_some() || input.ast.motor.location.is_some() {
                return Err(twice(&at, &input.ast.motor, "motor"));
            }
            input.ast.motor.location = Some(at);
            input.motor_file = Some(FileName { path });
        }
        ("board", [TokenTree::Literal(literal)]) => {
            let path: syn::LitStr = syn::parse2(TokenTree::from(literal.clone()).into())
                .map_err(|_| expected_section(value, "board"))?;
            if let Some(first) = &input.board {
                let first = Location::Macro(first.path.to_token_stream());
                return Err(catalogue::duplicate_field(&at, &first, "board"));
            }
            let name = Name {
                text: path.value(),
                location: location(value),
            };
            input.board = Some(FileName { path });
            match Board::named(name) {
                Ok(board) => input.ast.board = Some(board),
                Err(errors) => {
                    // What the board would have given is not missing.
                    input.ast.excuse("inverter");
                    input
                        .ast
                        .malformed
                        .extend(errors.as_slice().iter().cloned());
                }
            }
        }
        ("motor", [TokenTree::Group(group)]) if group.delimiter() == Delimiter::Brace => {
            let section = &mut input.ast.motor;
            read_fields(
                section,
                &mut input.ast.malformed,
                at,
                "motor",
                group.stream(),
            )?;
        }
        ("inverter", [TokenTree::Group(group)]) if group.delimiter() == Delimiter::Brace => {
            let section = &mut input.ast.inverter;
            read_fields(
                section,
                &mut input.ast.malformed,
                at,
                "inverter",
                group.stream(),
            )?;
        }
        ("controller", tokens) => read_controller(input, at, tokens)?,
        _ if fields::section_of(&name).is_some_and(|section| section == "controller") => {
            return Err(catalogue::syntax(
                &at,
                &format!("`{name}` is an option; {OPTIONS}"),
            ));
        }
        ("motor" | "board" | "inverter", _) => return Err(expected_section(value, &name)),
        _ => {
            let known = ["motor", "board", "inverter", "controller"];
            let fields = field_names(value);
            let fields: Vec<&str> = fields.iter().map(String::as_str).collect();
            input
                .ast
                .unknown_section(&at, &name, &known, fields::section_of_most(&fields));
        }
    }
    Ok(())
}

/// Names of the fields in a section's braces.
fn field_names(value: &[TokenTree]) -> Vec<String> {
    let [TokenTree::Group(group)] = value else {
        return vec![];
    };
    let entries = entries(group.stream());
    let names = entries
        .iter()
        .filter_map(|entry| Some(entry.split().ok()?.0));
    names.collect()
}

fn expected_section(value: &[TokenTree], name: &str) -> Diagnostic {
    let wanted = match name {
        "motor" => "`motor` takes braces with fields or the path of a motor file",
        "board" => {
            "`board` takes the name of a board or the path of its file, in quotes, as in `board: \"vesc-4\"`; the fields of an inverter of your own stand in `inverter`"
        }
        "controller" => {
            "`controller` takes the name of a controller and braces with its options, as in `controller: pdcc { emf: model }`"
        }
        _ => "`inverter` takes braces with fields",
    };
    catalogue::syntax(&location(value), wanted)
}

fn twice(at: &Location, section: &Section, name: &str) -> Diagnostic {
    catalogue::duplicate_field(at, section.location.as_ref().unwrap_or(at), name)
}

fn read_controller(
    input: &mut MacroInput,
    at: Location,
    value: &[TokenTree],
) -> Result<(), Diagnostic> {
    let (kind, options) = match value {
        [kind @ .., TokenTree::Group(group)] if group.delimiter() == Delimiter::Brace => {
            (kind, group.stream())
        }
        kind => (kind, TokenStream::new()),
    };
    let kind_location = location(kind);
    let word = parse_value(fields::field("kind"), &text_of(kind), &kind_location);
    if kind.is_empty() || !matches!(word, Value::Word(_)) {
        return Err(expected_section(value, "controller"));
    }
    let section = &mut input.ast.controller;
    read_fields(section, &mut input.ast.malformed, at, "controller", options)?;
    section.fields.insert(
        0,
        Field {
            name: "kind".to_owned(),
            name_location: kind_location.clone(),
            value: word,
            location: kind_location,
            assumed: None,
        },
    );
    Ok(())
}

fn read_fields(
    section: &mut Section,
    malformed: &mut Vec<Diagnostic>,
    at: Location,
    name: &str,
    tokens: TokenStream,
) -> Result<(), Diagnostic> {
    if section.location.is_some() {
        return Err(twice(&at, section, name));
    }
    section.location = Some(at);
    for entry in fields(tokens) {
        match entry.split() {
            Ok((name, head, value)) => section.fields.push(Field {
                value: read_value(fields::field(&name), value),
                name,
                name_location: location(head),
                location: location(value),
                assumed: None,
            }),
            Err(error) => {
                malformed.push(error);
                section.incomplete = true;
            }
        }
    }
    Ok(())
}

fn read_value(field: FieldRule, tokens: &[TokenTree]) -> Value {
    let at = location(tokens);
    if let [TokenTree::Literal(literal)] = tokens {
        let written = literal.to_string();
        let literal = TokenTree::from(literal.clone());
        if let Ok(text) = syn::parse2::<syn::LitStr>(literal.clone().into()) {
            // Quotes are for text: in the macro all else stands as tokens.
            return if field.is_text() {
                parse_value(field, &text.value(), &at)
            } else {
                unreadable(field, &written, &at)
            };
        }
        if ["0x", "0o", "0b"]
            .iter()
            .any(|base| written.starts_with(base))
        {
            return unreadable(field, &written, &at);
        }
        if let Ok(number) = syn::parse2::<syn::LitInt>(literal.into())
            && number.suffix().is_empty()
        {
            return plain_number(field, number.base10_digits(), &at);
        }
    }
    parse_value(field, &text_of(tokens), &at)
}

/// The tokens as text; white space carries no meaning for the value's reader.
fn text_of(tokens: &[TokenTree]) -> String {
    let parts: Vec<String> = tokens
        .iter()
        .map(|token| match token {
            TokenTree::Group(group) => {
                let inner = text_of(&flatten(group.stream()));
                match group.delimiter() {
                    Delimiter::Parenthesis => format!("({inner})"),
                    Delimiter::Bracket => format!("[{inner}]"),
                    Delimiter::Brace => format!("{{{inner}}}"),
                    Delimiter::None => inner,
                }
            }
            other => other.to_string(),
        })
        .collect();
    parts.join(" ").replace(" , ", ", ")
}
