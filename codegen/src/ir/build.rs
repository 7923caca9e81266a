//! Construction of programs, function by function and stage by stage, with intervals.
//!
//! The builder never fails: a value that leaves its word keeps its interval (clipped far outside
//! the word), and [`super::verify()`] reports it, so a caller can try scales in turn. Values are
//! returned as expressions ([`super::expr`]) that refer to the builder.

use super::error::{Exact, Real};
use super::expr::{Expr, Flag, Lut, Memory, Param};
use super::graph::{
    Constant, Function, Guard, Input, Node, Periodic, Program, Quantity, Stage, Table, Word,
};
use super::interval::Interval;
use super::op::{ConstantId, Op, ParamId, StateId, TableId, Value};
use super::role::{Demand, Output, Setter, Told};
use std::cell::RefCell;

/// Intervals are clipped here, far outside the 32-bit word, so that interval arithmetic in 64 bits
/// cannot overflow for any program.
const CLIP: i64 = 1 << 40;

/// Builder of a program; one function is open at a time, first the step.
#[derive(Debug)]
pub struct ProgramBuilder {
    draft: RefCell<Draft>,
}

#[derive(Debug)]
struct Draft {
    program: Program,
    function: Function,
}

impl Program {
    /// An empty program.
    pub fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            constants: vec![],
            tables: vec![],
            params: vec![],
            states: vec![],
            step: Function::new("step", &[]),
            setters: vec![],
        }
    }
}

impl Function {
    /// An empty function.
    pub fn new(name: &str, doc: &[&str]) -> Self {
        Self {
            name: name.to_owned(),
            doc: owned(doc),
            inputs: vec![],
            nodes: vec![],
            stages: vec![],
            outputs: vec![],
            next_state: vec![],
            next_params: vec![],
            told: vec![],
            quantities: vec![],
            tracking: 0,
        }
    }
}

fn owned(lines: &[&str]) -> Vec<String> {
    lines.iter().map(|&line| line.to_owned()).collect()
}

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

/// Constants, tables and words, shared by all functions.
impl ProgramBuilder {
    /// Starts a program, with its step open.
    pub fn new(name: &str, step_doc: &[&str]) -> Self {
        Self {
            draft: RefCell::new(Draft {
                program: Program::new(name),
                function: Function::new("step", step_doc),
            }),
        }
    }

    /// The program, whose step is the open function.
    pub fn finish(self) -> Program {
        let Draft { program, function } = self.draft.into_inner();
        Program {
            step: function,
            ..program
        }
    }

    /// Adds a function that sets set-point words: `build` opens its stages. The step is open again
    /// afterwards.
    pub fn setter<'b>(&'b self, setter: Setter, doc: &[&str], build: impl FnOnce(&'b Self)) {
        let function = Function::new(setter.name(), doc);
        let step = self.draft.borrow_mut().open(function);
        build(self);
        let mut draft = self.draft.borrow_mut();
        let function = draft.open(step);
        draft.program.setters.push((setter, function));
    }

    /// Adds a named constant with exact value `exact`, or finds the one of the same name and value.
    pub fn declare_constant(
        &self,
        name: &str,
        raw: i32,
        exact: Exact,
        doc: &[String],
    ) -> ConstantId {
        let constants = &mut self.draft.borrow_mut().program.constants;
        let is_same = |known: &Constant| known.name == name && known.raw == raw;
        let place = constants.iter().position(is_same).unwrap_or_else(|| {
            constants.push(Constant {
                name: name.to_owned(),
                raw,
                exact,
                doc: doc.to_vec(),
            });
            constants.len() - 1
        });
        ConstantId(place as u32)
    }

