//! Bounds on the distance of every value from the ideal computation.
//!
//! The ideal computation starts from the same inputs, state and set-point words, has the exact
//! coefficients, rounds nothing, and takes the same decisions. So a value's error is that of
//! arithmetic alone, and each decision on inexact values has a tie band: it equals the ideal one if
//! the compared values differ by more. Minimum, maximum, clamp and magnitude do not increase the
//! distance of two values, so they are no decisions.
//!
//! A discarded value needs no bound: a value that reaches a result only under a condition is
//! bounded under that condition ([`Bounds::operand`]).

use super::error::{ErrorInterval, Exact, Real};
use super::graph::{Function, Program};
use super::interval::Interval;
use super::op::{Comparison, Kind, Op, Value};

/// A case of a function, with its bounds.
#[derive(Clone, Debug)]
pub struct Case<'p> {
    /// `snake_case` name from the conditions.
    pub name: String,
    /// Whether an inexact decision leaves the normal path, such as a limit.
    pub is_rare: bool,
    /// The conditions, each true or false.
    pub known: Vec<(Value, bool)>,
    /// Bounds of all values.
    pub bounds: Bounds<'p>,
}

/// Error of a quantity against the ideal one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatedError {
    /// `snake_case` name.
    pub name: String,
    /// Documentation of the quantity.
    pub doc: String,
    /// Unit.
    pub unit: String,
    /// Value of one word in that unit.
    pub word: Real,
    /// Errors on the normal path, in words.
    pub normal: ErrorInterval,
    /// Errors off that path after an inexact decision, in words; if there is such a decision.
    pub rare: Option<ErrorInterval>,
}

impl StatedError {
    /// Largest error on the normal path, in the quantity's unit.
    pub fn normal_bound(&self) -> f64 {
        self.normal.magnitude() * self.word.value()
    }

    /// Largest error off that path, in the quantity's unit.
    pub fn rare_bound(&self) -> Option<f64> {
        let rare = self.rare?;
        Some(rare.magnitude() * self.word.value())
    }
}

/// The stated errors of a program's step, the largest of each name.
pub fn stated_errors(program: &Program) -> Vec<StatedError> {
    let mut stated: Vec<StatedError> = vec![];
    for case in cases(program, &program.step) {
        for quantity in &program.step.quantities {
            let error = case.bounds.error(quantity.value);
            let place = stated.iter().position(|known| known.name == quantity.name);
            // The first case is a normal one.
            let place = place.unwrap_or_else(|| {
                stated.push(StatedError {
                    name: quantity.name.clone(),
                    doc: quantity.doc.clone(),
                    unit: quantity.unit.clone(),
                    word: quantity.word,
                    normal: error,
                    rare: None,
                });
                stated.len() - 1
            });
            let known = &mut stated[place];
            if case.is_rare {
                known.rare = Some(known.rare.map_or(error, |rare| rare.union(error)));
            } else {
                known.normal = known.normal.union(error);
            }
        }
    }
    stated
}

/// Bounds a function in exhaustive cases: with and without each rare stage that rounds.
pub fn cases<'p>(program: &'p Program, function: &'p Function) -> Vec<Case<'p>> {
    let all = Bounds::new(program, function);
    let rare = function.stages.iter().filter_map(|stage| {
        let guard = stage.guard.as_ref().filter(|guard| guard.rare)?;
        let mut values = function.values().take(stage.end).skip(stage.first);
        let inexact = values.any(|value| !all.error(value).is_zero());
        inexact.then_some((stage, guard.condition))
    });
    let mut cases = vec![(vec![], vec![], false)];
    for (stage, condition) in rare {
        let decides = all.band(condition).is_some();
        cases = cases
            .into_iter()
            .flat_map(|(known, names, is_rare): (Vec<_>, Vec<&str>, bool)| {
                [false, true].map(|holds| {
                    let (mut known, mut names) = (known.clone(), names.clone());
                    known.push((condition, holds));
                    names.extend(holds.then_some(stage.name.as_str()));
                    (known, names, is_rare || holds && decides)
                })
            })
            .collect();
    }
    let named = cases.into_iter().map(|(known, names, is_rare)| Case {
        name: if names.is_empty() {
            "normal".to_owned()
        } else {
            names.join("_and_")
        },
        is_rare,
        bounds: if known.is_empty() {
            all.clone()
        } else {
            Bounds::where_known(program, function, &known)
        },
        known,
    });
    named.collect()
}

