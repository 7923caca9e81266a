//! Every small fault of each kind in a program: a wrong bit in a constant or a table, a shift or a
//! rounding, operators and operands exchanged, a state word not updated. And the drives with
//! planted faults.

mod drives;
mod limits;

pub use drives::{DRIVES, LEAST_NOTICED};
pub use limits::wrong_limits;

use hexagen_codegen::ir::{
    Comparison, Function, Interval, Op, Program, Stage, Value, derived_interval,
};
use std::collections::HashMap;
use std::fmt::Write as _;

/// A fault: place, change, and the faulty program.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Stage and name of the value, or the name of the constant, table or word.
    pub place: String,
    /// The change, with a number if the place has several of the kind.
    pub what: String,
    /// The faulty program. Its intervals are opened to the whole word, so that only a wrong result
    /// (or one that leaves the word) reveals it.
    pub program: Program,
    change: Change,
}

impl Fault {
    /// Place and change.
    pub fn name(&self) -> String {
        format!("{}: {}", self.place, self.what)
    }

    /// The fault in `program`, its origin, with consistent intervals, as a generator would have
    /// made it.
    ///
    /// # Errors
    /// The value that leaves its word, or whose operator has no result, and so no interval.
    pub fn planted_in(&self, program: &Program) -> Result<Program, String> {
        let mut faulty = program.clone();
        self.change.apply(&mut faulty);
        for (number, function) in program.functions().enumerate() {
            for index in 0..function.nodes.len() {
                let held = faulty.functions().nth(number);
                let held = held.ok_or_else(|| format!("function {number}"))?;
                let derived = derived_interval(&faulty, held, index)
                    .filter(|&interval| Interval::WORD.contains(interval))
                    .ok_or_else(|| place(held, index))?;
                function_mut(&mut faulty, number).nodes[index].interval = derived;
            }
        }
        Ok(faulty)
    }
}

/// The step, or a setter behind it, in the order of [`Program::functions`].
fn function_mut(program: &mut Program, number: usize) -> &mut Function {
    match number {
        0 => &mut program.step,
        setter => &mut program.setters[setter - 1].1,
    }
}

/// All faults of the program, one at a time.
pub fn faults(program: &Program) -> impl Iterator<Item = Fault> + '_ {
    let mut open = program.clone();
    for node in &mut open.step.nodes {
        node.interval = Interval::WORD;
    }
    for node in open
        .setters
        .iter_mut()
        .flat_map(|(_, setter)| &mut setter.nodes)
    {
        node.interval = Interval::WORD;
    }
    let changes = constants(program)
        .chain(tables(program))
        .chain(words(program))
        .chain(tracking(program))
        .chain(nodes(program));
    let mut known: HashMap<(String, String), u32> = HashMap::new();
    changes.map(move |(place, mut what, change)| {
        let mut program = open.clone();
        change.apply(&mut program);
        // Unnamed values can share a place.
        let number = known.entry((place.clone(), what.clone())).or_insert(0);
        *number += 1;
        if *number > 1 {
            write!(what, " ({number})").expect("a string takes all");
        }
        Fault {
            place,
            what,
            program,
            change,
        }
    })
}

/// A change of a program.
#[derive(Clone, Copy, Debug)]
enum Change {
    Constant(usize, i32),
    Entry(usize, usize, i32),
    Initial(usize, i32),
    /// The state word keeps its old value: index in the list of new state.
    Forget(usize, Value),
    /// Function (0 the step, then the setters), node, operator.
    Op(usize, usize, Op),
    /// Number of tracking nodes.
    Tracking(usize),
}

impl Change {
    fn apply(self, program: &mut Program) {
        match self {
            Self::Constant(index, raw) => program.constants[index].raw = raw,
            Self::Entry(table, entry, value) => program.tables[table].values[entry] = value,
            Self::Initial(word, value) => program.states[word].initial = value,
            Self::Forget(index, old) => program.step.next_state[index].1 = old,
            Self::Op(function, node, op) => function_mut(program, function).nodes[node].op = op,
            Self::Tracking(nodes) => program.step.tracking = nodes,
        }
    }
}

