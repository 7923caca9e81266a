//! The step and the setters as calls of their stages, whatever the language.

use super::plan::{Context, StagePlan};
use crate::ir::{AtRest, Demand, Function, Op, Program, StateId, Value, Word};

/// The two parts of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// Runs in every period.
    Tracking,
    /// Runs in controlled periods.
    Control,
}

impl Part {
    /// Whether a stage belongs to the part.
    pub(super) fn has(self, function: &Function, plan: &StagePlan<'_>) -> bool {
        let is_tracking = plan.stage.first < function.tracking;
        is_tracking == (self == Self::Tracking)
    }
}

/// The outputs of a function, state and set-point words left out.
fn results(function: &Function) -> impl Iterator<Item = Value> {
    let outputs = function.outputs.iter().map(|&(_, value)| value);
    outputs.chain(function.told.iter().map(|&(_, value)| value))
}

/// Set-point words that are fields of the runtime's drive, with their names.
pub(super) const SINGLE: [(Demand, &str); 2] =
    [(Demand::Current, "current"), (Demand::Speed, "speed")];

/// The set-point words that a function reads.
pub(super) fn demands_read(program: &Program, function: &Function) -> Vec<Demand> {
    let read = function.nodes.iter().filter_map(|node| match node.op {
        Op::Param(id) => Some(program.params[id.index()].0),
        _ => None,
    });
    read.collect()
}

/// Names of the inputs that the values use, in the order of the inputs.
pub(super) fn inputs_used(function: &Function, values: impl Iterator<Item = Value>) -> Vec<&str> {
    let mut used: Vec<u32> = values
        .filter_map(|value| match function.node(value).op {
            Op::Input(n) => Some(n),
            _ => None,
        })
        .collect();
    used.sort_unstable();
    used.dedup();
    let names = used.into_iter();
    names
        .map(|n| function.inputs[n as usize].name.as_str())
        .collect()
}

/// State words set by a part of a step.
pub(super) struct Kept<'a> {
    /// Old words among the outputs: read before any word is written.
    pub reads: Vec<Value>,
    /// New state words, written once at the end, in an order that reads each old word before it is
    /// overwritten.
    pub words: Vec<(&'a Word, Value)>,
    /// The values from outside that the part's calls and stores use.
    pub used: Vec<Value>,
}

impl Kept<'_> {
    /// Whether a new value is an old word without a local name, read when it is written.
    pub(super) fn is_moved(&self, function: &Function, value: Value) -> bool {
        matches!(function.node(value).op, Op::State(_)) && !self.reads.contains(&value)
    }
}

/// The words that a part of the step sets at its end, without those that its stages store.
pub(super) fn kept<'a>(context: &Context<'a>, plans: &[StagePlan<'a>], part: Part) -> Kept<'a> {
    let (program, function) = (context.program, context.function);
    let is_kept = |&(state, value): &(StateId, Value)| {
        let mut stores = plans.iter().flat_map(|plan| &plan.stores);
        let is_stored = stores.any(|&(stored, _)| stored == state);
        let is_changed = function.node(value).op != Op::State(state);
        let is_tracked = context.is_tracked(state);
        is_changed && !is_stored && is_tracked == (part == Part::Tracking)
    };
    let is_old = |value: Value| matches!(function.node(value).op, Op::State(_));
    let words = function.next_state.iter().copied().filter(is_kept);
    let (mut moved, mut computed): (Vec<_>, Vec<_>) = words.partition(|&(_, value)| is_old(value));
    let mut reads: Vec<Value> = vec![];
    if part == Part::Control {
        reads.extend(results(function).filter(|&value| is_old(value)));
        reads.sort_unstable();
        reads.dedup();
    }
    let mut words = vec![];
    while !moved.is_empty() {
        let is_read = |state| {
            let mut moved = moved.iter();
            moved.any(|&(_, value)| function.node(value).op == Op::State(state))
        };
        let Some(next) = moved.iter().position(|&(state, _)| !is_read(state)) else {
            // Words exchange their values.
            reads.extend(moved.iter().map(|&(_, value)| value));
            break;
        };
        words.push(moved.remove(next));
    }
    words.append(&mut moved);
    words.append(&mut computed);
    let mut used: Vec<Value> = plans
        .iter()
        .filter(|plan| part.has(function, plan))
        .flat_map(used_by)
        .collect();
    used.extend(words.iter().map(|&(_, value)| value));
    if part == Part::Control {
        used.extend(results(function));
    }
    let words = words.into_iter();
    Kept {
        reads,
        words: words
            .map(|(state, value)| (&program.states[state.index()], value))
            .collect(),
        used,
    }
}

/// The values from outside that a stage's call uses.
fn used_by<'p>(plan: &'p StagePlan<'_>) -> impl Iterator<Item = Value> + 'p {
    let guard = plan.stage.guard.as_ref().map(|guard| guard.condition);
    let otherwise = plan.outcomes.iter().filter_map(|outcome| outcome.otherwise);
    plan.arguments.iter().copied().chain(guard).chain(otherwise)
}

/// Values at rest of the words that the tracking does not store.
pub(super) fn kept_at_rest<'a>(context: &Context<'a>) -> Vec<(&'a Word, AtRest)> {
    let function = context.function;
    let next = function.next_state.iter();
    let others = next.filter(|(state, value)| {
        let is_changed = function.node(*value).op != Op::State(*state);
        is_changed && !context.is_tracked(*state)
    });
    others
        .map(|&(state, value)| {
            let word = &context.program.states[state.index()];
            (word, function.at_rest(value))
        })
        .collect()
}

/// The words that a setter sets, in the order of the program's set-point words.
pub(super) fn writes(setter: &Function) -> Vec<Value> {
    let mut written = setter.next_params.clone();
    written.sort_by_key(|(param, _)| param.index());
    written.into_iter().map(|(_, value)| value).collect()
}
