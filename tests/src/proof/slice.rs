//! Values of a program along a path, from given ones.

use super::linear::Linear;
use super::paths::{Contradiction, Path};
use hexagen_codegen::ir::{Comparison, Function, Op, Program, Value};
use std::collections::HashMap;

/// A word as a linear form, or a flag decided by the path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Symbol {
    /// A word.
    Word(Linear),
    /// A flag.
    Flag(bool),
    /// An undecided flag: whether the form is negative. Only given, never computed.
    Sign(Linear),
}

impl Symbol {
    /// The word.
    ///
    /// # Panics
    /// For a flag.
    pub fn word(self) -> Linear {
        match self {
            Self::Word(word) => word,
            Self::Flag(_) | Self::Sign(_) => panic!("a flag where a word belongs"),
        }
    }

    /// The flag.
    ///
    /// # Panics
    /// For a word, and for an undecided flag.
    pub fn flag(self) -> bool {
        match self {
            Self::Flag(flag) => flag,
            Self::Word(_) | Self::Sign(_) => panic!("no flag, or one that nobody has decided"),
        }
    }
}

/// A program's step with the given values: nodes, constants and set-point words by name.
#[derive(Clone, Debug)]
pub struct Slice<'p> {
    program: &'p Program,
    given: HashMap<&'p str, Symbol>,
    known: HashMap<usize, Symbol>,
}

impl<'p> Slice<'p> {
    /// The step of a program, without given values.
    pub fn new(program: &'p Program) -> Self {
        Self {
            program,
            given: HashMap::new(),
            known: HashMap::new(),
        }
    }

    /// Gives the value of this name.
    pub fn give(&mut self, name: &'p str, value: Symbol) {
        self.given.insert(name, value);
    }

    /// The value of this name.
    ///
    /// # Errors
    /// If the path ends.
    ///
    /// # Panics
    /// If there is none, or it depends on something that is not given and that no proof can use:
    /// inputs, states, angles.
    pub fn named(&mut self, name: &str, path: &mut Path) -> Result<Symbol, Contradiction> {
        let mut nodes = self.program.step.nodes.iter();
        let node = nodes.position(|node| node.name == name);
        self.node(node.unwrap_or_else(|| panic!("no value {name}")), path)
    }

