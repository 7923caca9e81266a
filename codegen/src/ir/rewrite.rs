//! Rewriting: all rules that bring a program into the form that is proved, shown and emitted.
//!
//! Each rule replaces an operator by one of the same result that is cheaper on a small core or
//! easier to read; the operands' proven intervals decide where it is valid. Every rule is tested
//! against [`Op::apply`] over random and extreme words.

use super::graph::{Function, Node, Program, Table};
use super::interval::Interval;
use super::op::{Comparison, Op, Value};

/// A rule: the operator in place of another one; none if it does not apply.
struct Rule {
    /// Effect of the rule.
    #[cfg_attr(
        not(test),
        expect(dead_code, reason = "tests name the rule that fails")
    )]
    name: &'static str,
    replacement: fn(&mut Rewriter<'_>, Op) -> Option<Op>,
}

/// In order of trial; after one that applies, from the first one again.
const RULES: [Rule; 13] = [
    Rule {
        name: "numbers stand right",
        replacement: number_right,
    },
    Rule {
        name: "a negative number is subtracted",
        replacement: subtract_negative,
    },
    Rule {
        name: "a product with a power of two is a part of its signal",
        replacement: part_of_signal,
    },
    Rule {
        name: "a rounded product that fits a word takes no longer one",
        replacement: narrow_rounded_product,
    },
    Rule {
        name: "a product that fits a word is shifted as one",
        replacement: narrow_product,
    },
    Rule {
        name: "products that fit a word with their sum are shifted as one",
        replacement: narrow_sum_of_products,
    },
    Rule {
        name: "a product that fits a word is limited as one",
        replacement: narrow_limited_product,
    },
    Rule {
        name: "a quotient of words takes no longer division",
        replacement: narrow_quotient,
    },
    Rule {
        name: "of words that lie near each other the sign of the difference tells the lesser",
        replacement: extreme_of_near,
    },
    Rule {
        name: "the opposite comparison in place of a flag turned over",
        replacement: opposite,
    },
    Rule {
        name: "two comparisons with a limit and its negative are one of the magnitude",
        replacement: magnitude,
    },
    Rule {
        name: "a choice of 1 and 0 is the flag as a word",
        replacement: flag_word,
    },
    Rule {
        name: "an index that lies within its table is not masked",
        replacement: unmasked_index,
    },
];

impl Program {
    /// The program after all rules, not pruned.
    #[must_use]
    pub fn rewritten(mut self) -> Self {
        let step = self.step.rewritten(&self);
        let setters = self.setters.iter();
        let setters = setters.map(|(setter, function)| (*setter, function.rewritten(&self)));
        self.setters = setters.collect();
        self.step = step;
        self
    }
}

impl Function {
    fn rewritten(&self, program: &Program) -> Self {
        let mut rewriter = Rewriter {
            tables: &program.tables,
            nodes: Vec::with_capacity(self.nodes.len()),
        };
        let mut position: Vec<Value> = Vec::with_capacity(self.nodes.len());
        // Where the replacement of each node begins.
        let mut begins: Vec<usize> = Vec::with_capacity(self.nodes.len() + 1);
        for node in &self.nodes {
            begins.push(rewriter.nodes.len());
            let mut op = node.op;
            op.map_operands(|value| position[value.index()]);
            let rewritten = rewriter.rewrite(op);
            let interval = if rewritten == op {
                node.interval
            } else {
                rewriter.interval(rewritten)
            };
            rewriter.nodes.push(Node {
                op: rewritten,
                interval,
                ..node.clone()
            });
            position.push(Value(rewriter.nodes.len() as u32 - 1));
        }
        begins.push(rewriter.nodes.len());
        let nodes = rewriter.nodes;
        let mut function = self.clone();
        function.nodes = nodes;
        function.tracking = begins[self.tracking];
        for stage in &mut function.stages {
            (stage.first, stage.end) = (begins[stage.first], begins[stage.end]);
        }
        function.map_values(|value| position[value.index()]);
        function
    }
}

/// The nodes of the new function so far.
struct Rewriter<'a> {
    tables: &'a [Table],
    nodes: Vec<Node>,
}