/// Conditions, each true or false; a list, since they are few.
#[derive(Clone, Debug, Default)]
struct Context(Vec<(Value, bool)>);

impl Context {
    fn contains(&self, known: (Value, bool)) -> bool {
        self.0.contains(&known)
    }

    fn insert(&mut self, known: (Value, bool)) {
        if !self.contains(known) {
            self.0.push(known);
        }
    }

    /// Keeps the conditions that the other has, too.
    fn intersect(&mut self, other: &Self) {
        self.0.retain(|&known| other.contains(known));
    }
}

/// Intervals and errors of all values of a function.
#[derive(Clone, Debug)]
pub struct Bounds<'p> {
    program: &'p Program,
    function: &'p Function,
    contexts: Vec<Context>,
    intervals: Vec<Interval>,
    errors: Vec<ErrorInterval>,
}

impl<'p> Bounds<'p> {
    /// Bounds a function of a program in all cases together.
    pub fn new(program: &'p Program, function: &'p Function) -> Self {
        Self::where_known(program, function, &[])
    }

    /// Bounds a function of a program under known conditions.
    pub fn where_known(
        program: &'p Program,
        function: &'p Function,
        known: &[(Value, bool)],
    ) -> Self {
        let nodes = function.nodes.len();
        let mut contexts = contexts(function);
        for context in &mut contexts {
            for &condition in known {
                context.insert(condition);
            }
        }
        let mut bounds = Self {
            program,
            function,
            contexts,
            intervals: Vec::with_capacity(nodes),
            errors: Vec::with_capacity(nodes),
        };
        for index in 0..nodes {
            let interval = bounds.interval_of(index);
            bounds.intervals.push(interval);
            let error = bounds.error_of(index);
            bounds.errors.push(error);
        }
        bounds
    }

    /// The interval of a value whenever a result depends on it.
    pub fn interval(&self, value: Value) -> Interval {
        self.intervals[value.index()]
    }

    /// The error of a value whenever a result depends on it, in units of the last place.
    pub fn error(&self, value: Value) -> ErrorInterval {
        self.errors[value.index()]
    }

    /// The interval of an operand of `user` whenever a result depends on `user`.
    pub fn operand(&self, user: Value, operand: Value) -> Interval {
        self.refined(&self.contexts[user.index()], operand)
    }

    /// The tie band of a decision: the error of the compared values' difference. None for exact
    /// decisions, and for values that are no decisions.
    pub fn band(&self, value: Value) -> Option<ErrorInterval> {
        let band = match self.function.node(value).op {
            Op::Compare(_, a, b) => self.error(a).minus(self.error(b)),
            Op::Exceeds(a, limit) => {
                let [a, limit] = [a, limit].map(|value| self.error(value).magnitude());
                ErrorInterval::symmetric(a + limit)
            }
            Op::AngleIndex { angle, .. } => self.error(angle),
            _ => return None,
        };
        (!band.is_zero()).then_some(band)
    }

    fn refined(&self, context: &Context, value: Value) -> Interval {
        let own = self.intervals[value.index()];
        let mut interval = own;
        for &(condition, holds) in &context.0 {
            self.refine(condition, holds, value, &mut interval);
        }
        // The conditions contradict each other: the place is never reached, and any bound is valid.
        if interval.low > interval.high {
            own
        } else {
            interval
        }
    }

