//! What each stage of a function takes, yields and stores: everything that a signature needs.
//!
//! Constants, small numbers, inputs, set-point words and state words are leaves: they belong to no
//! stage and are read where they are used. All else is a result of the stage that computes it if
//! something outside uses it.

use super::groups::Signal;
use crate::ir::{Function, Op, Program, Stage, StateId, Value};

/// Who uses a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum User {
    /// A node.
    Node(usize),
    /// The new value of a state word.
    NextState(StateId),
    /// An output, a new set-point word or the guard of a stage.
    Other,
}

/// A value that leaves a stage.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    /// Name and kind outside of the stage.
    pub signal: Signal,
    /// The value within the stage.
    pub value: Value,
    /// For a guarded stage: what holds where it does not run.
    pub otherwise: Option<Value>,
}

/// One stage, as a function.
#[derive(Clone, Debug)]
pub(super) struct StagePlan<'a> {
    /// The stage.
    pub stage: &'a Stage,
    /// Its nodes that become code.
    pub body: Vec<Value>,
    /// State words that it reads.
    pub reads: Vec<StateId>,
    /// Values from outside that it uses, in the order of their definition.
    pub arguments: Vec<Value>,
    /// Values that it yields.
    pub outcomes: Vec<Outcome>,
    /// State words that a guarded stage stores itself: nothing else happens to them, so that the
    /// normal path need not touch them.
    pub stores: Vec<(StateId, Value)>,
}

/// Whether a value is read where it is used rather than computed by a stage.
pub(super) fn is_leaf(op: &Op) -> bool {
    matches!(
        op,
        Op::Input(_) | Op::Param(_) | Op::State(_) | Op::Constant(_) | Op::Literal(_)
    )
}

/// Plans all stages of `function`.
pub(super) fn plan<'a>(program: &Program, function: &'a Function) -> Vec<StagePlan<'a>> {
    let users = users(function);
    function
        .stages
        .iter()
        .map(|stage| plan_stage(program, function, &users, stage))
        .collect()
}

/// The name and kind of a value.
pub(super) fn signal(function: &Function, value: Value) -> Signal {
    let node = function.node(value);
    Signal {
        name: node.name.clone(),
        kind: node.kind,
    }
}

fn users(function: &Function) -> Vec<Vec<User>> {
    let mut users = vec![vec![]; function.nodes.len()];
    for (index, node) in function.nodes.iter().enumerate() {
        for operand in node.op.operands() {
            users[operand.index()].push(User::Node(index));
        }
    }
    for &(state, value) in &function.next_state {
        users[value.index()].push(User::NextState(state));
    }
    let conditions = function
        .stages
        .iter()
        .filter_map(|stage| stage.guard.as_ref())
        .map(|guard| guard.condition);
    let results = function.outputs.iter().map(|&(_, value)| value);
    let params = function.next_params.iter().map(|&(_, value)| value);
    for value in conditions.chain(results).chain(params) {
        users[value.index()].push(User::Other);
    }
    users
}

fn plan_stage<'a>(
    program: &Program,
    function: &'a Function,
    users: &[Vec<User>],
    stage: &'a Stage,
) -> StagePlan<'a> {
    let inside = stage.first..stage.end;
    let body: Vec<Value> = inside
        .clone()
        .map(|index| Value(index as u32))
        .filter(|&value| !is_leaf(&function.node(value).op))
        .collect();
    let (mut outcomes, mut stores) = (vec![], vec![]);
    match &stage.guard {
        None => {
            for &value in &body {
                let leaves =
                    |user: &User| !matches!(user, User::Node(index) if inside.contains(index));
                if users[value.index()].iter().any(leaves) {
                    outcomes.push(Outcome {
                        signal: signal(function, value),
                        value,
                        otherwise: None,
                    });
                }
            }
        }
        Some(guard) => {
            for &join in &guard.joins {
                let Op::Join { taken, otherwise } = function.node(join).op else {
                    continue;
                };
                match stored_inside(function, users, stage, join, otherwise) {
                    Some(state) => stores.push((state, taken)),
                    None => outcomes.push(Outcome {
                        signal: signal(function, join),
                        value: taken,
                        otherwise: Some(otherwise),
                    }),
                }
            }
        }
    }
    let mut used: Vec<Value> = body
        .iter()
        .flat_map(|&value| function.node(value).op.operands())
        .collect();
    used.extend(outcomes.iter().map(|outcome| outcome.value));
    used.extend(stores.iter().map(|&(_, value)| value));
    used.sort_unstable();
    used.dedup();
    let mut reads = vec![];
    let mut arguments = vec![];
    for value in used {
        match function.node(value).op {
            Op::Constant(_) | Op::Literal(_) => {}
            Op::State(state) => reads.push(state),
            Op::Input(_) | Op::Param(_) => arguments.push(value),
            _ if inside.contains(&value.index()) => {}
            _ => arguments.push(value),
        }
    }
    reads.sort_by_key(|state| state.index());
    debug_assert!(
        reads
            .iter()
            .all(|state| state.index() < program.states.len()),
        "verified"
    );
    StagePlan {
        stage,
        body,
        reads,
        arguments,
        outcomes,
        stores,
    }
}

/// The state word that the guarded stage may store itself in place of `join`: the join is its next
/// value and nothing else, it keeps its value where the stage does not run, and nothing reads the
/// old value later.
fn stored_inside(
    function: &Function,
    users: &[Vec<User>],
    stage: &Stage,
    join: Value,
    otherwise: Value,
) -> Option<StateId> {
    let Op::State(kept) = function.node(otherwise).op else {
        return None;
    };
    let only_next = users[join.index()] == [User::NextState(kept)];
    let joins = stage.guard.as_ref().map_or(0, |guard| guard.joins.len());
    let behind = stage.end + joins;
    let read_before = |user: &User| matches!(user, User::Node(index) if *index < behind);
    (only_next && users[otherwise.index()].iter().all(read_before)).then_some(kept)
}
