//! How tables lie in memory: alone, or side by side as the columns of rows that one index reads.

use crate::ir::{Program, Table};

/// The row that a table is a column of, where it has company there or its entries have a type of their own.
pub(super) fn row_of(program: &Program, table: &Table) -> Option<&'static str> {
    let row = table.row?;
    (columns(program, row).count() > 1 || table.holds_legs).then_some(row)
}

/// The tables of a row.
pub(super) fn columns<'a>(
    program: &'a Program,
    row: &'static str,
) -> impl Iterator<Item = &'a Table> {
    let tables = program.tables.iter();
    tables.filter(move |table| table.row == Some(row))
}

/// Bytes of the smallest elements that hold a table.
pub(super) fn size(table: &Table) -> usize {
    match table.interval().bits() {
        _ if table.holds_legs => 1,
        ..=8 => 1,
        9..=16 => 2,
        _ => 4,
    }
}

/// Bytes of a row as it is packed, its widest elements aligned.
fn packed<'a>(columns: impl Iterator<Item = &'a Table>) -> usize {
    let sizes: Vec<usize> = columns.map(size).collect();
    let widest = sizes.iter().copied().max().unwrap_or(1);
    sizes.iter().sum::<usize>().next_multiple_of(widest)
}

/// The alignment that makes a row as long as a power of two, where that takes no more than a word: its address is then
/// a shift of the index.
pub(super) fn padding<'a>(columns: impl Iterator<Item = &'a Table>) -> Option<usize> {
    let size = packed(columns);
    let whole = size.next_power_of_two();
    (size < whole && whole <= size + 4).then_some(whole)
}

/// Bytes of all tables of a program.
pub(super) fn bytes(program: &Program) -> usize {
    let mut known = vec![];
    let mut sum = 0;
    for table in &program.tables {
        let one = match row_of(program, table) {
            None => size(table),
            Some(row) if known.contains(&row) => 0,
            Some(row) => {
                known.push(row);
                padding(columns(program, row)).unwrap_or_else(|| packed(columns(program, row)))
            }
        };
        sum += one * table.values.len();
    }
    sum
}
