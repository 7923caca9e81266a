//! The two ways through a function that has an exit: what it computes where the exit is taken, and where not.
//!
//! Where the exit's flags do not hold, what they say is known behind them (a count lies inside its range, a code is
//! valid), and operators that only guard against the contrary fall away. A path that is gone to its end computes what
//! the whole function computes, so the intervals that were verified for it hold there. The normal path is left where the
//! last flag is known; what it has computed up to there under a false assumption is thrown away, and no operator fails on
//! any word.

use super::graph::{Function, Guard, Table};
use super::op::{Comparison, Kind, Op, Value};

/// The paths of a function.
#[derive(Clone, Debug)]
pub struct Paths {
    /// Where the exit is not taken; the whole function where there is no exit. [`Function::leave`] holds the flags.
    pub normal: Function,
    /// Where it is taken.
    pub exit: Option<Function>,
}

impl Function {
    /// Both paths, of a function that looks up these tables.
    pub fn paths(&self, tables: &[Table]) -> Paths {
        let is_exit = |guard: &Guard| guard.exit;
        let position = self
            .stages
            .iter()
            .position(|stage| stage.guard.as_ref().is_some_and(is_exit));
        match position {
            None => Paths {
                normal: self.clone(),
                exit: None,
            },
            Some(exit) => Paths {
                normal: Path::new(self, tables, exit, false).function(),
                exit: Some(Path::new(self, tables, exit, true).function()),
            },
        }
    }

    /// The flags of which at least one holds where `flag` does, as far apart as they have names.
    fn disjuncts(&self, flag: Value) -> Option<Vec<Value>> {
        let node = self.node(flag);
        let parts = match node.op {
            Op::Or(a, b) => self.disjuncts(a).zip(self.disjuncts(b)),
            _ => None,
        };
        match parts {
            Some((mut a, b)) => {
                a.extend(b);
                Some(a)
            }
            None => (!node.name.is_empty()).then(|| vec![flag]),
        }
    }

    /// The disjunctions of the flags that [`Self::disjuncts`] finds, themselves left out.
    fn disjunctions(&self, flag: Value) -> Vec<Value> {
        match self.node(flag).op {
            Op::Or(a, b) if self.disjuncts(a).is_some() && self.disjuncts(b).is_some() => {
                let mut all = self.disjunctions(a);
                all.extend(self.disjunctions(b));
                all.push(flag);
                all
            }
            _ => vec![],
        }
    }
}

/// What is known of the order of two words: whether the first may be less, equal, greater.
type Orders = [bool; 3];

fn orders(how: Comparison, holds: bool) -> Orders {
    let where_true = match how {
        Comparison::Less => [true, false, false],
        Comparison::LessEqual => [true, true, false],
        Comparison::Equal => [false, true, false],
        Comparison::NotEqual => [true, false, true],
    };
    where_true.map(|possible| possible == holds)
}

/// A function on its way to one of its paths.
struct Path<'f> {
    whole: &'f Function,
    tables: &'f [Table],
    result: Function,
    exit: usize,
    taken: bool,
    /// What each value is replaced by.
    alias: Vec<Value>,
    /// Flags of which the value is known here.
    known: Vec<Option<bool>>,
    /// Pairs of words of which the order is known here.
    compared: Vec<(Value, Value, Orders)>,
    /// Disjunctions, and the second of the flags that each combines, which says nothing beside the first.
    told: Vec<(Value, Value)>,
}

impl<'f> Path<'f> {
    fn new(whole: &'f Function, tables: &'f [Table], exit: usize, taken: bool) -> Self {
        Self {
            whole,
            tables,
            result: whole.clone(),
            exit,
            taken,
            alias: (0..whole.nodes.len() as u32).map(Value).collect(),
            known: vec![None; whole.nodes.len()],
            compared: vec![],
            told: vec![],
        }
    }