    /// Narrows the interval of a value by a condition.
    fn refine(&self, condition: Value, holds: bool, value: Value, interval: &mut Interval) {
        // Of values computed later only the proven interval is known.
        let known = |value: Value| {
            let refined = self.intervals.get(value.index());
            refined.map_or_else(|| self.function.node(value).interval, |refined| *refined)
        };
        match self.function.node(condition).op {
            Op::Not(inner) => self.refine(inner, !holds, value, interval),
            Op::And(a, b) if holds => {
                self.refine(a, true, value, interval);
                self.refine(b, true, value, interval);
            }
            Op::Or(a, b) if !holds => {
                self.refine(a, false, value, interval);
                self.refine(b, false, value, interval);
            }
            Op::Compare(how, a, b) if a != b => {
                // least + strict <= greatest
                let (least, greatest, strict) = match (how, holds) {
                    (Comparison::Less, true) => (a, b, 1),
                    (Comparison::LessEqual, true) => (a, b, 0),
                    (Comparison::Less, false) => (b, a, 0),
                    (Comparison::LessEqual, false) => (b, a, 1),
                    (Comparison::Equal | Comparison::NotEqual, _) => return,
                };
                if value == least {
                    interval.high = interval.high.min(known(greatest).high - strict);
                } else if value == greatest {
                    interval.low = interval.low.max(known(least).low + strict);
                }
            }
            Op::Exceeds(a, limit) if !holds && a == value => {
                let limit = known(limit).high;
                interval.low = interval.low.max(-limit);
                interval.high = interval.high.min(limit);
            }
            _ => {}
        }
    }

    fn interval_of(&self, index: usize) -> Interval {
        let node = &self.function.nodes[index];
        let proven = node.interval;
        let user = Value(index as u32);
        let found = match node.op {
            Op::Input(_) | Op::Param(_) | Op::State(_) | Op::Constant(_) => None,
            Op::Select {
                condition,
                then,
                otherwise,
            } => {
                let side = |holds: bool| {
                    let mut context = self.contexts[index].clone();
                    context.insert((condition, holds));
                    self.refined(&context, if holds { then } else { otherwise })
                };
                let both = || side(true).union(side(false));
                Some(self.decided(index, condition).map_or_else(both, side))
            }
            Op::Join { taken, otherwise } => {
                let side = |holds: bool| self.operand(user, if holds { taken } else { otherwise });
                self.guard(index)
                    .and_then(|guard| self.decided(index, guard))
                    .map(side)
            }
            op => {
                let operands: Vec<Interval> = op
                    .operands()
                    .iter()
                    .map(|&operand| self.operand(user, operand))
                    .collect();
                op.interval(&operands, |id| self.program.tables[id.index()].interval())
            }
        };
        match found {
            Some(found) => Interval::new(proven.low.max(found.low), proven.high.min(found.high)),
            None => proven,
        }
    }

    /// The condition's outcome whenever a result depends on the value, if it is known.
    fn decided(&self, index: usize, condition: Value) -> Option<bool> {
        let context = &self.contexts[index];
        [true, false]
            .into_iter()
            .find(|&holds| context.contains((condition, holds)))
    }

    /// The guard of a join's stage.
    fn guard(&self, join: usize) -> Option<Value> {
        let join = Value(join as u32);
        let mut guards = self
            .function
            .stages
            .iter()
            .filter_map(|stage| stage.guard.as_ref());
        let guard = guards.find(|guard| guard.joins.contains(&join))?;
        Some(guard.condition)
    }

    /// One of two errors if the condition is known, else both.
    fn chosen(&self, index: usize, condition: Option<Value>, sides: [Value; 2]) -> ErrorInterval {
        let [then, otherwise] = sides.map(|value| self.error(value));
        match condition.and_then(|condition| self.decided(index, condition)) {
            Some(true) => then,
            Some(false) => otherwise,
            None => then.union(otherwise),
        }
    }

    /// The error of a clamped value: at most the distance of the limits.
    fn limited(&self, error: ErrorInterval, user: Value, [low, high]: [Value; 2]) -> ErrorInterval {
        let off = self.error(low).union(self.error(high)).magnitude();
        let span = self.operand(user, high).high - self.operand(user, low).low;
        error.intersection(ErrorInterval::symmetric(span as f64 + off))
    }

