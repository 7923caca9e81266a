//! The verifier: from a program to a [`VerifiedGraph`], or the list of broken invariants.
//!
//! Invariants:
//! 1. Every operand is defined earlier; all words, constants, tables and results exist.
//! 2. Stages and their joins partition the nodes in order.
//! 3. Values of a guarded stage leave it through its joins only; joins come right after their
//!    stage, and its guard is defined before it.
//! 4. Operand kinds fit, and results are words.
//! 5. Every stored interval follows from the operands (and, at a join, the guard:
//!    [`Function::interval_where_not`]) and fits the 32-bit word.
//! 6. Operators stay in their domain: denominators >= 1, factors and numerators not negative where
//!    required, clamp limits in order, shifts and segments in range.
//! 7. Names are unique: of constants and tables, of words, of functions; in a function of inputs,
//!    outputs, stages and values. A value without a name, unless a constant, is used once, in its
//!    stage.
//! 8. Tables have a power-of-two length.
//! 9. The step sets every state word once and no set-point word; a setter sets no state word, and a
//!    set-point word at most once. New and initial values lie in the word's interval, which fits
//!    its storage of 16 or 32 bits.
//! 10. No dead nodes.
//! 11. Tracking, which runs in periods without control, ends with a stage and reads no set-point
//!     word; the interval of every state word that it does not set contains 0.

use std::collections::HashSet;
use std::fmt::{self, Display};
use std::hash::Hash;

use super::graph::{AtRest, Function, Program, Word};
use super::interval::Interval;
use super::op::{Kind, Op, Value};

/// A broken invariant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Function and value.
    pub place: String,
    /// What is wrong.
    pub what: String,
    /// The interval that exceeds its word, for scaling.
    pub escaped: Option<Interval>,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.what)
    }
}

/// A program with all invariants of this module's header: the only input of emitters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VerifiedGraph(Program);

impl VerifiedGraph {
    /// The program.
    pub fn program(&self) -> &Program {
        &self.0
    }

    /// The same program with nameless constants, which macros write by value.
    pub(crate) fn without_constant_names(mut self) -> Self {
        for constant in &mut self.0.constants {
            constant.name.clear();
        }
        self
    }
}

/// Checks all invariants.
///
/// # Errors
/// Every violation found.
pub fn verify(program: Program) -> Result<VerifiedGraph, Vec<Violation>> {
    let mut violations = Violations(vec![]);
    let constants = program.constants.iter().map(|constant| &constant.name);
    violations.repeated(constants.chain(program.tables.iter().map(|table| &table.name)));
    violations.repeated(program.words().map(|word| &word.name));
    violations.repeated(program.functions().map(|function| &function.name));
    for table in &program.tables {
        if !table.values.len().is_power_of_two() {
            violations.add(&table.name, "table length is not a power of two");
        }
    }
    for word in program.words() {
        check_word(word, &mut violations);
    }
    for function in program.functions() {
        FunctionCheck {
            program: &program,
            function,
            violations: &mut violations,
        }
        .run();
    }
    let set = program
        .step
        .next_state
        .iter()
        .map(|(state, _)| state.index());
    let set: Vec<usize> = set.collect();
    for (index, word) in program.states.iter().enumerate() {
        if set.iter().filter(|&&state| state == index).count() != 1 {
            violations.add(&word.name, "state word is not set exactly once");
        }
    }
    if !program.step.next_params.is_empty() {
        violations.add(&program.step.name, "the step sets a set-point word");
    }
    for (_, setter) in &program.setters {
        if !setter.next_state.is_empty() {
            violations.add(&setter.name, "a setter sets a state word");
        }
        let mut set = HashSet::new();
        if !setter
            .next_params
            .iter()
            .all(|(param, _)| set.insert(param.index()))
        {
            violations.add(&setter.name, "set-point word is set twice");
        }
    }
    if violations.0.is_empty() {
        Ok(VerifiedGraph(program))
    } else {
        Err(violations.0)
    }
}

fn check_word(word: &Word, violations: &mut Violations) {
    let initial = Interval::point(i64::from(word.initial));
    if !word.interval.contains(initial) {
        violations.add(
            &word.name,
            &format!("initial value {} outside {}", word.initial, word.interval),
        );
    }
    let fits = match word.storage_bits {
        16 => Interval::HALFWORD.contains(word.interval),
        32 => word.interval.bits() <= 32,
        _ => false,
    };
    if !fits {
        violations.escape(&word.name, word.interval, word.storage_bits);
    }
}