impl Rewriter<'_> {
    fn rewrite(&mut self, mut op: Op) -> Op {
        while let Some(next) = RULES.iter().find_map(|rule| (rule.replacement)(self, op)) {
            op = next;
        }
        op
    }

    /// Adds an unnamed node, itself rewritten.
    fn part(&mut self, op: Op) -> Value {
        let op = self.rewrite(op);
        self.nodes.push(Node {
            op,
            kind: op.kind(|value| self.nodes[value.index()].kind),
            interval: self.interval(op),
            name: String::new(),
        });
        Value(self.nodes.len() as u32 - 1)
    }

    fn node(&self, value: Value) -> &Node {
        &self.nodes[value.index()]
    }

    fn of(&self, value: Value) -> Interval {
        self.node(value).interval
    }

    /// The operator of an unnamed value.
    fn inner(&self, value: Value) -> Option<Op> {
        let node = self.node(value);
        node.name.is_empty().then_some(node.op)
    }

    fn literal(&self, value: Value) -> Option<i32> {
        match self.node(value).op {
            Op::Literal(number) => Some(number),
            _ => None,
        }
    }

    fn is_constant(&self, value: Value) -> bool {
        matches!(self.node(value).op, Op::Literal(_) | Op::Constant(_))
    }

    fn interval(&self, op: Op) -> Interval {
        if let Op::Literal(number) = op {
            return Interval::point(i64::from(number));
        }
        let operands: Vec<Interval> = op.operands().into_iter().map(|x| self.of(x)).collect();
        let table = |id: super::TableId| self.tables[id.index()].interval();
        op.interval(&operands, table).unwrap_or(Interval::WORD)
    }

    /// Interval of the product.
    fn products(&self, a: Value, b: Value) -> Interval {
        self.of(a).corners(self.of(b), |a, b| a * b)
    }

    fn product_fits(&self, a: Value, b: Value) -> bool {
        let factors = [a, b].map(|factor| Interval::WORD.contains(self.of(factor)));
        factors == [true; 2] && Interval::WORD.contains(self.products(a, b))
    }
}

fn number_right(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let is_literal = |value| r.literal(value).is_some();
    let is_constant = |value| r.is_constant(value);
    let (left, right, turned) = match op {
        Op::Add(a, b) => (is_literal(a), is_literal(b), Op::Add(b, a)),
        Op::Product(a, b) => (is_literal(a), is_literal(b), Op::Product(b, a)),
        Op::Min(a, b) => (is_constant(a), is_constant(b), Op::Min(b, a)),
        Op::Max(a, b) => (is_constant(a), is_constant(b), Op::Max(b, a)),
        _ => return None,
    };
    (left && !right).then_some(turned)
}

fn subtract_negative(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let Op::Add(a, b) = op else {
        return None;
    };
    let positive = r.literal(b).filter(|&number| number < 0)?.checked_neg()?;
    Some(Op::Sub(a, r.part(Op::Literal(positive))))
}

/// Compilers go through 64 bits otherwise.
fn part_of_signal(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let Op::MulRound {
        coefficient,
        signal,
        shift,
    } = op
    else {
        return None;
    };
    let raw = r.of(coefficient);
    let power = u32::try_from(raw.low).ok()?;
    let is_power = raw.low == raw.high && power.is_power_of_two();
    let part = shift.checked_sub(power.checked_ilog2()?)?;
    let rounded = Op::ShiftRound(signal, part);
    (is_power && rounded.is_narrow(&[r.of(signal)])).then_some(rounded)
}

fn narrow_rounded_product(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let Op::MulRound {
        coefficient,
        signal,
        shift,
    } = op
    else {
        return None;
    };
    let narrow = Op::MulRoundNarrow {
        coefficient,
        signal,
        shift,
    };
    narrow
        .is_narrow(&[r.of(coefficient), r.of(signal)])
        .then_some(narrow)
}

fn narrow_product(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let Op::MulFloor { a, b, shift } = op else {
        return None;
    };
    if shift == 0 {
        return Some(Op::Product(a, b));
    }
    let fits = shift <= 31 && r.product_fits(a, b);
    fits.then(|| Op::ShiftRight(r.part(Op::Product(a, b)), shift))
}

fn narrow_sum_of_products(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let Op::MulAddFloor {
        first: [a, b],
        second: [c, d],
        shift,
    } = op
    else {
        return None;
    };
    if shift > 31 || !r.product_fits(a, b) || !r.product_fits(c, d) {
        return None;
    }
    let (first, second) = (r.products(a, b), r.products(c, d));
    let sum = Interval::new(first.low + second.low, first.high + second.high);
    if !Interval::WORD.contains(sum) {
        return None;
    }
    let products = [(a, b), (c, d)].map(|(x, y)| r.part(Op::Product(x, y)));
    let sum = Op::Add(products[0], products[1]);
    Some(match shift {
        0 => sum,
        _ => Op::ShiftRight(r.part(sum), shift),
    })
}

fn narrow_limited_product(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let Op::MulLimited { a, b, limit } = op else {
        return None;
    };
    let fits = r.product_fits(a, b);
    fits.then(|| Op::Min(r.part(Op::Product(a, b)), limit))
}

