//! Data of the IR: nodes, stages, functions, programs.

use super::error::{ErrorInterval, Exact, Real};
use super::interval::Interval;
use super::op::{Comparison, Kind, Op, ParamId, StateId, Value};
use super::role::{Demand, Output, Setter, Told};

/// A node: operator, interval and name of one value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// Operator and operands.
    pub op: Op,
    /// Word or flag.
    pub kind: Kind,
    /// Proven interval.
    pub interval: Interval,
    /// Stable signal name; empty for a value that is used once, in its stage.
    pub name: String,
}

/// A named constant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constant {
    /// `snake_case` name; empty for one that is written by value.
    pub name: String,
    /// Value.
    pub raw: i32,
    /// The number that it represents.
    pub exact: Exact,
    /// Meaning, physical value with unit and formula, format, quantisation error.
    pub doc: Vec<String>,
}

/// A table of words; the length is a power of two.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// `snake_case` name.
    pub name: String,
    /// Entries.
    pub values: Vec<i32>,
    /// The numbers that they represent.
    pub exact: Exact,
    /// The periodic function whose constant coefficients these are.
    pub periodic: Option<Periodic>,
    /// Name shared by the tables with a common index, which emitters lay out as columns of rows.
    pub row: Option<&'static str>,
    /// Whether the entries are leg states.
    pub holds_legs: bool,
    /// Meaning of the entries.
    pub doc: Vec<String>,
}

/// A periodic function that is approximated segment by segment; the segments meet at their borders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Periodic {
    /// Largest distance of the approximation, words.
    pub misfit: Real,
    /// Steepest slope, words per turn.
    pub slope: Real,
}

impl Periodic {
    /// Error of the approximation at an inexact angle. The approximation is continuous, so it differs from itself at the
    /// exact angle by its slope.
    pub fn error(self, angle: ErrorInterval) -> ErrorInterval {
        let turn = f64::from(32).exp2();
        ErrorInterval::symmetric(
            self.misfit.value() + self.slope.value() * angle.magnitude() / turn,
        )
    }
}

impl Table {
    /// Whether every word of the interval is a valid index.
    pub fn has(&self, index: Interval) -> bool {
        Interval::new(0, self.values.len() as i64 - 1).contains(index)
    }

    /// The entry at an index, taken modulo the length.
    #[inline]
    pub fn entry(&self, index: i64) -> i64 {
        self.values[index as usize & (self.values.len() - 1)].into()
    }

    /// Interval of its entries.
    pub fn interval(&self) -> Interval {
        let words = || self.values.iter().map(|&value| i64::from(value));
        Interval::new(words().min().unwrap_or(0), words().max().unwrap_or(0))
    }
}

/// A persistent word: state or set-point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// `snake_case` name.
    pub name: String,
    /// Value at start.
    pub initial: i32,
    /// Its interval.
    pub interval: Interval,
    /// Storage bits: 32, or 16 for a number that is never negative. A signed halfword is slower to
    /// load than a word if only the unsigned load has an offset (ARMv6-M).
    pub storage_bits: u32,
    /// Meaning and format.
    pub doc: String,
}

/// An input word of a function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// `snake_case` name.
    pub name: String,
    /// Its interval.
    pub interval: Interval,
    /// Meaning.
    pub doc: String,
}

/// Condition and joins of a guarded stage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Guard {
    /// Flag defined before the stage: the stage runs only if it holds.
    pub condition: Value,
    /// The joins, right after the stage's nodes: the only way out for its values.
    pub joins: Vec<Value>,
    /// Whether the stage is off the normal path, for code placement and operation counts.
    pub rare: bool,
}

/// A named group of consecutive nodes: one function of the emitted code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stage {
    /// `snake_case` name, a verb phrase.
    pub name: String,
    /// Documentation, with the source of the equation.
    pub doc: Vec<String>,
    /// First node.
    pub first: usize,
    /// One past the last node (without joins).
    pub end: usize,
    /// Its guard, if it runs under a condition.
    pub guard: Option<Guard>,
}

/// A straight-line function over words: nodes in order, partitioned into stages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// `snake_case` name.
    pub name: String,
    /// Meaning.
    pub doc: Vec<String>,
    /// Input words.
    pub inputs: Vec<Input>,
    /// Nodes, each defined before it is used.
    pub nodes: Vec<Node>,
    /// Stages, in order; they and their joins cover all nodes.
    pub stages: Vec<Stage>,
    /// Results, in order.
    pub outputs: Vec<(Output, Value)>,
    /// Observations.
    pub told: Vec<(Told, Value)>,
    /// New state words.
    pub next_state: Vec<(StateId, Value)>,
    /// New set-point words.
    pub next_params: Vec<(ParamId, Value)>,
    /// Quantities whose error is stated.
    pub quantities: Vec<Quantity>,
    /// Number of the first nodes that are tracking, which runs in periods without control, too. All
    /// nodes of a setter.
    pub tracking: usize,
}

