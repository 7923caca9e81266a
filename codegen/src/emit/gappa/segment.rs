//! One stage in one case as Gappa scripts.

use std::collections::{BTreeMap, BTreeSet};

use super::{Goal, Script, Subject, gap, variable};
use crate::ir::{
    Bounds, Case, ErrorInterval, Exact, Function, Interval, Op, Program, Stage, Value,
};

/// The scripts of the stages of a function that run in a case.
pub(super) fn segments(program: &Program, function: &Function, case: &Case) -> Vec<Script> {
    let mut scripts = vec![];
    for stage in &function.stages {
        let idle = stage
            .guard
            .as_ref()
            .is_some_and(|guard| case.known.contains(&(guard.condition, false)));
        if idle {
            continue;
        }
        let name = format!("{}.{}.{}", function.name, stage.name, case.name);
        let segment = Segment::new(program, function, case, stage);
        scripts.extend(segment.divisions(&name));
        let parts = segment.parts();
        let leaving = segment.leaving();
        for values in parts {
            let segment = Segment::new(program, function, case, stage);
            scripts.extend(segment.script(&name, &values, &leaving));
        }
    }
    scripts
}

/// Expressions of a value: that of the code and the ideal one.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Pair {
    code: String,
    ideal: String,
}

impl Pair {
    fn error(&self) -> String {
        format!("{} - {}", self.code, self.ideal)
    }
}

struct Segment<'a> {
    program: &'a Program,
    function: &'a Function,
    bounds: &'a Bounds<'a>,
    stage: &'a Stage,
    definitions: Vec<String>,
    hypotheses: Vec<String>,
    goals: Vec<Goal>,
    /// Variables with hypotheses, by name.
    declared: BTreeSet<String>,
    /// Names of defined values.
    defined: BTreeMap<Value, Pair>,
    /// Values by definition: the checker accepts one name per expression.
    definers: BTreeMap<[String; 2], Value>,
}

/// Whether scripts define the operator; all others cut.
fn is_arithmetic(op: Op) -> bool {
    matches!(
        op,
        Op::Add(..)
            | Op::Sub(..)
            | Op::Neg(_)
            | Op::Product(..)
            | Op::MulRound { .. }
            | Op::MulRoundNarrow { .. }
            | Op::ShiftRound(..)
            | Op::MulFloor { .. }
            | Op::MulAddFloor { .. }
            | Op::ShiftLeft(..)
            | Op::ShiftRight(..)
    )
}

impl<'a> Segment<'a> {
    fn new(
        program: &'a Program,
        function: &'a Function,
        case: &'a Case<'a>,
        stage: &'a Stage,
    ) -> Self {
        Self {
            program,
            function,
            bounds: &case.bounds,
            stage,
            definitions: vec![],
            hypotheses: vec![],
            goals: vec![],
            declared: BTreeSet::new(),
            defined: BTreeMap::new(),
            definers: BTreeMap::new(),
        }
    }

    fn values(&self) -> impl Iterator<Item = Value> + use<> {
        let count = self.stage.end - self.stage.first;
        self.function.values().skip(self.stage.first).take(count)
    }

    /// The values of the stage that scripts define or compare, in parts that share no definition.
    fn parts(&self) -> Vec<Vec<Value>> {
        let mut parts: Vec<Vec<Value>> = vec![];
        for value in self.values() {
            let op = self.function.node(value).op;
            let compares = matches!(op, Op::Compare(..) | Op::Exceeds(..))
                && self.bounds.band(value).is_some();
            if !is_arithmetic(op) && !compares {
                continue;
            }
            let operands = op.operands();
            let mut part = vec![];
            parts.retain_mut(|other| {
                let joins = operands
                    .iter()
                    .any(|&operand| other.contains(&operand) && self.is_same(value, operand));
                if joins {
                    part.append(other);
                }
                !joins
            });
            part.push(value);
            part.sort_unstable();
            parts.push(part);
        }
        parts
    }

    /// Whether an operand's bounds at its use are those of its definition.
    fn is_same(&self, user: Value, operand: Value) -> bool {
        self.bounds.operand(user, operand) == self.bounds.interval(operand)
    }

    /// The script of sums, products, shifts and decisions.
    fn script(mut self, name: &str, values: &[Value], leaving: &BTreeSet<Value>) -> Option<Script> {
        for &value in values {
            let op = self.function.node(value).op;
            if is_arithmetic(op) {
                self.define(value, op);
                let pair = self.defined[&value].clone();
                self.claim(Goal::value(&pair.code, self.bounds.interval(value)));
                let error = self.bounds.error(value);
                if leaving.contains(&value) && !error.is_zero() && !error.is_unbounded() {
                    self.claim(Goal::error(pair.error(), Subject::Error, error));
                }
            }
            // The band of a magnitude above a limit has both signs.
            if let (Op::Compare(_, a, b) | Op::Exceeds(a, b), Some(band)) =
                (op, self.bounds.band(value))
            {
                self.compare(value, [a, b], band);
            }
        }
        let last = values
            .last()
            .map(|&value| self.name(value))
            .unwrap_or_default();
        (!self.goals.is_empty()).then_some(Script {
            name: format!("{name}.{last}"),
            also: vec![],
            definitions: self.definitions,
            hypotheses: self.hypotheses,
            hints: vec![],
            goals: self.goals,
        })
    }

