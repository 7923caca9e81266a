//! Goals that a controller's scripts must state, counted from its graph, so that none is forgotten.

use hexagen_codegen::emit::gappa::{Script, Subject, gap, variable};
use hexagen_codegen::ir::{
    Case, Exact, Function, Interval, Op, Program, Real, Stage, Value, VerifiedGraph, cases,
};
use std::collections::HashMap;

/// The goals of an operator's result.
enum Duty {
    /// That it stays in its interval, and how far it is from the ideal where something relies on
    /// that.
    Arithmetic,
    /// How far a quotient is from the ideal one: by that of the code, and by the ideal one.
    Quotient,
    /// How far what a decision compares is from the ideal.
    Decision,
    /// Nothing: its result is a word as it stands, one of its operands, or no further from the
    /// ideal than they are.
    None,
}

fn duty(op: Op) -> Duty {
    match op {
        Op::Add(..)
        | Op::Sub(..)
        | Op::Neg(_)
        | Op::Product(..)
        | Op::MulRound { .. }
        | Op::MulRoundNarrow { .. }
        | Op::MulFloor { .. }
        | Op::MulAddFloor { .. }
        | Op::ShiftLeft(..)
        | Op::ShiftRight(..)
        | Op::ShiftRound(..) => Duty::Arithmetic,
        Op::Divide { .. } | Op::DivideNarrow { .. } => Duty::Quotient,
        Op::Compare(..) | Op::Exceeds(..) => Duty::Decision,
        Op::Input(_)
        | Op::Param(_)
        | Op::State(_)
        | Op::Constant(_)
        | Op::Literal(_)
        | Op::Abs(_)
        | Op::MulLimited { .. }
        | Op::Remainder(..)
        | Op::Min(..)
        | Op::Max(..)
        | Op::Lesser(..)
        | Op::Greater(..)
        | Op::Clamp { .. }
        | Op::TurnOver(_)
        | Op::AngleAdd(..)
        | Op::AngleSub(..)
        | Op::AngleIndex { .. }
        | Op::AngleFraction { .. }
        | Op::Lookup { .. }
        | Op::And(..)
        | Op::Or(..)
        | Op::Not(_)
        | Op::FlagWord(_)
        | Op::Select { .. }
        | Op::Join { .. } => Duty::None,
    }
}

/// The goals of a controller's graph that no script states: of every stage in every case in
/// which it runs, the interval of every sum, product and shift, the error of what leaves the
/// stage's arithmetic, and the tie band of every inexact decision.
pub fn missing_goals(graph: &VerifiedGraph, scripts: &[Script]) -> Vec<String> {
    let program = graph.program();
    let stated = Stated::of(scripts);
    let mut missing = vec![];
    for function in program.functions() {
        for case in cases(program, function) {
            let twins = Twins::of(program, function, &case);
            for stage in &function.stages {
                let guard = stage.guard.as_ref();
                if guard.is_some_and(|guard| case.known.contains(&(guard.condition, false))) {
                    continue;
                }
                let part = Part {
                    function,
                    case: &case,
                    stage,
                    twins: &twins,
                };
                missing.extend(part.missing(&stated));
            }
        }
    }
    missing
}

/// How often scripts state a bound: by function, stage and case, by the expression, and by its
/// bounds.
struct Stated(HashMap<(String, String, Subject, [Real; 2]), usize>);

impl Stated {
    fn of(scripts: &[Script]) -> Self {
        let mut stated = HashMap::new();
        for script in scripts {
            for name in script.also.iter().chain([&script.name]) {
                let place: Vec<&str> = name.splitn(4, '.').take(3).collect();
                for goal in &script.goals {
                    let bounds = [goal.low, goal.high];
                    let key = (
                        place.join("."),
                        goal.expression.clone(),
                        goal.subject,
                        bounds,
                    );
                    *stated.entry(key).or_default() += 1;
                }
            }
        }
        Self(stated)
    }
}

/// The first of the values that are computed alike in one script, which knows the same expression
/// by one name only.
struct Twins(Vec<Value>);

impl Twins {
    fn of(program: &Program, function: &Function, case: &Case<'_>) -> Self {
        let bounds = &case.bounds;
        let parts = parts(function, case);
        let mut firsts: HashMap<String, Value> = HashMap::new();
        let mut twins: Vec<Value> = vec![];
        for value in function.values() {
            let mut op = function.node(value).op;
            let operands = op.operands().into_iter();
            let seen: Vec<Interval> = operands.map(|x| bounds.operand(value, x)).collect();
            op.map_operands(|operand| twins[operand.index()]);
            // Equal numbers are one expression.
            let number = |raw: i32, exact: Exact| format!("{raw} {exact:?}");
            let key = match (op, duty(op)) {
                (Op::Literal(raw), _) => number(raw, Exact::Itself),
                (Op::Constant(id), _) => {
                    let constant = &program.constants[id.index()];
                    match constant.exact {
                        Exact::Within(_) => format!("{value:?}"),
                        exact => number(constant.raw, exact),
                    }
                }
                (_, Duty::Arithmetic) => {
                    let known = (bounds.interval(value), bounds.error(value));
                    format!("{op:?} {seen:?} {known:?} {:?}", parts[value.index()])
                }
                _ => format!("{value:?}"),
            };
            twins.push(*firsts.entry(key).or_insert(value));
        }
        Self(twins)
    }
}

