//! The data of the IR and the meaning of every operator.
//!
//! Every value is a 32-bit two's complement word or a flag. [`Op::apply`] is the one definition of
//! what operators compute; [`Op::interval`] is its extension to intervals. All integers are exact:
//! an operator whose result leaves the 32-bit word is an error of the program, except for the
//! angle operators, which wrap by definition.

use std::fmt;

use super::error::{ErrorInterval, Exact, Real};

/// A value of a function: index of the node that defines it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Value(pub(crate) u32);

impl Value {
    /// Position of the defining node in its function.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Index of a named constant of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ConstantId(pub(crate) u32);

/// Index of a table of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TableId(pub(crate) u32);

/// Index of a set-point word of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ParamId(pub(crate) u32);

/// Index of a state word of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StateId(pub(crate) u32);

macro_rules! position {
    ($($id:ident),*) => {$(
        impl $id {
            /// Position in the program's list.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}
position!(ConstantId, TableId, ParamId, StateId);

/// What a value can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A 32-bit signed word.
    Word,
    /// True or false.
    Flag,
}

/// A closed integer interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interval {
    /// Least value.
    pub low: i64,
    /// Greatest value.
    pub high: i64,
}

impl Interval {
    /// The interval of all 32-bit words.
    pub const WORD: Self = Self {
        low: i32::MIN as i64,
        high: i32::MAX as i64,
    };
    /// False and true.
    pub const FLAG: Self = Self { low: 0, high: 1 };

    /// `low..=high`.
    pub fn new(low: i64, high: i64) -> Self {
        Self { low, high }
    }

    /// `-bound..=bound`.
    pub fn symmetric(bound: i64) -> Self {
        Self {
            low: -bound,
            high: bound,
        }
    }

    /// One value.
    pub fn point(value: i64) -> Self {
        Self {
            low: value,
            high: value,
        }
    }

    /// Whether every value of `inner` lies in `self`.
    pub fn contains(self, inner: Self) -> bool {
        self.low <= inner.low && inner.high <= self.high
    }

    /// The smallest interval that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Largest magnitude.
    pub fn magnitude(self) -> i64 {
        self.low.abs().max(self.high.abs())
    }

    /// Bits of the smallest two's complement word that holds the interval.
    pub fn bits(self) -> u32 {
        let of = |x: i64| {
            65 - if x < 0 {
                x.leading_ones()
            } else {
                x.leading_zeros()
            }
        };
        of(self.low).max(of(self.high))
    }

    fn corners(self, other: Self, f: impl Fn(i64, i64) -> i64) -> Self {
        let all = [
            f(self.low, other.low),
            f(self.low, other.high),
            f(self.high, other.low),
            f(self.high, other.high),
        ];
        Self {
            low: all.into_iter().fold(i64::MAX, i64::min),
            high: all.into_iter().fold(i64::MIN, i64::max),
        }
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, {}]", self.low, self.high)
    }
}

/// Comparison operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// a < b
    Less,
    /// a <= b
    LessEqual,
    /// a == b
    Equal,
    /// a != b
    NotEqual,
}

impl Comparison {
    fn holds(self, a: i64, b: i64) -> bool {
        match self {
            Self::Less => a < b,
            Self::LessEqual => a <= b,
            Self::Equal => a == b,
            Self::NotEqual => a != b,
        }
    }
}

/// Operators. `a`, `b` and so on are words unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Op {
    /// Word `n` of the function's inputs.
    Input(u32),
    /// A set-point word.
    Param(ParamId),
    /// A state word as it was before the step.
    State(StateId),
    /// A named constant.
    Constant(ConstantId),
    /// A small number that needs no name.
    Literal(i32),
    /// a + b
    Add(Value, Value),
    /// a - b
    Sub(Value, Value),
    /// -a
    Neg(Value),
    /// |a|
    Abs(Value),
    /// a b, in one word
    Product(Value, Value),
    /// floor((c x + 2^(shift-1)) / 2^shift): coefficient times signal, rounded half up
    MulRound {
        /// Coefficient.
        coefficient: Value,
        /// Signal.
        signal: Value,
        /// 1 to 62.
        shift: u32,
    },
    /// floor(a b / 2^shift)
    MulFloor {
        /// Factor.
        a: Value,
        /// Factor.
        b: Value,
        /// 0 to 62.
        shift: u32,
    },
    /// min(a b, limit) for a, b >= 0
    MulLimited {
        /// Factor, not negative.
        a: Value,
        /// Factor, not negative.
        b: Value,
        /// Upper limit, a word.
        limit: Value,
    },
    /// a 2^n
    ShiftLeft(Value, u32),
    /// floor(a / 2^n)
    ShiftRight(Value, u32),
    /// min(a, b)
    Min(Value, Value),
    /// max(a, b)
    Max(Value, Value),
    /// min(max(x, low), high), low <= high
    Clamp {
        /// What is clamped.
        x: Value,
        /// Lower limit.
        low: Value,
        /// Upper limit.
        high: Value,
    },
    /// min(floor(numerator 2^shift / denominator), limit), numerator >= 0, denominator >= 1
    Divide {
        /// Not negative.
        numerator: Value,
        /// 0 to 31.
        shift: u32,
        /// At least 1.
        denominator: Value,
        /// Upper limit, a word.
        limit: Value,
    },
    /// floor((2^32 - 1) / a), a >= 2
    TurnOver(Value),
    /// (a + b) mod 2^32 as a signed word: angles
    AngleAdd(Value, Value),
    /// (a - b) mod 2^32 as a signed word: angles
    AngleSub(Value, Value),
    /// floor(u segments / 2^32) with u the angle as an unsigned word
    AngleIndex {
        /// Angle.
        angle: Value,
        /// Segments of a turn, 1 to 2^16.
        segments: u32,
    },
    /// the top 31 bits of (u segments mod 2^32): position within the segment, 2^31 = its whole width
    AngleFraction {
        /// Angle.
        angle: Value,
        /// Segments of a turn, 1 to 2^16.
        segments: u32,
    },
    /// table[index mod length]
    Lookup {
        /// Table; its length is a power of two.
        table: TableId,
        /// Any word.
        index: Value,
    },
    /// Flag: a compared with b
    Compare(Comparison, Value, Value),
    /// Flag: both flags
    And(Value, Value),
    /// Flag: either flag
    Or(Value, Value),
    /// Flag: not the flag
    Not(Value),
    /// `then` if the flag holds, else `otherwise`; both of the same kind
    Select {
        /// Flag.
        condition: Value,
        /// Value where it holds.
        then: Value,
        /// Value where it does not.
        otherwise: Value,
    },
    /// Result of a guarded stage: `taken` from inside if the guard held, else `otherwise` from outside
    Join {
        /// Value of the guarded stage.
        taken: Value,
        /// Value defined before the guarded stage.
        otherwise: Value,
    },
}