struct Violations(Vec<Violation>);

impl Violations {
    fn add(&mut self, place: &str, what: &str) {
        self.0.push(Violation {
            place: place.to_owned(),
            what: what.to_owned(),
            escaped: None,
        });
    }

    /// Reports repeated names.
    fn repeated<N: Eq + Hash + Copy + Display>(&mut self, names: impl Iterator<Item = N>) {
        let mut known = HashSet::new();
        for name in names {
            if !known.insert(name) {
                self.add(&name.to_string(), "named twice");
            }
        }
    }

    fn escape(&mut self, place: &str, interval: Interval, bits: u32) {
        let what = format!(
            "interval {interval} needs {} bits, the word has {bits}",
            interval.bits()
        );
        self.0.push(Violation {
            place: place.to_owned(),
            what,
            escaped: Some(interval),
        });
    }
}

struct FunctionCheck<'a> {
    program: &'a Program,
    function: &'a Function,
    violations: &'a mut Violations,
}

impl FunctionCheck<'_> {
    fn run(mut self) {
        self.check_order();
        // The checks below follow operands, so operands must exist.
        if self.violations.0.is_empty() {
            self.check_stages();
            self.check_tracking();
            self.check_nodes();
            self.check_names();
            self.check_results();
        }
    }

    fn fail(&mut self, value: usize, what: &str) {
        let place = self.place(value);
        self.violations.add(&place, what);
    }

    fn place(&self, value: usize) -> String {
        let function = &self.function.name;
        match self.function.nodes.get(value) {
            None => format!("{function}: %{value}"),
            Some(node) if node.name.is_empty() => {
                format!("{function}: %{value} ({:?})", node.op)
            }
            Some(node) => format!("{function}: {}", node.name),
        }
    }

    /// Outputs, new state words and new set-point words.
    fn results(&self) -> impl Iterator<Item = Value> {
        let function = self.function;
        let outputs = function.outputs.iter().map(|&(_, value)| value);
        let states = function.next_state.iter().map(|&(_, value)| value);
        let params = function.next_params.iter().map(|&(_, value)| value);
        outputs.chain(states).chain(params)
    }

    fn roots(&self) -> Vec<Value> {
        let guards = self
            .function
            .stages
            .iter()
            .filter_map(|stage| stage.guard.as_ref().map(|guard| guard.condition));
        self.results().chain(guards).collect()
    }

    fn check_order(&mut self) {
        let function = self.function;
        for (index, node) in function.nodes.iter().enumerate() {
            if node
                .op
                .operands()
                .iter()
                .any(|operand| operand.index() >= index)
            {
                self.fail(index, "operand defined later");
            }
            let known = match node.op {
                Op::Input(n) => (n as usize) < function.inputs.len(),
                Op::Param(id) => id.index() < self.program.params.len(),
                Op::State(id) => id.index() < self.program.states.len(),
                Op::Constant(id) => id.index() < self.program.constants.len(),
                Op::Lookup { table, .. } => table.index() < self.program.tables.len(),
                _ => true,
            };
            if let Op::Lookup {
                table,
                index: place,
                is_masked: false,
            } = node.op
                && known
                && place.index() < index
                && !self.program.tables[table.index()].has(function.node(place).interval)
            {
                self.fail(index, "the index may leave the table");
            }
            if !known {
                self.fail(index, "names a word, constant or table that does not exist");
            }
        }
        let (states, params) = (self.program.states.len(), self.program.params.len());
        let unknown_word = function
            .next_state
            .iter()
            .any(|(id, _)| id.index() >= states)
            || function
                .next_params
                .iter()
                .any(|(id, _)| id.index() >= params);
        let undefined = |root: &Value| root.index() >= function.nodes.len();
        if unknown_word || self.roots().iter().any(undefined) {
            self.violations.add(&function.name, "result is not defined");
        }
    }

    /// Stage number of every node; joins belong to no stage.
    fn stage_of_nodes(&self) -> Vec<Option<usize>> {
        let mut stage_of = vec![None; self.function.nodes.len()];
        for (number, stage) in self.function.stages.iter().enumerate() {
            for slot in stage_of.iter_mut().take(stage.end).skip(stage.first) {
                *slot = Some(number);
            }
        }
        stage_of
    }

    fn check_stages(&mut self) {
        let function = self.function;
        let mut next = 0;
        for stage in &function.stages {
            if stage.first != next || stage.end < stage.first {
                self.violations
                    .add(&stage.name, "stages do not follow one another");
            }
            next = stage.end;
            for join in stage.guard.iter().flat_map(|guard| &guard.joins) {
                let behind = join.index() == next;
                next += 1;
                let is_before =
                    |value: Value| value.index() < stage.first || function.node(value).op.is_leaf();
                let from_inside = match function.node(*join).op {
                    Op::Join { taken, otherwise } => {
                        let is_inside = (stage.first..stage.end).contains(&taken.index());
                        (is_inside || is_before(taken)) && is_before(otherwise)
                    }
                    _ => false,
                };
                if !behind || !from_inside {
                    self.fail(join.index(), "is no join of the stage before it");
                }
            }
            if let Some(guard) = &stage.guard
                && guard.condition.index() >= stage.first
            {
                self.violations
                    .add(&stage.name, "guard is defined after the stage begins");
            }
        }
        if next != function.nodes.len() {
            self.violations
                .add(&function.name, "stages do not cover all nodes");
        }
        let stage_of = self.stage_of_nodes();
        let guarded =
            |node: usize| stage_of[node].filter(|&stage| function.stages[stage].guard.is_some());
        for (index, node) in function.nodes.iter().enumerate() {
            for operand in node.op.operands() {
                let inside = guarded(operand.index());
                let own_join = inside.is_some_and(|stage| {
                    function.stages[stage]
                        .guard
                        .as_ref()
                        .is_some_and(|guard| guard.joins.contains(&Value(index as u32)))
                });
                let is_leaf = function.node(operand).op.is_leaf();
                if inside.is_some() && stage_of[index] != inside && !own_join && !is_leaf {
                    self.fail(
                        operand.index(),
                        "leaves its guarded stage other than by a join",
                    );
                }
            }
        }
        for root in self.roots() {
            let is_leaf = function.node(root).op.is_leaf();
            if guarded(root.index()).is_some() && !is_leaf {
                self.fail(
                    root.index(),
                    "leaves its guarded stage other than by a join",
                );
            }
        }
    }

    fn check_tracking(&mut self) {
        let function = self.function;
        let mut begins = function.stages.iter().map(|stage| stage.first);
        let count = function.nodes.len();
        if function.tracking != count && !begins.any(|first| first == function.tracking) {
            self.violations
                .add(&function.name, "tracking does not end with a stage");
        }
        for value in function.values().take(function.tracking) {
            if matches!(function.node(value).op, Op::Param(_)) {
                self.fail(value.index(), "tracking reads a set-point word");
            }
        }
        for &(state, value) in &function.next_state {
            let word = &self.program.states[state.index()];
            let is_forgotten = function.at_rest(value) == AtRest::Forgotten;
            if is_forgotten && !word.interval.contains(Interval::point(0)) {
                let what = format!("{}: forgotten at rest, but never 0", word.name);
                self.violations.add(&function.name, &what);
            }
        }
    }

    fn check_nodes(&mut self) {
        let function = self.function;
        for (index, node) in function.nodes.iter().enumerate() {
            let kinds: Vec<Kind> = node
                .op
                .operands()
                .iter()
                .map(|&operand| function.node(operand).kind)
                .collect();
            if node.kind != node.op.kind(|value| function.node(value).kind)
                || kinds != node.op.operand_kinds(node.kind)
            {
                self.fail(index, "operand kinds do not fit the operator");
            }
            let operands: Vec<Interval> = node
                .op
                .operands()
                .iter()
                .map(|&operand| function.node(operand).interval)
                .collect();
            if !in_domain(&node.op, &operands) {
                self.fail(index, "operands may leave the operator's domain");
                continue;
            }
            let derived = derived_interval(self.program, function, index);
            if !Interval::WORD.contains(node.interval) {
                let place = self.place(index);
                self.violations.escape(&place, node.interval, 32);
            } else if derived != Some(node.interval) {
                self.fail(
                    index,
                    &format!(
                        "interval {} does not follow from the operands",
                        node.interval
                    ),
                );
            }
        }
    }

    fn check_names(&mut self) {
        let function = self.function;
        self.violations
            .repeated(function.inputs.iter().map(|input| &input.name));
        self.violations
            .repeated(function.outputs.iter().map(|(output, _)| output));
        self.violations
            .repeated(function.told.iter().map(|(told, _)| told));
        self.violations
            .repeated(function.stages.iter().map(|stage| &stage.name));
        let stage_of = self.stage_of_nodes();
        let mut names = HashSet::new();
        // Number of uses, and the stage of the last use.
        let mut uses: Vec<(usize, Option<usize>)> = vec![(0, None); function.nodes.len()];
        let mut note = |operand: Value, stage| {
            let used = &mut uses[operand.index()];
            *used = (used.0 + 1, stage);
        };
        for (index, node) in function.nodes.iter().enumerate() {
            let stage = match node.op {
                Op::Join { .. } => None,
                _ => stage_of[index],
            };
            node.op.visit_operands(|operand| note(operand, stage));
            if !node.name.is_empty() && !names.insert(node.name.as_str()) {
                self.fail(index, "named twice");
            }
        }
        for root in self.roots() {
            note(root, None);
        }
        for &(_, value) in &function.told {
            if uses[value.index()].0 == 0 {
                self.fail(value.index(), "is told to people and used for nothing else");
            }
            uses[value.index()] = (uses[value.index()].0 + 1, None);
        }
        for (index, node) in function.nodes.iter().enumerate() {
            let free = matches!(node.op, Op::Constant(_) | Op::Literal(_));
            if uses[index].0 == 0 {
                self.fail(index, "is never used");
            } else if node.name.is_empty() && !free && uses[index] != (1, stage_of[index]) {
                self.fail(
                    index,
                    "is used more than once or outside its stage and has no name",
                );
            }
        }
    }

    fn check_results(&mut self) {
        let function = self.function;
        let told = function.told.iter().map(|&(_, value)| value);
        let results: Vec<Value> = self.results().chain(told).collect();
        for result in results {
            if function.node(result).kind != Kind::Word {
                self.fail(result.index(), "a result is no word");
            }
        }
        let states = function
            .next_state
            .iter()
            .map(|&(id, value)| (&self.program.states[id.index()], value));
        let params = function
            .next_params
            .iter()
            .map(|&(id, value)| (&self.program.params[id.index()].1, value));
        let wrong: Vec<String> = states
            .chain(params)
            .filter(|(word, value)| !word.interval.contains(function.node(*value).interval))
            .map(|(word, value)| {
                format!(
                    "{}: set to {}, holds {}",
                    word.name,
                    function.node(value).interval,
                    word.interval
                )
            })
            .collect();
        for what in wrong {
            self.violations.add(&function.name, &what);
        }
    }
}