type Found = (String, String, Change);

/// One more, one less, and a single wrong bit in the lower, middle and upper part.
fn wrong_words(raw: i32) -> Vec<(String, i32)> {
    let length = i32::BITS - raw.unsigned_abs().leading_zeros();
    let bits = [length / 3, length * 2 / 3, length.saturating_sub(1)];
    let mut wrong = vec![
        ("one more".to_owned(), raw.wrapping_add(1)),
        ("one less".to_owned(), raw.wrapping_sub(1)),
    ];
    for bit in bits {
        let flipped = raw ^ (1 << bit);
        if wrong.iter().all(|&(_, known)| known != flipped) {
            wrong.push((format!("bit {bit}"), flipped));
        }
    }
    wrong
}

/// The last state words tracked at rest are not updated.
fn tracking(program: &Program) -> impl Iterator<Item = Found> + '_ {
    let Function {
        stages,
        next_state,
        tracking,
        ..
    } = &program.step;
    let is_kept = |stage: &&Stage| {
        let tracked = stage.first..*tracking;
        let mut words = next_state.iter();
        words.any(|(_, value)| tracked.contains(&value.index()))
    };
    let last = stages.iter().rev().find(is_kept);
    last.into_iter().map(|stage| {
        let change = Change::Tracking(stage.first);
        (stage.name.clone(), "not tracked".to_owned(), change)
    })
}

fn constants(program: &Program) -> impl Iterator<Item = Found> + '_ {
    program
        .constants
        .iter()
        .enumerate()
        .flat_map(|(index, constant)| {
            wrong_words(constant.raw)
                .into_iter()
                .map(move |(what, raw)| (constant.name.clone(), what, Change::Constant(index, raw)))
        })
}

fn tables(program: &Program) -> impl Iterator<Item = Found> + '_ {
    program
        .tables
        .iter()
        .enumerate()
        .flat_map(move |(index, table)| {
            let entries = table.values.iter().enumerate();
            let read = entries.filter(move |&(entry, _)| is_read(program, index, entry));
            read.map(move |(entry, &value)| {
                let place = format!("{}[{entry}]", table.name);
                let change = Change::Entry(index, entry, value.wrapping_add(1));
                (place, "one more".to_owned(), change)
            })
        })
}

/// Whether a lookup's index can be that of the entry, by its proven interval: tables are padded.
fn is_read(program: &Program, table: usize, entry: usize) -> bool {
    program.functions().any(|function| {
        function.nodes.iter().any(|node| match node.op {
            Op::Lookup {
                table: id, index, ..
            } if id.index() == table => {
                let Interval { low, high } = function.node(index).interval;
                let length = program.tables[table].values.len() as i64;
                (entry as i64 - low).rem_euclid(length) <= high - low
            }
            _ => false,
        })
    })
}

fn words(program: &Program) -> impl Iterator<Item = Found> + '_ {
    let step = &program.step;
    let initial = program.states.iter().enumerate().map(|(index, word)| {
        let change = Change::Initial(index, word.initial.wrapping_add(1));
        (
            word.name.clone(),
            "initial value one more".to_owned(),
            change,
        )
    });
    let forgotten = step
        .next_state
        .iter()
        .enumerate()
        .filter_map(move |(index, (state, new))| {
            let old = step
                .nodes
                .iter()
                .position(|node| node.op == Op::State(*state))?;
            let old = value_of(step, old)?;
            let name = program.states[state.index()].name.clone();
            (old != *new).then(|| (name, "never changes".to_owned(), Change::Forget(index, old)))
        });
    initial.chain(forgotten)
}

/// The value that node `index` defines, found by its uses.
fn value_of(function: &Function, index: usize) -> Option<Value> {
    let operands = function.nodes.iter().flat_map(|node| node.op.operands());
    operands.into_iter().find(|value| value.index() == index)
}

