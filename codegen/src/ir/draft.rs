//! The program under construction: its data, its stages, and the intervals of new nodes.

use super::error::Exact;
use super::graph::{Constant, Function, Guard, Node, Program, Stage};
use super::interval::Interval;
use super::op::{ConstantId, Op, ParamId, StateId, TableId, Value};
use super::role::Setter;
use std::cell::RefCell;

/// Intervals are clipped here, far outside the 32-bit word, so that interval arithmetic in 64 bits
/// cannot overflow for any program.
const CLIP: i64 = 1 << 40;

/// Builder of a program; one function is open at a time, first the step.
#[derive(Debug)]
pub struct ProgramBuilder {
    pub(super) draft: RefCell<Draft>,
}

#[derive(Debug)]
pub(super) struct Draft {
    pub(super) program: Program,
    pub(super) function: Function,
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

/// Everything but the expressions, which `build` adds.
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

    /// The value of a constant.
    pub fn constant_value(&self, id: ConstantId) -> i32 {
        self.draft.borrow().program.constants[id.index()].raw
    }

    pub(super) fn put_in_row(&self, table: TableId, row: &'static str) {
        self.draft.borrow_mut().program.tables[table.index()].row = Some(row);
    }

    pub(super) fn hold_legs(&self, table: TableId) {
        self.draft.borrow_mut().program.tables[table.index()].holds_legs = true;
    }

    pub(super) fn param_interval(&self, id: ParamId) -> Interval {
        self.draft.borrow().program.params[id.index()].1.interval
    }

    /// Opens a stage; all nodes up to the next stage belong to it.
    pub fn stage(&self, name: &str, doc: &[&str]) {
        self.draft.borrow_mut().open_stage(name, doc, None);
    }

    /// Ends the tracking: later stages run in controlled periods only. A new stage must be opened.
    pub fn end_tracking(&self) {
        let function = &mut self.draft.borrow_mut().function;
        function.close();
        function.tracking = function.nodes.len();
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

    pub(super) fn read_word(&self, op: Op) -> Value {
        let known = self.draft.borrow().find(op);
        known.unwrap_or_else(|| {
            let name = self.draft.borrow().name_of(op);
            self.push(&name, op)
        })
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

    pub(super) fn open_stage(&mut self, name: &str, doc: &[&str], guard: Option<Guard>) {
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
    pub(super) fn end_stage(&mut self) {
        self.function.close();
    }

    pub(super) fn note_joins(&mut self, joins: impl IntoIterator<Item = Value>) {
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
    pub(super) fn close(&mut self) {
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
