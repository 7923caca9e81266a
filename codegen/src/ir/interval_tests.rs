//! Intervals against all values of small ranges: none too narrow, and none too wide except as
//! stated.

use super::{
    Bounds, Comparison, Expr, Flag, Function, Interval, Named, Op, Output, Program, ProgramBuilder,
    Value, named,
};

fn hull(values: impl IntoIterator<Item = i64>) -> Option<Interval> {
    values
        .into_iter()
        .map(Interval::point)
        .reduce(Interval::union)
}

/// All intervals with ends from `low` to `high`.
fn intervals(low: i64, high: i64) -> impl Iterator<Item = Interval> + Clone {
    (low..=high).flat_map(move |from| (from..=high).map(move |to| Interval::new(from, to)))
}

/// All choices of one value of each interval.
fn choices(intervals: &[Interval]) -> Vec<Vec<i64>> {
    intervals.iter().fold(vec![vec![]], |choices, interval| {
        let longer = choices.iter().flat_map(|choice: &Vec<i64>| {
            (interval.low..=interval.high).map(|value| [&choice[..], &[value]].concat())
        });
        longer.collect()
    })
}

/// Checks that an operator's interval is exactly that of its results, and none outside its domain.
fn check(op: Op, operands: &[Interval]) {
    let results: Option<Vec<i64>> = choices(operands)
        .iter()
        .map(|x| op.apply_to(x, |_, _| 0))
        .collect();
    let found = op.interval(operands, |_| Interval::FLAG);
    assert_eq!(found, results.and_then(hull), "{op:?} of {operands:?}");
}

/// Unused operand.
const X: Value = Value(0);

#[test]
fn intervals_of_one_operand_are_those_of_all_values() {
    for x in intervals(-9, 9) {
        check(Op::Neg(X), &[x]);
        check(Op::Abs(X), &[x]);
        check(Op::TurnOver(X), &[x]);
        for n in 0..4 {
            check(Op::ShiftLeft(X, n), &[x]);
            check(Op::ShiftRight(X, n), &[x]);
            check(Op::ShiftRound(X, n + 1), &[x]);
            check(Op::Remainder(X, n + 1), &[x]);
        }
    }
}

#[test]
fn intervals_of_two_operands_are_those_of_all_values() {
    for x in intervals(-4, 4) {
        for y in intervals(-4, 4) {
            let pair = [x, y];
            check(Op::Add(X, X), &pair);
            check(Op::Sub(X, X), &pair);
            check(Op::Product(X, X), &pair);
            check(Op::Min(X, X), &pair);
            check(Op::Max(X, X), &pair);
            check(Op::Lesser(X, X), &pair);
            check(Op::Greater(X, X), &pair);
            for shift in 0..4 {
                check(Op::MulFloor { a: X, b: X, shift }, &pair);
                if shift > 0 {
                    let (coefficient, signal) = (X, X);
                    let op = Op::MulRound {
                        coefficient,
                        signal,
                        shift,
                    };
                    check(op, &pair);
                }
            }
        }
    }
}

#[test]
fn intervals_of_three_operands_are_those_of_all_values() {
    let limited = Op::MulLimited {
        a: X,
        b: X,
        limit: X,
    };
    let clamp = Op::Clamp {
        x: X,
        low: X,
        high: X,
    };
    for x in intervals(-2, 3) {
        for y in intervals(-2, 3) {
            for z in intervals(0, 5) {
                check(limited, &[x, y, z]);
                for shift in 0..3 {
                    let op = Op::Divide {
                        numerator: X,
                        shift,
                        denominator: X,
                        limit: X,
                    };
                    check(op, &[x, y, z]);
                }
                if y.high <= z.low {
                    check(clamp, &[x, y, z]);
                }
            }
            let select = Op::Select {
                condition: X,
                then: X,
                otherwise: X,
            };
            check(select, &[Interval::FLAG, x, y]);
        }
    }
}

#[test]
fn intervals_of_sums_of_products_are_those_of_all_values() {
    let few = [(-2, 1), (-1, 2), (0, 2), (1, 3), (-3, -1), (2, 2)]
        .map(|(low, high)| Interval::new(low, high));
    for shift in 0..3 {
        let op = Op::MulAddFloor {
            first: [X; 2],
            second: [X; 2],
            shift,
        };
        for &a in &few {
            for &b in &few {
                for &c in &few {
                    for &d in &few {
                        check(op, &[a, b, c, d]);
                    }
                }
            }
        }
    }
}

#[test]
fn intervals_of_angles_and_tables_are_those_of_all_words() {
    let ends = [0, 1, -1, i64::from(i32::MAX), i64::from(i32::MIN)];
    let of = |op: Op| {
        let results = ends
            .iter()
            .filter_map(|&angle| op.apply_to(&[angle], |_, _| 0));
        (
            hull(results),
            op.interval(&[Interval::WORD], |_| Interval::FLAG),
        )
    };
    for segments in [1, 6, 64, 1 << 16] {
        let (found, stated) = of(Op::AngleIndex { angle: X, segments });
        assert_eq!(found, stated);
    }
    let (found, stated) = of(Op::AngleFraction {
        angle: X,
        segments: 1,
    });
    assert_eq!(found, stated);
    let b = ProgramBuilder::new("Table", &[]);
    b.table("table", vec![5, -7, 2, 3], &[]);
    assert_eq!(b.finish().tables[0].interval(), Interval::new(-7, 5));
}

