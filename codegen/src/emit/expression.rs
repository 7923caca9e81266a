//! Values as expressions, whatever the language.
//!
//! A value with a name is that name; a value without one is written where it is used. Comparisons
//! with a constant have it on the right. All else is as in the graph.

use super::plan::Context;
use super::signal::{Leg, Shape};
use crate::ir::{Comparison, ConstantId, Node, Op, StateId, TableId, Value};

/// An expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Expression {
    /// A named value.
    Signal(String),
    /// A state word.
    State(StateId),
    /// A named constant.
    Constant(ConstantId),
    /// A small number.
    Number(i32),
    /// The state of a leg, by name.
    Leg(Leg),
    /// -a
    Negated(Box<Self>),
    /// Negation of a flag.
    Not(Box<Self>),
    /// Two operands.
    Binary(Operator, Box<Self>, Box<Self>),
    /// a 2^n, n at least 1
    ShiftedLeft(Box<Self>, u32),
    /// floor(a / 2^n), n at least 1
    ShiftedRight(Box<Self>, u32),
    /// A primitive, its operands, and its shift or number of segments.
    Call(Primitive, Vec<Self>, Option<u32>),
    /// table[index mod length]; whether the index must be masked.
    Lookup(TableId, Box<Self>, bool),
    /// 1 where the flag holds, else 0.
    FlagWord(Box<Self>),
    /// A word as the state of a leg.
    LegOf(Box<Self>),
    /// Condition, value if true, value if false.
    Choice(Box<[Self; 3]>),
}

/// Operators of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operator {
    /// a + b
    Add,
    /// a - b
    Sub,
    /// (a + b) mod 2^32 as a signed word
    AngleAdd,
    /// (a - b) mod 2^32 as a signed word
    AngleSub,
    /// a b, in one word
    Mul,
    /// a < b
    Less,
    /// a <= b
    LessEqual,
    /// a > b
    Greater,
    /// a >= b
    GreaterEqual,
    /// a == b
    Equal,
    /// a != b
    NotEqual,
    /// Both flags.
    And,
    /// Either flag.
    Or,
}

/// Functions with a helper in every language; their meaning is that of the [`Op`] of the same name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Primitive {
    /// |a|
    Abs,
    /// Flag: |a| > b, b not negative
    Exceeds,
    /// min(a, b)
    Min,
    /// max(a, b)
    Max,
    /// min(a, b), neither a constant, a - b in one word
    Lesser,
    /// max(a, b), likewise
    Greater,
    /// min(max(x, low), high)
    Clamp,
    /// [`Op::MulRound`]
    MulRound,
    /// [`Op::MulRound`] whose rounded product fits a word.
    MulRoundNarrow,
    /// [`Op::MulFloor`]
    MulFloor,
    /// [`Op::MulAddFloor`]
    MulAddFloor,
    /// [`Op::MulLimited`]
    MulLimited,
    /// [`Op::Divide`]
    Divide,
    /// [`Op::Divide`] whose shifted numerator fits 32 unsigned bits.
    DivideNarrow,
    /// [`Op::Remainder`]
    Remainder,
    /// [`Op::TurnOver`]
    TurnOver,
    /// [`Op::AngleIndex`]
    AngleIndex,
    /// [`Op::AngleFraction`]
    AngleFraction,
}

impl Expression {
    fn binary(operator: Operator, a: Self, b: Self) -> Self {
        Self::Binary(operator, Box::new(a), Box::new(b))
    }

    fn is_constant(&self) -> bool {
        matches!(self, Self::Number(_) | Self::Constant(_))
    }
}

/// The place where values are used.
#[derive(Clone, Copy)]
pub(super) struct Scope<'a> {
    /// The function.
    pub context: &'a Context<'a>,
    /// Whether state words are read in place (in the function's own body) rather than by name (in a
    /// stage, which reads them first).
    pub reads_state: bool,
}