fn narrow_quotient(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let Op::Divide {
        numerator,
        shift,
        denominator,
        limit,
    } = op
    else {
        return None;
    };
    let narrow = Op::DivideNarrow {
        numerator,
        shift,
        denominator,
        limit,
    };
    let operands = [numerator, denominator, limit].map(|x| r.of(x));
    narrow.is_narrow(&operands).then_some(narrow)
}

fn extreme_of_near(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let (near, [a, b]) = match op {
        Op::Min(a, b) => (Op::Lesser(a, b), [a, b]),
        Op::Max(a, b) => (Op::Greater(a, b), [a, b]),
        _ => return None,
    };
    let are_signals = !r.is_constant(a) && !r.is_constant(b);
    (are_signals && near.is_narrow(&[r.of(a), r.of(b)])).then_some(near)
}

fn opposite(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let Op::Not(flag) = op else {
        return None;
    };
    let Op::Compare(how, a, b) = r.inner(flag)? else {
        return None;
    };
    Some(match how {
        Comparison::Less => Op::Compare(Comparison::LessEqual, b, a),
        Comparison::LessEqual => Op::Compare(Comparison::Less, b, a),
        Comparison::Equal => Op::Compare(Comparison::NotEqual, a, b),
        Comparison::NotEqual => Op::Compare(Comparison::Equal, a, b),
    })
}

/// `limit < x` or `x < -limit`.
fn magnitude(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let Op::Or(above, below) = op else {
        return None;
    };
    let (Op::Compare(Comparison::Less, limit, x), Op::Compare(Comparison::Less, again, low)) =
        (r.inner(above)?, r.inner(below)?)
    else {
        return None;
    };
    let Op::Neg(other) = r.inner(low)? else {
        return None;
    };
    let is_constant = matches!(r.node(limit).op, Op::Constant(_));
    let is_limit = other == limit || is_constant && r.node(other).op == r.node(limit).op;
    (x == again && is_limit && r.of(limit).low >= 0).then_some(Op::Exceeds(x, limit))
}

fn flag_word(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let Op::Select {
        condition,
        then,
        otherwise,
    } = op
    else {
        return None;
    };
    let arms = [then, otherwise].map(|arm| r.literal(arm));
    (arms == [Some(1), Some(0)]).then_some(Op::FlagWord(condition))
}

fn unmasked_index(r: &mut Rewriter<'_>, op: Op) -> Option<Op> {
    let Op::Lookup {
        table,
        index,
        is_masked: true,
    } = op
    else {
        return None;
    };
    let is_inside = r.tables[table.index()].has(r.of(index));
    is_inside.then_some(Op::Lookup {
        table,
        index,
        is_masked: false,
    })
}

#[cfg(test)]
mod tests {
    use super::super::{
        Expr, Lut, Machine, Named, Output, Program, ProgramBuilder, mul_add_floor, verify,
    };
    use super::{Interval, Op, RULES, Rewriter};
    use fastrand::Rng;

