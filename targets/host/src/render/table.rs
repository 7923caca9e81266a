//! Tables as HTML.

use super::inline::{prose, sign};
use hexagen_lab::report::{Cell, Column, Group, Label, Table};
use maud::{Markup, html as markup};

/// A table; a group of rows is a body of its own.
pub fn html(table: &Table) -> Markup {
    let columns = columns(&table.columns);
    markup! {
        table class=[Some(table.kind).filter(|kind| !kind.is_empty())] {
            // A list of facts explains itself.
            @if table.title.is_empty() { (head(&columns)) }
            @for group in &table.groups { (body(&columns, group)) }
        }
    }
}

/// The columns, and whether each begins something new: a group, or what stands behind the last one.
fn columns(columns: &[Column]) -> Vec<(&Column, bool)> {
    let before = [""]
        .into_iter()
        .chain(columns.iter().map(|of| of.group.as_str()));
    let pairs = columns.iter().zip(before);
    pairs
        .map(|(column, before)| (column, column.group != before))
        .collect()
}

/// Names of columns, below the names of their groups.
fn head(columns: &[(&Column, bool)]) -> Markup {
    let groups = columns.chunk_by(|(a, _), (b, _)| !a.group.is_empty() && a.group == b.group);
    let lower: Vec<_> = columns
        .iter()
        .filter(|(column, _)| !column.group.is_empty())
        .collect();
    let rows = if lower.is_empty() { 1 } else { 2 };
    markup! {
        thead {
            tr {
                @for group in groups {
                    @let (first, is_edge) = group[0];
                    @if first.group.is_empty() { (heading(first, is_edge, rows)) }
                    @else { th.group.edge colspan=(group.len()) { (prose(&first.group)) } }
                }
            }
            @if rows > 1 {
                tr { @for (column, is_edge) in lower { (heading(column, *is_edge, 1)) } }
            }
        }
    }
}

/// Classes of a cell in the style sheet.
fn class(is_number: bool, is_edge: bool, tone: &str) -> Option<String> {
    let names = [
        if is_number { "number" } else { "" },
        if is_edge { "edge" } else { "" },
        tone,
    ];
    let names = names.into_iter().filter(|name| !name.is_empty());
    let names = names.collect::<Vec<_>>().join(" ");
    (!names.is_empty()).then_some(names)
}

fn heading(column: &Column, is_edge: bool, rows: usize) -> Markup {
    let rows = (rows > 1).then_some(rows);
    markup! {
        th class=[class(column.is_number, is_edge, "")] rowspan=[rows] {
            (prose(&column.name))
            @if !column.unit.is_empty() { br; small { (column.unit) } }
        }
    }
}

fn body(columns: &[(&Column, bool)], group: &Group) -> Markup {
    let beside = match &group.label {
        Label::Beside(label) => Some(label),
        Label::None | Label::Above(_) => None,
    };
    markup! {
        tbody {
            @if let Label::Above(label) = &group.label {
                tr { th colspan=(columns.len()) scope="rowgroup" { (content(label)) } }
            }
            @for (place, row) in group.rows.iter().enumerate() {
                tr {
                    @if let (Some(label), 0) = (beside, place) {
                        th scope="rowgroup" rowspan=(group.rows.len()) { (content(label)) }
                    }
                    @for cell in placed(&columns[usize::from(beside.is_some())..], row) { (cell) }
                }
            }
        }
    }
}

/// Cells in their columns.
fn placed(columns: &[(&Column, bool)], row: &[Cell]) -> Vec<Markup> {
    let mut place = 0;
    let cells = row.iter().map(|cell| {
        let column = columns.get(place);
        place += cell.columns.max(1);
        let is_number = column.is_some_and(|(column, _)| column.is_number);
        let is_edge = column.is_some_and(|(_, is_edge)| *is_edge);
        let span = (cell.columns > 1).then_some(cell.columns);
        markup! {
            td class=[class(is_number, is_edge, cell.tone.name())] colspan=[span] { (content(cell)) }
        }
    });
    cells.collect()
}

fn content(cell: &Cell) -> Markup {
    markup! {
        @if let Some(of) = cell.sign { (sign(of)) " " }
        (prose(&cell.text))
        @if !cell.detail.is_empty() {
            @if !cell.detail.starts_with('\n') { " " }
            small { (prose(&cell.detail)) }
        }
    }
}
