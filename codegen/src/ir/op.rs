//! Operators and their meaning.
//!
//! Every value is a 32-bit two's complement word or a flag. [`Op::apply`] is the one definition of
//! what operators compute; [`Op::interval`] is its extension to intervals. All integers are exact:
//! an operator whose result leaves the 32-bit word is an error of the program, except for the
//! angle operators, which wrap by definition.

use super::interval::Interval;

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

/// Kind of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A 32-bit signed word.
    Word,
    /// True or false.
    Flag,
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
    /// The input word of this number.
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
    /// The same of a rounded product that fits a word
    MulRoundNarrow {
        /// Coefficient.
        coefficient: Value,
        /// Signal.
        signal: Value,
        /// 1 to 30.
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
    /// floor((a b + c d) / 2^shift)
    MulAddFloor {
        /// Factors of the first product.
        first: [Value; 2],
        /// Factors of the second product.
        second: [Value; 2],
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
    /// floor((a + 2^(n-1)) / 2^n), n at least 1: a part of a, rounded half up; the sum in one word
    ShiftRound(Value, u32),
    /// a - 2^n floor(a / 2^n), n from 1 to 30: what a shift by n leaves over
    Remainder(Value, u32),
    /// min(a, b)
    Min(Value, Value),
    /// max(a, b)
    Max(Value, Value),
    /// min(a, b) of words whose difference fits a word
    Lesser(Value, Value),
    /// max(a, b) of words whose difference fits a word
    Greater(Value, Value),
    /// min(max(x, low), high), low <= high
    Clamp {
        /// The clamped value.
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
    /// The same of a shifted numerator below 2^32
    DivideNarrow {
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
    /// (u segments mod 2^32) - 2^31: position within the segment from its middle, 2^32 = its whole
    /// width
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
        /// Any word if masked; else one within the table.
        index: Value,
        /// Whether the index is taken modulo the length.
        is_masked: bool,
    },
    /// Flag: a compared with b
    Compare(Comparison, Value, Value),
    /// Flag: |a| > limit, limit >= 0
    Exceeds(Value, Value),
    /// Flag: both flags
    And(Value, Value),
    /// Flag: either flag
    Or(Value, Value),
    /// Flag: not the flag
    Not(Value),
    /// 1 where the flag holds, else 0
    FlagWord(Value),
    /// `then` if the flag holds, else `otherwise`; both of the same kind
    Select {
        /// Flag.
        condition: Value,
        /// Value if true.
        then: Value,
        /// Value if false.
        otherwise: Value,
    },
    /// Result of a guarded stage: `taken` from inside if the guard held, else `otherwise` from
    /// outside
    Join {
        /// Value of the guarded stage.
        taken: Value,
        /// Value defined before the guarded stage.
        otherwise: Value,
    },
}

impl Op {
    /// Whether the value is read in place rather than computed by a stage.
    pub fn is_leaf(&self) -> bool {
        matches!(
            self,
            Self::Input(_) | Self::Param(_) | Self::State(_) | Self::Constant(_) | Self::Literal(_)
        )
    }

    /// The operands, in order.
    pub fn operands(&self) -> Vec<Value> {
        let mut operands = Vec::with_capacity(4);
        self.visit_operands(|operand| operands.push(operand));
        operands
    }

    /// Visits every operand, in order.
    pub(crate) fn visit_operands(&self, mut visit: impl FnMut(Value)) {
        let mut op = *self;
        op.each_operand(|operand| visit(*operand));
    }

    /// Replaces every operand.
    pub fn map_operands(&mut self, f: impl Fn(Value) -> Value) {
        self.each_operand(|operand| *operand = f(*operand));
    }

    /// Visits every operand, to replace it.
    fn each_operand(&mut self, mut visit: impl FnMut(&mut Value)) {
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
            | Self::ShiftRound(a, _)
            | Self::Remainder(a, _)
            | Self::TurnOver(a)
            | Self::Not(a)
            | Self::FlagWord(a)
            | Self::AngleIndex { angle: a, .. }
            | Self::AngleFraction { angle: a, .. }
            | Self::Lookup { index: a, .. } => visit(a),
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Product(a, b)
            | Self::MulRound {
                coefficient: a,
                signal: b,
                ..
            }
            | Self::MulRoundNarrow {
                coefficient: a,
                signal: b,
                ..
            }
            | Self::MulFloor { a, b, .. }
            | Self::Min(a, b)
            | Self::Max(a, b)
            | Self::Lesser(a, b)
            | Self::Greater(a, b)
            | Self::Exceeds(a, b)
            | Self::AngleAdd(a, b)
            | Self::AngleSub(a, b)
            | Self::Compare(_, a, b)
            | Self::And(a, b)
            | Self::Or(a, b)
            | Self::Join {
                taken: a,
                otherwise: b,
            } => {
                visit(a);
                visit(b);
            }
            Self::MulAddFloor { first, second, .. } => {
                first.iter_mut().chain(second).for_each(visit);
            }
            Self::MulLimited { a, b, limit: c }
            | Self::Divide {
                numerator: a,
                denominator: b,
                limit: c,
                ..
            }
            | Self::DivideNarrow {
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
                visit(a);
                visit(b);
                visit(c);
            }
        }
    }

    /// Whether a narrow operator is valid for operands in these intervals: its intermediate results
    /// fit a word. True for all other operators.
    pub fn is_narrow(&self, x: &[Interval]) -> bool {
        let fits = |interval: Interval| Interval::WORD.contains(interval);
        match *self {
            Self::MulRoundNarrow { shift, .. } => {
                let is_word = x.iter().all(|&factor| fits(factor));
                let in_range = (1..=30).contains(&shift);
                is_word && in_range && {
                    let products = x[0].corners(x[1], |a, b| a * b);
                    fits(products) && fits(Interval::point(products.high + (1 << (shift - 1))))
                }
            }
            Self::ShiftRound(_, n) => {
                (1..=31).contains(&n)
                    && fits(x[0])
                    && x[0].high + (1 << (n - 1)) <= Interval::WORD.high
            }
            Self::Lesser(..) | Self::Greater(..) => {
                fits(Interval::new(x[0].low - x[1].high, x[0].high - x[1].low))
            }
            Self::DivideNarrow { shift, .. } => {
                fits(x[0]) && shift <= 31 && x[0].high << shift <= i64::from(u32::MAX)
            }
            Self::Exceeds(..) => x[1].low >= 0,
            _ => true,
        }
    }

    /// The kind of the result, from the kinds of the operands.
    pub fn kind(&self, kind_of: impl Fn(Value) -> Kind) -> Kind {
        match *self {
            Self::Compare(..) | Self::Exceeds(..) | Self::And(..) | Self::Or(..) | Self::Not(_) => {
                Kind::Flag
            }
            Self::Select { then: a, .. } | Self::Join { taken: a, .. } => kind_of(a),
            _ => Kind::Word,
        }
    }

    /// The kinds that the operands must have, in the order of [`Op::operands`].
    pub fn operand_kinds(&self, result: Kind) -> Vec<Kind> {
        match *self {
            Self::And(..) | Self::Or(..) => vec![Kind::Flag, Kind::Flag],
            Self::Not(_) | Self::FlagWord(_) => vec![Kind::Flag],
            Self::Select { .. } => vec![Kind::Flag, result, result],
            Self::Join { .. } => vec![result, result],
            _ => vec![Kind::Word; self.operands().len()],
        }
    }

    /// The exact result of the values that `word` gives, which may exceed a word. `None` for leaves
    /// and joins, and for values outside the operator's domain.
    #[inline]
    pub fn apply(
        &self,
        word: impl Fn(Value) -> i64,
        table: impl Fn(TableId, i64) -> i64,
    ) -> Option<i64> {
        let turn = 1_i64 << 32;
        let unsigned = |value| word(value).rem_euclid(turn);
        let wrap = |a: i64| i64::from(a.rem_euclid(turn) as u32 as i32);
        let product = |a, b| i128::from(word(a)) * i128::from(word(b));
        Some(match *self {
            Self::Input(_)
            | Self::Param(_)
            | Self::State(_)
            | Self::Constant(_)
            | Self::Join { .. } => return None,
            Self::Literal(value) => i64::from(value),
            Self::Add(a, b) => word(a) + word(b),
            Self::Sub(a, b) => word(a) - word(b),
            Self::Neg(a) => -word(a),
            Self::Abs(a) => word(a).abs(),
            Self::Product(a, b) => word(a) * word(b),
            Self::MulRound {
                coefficient,
                signal,
                shift,
            }
            | Self::MulRoundNarrow {
                coefficient,
                signal,
                shift,
            } => ((product(coefficient, signal) + (1 << (shift - 1))) >> shift) as i64,
            Self::MulFloor { a, b, shift } => (product(a, b) >> shift) as i64,
            Self::MulAddFloor {
                first: [a, b],
                second: [c, d],
                shift,
            } => ((product(a, b) + product(c, d)) >> shift) as i64,
            Self::MulLimited { a, b, limit } => {
                let (a, b) = (word(a), word(b));
                if a < 0 || b < 0 {
                    return None;
                }
                (a * b).min(word(limit))
            }
            Self::ShiftLeft(a, n) => word(a) << n,
            Self::ShiftRight(a, n) => word(a) >> n,
            Self::ShiftRound(a, n) => (word(a) + (1 << (n - 1))) >> n,
            Self::Remainder(a, n) => word(a).rem_euclid(1 << n),
            Self::Min(a, b) | Self::Lesser(a, b) => word(a).min(word(b)),
            Self::Max(a, b) | Self::Greater(a, b) => word(a).max(word(b)),
            Self::Clamp { x, low, high } => word(x).max(word(low)).min(word(high)),
            Self::Divide {
                numerator,
                shift,
                denominator,
                limit,
            }
            | Self::DivideNarrow {
                numerator,
                shift,
                denominator,
                limit,
            } => {
                let (numerator, denominator) = (word(numerator), word(denominator));
                if numerator < 0 || denominator < 1 {
                    return None;
                }
                ((numerator << shift) / denominator).min(word(limit))
            }
            Self::TurnOver(a) => {
                let a = word(a);
                if a < 2 {
                    return None;
                }
                (turn - 1) / a
            }
            Self::AngleAdd(a, b) => wrap(word(a) + word(b)),
            Self::AngleSub(a, b) => wrap(word(a) - word(b)),
            Self::AngleIndex { angle, segments } => (unsigned(angle) * i64::from(segments)) >> 32,
            Self::AngleFraction { angle, segments } => {
                (unsigned(angle) * i64::from(segments)).rem_euclid(turn) - (1 << 31)
            }
            Self::Lookup {
                table: id, index, ..
            } => table(id, word(index)),
            Self::Compare(how, a, b) => i64::from(how.holds(word(a), word(b))),
            Self::Exceeds(a, limit) => i64::from(word(a).abs() > word(limit)),
            Self::FlagWord(flag) => word(flag),
            Self::And(a, b) => word(a) & word(b),
            Self::Or(a, b) => word(a) | word(b),
            Self::Not(a) => 1 - word(a),
            Self::Select {
                condition,
                then,
                otherwise,
            } => word(if word(condition) == 1 {
                then
            } else {
                otherwise
            }),
        })
    }

    /// [`Op::apply`] to words in the order of [`Op::operands`], wherever its operands are defined.
    pub fn apply_to(&self, words: &[i64], table: impl Fn(TableId, i64) -> i64) -> Option<i64> {
        let (mut op, mut numbers) = (*self, 0..);
        op.each_operand(|operand| operand.0 = numbers.next().unwrap_or(u32::MAX));
        op.apply(|operand| words[operand.index()], table)
    }

    /// An interval of the results for operands in the intervals `x`; exact but for correlations
    /// between operands. `None` if the operator's domain may be left.
    pub fn interval(
        &self,
        x: &[Interval],
        table: impl Fn(TableId) -> Interval,
    ) -> Option<Interval> {
        let exact = |p: i64, q: i64| self.apply_to(&[p, q], |_, _| 0).unwrap_or(0);
        Some(match *self {
            Self::Input(_) | Self::Param(_) | Self::State(_) | Self::Constant(_) => return None,
            Self::Literal(value) => Interval::point(i64::from(value)),
            // Monotonic in each operand.
            Self::Add(..)
            | Self::Sub(..)
            | Self::Product(..)
            | Self::MulRound { .. }
            | Self::MulRoundNarrow { .. }
            | Self::MulFloor { .. }
            | Self::Min(..)
            | Self::Max(..)
            | Self::Lesser(..)
            | Self::Greater(..) => x[0].corners(x[1], exact),
            Self::Neg(_) => Interval::new(-x[0].high, -x[0].low),
            Self::Abs(_) => {
                let least = if x[0].low <= 0 && x[0].high >= 0 {
                    0
                } else {
                    x[0].low.abs().min(x[0].high.abs())
                };
                Interval::new(least, x[0].magnitude())
            }
            Self::MulAddFloor { shift, .. } => {
                // Words make products of 63 bits; the sum itself must fit 64.
                if !x.iter().all(|&factor| Interval::WORD.contains(factor)) {
                    return None;
                }
                let [first, second] =
                    [(x[0], x[1]), (x[2], x[3])].map(|(a, b)| a.corners(b, |a, b| a * b));
                let least = first.low.checked_add(second.low)?;
                let most = first.high.checked_add(second.high)?;
                Interval::new(least >> shift, most >> shift)
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
            Self::ShiftRound(..) => Interval::new(exact(x[0].low, 0), exact(x[0].high, 0)),
            Self::Remainder(_, n) if x[0].low >> n == x[0].high >> n => {
                Interval::new(exact(x[0].low, 0), exact(x[0].high, 0))
            }
            Self::Remainder(_, n) => Interval::new(0, (1 << n) - 1),
            Self::FlagWord(_) => x[0],
            Self::Clamp { .. } => {
                let raised = x[0].corners(x[1], i64::max);
                raised.corners(x[2], i64::min)
            }
            Self::Divide { shift, .. } | Self::DivideNarrow { shift, .. } => {
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
            Self::AngleAdd(..) | Self::AngleSub(..) | Self::AngleFraction { .. } => Interval::WORD,
            Self::AngleIndex { segments, .. } => Interval::new(0, i64::from(segments) - 1),
            Self::Lookup { table: id, .. } => table(id),
            Self::Compare(..) | Self::Exceeds(..) | Self::And(..) | Self::Or(..) | Self::Not(_) => {
                Interval::FLAG
            }
            Self::Select { .. } => x[1].union(x[2]),
            Self::Join { .. } => x[0].union(x[1]),
        })
    }
}
