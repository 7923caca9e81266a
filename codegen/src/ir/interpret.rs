//! The interpreter: runs a verified graph with exact integer semantics.
//!
//! The arithmetic is [`Op::apply`]; guarded stages run only if their guard holds, as in the emitted
//! code. A value outside its proven interval is an error: a bug of the generator.
//!
//! A simulation takes millions of steps, so every function is laid out before the first one: the
//! nodes of a step lie next to each other in memory, and constants are stored once.

use super::graph::{AtRest, Function, Program, Stage};
use super::interval::Interval;
use super::op::{Op, TableId, Value};
use super::role::Setter;
use super::verify::VerifiedGraph;
use std::ops::Range;

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
    /// The step, then the setters.
    routines: Vec<Routine<'g>>,
    /// Number of the routine that ran last.
    last: usize,
    /// Nodes of it that have a value, its first ones.
    evaluated: usize,
}

impl<'g> Machine<'g> {
    /// The program with initial state and set-point.
    pub fn new(graph: &'g VerifiedGraph) -> Self {
        Self::of_program(graph.program())
    }

    /// As [`Machine::new`], for a program that need not pass verification, such as one with a
    /// planted fault.
    pub fn of_program(program: &'g Program) -> Self {
        let functions = program.functions();
        Self {
            program,
            state: program.states.iter().map(|word| word.initial).collect(),
            params: program
                .params
                .iter()
                .map(|(_, word)| word.initial)
                .collect(),
            routines: functions
                .map(|function| Routine::new(program, function))
                .collect(),
            last: 0,
            evaluated: 0,
        }
    }

    /// A value of the function that ran last; `None` if it did not come so far. Of a guarded stage that did not
    /// run it is 0.
    pub fn value(&self, value: Value) -> Option<i64> {
        let is_evaluated = value.index() < self.evaluated;
        is_evaluated.then(|| self.routines[self.last].values[value.index()])
    }

    /// Runs one step; returns the outputs in the order of the step's list.
    ///
    /// # Errors
    /// [`Escape`] when a value leaves its proven interval.
    pub fn step(&mut self, inputs: &[i32]) -> Result<&[i32], Escape> {
        self.run(0, inputs)
    }

    /// Runs a period without control: the tracking and the values at rest.
    ///
    /// # Errors
    /// [`Escape`] when a value leaves its proven interval.
    pub fn rest(&mut self, inputs: &[i32]) -> Result<(), Escape> {
        let function = &self.program.step;
        self.evaluate(0, inputs, function.tracking)?;
        for &(state, value) in &function.next_state {
            self.state[state.index()] = match function.at_rest(value) {
                AtRest::Tracked(value) => self.routines[0].word(value),
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
        let mut setters = self.program.setters.iter();
        match setters.position(|(setter, _)| *setter == sought) {
            Some(place) => self.run(1 + place, inputs).map(drop),
            None => Ok(()),
        }
    }

    /// Runs all of a routine.
    fn run(&mut self, number: usize, inputs: &[i32]) -> Result<&[i32], Escape> {
        let function = self.routines[number].function;
        self.evaluate(number, inputs, function.nodes.len())?;
        let routine = &mut self.routines[number];
        for &(state, value) in &function.next_state {
            self.state[state.index()] = routine.word(value);
        }
        for &(param, value) in &function.next_params {
            self.params[param.index()] = routine.word(value);
        }
        for (place, &(_, value)) in function.outputs.iter().enumerate() {
            routine.outputs[place] = routine.word(value);
        }
        Ok(&routine.outputs)
    }

    /// Computes the values of a routine's stages before node `end`.
    fn evaluate(&mut self, number: usize, inputs: &[i32], end: usize) -> Result<(), Escape> {
        (self.last, self.evaluated) = (number, end);
        let Self {
            program,
            state,
            params,
            ..
        } = self;
        let word = |op| match op {
            Op::Input(place) => inputs.get(place as usize).copied(),
            Op::Param(id) => Some(params[id.index()]),
            Op::State(id) => Some(state[id.index()]),
            _ => None,
        };
        self.routines[number].evaluate(program, word, end)
    }
}

/// A function, laid out to run.
#[derive(Clone, Debug)]
struct Routine<'g> {
    function: &'g Function,
    /// Of every node.
    values: Vec<i64>,
    /// Inputs, state and set-point words, and what is computed, each in the function's order.
    read: Vec<Instruction>,
    computed: Vec<Instruction>,
    passages: Vec<Passage>,
    outputs: Vec<i32>,
    /// A constant outside its interval.
    wrong: Option<Escape>,
}

/// A node, laid out to run.
#[derive(Clone, Copy, Debug)]
struct Instruction {
    op: Op,
    value: Value,
    interval: Interval,
}

/// A stage, laid out to run.
#[derive(Clone, Debug)]
struct Passage {
    first: usize,
    /// Its part of what the routine reads and computes.
    read: Range<usize>,
    computed: Range<usize>,
    /// Place of its guard's flag.
    condition: Option<usize>,
    /// Whether it ran when it was met last; if not, its values are 0.
    ran: bool,
    /// Place of each join, of the value inside the stage, and of the one outside.
    joins: Vec<[usize; 3]>,
}

impl<'g> Routine<'g> {
    fn new(program: &Program, function: &'g Function) -> Self {
        let mut routine = Self {
            function,
            values: vec![0; function.nodes.len()],
            read: vec![],
            computed: vec![],
            passages: vec![],
            outputs: vec![0; function.outputs.len()],
            wrong: None,
        };
        for stage in &function.stages {
            let (read, computed) = (routine.read.len(), routine.computed.len());
            let own = |value: &Value| (stage.first..stage.end).contains(&value.index());
            for value in function.values().filter(own) {
                routine.lay_out(program, value);
            }
            routine.passages.push(Passage {
                first: stage.first,
                read: read..routine.read.len(),
                computed: computed..routine.computed.len(),
                condition: stage.guard.as_ref().map(|guard| guard.condition.index()),
                ran: false,
                joins: joins(function, stage),
            });
        }
        routine
    }