impl<'a> Scope<'a> {
    fn node(&self, value: Value) -> &'a Node {
        self.context.function.node(value)
    }

    /// The value as a small number, if it is one.
    pub(super) fn literal(&self, value: Value) -> Option<i32> {
        match self.node(value).op {
            Op::Literal(literal) => Some(literal),
            _ => None,
        }
    }

    /// A value in use: its name, or its expression.
    pub(super) fn value(&self, value: Value) -> Expression {
        let node = self.node(value);
        match node.op {
            Op::Constant(id) => Expression::Constant(id),
            Op::Literal(literal) => Expression::Number(literal),
            Op::State(id) if self.reads_state => Expression::State(id),
            _ if node.name.is_empty() => self.definition(value),
            _ => Expression::Signal(node.name.clone()),
        }
    }

    /// A value in the given shape.
    pub(super) fn in_shape(&self, value: Value, shape: Shape) -> Expression {
        if shape == Shape::Leg
            && let Some(number) = self.literal(value)
        {
            return Expression::Leg(Leg::of(number));
        }
        let is_as_wanted = shape != Shape::Leg || self.context.shape(value) == Shape::Leg;
        let word = self.value(value);
        if is_as_wanted {
            word
        } else {
            Expression::LegOf(Box::new(word))
        }
    }

    /// The expression that a named value is bound to.
    pub(super) fn definition(&self, value: Value) -> Expression {
        use Expression as E;
        use Operator as O;
        use Primitive as P;
        let of = |value: Value| self.value(value);
        let boxed = |value: Value| Box::new(self.value(value));
        let call = |primitive, operands: &[Value], number| {
            E::Call(
                primitive,
                operands.iter().copied().map(of).collect(),
                number,
            )
        };
        match self.node(value).op {
            Op::Input(_) | Op::Param(_) | Op::State(_) | Op::Constant(_) | Op::Literal(_) => {
                self.value(value)
            }
            // A join is bound by the call of its stage.
            Op::Join { taken, .. } => of(taken),
            Op::Add(a, b) => E::binary(O::Add, of(a), of(b)),
            Op::AngleAdd(a, b) => E::binary(O::AngleAdd, of(a), of(b)),
            Op::Sub(a, b) => E::binary(O::Sub, of(a), of(b)),
            Op::AngleSub(a, b) => E::binary(O::AngleSub, of(a), of(b)),
            Op::Neg(a) => E::Negated(boxed(a)),
            Op::Abs(a) => call(P::Abs, &[a], None),
            Op::Product(a, b) => E::binary(O::Mul, of(a), of(b)),
            Op::MulRound {
                coefficient,
                signal,
                shift,
            } => call(P::MulRound, &[coefficient, signal], Some(shift)),
            Op::MulRoundNarrow {
                coefficient,
                signal,
                shift,
            } => call(P::MulRoundNarrow, &[coefficient, signal], Some(shift)),
            Op::MulFloor { a, b, shift } => call(P::MulFloor, &[a, b], Some(shift)),
            Op::MulAddFloor {
                first: [a, b],
                second: [c, d],
                shift,
            } => call(P::MulAddFloor, &[a, b, c, d], Some(shift)),
            Op::MulLimited { a, b, limit } => call(P::MulLimited, &[a, b, limit], None),
            Op::ShiftLeft(a, bits) => E::ShiftedLeft(boxed(a), bits),
            Op::ShiftRight(a, bits) => E::ShiftedRight(boxed(a), bits),
            Op::ShiftRound(a, bits) => {
                let half = E::binary(O::Add, of(a), E::Number(1 << (bits - 1)));
                E::ShiftedRight(Box::new(half), bits)
            }
            Op::Remainder(a, bits) => call(P::Remainder, &[a], Some(bits)),
            Op::Min(a, b) => call(P::Min, &[a, b], None),
            Op::Max(a, b) => call(P::Max, &[a, b], None),
            Op::Lesser(a, b) => call(P::Lesser, &[a, b], None),
            Op::Greater(a, b) => call(P::Greater, &[a, b], None),
            Op::Clamp { x, low, high } => call(P::Clamp, &[x, low, high], None),
            Op::Divide {
                numerator,
                shift,
                denominator,
                limit,
            } => call(P::Divide, &[numerator, denominator, limit], Some(shift)),
            Op::DivideNarrow {
                numerator,
                shift,
                denominator,
                limit,
            } => call(
                P::DivideNarrow,
                &[numerator, denominator, limit],
                Some(shift),
            ),
            Op::TurnOver(a) => call(P::TurnOver, &[a], None),
            Op::AngleIndex { angle, segments } => call(P::AngleIndex, &[angle], Some(segments)),
            Op::AngleFraction { angle, segments } => {
                call(P::AngleFraction, &[angle], Some(segments))
            }
            Op::Lookup {
                table,
                index,
                is_masked,
            } => E::Lookup(table, boxed(index), is_masked),
            Op::Compare(how, a, b) => self.comparison(how, a, b),
            Op::Exceeds(a, limit) => call(P::Exceeds, &[a, limit], None),
            Op::And(a, b) => E::binary(O::And, of(a), of(b)),
            Op::Or(a, b) => E::binary(O::Or, of(a), of(b)),
            Op::Not(a) => E::Not(boxed(a)),
            Op::FlagWord(a) => E::FlagWord(boxed(a)),
            Op::Select {
                condition,
                then,
                otherwise,
            } => {
                let shape = self.context.shape(value);
                let [then, otherwise] = [then, otherwise].map(|arm| self.in_shape(arm, shape));
                E::Choice(Box::new([of(condition), then, otherwise]))
            }
        }
    }

    /// The signal on the left, its limit on the right.
    fn comparison(&self, how: Comparison, a: Value, b: Value) -> Expression {
        let turned = self.value(a).is_constant() && !self.value(b).is_constant();
        let (left, right) = if turned { (b, a) } else { (a, b) };
        let operator = match (how, turned) {
            (Comparison::Equal, _) => Operator::Equal,
            (Comparison::NotEqual, _) => Operator::NotEqual,
            (Comparison::Less, false) => Operator::Less,
            (Comparison::Less, true) => Operator::Greater,
            (Comparison::LessEqual, false) => Operator::LessEqual,
            (Comparison::LessEqual, true) => Operator::GreaterEqual,
        };
        Expression::binary(operator, self.value(left), self.value(right))
    }
}