impl Op {
    /// The operands, in order.
    pub fn operands(&self) -> Vec<Value> {
        match *self {
            Self::Input(_)
            | Self::Param(_)
            | Self::State(_)
            | Self::Constant(_)
            | Self::Literal(_) => vec![],
            Self::Neg(a)
            | Self::Abs(a)
            | Self::ShiftLeft(a, _)
            | Self::ShiftRight(a, _)
            | Self::TurnOver(a)
            | Self::Not(a)
            | Self::AngleIndex { angle: a, .. }
            | Self::AngleFraction { angle: a, .. }
            | Self::Lookup { index: a, .. } => vec![a],
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Product(a, b)
            | Self::MulRound {
                coefficient: a,
                signal: b,
                ..
            }
            | Self::MulFloor { a, b, .. }
            | Self::Min(a, b)
            | Self::Max(a, b)
            | Self::AngleAdd(a, b)
            | Self::AngleSub(a, b)
            | Self::Compare(_, a, b)
            | Self::And(a, b)
            | Self::Or(a, b)
            | Self::Join {
                taken: a,
                otherwise: b,
            } => vec![a, b],
            Self::MulLimited { a, b, limit: c }
            | Self::Divide {
                numerator: a,
                denominator: b,
                limit: c,
                ..
            }
            | Self::Clamp {
                x: a,
                low: b,
                high: c,
            }
            | Self::Select {
                condition: a,
                then: b,
                otherwise: c,
            } => vec![a, b, c],
        }
    }