#[test]
fn bits_are_those_of_the_smallest_word_that_holds_both_ends() {
    for bits in 1..=48 {
        let (least, most) = (-(1_i64 << (bits - 1)), (1_i64 << (bits - 1)) - 1);
        for (low, high, wanted) in [
            (least, most, bits),
            (least, 0, bits),
            (0, most, bits),
            (least - 1, 0, bits + 1),
            (0, most + 1, bits + 1),
        ] {
            assert_eq!(Interval::new(low, high).bits(), wanted, "[{low}, {high}]");
        }
    }
}

/// A step built by `build`, not verified.
fn program(
    inputs: &[Interval],
    build: impl for<'b> Fn(&'b ProgramBuilder, &[Expr<'b>]),
) -> Program {
    let b = ProgramBuilder::new("Conditions", &[]);
    b.stage("read", &[]);
    let names = ["x", "y", "z"].into_iter().zip(inputs);
    let values: Vec<Expr<'_>> = names
        .map(|(name, &interval)| b.input(name, interval, ""))
        .collect();
    build(&b, &values);
    b.finish()
}

fn value_named(function: &Function, name: &str) -> Value {
    let mut values = function.values();
    let found = values.find(|&value| function.node(value).name == name);
    found.expect("a value of this name")
}

/// The results of all values of the step, by their places, for these inputs.
fn results(function: &Function, inputs: &[i64]) -> Vec<i64> {
    let mut results: Vec<i64> = vec![];
    for node in &function.nodes {
        let result = match node.op {
            Op::Input(number) => inputs[number as usize],
            Op::Join { taken, otherwise } => {
                let holds = results[value_named(function, "holds").index()] == 1;
                results[if holds { taken } else { otherwise }.index()]
            }
            op => {
                let result = op.apply(|operand| results[operand.index()], |_, _| 0);
                result.expect("inside its domain")
            }
        };
        results.push(result);
    }
    results
}

const HOWS: [Comparison; 4] = [
    Comparison::Less,
    Comparison::LessEqual,
    Comparison::Equal,
    Comparison::NotEqual,
];

/// Bounds of `x` and `y` under a condition, in a selection and in a guarded stage: never narrower
/// than all inputs show, and exact for an order of the two.
fn check_condition(
    ranges: &[Interval],
    is_exact: bool,
    condition: impl for<'b> Fn(&[Expr<'b>]) -> Flag<'b>,
) {
    let selected = program(ranges, |b, x| {
        named! {
            let then = x[0] + 1;
            let otherwise = x[1] - 1;
            let holds = condition(x);
        }
        b.output(Output::Probe("chosen"), holds.choose(then, otherwise));
        named! {
            let direct = holds.choose(x[0], x[1]);
        }
        b.output(Output::Probe("direct"), direct);
    });
    let guarded = program(ranges, |b, x| {
        named! {
            let holds = condition(x);
            let otherwise = x[1] - 1;
        }
        b.guarded_stage("rarely", holds, true, &[]);
        named! {
            let then = x[0] + 1;
        }
        let [joined] = b.join([("joined", then, otherwise)]);
        b.output(Output::Probe("joined"), joined);
    });
    for program in [&selected, &guarded] {
        let step = &program.step;
        let all: Vec<Vec<i64>> = choices(ranges)
            .iter()
            .map(|inputs| results(step, inputs))
            .collect();
        let holds = value_named(step, "holds").index();
        let seen = |name: &str, when: Option<bool>| {
            let place = value_named(step, name).index();
            let matters = all
                .iter()
                .filter(|values| when.is_none_or(|when| (values[holds] == 1) == when));
            hull(matters.map(|values| values[place]))
        };
        let mut wanted = vec![("then", Some(true)), ("otherwise", Some(false))];
        if step.nodes.iter().any(|node| node.name == "direct") {
            wanted.push(("direct", None));
        }
        // A condition that never or always holds leaves a side that is never reached.
        if wanted
            .iter()
            .any(|&(name, when)| seen(name, when).is_none())
        {
            continue;
        }
        let bounds = Bounds::new(program, step);
        for &(name, when) in &wanted {
            let Some(seen) = seen(name, when) else {
                continue;
            };
            let stated = bounds.interval(value_named(step, name));
            assert!(
                stated.contains(seen),
                "{name} in {stated}, but takes {seen}: {ranges:?} {:?}",
                step.nodes[holds]
            );
            assert!(
                !is_exact || stated == seen,
                "{name} in {stated} for {seen}: {ranges:?} {:?}",
                step.nodes[holds]
            );
        }
        let known = [true, false].map(|when| {
            let name = if when { "then" } else { "otherwise" };
            let bounds = Bounds::where_known(program, step, &[(Value(holds as u32), when)]);
            (
                bounds.interval(value_named(step, name)),
                seen(name, Some(when)),
            )
        });
        for (stated, seen) in known {
            assert!(
                seen.is_some_and(|seen| stated.contains(seen)),
                "{stated}: {ranges:?}"
            );
        }
    }
}