    /// Adds a goal, once.
    fn claim(&mut self, goal: Goal) {
        if !self.goals.contains(&goal) {
            self.goals.push(goal);
        }
    }

    /// Values of the stage whose error is used outside of its definitions.
    fn leaving(&self) -> BTreeSet<Value> {
        let function = self.function;
        let range = self.stage.first..self.stage.end;
        let mut leaving: BTreeSet<Value> = BTreeSet::new();
        for user in function.values() {
            let op = function.node(user).op;
            let inside = range.contains(&user.index()) && is_arithmetic(op);
            for operand in op.operands() {
                if !(inside && self.is_same(user, operand)) {
                    leaving.insert(operand);
                }
            }
        }
        leaving.extend(function.outputs.iter().map(|&(_, value)| value));
        leaving.extend(function.next_state.iter().map(|&(_, value)| value));
        leaving.extend(function.next_params.iter().map(|&(_, value)| value));
        leaving.extend(function.quantities.iter().map(|quantity| quantity.value));
        leaving
    }

    fn define(&mut self, value: Value, op: Op) {
        let pairs: Vec<Pair> = op
            .operands()
            .iter()
            .map(|&operand| self.operand(value, operand))
            .collect();
        let binary = |sign: &str| {
            let side =
                |of: fn(&Pair) -> &String| format!("{} {sign} {}", of(&pairs[0]), of(&pairs[1]));
            [side(|pair| &pair.code), side(|pair| &pair.ideal)]
        };
        let scaled = |shift: u32| binary("*").map(|text| format!("{text} * 1b-{shift}"));
        let [code, ideal] = match op {
            Op::Add(..) => binary("+"),
            Op::Sub(..) => binary("-"),
            Op::Product(..) | Op::MulFloor { shift: 0, .. } => binary("*"),
            Op::Neg(_) => [&pairs[0].code, &pairs[0].ideal].map(|text| format!("-{text}")),
            Op::ShiftLeft(_, n) => {
                [&pairs[0].code, &pairs[0].ideal].map(|text| format!("{text} * 1b{n}"))
            }
            Op::ShiftRight(_, 0) => [pairs[0].code.clone(), pairs[0].ideal.clone()],
            Op::ShiftRight(_, n) => {
                let [code, ideal] =
                    [&pairs[0].code, &pairs[0].ideal].map(|text| format!("{text} * 1b-{n}"));
                [format!("floor({code})"), ideal]
            }
            Op::MulFloor { shift, .. } => {
                let [code, ideal] = scaled(shift);
                [format!("floor({code})"), ideal]
            }
            Op::MulAddFloor { shift, .. } => {
                let side = |of: fn(&Pair) -> &String| {
                    let [a, b, c, d] = [0, 1, 2, 3].map(|place| of(&pairs[place]));
                    format!("({a} * {b} + {c} * {d}) * 1b-{shift}")
                };
                let [code, ideal] = [side(|pair| &pair.code), side(|pair| &pair.ideal)];
                match shift {
                    0 => [code, ideal],
                    _ => [format!("floor({code})"), ideal],
                }
            }
            Op::ShiftRound(_, n) => {
                let [code, ideal] =
                    [&pairs[0].code, &pairs[0].ideal].map(|text| format!("{text} * 1b-{n}"));
                [format!("nearest({code})"), ideal]
            }
            Op::MulRound { shift, .. } | Op::MulRoundNarrow { shift, .. } => {
                let [code, ideal] = scaled(shift);
                [format!("nearest({code})"), ideal]
            }
            _ => return,
        };
        let definition = [code, ideal];
        if let Some(&same) = self.definers.get(&definition)
            && self.bounds.interval(same) == self.bounds.interval(value)
            && self.bounds.error(same) == self.bounds.error(value)
        {
            self.defined.insert(value, self.defined[&same].clone());
            return;
        }
        self.definers.insert(definition.clone(), value);
        let [code, ideal] = definition;
        let name = self.name(value);
        let pair = if self.bounds.error(value).is_zero() {
            Pair {
                code: name.clone(),
                ideal: name.clone(),
            }
        } else {
            let ideal_name = format!("M{name}");
            self.definitions.push(format!("{ideal_name} = {ideal}"));
            Pair {
                code: name.clone(),
                ideal: ideal_name,
            }
        };
        self.definitions.push(format!("{name} = {code}"));
        self.defined.insert(value, pair);
    }