    /// Replaces every operand.
    pub(crate) fn map_operands(&mut self, f: impl Fn(Value) -> Value) {
        match self {
            Self::Input(_)
            | Self::Param(_)
            | Self::State(_)
            | Self::Constant(_)
            | Self::Literal(_) => {}
            Self::Neg(a)
            | Self::Abs(a)
            | Self::ShiftLeft(a, _)
            | Self::ShiftRight(a, _)
            | Self::TurnOver(a)
            | Self::Not(a)
            | Self::AngleIndex { angle: a, .. }
            | Self::AngleFraction { angle: a, .. }
            | Self::Lookup { index: a, .. } => *a = f(*a),
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Product(a, b)
            | Self::MulRound {
                coefficient: a,
                signal: b,
                ..
            }
            | Self::MulFloor { a, b, .. }
            | Self::Min(a, b)
            | Self::Max(a, b)
            | Self::AngleAdd(a, b)
            | Self::AngleSub(a, b)
            | Self::Compare(_, a, b)
            | Self::And(a, b)
            | Self::Or(a, b)
            | Self::Join {
                taken: a,
                otherwise: b,
            } => {
                *a = f(*a);
                *b = f(*b);
            }
            Self::MulLimited { a, b, limit: c }
            | Self::Divide {
                numerator: a,
                denominator: b,
                limit: c,
                ..
            }
            | Self::Clamp {
                x: a,
                low: b,
                high: c,
            }
            | Self::Select {
                condition: a,
                then: b,
                otherwise: c,
            } => {
                *a = f(*a);
                *b = f(*b);
                *c = f(*c);
            }
        }
    }

    /// What kind of value the operator yields, from the kinds of its operands.
    pub fn kind(&self, kind_of: impl Fn(Value) -> Kind) -> Kind {
        match *self {
            Self::Compare(..) | Self::And(..) | Self::Or(..) | Self::Not(_) => Kind::Flag,
            Self::Select { then: a, .. } | Self::Join { taken: a, .. } => kind_of(a),
            _ => Kind::Word,
        }
    }

    /// What kinds the operands must have, in the order of [`Op::operands`].
    pub fn operand_kinds(&self, result: Kind) -> Vec<Kind> {
        match *self {
            Self::And(..) | Self::Or(..) => vec![Kind::Flag, Kind::Flag],
            Self::Not(_) => vec![Kind::Flag],
            Self::Select { .. } => vec![Kind::Flag, result, result],
            Self::Join { .. } => vec![result, result],
            _ => vec![Kind::Word; self.operands().len()],
        }
    }

