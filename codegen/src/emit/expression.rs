//! Values as expressions that a language prints: which form each takes, not how it is spelled.
//!
//! A value with a name is that name; a value without one stands where it is used. Constants stand on the right;
//! products and dividends that provably fit 32 bits take the narrow primitives.

use super::plan::Context;
use super::signal::{Leg, Shape};
use crate::ir::{Comparison, ConstantId, Interval, Node, Op, StateId, TableId, Value};

/// An expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Expression {
    /// A value under its name.
    Signal(String),
    /// A state word, read at its place.
    State(StateId),
    /// A named constant.
    Constant(ConstantId),
    /// A small number.
    Number(i32),
    /// The state of a leg, by name.
    Leg(Leg),
    /// -a
    Negated(Box<Self>),
    /// The flag does not hold.
    Not(Box<Self>),
    /// Two operands.
    Binary(Operator, Box<Self>, Box<Self>),
    /// a 2^n, n at least 1
    ShiftedLeft(Box<Self>, u32),
    /// floor(a / 2^n), n at least 1
    ShiftedRight(Box<Self>, u32),
    /// A primitive of its operands; the number is a shift or a count of segments.
    Call(Primitive, Vec<Self>, Option<u32>),
    /// table[index mod length]; whether the index is known to lie within the table.
    Lookup(TableId, Box<Self>, bool),
    /// 1 where the flag holds, else 0.
    FlagWord(Box<Self>),
    /// The state of a leg that a word stands for.
    LegOf(Box<Self>),
    /// Condition, value where it holds, value where it does not.
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

/// Functions that every language has a helper for; their meaning is that of the [`Op`] of the same name.
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

    fn is_number(&self) -> bool {
        matches!(self, Self::Number(_))
    }

    fn is_constant(&self) -> bool {
        matches!(self, Self::Number(_) | Self::Constant(_))
    }
}

/// The place from which values are seen.
#[derive(Clone, Copy)]
pub(super) struct Scope<'a> {
    /// The function.
    pub context: &'a Context<'a>,
    /// Whether state words are read where they are used (in the function's own body) rather than
    /// under their names (in a stage, which reads them first).
    pub reads_state: bool,
}