#[test]
fn comparisons_bound_what_they_compare() {
    for x in intervals(-2, 3) {
        for y in intervals(-2, 3) {
            for how in HOWS {
                let is_order = matches!(how, Comparison::Less | Comparison::LessEqual);
                check_condition(&[x, y], is_order, |x| x[0].compare(how, x[1]));
                check_condition(&[x, y], is_order, |x| x[1].compare(how, x[0]));
                check_condition(&[x, y], is_order, |x| !x[0].compare(how, x[1]));
            }
        }
    }
}

#[test]
fn flags_of_several_comparisons_bound_what_all_of_them_compare() {
    let few =
        [(-2, 2), (0, 3), (-1, 1), (1, 4), (-3, 0)].map(|(low, high)| Interval::new(low, high));
    for x in few {
        for y in few {
            for z in few {
                for first in HOWS {
                    for second in HOWS {
                        check_condition(&[x, y, z], false, |x| {
                            x[0].compare(first, x[1]) & x[2].compare(second, x[0])
                        });
                        check_condition(&[x, y, z], false, |x| {
                            x[0].compare(first, x[1]) | x[2].compare(second, x[0])
                        });
                    }
                }
            }
        }
    }
    // Both say something: x < y and x < z.
    let ranges = [(0, 9), (2, 6), (3, 5)].map(|(low, high)| Interval::new(low, high));
    let either = program(&ranges, |b, x| {
        named! {
            let then = x[0] + 1;
            let otherwise = x[0] - 1;
        }
        let holds = x[0].is_below(x[1]) & x[0].is_below(x[2]);
        b.output(Output::Probe("chosen"), holds.choose(then, otherwise));
    });
    let bounds = Bounds::new(&either, &either.step);
    let then = bounds.interval(value_named(&either.step, "then"));
    assert_eq!(then, Interval::new(1, 5), "x is below 5 there");
}

/// `limit < max(a, b, c) - min(a, b, c)` for c = -(a + b), and its bounds on each of them, their
/// middle, each less the middle, and each lifted by a number less middle, max or min. Other lifts have no bounds of it.
#[test]
fn a_spread_bounds_its_legs_and_their_middle() {
    let range = Interval::symmetric(15);
    let names = [
        "a",
        "b",
        "c",
        "middle",
        "centred_a",
        "centred_c",
        "lifted_b",
        "below_a",
        "above_c",
        "least_b",
    ];
    let mut tight = [0; 10];
    for limit in 0..=18 {
        let program = program(&[range, range], |_, x| {
            named! {
                let a = x[0];
                let b = x[1];
                let c = -(a + b);
            }
            let (high, low) = (a.max(b).max(c), a.min(b).min(c));
            let spread = high - low;
            let both = high + low;
            named! {
                let middle = both >> 1;
            }
            let _ = spread.is_above(limit).named("holds");
            let _ = (a - middle).named("centred_a");
            let _ = (c - middle).named("centred_c");
            let _ = (b + (7 - middle)).named("lifted_b");
            let _ = (a + (9 - high)).named("below_a");
            let _ = (c + (4 - low)).named("above_c");
            let _ = (b + (7 - middle).min(9 - high)).named("least_b");
            let _ = (b + (a - high)).named("lift_of_a_leg");
            let _ = (b + (7 - middle).min(a)).named("least_with_a_leg");
            let _ = (b + (7 - middle).max(9 - high)).named("greatest_lift");
            let _ = ((b + 1) + (9 - high)).named("no_leg");
        });
        let step = &program.step;
        let all: Vec<Vec<i64>> = choices(&[range, range])
            .iter()
            .map(|inputs| results(step, inputs))
            .collect();
        let holds = value_named(step, "holds");
        for (name, tight) in names.iter().zip(&mut tight) {
            let value = value_named(step, name);
            let inside = all.iter().filter(|values| values[holds.index()] == 0);
            let seen = hull(inside.map(|values| values[value.index()])).expect("0 has no spread");
            let stated = step.interval_where_not(holds, value);
            assert!(
                stated.contains(seen),
                "{name} in {stated}, but takes {seen}: {limit}"
            );
            *tight += i32::from(stated.low == seen.low || stated.high == seen.high);
        }
        for name in [
            "lift_of_a_leg",
            "least_with_a_leg",
            "greatest_lift",
            "no_leg",
        ] {
            let value = value_named(step, name);
            let own = step.node(value).interval;
            assert_eq!(step.interval_where_not(holds, value), own, "{name}");
        }
    }
    assert!(tight.iter().all(|&tight| tight > 0), "{names:?} {tight:?}");
}
