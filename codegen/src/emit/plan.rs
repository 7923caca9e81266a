//! Arguments, results and stored words of each stage.
//!
//! Constants, small numbers, inputs, set-point words and state words are leaves: they belong to no
//! stage and are read where they are used. Any other value is a result of its stage if it is used
//! outside of it.

use super::rows::WholeCommand;
use super::signal::{Shape, Signal};
use crate::ir::{Function, Kind, Op, Output, Program, Stage, StateId, Value};
use std::collections::BTreeSet;

/// User of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum User {
    /// A node.
    Node(usize),
    /// The new value of a state word.
    NextState(StateId),
    /// The state of a leg.
    Leg,
    /// The guard of a stage that begins with this node.
    Guard(usize),
    /// Another output, or a new set-point word.
    Other,
}

/// A function and the uses of its values.
#[derive(Debug)]
pub(super) struct Context<'a> {
    /// The program.
    pub program: &'a Program,
    /// The function.
    pub function: &'a Function,
    users: Vec<Vec<User>>,
    legs: BTreeSet<Value>,
    /// Values that no stage computes: the lookup of a whole command.
    left_out: BTreeSet<Value>,
}

/// A value that leaves a stage.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    /// Name and shape outside of the stage.
    pub signal: Signal,
    /// The value within the stage.
    pub value: Value,
    /// For a guarded stage: the value if it does not run.
    pub otherwise: Option<Value>,
}

/// One stage, as a function.
#[derive(Clone, Debug)]
pub(super) struct StagePlan<'a> {
    /// The stage.
    pub stage: &'a Stage,
    /// Its nodes that are emitted.
    pub body: Vec<Value>,
    /// State words that it reads.
    pub reads: Vec<StateId>,
    /// Values from outside that it uses, in the order of their definition.
    pub arguments: Vec<Value>,
    /// Its results.
    pub outcomes: Vec<Outcome>,
    /// State words that a guarded stage stores itself, so that the normal path does not write them.
    pub stores: Vec<(StateId, Value)>,
}

impl<'a> Context<'a> {
    /// Collects the uses of all values of `function`.
    pub(super) fn new(program: &'a Program, function: &'a Function) -> Self {
        let users = users(function);
        let legs = legs(program, function, &users);
        Self {
            program,
            function,
            users,
            legs,
            left_out: BTreeSet::new(),
        }
    }

    /// Likewise for a step whose command is looked up as a `whole`.
    pub(super) fn of_step(program: &'a Program, whole: Option<&WholeCommand<'_>>) -> Self {
        let mut context = Self::new(program, &program.step);
        if let Some(whole) = whole {
            context.left_out = whole.entries.iter().copied().collect();
            context.users[whole.index.index()].push(User::Other);
        }
        context
    }

    /// The values of the tracking that the rest of the step uses, in order.
    pub(super) fn handed_over(&self) -> Vec<Value> {
        let tracking = self.function.values().take(self.function.tracking);
        let is_used = |user: &User| match *user {
            User::Node(node) | User::Guard(node) => node >= self.function.tracking,
            User::NextState(state) => !self.is_tracked(state),
            User::Leg | User::Other => true,
        };
        let computed = tracking.filter(|&value| !self.function.node(value).op.is_leaf());
        computed
            .filter(|value| self.users[value.index()].iter().any(is_used))
            .collect()
    }

    /// Whether the tracking stores a state word: it computes the new value, and the control part
    /// does not read the old one.
    pub(super) fn is_tracked(&self, state: StateId) -> bool {
        let mut next = self.function.next_state.iter();
        let Some(&(_, value)) = next.find(|(known, _)| *known == state) else {
            return false;
        };
        let is_old = |value: &Value| self.function.node(*value).op == Op::State(state);
        let read_behind = |user: &User| match *user {
            User::Node(node) | User::Guard(node) => node >= self.function.tracking,
            User::NextState(other) => other != state,
            User::Leg | User::Other => true,
        };
        let is_own = self.function.is_tracking(value)
            && !matches!(
                self.function.node(value).op,
                Op::Input(_) | Op::Literal(_) | Op::Constant(_)
            );
        let mut old = self.function.values().filter(is_old);
        is_own && !old.any(|old| self.users[old.index()].iter().any(read_behind))
    }

