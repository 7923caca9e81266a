//! Tables: alone, or side by side as the columns of rows that one index reads.
//!
//! One address then leads to all entries of a row, where tables of their own would each need theirs.

use super::expression::coded;
use super::names::{camel, docs, number, screaming, snake};
use super::source::{Source, quote};
use crate::emit::rows::{columns, padding, row_of, size};
use crate::emit::signal::Shape;
use crate::ir::{Program, Table, TableId};

/// The entry of a table at an index: a word, or the state of a leg.
pub(super) fn look_up(program: &Program, id: TableId, index: &Source) -> Source {
    let table = &program.tables[id.index()];
    let name = screaming(&table.name);
    let Some(row) = row_of(program, table) else {
        return quote!(lookup(&#name, #index));
    };
    let (rows, field) = (rows(row), field(row, table));
    let entry = quote!(row(&#rows, #index).#field);
    if table.holds_legs {
        entry
    } else {
        quote!(Word::from(#entry))
    }
}

/// All tables of a program that its code names: those alone by `named`, those in rows all together.
pub(super) fn emit_tables(program: &Program, named: impl Fn(&str) -> bool) -> Source {
    let mut items = Source::new();
    let mut known = vec![];
    for table in &program.tables {
        match row_of(program, table) {
            None if named(&table.name) => items.insert(&emit_table(table)),
            Some(row) if !known.contains(&row) && named(&rows(row).to_string()) => {
                known.push(row);
                items.insert(&emit_rows(program, row));
            }
            _ => {}
        }
    }
    items
}

/// The name of all rows together.
fn rows(row: &str) -> Source {
    screaming(&format!("{row}_rows"))
}

/// The name of a column, without the row's own.
fn field(row: &str, table: &Table) -> Source {
    let name = table.name.strip_prefix(row);
    let name = name.and_then(|name| name.strip_prefix('_'));
    snake(name.unwrap_or(&table.name))
}

/// Whether the names of three fields or more all begin or all end with the same word.
fn shares_a_word(program: &Program, row: &'static str) -> bool {
    let names = columns(program, row).map(|table| field(row, table).to_string());
    let names: Vec<String> = names.collect();
    let alike =
        |word: fn(&str) -> Option<&str>| names.iter().all(|name| word(name) == word(&names[0]));
    names.len() >= 3
        && (alike(|name| name.split('_').next()) || alike(|name| name.rsplit('_').next()))
}

fn emit_rows(program: &Program, row: &'static str) -> Source {
    let (name, rows) = (Source::of(format!("{}Row", camel(row))), rows(row));
    let fields = columns(program, row).map(|table| {
        let (field, doc, element) = (field(row, table), docs(&table.doc), element(table));
        quote!(#doc #field: #element)
    });
    let count = columns(program, row).map(|table| table.values.len()).max();
    let count = count.unwrap_or(0);
    let entries = (0..count).map(|index| {
        let fields = columns(program, row).map(|table| {
            let value = table.values.get(index).copied().unwrap_or(0);
            let (field, entry) = (field(row, table), entry(table, value));
            quote!(#field: #entry)
        });
        quote!(#name { #(#fields),* })
    });
    let doc = docs(&[format!("What one {row} tells.")]);
    let layout = padding(columns(program, row)).map(|bytes| quote!(#[repr(align(#bytes))]));
    let alike = shares_a_word(program, row)
        .then(|| quote!(#[expect(clippy::struct_field_names, reason = "signals of three phases")]));
    let all = docs(&[format!("The rows of every {row}.")]);
    quote! {
        #doc
        #layout
        #alike
        struct #name { #(#fields),* }

        #all
        static #rows: [#name; #count] = [#(#entries),*];
    }
}

/// A table by itself.
fn emit_table(table: &Table) -> Source {
    let (name, doc, element) = (screaming(&table.name), docs(&table.doc), element(table));
    let count = table.values.len();
    let values = table.values.iter().map(|&value| entry(table, value));
    quote!(#doc static #name: [#element; #count] = [#(#values),*];)
}

/// The smallest elements that hold a table, unsigned where that will do: to load and to compare them takes no sign extension.
fn element(table: &Table) -> Source {
    match size(table) {
        1 if table.holds_legs => quote!(LegState),
        1 if is_unsigned(table) => quote!(u8),
        1 => quote!(i8),
        2 if is_unsigned(table) => quote!(u16),
        2 => quote!(i16),
        _ => quote!(i32),
    }
}

fn is_unsigned(table: &Table) -> bool {
    table.values.iter().all(|&value| value >= 0)
}

fn entry(table: &Table, value: i32) -> Source {
    let code = table.holds_legs.then(|| Shape::Leg.code(value)).flatten();
    code.map_or_else(|| number(i64::from(value)), coded)
}