/// The interval of node `index` from the stored intervals of its operands; `None` if the operator's
/// domain may be left.
pub fn derived_interval(program: &Program, function: &Function, index: usize) -> Option<Interval> {
    let op = function.nodes[index].op;
    let operands = op.operands().into_iter();
    let x: Vec<Interval> = operands.map(|x| function.node(x).interval).collect();
    let guards = function
        .stages
        .iter()
        .filter_map(|stage| stage.guard.as_ref());
    match op {
        Op::Input(n) => Some(function.inputs[n as usize].interval),
        Op::Param(id) => Some(program.params[id.index()].1.interval),
        Op::State(id) => Some(program.states[id.index()].interval),
        Op::Constant(id) => {
            let raw = program.constants[id.index()].raw;
            Some(Interval::point(i64::from(raw)))
        }
        Op::Join { otherwise, .. } => {
            let mut guards = guards.filter(|guard| guard.joins.contains(&Value(index as u32)));
            let condition = guards.next()?.condition;
            Some(x[0].union(function.interval_where_not(condition, otherwise)))
        }
        op => op.interval(&x, |table| program.tables[table.index()].interval()),
    }
}

/// Checks of shifts, segments and limits that [`Op::interval`] does not make.
fn in_domain(op: &Op, x: &[Interval]) -> bool {
    let formed = match *op {
        Op::MulRound { shift, .. } => (1..=62).contains(&shift),
        Op::MulFloor { shift, .. } | Op::MulAddFloor { shift, .. } => shift <= 62,
        Op::ShiftLeft(_, n) | Op::ShiftRight(_, n) => n <= 31,
        Op::Remainder(_, n) => (1..=30).contains(&n),
        Op::Divide { shift, .. } | Op::DivideNarrow { shift, .. } => shift <= 31 && x[2].low >= 0,
        Op::AngleIndex { segments, .. } | Op::AngleFraction { segments, .. } => {
            (1..=1 << 16).contains(&segments)
        }
        Op::Clamp { .. } => x[1].high <= x[2].low,
        _ => true,
    };
    let leaf = matches!(
        op,
        Op::Input(_) | Op::Param(_) | Op::State(_) | Op::Constant(_)
    );
    formed && op.is_narrow(x) && (leaf || op.interval(x, |_| Interval::point(0)).is_some())
}
