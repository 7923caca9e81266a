//! The integer primitives of emitted code against the semantics of the IR's operators.

#![expect(
    clippy::redundant_closure_for_method_calls,
    reason = "a method of expressions is of one lifetime, what is wanted of all"
)]

use hexagen::arith::{
    Word, angle_fraction, angle_index, angle_index_by_halves, divide, divide_by_digits,
    divide_narrow, lookup, mul_add_floor, mul_floor, mul_limited, mul_round, mul_round_narrow,
    mul_round_without_carry, product_by_halves, remainder, select, turn_over,
};
use hexagen_codegen::ir::{
    Expr, Interval, Lut, Machine, Named, Output, ProgramBuilder, mul_add_floor as sum_of_products,
    verify,
};
use proptest::prelude::*;

/// Result of a function of one operator, by the interpreter.
fn interpreted(
    intervals: &[Interval],
    operands: &[i32],
    table: &[i32],
    build: impl for<'b> Fn(&[Expr<'b>], Lut<'b>) -> Expr<'b>,
) -> i32 {
    let b = ProgramBuilder::new("Operator", &[]);
    let table = b.table("table", table.to_vec(), &[]);
    b.stage("apply", &[]);
    let names = ["x", "y", "z", "w"];
    let inputs: Vec<Expr<'_>> = names
        .iter()
        .zip(intervals)
        .map(|(name, &interval)| b.input(name, interval, ""))
        .collect();
    b.output(
        Output::Probe("result"),
        build(&inputs, table).named("result"),
    );
    let graph = verify(b.finish()).expect("the program is right");
    let mut machine = Machine::new(&graph);
    let outputs = machine.step(operands);
    outputs.expect("no value leaves its interval")[0]
}

fn symmetric(bits: u32) -> Interval {
    Interval::new(-(1 << (bits - 1)), (1 << (bits - 1)) - 1)
}

/// A word of at most `bits` bits, small and large ones.
fn word(bits: u32) -> impl Strategy<Value = i32> {
    (any::<i32>(), 32 - bits..32).prop_map(|(word, shift)| word >> shift)
}

fn natural(bits: u32) -> impl Strategy<Value = i32> {
    (any::<u32>(), 32 - bits..32).prop_map(|(word, shift)| (word >> shift) as i32)
}

const TABLE: [i16; 8] = [5, -3, 32767, -32768, 0, 1, 2, 3];