    /// Plans all stages.
    pub(super) fn plan(&self) -> Vec<StagePlan<'a>> {
        self.function
            .stages
            .iter()
            .map(|stage| self.plan_stage(stage))
            .collect()
    }

    /// Shape of a value in emitted code.
    pub(super) fn shape(&self, value: Value) -> Shape {
        match self.function.node(value).kind {
            Kind::Flag => Shape::Flag,
            Kind::Word if self.legs.contains(&value) => Shape::Leg,
            Kind::Word => Shape::Word,
        }
    }

    /// The name and shape of a value.
    pub(super) fn signal(&self, value: Value) -> Signal {
        Signal {
            name: self.function.node(value).name.clone(),
            shape: self.shape(value),
        }
    }

    fn plan_stage(&self, stage: &'a Stage) -> StagePlan<'a> {
        let function = self.function;
        let inside = stage.first..stage.end;
        let body: Vec<Value> = inside
            .clone()
            .map(|index| Value(index as u32))
            .filter(|value| !function.node(*value).op.is_leaf() && !self.left_out.contains(value))
            .collect();
        let (mut outcomes, mut stores) = (vec![], vec![]);
        match &stage.guard {
            None => {
                for &value in &body {
                    let leaves =
                        |user: &User| !matches!(user, User::Node(index) if inside.contains(index));
                    if self.users[value.index()].iter().any(leaves) {
                        outcomes.push(Outcome {
                            signal: self.signal(value),
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
                    let stored = self.stored_inside(stage, join, otherwise);
                    stores.extend(stored.map(|state| (state, taken)));
                    if stored.is_none_or(|state| self.is_used_besides(join, state)) {
                        outcomes.push(Outcome {
                            signal: self.signal(join),
                            value: taken,
                            otherwise: Some(otherwise),
                        });
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
        StagePlan {
            stage,
            body,
            reads,
            arguments,
            outcomes,
            stores,
        }
    }

    /// The state word that the guarded stage may store itself: the join is its next value, its old
    /// value stays if the stage does not run, and nothing reads the old value later.
    fn stored_inside(&self, stage: &Stage, join: Value, otherwise: Value) -> Option<StateId> {
        let Op::State(kept) = self.function.node(otherwise).op else {
            return None;
        };
        let is_next = self.users[join.index()].contains(&User::NextState(kept));
        let joins = stage.guard.as_ref().map_or(0, |guard| guard.joins.len());
        let behind = stage.end + joins;
        let read_before = |user: &User| matches!(user, User::Node(index) if *index < behind);
        (is_next && self.users[otherwise.index()].iter().all(read_before)).then_some(kept)
    }

    /// Whether a value has another use than as the next one of a state word.
    fn is_used_besides(&self, value: Value, state: StateId) -> bool {
        self.users[value.index()] != [User::NextState(state)]
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
    for stage in &function.stages {
        if let Some(guard) = &stage.guard {
            users[guard.condition.index()].push(User::Guard(stage.first));
        }
    }
    for (output, value) in &function.outputs {
        let user = match output {
            Output::Leg(_) => User::Leg,
            Output::Compare(_) | Output::End(_) | Output::States(_) | Output::Probe(_) => {
                User::Other
            }
        };
        users[value.index()].push(user);
    }
    let params = function.next_params.iter().map(|&(_, value)| value);
    let told = function.told.iter().map(|&(_, value)| value);
    for value in params.chain(told) {
        users[value.index()].push(User::Other);
    }
    users
}

/// Values used as leg states only: they are chosen among `LegState`s, or looked up as such.
fn legs(program: &Program, function: &Function, users: &[Vec<User>]) -> BTreeSet<Value> {
    let mut legs = BTreeSet::new();
    for (index, node) in function.nodes.iter().enumerate().rev() {
        let value = Value(index as u32);
        let is_choice = match node.op {
            Op::Select { .. } | Op::Join { .. } => true,
            Op::Lookup { table, .. } => program.tables[table.index()].holds_legs,
            _ => false,
        };
        let is_arm = |user: usize| match function.nodes[user].op {
            Op::Select { condition, .. } => condition != value,
            _ => true,
        };
        let becomes_leg = |user: &User| match *user {
            User::Leg => true,
            User::Node(user) => legs.contains(&Value(user as u32)) && is_arm(user),
            User::NextState(_) | User::Guard(_) | User::Other => false,
        };
        if is_choice && users[index].iter().all(becomes_leg) {
            legs.insert(value);
        }
    }
    legs
}