    /// Adds an exact named constant, and reads it.
    pub fn constant(&self, name: &str, raw: i32, doc: &[String]) -> Expr<'_> {
        self.read_constant(self.declare_constant(name, raw, Exact::Itself, doc))
    }

    /// The value of a constant.
    pub fn constant_value(&self, id: ConstantId) -> i32 {
        self.draft.borrow().program.constants[id.index()].raw
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

    pub(super) fn put_in_row(&self, table: TableId, row: &'static str) {
        self.draft.borrow_mut().program.tables[table.index()].row = Some(row);
    }

    pub(super) fn hold_legs(&self, table: TableId) {
        self.draft.borrow_mut().program.tables[table.index()].holds_legs = true;
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

    pub(super) fn param_interval(&self, id: ParamId) -> Interval {
        self.draft.borrow().program.params[id.index()].1.interval
    }
}

/// The open function.
impl ProgramBuilder {
    /// Opens a stage; all nodes up to the next stage belong to it.
    pub fn stage(&self, name: &str, doc: &[&str]) {
        self.draft.borrow_mut().open_stage(name, doc, None);
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

    /// [`Self::join`] for a list of any length.
    pub fn join_all<'b>(&'b self, results: &[(&str, Expr<'b>, Expr<'b>)]) -> Vec<Expr<'b>> {
        let joined = results.iter().map(|&result| self.join([result])[0]);
        joined.collect()
    }

    /// Ends the tracking: later stages run in controlled periods only. A new stage must be opened.
    pub fn end_tracking(&self) {
        let function = &mut self.draft.borrow_mut().function;
        function.close();
        function.tracking = function.nodes.len();
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

    pub(super) fn set_state(&self, state: StateId, value: Value) {
        let function = &mut self.draft.borrow_mut().function;
        function.close();
        function.next_state.push((state, value));
    }

    pub(super) fn set_param(&self, param: ParamId, value: Value) {
        let function = &mut self.draft.borrow_mut().function;
        function.close();
        function.next_params.push((param, value));
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

    pub(super) fn read_param(&self, id: ParamId) -> Expr<'_> {
        self.read_word(Op::Param(id))
    }

    pub(super) fn read_state(&self, id: StateId) -> Expr<'_> {
        self.read_word(Op::State(id))
    }

    fn read_word(&self, op: Op) -> Expr<'_> {
        let known = self.draft.borrow().find(op);
        let value = known.unwrap_or_else(|| {
            let name = self.draft.borrow().name_of(op);
            self.push(&name, op)
        });
        self.expr(value)
    }

    fn expr(&self, value: Value) -> Expr<'_> {
        Expr { b: self, value }
    }

    pub(super) fn interval(&self, value: Value) -> Interval {
        self.draft.borrow().function.node(value).interval
    }

    pub(super) fn name(&self, value: Value, name: &str) {
        let nodes = &mut self.draft.borrow_mut().function.nodes;
        name.clone_into(&mut nodes[value.index()].name);
    }

    pub(super) fn push(&self, name: &str, op: Op) -> Value {
        self.draft.borrow_mut().push(name, op)
    }
}

impl Draft {
    /// Opens a function in place of the open one, which it returns.
    fn open(&mut self, function: Function) -> Function {
        self.function.close();
        std::mem::replace(&mut self.function, function)
    }

    fn open_stage(&mut self, name: &str, doc: &[&str], guard: Option<Guard>) {
        self.function.close();
        let first = self.function.nodes.len();
        self.function.stages.push(Stage {
            name: name.to_owned(),
            doc: owned(doc),
            first,
            end: first,
            guard,
        });
    }

    /// Ends the guarded stage that is open, once.
    fn end_stage(&mut self) {
        self.function.close();
    }

    fn note_joins(&mut self, joins: impl IntoIterator<Item = Value>) {
        let stage = self.function.stages.last_mut();
        if let Some(guard) = stage.and_then(|stage| stage.guard.as_mut()) {
            guard.joins.extend(joins);
        }
    }

    fn find(&self, op: Op) -> Option<Value> {
        let nodes = &self.function.nodes;
        let index = nodes.iter().position(|node| node.op == op)?;
        Some(Value(index as u32))
    }

    /// The name of the word that a leaf reads.
    fn name_of(&self, op: Op) -> String {
        let word = match op {
            Op::Param(id) => self.program.params.get(id.index()).map(|(_, word)| word),
            Op::State(id) => self.program.states.get(id.index()),
            _ => None,
        };
        word.map(|word| word.name.clone()).unwrap_or_default()
    }

    fn push(&mut self, name: &str, op: Op) -> Value {
        let kind = op.kind(|value| self.function.node(value).kind);
        let interval = self.interval(op);
        let interval = Interval::new(
            interval.low.clamp(-CLIP, CLIP),
            interval.high.clamp(-CLIP, CLIP),
        );
        self.function.nodes.push(Node {
            op,
            kind,
            interval,
            name: name.to_owned(),
        });
        Value(self.function.nodes.len() as u32 - 1)
    }

    fn interval(&self, op: Op) -> Interval {
        let (program, function) = (&self.program, &self.function);
        let of = |value: Value| function.node(value).interval;
        match op {
            Op::Input(n) => function.inputs[n as usize].interval,
            Op::Param(id) => program.params[id.index()].1.interval,
            Op::State(id) => program.states[id.index()].interval,
            Op::Constant(id) => Interval::point(i64::from(program.constants[id.index()].raw)),
            Op::Join { taken, otherwise } => {
                let stage = function.stages.last();
                let outside = match stage.and_then(|stage| stage.guard.as_ref()) {
                    Some(guard) => function.interval_where_not(guard.condition, otherwise),
                    None => of(otherwise),
                };
                of(taken).union(outside)
            }
            _ => {
                let operands: Vec<Interval> = op.operands().into_iter().map(of).collect();
                op.interval(&operands, |id| program.tables[id.index()].interval())
                    .unwrap_or(Interval::symmetric(CLIP))
            }
        }
    }
}

impl Function {
    /// Ends the open stage, unless joins have ended it.
    fn close(&mut self) {
        let end = self.nodes.len();
        let is_open = |stage: &&mut Stage| {
            let guard = stage.guard.as_ref();
            guard.is_none_or(|guard| guard.joins.is_empty())
        };
        if let Some(stage) = self.stages.last_mut().filter(is_open) {
            stage.end = end;
        }
    }
}