    fn function(mut self) -> Function {
        let exit = &self.whole.stages[self.exit];
        let condition = exit.guard.as_ref().map(|guard| guard.condition);
        let flags = condition.and_then(|flag| self.whole.disjuncts(flag));
        let flags = flags.unwrap_or_default();
        let told = |&flag: &Value| Some((flag, self.told_by_other(flag)?));
        self.told = flags.iter().filter_map(told).collect();
        let mut assumed: Vec<Value> = self.told.iter().map(|&(_, flag)| flag).collect();
        assumed.extend(condition.map_or(vec![], |flag| self.whole.disjunctions(flag)));
        assumed.extend(&flags);
        for (number, stage) in self.whole.stages.iter().enumerate() {
            for index in stage.first..stage.end {
                self.simplify(index);
            }
            self.close(number);
            // What a stage checks is known behind it.
            if !self.taken {
                let inside = |flag: &&Value| (stage.first..stage.end).contains(&flag.index());
                for &flag in assumed.iter().filter(inside) {
                    self.assume(flag, false);
                }
            }
        }
        let alias = &self.alias;
        let path = &mut self.result;
        let results = path.outputs.iter_mut().map(|(_, value)| value);
        let words = path.next_state.iter_mut().map(|(_, value)| value);
        let guards = path.stages.iter_mut().flat_map(|stage| &mut stage.guard);
        let conditions = guards.map(|guard| &mut guard.condition);
        for value in results.chain(words).chain(conditions) {
            *value = alias[value.index()];
        }
        // Errors are stated for the whole function.
        path.quantities.clear();
        if !self.taken {
            path.leave = flags.iter().map(|flag| alias[flag.index()]).collect();
        }
        self.result.prune();
        self.result
    }

    /// The joins behind a stage, and its guard.
    fn close(&mut self, number: usize) {
        let stage = &self.whole.stages[number];
        let Some(guard) = &stage.guard else { return };
        let decided = if number == self.exit {
            Some(self.taken)
        } else {
            self.known[guard.condition.index()]
        };
        for &join in &guard.joins {
            let Op::Join { taken, otherwise } = self.whole.node(join).op else {
                continue;
            };
            match decided {
                None => self.simplify(join.index()),
                Some(true) => self.replace(join, taken),
                Some(false) => self.replace(join, otherwise),
            }
        }
        if decided == Some(true) {
            self.result.stages[number].guard = None;
        }
    }

    fn simplify(&mut self, index: usize) {
        let alias = &self.alias;
        let node = &mut self.result.nodes[index];
        node.op.map_operands(|value| alias[value.index()]);
        let value = Value(index as u32);
        match node.op {
            Op::Compare(how, a, b) => self.known[index] = self.compare(how, a, b),
            Op::Not(a) => self.known[index] = self.known[a.index()].map(|holds| !holds),
            Op::Or(a, b) => self.combine(value, [a, b], true),
            Op::And(a, b) => self.combine(value, [a, b], false),
            Op::Select {
                condition,
                then,
                otherwise,
            } => match self.known[condition.index()] {
                Some(true) => self.replace(value, then),
                Some(false) => self.replace(value, otherwise),
                None => {}
            },
            Op::Min(a, b) => self.pick(value, a, b),
            Op::Max(a, b) => self.pick(value, b, a),
            _ => {}
        }
    }

    /// An `or` (absorbing `true`) or `and` (absorbing `false`).
    fn combine(&mut self, value: Value, flags: [Value; 2], absorbing: bool) {
        let [a, b] = flags.map(|flag| self.known[flag.index()]);
        match (a, b) {
            (Some(known), _) | (_, Some(known)) if known == absorbing => {
                self.known[value.index()] = Some(absorbing);
            }
            (Some(_), Some(_)) => self.known[value.index()] = Some(!absorbing),
            (Some(_), None) => self.replace(value, flags[1]),
            (None, Some(_)) => self.replace(value, flags[0]),
            (None, None) if self.told.iter().any(|&(either, _)| either == value) => {
                self.replace(value, flags[0]);
            }
            (None, None) => {}
        }
    }

