//! Construction of programs, function by function and stage by stage, with intervals.
//!
//! The builder never fails: a value that leaves its word keeps its interval (clipped far outside
//! the word), and [`super::verify()`] reports it, so a caller can try scales in turn. Values are
//! returned as expressions ([`super::expr`]) that refer to the builder.

use super::draft::ProgramBuilder;
use super::error::{Exact, Real};
use super::expr::{Expr, Flag, Lut, Memory, Param};
use super::graph::{Guard, Input, Periodic, Quantity, Table, Word};
use super::interval::Interval;
use super::op::{ConstantId, Op, ParamId, StateId, TableId, Value};
use super::role::{Demand, Output, Told};

fn word(name: &str, initial: i32, interval: Interval, doc: &str) -> Word {
    let storage_bits = if Interval::HALFWORD.contains(interval) {
        16
    } else {
        32
    };
    Word {
        name: name.to_owned(),
        initial,
        interval,
        storage_bits,
        doc: doc.to_owned(),
    }
}

/// Words, tables, stages and results as expressions.
impl ProgramBuilder {
    /// Adds an exact named constant, and reads it.
    pub fn constant(&self, name: &str, raw: i32, doc: &[String]) -> Expr<'_> {
        self.read_constant(self.declare_constant(name, raw, Exact::Itself, doc))
    }

    /// Adds a table of exact entries, padded with zeros to a power of two.
    pub fn table(&self, name: &str, values: Vec<i32>, doc: &[String]) -> Lut<'_> {
        self.rounded_table(name, values, (Exact::Itself, None), doc)
    }

    /// Adds a table that shares its index with others of the same `row`.
    pub fn column(&self, row: &'static str, name: &str, values: Vec<i32>, doc: &str) -> Lut<'_> {
        self.table(name, values, &[doc.to_owned()]).in_row(row)
    }

    /// Adds a table of rounded entries, perhaps of a function of the angle; padded as
    /// [`Self::table`].
    pub fn rounded_table(
        &self,
        name: &str,
        mut values: Vec<i32>,
        (exact, periodic): (Exact, Option<Periodic>),
        doc: &[String],
    ) -> Lut<'_> {
        values.resize(values.len().next_power_of_two(), 0);
        let tables = &mut self.draft.borrow_mut().program.tables;
        tables.push(Table {
            name: name.to_owned(),
            values,
            exact,
            periodic,
            row: None,
            holds_legs: false,
            doc: doc.to_vec(),
        });
        Lut {
            b: self,
            id: TableId(tables.len() as u32 - 1),
        }
    }

    /// Adds a state word, stored in 16 bits if its interval fits, see [`Word::storage_bits`].
    pub fn memory(&self, name: &str, initial: i32, interval: Interval, doc: &str) -> Memory<'_> {
        let states = &mut self.draft.borrow_mut().program.states;
        states.push(word(name, initial, interval, doc));
        Memory {
            b: self,
            id: StateId(states.len() as u32 - 1),
        }
    }

    /// Adds a set-point word.
    pub fn param(
        &self,
        demand: Demand,
        name: &str,
        initial: i32,
        interval: Interval,
        doc: &str,
    ) -> Param<'_> {
        let params = &mut self.draft.borrow_mut().program.params;
        let word = Word {
            storage_bits: 32,
            ..word(name, initial, interval, doc)
        };
        params.push((demand, word));
        Param {
            b: self,
            id: ParamId(params.len() as u32 - 1),
        }
    }

    /// Opens a stage that runs only if `condition` holds; close it with [`Self::join`].
    pub fn guarded_stage(&self, name: &str, condition: Flag<'_>, rare: bool, doc: &[&str]) {
        let guard = Guard {
            condition: condition.value,
            joins: vec![],
            rare,
        };
        let mut draft = self.draft.borrow_mut();
        draft.open_stage(name, doc, Some(guard));
    }

    /// Closes the guarded stage: per result its name, the value from inside, and the value if the
    /// stage does not run. A new stage must be opened before further nodes are added.
    pub fn join<'b, const N: usize>(
        &'b self,
        results: [(&str, Expr<'b>, Expr<'b>); N],
    ) -> [Expr<'b>; N] {
        self.draft.borrow_mut().end_stage();
        let joined = results.map(|(name, taken, otherwise)| {
            let (taken, otherwise) = (taken.value, otherwise.value);
            self.expr(self.push(name, Op::Join { taken, otherwise }))
        });
        self.draft
            .borrow_mut()
            .note_joins(joined.map(|join| join.value));
        joined
    }

    /// Makes a value an observation.
    pub fn tell(&self, told: Told, value: Expr<'_>) {
        let mut draft = self.draft.borrow_mut();
        draft.function.told.push((told, value.value));
    }

    /// Makes a value an output.
    pub fn output(&self, output: Output, value: Expr<'_>) {
        let function = &mut self.draft.borrow_mut().function;
        function.close();
        function.outputs.push((output, value.value));
    }

    /// States the error bound of a value: quantity, unit, and the word in that unit.
    pub fn state_error(&self, name: &str, value: Expr<'_>, [doc, unit]: [&str; 2], word: f64) {
        let mut draft = self.draft.borrow_mut();
        draft.function.quantities.push(Quantity {
            name: name.to_owned(),
            doc: doc.to_owned(),
            unit: unit.to_owned(),
            word: Real::of(word),
            value: value.value,
        });
    }

    /// Adds an input word and reads it.
    pub fn input(&self, name: &str, interval: Interval, doc: &str) -> Expr<'_> {
        let number = {
            let inputs = &mut self.draft.borrow_mut().function.inputs;
            inputs.push(Input {
                name: name.to_owned(),
                interval,
                doc: doc.to_owned(),
            });
            inputs.len() as u32 - 1
        };
        self.expr(self.push(name, Op::Input(number)))
    }

    /// A small number.
    pub fn number(&self, value: i32) -> Expr<'_> {
        self.expr(self.push("", Op::Literal(value)))
    }

    /// Reads a named constant.
    pub fn read_constant(&self, id: ConstantId) -> Expr<'_> {
        self.expr(self.push("", Op::Constant(id)))
    }

    fn expr(&self, value: Value) -> Expr<'_> {
        Expr { b: self, value }
    }
}