/// The script that each value is in, by the first of its values: those of a stage that stand in
/// each other's definitions.
fn parts(function: &Function, case: &Case<'_>) -> Vec<Value> {
    let mut parts: Vec<Value> = function.values().collect();
    for stage in &function.stages {
        for user in function.values().take(stage.end).skip(stage.first) {
            let op = function.node(user).op;
            if matches!(duty(op), Duty::Arithmetic) || case.bounds.band(user).is_some() {
                for operand in op.operands() {
                    let is_defined = (stage.first..stage.end).contains(&operand.index())
                        && matches!(duty(function.node(operand).op), Duty::Arithmetic)
                        && case.bounds.operand(user, operand) == case.bounds.interval(operand);
                    if is_defined {
                        let [one, other] = [operand, user].map(|value| parts[value.index()]);
                        let joined = one.min(other);
                        let members = parts.iter_mut().filter(|part| [one, other].contains(part));
                        members.for_each(|part| *part = joined);
                    }
                }
            }
        }
    }
    parts
}

/// A stage in a case.
struct Part<'a> {
    function: &'a Function,
    case: &'a Case<'a>,
    stage: &'a Stage,
    twins: &'a Twins,
}

impl Part<'_> {
    fn missing(&self, stated: &Stated) -> Vec<String> {
        let bounds = &self.case.bounds;
        let place = [&self.function.name, &self.stage.name, &self.case.name].map(String::as_str);
        let place = place.join(".");
        let mut missing = vec![];
        let mut want = |what: &str, expression: String, subject, [low, high]: [Real; 2], times| {
            let key = (place.clone(), expression, subject, [low, high]);
            if stated.0.get(&key).copied().unwrap_or(0) < times {
                let expression = key.1;
                missing.push(format!(
                    "{place}: no goal for the {what}, {expression} in [{low},{high}]"
                ));
            }
        };
        let values = self.function.values().take(self.stage.end);
        for value in values.skip(self.stage.first) {
            let error = bounds.error(value);
            let errors = [error.low(), error.high()];
            let name = variable(self.function, self.twins.0[value.index()]);
            match duty(self.function.node(value).op) {
                Duty::Arithmetic => {
                    let Interval { low, high } = bounds.interval(value);
                    let ends = [low, high].map(|end| Real::of(end as f64));
                    want("value", name.clone(), Subject::Value, ends, 1);
                    let is_known = error.is_zero() || error.is_unbounded();
                    if !is_known && self.is_relied_on(value) {
                        let distance = format!("{name} - M{name}");
                        want("error", distance, Subject::Error, errors, 1);
                    }
                }
                Duty::Quotient => {
                    let limit = self.function.node(value).op.operands()[2];
                    // What is bounded by the limit alone needs no proof.
                    let widest = bounds.operand(value, limit).high as f64;
                    if !error.is_zero() && error.magnitude() < widest {
                        let distance = format!("{name} - M{name}_exact");
                        want("error", distance, Subject::Error, errors, 2);
                    }
                }
                Duty::Decision => {
                    let band = bounds.band(value).filter(|band| !band.is_unbounded());
                    if let Some(band) = band {
                        let gap = gap(value);
                        let ends = [band.low(), band.high()];
                        want(
                            "tie band",
                            format!("{gap} - M{gap}"),
                            Subject::TieBand,
                            ends,
                            1,
                        );
                    }
                }
                Duty::None => {}
            }
        }
        missing
    }

    /// Whether a value's error is stated, or taken for granted by what is no arithmetic of this
    /// stage on all that the value can be.
    fn is_relied_on(&self, value: Value) -> bool {
        let function = self.function;
        let outputs = function.outputs.iter().map(|&(_, result)| result);
        let states = function.next_state.iter().map(|&(_, result)| result);
        let params = function.next_params.iter().map(|&(_, result)| result);
        let quantities = function.quantities.iter().map(|quantity| quantity.value);
        let mut results = outputs.chain(states).chain(params).chain(quantities);
        let bounds = &self.case.bounds;
        let continues = |user: Value| {
            let inside = (self.stage.first..self.stage.end).contains(&user.index());
            let is_arithmetic = matches!(duty(function.node(user).op), Duty::Arithmetic);
            inside && is_arithmetic && bounds.operand(user, value) == bounds.interval(value)
        };
        results.any(|result| result == value)
            || function
                .values()
                .any(|user| function.node(user).op.operands().contains(&value) && !continues(user))
    }
}