    /// The one of two words that is known to be at most the other replaces `value`: `least` first.
    fn pick(&mut self, value: Value, least: Value, other: Value) {
        if self.compare(Comparison::LessEqual, least, other) == Some(true) {
            self.replace(value, least);
        } else if self.compare(Comparison::LessEqual, other, least) == Some(true) {
            self.replace(value, other);
        }
    }

    fn replace(&mut self, value: Value, by: Value) {
        let by = self.alias[by.index()];
        self.alias[value.index()] = by;
        self.known[value.index()] = self.known[by.index()];
        let name = self.result.nodes[value.index()].name.clone();
        let heir = &mut self.result.nodes[by.index()];
        if heir.name.is_empty() && !matches!(heir.op, Op::Constant(_) | Op::Literal(_)) {
            heir.name = name;
        }
    }

    /// The second of the flags that `flag` combines, where the first holds wherever it does: the second says that a
    /// table's entry is some number; the first that a magnitude is above a level from the same row, and there such a
    /// level is below all magnitudes.
    fn told_by_other(&self, flag: Value) -> Option<Value> {
        let op = |value: Value| self.whole.node(value).op;
        let entry = |value: Value| match op(value) {
            Op::Lookup { table, index } => Some((&self.tables[table.index()].values, index)),
            _ => None,
        };
        let Op::Or(first, second) = op(flag) else {
            return None;
        };
        let (mut above, mut below) = (first, second);
        while let Op::Or(a, b) = op(above) {
            (above, below) = (a, b);
        }
        let (
            Op::Compare(Comparison::Equal, code, number),
            Op::Compare(Comparison::Less, level, x),
            Op::Compare(Comparison::Less, again, lower),
        ) = (op(second), op(above), op(below))
        else {
            return None;
        };
        let ((codes, index), (levels, same)) = (entry(code)?, entry(level)?);
        let Op::Literal(number) = op(number) else {
            return None;
        };
        let is_below = |(&code, &level): (&i32, &i32)| code != number || level < 0;
        let is_told = again == x
            && op(lower) == Op::Neg(level)
            && index == same
            && codes.len() == levels.len()
            && codes.iter().zip(levels).all(is_below);
        is_told.then_some(second)
    }

    fn assume(&mut self, flag: Value, holds: bool) {
        let flag = self.alias[flag.index()];
        self.known[flag.index()] = Some(holds);
        match (self.result.node(flag).op, holds) {
            (Op::Not(a), _) => self.assume(a, !holds),
            (Op::Or(a, b), false) | (Op::And(a, b), true) => {
                self.assume(a, holds);
                self.assume(b, holds);
            }
            (Op::Compare(how, a, b), _) => self.compared.push((a, b, orders(how, holds))),
            _ => {}
        }
    }

    /// What is known of a comparison.
    fn compare(&self, how: Comparison, a: Value, b: Value) -> Option<bool> {
        let mut possible = [true; 3];
        for &(c, d, [less, equal, greater]) in &self.compared {
            let order = if self.same(a, c) && self.same(b, d) {
                [less, equal, greater]
            } else if self.same(a, d) && self.same(b, c) {
                [greater, equal, less]
            } else {
                continue;
            };
            for (possible, order) in possible.iter_mut().zip(order) {
                *possible &= order;
            }
        }
        let holding = orders(how, true);
        let possible = || {
            possible
                .into_iter()
                .zip(holding)
                .filter(|&(possible, _)| possible)
        };
        if possible().all(|(_, holds)| holds) {
            Some(true)
        } else if possible().all(|(_, holds)| !holds) {
            Some(false)
        } else {
            None
        }
    }

    /// Whether two values are known to be the same word: constants and small numbers are read anew wherever used.
    fn same(&self, a: Value, b: Value) -> bool {
        let [p, q] = [a, b].map(|value| self.result.node(value));
        let is_leaf = matches!(p.op, Op::Constant(_) | Op::Literal(_));
        a == b || p.kind == Kind::Word && is_leaf && p.op == q.op
    }
}
