//! A path of the step, or a setter, as calls of its stages: what every language's functions are made of.

use super::plan::{Context, StagePlan};
use super::set_point::{Shared, shared};
use crate::ir::{Function, Op, Program, StateId, Value, Word};

/// A stage as a language writes it.
pub(super) trait StageCode {
    /// Name of its function.
    fn name(&self) -> &str;
    /// What it is planned as.
    fn plan(&self) -> &StagePlan<'_>;
    /// The text of its function.
    fn text(&self) -> String;
}

/// The stages of a path beside those of another, and which of them are functions of the other: a stage that is the
/// same there is that function, and one that is not has a name of its own.
pub(super) fn beside<'a, S: StageCode>(
    context: &'a Context<'a>,
    others: &[S],
    make: impl Fn(StagePlan<'a>, &str) -> S,
) -> (Vec<S>, Vec<bool>) {
    let (mut stages, mut shared) = (vec![], vec![]);
    for plan in context.plan() {
        let name = plan.stage.name.clone();
        let stage = make(plan.clone(), &name);
        let other = others.iter().find(|other| other.name() == stage.name());
        let is_same = other.is_some_and(|other| other.text() == stage.text());
        shared.push(is_same);
        stages.push(if is_same || other.is_none() {
            stage
        } else {
            make(plan, &format!("{name}_at_rest"))
        });
    }
    (stages, shared)
}

/// The flags behind a stage of which one that holds ends the path.
pub(super) fn leaves_behind(function: &Function, plan: &StagePlan<'_>) -> Vec<Value> {
    let inside = plan.stage.first..plan.stage.end;
    let flags = function.leave.iter().copied();
    flags
        .filter(|flag| inside.contains(&flag.index()))
        .collect()
}

/// The value of an output by name.
pub(super) fn output(function: &Function, name: &str) -> Option<Value> {
    let mut outputs = function.outputs.iter();
    let found = outputs.find(|(known, _)| known == name);
    found.map(|&(_, value)| value)
}

/// Positions of the set-point words that a function reads.
pub(super) fn params_read(function: &Function) -> Vec<usize> {
    let read = function.nodes.iter().filter_map(|node| match node.op {
        Op::Param(id) => Some(id.index()),
        _ => None,
    });
    read.collect()
}

/// Names of the set-point words that a function reads.
pub(super) fn words_read<'p>(program: &'p Program, function: &Function) -> Vec<&'p str> {
    let words = params_read(function).into_iter();
    words
        .map(|index| program.params[index].name.as_str())
        .collect()
}

/// Names of the inputs that a function reads.
pub(super) fn inputs_read(function: &Function) -> Vec<&str> {
    let inputs = function.nodes.iter().filter_map(|node| match node.op {
        Op::Input(n) => Some(function.inputs[n as usize].name.as_str()),
        _ => None,
    });
    inputs.collect()
}

/// What a path leaves behind.
pub(super) struct Kept<'a> {
    /// Old words that go into other words or out of the step: read before anything is written.
    pub reads: Vec<Value>,
    /// New state words, each written once at the end.
    pub words: Vec<(&'a Word, Value)>,
}

/// The words that a path keeps at its end: those that its stages store themselves are left out.
pub(super) fn kept<'a, S: StageCode>(context: &Context<'a>, stages: &[S]) -> Kept<'a> {
    let (program, function) = (context.program, context.function);
    let is_stored = |state: StateId| {
        let mut stores = stages.iter().flat_map(|stage| &stage.plan().stores);
        stores.any(|&(stored, _)| stored == state)
    };
    let words: Vec<(&Word, Value)> = function
        .next_state
        .iter()
        .filter(|(state, value)| function.node(*value).op != Op::State(*state))
        .filter(|(state, _)| !is_stored(*state))
        .map(|&(state, value)| (&program.states[state.index()], value))
        .collect();
    let mut reads: Vec<Value> = vec![];
    let outputs = function.outputs.iter().map(|&(_, value)| value);
    for value in words.iter().map(|&(_, value)| value).chain(outputs) {
        let is_old = matches!(function.node(value).op, Op::State(_));
        if is_old && !reads.contains(&value) {
            reads.push(value);
        }
    }
    Kept { reads, words }
}

/// What a setter writes: words that are replaced together, each with its new value; without one it stays.
pub(super) fn writes<'p>(
    program: &'p Program,
    setter: &Function,
) -> Vec<(Shared<'p>, Vec<Option<Value>>)> {
    let written = |word: usize| {
        let mut written = setter.next_params.iter();
        let found = written.find(|(param, _)| param.index() == word);
        found.map(|&(_, value)| value)
    };
    let all = shared(program).into_iter().map(|shared| {
        let values = shared.words.iter().map(|&(word, _)| written(word));
        let values: Vec<Option<Value>> = values.collect();
        (shared, values)
    });
    all.filter(|(_, values)| values.iter().any(Option::is_some))
        .collect()
}
