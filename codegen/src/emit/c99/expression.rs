//! Expressions as C, with the parentheses for grammar, compiler warnings and readers.

use super::super::expression::{Expression, Operator, Primitive, Scope};
use super::super::signal::{Leg, Shape};
use super::names::{Names, number};
use crate::ir::{Program, Table, Value, Word};

/// Values as C, at a place.
#[derive(Clone, Copy)]
pub(super) struct Printer<'a> {
    /// The place.
    pub scope: Scope<'a>,
    /// Names.
    pub names: &'a Names,
}

impl Printer<'_> {
    /// A value as a complete expression.
    pub(super) fn whole(&self, value: Value) -> String {
        self.written(&self.scope.value(value)).text
    }

    /// A value as a complete expression of the given shape.
    pub(super) fn shaped(&self, value: Value, shape: Shape) -> String {
        self.written(&self.scope.in_shape(value, shape)).text
    }

    /// The expression that a named value is bound to.
    pub(super) fn bound(&self, value: Value) -> String {
        self.written(&self.scope.definition(value)).text
    }

    /// A flag before `?`.
    pub(super) fn condition(&self, value: Value) -> String {
        self.written(&self.scope.value(value))
            .within(Binding::Unary)
    }

    /// A value after `?` or `:`.
    pub(super) fn arm(&self, value: Value, shape: Shape) -> String {
        let value = self.written(&self.scope.in_shape(value, shape));
        value.within(Binding::Or)
    }

    /// A value cast to a type.
    pub(super) fn cast(&self, kind: &str, value: Value) -> String {
        let value = self
            .written(&self.scope.value(value))
            .within(Binding::Unary);
        format!("({kind}){value}")
    }

    /// A value in a state word's storage type.
    pub(super) fn kept(&self, word: &Word, value: Value) -> String {
        let value = self.written(&self.scope.value(value));
        if word.storage_bits == 16 && !value.is_literal {
            format!("(uint16_t){}", value.within(Binding::Unary))
        } else {
            value.text
        }
    }

    fn program(&self) -> &Program {
        self.scope.context.program
    }

    fn written(&self, expression: &Expression) -> Written {
        let of = |expression: &Expression| self.written(expression);
        match expression {
            Expression::Signal(name) => Written::atom(self.names.local(name)),
            Expression::State(id) => {
                let word = &self.program().states[id.index()];
                Written {
                    is_narrow: word.storage_bits == 16,
                    ..Written::atom(format!("state->{}", self.names.local(&word.name)))
                }
            }
            Expression::Constant(id) => {
                let name = &self.program().constants[id.index()].name;
                Written::atom(self.names.constant(name))
            }
            Expression::Number(raw) => literal(*raw),
            Expression::Leg(leg) => Written::atom(leg_state(*leg).to_owned()),
            Expression::Negated(a) => {
                let a = of(a).operand(Binding::Atom);
                Written::new(format!("-{a}"), Binding::Unary)
            }
            Expression::Not(a) => {
                let a = of(a).within(Binding::Unary);
                Written::new(format!("!{a}"), Binding::Unary)
            }
            Expression::Binary(operator, a, b) => binary(*operator, of(a), of(b)),
            Expression::ShiftedLeft(a, bits) => shift("hexagen_shift_left", of(a).text, *bits),
            Expression::ShiftedRight(a, bits) => shift("hexagen_shift_right", of(a).text, *bits),
            Expression::Call(primitive, operands, parameter) => {
                let operands = operands.iter().map(|operand| of(operand).text);
                let parameter = parameter.map(|parameter| parameter.to_string());
                let arguments: Vec<String> = operands.chain(parameter).collect();
                Written::atom(format!("{}({})", called(*primitive), arguments.join(", ")))
            }
            Expression::Lookup(table, index, is_masked) => {
                let table = &self.program().tables[table.index()];
                let name = self.names.constant(&table.name);
                let index = of(index);
                let text = if *is_masked {
                    let index = index.within(Binding::Unary);
                    format!("{name}[(uint32_t){index} & {}U]", table.values.len() - 1)
                } else {
                    format!("{name}[{}]", index.text)
                };
                if table.holds_legs {
                    return Written::atom(format!("hexagen_leg_of({text})"));
                }
                Written {
                    is_narrow: element(table) == "int16_t",
                    ..Written::atom(text)
                }
            }
            Expression::FlagWord(flag) => {
                let flag = of(flag).within(Binding::Unary);
                Written::new(format!("{flag} ? 1 : 0"), Binding::Choice)
            }
            Expression::LegOf(word) => Written::atom(format!("hexagen_leg_of({})", of(word).text)),
            Expression::Choice(parts) => {
                let [condition, then, otherwise] = &**parts;
                let condition = of(condition).within(Binding::Unary);
                let then = of(then).within(Binding::Or);
                let otherwise = of(otherwise).text;
                Written::new(
                    format!("{condition} ? {then} : {otherwise}"),
                    Binding::Choice,
                )
            }
        }
    }
}