    fn error_of(&self, index: usize) -> ErrorInterval {
        let node = &self.function.nodes[index];
        if node.kind == Kind::Flag {
            return ErrorInterval::ZERO;
        }
        let user = Value(index as u32);
        let of = |value: Value| self.errors[value.index()];
        let product = |a: Value, b: Value| {
            ErrorInterval::product(self.operand(user, a), of(a), self.operand(user, b), of(b))
        };
        let shifted = |exact: ErrorInterval, shift: u32| match shift {
            0 => exact,
            _ => exact.shifted_right(shift).plus(ErrorInterval::floor()),
        };
        match node.op {
            Op::Input(_) | Op::Param(_) | Op::State(_) | Op::Literal(_) | Op::AngleIndex { .. } => {
                ErrorInterval::ZERO
            }
            Op::Constant(id) => {
                let constant = &self.program.constants[id.index()];
                ErrorInterval::of(constant.raw, constant.exact)
            }
            Op::Add(a, b) | Op::AngleAdd(a, b) => of(a).plus(of(b)),
            Op::Sub(a, b) | Op::AngleSub(a, b) => of(a).minus(of(b)),
            Op::Neg(a) => of(a).negated(),
            Op::Abs(a) => of(a).magnitudes(),
            Op::Product(a, b) => product(a, b),
            Op::MulRound {
                coefficient,
                signal,
                shift,
            }
            | Op::MulRoundNarrow {
                coefficient,
                signal,
                shift,
            } => {
                let exact = product(coefficient, signal).shifted_right(shift);
                exact.plus(ErrorInterval::nearest())
            }
            Op::MulFloor { a, b, shift } => shifted(product(a, b), shift),
            Op::MulAddFloor {
                first: [a, b],
                second: [c, d],
                shift,
            } => shifted(product(a, b).plus(product(c, d)), shift),
            Op::MulLimited { a, b, limit } => product(a, b).union(of(limit)),
            Op::ShiftLeft(a, n) => of(a).shifted_left(n),
            Op::ShiftRight(a, 0) => of(a),
            Op::ShiftRight(a, n) if self.operand(user, a).low == self.operand(user, a).high => {
                let lost = self.operand(user, a).low.rem_euclid(1 << n);
                let lost = -(lost as f64) / f64::from(n).exp2();
                of(a).shifted_right(n).plus(ErrorInterval::new(lost, lost))
            }
            Op::ShiftRight(a, n) => shifted(of(a), n),
            Op::ShiftRound(a, n) => of(a).shifted_right(n).plus(ErrorInterval::nearest()),
            // A number that is shifted without rounding leaves nothing over.
            Op::Remainder(_, n) => ErrorInterval::new(0.0, f64::from(n).exp2() - 1.0),
            Op::Min(x, high) | Op::Lesser(x, high) => {
                let error = of(x).union(of(high));
                match self.function.node(x).op {
                    // Clamped by one limit after the other.
                    Op::Max(_, low) | Op::Greater(_, low) => self.limited(error, user, [low, high]),
                    _ => error,
                }
            }
            Op::Max(a, b) | Op::Greater(a, b) => of(a).union(of(b)),
            Op::Clamp { x, low, high } => {
                let error = of(x).union(of(low)).union(of(high));
                self.limited(error, user, [low, high])
            }
            Op::Divide {
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
            } => self.quotient(user, [numerator, denominator, limit], shift),
            Op::TurnOver(a) => {
                let least = self.operand(user, a).low as f64;
                let ideal = least - of(a).magnitude();
                if ideal < 1.0 {
                    return ErrorInterval::unbounded();
                }
                // floor((2^32 - 1)/a) against 2^32/a, and the slope of 2^32/a.
                let slope = of(a).quotient(32, least * ideal);
                slope.plus(ErrorInterval::new(-1.0 - 1.0 / least, 0.0))
            }
            Op::Lookup { table, index, .. } => {
                let table = &self.program.tables[table.index()];
                let entry = match table.exact {
                    Exact::Itself | Exact::Number(_) => ErrorInterval::ZERO,
                    Exact::Within(units) => ErrorInterval::symmetric(f64::from(units)),
                };
                match (self.function.node(index).op, table.periodic) {
                    (Op::AngleIndex { angle, .. }, Some(periodic)) => {
                        entry.plus(periodic.error(of(angle)))
                    }
                    _ => entry,
                }
            }
            Op::Select {
                condition,
                then,
                otherwise,
            } => self.chosen(index, Some(condition), [then, otherwise]),
            Op::Join { taken, otherwise } => {
                self.chosen(index, self.guard(index), [taken, otherwise])
            }
            // The effect of the angle's error on its fraction is counted at the lookup.
            Op::AngleFraction { .. }
            | Op::Compare(..)
            | Op::Exceeds(..)
            | Op::And(..)
            | Op::Or(..)
            | Op::Not(_)
            | Op::FlagWord(_) => ErrorInterval::ZERO,
        }
    }

