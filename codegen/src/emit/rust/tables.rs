//! Tables: alone, or as columns of rows with a common index, whose entries share one address.

use super::groups::array;
use super::names::{camel, docs, leg_state, number, screaming, snake};
use super::source::{Source, quote};
use crate::emit::rows::{WholeCommand, columns, padding, row_of, size};
use crate::emit::signal::Leg;
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

/// The command in the row at an index.
pub(super) fn look_up_command(whole: &WholeCommand<'_>, index: &Source) -> Source {
    let rows = rows(whole.row);
    quote!(row(&#rows, #index).legs)
}

/// The tables of a program: single ones if `named` in the code, rows with all their columns; the
/// columns of a whole command are one.
pub(super) fn emit_tables(
    program: &Program,
    whole: Option<&WholeCommand<'_>>,
    named: impl Fn(&str) -> bool,
) -> Source {
    let mut items = Source::new();
    let mut known = vec![];
    for table in &program.tables {
        match row_of(program, table) {
            None if named(&table.name) => items.insert(&emit_table(table)),
            Some(row) if !known.contains(&row) && named(&rows(row).to_string()) => {
                known.push(row);
                items.insert(&emit_rows(program, row, whole));
            }
            _ => {}
        }
    }
    items
}

/// The name of the array of rows.
fn rows(row: &str) -> Source {
    screaming(&format!("{row}_rows"))
}

/// The name of a column, without the row's own.
fn field(row: &str, table: &Table) -> Source {
    let name = table.name.strip_prefix(row);
    let name = name.and_then(|name| name.strip_prefix('_'));
    snake(name.unwrap_or(&table.name))
}

/// Whether the names of at least three fields all begin or all end with the same word.
fn share_a_word(names: &[String]) -> bool {
    let alike =
        |word: fn(&str) -> Option<&str>| names.iter().all(|name| word(name) == word(&names[0]));
    names.len() >= 3
        && (alike(|name| name.split('_').next()) || alike(|name| name.rsplit('_').next()))
}

/// One field of rows.
struct Field {
    name: Source,
    doc: Source,
    element: Source,
    entries: Vec<Source>,
}

impl Field {
    fn of_table(row: &str, table: &Table) -> Self {
        let entries = table.values.iter().map(|&value| entry(table, value));
        Self {
            name: field(row, table),
            doc: docs(&table.doc),
            element: element(table),
            entries: entries.collect(),
        }
    }

    fn of_command(whole: &WholeCommand<'_>) -> Self {
        let (compares, states) = whole.columns.split_at(3);
        let entries = (0..compares[0].values.len()).map(|index| {
            let [compares, states] = [compares, states].map(|tables| {
                let entries = tables.iter().map(|table| entry(table, table.values[index]));
                array(&entries.collect::<Vec<Source>>())
            });
            quote!(Legs::new(#compares, #states))
        });
        let of_a = compares[0].doc.first().map_or("", String::as_str);
        Self {
            name: Source::of("legs"),
            doc: docs(&[of_a.replacen("Compare value of the leg", "Command of the legs", 1)]),
            element: quote!(Legs),
            entries: entries.collect(),
        }
    }
}

fn emit_rows(program: &Program, row: &'static str, whole: Option<&WholeCommand<'_>>) -> Source {
    let (name, rows) = (Source::of(format!("{}Row", camel(row))), rows(row));
    let whole_here = whole.filter(|whole| whole.row == row);
    let apart = columns(program, row)
        .filter(|table| whole_here.is_none_or(|whole| !whole.holds(table)))
        .map(|table| Field::of_table(row, table));
    let every: Vec<Field> = whole_here
        .map(Field::of_command)
        .into_iter()
        .chain(apart)
        .collect();
    let count = every.iter().map(|field| field.entries.len()).max();
    let count = count.unwrap_or(0);
    let none = quote!(0);
    let entries = (0..count).map(|index| {
        let fields = every.iter().map(|field| {
            let (name, entry) = (&field.name, field.entries.get(index).unwrap_or(&none));
            quote!(#name: #entry)
        });
        quote!(#name { #(#fields),* })
    });
    let fields = every.iter().map(
        |Field {
             name, doc, element, ..
         }| quote!(#doc #name: #element),
    );
    let names: Vec<String> = every.iter().map(|field| field.name.to_string()).collect();
    let doc = docs(&[format!("Row of a table, by {row}.")]);
    let layout = padding(program, row, whole).map(|bytes| quote!(#[repr(align(#bytes))]));
    let alike = share_a_word(&names)
        .then(|| quote!(#[expect(clippy::struct_field_names, reason = "signals of three phases")]));
    quote! {
        #doc
        #layout
        #alike
        struct #name { #(#fields),* }

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

/// The smallest element type of a table, unsigned if possible: loads need no sign extension.
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
    if table.holds_legs {
        leg_state(Leg::of(value))
    } else {
        number(i64::from(value))
    }
}