/// Type of a table's elements.
pub(super) fn element(table: &Table) -> &'static str {
    match table.interval().bits() {
        ..=16 => "int16_t",
        _ => "int32_t",
    }
}

/// How tightly an expression binds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Choice,
    Or,
    And,
    Compare,
    Sum,
    Product,
    Unary,
    Atom,
}

/// A text with its binding strength.
struct Written {
    text: String,
    binding: Binding,
    /// Whether its type may be narrower than a word.
    is_narrow: bool,
    /// Whether it is a literal.
    is_literal: bool,
}

impl Written {
    fn new(text: String, binding: Binding) -> Self {
        Self {
            text,
            binding,
            is_narrow: false,
            is_literal: false,
        }
    }

    fn atom(text: String) -> Self {
        Self::new(text, Binding::Atom)
    }

    /// The text inside an expression that binds its operands as tightly as `least`.
    fn within(self, least: Binding) -> String {
        if self.binding < least {
            format!("({})", self.text)
        } else {
            self.text
        }
    }

    /// As [`Self::within`], as an operand of word arithmetic.
    fn operand(self, least: Binding) -> String {
        if self.is_narrow {
            let cast = format!("(int32_t){}", self.within(Binding::Unary));
            Self::new(cast, Binding::Unary).within(least)
        } else {
            self.within(least)
        }
    }
}

fn literal(raw: i32) -> Written {
    let binding = if raw < 0 && raw > i32::MIN {
        Binding::Unary
    } else {
        Binding::Atom
    };
    Written {
        is_literal: true,
        ..Written::new(number(raw), binding)
    }
}

fn binary(operator: Operator, a: Written, b: Written) -> Written {
    let sign = match operator {
        Operator::AngleAdd => return wrapping("hexagen_angle_add", &a, &b),
        Operator::AngleSub => return wrapping("hexagen_angle_sub", &a, &b),
        Operator::Add => "+",
        Operator::Sub => "-",
        Operator::Mul => "*",
        Operator::Less => "<",
        Operator::LessEqual => "<=",
        Operator::Greater => ">",
        Operator::GreaterEqual => ">=",
        Operator::Equal => "==",
        Operator::NotEqual => "!=",
        Operator::And => "&&",
        Operator::Or => "||",
    };
    let (binding, a, b) = match operator {
        Operator::Add | Operator::Sub => (
            Binding::Sum,
            a.operand(Binding::Sum),
            b.operand(Binding::Product),
        ),
        Operator::Mul => (
            Binding::Product,
            a.operand(Binding::Product),
            b.operand(Binding::Unary),
        ),
        Operator::And => (Binding::And, a.within(Binding::And), b.within(Binding::And)),
        // Compilers warn of `&&` within `||` without parentheses.
        Operator::Or => {
            let under = |flag: Written| match flag.binding {
                Binding::And => format!("({})", flag.text),
                _ => flag.within(Binding::Or),
            };
            (Binding::Or, under(a), under(b))
        }
        _ => (
            Binding::Compare,
            a.within(Binding::Sum),
            b.within(Binding::Sum),
        ),
    };
    Written::new(format!("{a} {sign} {b}"), binding)
}

fn wrapping(name: &str, a: &Written, b: &Written) -> Written {
    Written::atom(format!("{name}({}, {})", a.text, b.text))
}

/// A shift, split in two if it is as wide as the word.
fn shift(name: &str, text: String, bits: u32) -> Written {
    let inner = bits.saturating_sub(30);
    let text = match inner {
        0 => text,
        _ => format!("{name}({text}, {inner})"),
    };
    Written::atom(format!("{name}({text}, {})", bits - inner))
}

fn called(primitive: Primitive) -> &'static str {
    match primitive {
        Primitive::Abs => "hexagen_abs",
        Primitive::Exceeds => "hexagen_exceeds",
        Primitive::Min | Primitive::Lesser => "hexagen_min",
        Primitive::Max | Primitive::Greater => "hexagen_max",
        Primitive::Clamp => "hexagen_clamp",
        Primitive::MulRound => "hexagen_mul_round",
        Primitive::MulRoundNarrow => "hexagen_mul_round_narrow",
        Primitive::MulFloor => "hexagen_mul_floor",
        Primitive::MulAddFloor => "hexagen_mul_add_floor",
        Primitive::MulLimited => "hexagen_mul_limited",
        Primitive::Divide => "hexagen_divide",
        Primitive::DivideNarrow => "hexagen_divide_narrow",
        Primitive::Remainder => "hexagen_remainder",
        Primitive::TurnOver => "hexagen_turn_over",
        Primitive::AngleIndex => "hexagen_angle_index",
        Primitive::AngleFraction => "hexagen_angle_fraction",
    }
}

/// The state of a leg by its name.
pub(super) fn leg_state(leg: Leg) -> &'static str {
    match leg {
        Leg::Pulsed => "HEXAGEN_LEG_PULSED",
        Leg::Low => "HEXAGEN_LEG_LOW",
        Leg::Off => "HEXAGEN_LEG_OFF",
    }
}
