//! Expressions as Rust, with the parentheses for grammar and readers.

use super::super::expression::{Expression, Operator, Primitive, Scope};
use super::super::signal::Shape;
use super::names::{leg_state, loaded, number, screaming, snake, stored};
use super::source::{Source, quote};
use super::tables::look_up;
use crate::ir::{Program, Value, Word};

/// Values as Rust, at a place.
pub(super) trait RustScope {
    /// A value as a complete expression.
    fn whole(&self, value: Value) -> Source;
    /// A value as a complete expression of the given shape.
    fn shaped(&self, value: Value, shape: Shape) -> Source;
    /// A value in a state word's storage type.
    fn kept(&self, word: &Word, value: Value) -> Source;
    /// The expression that the `let` of a named value binds.
    fn bound(&self, value: Value) -> Source;
    /// A value as the receiver of a method.
    fn receiver(&self, value: Value) -> Source;
}

impl RustScope for Scope<'_> {
    fn whole(&self, value: Value) -> Source {
        written(self.context.program, &self.value(value)).tokens
    }

    fn shaped(&self, value: Value, shape: Shape) -> Source {
        written(self.context.program, &self.in_shape(value, shape)).tokens
    }

    fn kept(&self, word: &Word, value: Value) -> Source {
        if let Some(literal) = self.literal(value) {
            let literal = number(i64::from(literal));
            return if word.storage_bits == 16 {
                literal
            } else {
                quote!(Word(#literal))
            };
        }
        let value = written(self.context.program, &self.value(value));
        stored(word, &value.within(Binding::Atom))
    }

    fn bound(&self, value: Value) -> Source {
        written(self.context.program, &self.definition(value)).tokens
    }

    fn receiver(&self, value: Value) -> Source {
        written(self.context.program, &self.value(value)).within(Binding::Atom)
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

impl Binding {
    fn of(operator: Operator) -> Self {
        match operator {
            Operator::Add | Operator::Sub | Operator::AngleAdd | Operator::AngleSub => Self::Sum,
            Operator::Mul => Self::Product,
            Operator::And => Self::And,
            Operator::Or => Self::Or,
            _ => Self::Compare,
        }
    }

    /// Least binding of the left and the right operand.
    fn of_operands(self) -> [Self; 2] {
        match self {
            // Left associative: the right operand binds tighter.
            Self::Sum => [Self::Sum, Self::Product],
            Self::Product => [Self::Product, Self::Unary],
            Self::Compare => [Self::Sum; 2],
            other => [other; 2],
        }
    }
}

/// A text of tokens with its binding strength.
struct Written {
    tokens: Source,
    binding: Binding,
    /// A branch as a call of `select`, for use inside other expressions.
    embedded: Option<Source>,
}

impl Written {
    fn new(tokens: Source, binding: Binding) -> Self {
        Self {
            tokens,
            binding,
            embedded: None,
        }
    }

    fn atom(tokens: Source) -> Self {
        Self::new(tokens, Binding::Atom)
    }

    /// The tokens inside an expression that binds its operands as tightly as `least`.
    fn within(self, least: Binding) -> Source {
        let tokens = self.tokens;
        match self.embedded {
            Some(embedded) => embedded,
            None if self.binding < least => quote!((#tokens)),
            None => tokens,
        }
    }
}

fn written(program: &Program, expression: &Expression) -> Written {
    let of = |expression: &Expression| written(program, expression);
    match expression {
        Expression::Signal(name) => {
            let name = snake(name);
            Written::atom(quote!(#name))
        }
        Expression::State(id) => {
            let word = &program.states[id.index()];
            let field = snake(&word.name);
            Written::atom(loaded(word, &quote!(state.#field)))
        }
        Expression::Constant(id) => {
            let constant = &program.constants[id.index()];
            let raw = number(i64::from(constant.raw));
            Written::atom(match constant.name.as_str() {
                "" => quote!(Word(#raw)),
                name => screaming(name),
            })
        }
        Expression::Number(literal) => {
            let literal = number(i64::from(*literal));
            Written::atom(quote!(Word(#literal)))
        }
        Expression::Leg(leg) => Written::atom(leg_state(*leg)),
        Expression::Negated(a) => {
            let a = of(a).within(Binding::Atom);
            Written::new(quote!(-#a), Binding::Unary)
        }
        Expression::Not(a) => {
            let a = of(a).within(Binding::Unary);
            Written::new(quote!(!#a), Binding::Unary)
        }
        Expression::Binary(operator, a, b) => {
            let binding = Binding::of(*operator);
            let [left, right] = binding.of_operands();
            let a = of(a).within(left);
            let b = right_operand(program, b, right);
            let operator = sign(*operator);
            Written::new(quote!(#a #operator #b), binding)
        }
        Expression::ShiftedLeft(a, bits) => {
            shift(&of(a).within(Binding::Unary), &quote!(<<), *bits)
        }
        Expression::ShiftedRight(a, bits) => {
            shift(&of(a).within(Binding::Unary), &quote!(>>), *bits)
        }
        Expression::Call(primitive, operands, parameter) => {
            call(program, *primitive, operands, *parameter)
        }
        Expression::Lookup(table, index, _) => {
            let index = of(index).within(Binding::Branch);
            Written::atom(look_up(program, *table, &index))
        }
        Expression::FlagWord(flag) => {
            let flag = of(flag).within(Binding::Branch);
            Written::atom(quote!(Word::from(#flag)))
        }
        Expression::LegOf(word) => {
            let word = of(word).within(Binding::Atom);
            Written::atom(quote!(LegState::from_number(#word.0)))
        }
        Expression::Choice(parts) => {
            let [condition, then, otherwise] = &**parts;
            let arms = [then, otherwise];
            let nests = arms.iter().any(|arm| matches!(arm, Expression::Choice(_)));
            let written = choice(of(condition), of(then), of(otherwise));
            match written.embedded {
                // A nested call takes one line, nested branches seven.
                Some(selected) if nests && arms.iter().all(|arm| is_there(arm)) => {
                    Written::atom(selected)
                }
                embedded => Written {
                    embedded,
                    ..written
                },
            }
        }
    }
}

/// Whether only the choice itself is left to compute: a branch pays if it skips work.
fn is_there(expression: &Expression) -> bool {
    match expression {
        Expression::Signal(_)
        | Expression::State(_)
        | Expression::Constant(_)
        | Expression::Number(_)
        | Expression::Leg(_) => true,
        Expression::Negated(a) => is_there(a),
        Expression::Choice(parts) => {
            let [_, then, otherwise] = &**parts;
            is_there(then) && is_there(otherwise)
        }
        _ => false,
    }
}

fn sign(operator: Operator) -> Source {
    match operator {
        Operator::Add | Operator::AngleAdd => quote!(+),
        Operator::Sub | Operator::AngleSub => quote!(-),
        Operator::Mul => quote!(*),
        Operator::Less => quote!(<),
        Operator::LessEqual => quote!(<=),
        Operator::Greater => quote!(>),
        Operator::GreaterEqual => quote!(>=),
        Operator::Equal => quote!(==),
        Operator::NotEqual => quote!(!=),
        Operator::And => quote!(&&),
        Operator::Or => quote!(||),
    }
}

/// A right operand of an operator or method of `Word`, which takes small numbers unwrapped.
fn right_operand(program: &Program, expression: &Expression, least: Binding) -> Source {
    match expression {
        Expression::Number(literal) => number(i64::from(*literal)),
        other => written(program, other).within(least),
    }
}

fn shift(a: &Source, operator: &Source, bits: u32) -> Written {
    let bits = number(i64::from(bits));
    Written::new(quote!(#a #operator #bits), Binding::Shift)
}

/// A method of the word, or a function of `hexagen::arith`; `parameter` is its shift or its number
/// of segments.
fn call(
    program: &Program,
    primitive: Primitive,
    operands: &[Expression],
    parameter: Option<u32>,
) -> Written {
    let method = |name: Source| {
        let mut operands = operands.iter();
        let receiver = operands.next().map(|receiver| written(program, receiver));
        let receiver = receiver.map(|receiver| receiver.within(Binding::Atom));
        let rest = operands.map(|operand| right_operand(program, operand, Binding::Branch));
        Written::atom(quote!(#receiver.#name(#(#rest),*)))
    };
    let name = match primitive {
        Primitive::Abs => return method(quote!(abs)),
        Primitive::Exceeds => return method(quote!(exceeds)),
        Primitive::Min => return method(quote!(min)),
        Primitive::Max => return method(quote!(max)),
        Primitive::Lesser => return method(quote!(lesser)),
        Primitive::Greater => return method(quote!(greater)),
        Primitive::Clamp => return method(quote!(clamp)),
        Primitive::MulRound => quote!(mul_round),
        Primitive::MulRoundNarrow => quote!(mul_round_narrow),
        Primitive::MulFloor => quote!(mul_floor),
        Primitive::MulAddFloor => quote!(mul_add_floor),
        Primitive::MulLimited => quote!(mul_limited),
        Primitive::Divide => quote!(divide),
        Primitive::DivideNarrow => quote!(divide_narrow),
        Primitive::Remainder => quote!(remainder),
        Primitive::TurnOver => quote!(turn_over),
        Primitive::AngleIndex => quote!(angle_index),
        Primitive::AngleFraction => quote!(angle_fraction),
    };
    let operands = operands
        .iter()
        .map(|operand| written(program, operand).within(Binding::Branch))
        .chain(parameter.map(|parameter| number(i64::from(parameter))));
    Written::atom(quote!(#name(#(#operands),*)))
}

fn choice(condition: Written, then: Written, otherwise: Written) -> Written {
    let condition = condition.within(Binding::Branch);
    let (then_branch, otherwise_branch) = (then.tokens.clone(), otherwise.tokens.clone());
    let is_choice = otherwise.embedded.is_some();
    let otherwise_branch = if is_choice {
        otherwise_branch
    } else {
        quote!({ #otherwise_branch })
    };
    let [then, otherwise] = [then, otherwise].map(|arm| arm.within(Binding::Branch));
    Written {
        tokens: quote!(if #condition { #then_branch } else #otherwise_branch),
        binding: Binding::Branch,
        embedded: Some(quote!(select(#condition, #then, #otherwise))),
    }
}
