//! What each stage of a function takes, yields and stores: everything that a signature needs.
//!
//! Constants, small numbers, inputs, set-point words and state words are leaves: they belong to no
//! stage and are read where they are used. All else is a result of the stage that computes it if
//! something outside uses it.

use super::rows::WholeCommand;
use super::signal::{Shape, Signal};
use crate::ir::{Function, Kind, Op, Program, Stage, StateId, Value};
use std::collections::{BTreeMap, BTreeSet};

/// Who uses a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum User {
    /// A node.
    Node(usize),
    /// The new value of a state word.
    NextState(StateId),
    /// The state of a leg.
    Leg,
    /// Another output, a new set-point word or the guard of a stage.
    Other,
}

/// A function and what is known of its values.
#[derive(Debug)]
pub(super) struct Context<'a> {
    /// The program.
    pub program: &'a Program,
    /// The function.
    pub function: &'a Function,
    users: Vec<Vec<User>>,
    legs: BTreeSet<Value>,
    alarms: BTreeSet<Value>,
    /// Values that no stage computes: they go out of the step another way.
    left_out: BTreeSet<Value>,
    codes: BTreeMap<Value, Shape>,
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
    /// State words that a guarded stage stores itself: they change nowhere else, so that the normal path does not
    /// write them.
    pub stores: Vec<(StateId, Value)>,
}

/// Whether a value is read where it is used rather than computed by a stage.
pub(super) fn is_leaf(op: &Op) -> bool {
    matches!(
        op,
        Op::Input(_) | Op::Param(_) | Op::State(_) | Op::Constant(_) | Op::Literal(_)
    )
}

impl<'a> Context<'a> {
    /// Looks at all values of `function`.
    pub(super) fn new(program: &'a Program, function: &'a Function) -> Self {
        let users = users(function);
        let legs = legs(program, function, &users);
        let codes = codes(program, function);
        Self {
            program,
            function,
            users,
            legs,
            alarms: BTreeSet::new(),
            left_out: BTreeSet::new(),
            codes,
        }
    }

    /// Likewise, of a path whose flags to leave by are looked at together, behind the last of them: flags that do
    /// nothing else are words, which take no comparison each. None where a stage on the way is guarded: what it does
    /// is not for periods that are left. A command that is looked up as a `whole` is no stage's.
    pub(super) fn watched(
        program: &'a Program,
        function: &'a Function,
        whole: Option<&WholeCommand<'_>>,
    ) -> Self {
        let mut context = Self::new(program, function);
        if let Some(whole) = whole {
            context.left_out = whole.entries.iter().copied().collect();
            context.users[whole.index.index()].push(User::Other);
        }
        if context.leaves_once() {
            let only = |flag: &Value| context.users[flag.index()] == [User::Other];
            context.alarms = function.leave.iter().copied().filter(only).collect();
        }
        context
    }

    /// Of the other path, where the flags that `path` has as words are words, too: so both share the stages that find them.
    pub(super) fn beside(program: &'a Program, function: &'a Function, path: &Self) -> Self {
        let mut context = Self::new(program, function);
        let names = path
            .alarms
            .iter()
            .map(|&flag| &path.function.node(flag).name);
        let names: BTreeSet<&String> = names.collect();
        let values = (0..).map(Value).zip(&function.nodes);
        let named = values.filter(|(_, node)| names.contains(&node.name));
        context.alarms = named.map(|(value, _)| value).collect();
        context
    }

    /// Whether no stage up to the last flag to leave by is guarded.
    fn leaves_once(&self) -> bool {
        let last = self.function.leave.iter().map(|flag| flag.index()).max();
        let stages = self.function.stages.iter();
        let mut before = stages.filter(|stage| last.is_some_and(|last| stage.first <= last));
        before.all(|stage| stage.guard.is_none())
    }

    /// Plans all stages.
    pub(super) fn plan(&self) -> Vec<StagePlan<'a>> {
        self.function
            .stages
            .iter()
            .map(|stage| self.plan_stage(stage))
            .collect()
    }

    /// What a value is in emitted code.
    pub(super) fn shape(&self, value: Value) -> Shape {
        match self.function.node(value).kind {
            Kind::Flag if self.alarms.contains(&value) => Shape::Alarm,
            Kind::Flag => Shape::Flag,
            Kind::Word if self.legs.contains(&value) => Shape::Leg,
            Kind::Word => self.codes.get(&value).copied().unwrap_or(Shape::Word),
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
            .filter(|value| !is_leaf(&function.node(*value).op) && !self.left_out.contains(value))
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

    /// The state word that the guarded stage may store itself: the join is its next value, it keeps its value where
    /// the stage does not run, nothing reads the old value later, and no flag that is still to come leaves the path.
    fn stored_inside(&self, stage: &Stage, join: Value, otherwise: Value) -> Option<StateId> {
        let Op::State(kept) = self.function.node(otherwise).op else {
            return None;
        };
        let mut leave = self.function.leave.iter();
        let stays = leave.all(|flag| flag.index() < stage.first);
        let is_next = self.users[join.index()].contains(&User::NextState(kept));
        let joins = stage.guard.as_ref().map_or(0, |guard| guard.joins.len());
        let behind = stage.end + joins;
        let read_before = |user: &User| matches!(user, User::Node(index) if *index < behind);
        (stays && is_next && self.users[otherwise.index()].iter().all(read_before)).then_some(kept)
    }

    /// Whether a value is more than the next one of a state word.
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
    let conditions = function
        .stages
        .iter()
        .filter_map(|stage| stage.guard.as_ref())
        .map(|guard| guard.condition);
    for (name, value) in &function.outputs {
        let leg = name.starts_with("leg_");
        users[value.index()].push(if leg { User::Leg } else { User::Other });
    }
    let params = function.next_params.iter().map(|&(_, value)| value);
    for value in conditions
        .chain(params)
        .chain(function.leave.iter().copied())
    {
        users[value.index()].push(User::Other);
    }
    users
}

/// The choices that end in leg states and nowhere else: they are made among `LegState`s, or looked up as such.
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
            User::NextState(_) | User::Other => false,
        };
        if is_choice && users[index].iter().all(becomes_leg) {
            legs.insert(value);
        }
    }
    legs
}

/// The modes and faults: the state words themselves, and all choices that end in them.
fn codes(program: &Program, function: &Function) -> BTreeMap<Value, Shape> {
    let shape = |state: StateId| Shape::of_state(&program.states[state.index()]);
    let read = function.nodes.iter().enumerate();
    let read = read.filter_map(|(index, node)| match node.op {
        Op::State(state) => Some((Value(index as u32), shape(state))),
        _ => None,
    });
    let written = function.next_state.iter();
    let mut open: Vec<(Value, Shape)> = written
        .map(|&(state, value)| (value, shape(state)))
        .chain(read)
        .filter(|&(_, shape)| shape != Shape::Word)
        .collect();
    let mut codes = BTreeMap::new();
    while let Some((value, shape)) = open.pop() {
        match function.node(value).op {
            Op::Select {
                then, otherwise, ..
            } => open.extend([(then, shape), (otherwise, shape)]),
            Op::Join { taken, otherwise } => open.extend([(taken, shape), (otherwise, shape)]),
            Op::State(_) => {}
            _ => continue,
        }
        codes.insert(value, shape);
    }
    codes
}