    /// Expressions of three words to which rules apply.
    const SHAPES: [fn([Expr<'_>; 3]) -> Expr<'_>; 21] = [
        |[x, ..]| 5 + x,
        |[x, ..]| x + -5,
        |[x, ..]| 3 * x,
        |[x, ..]| x.builder().number(4).min(x),
        |[x, ..]| x.builder().number(4).max(x),
        |[x, y, _]| x.min(y),
        |[x, y, _]| x.max(y),
        |[x, y, _]| y.mul_round(x, 1),
        |[x, y, _]| y.mul_round(x, 9),
        |[x, ..]| x.mul_round(x.builder().number(16), 9),
        |[x, ..]| x.mul_round(x.builder().number(1), 31),
        |[x, y, _]| x.mul_floor(y, 0),
        |[x, y, _]| x.mul_floor(y, 7),
        |[x, y, z]| mul_add_floor([x, y], [z, x], 5),
        |[x, y, z]| x.abs().mul_limited(y.abs(), z),
        |[x, y, _]| x.abs().divide(3, y.abs().max(1), 1 << 20),
        |[x, y, _]| (!x.is_below(y)).choose(x, y),
        |[x, y, _]| x.is_below(y).choose(1, 0),
        |[x, y, _]| {
            let limit = y.abs().named("limit");
            (x.is_above(limit) | x.is_below(-limit)).choose(x, 1)
        },
        |[x, ..]| squares(x).at(x),
        |[x, ..]| squares(x).at(x.abs().min(3)),
    ];

    fn squares(x: Expr<'_>) -> Lut<'_> {
        x.builder().table("squares", vec![0, 1, 4, 9], &[])
    }

    fn program(shape: fn([Expr<'_>; 3]) -> Expr<'_>, bits: u32) -> Program {
        let range = Interval::symmetric((1 << (bits - 1)) - 1);
        let b = ProgramBuilder::new("Shape", &[]);
        b.stage("apply", &[]);
        let x = ["x", "y", "z"].map(|name| b.input(name, range, ""));
        // Inputs that an expression leaves out are results, too.
        for (name, x) in ["x_too", "y_too", "z_too"].into_iter().zip(x) {
            b.output(Output::Probe(name), x);
        }
        let result = shape(x).named("result");
        b.output(Output::Probe("result"), result);
        b.finish()
    }

    fn words(random: &mut Rng, bits: u32) -> [i32; 3] {
        let most = (1_i64 << (bits - 1)) - 1;
        [(); 3].map(|()| match random.u8(..6) {
            0 => most as i32,
            1 => -most as i32,
            2 => random.i32(-2..=2).clamp(-most as i32, most as i32),
            _ => random.i64(-most..=most) as i32,
        })
    }

    #[test]
    fn rewritten_programs_compute_the_same_of_random_and_extreme_words() {
        let mut random = Rng::with_seed(1);
        let mut changed = 0;
        for shape in SHAPES {
            for bits in [2, 4, 9, 15, 16, 17, 24, 30, 31, 32] {
                let plain = program(shape, bits);
                let rewritten = plain.clone().rewritten().pruned();
                changed += usize::from(rewritten != plain);
                // An expression that exceeds a word is refused, rewritten or not.
                let (Ok(plain), Ok(rewritten)) = (verify(plain), verify(rewritten)) else {
                    continue;
                };
                let (mut plain, mut rewritten) = (Machine::new(&plain), Machine::new(&rewritten));
                for _ in 0..200 {
                    let words = words(&mut random, bits);
                    let expected = plain.step(&words).expect("inside the intervals").to_vec();
                    assert_eq!(
                        rewritten.step(&words),
                        Ok(expected.as_slice()),
                        "{words:?}, {bits} bits"
                    );
                }
            }
        }
        assert!(changed > 100, "{changed}");
    }

    /// Extremes computed by the difference: min and max of x and y, then of y and x.
    fn by_difference(x: Interval, y: Interval) -> [bool; 4] {
        let b = ProgramBuilder::new("Extremes", &[]);
        b.stage("compare", &[]);
        let (x, y) = (b.input("x", x, ""), b.input("y", y, ""));
        let all = [x.min(y), x.max(y), y.min(x), y.max(x)];
        let names = ["min", "max", "min_turned", "max_turned"];
        for (name, value) in names.into_iter().zip(all) {
            b.output(Output::Probe(name), value.named(name));
        }
        let step = b.finish().rewritten().step;
        names.map(|name| {
            let node = step.nodes.iter().find(|node| node.name == name);
            matches!(node.expect("its node").op, Op::Lesser(..) | Op::Greater(..))
        })
    }

    /// `a + negative part of (b - a)` is right only where neither difference leaves its word.
    #[test]
    fn extremes_go_by_a_difference_only_where_it_fits_a_word() {
        let most = i64::from(i32::MAX);
        for high in [0, 1, 1 << 30, most] {
            let x = Interval::new(0, high);
            let y = |low: i64| Interval::new(low, 0);
            assert_eq!(by_difference(x, y(high - most)), [true; 4], "{high}");
            assert_eq!(by_difference(y(high - most), x), [true; 4], "{high}");
            let beyond = by_difference(x, y(high - most - 1));
            assert!(!beyond[0], "{high}: x - y may be 2^31");
            let beyond = by_difference(x, y(high - most - 2));
            assert_eq!(beyond, [false; 4], "{high}");
        }
        assert_eq!(by_difference(Interval::WORD, Interval::WORD), [false; 4]);
    }

    /// Every rule is tested.
    #[test]
    fn every_rule_applies_to_some_shape() {
        for rule in &RULES {
            let applies = SHAPES.iter().any(|&shape| {
                [2, 9, 16, 30].into_iter().any(|bits| {
                    let program = program(shape, bits);
                    let mut rewriter = Rewriter {
                        tables: &program.tables,
                        nodes: program.step.nodes.clone(),
                    };
                    let ops: Vec<Op> = program.step.nodes.iter().map(|node| node.op).collect();
                    ops.into_iter()
                        .any(|op| (rule.replacement)(&mut rewriter, op).is_some())
                })
            });
            assert!(applies, "{}", rule.name);
        }
    }
}