fn nodes(program: &Program) -> impl Iterator<Item = Found> + '_ {
    program
        .functions()
        .enumerate()
        .flat_map(|(number, function)| {
            function
                .nodes
                .iter()
                .enumerate()
                .flat_map(move |(index, node)| {
                    let operators = wrong_operators(node.op)
                        .into_iter()
                        .map(|(what, op)| (what.to_owned(), op));
                    operators
                        .chain(wrong_literals(node.op))
                        .map(move |(what, op)| {
                            (place(function, index), what, Change::Op(number, index, op))
                        })
                })
        })
}

/// Stage and name of a value; an unnamed value has that of the next named one.
fn place(function: &Function, index: usize) -> String {
    let stage = function
        .stages
        .iter()
        .find(|stage| {
            let joins = stage.guard.as_ref().map_or(0, |guard| guard.joins.len());
            (stage.first..stage.end + joins).contains(&index)
        })
        .map_or("", |stage| stage.name.as_str());
    let node = &function.nodes[index];
    if !node.name.is_empty() {
        return format!("{stage}: {}", node.name);
    }
    let user = function.nodes[index..]
        .iter()
        .find(|node| !node.name.is_empty());
    format!(
        "{stage}: in {}",
        user.map_or("a result", |node| node.name.as_str())
    )
}

fn wrong_literals(op: Op) -> impl Iterator<Item = (String, Op)> {
    let literal = match op {
        Op::Literal(value) => Some(value),
        _ => None,
    };
    literal.into_iter().flat_map(|value| {
        [value.wrapping_add(1), value.wrapping_sub(1)]
            .map(|wrong| (format!("{wrong} for {value}"), Op::Literal(wrong)))
    })
}

