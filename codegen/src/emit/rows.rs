//! Memory layout of tables: alone, or as columns of rows with a common index.

use crate::ir::{Function, Op, Output, Phase, Program, Table, TableId, Value};

/// The row of a table, if it is not its only column or its entries are leg states.
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

/// A command that is looked up as a whole: the columns of one row hold compare values and leg
/// states, and have no other use, so they form one column of commands.
#[derive(Clone, Debug)]
pub(super) struct WholeCommand<'a> {
    /// The row.
    pub row: &'static str,
    /// Index of the lookup.
    pub index: Value,
    /// Compare values and states of legs a, b, c.
    pub columns: Vec<&'a Table>,
    /// The entries.
    pub entries: Vec<Value>,
}

impl<'a> WholeCommand<'a> {
    /// Size of a command, bytes.
    const SIZE: usize = 8;

    /// The step's command, if it is looked up as a whole. Without off legs there are no columns of
    /// states, and the command is built in code.
    pub(super) fn of(program: &'a Program) -> Option<Self> {
        let path = &program.step;
        let outputs = [Output::Compare, Output::Leg].map(|of| Phase::ALL.map(of));
        let mut place = None;
        let (mut columns, mut entries, mut tables) = (vec![], vec![], vec![]);
        for sought in outputs.into_iter().flatten() {
            let value = path.output(sought)?;
            let Op::Lookup { table, index, .. } = path.node(value).op else {
                return None;
            };
            let column = &program.tables[table.index()];
            let row = row_of(program, column)?;
            if *place.get_or_insert((row, index)) != (row, index) {
                return None;
            }
            columns.push(column);
            entries.push(value);
            tables.push(table);
        }
        let (row, index) = place?;
        let is_entry = |value: &Value| entries.contains(value);
        let mut operands = path.nodes.iter().flat_map(|node| node.op.operands());
        let mut kept = path.next_state.iter();
        let is_used =
            operands.any(|value| is_entry(&value)) || kept.any(|(_, value)| is_entry(value));
        let mut elsewhere = program.setters.iter().map(|(_, setter)| setter);
        let is_alone = tables.iter().all(|&table| reads(path, table) == 1)
            && elsewhere.all(|path| tables.iter().all(|&table| reads(path, table) == 0));
        let count = columns.first()?.values.len();
        let is_even = self::columns(program, row).all(|column| column.values.len() == count);
        (!is_used && is_alone && is_even).then_some(Self {
            row,
            index,
            columns,
            entries,
        })
    }

    /// Whether a table is one of its columns.
    pub(super) fn holds(&self, table: &Table) -> bool {
        self.columns.iter().any(|column| column.name == table.name)
    }
}

/// Number of a function's lookups of a table.
fn reads(function: &Function, sought: TableId) -> usize {
    let is_sought = |op: &Op| matches!(op, Op::Lookup { table, .. } if *table == sought);
    function
        .nodes
        .iter()
        .filter(|node| is_sought(&node.op))
        .count()
}

/// Bytes of a table's elements.
pub(super) fn size(table: &Table) -> usize {
    match table.interval().bits() {
        _ if table.holds_legs => 1,
        ..=8 => 1,
        9..=16 => 2,
        _ => 4,
    }
}

/// Bytes of the fields of a row.
fn fields(program: &Program, row: &'static str, whole: Option<&WholeCommand<'_>>) -> Vec<usize> {
    let whole = whole.filter(|whole| whole.row == row);
    let is_apart = |table: &&Table| whole.is_none_or(|whole| !whole.holds(table));
    let apart = columns(program, row).filter(is_apart).map(size);
    whole
        .map(|_| WholeCommand::SIZE)
        .into_iter()
        .chain(apart)
        .collect()
}

/// Bytes of a packed row, its widest field aligned.
fn packed(fields: &[usize]) -> usize {
    let widest = fields.iter().copied().max().unwrap_or(1);
    fields.iter().sum::<usize>().next_multiple_of(widest)
}

/// The alignment that pads a row to a power of two, if that takes no more than a word: its address
/// is then a shift of the index.
pub(super) fn padding(
    program: &Program,
    row: &'static str,
    whole: Option<&WholeCommand<'_>>,
) -> Option<usize> {
    let size = packed(&fields(program, row, whole));
    let power = size.next_power_of_two();
    (size < power && power <= size + 4).then_some(power)
}

/// Bytes of all tables of a program.
pub(super) fn bytes(program: &Program) -> usize {
    let whole = WholeCommand::of(program);
    let whole = whole.as_ref();
    let mut known = vec![];
    let mut sum = 0;
    for table in &program.tables {
        let one = match row_of(program, table) {
            None => size(table),
            Some(row) if known.contains(&row) => 0,
            Some(row) => {
                known.push(row);
                padding(program, row, whole).unwrap_or_else(|| packed(&fields(program, row, whole)))
            }
        };
        sum += one * table.values.len();
    }
    sum
}