/// Words at the ends of a product's range, and random ones.
fn factor() -> impl Strategy<Value = i32> {
    const ENDS: [i32; 8] = [
        i32::MIN,
        i32::MIN + 1,
        -(1 << 30),
        1 - (1 << 30),
        (1 << 30) - 1,
        1 << 30,
        i32::MAX - 1,
        i32::MAX,
    ];
    prop_oneof![prop::sample::select(&ENDS[..]), word(32)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn products_without_a_carry_flag(c in factor(), x in factor(), shift in 1..63_u32) {
        for shift in [shift, 32] {
            let product = i128::from(c) * i128::from(x);
            let exact = (product + (1 << (shift - 1))) >> shift;
            // The generator proves that results fit a word.
            if let Ok(exact) = i32::try_from(exact) {
                prop_assert_eq!(mul_round_without_carry(Word(c), Word(x), shift).0, exact);
            }
        }
    }

    #[test]
    fn products_by_halves(a in factor(), b in factor()) {
        prop_assert_eq!(product_by_halves(Word(a), Word(b)), i64::from(a) * i64::from(b));
    }

    #[test]
    fn extremes_of_words_that_lie_near(x in word(31), y in word(31)) {
        let low = interpreted(&[symmetric(31); 2], &[x, y], &[0], |x, _| x[0].min(x[1]));
        let high = interpreted(&[symmetric(31); 2], &[x, y], &[0], |x, _| x[0].max(x[1]));
        prop_assert_eq!(Word(x).lesser(Word(y)).0, low);
        prop_assert_eq!(Word(x).greater(Word(y)).0, high);
    }

    #[test]
    fn extremes_of_words_whose_difference_just_fits(x in factor(), difference in factor()) {
        // All of x - y from -2^31 to 2^31 - 1: no caller exceeds it.
        if let Some(y) = x.checked_sub(difference) {
            prop_assert_eq!(Word(x).lesser(Word(y)).0, x.min(y));
            prop_assert_eq!(Word(x).greater(Word(y)).0, x.max(y));
        }
    }

    #[test]
    fn magnitudes_beyond_a_limit(x in factor(), limit in natural(31), near in -1..=1_i64) {
        let magnitude = i64::from(x).abs();
        // Any limit, and those next to the magnitude.
        for limit in [i64::from(limit), magnitude + near] {
            if let Ok(limit) = i32::try_from(limit.max(0)) {
                let exceeds = magnitude > i64::from(limit);
                prop_assert_eq!(Word(x).exceeds(limit), exceeds, "{} {}", x, limit);
            }
        }
    }

    #[test]
    fn rounded_products(c in word(32), x in word(32), shift in 32_u32..=62) {
        let expected = interpreted(&[symmetric(32); 2], &[c, x], &[0], |x, _| x[1].mul_round(x[0], shift));
        prop_assert_eq!(mul_round(Word(c), Word(x), shift).0, expected);
    }

    #[test]
    fn rounded_narrow_products(c in word(15), x in word(16), shift in 1_u32..=30) {
        let intervals = [symmetric(15), symmetric(16)];
        let expected = interpreted(&intervals, &[c, x], &[0], |x, _| x[1].mul_round(x[0], shift));
        prop_assert_eq!(mul_round_narrow(Word(c), Word(x), shift).0, expected);
        prop_assert_eq!(mul_round(Word(c), Word(x), shift).0, expected);
    }

    #[test]
    fn floored_products(a in word(24), c in word(24), shift in 16_u32..=40) {
        let expected = interpreted(&[symmetric(24); 2], &[a, c], &[0], |x, _| x[0].mul_floor(x[1], shift));
        prop_assert_eq!(mul_floor(Word(a), Word(c), shift).0, expected);
    }

    #[test]
    fn floored_sums_of_products(words in [word(26), word(26), word(26), word(26)], shift in 22_u32..=40) {
        let expected = interpreted(&[symmetric(26); 4], &words, &[0], |x, _| {
            sum_of_products([x[0], x[1]], [x[2], x[3]], shift)
        });
        let [a, b, c, d] = words.map(Word);
        prop_assert_eq!(mul_add_floor(a, b, c, d, shift).0, expected);
    }

    #[test]
    fn limited_products(a in natural(31), c in natural(31), limit in natural(30)) {
        let intervals = [Interval::new(0, i64::from(i32::MAX)), Interval::new(0, i64::from(i32::MAX)), Interval::new(0, 1 << 30)];
        let expected = interpreted(&intervals, &[a, c, limit], &[0], |x, _| x[0].mul_limited(x[1], x[2]));
        prop_assert_eq!(mul_limited(Word(a), Word(c), Word(limit)).0, expected);
    }

    #[test]
    fn quotients(n in natural(31), d in natural(31), limit in natural(30), shift in 0_u32..=31) {
        let d = d.max(1);
        let intervals = [Interval::new(0, i64::from(i32::MAX)), Interval::new(1, i64::from(i32::MAX)), Interval::new(0, 1 << 30)];
        let expected = interpreted(&intervals, &[n, d, limit], &[0], |x, _| x[0].divide(shift, x[1], x[2]));
        prop_assert_eq!(divide(Word(n), Word(d), Word(limit), shift).0, expected);
        prop_assert_eq!(divide_by_digits(Word(n), Word(d), Word(limit), shift).0, expected);
        if i64::from(n) << shift <= i64::from(u32::MAX) {
            prop_assert_eq!(divide_narrow(Word(n), Word(d), Word(limit), shift).0, expected);
        }
    }

    #[test]
    fn quotients_whose_digits_are_corrected(high in 0_i32..1 << 8, low in 0_i32..1 << 8, less in 0_i32..16, shift in 0_u32..=31) {
        // A divisor whose lower half, once its highest bit is set, is large beside the upper one,
        // and a numerator just below it: the estimate is two too large.
        let d = 1 << 30 | high << 15 | 0x7f00 | low >> 1;
        let n = (d - 1 - less).max(0);
        let exact = ((i64::from(n) << shift) / i64::from(d)) as i32;
        prop_assert_eq!(divide_by_digits(Word(n), Word(d), Word(i32::MAX), shift).0, exact);
    }

    #[test]
    fn remainders(x in any::<i32>(), bits in 1_u32..=30) {
        let expected = interpreted(&[Interval::WORD], &[x], &[0], |x, _| x[0].remainder(bits));
        prop_assert_eq!(remainder(Word(x), bits).0, expected);
    }

    #[test]
    fn angles_of_a_tick(ticks in natural(31)) {
        let ticks = ticks.max(2);
        let expected = interpreted(&[Interval::new(2, i64::from(i32::MAX))], &[ticks], &[0], |x, _| x[0].turn_over());
        prop_assert_eq!(turn_over(Word(ticks)).0, expected);
    }

    #[test]
    fn angles(theta in any::<i32>(), other in any::<i32>(), segments in 1_u32..=1 << 16) {
        let full = [Interval::WORD; 2];
        let index = interpreted(&full[..1], &[theta], &[0], |x, _| x[0].angle_index(segments));
        let fraction = interpreted(&full[..1], &[theta], &[0], |x, _| x[0].angle_fraction(segments));
        let sum = interpreted(&full, &[theta, other], &[0], |x, _| x[0].angle_add(x[1]));
        let difference = interpreted(&full, &[theta, other], &[0], |x, _| x[0].angle_sub(x[1]));
        prop_assert_eq!(angle_index(Word(theta), segments).0, index);
        prop_assert_eq!(angle_index_by_halves(Word(theta), segments).0, index);
        prop_assert_eq!(angle_fraction(Word(theta), segments).0, fraction);
        prop_assert_eq!((Word(theta) + Word(other)).0, sum);
        prop_assert_eq!((Word(theta) - Word(other)).0, difference);
    }

    #[test]
    fn table_entries(index in any::<i32>()) {
        let table = TABLE.map(i32::from);
        let expected = interpreted(&[Interval::WORD], &[index], &table, |x, table| table.at(x[0]));
        prop_assert_eq!(lookup(&TABLE, Word(index)).0, expected);
    }

    #[test]
    fn operators_of_words(a in word(30), c in word(30), bits in 0_u32..=31) {
        let wide = [symmetric(30); 2];
        let two = |of: fn([Expr<'_>; 2]) -> Expr<'_>| {
            interpreted(&wide, &[a, c], &[0], |x, _| of([x[0], x[1]]))
        };
        let one = |of: fn(Expr<'_>) -> Expr<'_>| interpreted(&wide[..1], &[a], &[0], |x, _| of(x[0]));
        let (x, y) = (Word(a), Word(c));
        prop_assert_eq!((x + y).0, two(|[x, y]| x + y));
        prop_assert_eq!((x - y).0, two(|[x, y]| x - y));
        prop_assert_eq!(x.min(y).0, two(|[x, y]| x.min(y)));
        prop_assert_eq!(x.max(y).0, two(|[x, y]| x.max(y)));
        prop_assert_eq!((-x).0, one(|x| -x));
        prop_assert_eq!(x.abs().0, one(|x| x.abs()));
        let shifted = interpreted(&wide[..1], &[a], &[0], |x, _| x[0] >> bits);
        prop_assert_eq!((x >> bits).0, shifted);
        let limits = [symmetric(30), Interval::new(-9000, -7), Interval::new(-6, 9000)];
        let (low, high) = (-7 - c.rem_euclid(8000), c.rem_euclid(9000));
        let clamped = interpreted(&limits, &[a, low, high], &[0], |x, _| x[0].clamp(x[1], x[2]));
        prop_assert_eq!(x.clamp(Word(low), high).0, clamped);
        let less = interpreted(&wide, &[a, c], &[0], |x, _| {
            x[0].is_below(x[1]).named("less").choose(x[1], x[0])
        });
        prop_assert_eq!(select(x < y, y, x).0, less);
        prop_assert_eq!(x < c, x < y);
        prop_assert_eq!(x == c, x == y);
    }
}
