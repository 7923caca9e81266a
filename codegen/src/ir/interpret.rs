//! The interpreter: runs a verified graph with exact integer semantics.
//!
//! The arithmetic is [`Op::apply`]; guarded stages run only if their guard holds, as in the emitted
//! code. A value outside its proven interval is an error: a bug of the generator.

use super::graph::{AtRest, Function, Program};
use super::op::{Op, Value};
use super::role::Setter;
use super::verify::VerifiedGraph;

/// A value left its proven interval, or an operand its operator's domain: a bug of the generator.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Escape {
    /// Function and name (or number) of the value.
    pub place: String,
    /// The value, if it exists.
    pub value: Option<i64>,
}

/// A program with its state and set-point words.
#[derive(Clone, Debug)]
pub struct Machine<'g> {
    program: &'g Program,
    /// State words, in the program's order.
    pub state: Vec<i32>,
    /// Set-point words, in the program's order.
    pub params: Vec<i32>,
    values: Vec<i64>,
    /// Nodes of the last function that ran, its first ones.
    evaluated: usize,
    /// Places of every node's operands: of the step, then of the setters.
    operands: Vec<Vec<[usize; 4]>>,
}

/// Places of the operands of every node; unused ones are 0.
fn operand_places(function: &Function) -> Vec<[usize; 4]> {
    let places = |op: &Op| {
        let mut places = [0; 4];
        for (place, operand) in places.iter_mut().zip(op.operands()) {
            *place = operand.index();
        }
        places
    };
    function.nodes.iter().map(|node| places(&node.op)).collect()
}

impl<'g> Machine<'g> {
    /// The program with initial state and set-point.
    pub fn new(graph: &'g VerifiedGraph) -> Self {
        Self::of_program(graph.program())
    }

    /// As [`Machine::new`], for a program that need not pass verification, such as one with a
    /// planted fault.
    pub fn of_program(program: &'g Program) -> Self {
        Self {
            program,
            state: program.states.iter().map(|word| word.initial).collect(),
            params: program
                .params
                .iter()
                .map(|(_, word)| word.initial)
                .collect(),
            values: vec![],
            evaluated: 0,
            operands: program.functions().map(operand_places).collect(),
        }
    }

    /// A value of the function that ran last; `None` if it did not come so far. Of a guarded stage that did not
    /// run it is 0.
    pub fn value(&self, value: Value) -> Option<i64> {
        let is_evaluated = value.index() < self.evaluated;
        is_evaluated.then(|| self.values[value.index()])
    }

    /// Runs one step; returns the outputs in the order of the step's list.
    ///
    /// # Errors
    /// [`Escape`] when a value leaves its proven interval.
    pub fn step(&mut self, inputs: &[i32]) -> Result<Vec<i32>, Escape> {
        let program = self.program;
        self.run(0, &program.step, inputs)
    }

    /// Runs a period without control: the tracking and the values at rest.
    ///
    /// # Errors
    /// [`Escape`] when a value leaves its proven interval.
    pub fn rest(&mut self, inputs: &[i32]) -> Result<(), Escape> {
        let function = &self.program.step;
        self.evaluate_all(0, function, inputs, function.tracking)?;
        for &(state, value) in &function.next_state {
            self.state[state.index()] = match function.at_rest(value) {
                AtRest::Tracked(value) => self.values[value.index()] as i32,
                AtRest::Forgotten => 0,
            };
        }
        Ok(())
    }

    /// Runs a setter, if the program has it.
    ///
    /// # Errors
    /// [`Escape`] when a value leaves its proven interval.
    pub fn set(&mut self, sought: Setter, inputs: &[i32]) -> Result<(), Escape> {
        let program = self.program;
        let mut setters = program.setters.iter().zip(1..);
        match setters.find(|((setter, _), _)| *setter == sought) {
            Some(((_, function), number)) => self.run(number, function, inputs).map(drop),
            None => Ok(()),
        }
    }

    /// Runs function `number`: 0 the step, then the setters.
    fn run(
        &mut self,
        number: usize,
        function: &Function,
        inputs: &[i32],
    ) -> Result<Vec<i32>, Escape> {
        self.evaluate_all(number, function, inputs, function.nodes.len())?;
        let word = |value: Value, values: &[i64]| values[value.index()] as i32;
        for &(state, value) in &function.next_state {
            self.state[state.index()] = word(value, &self.values);
        }
        for &(param, value) in &function.next_params {
            self.params[param.index()] = word(value, &self.values);
        }
        Ok(function
            .outputs
            .iter()
            .map(|&(_, value)| word(value, &self.values))
            .collect())
    }

    /// Computes the values of all stages before node `end`.
    fn evaluate_all(
        &mut self,
        number: usize,
        function: &Function,
        inputs: &[i32],
        end: usize,
    ) -> Result<(), Escape> {
        self.values.clear();
        self.values.resize(function.nodes.len(), 0);
        self.evaluated = end;
        for stage in function.stages.iter().filter(|stage| stage.first < end) {
            let runs = stage
                .guard
                .as_ref()
                .is_none_or(|guard| self.values[guard.condition.index()] == 1);
            for index in stage.first..stage.end {
                if runs || function.nodes[index].op.is_leaf() {
                    self.evaluate(number, function, index, inputs)?;
                }
            }
            for join in stage.guard.iter().flat_map(|guard| &guard.joins) {
                if let Op::Join { taken, otherwise } = function.node(*join).op {
                    self.values[join.index()] =
                        self.values[if runs { taken } else { otherwise }.index()];
                }
            }
        }
        Ok(())
    }

    #[inline]
    fn evaluate(
        &mut self,
        number: usize,
        function: &Function,
        index: usize,
        inputs: &[i32],
    ) -> Result<(), Escape> {
        let node = &function.nodes[index];
        let operands = self.operands[number][index].map(|place| self.values[place]);
        let result = match node.op {
            Op::Input(n) => inputs.get(n as usize).map(|&word| i64::from(word)),
            Op::Param(id) => Some(i64::from(self.params[id.index()])),
            Op::State(id) => Some(i64::from(self.state[id.index()])),
            Op::Constant(id) => Some(i64::from(self.program.constants[id.index()].raw)),
            op => op.apply(&operands, |table, at| {
                let values = &self.program.tables[table.index()].values;
                i64::from(values[(at as usize) & (values.len() - 1)])
            }),
        };
        match result {
            Some(value) if node.interval.low <= value && value <= node.interval.high => {
                self.values[index] = value;
                Ok(())
            }
            value => {
                let name = if node.name.is_empty() {
                    format!("%{index}")
                } else {
                    node.name.clone()
                };
                Err(Escape {
                    place: format!("{}: {name}", function.name),
                    value,
                })
            }
        }
    }
}