    fn step(&self) -> &'p Function {
        &self.program.step
    }

    fn node(&mut self, index: usize, path: &mut Path) -> Result<Symbol, Contradiction> {
        if let Some(known) = self.known.get(&index) {
            return Ok(known.clone());
        }
        let node = &self.step().nodes[index];
        let value = match self.given.get(node.name.as_str()) {
            Some(Symbol::Sign(form)) => Symbol::Flag(path.is_negative(form)?),
            Some(given) if !node.name.is_empty() => given.clone(),
            _ => match node.op {
                Op::Join { taken, otherwise } => {
                    let taken_here = self.flag(self.guard(index), path)?;
                    let chosen = if taken_here { taken } else { otherwise };
                    self.node(chosen.index(), path)?
                }
                op => self.compute(op, path)?,
            },
        };
        self.known.insert(index, value.clone());
        Ok(value)
    }

    /// The condition of the stage with this join as result.
    fn guard(&self, join: usize) -> Value {
        let guards = self.step().stages.iter();
        let mut guards = guards.filter_map(|stage| stage.guard.as_ref());
        let guard = guards.find(|guard| guard.joins.iter().any(|value| value.index() == join));
        guard.expect("the guard of a join").condition
    }

    fn word(&mut self, value: Value, path: &mut Path) -> Result<Linear, Contradiction> {
        Ok(self.node(value.index(), path)?.word())
    }

    fn flag(&mut self, value: Value, path: &mut Path) -> Result<bool, Contradiction> {
        Ok(self.node(value.index(), path)?.flag())
    }

    fn compute(&mut self, op: Op, path: &mut Path) -> Result<Symbol, Contradiction> {
        let word = match op {
            Op::Literal(number) => Linear::number(i64::from(number)),
            Op::Constant(id) => {
                let constant = &self.program.constants[id.index()];
                match self.given.get(constant.name.as_str()) {
                    Some(given) => given.clone().word(),
                    None => Linear::number(i64::from(constant.raw)),
                }
            }
            Op::Add(a, b) => &self.word(a, path)? + &self.word(b, path)?,
            Op::Sub(a, b) => &self.word(a, path)? - &self.word(b, path)?,
            Op::Neg(a) => -&self.word(a, path)?,
            Op::Abs(a) => {
                let a = self.word(a, path)?;
                if path.is_negative(&a)? { -&a } else { a }
            }
            Op::Product(a, b) => {
                let (a, b) = (self.word(a, path)?, self.word(b, path)?);
                match (a.as_number(), b.as_number()) {
                    (Some(factor), _) => b.times(factor),
                    (_, Some(factor)) => a.times(factor),
                    _ => path.product(&a, &b, 0),
                }
            }
            Op::MulFloor { a, b, shift } => {
                let (a, shift) = self.unshifted(a, shift);
                let (a, b) = (self.word(a, path)?, self.word(b, path)?);
                path.product(&a, &b, shift)
            }
            Op::MulAddFloor {
                first: [a, b],
                second: [c, d],
                shift,
            } => {
                let (part, rest) = self.unshifted(a, shift);
                let (other, same) = self.unshifted(c, shift);
                let (a, c, shift) = if rest == same {
                    (part, other, rest)
                } else {
                    (a, c, shift)
                };
                let [a, b, c, d] = [a, b, c, d].map(|factor| self.word(factor, path));
                path.sum_of_products([[&a?, &b?], [&c?, &d?]], shift)
            }
            // Another function of the same factors.
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
                let (a, b) = (self.word(coefficient, path)?, self.word(signal, path)?);
                path.product(&a, &b, u32::BITS * 2 + shift)
            }
            Op::ShiftLeft(a, bits) => self.word(a, path)?.times(1 << bits),
            Op::ShiftRight(a, bits) => {
                let a = self.word(a, path)?;
                path.floored(&a, bits)?
            }
            Op::Min(a, b) | Op::Lesser(a, b) => {
                let words = [self.word(a, path)?, self.word(b, path)?];
                bounded(words, false, path)?
            }
            Op::Max(a, b) | Op::Greater(a, b) => {
                let words = [self.word(a, path)?, self.word(b, path)?];
                bounded(words, true, path)?
            }
            Op::Clamp { x, low, high } => {
                let words = [self.word(x, path)?, self.word(low, path)?];
                let raised = bounded(words, true, path)?;
                let high = self.word(high, path)?;
                bounded([raised, high], false, path)?
            }
            Op::Lookup { table, index, .. } => {
                let index = self.word(index, path)?.as_number();
                let index = index.expect("an index that the path decides");
                Linear::number(self.program.tables[table.index()].entry(index))
            }
            Op::Select {
                condition,
                then,
                otherwise,
            } => {
                let taken = self.flag(condition, path)?;
                return self.node(if taken { then } else { otherwise }.index(), path);
            }
            Op::Compare(how, a, b) => return self.compare(how, [a, b], path).map(Symbol::Flag),
            Op::And(a, b) => {
                return Ok(Symbol::Flag(self.flag(a, path)? && self.flag(b, path)?));
            }
            Op::Or(a, b) => {
                return Ok(Symbol::Flag(self.flag(a, path)? || self.flag(b, path)?));
            }
            Op::Not(a) => return Ok(Symbol::Flag(!self.flag(a, path)?)),
            Op::FlagWord(flag) => Linear::number(i64::from(self.flag(flag, path)?)),
            Op::Exceeds(a, limit) => {
                let (a, limit) = (self.word(a, path)?, self.word(limit, path)?);
                let is_beyond =
                    path.is_negative(&(&limit - &a))? || path.is_negative(&(&limit + &a))?;
                return Ok(Symbol::Flag(is_beyond));
            }
            Op::Input(_)
            | Op::Param(_)
            | Op::State(_)
            | Op::MulLimited { .. }
            | Op::ShiftRound(..)
            | Op::Remainder(..)
            | Op::Divide { .. }
            | Op::DivideNarrow { .. }
            | Op::TurnOver(_)
            | Op::AngleAdd(..)
            | Op::AngleSub(..)
            | Op::AngleIndex { .. }
            | Op::AngleFraction { .. }
            | Op::Join { .. } => panic!("{op:?} is no part of a slice"),
        };
        Ok(Symbol::Word(word))
    }

    /// The operand of a factor's shift, and the shift left for its product: floor(2^n x y / 2^s) is
    /// floor(x y / 2^(s - n)).
    fn unshifted(&self, factor: Value, shift: u32) -> (Value, u32) {
        match self.step().node(factor).op {
            Op::ShiftLeft(whole, bits) if bits <= shift => (whole, shift - bits),
            _ => (factor, shift),
        }
    }

    fn compare(
        &mut self,
        how: Comparison,
        [a, b]: [Value; 2],
        path: &mut Path,
    ) -> Result<bool, Contradiction> {
        let difference = &self.word(a, path)? - &self.word(b, path)?;
        let opposite = -&difference;
        Ok(match how {
            Comparison::Less => path.is_negative(&difference)?,
            Comparison::LessEqual => !path.is_negative(&opposite)?,
            Comparison::Equal => !path.is_negative(&difference)? && !path.is_negative(&opposite)?,
            Comparison::NotEqual => {
                path.is_negative(&difference)? || path.is_negative(&opposite)?
            }
        })
    }
}

/// The minimum or maximum of two words.
fn bounded([a, b]: [Linear; 2], greater: bool, path: &mut Path) -> Result<Linear, Contradiction> {
    let is_less = path.is_negative(&(&a - &b))?;
    Ok(if is_less == greater { b } else { a })
}
