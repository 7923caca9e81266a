//! Operators as Rust expressions, with the parentheses that grammar and readers need.
//!
//! A value with a name is that name; a value without one stands where it is used. Products and
//! dividends that provably fit 32 bits take the `_narrow` helpers.

use super::groups::Shape;
use super::names::{loaded, number, screaming, snake, stored};
use super::plan::Context;
use crate::ir::{Comparison, Interval, Node, Op, Value, Word};
use proc_macro2::TokenStream;
use quote::quote;

/// A number as the state word keeps it.
pub(super) fn initial(word: &Word, raw: i32) -> TokenStream {
    let literal = number(i64::from(raw));
    match Shape::of_state(word).constant(raw) {
        Some(constant) => stored(word, &constant),
        None if word.storage_bits == 16 => literal,
        None => quote!(Word(#literal)),
    }
}

/// How tightly an expression binds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Branch,
    Or,
    And,
    Compare,
    Shift,
    Sum,
    Product,
    Unary,
    Atom,
}

/// An expression and what it takes to embed it.
struct Expression {
    tokens: TokenStream,
    binding: Binding,
    /// A branch as a call of `select`, for use inside of other expressions.
    embedded: Option<TokenStream>,
}

impl Expression {
    fn new(tokens: TokenStream, binding: Binding) -> Self {
        Self {
            tokens,
            binding,
            embedded: None,
        }
    }

    fn atom(tokens: TokenStream) -> Self {
        Self::new(tokens, Binding::Atom)
    }

    /// The tokens inside an expression that binds its operands as tightly as `least`.
    fn within(self, least: Binding) -> TokenStream {
        let tokens = self.tokens;
        match self.embedded {
            Some(embedded) => embedded,
            None if self.binding < least => quote!((#tokens)),
            None => tokens,
        }
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

    /// A value as a complete expression: what a `let` binds or a branch yields.
    pub(super) fn whole(&self, value: Value) -> TokenStream {
        self.value(value).tokens
    }

    /// A value as a complete expression of the given shape.
    pub(super) fn shaped(&self, value: Value, shape: Shape) -> TokenStream {
        self.in_shape(value, shape).tokens
    }

    fn in_shape(&self, value: Value, shape: Shape) -> Expression {
        let named = |literal| shape.constant(literal);
        if let Some(constant) = self.literal(value).and_then(named) {
            return Expression::atom(constant);
        }
        if shape != Shape::Leg || self.context.shape(value) == Shape::Leg {
            return self.value(value);
        }
        let word = self.whole(value);
        Expression::atom(quote!(LegState::from_word(#word)))
    }

    /// A value as the state word keeps it.
    pub(super) fn kept(&self, word: &Word, value: Value) -> TokenStream {
        let shape = Shape::of_state(word);
        match self.literal(value) {
            Some(literal) => initial(word, literal),
            None => stored(word, &self.in_shape(value, shape).within(Binding::Atom)),
        }
    }

    /// What the `let` of a named value binds.
    pub(super) fn definition(&self, value: Value) -> TokenStream {
        self.operation(value).tokens
    }

    /// A value that a method is called on.
    pub(super) fn receiver(&self, value: Value) -> TokenStream {
        self.value(value).within(Binding::Atom)
    }

    /// The small number that a value is, if it is one.
    pub(super) fn literal(&self, value: Value) -> Option<i32> {
        match self.node(value).op {
            Op::Literal(literal) => Some(literal),
            _ => None,
        }
    }

    fn is_constant(&self, value: Value) -> bool {
        matches!(self.node(value).op, Op::Literal(_) | Op::Constant(_))
    }

    /// A value where it is used: its name, or what it stands for.
    fn value(&self, value: Value) -> Expression {
        let node = self.node(value);
        match node.op {
            Op::Constant(id) => {
                let name = screaming(&self.context.program.constants[id.index()].name);
                Expression::atom(quote!(#name))
            }
            Op::Literal(literal) => {
                let literal = number(i64::from(literal));
                Expression::atom(quote!(Word(#literal)))
            }
            Op::State(id) if self.reads_state => {
                let word = &self.context.program.states[id.index()];
                let field = snake(&word.name);
                Expression::atom(loaded(word, &quote!(state.#field)))
            }
            _ if node.name.is_empty() => self.operation(value),
            _ => {
                let name = snake(&node.name);
                Expression::atom(quote!(#name))
            }
        }
    }

    /// A right operand of an operator of `Word`, where a small number needs no wrapping.
    fn right(&self, value: Value, least: Binding) -> TokenStream {
        match self.literal(value) {
            Some(literal) => number(i64::from(literal)),
            None => self.value(value).within(least),
        }
    }

    fn operation(&self, value: Value) -> Expression {
        match self.node(value).op {
            Op::Input(_) | Op::Param(_) | Op::State(_) | Op::Constant(_) | Op::Literal(_) => {
                self.value(value)
            }
            // A join is bound where its stage is called.
            Op::Join { taken, .. } => self.value(taken),
            Op::Add(a, b) => self.sum(a, b),
            Op::AngleAdd(a, b) => self.binary(a, &quote!(+), b, Binding::Sum),
            Op::Sub(a, b) | Op::AngleSub(a, b) => self.binary(a, &quote!(-), b, Binding::Sum),
            Op::Neg(a) => {
                let a = self.value(a).within(Binding::Atom);
                Expression::new(quote!(-#a), Binding::Unary)
            }
            Op::Abs(a) => {
                let a = self.receiver(a);
                Expression::atom(quote!(#a.abs()))
            }
            Op::Product(a, b) | Op::MulFloor { a, b, shift: 0 } => self.product(a, b),
            Op::MulRound {
                coefficient,
                signal,
                shift,
            } => {
                let name = if self.rounds_narrow(coefficient, signal, shift) {
                    quote!(mul_round_narrow)
                } else {
                    quote!(mul_round)
                };
                self.call(&quote!(#name), &[coefficient, signal], Some(shift))
            }
            Op::MulFloor { a, b, shift } => {
                if fits_word(self.products(a, b)) {
                    let product = self.product(a, b).tokens;
                    let shift = number(i64::from(shift));
                    Expression::new(quote!((#product) >> #shift), Binding::Shift)
                } else {
                    self.call(&quote!(mul_floor), &[a, b], Some(shift))
                }
            }
            Op::MulLimited { a, b, limit } => {
                if fits_word(self.products(a, b)) {
                    let product = self.product(a, b).tokens;
                    let limit = self.right(limit, Binding::Branch);
                    Expression::atom(quote!((#product).min(#limit)))
                } else {
                    self.call(&quote!(mul_limited), &[a, b, limit], None)
                }
            }
            Op::ShiftLeft(a, bits) => self.shift(a, &quote!(<<), bits),
            Op::ShiftRight(a, bits) => self.shift(a, &quote!(>>), bits),
            Op::Min(a, b) => self.extreme(a, &quote!(min), b),
            Op::Max(a, b) => self.extreme(a, &quote!(max), b),
            Op::Clamp { x, low, high } => {
                let x = self.receiver(x);
                let low = self.right(low, Binding::Branch);
                let high = self.right(high, Binding::Branch);
                Expression::atom(quote!(#x.clamp(#low, #high)))
            }
            Op::Divide {
                numerator,
                shift,
                denominator,
                limit,
            } => {
                let narrow = self.interval(numerator).high << shift <= i64::from(u32::MAX);
                let name = if narrow {
                    quote!(divide_narrow)
                } else {
                    quote!(divide)
                };
                self.call(&name, &[numerator, denominator, limit], Some(shift))
            }
            Op::TurnOver(a) => self.call(&quote!(turn_over), &[a], None),
            Op::AngleIndex { angle, segments } => {
                self.call(&quote!(angle_index), &[angle], Some(segments))
            }
            Op::AngleFraction { angle, segments } => {
                self.call(&quote!(angle_fraction), &[angle], Some(segments))
            }
            Op::Lookup { table, index } => {
                let table = screaming(&self.context.program.tables[table.index()].name);
                let index = self.value(index).within(Binding::Branch);
                Expression::atom(quote!(lookup(&#table, #index)))
            }
            Op::Compare(how, a, b) => self.comparison(how, a, b),
            Op::And(a, b) => self.logic(a, &quote!(&&), b, Binding::And),
            Op::Or(a, b) => self.logic(a, &quote!(||), b, Binding::Or),
            Op::Not(a) => self.negation(a),
            Op::Select {
                condition,
                then,
                otherwise,
            } => self.select(self.context.shape(value), condition, then, otherwise),
        }
    }

    /// Left-associative operator of words.
    fn binary(&self, a: Value, operator: &TokenStream, b: Value, binding: Binding) -> Expression {
        // Shifts under sums get parentheses from their binding; what stands right binds tighter.
        let a = self.value(a).within(binding);
        let b = self.right(
            b,
            if binding == Binding::Sum {
                Binding::Product
            } else {
                Binding::Unary
            },
        );
        Expression::new(quote!(#a #operator #b), binding)
    }

    fn sum(&self, a: Value, b: Value) -> Expression {
        match self.literal(b) {
            Some(literal) if literal < 0 => {
                let a = self.value(a).within(Binding::Sum);
                let literal = number(-i64::from(literal));
                Expression::new(quote!(#a - #literal), Binding::Sum)
            }
            _ if self.literal(a).is_some() => self.binary(b, &quote!(+), a, Binding::Sum),
            _ => self.binary(a, &quote!(+), b, Binding::Sum),
        }
    }

    fn product(&self, a: Value, b: Value) -> Expression {
        let (a, b) = if self.literal(a).is_some() {
            (b, a)
        } else {
            (a, b)
        };
        self.binary(a, &quote!(*), b, Binding::Product)
    }

    fn shift(&self, a: Value, operator: &TokenStream, bits: u32) -> Expression {
        if bits == 0 {
            return self.value(a);
        }
        let a = self.value(a).within(Binding::Unary);
        let bits = number(i64::from(bits));
        Expression::new(quote!(#a #operator #bits), Binding::Shift)
    }

    fn extreme(&self, a: Value, method: &TokenStream, b: Value) -> Expression {
        let (a, b) = if self.is_constant(a) { (b, a) } else { (a, b) };
        let a = self.receiver(a);
        let b = self.right(b, Binding::Branch);
        Expression::atom(quote!(#a.#method(#b)))
    }

    /// A call; `parameter` is the shift or the number of segments.
    fn call(&self, name: &TokenStream, arguments: &[Value], parameter: Option<u32>) -> Expression {
        let arguments = arguments
            .iter()
            .map(|&argument| self.value(argument).within(Binding::Branch))
            .chain(parameter.map(|parameter| number(i64::from(parameter))));
        Expression::atom(quote!(#name(#(#arguments),*)))
    }

    /// The signal stands left, what it is compared with right.
    fn comparison(&self, how: Comparison, a: Value, b: Value) -> Expression {
        let turned = self.is_constant(a) && !self.is_constant(b);
        let (left, right) = if turned { (b, a) } else { (a, b) };
        let operator = match (how, turned) {
            (Comparison::Equal, _) => quote!(==),
            (Comparison::NotEqual, _) => quote!(!=),
            (Comparison::Less, false) => quote!(<),
            (Comparison::Less, true) => quote!(>),
            (Comparison::LessEqual, false) => quote!(<=),
            (Comparison::LessEqual, true) => quote!(>=),
        };
        let named = |literal| self.context.shape(left).constant(literal);
        let right = match self.literal(right).and_then(named) {
            Some(constant) => constant,
            None => self.right(right, Binding::Sum),
        };
        let left = self.value(left).within(Binding::Sum);
        Expression::new(quote!(#left #operator #right), Binding::Compare)
    }

    fn logic(&self, a: Value, operator: &TokenStream, b: Value, binding: Binding) -> Expression {
        let a = self.value(a).within(binding);
        let b = self.value(b).within(binding);
        Expression::new(quote!(#a #operator #b), binding)
    }

    /// The opposite comparison rather than `!` before a comparison.
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
            _ => {
                let a = self.value(a).within(Binding::Unary);
                Expression::new(quote!(!#a), Binding::Unary)
            }
        }
    }

    fn select(&self, shape: Shape, condition: Value, then: Value, otherwise: Value) -> Expression {
        if shape == Shape::Word
            && self.literal(then) == Some(1)
            && self.literal(otherwise) == Some(0)
        {
            return self.call(&quote!(Word::from), &[condition], None);
        }
        let condition = self.value(condition).within(Binding::Branch);
        let embed = |value: Value| self.in_shape(value, shape).within(Binding::Branch);
        let (then_embedded, otherwise_embedded) = (embed(then), embed(otherwise));
        let then = self.shaped(then, shape);
        let rest = self.in_shape(otherwise, shape);
        let chains = rest.binding == Binding::Branch;
        let otherwise = rest.tokens;
        let otherwise = if chains {
            otherwise
        } else {
            quote!({ #otherwise })
        };
        Expression {
            tokens: quote!(if #condition { #then } else #otherwise),
            binding: Binding::Branch,
            embedded: Some(quote!(select(#condition, #then_embedded, #otherwise_embedded))),
        }
    }

    /// Every product of the two.
    fn products(&self, a: Value, b: Value) -> Interval {
        let (a, b) = (self.interval(a), self.interval(b));
        let all = [
            a.low * b.low,
            a.low * b.high,
            a.high * b.low,
            a.high * b.high,
        ];
        Interval::new(
            all.into_iter().fold(i64::MAX, i64::min),
            all.into_iter().fold(i64::MIN, i64::max),
        )
    }

    fn rounds_narrow(&self, a: Value, b: Value, shift: u32) -> bool {
        let products = self.products(a, b);
        shift <= 30
            && fits_word(products)
            && fits_word(Interval::point(products.high + (1 << (shift - 1))))
    }
}

fn fits_word(interval: Interval) -> bool {
    Interval::WORD.contains(interval)
}