/// A physical quantity with a stated error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// `snake_case` name; values of the same name share the largest error.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// Unit.
    pub unit: String,
    /// Value of one word in that unit.
    pub word: Real,
    /// The value.
    pub value: Value,
}

/// New value of a state word in a period without control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtRest {
    /// A value of the tracking.
    Tracked(Value),
    /// 0: past commands and estimates are cleared.
    Forgotten,
}

impl Function {
    /// The value of an output, if it exists.
    pub fn output(&self, sought: Output) -> Option<Value> {
        let mut outputs = self.outputs.iter();
        let found = outputs.find(|(output, _)| *output == sought);
        found.map(|&(_, value)| value)
    }

    /// The value of an observation, if it exists.
    pub fn told(&self, sought: Told) -> Option<Value> {
        let mut told = self.told.iter();
        let found = told.find(|(told, _)| *told == sought);
        found.map(|&(_, value)| value)
    }

    /// Whether a value belongs to the tracking.
    pub fn is_tracking(&self, value: Value) -> bool {
        value.index() < self.tracking
    }

    /// New value in a period without control of the state word whose controlled new value is
    /// `value`.
    pub fn at_rest(&self, value: Value) -> AtRest {
        if self.is_tracking(value) {
            AtRest::Tracked(value)
        } else {
            AtRest::Forgotten
        }
    }

    /// Replaces every reference to a value, operands excepted.
    pub(super) fn map_values(&mut self, f: impl Fn(Value) -> Value) {
        let guards = self
            .stages
            .iter_mut()
            .filter_map(|stage| stage.guard.as_mut());
        for guard in guards {
            guard.condition = f(guard.condition);
            guard.joins.iter_mut().for_each(|join| *join = f(*join));
        }
        let outputs = self.outputs.iter_mut().map(|(_, value)| value);
        let told = self.told.iter_mut().map(|(_, value)| value);
        let states = self.next_state.iter_mut().map(|(_, value)| value);
        let params = self.next_params.iter_mut().map(|(_, value)| value);
        let quantities = self
            .quantities
            .iter_mut()
            .map(|quantity| &mut quantity.value);
        for value in outputs
            .chain(told)
            .chain(states)
            .chain(params)
            .chain(quantities)
        {
            *value = f(*value);
        }
    }

    /// All values, in order.
    pub fn values(&self) -> impl Iterator<Item = Value> + use<> {
        (0..self.nodes.len() as u32).map(Value)
    }

    /// The node that defines `value`.
    pub fn node(&self, value: Value) -> &Node {
        &self.nodes[value.index()]
    }

    /// The interval of `value` if the flag `condition` does not hold.
    ///
    /// Besides the value's own interval it uses the spread rule: for three numbers that sum to
    /// zero, `c = -(a + b)`, and `spread = max - min` of the three, "not (limit < spread)" bounds
    /// each of them by 2/3 limit (max and min are at most `limit` apart, and two of the three share
    /// a sign), max + min, which is minus the middle one, by 1/3 limit, and each less floor((max +
    /// min)/2), perhaps plus a constant, by 1/2 limit: the largest is ceil(spread/2) above it and
    /// the smallest floor(spread/2) below. Each less max is in [-limit, 0], each less
    /// min in [0, limit]; of the least of two such lifts each leg has the least of both.
    pub fn interval_where_not(&self, condition: Value, value: Value) -> Interval {
        let own = self.node(value).interval;
        let Some((limit, legs, high, low)) = self.spread_condition(condition) else {
            return own;
        };
        let limit = self.node(limit).interval.high.max(0);
        let bound = if legs.contains(&value) {
            Interval::symmetric(limit * 2 / 3)
        } else if self.is_half_sum(value, high, low) {
            Interval::symmetric(limit / 6 + 1)
        } else if let Some(bound) = self.lifted_leg(value, limit, legs, [high, low]) {
            bound
        } else {
            return own;
        };
        Interval::new(own.low.max(bound.low), own.high.min(bound.high))
    }