/// Operators with one fault each, with its name.
fn wrong_operators(op: Op) -> Vec<(&'static str, Op)> {
    // The identity, for an operator left out.
    let same = |a: Value| Op::Max(a, a);
    match op {
        Op::Add(a, b) => vec![
            ("- for +", Op::Sub(a, b)),
            ("second term left out", same(a)),
        ],
        Op::Sub(a, b) => vec![
            ("+ for -", Op::Add(a, b)),
            ("operands swapped", Op::Sub(b, a)),
        ],
        Op::Neg(a) => vec![("sign lost", same(a))],
        Op::Abs(a) => vec![("magnitude lost", same(a)), ("sign wrong", Op::Neg(a))],
        Op::MulRound {
            coefficient,
            signal,
            shift,
        }
        | Op::MulRoundNarrow {
            coefficient,
            signal,
            shift,
        } => vec![
            (
                "shift one more",
                Op::MulRound {
                    coefficient,
                    signal,
                    shift: shift + 1,
                },
            ),
            (
                "shift one less",
                if shift > 1 {
                    Op::MulRound {
                        coefficient,
                        signal,
                        shift: shift - 1,
                    }
                } else {
                    Op::Product(coefficient, signal)
                },
            ),
            (
                "rounded down",
                Op::MulFloor {
                    a: coefficient,
                    b: signal,
                    shift,
                },
            ),
        ],
        Op::MulFloor { a, b, shift } => vec![
            (
                "shift one more",
                Op::MulFloor {
                    a,
                    b,
                    shift: shift + 1,
                },
            ),
            (
                "rounded half up",
                Op::MulRound {
                    coefficient: a,
                    signal: b,
                    shift,
                },
            ),
        ],
        Op::MulAddFloor {
            first: [a, b],
            second,
            shift,
        } => vec![
            (
                "shift one more",
                Op::MulAddFloor {
                    first: [a, b],
                    second,
                    shift: shift + 1,
                },
            ),
            ("term missing", Op::MulFloor { a, b, shift }),
        ],
        Op::MulLimited { a, b, limit } => vec![
            ("limit alone", same(limit)),
            ("factors added", Op::Add(a, b)),
        ],
        Op::ShiftLeft(a, n) => vec![
            ("shift one more", Op::ShiftLeft(a, n + 1)),
            ("shift one less", Op::ShiftLeft(a, n.saturating_sub(1))),
        ],
        Op::ShiftRight(a, n) => vec![
            ("shift one more", Op::ShiftRight(a, n + 1)),
            ("shift one less", Op::ShiftRight(a, n.saturating_sub(1))),
        ],
        Op::ShiftRound(a, n) => vec![
            ("rounded down", Op::ShiftRight(a, n)),
            ("shift one more", Op::ShiftRound(a, n + 1)),
        ],
        Op::Remainder(a, n) => vec![("one bit more", Op::Remainder(a, n + 1))],
        Op::Min(a, b) | Op::Lesser(a, b) => {
            vec![("max for min", Op::Max(a, b)), ("limit left out", same(a))]
        }
        Op::Max(a, b) | Op::Greater(a, b) => {
            vec![("min for max", Op::Min(a, b)), ("limit left out", same(a))]
        }
        Op::Clamp { x, low, high } => vec![
            ("lower limit left out", Op::Min(x, high)),
            ("upper limit left out", Op::Max(x, low)),
        ],
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
        } => vec![
            (
                "shift one more",
                Op::Divide {
                    numerator,
                    shift: shift + 1,
                    denominator,
                    limit,
                },
            ),
            (
                "shift one less",
                Op::Divide {
                    numerator,
                    shift: shift.saturating_sub(1),
                    denominator,
                    limit,
                },
            ),
        ],
        Op::AngleAdd(a, b) => vec![("- for +", Op::AngleSub(a, b))],
        Op::AngleSub(a, b) => vec![
            ("+ for -", Op::AngleAdd(a, b)),
            ("operands swapped", Op::AngleSub(b, a)),
        ],
        Op::AngleIndex { angle, segments } => vec![(
            "a segment more",
            Op::AngleIndex {
                angle,
                segments: segments + 1,
            },
        )],
        Op::AngleFraction { angle, segments } => vec![(
            "a segment more",
            Op::AngleFraction {
                angle,
                segments: segments + 1,
            },
        )],
        Op::Compare(how, a, b) => {
            let wrong = match how {
                Comparison::Less => Comparison::LessEqual,
                Comparison::LessEqual => Comparison::Less,
                Comparison::Equal => Comparison::NotEqual,
                Comparison::NotEqual => Comparison::Equal,
            };
            let mut faults = vec![("another comparison", Op::Compare(wrong, a, b))];
            if matches!(how, Comparison::Less | Comparison::LessEqual) {
                faults.push(("operands swapped", Op::Compare(how, b, a)));
            }
            faults
        }
        Op::And(a, b) => vec![
            ("or for and", Op::Or(a, b)),
            ("second left out", Op::And(a, a)),
        ],
        Op::Or(a, b) => vec![
            ("and for or", Op::And(a, b)),
            ("second left out", Op::And(a, a)),
        ],
        Op::Exceeds(a, limit) => vec![
            ("sign looked at", Op::Compare(Comparison::Less, limit, a)),
            ("never", Op::Exceeds(limit, limit)),
        ],
        Op::Not(a) => vec![("not left out", Op::And(a, a))],
        Op::FlagWord(_) => vec![("always", Op::Literal(1)), ("never", Op::Literal(0))],
        Op::Select {
            condition,
            then,
            otherwise,
        } => vec![(
            "branches swapped",
            Op::Select {
                condition,
                then: otherwise,
                otherwise: then,
            },
        )],
        Op::Join { taken, otherwise } => vec![(
            "branches swapped",
            Op::Join {
                taken: otherwise,
                otherwise: taken,
            },
        )],
        Op::Product(a, b) => vec![("sum for product", Op::Add(a, b))],
        // Literals have faults of their own.
        Op::Literal(_)
        | Op::Input(_)
        | Op::Param(_)
        | Op::State(_)
        | Op::Constant(_)
        | Op::TurnOver(_)
        | Op::Lookup { .. } => vec![],
    }
}