    /// The exact result for operand values `x` (in the order of [`Op::operands`]), before any check
    /// that it fits its word. `None` for leaves and joins, whose value comes from elsewhere, and for
    /// operands outside the operator's domain.
    pub fn apply(&self, x: &[i64], table: impl Fn(TableId, i64) -> i64) -> Option<i64> {
        let turn = 1_i64 << 32;
        let unsigned = |a: i64| a.rem_euclid(turn);
        let wrap = |a: i64| i64::from(a.rem_euclid(turn) as u32 as i32);
        Some(match *self {
            Self::Input(_)
            | Self::Param(_)
            | Self::State(_)
            | Self::Constant(_)
            | Self::Join { .. } => return None,
            Self::Literal(value) => i64::from(value),
            Self::Add(..) => x[0] + x[1],
            Self::Sub(..) => x[0] - x[1],
            Self::Neg(_) => -x[0],
            Self::Abs(_) => x[0].abs(),
            Self::Product(..) => x[0] * x[1],
            Self::MulRound { shift, .. } => {
                ((i128::from(x[0]) * i128::from(x[1]) + (1 << (shift - 1))) >> shift) as i64
            }
            Self::MulFloor { shift, .. } => ((i128::from(x[0]) * i128::from(x[1])) >> shift) as i64,
            Self::MulLimited { .. } => {
                if x[0] < 0 || x[1] < 0 {
                    return None;
                }
                (x[0] * x[1]).min(x[2])
            }
            Self::ShiftLeft(_, n) => x[0] << n,
            Self::ShiftRight(_, n) => x[0] >> n,
            Self::Min(..) => x[0].min(x[1]),
            Self::Max(..) => x[0].max(x[1]),
            Self::Clamp { .. } => x[0].max(x[1]).min(x[2]),
            Self::Divide { shift, .. } => {
                if x[0] < 0 || x[1] < 1 {
                    return None;
                }
                ((x[0] << shift) / x[1]).min(x[2])
            }
            Self::TurnOver(_) => {
                if x[0] < 2 {
                    return None;
                }
                (turn - 1) / x[0]
            }
            Self::AngleAdd(..) => wrap(x[0] + x[1]),
            Self::AngleSub(..) => wrap(x[0] - x[1]),
            Self::AngleIndex { segments, .. } => (unsigned(x[0]) * i64::from(segments)) >> 32,
            Self::AngleFraction { segments, .. } => {
                unsigned(unsigned(x[0]) * i64::from(segments)) >> 1
            }
            Self::Lookup { table: id, .. } => table(id, x[0]),
            Self::Compare(how, ..) => i64::from(how.holds(x[0], x[1])),
            Self::And(..) => x[0] & x[1],
            Self::Or(..) => x[0] | x[1],
            Self::Not(_) => 1 - x[0],
            Self::Select { .. } => x[if x[0] == 1 { 1 } else { 2 }],
        })
    }

    /// An interval that holds every result for operands in the intervals `x`; exact but for
    /// correlations between operands. `None` where the operator's domain may be left.
    pub fn interval(
        &self,
        x: &[Interval],
        table: impl Fn(TableId) -> Interval,
    ) -> Option<Interval> {
        let exact = |p: i64, q: i64| self.apply(&[p, q, 0], |_, _| 0).unwrap_or(0);
        Some(match *self {
            Self::Input(_) | Self::Param(_) | Self::State(_) | Self::Constant(_) => return None,
            Self::Literal(value) => Interval::point(i64::from(value)),
            // Monotonic in each operand: the corners decide.
            Self::Add(..)
            | Self::Sub(..)
            | Self::Product(..)
            | Self::MulRound { .. }
            | Self::MulFloor { .. }
            | Self::Min(..)
            | Self::Max(..) => x[0].corners(x[1], exact),
            Self::Neg(_) => Interval::new(-x[0].high, -x[0].low),
            Self::Abs(_) => {
                let least = if x[0].low <= 0 && x[0].high >= 0 {
                    0
                } else {
                    x[0].low.abs().min(x[0].high.abs())
                };
                Interval::new(least, x[0].magnitude())
            }
            Self::MulLimited { .. } => {
                if x[0].low < 0 || x[1].low < 0 {
                    return None;
                }
                Interval::new(
                    (x[0].low * x[1].low).min(x[2].low),
                    (x[0].high * x[1].high).min(x[2].high),
                )
            }
            Self::ShiftLeft(_, n) => Interval::new(x[0].low << n, x[0].high << n),
            Self::ShiftRight(_, n) => Interval::new(x[0].low >> n, x[0].high >> n),
            Self::Clamp { .. } => {
                let raised = x[0].corners(x[1], i64::max);
                raised.corners(x[2], i64::min)
            }
            Self::Divide { shift, .. } => {
                if x[0].low < 0 || x[1].low < 1 {
                    return None;
                }
                let quotient = Interval::new(
                    (x[0].low << shift) / x[1].high,
                    (x[0].high << shift) / x[1].low,
                );
                Interval::new(quotient.low.min(x[2].low), quotient.high.min(x[2].high))
            }
            Self::TurnOver(_) => {
                if x[0].low < 2 {
                    return None;
                }
                Interval::new(((1 << 32) - 1) / x[0].high, ((1 << 32) - 1) / x[0].low)
            }
            Self::AngleAdd(..) | Self::AngleSub(..) => Interval::WORD,
            Self::AngleIndex { segments, .. } => Interval::new(0, i64::from(segments) - 1),
            Self::AngleFraction { .. } => Interval::new(0, i64::from(i32::MAX)),
            Self::Lookup { table: id, .. } => table(id),
            Self::Compare(..) | Self::And(..) | Self::Or(..) | Self::Not(_) => Interval::FLAG,
            Self::Select { .. } => x[1].union(x[2]),
            Self::Join { .. } => x[0].union(x[1]),
        })
    }
}