    /// Interval of a leg `leg - middle` or `leg + lift`.
    fn lifted_leg(
        &self,
        value: Value,
        limit: i64,
        legs: [Value; 3],
        extremes: [Value; 2],
    ) -> Option<Interval> {
        match self.node(value).op {
            Op::Sub(leg, middle) if legs.contains(&leg) => self.above(middle, limit, extremes),
            Op::Add(leg, lift) if legs.contains(&leg) => self.lifted(lift, limit, extremes),
            _ => None,
        }
    }

    /// Interval of any leg plus `lift`: a number less middle, max or min of the legs, or the least of two such.
    fn lifted(&self, lift: Value, limit: i64, extremes: [Value; 2]) -> Option<Interval> {
        match self.node(lift).op {
            Op::Sub(number, origin) => {
                let Interval { low, high } = self.node(number).interval;
                let above = self.above(origin, limit, extremes)?;
                (low == high).then(|| Interval::new(above.low + low, above.high + low))
            }
            Op::Min(one, other) | Op::Lesser(one, other) => {
                let [one, other] = [one, other].map(|lift| self.lifted(lift, limit, extremes));
                Some(one?.corners(other?, i64::min))
            }
            _ => None,
        }
    }

    /// Interval of any leg less `origin`: middle, max or min of the legs.
    fn above(&self, origin: Value, limit: i64, [high, low]: [Value; 2]) -> Option<Interval> {
        if self.is_half_sum(origin, high, low) {
            Some(Interval::symmetric((limit + 1) / 2))
        } else if origin == high {
            Some(Interval::new(-limit, 0))
        } else if origin == low {
            Some(Interval::new(0, limit))
        } else {
            None
        }
    }

    /// Matches `limit < max(a, b, c) - min(a, b, c)` with c = -(a + b): limit, legs, max, min.
    fn spread_condition(&self, condition: Value) -> Option<(Value, [Value; 3], Value, Value)> {
        let Op::Compare(Comparison::Less, limit, spread) = self.node(condition).op else {
            return None;
        };
        let Op::Sub(high, low) = self.node(spread).op else {
            return None;
        };
        let greater = |value: Value| match self.node(value).op {
            Op::Max(a, b) | Op::Greater(a, b) => Some((a, b)),
            _ => None,
        };
        let lesser = |value: Value| match self.node(value).op {
            Op::Min(a, b) | Op::Lesser(a, b) => Some((a, b)),
            _ => None,
        };
        let (high_pair, c) = greater(high)?;
        let (a, b) = greater(high_pair)?;
        let (low_pair, low_c) = lesser(low)?;
        let Op::Neg(sum) = self.node(c).op else {
            return None;
        };
        let same =
            lesser(low_pair) == Some((a, b)) && low_c == c && self.node(sum).op == Op::Add(a, b);
        same.then_some((limit, [a, b, c], high, low))
    }

    fn is_half_sum(&self, value: Value, high: Value, low: Value) -> bool {
        match self.node(value).op {
            Op::ShiftRight(sum, 1) => self.node(sum).op == Op::Add(high, low),
            _ => false,
        }
    }
}

/// One controller: the step, the setters, and their shared constants, tables and words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// Name of the controller type.
    pub name: String,
    /// Named constants.
    pub constants: Vec<Constant>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Set-point words.
    pub params: Vec<(Demand, Word)>,
    /// State words.
    pub states: Vec<Word>,
    /// The control step: reads params, reads and writes state.
    pub step: Function,
    /// Functions outside the step: each reads inputs and writes some params.
    pub setters: Vec<(Setter, Function)>,
}

impl Program {
    /// The place of a set-point word, if it exists.
    pub fn place_of(&self, sought: Demand) -> Option<usize> {
        let mut params = self.params.iter();
        params.position(|(demand, _)| *demand == sought)
    }

    /// A set-point word, if it exists.
    pub fn param(&self, sought: Demand) -> Option<&Word> {
        self.place_of(sought).map(|place| &self.params[place].1)
    }

    /// Whether the step's command has intervals with legs of their own.
    pub fn has_intervals(&self) -> bool {
        self.step.output(Output::End(0)).is_some()
    }

    /// All persistent words: state, then set-point.
    pub fn words(&self) -> impl Iterator<Item = &Word> {
        // Whether the bus is fresh the runtime computes; nothing keeps it.
        let kept = self.params.iter();
        let kept = kept.filter(|(demand, _)| *demand != Demand::BusIsFresh);
        self.states.iter().chain(kept.map(|(_, word)| word))
    }

    /// The step and the setters.
    pub fn functions(&self) -> impl Iterator<Item = &Function> {
        let setters = self.setters.iter().map(|(_, function)| function);
        std::iter::once(&self.step).chain(setters)
    }
}
