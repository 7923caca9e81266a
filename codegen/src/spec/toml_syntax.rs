//! Front end: a TOML motor file to a [`SpecAst`], a board's file to a [`BoardFile`].
//!
//! Sections `[motor]`, `[inverter]`, `[controller]` with the macro's fields and values as strings;
//! `[assumed.motor]` and `[assumed.inverter]` with `{ value = "…", reason = "…" }` for what the
//! data sheet lacks; `[source]` free text; before them `board`, a name or a path. A board's file
//! has `[board]` with a description, and of the sections the inverter's and `[source]` alone. Every
//! place is kept as file, line and column.

use super::ast::{Board, BoardFile, Field, Name, Section, SpecAst, Value};
use super::board_library::{BOARDS, file_of};
use super::field_rule::FieldRule;
use super::fields;
use super::value::{free_text, no_text, parse_value, plain_number, unreadable};
use crate::diagnostics::{Diagnostic, Diagnostics, Location, catalogue};
use std::ops::Range;
use std::path::Path;
use toml_edit::{Document, Item, Key, TableLike};

const SECTIONS: [&str; 5] = ["motor", "inverter", "controller", "assumed", "source"];
const BOARD_SECTIONS: [&str; 5] = ["board", "inverter", "controller", "assumed", "source"];

/// Parses the text of a motor file; `file_name` is used in messages and, without folder and
/// extension, as the default name of the drive.
///
/// # Errors
/// If the text is not TOML. Errors in fields are kept in the tree and come with [`super::check`].
pub fn parse_toml(text: &str, file_name: &str) -> Result<SpecAst, Diagnostics> {
    let file = File {
        name: file_name,
        text,
    };
    let document = Document::parse(text).map_err(|error| file.syntax_error(&error))?;
    let mut ast = SpecAst::new(Name {
        text: type_name(file_name),
        location: file.at(0),
    });
    for (name, item) in document.iter() {
        let at = file.key(document.key(name), item);
        if name == "board" && !item.is_table_like() {
            match file.read_board(item) {
                Ok(board) => ast.board = Some(board),
                Err(errors) => {
                    ast.malformed.extend(errors.as_slice().iter().cloned());
                    // What the board would state is not reported as missing.
                    ast.excuse("inverter");
                }
            }
            continue;
        }
        let Some(table) = item.as_table_like() else {
            if SECTIONS.contains(&name) {
                ast.malformed.push(catalogue::not_a_section(&at, name));
                ast.excuse(name);
            } else {
                ast.unknown_section(&at, name, &SECTIONS, None);
            }
            continue;
        };
        match name {
            // Nothing else in a board's file is that of a motor.
            "board" if document.get("motor").is_none() => {
                return Err(catalogue::board_for_motor(&at).into());
            }
            "motor" => file.read_fields(&mut ast.motor, at, table),
            "inverter" => file.read_fields(&mut ast.inverter, at, table),
            "controller" => file.read_fields(&mut ast.controller, at, table),
            "assumed" => file.read_assumed(&mut ast, table, &["motor", "inverter"]),
            "source" => file.read_source(&mut ast, table),
            _ => ast.unknown_section(&at, name, &SECTIONS, fields::section_of_most(&keys(table))),
        }
    }
    // `name` stands in `[motor]` but belongs to the drive.
    if let Some(index) = ast
        .motor
        .fields
        .iter()
        .position(|field| field.name == "name")
    {
        let field = ast.motor.fields.remove(index);
        match field.value {
            Value::Text(text) => {
                ast.name = Name {
                    text,
                    location: field.location,
                };
            }
            Value::Malformed(error) => ast.malformed.push(*error),
            _ => {}
        }
    }
    Ok(ast)
}

/// Parses the text of a board's file; `file_name` is used in messages.
///
/// # Errors
/// If the text is no TOML. Errors in fields are kept and come with [`super::check`].
pub fn parse_board(text: &str, file_name: &str) -> Result<BoardFile, Diagnostics> {
    let file = File {
        name: file_name,
        text,
    };
    let document = Document::parse(text).map_err(|error| file.syntax_error(&error))?;
    let mut ast = SpecAst::new(Name {
        text: String::new(),
        location: file.at(0),
    });
    let mut description = None;
    for (name, item) in document.iter() {
        let at = file.key(document.key(name), item);
        let table = item.as_table_like();
        match (name, table) {
            ("board", Some(table)) => {
                let mut about = Section::default();
                file.read_fields(&mut about, at, table);
                for field in about.fields {
                    match (field.name.as_str(), field.value) {
                        ("description", Value::Text(text)) => description = Some(text),
                        ("description", Value::Malformed(error)) => ast.malformed.push(*error),
                        (name, _) => ast.malformed.push(catalogue::unknown_section(
                            &field.name_location,
                            &format!("board.{name}"),
                            &["board.description"],
                            None,
                        )),
                    }
                }
            }
            ("inverter", Some(table)) => file.read_fields(&mut ast.inverter, at, table),
            ("controller", Some(table)) => {
                file.read_fields(&mut ast.controller, at, table);
                ast.refuse_all_but_core();
            }
            ("assumed", Some(table)) => file.read_assumed(&mut ast, table, &["inverter"]),
            ("source", Some(table)) => file.read_source(&mut ast, table),
            (name, None) if BOARD_SECTIONS.contains(&name) => {
                ast.malformed.push(catalogue::not_a_section(&at, name));
            }
            (name, table) => {
                let fields = table.map_or(vec![], keys);
                ast.unknown_section(&at, name, &BOARD_SECTIONS, fields::section_of_most(&fields));
            }
        }
    }
    if document.get("board").is_none() && document.get("inverter").is_none() {
        ast.malformed.push(catalogue::not_a_board(&file.at(0)));
    }
    Ok(BoardFile {
        description,
        inverter: ast.inverter,
        core: ast.controller,
        source: ast.source,
        malformed: ast.malformed,
    })
}