/// A node: operator, interval and name of one value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// Operator and operands.
    pub op: Op,
    /// Word or flag.
    pub kind: Kind,
    /// Proven interval.
    pub interval: Interval,
    /// Stable signal name; empty for a value that is used once, right in its stage.
    pub name: String,
}

/// A named constant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constant {
    /// `snake_case` name.
    pub name: String,
    /// Value.
    pub raw: i32,
    /// What it stands for.
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
    /// What they stand for.
    pub exact: Exact,
    /// The function of the angle whose first coefficients these are.
    pub periodic: Option<Periodic>,
    /// Meaning of the entries.
    pub doc: Vec<String>,
}

/// A periodic function that is approximated segment by segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Periodic {
    /// Largest distance of the approximation, words.
    pub misfit: Real,
    /// Steepest slope, words per turn.
    pub slope: Real,
}

impl Periodic {
    /// How far the approximation at an inexact angle is from the function at the exact one.
    pub fn error(self, angle: ErrorInterval) -> ErrorInterval {
        let turn = f64::from(32).exp2();
        let moved = if angle.is_zero() {
            0.0
        } else {
            self.misfit.value()
        };
        ErrorInterval::symmetric(
            self.misfit.value() + moved + self.slope.value() * angle.magnitude() / turn,
        )
    }
}

impl Table {
    /// The interval of its entries.
    pub fn interval(&self) -> Interval {
        let words = || self.values.iter().map(|&value| i64::from(value));
        Interval::new(words().min().unwrap_or(0), words().max().unwrap_or(0))
    }
}

/// A word that outlives a call: state of the step or word of the set-point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// `snake_case` name.
    pub name: String,
    /// Value at start.
    pub initial: i32,
    /// Interval that it never leaves.
    pub interval: Interval,
    /// Bits of the word that stores it: 16 or 32.
    pub storage_bits: u32,
    /// Meaning and format.
    pub doc: String,
}

/// A word that comes in with a call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// `snake_case` name.
    pub name: String,
    /// All values that can come.
    pub interval: Interval,
    /// Meaning.
    pub doc: String,
}

/// The condition of a guarded stage and the values that it may replace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Guard {
    /// Flag defined before the stage: the stage runs only where it holds.
    pub condition: Value,
    /// The joins, right after the stage's nodes, through which alone its values are seen outside.
    pub joins: Vec<Value>,
    /// Whether the stage is off the normal path, for the emitters (code placement) and op counts.
    pub rare: bool,
    /// Whether the function ends where the guard holds: the joins are results, and no node reads them.
    pub exit: bool,
}

/// A named group of consecutive nodes: one function of the emitted code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stage {
    /// `snake_case` name, a verb phrase.
    pub name: String,
    /// What the stage computes and why it is so, with the equation's source.
    pub doc: Vec<String>,
    /// First node.
    pub first: usize,
    /// One past the last node (without joins).
    pub end: usize,
    /// For a stage that runs under a condition only.
    pub guard: Option<Guard>,
}

/// A straight-line function over words: nodes in order, partitioned into stages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// `snake_case` name.
    pub name: String,
    /// Meaning.
    pub doc: Vec<String>,
    /// Words that come in.
    pub inputs: Vec<Input>,
    /// Nodes, each defined before it is used.
    pub nodes: Vec<Node>,
    /// Stages, in order; they and their joins cover all nodes.
    pub stages: Vec<Stage>,
    /// Named results, in order.
    pub outputs: Vec<(String, Value)>,
    /// New state words.
    pub next_state: Vec<(StateId, Value)>,
    /// New set-point words.
    pub next_params: Vec<(ParamId, Value)>,
    /// Quantities whose error is stated.
    pub quantities: Vec<Quantity>,
    /// Of the normal path of a function with an exit ([`Function::paths`]): the flags of which none holds on it.
    pub leave: Vec<Value>,
}