impl<'a> Scope<'a> {
    fn node(&self, value: Value) -> &'a Node {
        self.context.function.node(value)
    }

    fn interval(&self, value: Value) -> Interval {
        self.node(value).interval
    }

    /// The small number that a value is, if it is one.
    pub(super) fn literal(&self, value: Value) -> Option<i32> {
        match self.node(value).op {
            Op::Literal(literal) => Some(literal),
            _ => None,
        }
    }

    /// A value where it is used: its name, or what it stands for.
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

    /// A value as the given shape has it.
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

    /// What a named value is bound to.
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
            // A join is bound where its stage is called.
            Op::Join { taken, .. } => of(taken),
            Op::Add(a, b) => sum(of(a), of(b)),
            Op::AngleAdd(a, b) => E::binary(O::AngleAdd, of(a), of(b)),
            Op::Sub(a, b) => E::binary(O::Sub, of(a), of(b)),
            Op::AngleSub(a, b) => E::binary(O::AngleSub, of(a), of(b)),
            Op::Neg(a) => E::Negated(boxed(a)),
            Op::Abs(a) => call(P::Abs, &[a], None),
            Op::Product(a, b) | Op::MulFloor { a, b, shift: 0 } => product(of(a), of(b)),
            Op::MulRound {
                coefficient,
                signal,
                shift,
            } => {
                if let Some([half, shift]) = self.rounded_part(coefficient, signal, shift) {
                    let half = E::Number(half as i32);
                    return E::ShiftedRight(Box::new(sum(of(signal), half)), shift);
                }
                let rounds_narrow = self.rounds_narrow(coefficient, signal, shift);
                let primitive = if rounds_narrow {
                    P::MulRoundNarrow
                } else {
                    P::MulRound
                };
                call(primitive, &[coefficient, signal], Some(shift))
            }
            Op::MulFloor { a, b, shift } => {
                if fits_word(self.products(a, b)) {
                    E::ShiftedRight(Box::new(product(of(a), of(b))), shift)
                } else {
                    call(P::MulFloor, &[a, b], Some(shift))
                }
            }
            Op::MulAddFloor {
                first: [a, b],
                second: [c, d],
                shift,
            } => {
                let (first, second) = (self.products(a, b), self.products(c, d));
                let all = Interval::new(first.low + second.low, first.high + second.high);
                if [first, second, all].into_iter().all(fits_word) {
                    let whole = sum(product(of(a), of(b)), product(of(c), of(d)));
                    match shift {
                        0 => whole,
                        _ => E::ShiftedRight(Box::new(whole), shift),
                    }
                } else {
                    call(P::MulAddFloor, &[a, b, c, d], Some(shift))
                }
            }
            Op::MulLimited { a, b, limit } => {
                if fits_word(self.products(a, b)) {
                    E::Call(P::Min, vec![product(of(a), of(b)), of(limit)], None)
                } else {
                    call(P::MulLimited, &[a, b, limit], None)
                }
            }
            Op::ShiftLeft(a, 0) | Op::ShiftRight(a, 0) => of(a),
            Op::ShiftLeft(a, bits) => E::ShiftedLeft(boxed(a), bits),
            Op::ShiftRight(a, bits) => E::ShiftedRight(boxed(a), bits),
            Op::Min(a, b) if self.are_near(a, b) => call(P::Lesser, &[a, b], None),
            Op::Max(a, b) if self.are_near(a, b) => call(P::Greater, &[a, b], None),
            Op::Min(a, b) => extreme(P::Min, of(a), of(b)),
            Op::Max(a, b) => extreme(P::Max, of(a), of(b)),
            Op::Clamp { x, low, high } => call(P::Clamp, &[x, low, high], None),
            Op::Divide {
                numerator,
                shift,
                denominator,
                limit,
            } => {
                let is_narrow = self.interval(numerator).high << shift <= i64::from(u32::MAX);
                let primitive = if is_narrow {
                    P::DivideNarrow
                } else {
                    P::Divide
                };
                call(primitive, &[numerator, denominator, limit], Some(shift))
            }
            Op::TurnOver(a) => call(P::TurnOver, &[a], None),
            Op::AngleIndex { angle, segments } => call(P::AngleIndex, &[angle], Some(segments)),
            Op::AngleFraction { angle, segments } => {
                call(P::AngleFraction, &[angle], Some(segments))
            }
            Op::Lookup { table, index } => {
                let length = self.context.program.tables[table.index()].values.len();
                let inside = Interval::new(0, length as i64 - 1);
                E::Lookup(table, boxed(index), inside.contains(self.interval(index)))
            }
            Op::Compare(how, a, b) => self.comparison(how, a, b),
            Op::And(a, b) => E::binary(O::And, of(a), of(b)),
            Op::Or(a, b) => {
                if let Some([x, limit]) = self.range_test(a, b) {
                    call(P::Exceeds, &[x, limit], None)
                } else {
                    E::binary(O::Or, of(a), of(b))
                }
            }
            Op::Not(a) => self.negation(a),
            Op::Select {
                condition,
                then,
                otherwise,
            } => self.select(self.context.shape(value), [condition, then, otherwise]),
        }
    }

    /// The word and the limit, not negative, whose magnitudes the two flags compare: `limit < x` or `x < -limit`.
    fn range_test(&self, above: Value, below: Value) -> Option<[Value; 2]> {
        let unnamed = |value: Value| {
            let node = self.node(value);
            node.name.is_empty().then_some(node.op)
        };
        let (Op::Compare(Comparison::Less, limit, x), Op::Compare(Comparison::Less, again, low)) =
            (unnamed(above)?, unnamed(below)?)
        else {
            return None;
        };
        let Op::Neg(other) = unnamed(low)? else {
            return None;
        };
        let is_limit = other == limit
            || matches!(self.node(limit).op, Op::Constant(_))
                && self.node(other).op == self.node(limit).op;
        (x == again && is_limit && self.interval(limit).low >= 0).then_some([x, limit])
    }

    /// The signal stands left, what it is compared with right.
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

    /// The opposite comparison rather than a negated one.
    fn negation(&self, a: Value) -> Expression {
        let node = self.node(a);
        match node.op {
            Op::Compare(how, a, b) if node.name.is_empty() => match how {
                Comparison::Less => self.comparison(Comparison::LessEqual, b, a),
                Comparison::LessEqual => self.comparison(Comparison::Less, b, a),
                Comparison::Equal => self.comparison(Comparison::NotEqual, a, b),
                Comparison::NotEqual => self.comparison(Comparison::Equal, a, b),
            },
            Op::Not(inner) if node.name.is_empty() => self.value(inner),
            _ => Expression::Not(Box::new(self.value(a))),
        }
    }

    fn select(&self, shape: Shape, [condition, then, otherwise]: [Value; 3]) -> Expression {
        let is_flag = shape == Shape::Word
            && self.literal(then) == Some(1)
            && self.literal(otherwise) == Some(0);
        let condition = self.value(condition);
        if is_flag {
            return Expression::FlagWord(Box::new(condition));
        }
        let [then, otherwise] = [then, otherwise].map(|arm| self.in_shape(arm, shape));
        Expression::Choice(Box::new([condition, then, otherwise]))
    }

    /// Whether two signals are known to differ by no more than a word holds.
    fn are_near(&self, a: Value, b: Value) -> bool {
        let (left, right) = (self.interval(a), self.interval(b));
        let differences = Interval::new(left.low - right.high, left.high - right.low);
        let is_signal = |value| !self.value(value).is_constant();
        is_signal(a) && is_signal(b) && fits_word(differences)
    }

    /// Every product of the two.
    fn products(&self, a: Value, b: Value) -> Interval {
        self.interval(a).corners(self.interval(b), |a, b| a * b)
    }

    /// Where the coefficient is a power of two, so that its product is a part of the signal: half of what one is there,
    /// and the shift to it. (Compilers go through 64 bits otherwise.)
    fn rounded_part(&self, coefficient: Value, signal: Value, shift: u32) -> Option<[u32; 2]> {
        let raw = self.interval(coefficient);
        let power = u32::try_from(raw.low)
            .ok()
            .filter(|low| low.is_power_of_two())?;
        let part = shift.checked_sub(power.ilog2()).filter(|&part| part > 0)?;
        let half = 1 << (part - 1);
        let fits = raw.low == raw.high && self.interval(signal).high + half <= Interval::WORD.high;
        fits.then_some([half as u32, part])
    }

    fn rounds_narrow(&self, a: Value, b: Value, shift: u32) -> bool {
        let products = self.products(a, b);
        shift <= 30
            && fits_word(products)
            && fits_word(Interval::point(products.high + (1 << (shift - 1))))
    }
}