    /// The difference of a decision.
    fn compare(&mut self, value: Value, [a, b]: [Value; 2], band: ErrorInterval) {
        if band.is_unbounded() {
            return;
        }
        let [a, b] = [a, b].map(|operand| self.operand(value, operand));
        let name = gap(value);
        self.definitions
            .push(format!("{name} = {} - {}", a.code, b.code));
        self.definitions
            .push(format!("M{name} = {} - {}", a.ideal, b.ideal));
        let difference = format!("{name} - M{name}");
        self.goals
            .push(Goal::error(difference, Subject::TieBand, band));
    }

    fn name(&self, value: Value) -> String {
        variable(self.function, value)
    }

    /// An operand: a number, a defined value, or a variable.
    fn operand(&mut self, user: Value, value: Value) -> Pair {
        let interval = self.bounds.operand(user, value);
        let error = self.bounds.error(value);
        match self.function.node(value).op {
            Op::Literal(number) => {
                return Pair {
                    code: number.to_string(),
                    ideal: number.to_string(),
                };
            }
            Op::Constant(id) => {
                let constant = &self.program.constants[id.index()];
                let code = constant.raw.to_string();
                match constant.exact {
                    Exact::Itself => {
                        return Pair {
                            ideal: code.clone(),
                            code,
                        };
                    }
                    Exact::Number(number) => {
                        return Pair {
                            code,
                            ideal: number.to_string(),
                        };
                    }
                    Exact::Within(_) => {}
                }
            }
            _ => {}
        }
        if self.is_same(user, value)
            && let Some(pair) = self.defined.get(&value)
        {
            return pair.clone();
        }
        let mut name = self.name(value);
        if self.defined.contains_key(&value) {
            // The bounds at the use are closer than those at the definition.
            name = format!("{name}_at_{}", user.index());
        }
        self.variable(name, interval, error)
    }

    /// A variable with its hypotheses.
    fn variable(&mut self, name: String, interval: Interval, error: ErrorInterval) -> Pair {
        let ideal = if error.is_zero() {
            name.clone()
        } else {
            format!("M{name}")
        };
        let pair = Pair { code: name, ideal };
        if self.declared.insert(format!("{} {interval}", pair.code)) {
            let name = &pair.code;
            self.hypotheses.push(format!("@FIX({name},0)"));
            self.hypotheses
                .push(format!("{name} in [{},{}]", interval.low, interval.high));
            if !error.is_zero() && !error.is_unbounded() {
                self.hypotheses.push(format!("{} in {error}", pair.error()));
            }
        }
        pair
    }

    /// Two scripts for each quotient: with the code's quotient within the limit, and with the ideal
    /// one within it. If both exceed it, both are the limit.
    fn divisions(&self, stage: &str) -> Vec<Script> {
        let mut scripts = vec![];
        for value in self.values() {
            let (Op::Divide {
                numerator,
                shift,
                denominator,
                limit,
            }
            | Op::DivideNarrow {
                numerator,
                shift,
                denominator,
                limit,
            }) = self.function.node(value).op
            else {
                continue;
            };
            let error = self.bounds.error(value);
            let limit_high = self.bounds.operand(value, limit).high;
            // A bound by the limit alone needs no proof.
            if error.is_zero() || error.magnitude() >= limit_high as f64 {
                continue;
            }
            for of_code in [true, false] {
                let mut part = Segment {
                    definitions: vec![],
                    hypotheses: vec![],
                    goals: vec![],
                    declared: BTreeSet::new(),
                    defined: BTreeMap::new(),
                    definers: BTreeMap::new(),
                    ..*self
                };
                let [n, d] = [numerator, denominator].map(|operand| part.operand(value, operand));
                let name = self.name(value);
                let sides = [("", &n.code, &d.code), ("M", &n.ideal, &d.ideal)];
                for (prefix, n, d) in sides {
                    part.definitions
                        .push(format!("{prefix}{name}_exact = {n} * 1b{shift} / {d}"));
                }
                part.definitions
                    .push(format!("{name} = floor({name}_exact)"));
                let most = limit_high + 1;
                let (known, over) = if of_code {
                    ("", &d.ideal)
                } else {
                    ("M", &d.code)
                };
                part.hypotheses
                    .push(format!("{known}{name}_exact in [0,{most}]"));
                let hint = format!(
                    "{name}_exact - M{name}_exact -> ({}) * 1b{shift} / {over} - {known}{name}_exact * (({}) / {over}) {{ {} <> 0, {} <> 0 }}",
                    n.error(),
                    d.error(),
                    d.code,
                    d.ideal,
                );
                let goal = Goal::error(format!("{name} - M{name}_exact"), Subject::Error, error);
                scripts.push(Script {
                    name: format!("{stage}.{name}.{}", if of_code { "code" } else { "ideal" }),
                    also: vec![],
                    definitions: part.definitions,
                    hypotheses: part.hypotheses,
                    hints: vec![hint],
                    goals: vec![goal],
                });
            }
        }
        scripts
    }
}