    /// Of min(floor(n 2^s / d), limit): n/d - N/D = (n - N)/D - (n/d)(d - D)/D, or with (n, d) and
    /// (N, D) exchanged; one of the quotients is at most the limit, or both are limited.
    fn quotient(
        &self,
        user: Value,
        [numerator, denominator, limit]: [Value; 3],
        shift: u32,
    ) -> ErrorInterval {
        let [e_n, e_d, e_limit] = [numerator, denominator, limit].map(|value| self.error(value));
        let least = self.operand(user, denominator).low as f64 - e_d.magnitude();
        let limit = self.operand(user, limit).high;
        let most = limit.saturating_add(e_limit.magnitude().ceil() as i64 + 1);
        // Both are between 0 and the limit.
        let widest = ErrorInterval::symmetric(most as f64);
        if least <= 0.0 {
            return widest;
        }
        let error = e_n
            .quotient(shift, least)
            .plus(e_d.times(Interval::new(0, most)).quotient(0, least))
            .plus(ErrorInterval::floor())
            .union(e_limit);
        if error.magnitude() < limit as f64 {
            error
        } else {
            widest
        }
    }
}

/// The conditions under which each value reaches a result.
fn contexts(function: &Function) -> Vec<Context> {
    let mut contexts: Vec<Option<Context>> = vec![None; function.nodes.len()];
    let guards = function
        .stages
        .iter()
        .filter_map(|stage| stage.guard.as_ref());
    let outputs = function.outputs.iter().map(|&(_, value)| value);
    let states = function.next_state.iter().map(|&(_, value)| value);
    let params = function.next_params.iter().map(|&(_, value)| value);
    for root in outputs
        .chain(states)
        .chain(params)
        .chain(guards.clone().map(|guard| guard.condition))
    {
        contexts[root.index()] = Some(Context::default());
    }
    for index in (0..function.nodes.len()).rev() {
        let Some(own) = contexts[index].clone() else {
            continue;
        };
        let mut reach = |value: Value, condition: Option<(Value, bool)>| {
            let mut context = own.clone();
            if let Some(condition) = condition {
                context.insert(condition);
            }
            match &mut contexts[value.index()] {
                Some(known) => known.intersect(&context),
                unknown => *unknown = Some(context),
            }
        };
        match function.nodes[index].op {
            Op::Select {
                condition,
                then,
                otherwise,
            } => {
                reach(condition, None);
                reach(then, Some((condition, true)));
                reach(otherwise, Some((condition, false)));
            }
            Op::Join { taken, otherwise } => {
                let joined = Value(index as u32);
                let guard = guards.clone().find(|guard| guard.joins.contains(&joined));
                let guard = guard.map(|guard| guard.condition);
                reach(taken, guard.map(|condition| (condition, true)));
                reach(otherwise, guard.map(|condition| (condition, false)));
            }
            op => op
                .operands()
                .into_iter()
                .for_each(|operand| reach(operand, None)),
        }
    }
    contexts
        .into_iter()
        .map(Option::unwrap_or_default)
        .collect()
}