impl Board {
    /// A board by its name: one of the library is read, a file is not yet.
    ///
    /// # Errors
    /// If the library has no board of that name and it is no path of a TOML file.
    pub fn named(name: Name) -> Result<Self, Diagnostics> {
        let known = BOARDS.iter().find(|board| board.name == name.text);
        let extension = Path::new(&name.text).extension();
        let file = match known {
            Some(board) => Some(parse_board(board.text, &file_of(board.name))?),
            None if extension.is_some_and(|extension| extension == "toml") => None,
            None => {
                let names = BOARDS.map(|board| board.name);
                return Err(catalogue::unknown_board(&name.location, &name.text, &names).into());
            }
        };
        Ok(Self { name, file })
    }
}

struct File<'a> {
    name: &'a str,
    text: &'a str,
}

impl File<'_> {
    fn at(&self, offset: usize) -> Location {
        Location::in_file(self.name, self.text, offset)
    }

    fn span(&self, span: Option<Range<usize>>) -> Location {
        self.at(span.map_or(0, |range| range.start))
    }

    fn key(&self, key: Option<&Key>, item: &Item) -> Location {
        self.span(key.and_then(Key::span).or_else(|| item.span()))
    }

    fn read_fields(&self, section: &mut Section, at: Location, table: &dyn TableLike) {
        section.location.get_or_insert(at);
        for (name, item) in table.iter() {
            let location = self.span(item.span());
            section.fields.push(Field {
                name: name.to_owned(),
                name_location: self.key(table.key(name), item),
                value: self.read_value(fields::field(name), item, &location),
                location,
                assumed: None,
            });
        }
    }

    fn read_source(&self, ast: &mut SpecAst, table: &dyn TableLike) {
        for (key, item) in table.iter() {
            let Some(text) = item.as_str() else {
                continue;
            };
            match free_text(fields::field(key), text, &self.span(item.span())) {
                Ok(text) => ast.source.push((key.to_owned(), text)),
                Err(error) => ast.malformed.push(error),
            }
        }
    }

    /// `board = "vesc-4"`.
    fn read_board(&self, item: &Item) -> Result<Board, Diagnostics> {
        let location = self.span(item.span());
        let Some(text) = item.as_str() else {
            let wanted = "`board` takes the name of a board or the path of its file, in quotes";
            return Err(catalogue::syntax(&location, wanted).into());
        };
        Board::named(Name {
            text: text.to_owned(),
            location,
        })
    }

    /// `[assumed.motor]`: `field = { value = "…", reason = "…" }`.
    fn read_assumed(&self, ast: &mut SpecAst, assumed: &dyn TableLike, known: &[&str]) {
        for (name, item) in assumed.iter() {
            let at = self.key(assumed.key(name), item);
            let section = match name {
                "motor" if known.contains(&name) => &mut ast.motor,
                "inverter" => &mut ast.inverter,
                _ => {
                    ast.malformed
                        .push(catalogue::unknown_section(&at, name, known, None));
                    continue;
                }
            };
            let Some(table) = item.as_table_like() else {
                let path = format!("assumed.{name}");
                ast.malformed.push(catalogue::not_a_section(&at, &path));
                continue;
            };
            section.location.get_or_insert(at);
            for (field, item) in table.iter() {
                let name_location = self.key(table.key(field), item);
                match self.read_assumption(field, item, name_location) {
                    Ok(field) => section.fields.push(field),
                    Err(error) => {
                        ast.malformed.push(error);
                        section.incomplete = true;
                    }
                }
            }
        }
    }

    fn read_assumption(
        &self,
        name: &str,
        item: &Item,
        name_location: Location,
    ) -> Result<Field, Diagnostic> {
        let table = item.as_table_like();
        let value = table.and_then(|table| table.get("value"));
        let reason = table
            .and_then(|table| table.get("reason"))
            .and_then(|reason| Some((reason.as_str()?, self.span(reason.span()))));
        let (Some(value), Some((reason, reason_location))) = (value, reason) else {
            let given = value.or(Some(item)).and_then(Item::as_str);
            let values = given.map_or_else(
                || fields::field(name).examples(&[]),
                |given| vec![given.to_owned()],
            );
            return Err(catalogue::assumption(&name_location, name, &values));
        };
        let reason = free_text(fields::field(name), reason, &reason_location)?;
        let location = self.span(value.span());
        Ok(Field {
            name: name.to_owned(),
            name_location,
            value: self.read_value(fields::field(name), value, &location),
            location,
            assumed: Some(reason),
        })
    }

    fn syntax_error(&self, error: &toml_edit::TomlError) -> Diagnostics {
        let span = error.span();
        let start = span.as_ref().map_or(0, |range| range.start);
        let at = self.at(start);
        if error.message().contains("duplicate key") {
            let key = span
                .and_then(|range| self.text.get(range))
                .unwrap_or_default();
            if let Some(first) = self.earlier_key(key.trim(), start) {
                return catalogue::duplicate_field(&at, &self.at(first), key.trim()).into();
            }
        }
        catalogue::syntax(&at, &format!("invalid TOML: {}", error.message())).into()
    }

    /// Byte offset of the same key or section header before `end`; a key's search ends at its
    /// section's header.
    fn earlier_key(&self, key: &str, end: usize) -> Option<usize> {
        let before = self.text.get(..end)?;
        let lines: Vec<(usize, &str)> = before
            .split_inclusive('\n')
            .scan(0, |offset, line| {
                let start = *offset;
                *offset += line.len();
                Some((start, line))
            })
            .collect();
        let is_header = lines
            .last()
            .is_some_and(|(_, line)| line.trim_start().starts_with('['));
        for (start, line) in lines.iter().rev().skip(usize::from(is_header)) {
            let indent = line.len() - line.trim_start().len();
            let content = line.trim();
            if is_header {
                if content
                    .trim_start_matches('[')
                    .split(']')
                    .next()
                    .map(str::trim)
                    == Some(key)
                {
                    return Some(start + indent + 1);
                }
            } else if content.starts_with('[') {
                return None;
            } else if content.split('=').next().map(str::trim) == Some(key) {
                return Some(start + indent);
            }
        }
        None
    }

    fn read_value(&self, field: FieldRule, item: &Item, at: &Location) -> Value {
        let unreadable = |given: &str| {
            if field.is_text() {
                no_text(field, given, at)
            } else {
                unreadable(field, given, at)
            }
        };
        match item.as_value() {
            Some(toml_edit::Value::String(text)) => parse_value(field, text.value(), at),
            // As written: only decimal numbers are accepted.
            Some(number @ (toml_edit::Value::Integer(_) | toml_edit::Value::Float(_))) => {
                plain_number(field, self.written(number), at)
            }
            Some(toml_edit::Value::Boolean(flag)) if !field.is_text() => {
                Value::Word(flag.value().to_string())
            }
            Some(array @ toml_edit::Value::Array(list)) if !field.is_text() => {
                let numbers: Option<Vec<i64>> = list
                    .iter()
                    .map(|number| {
                        let is_decimal = self.written(number).parse() == Ok(number.as_integer()?);
                        number.as_integer().filter(|_| is_decimal)
                    })
                    .collect();
                match numbers {
                    Some(numbers) => Value::Integers(numbers),
                    None if field.takes_each() => self.read_each(field, list, at),
                    None => unreadable(self.written(array)),
                }
            }
            Some(other) => unreadable(self.written(other)),
            None => unreadable("a table"),
        }
    }

    /// A value of each sensed phase.
    fn read_each(&self, field: FieldRule, list: &toml_edit::Array, at: &Location) -> Value {
        let mut values = vec![];
        for item in list {
            let item = Item::Value(item.clone());
            match self.read_value(field, &item, at) {
                error @ Value::Malformed(_) => return error,
                value => values.push(value),
            }
        }
        Value::List(values)
    }

    /// A value as written in the file.
    fn written(&self, value: &toml_edit::Value) -> &str {
        value
            .span()
            .and_then(|range| self.text.get(range))
            .unwrap_or_default()
    }
}

/// The names in a section.
fn keys(table: &dyn TableLike) -> Vec<&str> {
    table.iter().map(|(name, _)| name).collect()
}

/// Name of a type for a file without a name of its own: `motors/rear-hub.toml` is `RearHub`.
pub(super) fn type_name(file_name: &str) -> String {
    let stem = Path::new(file_name)
        .file_stem()
        .and_then(|stem| stem.to_str())
        .unwrap_or_default();
    let mut name: String = stem
        .split(|c: char| !c.is_ascii_alphanumeric())
        .flat_map(|word| {
            let mut letters = word.chars();
            letters
                .next()
                .map(|first| first.to_ascii_uppercase())
                .into_iter()
                .chain(letters)
        })
        .collect();
    if !name.starts_with(|c: char| c.is_ascii_uppercase()) {
        name.insert_str(0, "Motor");
    }
    name
}