/// A value that stands for a physical quantity whose error is stated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// `snake_case` name; several values may have one, whose error is the largest.
    pub name: String,
    /// What it is.
    pub doc: String,
    /// Unit.
    pub unit: String,
    /// What one word of it is worth in that unit.
    pub word: Real,
    /// The value.
    pub value: Value,
}

impl Function {
    /// All values, in order.
    pub fn values(&self) -> impl Iterator<Item = Value> + use<> {
        (0..self.nodes.len() as u32).map(Value)
    }

    /// The node that defines `value`.
    pub fn node(&self, value: Value) -> &Node {
        &self.nodes[value.index()]
    }

    /// The interval of `value` where the flag `condition` does not hold.
    ///
    /// One relation is known besides the value's own interval, the spread rule: for three numbers that sum
    /// to zero, `c = -(a + b)`, and `spread = max - min` of the three, "not (limit < spread)" bounds each of
    /// them by 2/3 limit (it and its counterweight lie at most `limit` apart, and two of three share a sign),
    /// max + min, which is minus the middle one, by 1/3 limit, and each less floor((max + min)/2) by 1/2 limit:
    /// the largest is ceil(spread/2) above it and the smallest floor(spread/2) below.
    pub fn interval_where_not(&self, condition: Value, value: Value) -> Interval {
        let own = self.node(value).interval;
        let Some((limit, legs, high, low)) = self.spread_condition(condition) else {
            return own;
        };
        let limit = self.node(limit).interval.high.max(0);
        let is_centred = match self.node(value).op {
            Op::Sub(leg, middle) => legs.contains(&leg) && self.is_half_sum(middle, high, low),
            _ => false,
        };
        let bound = if legs.contains(&value) {
            limit * 2 / 3
        } else if self.is_half_sum(value, high, low) {
            limit / 6 + 1
        } else if is_centred {
            (limit + 1) / 2
        } else {
            return own;
        };
        Interval::new(own.low.max(-bound), own.high.min(bound))
    }

    /// Matches `limit < max(a, b, c) - min(a, b, c)` with c = -(a + b): limit, legs, max, min.
    fn spread_condition(&self, condition: Value) -> Option<(Value, [Value; 3], Value, Value)> {
        let Op::Compare(Comparison::Less, limit, spread) = self.node(condition).op else {
            return None;
        };
        let Op::Sub(high, low) = self.node(spread).op else {
            return None;
        };
        let Op::Max(high_pair, c) = self.node(high).op else {
            return None;
        };
        let Op::Max(a, b) = self.node(high_pair).op else {
            return None;
        };
        let Op::Min(low_pair, low_c) = self.node(low).op else {
            return None;
        };
        let Op::Neg(sum) = self.node(c).op else {
            return None;
        };
        let same = self.node(low_pair).op == Op::Min(a, b)
            && low_c == c
            && self.node(sum).op == Op::Add(a, b);
        same.then_some((limit, [a, b, c], high, low))
    }

    fn is_half_sum(&self, value: Value, high: Value, low: Value) -> bool {
        match self.node(value).op {
            Op::ShiftRight(sum, 1) => self.node(sum).op == Op::Add(high, low),
            _ => false,
        }
    }
}

/// One controller: its step, the functions that set its set-point, and what they share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// Name of the controller type.
    pub name: String,
    /// Named constants.
    pub constants: Vec<Constant>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Set-point words.
    pub params: Vec<Word>,
    /// State words.
    pub states: Vec<Word>,
    /// The control step: reads params, reads and writes state.
    pub step: Function,
    /// Functions outside the step: each reads inputs and writes some params.
    pub setters: Vec<Function>,
}

impl Program {
    /// The step and the setters.
    pub fn functions(&self) -> impl Iterator<Item = &Function> {
        std::iter::once(&self.step).chain(&self.setters)
    }
}