/// A negative number is subtracted, and a number stands on the right.
fn sum(a: Expression, b: Expression) -> Expression {
    match b {
        Expression::Number(number) if (-i32::MAX..0).contains(&number) => {
            Expression::binary(Operator::Sub, a, Expression::Number(-number))
        }
        _ if a.is_number() => Expression::binary(Operator::Add, b, a),
        _ => Expression::binary(Operator::Add, a, b),
    }
}

fn product(a: Expression, b: Expression) -> Expression {
    let (a, b) = if a.is_number() { (b, a) } else { (a, b) };
    Expression::binary(Operator::Mul, a, b)
}

fn extreme(primitive: Primitive, a: Expression, b: Expression) -> Expression {
    let (a, b) = if a.is_constant() { (b, a) } else { (a, b) };
    Expression::Call(primitive, vec![a, b], None)
}

fn fits_word(interval: Interval) -> bool {
    Interval::WORD.contains(interval)
}

#[cfg(test)]
mod tests {
    use super::{Context, Expression, Primitive, Scope};
    use crate::ir::{Builder, Expr, Interval};

    /// The primitives that the lesser and the greater of two words become.
    fn extremes(x: Interval, y: Interval) -> Vec<Primitive> {
        let b = Builder::new("Extremes", &[]);
        b.stage("compare", &[]);
        let (x, y) = (b.input("x", x, ""), b.input("y", y, ""));
        let all = [x.min(y), x.max(y), y.min(x), y.max(x)].map(Expr::value);
        let program = b.finish();
        let context = Context::new(&program, &program.step);
        let scope = Scope {
            context: &context,
            reads_state: true,
        };
        let primitive = |value| match scope.definition(value) {
            Expression::Call(primitive, ..) => primitive,
            other => panic!("{other:?}"),
        };
        all.map(primitive).to_vec()
    }

    /// `a + negative part of (b - a)` is right only where neither difference leaves its word:
    /// `Word::lesser`.
    #[test]
    fn extremes_go_by_a_difference_only_where_it_fits_a_word() {
        let most = i64::from(i32::MAX);
        let by_difference = [Primitive::Lesser, Primitive::Greater].repeat(2);
        let by_comparison = [Primitive::Min, Primitive::Max].repeat(2);
        for high in [0, 1, 1 << 30, most] {
            let x = Interval::new(0, high);
            let y = |low: i64| Interval::new(low, 0);
            assert_eq!(extremes(x, y(high - most)), by_difference, "{high}");
            assert_eq!(extremes(y(high - most), x), by_difference, "{high}");
            let beyond = extremes(x, y(high - most - 1));
            assert_eq!(beyond[0], Primitive::Min, "{high}: x - y may be 2^31");
            let beyond = extremes(x, y(high - most - 2));
            assert_eq!(beyond, by_comparison, "{high}");
        }
        assert_eq!(extremes(Interval::WORD, Interval::WORD), by_comparison);
    }
}