    fn lay_out(&mut self, program: &Program, value: Value) {
        let node = self.function.node(value);
        let instruction = Instruction {
            op: node.op,
            value,
            interval: node.interval,
        };
        let constant = match node.op {
            Op::Constant(id) => program.constants[id.index()].raw,
            Op::Literal(word) => word,
            Op::Input(_) | Op::Param(_) | Op::State(_) => return self.read.push(instruction),
            _ => return self.computed.push(instruction),
        };
        let constant = Some(constant.into());
        if !instruction.keep(&mut self.values, constant) && self.wrong.is_none() {
            self.wrong = Some(self.escape(&instruction, constant));
        }
    }

    /// Computes the values of the stages before node `end` from the words that `word` reads.
    fn evaluate(
        &mut self,
        program: &Program,
        word: impl Fn(Op) -> Option<i32>,
        end: usize,
    ) -> Result<(), Escape> {
        if let Some(wrong) = &self.wrong {
            return Err(wrong.clone());
        }
        let entry = |table: TableId, at: i64| program.tables[table.index()].entry(at);
        let values = &mut self.values;
        let passages = self.passages.iter_mut();
        for passage in passages.take_while(|passage| passage.first < end) {
            for node in &self.read[passage.read.clone()] {
                let value = word(node.op).map(i64::from);
                if !node.keep(values, value) {
                    return Err(self.escape(node, value));
                }
            }
            let computed = &self.computed[passage.computed.clone()];
            let runs = passage.condition.is_none_or(|flag| values[flag] == 1);
            if runs {
                passage.ran = true;
                for node in computed {
                    let value = node.op.apply(|operand| values[operand.index()], entry);
                    if !node.keep(values, value) {
                        return Err(self.escape(node, value));
                    }
                }
            } else if passage.ran {
                passage.ran = false;
                for node in computed {
                    values[node.value.index()] = 0;
                }
            }
            for &[join, taken, otherwise] in &passage.joins {
                values[join] = values[if runs { taken } else { otherwise }];
            }
        }
        Ok(())
    }

    /// A value as a word.
    fn word(&self, value: Value) -> i32 {
        self.values[value.index()] as i32
    }

    #[cold]
    fn escape(&self, node: &Instruction, value: Option<i64>) -> Escape {
        let name = &self.function.node(node.value).name;
        let name = if name.is_empty() {
            format!("%{}", node.value.index())
        } else {
            name.clone()
        };
        Escape {
            place: format!("{}: {name}", self.function.name),
            value,
        }
    }
}

impl Instruction {
    /// Puts a value in its place; `false` if there is none, or it is outside its interval.
    fn keep(&self, values: &mut [i64], value: Option<i64>) -> bool {
        let Interval { low, high } = self.interval;
        match value {
            Some(value) if low <= value && value <= high => {
                values[self.value.index()] = value;
                true
            }
            _ => false,
        }
    }
}

/// Places of each join of a stage, of its value inside, and of the one outside.
fn joins(function: &Function, stage: &Stage) -> Vec<[usize; 3]> {
    let joins = stage.guard.iter().flat_map(|guard| &guard.joins);
    let places = joins.filter_map(|join| match function.node(*join).op {
        Op::Join { taken, otherwise } => Some([*join, taken, otherwise].map(Value::index)),
        _ => None,
    });
    places.collect()
}
