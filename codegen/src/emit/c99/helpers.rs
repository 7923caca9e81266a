//! The primitives of emitted C, each a function that a source has where it uses it.
//!
//! C leaves right shifts of negative numbers and conversions to narrower signed types to the compiler, and left shifts
//! of negative numbers and signed overflow undefined; none of these occurs. Compilers know the forms: on a
//! Cortex-M4, gcc makes one instruction of each shift, conversion, minimum and maximum from `-O2` on.

use std::collections::BTreeSet;

/// A function of a source.
#[derive(Debug)]
pub(super) struct Helper {
    /// Its name.
    pub name: &'static str,
    /// Its documentation and text.
    text: &'static str,
}

/// All, each behind those that it calls.
pub(super) const HELPERS: [Helper; 23] = [
    Helper {
        name: "exceeds",
        text: "\
/** Whether |x| > limit, which is not negative. */
static inline bool exceeds(int32_t x, int32_t limit)
{
    return (uint32_t)x + (uint32_t)limit > UINT32_C(2) * (uint32_t)limit;
}
",
    },
    Helper {
        name: "shift_left",
        text: "\
/** x 2^shift; shift is 0 to 30. */
static inline int32_t shift_left(int32_t x, uint16_t shift)
{
    return x * (INT32_C(1) << shift);
}
",
    },
    Helper {
        name: "shift_right",
        text: "\
/** floor(x / 2^shift): an arithmetic shift, written without a right shift of negative numbers. */
static inline int32_t shift_right(int32_t x, uint16_t shift)
{
    return (x >= 0) ? (x >> shift) : ~(~x >> shift);
}
",
    },
    Helper {
        name: "shift_right_wide",
        text: "\
/** floor(x / 2^shift), as a word: the quotient is known to fit. */
static inline int32_t shift_right_wide(int64_t x, uint16_t shift)
{
    return (int32_t)((x >= 0) ? (x >> shift) : ~(~x >> shift));
}
",
    },
    Helper {
        name: "wrap",
        text: "\
/** The two's complement word of these bits. */
static inline int32_t wrap(uint32_t bits)
{
    return (bits <= UINT32_C(0x7fffffff)) ? (int32_t)bits : -1 - (int32_t)~bits;
}
",
    },
    Helper {
        name: "angle_add",
        text: "\
/** Sum of two angles: a turn is 2^32, so that sums wrap. */
static inline int32_t angle_add(int32_t a, int32_t b)
{
    return wrap((uint32_t)a + (uint32_t)b);
}
",
    },
    Helper {
        name: "angle_sub",
        text: "\
/** Difference of two angles: a turn is 2^32, so that differences wrap. */
static inline int32_t angle_sub(int32_t a, int32_t b)
{
    return wrap((uint32_t)a - (uint32_t)b);
}
",
    },
    Helper {
        name: "abs_of",
        text: "\
/** |x| */
static inline int32_t abs_of(int32_t x)
{
    return (x < 0) ? -x : x;
}
",
    },
    Helper {
        name: "min_of",
        text: "\
/** The lesser of the two. */
static inline int32_t min_of(int32_t a, int32_t b)
{
    return (a < b) ? a : b;
}
",
    },
    Helper {
        name: "max_of",
        text: "\
/** The greater of the two. */
static inline int32_t max_of(int32_t a, int32_t b)
{
    return (a > b) ? a : b;
}
",
    },
    Helper {
        name: "exceeding",
        text: "\
/** Not 0 where the magnitude of one of x, y and sum = x + y is more than `limit`: of x, y and -sum, which add up to 0,
 *  those above 0 add up to the largest magnitude. */
static inline int32_t exceeding(int32_t x, int32_t y, int32_t sum, int32_t limit)
{
    return ((max_of(x, 0) + max_of(y, 0)) - min_of(sum, 0) > limit) ? 1 : 0;
}
",
    },
    Helper {
        name: "clamp",
        text: "\
/** `low` below `low`, `high` above `high`. */
static inline int32_t clamp(int32_t x, int32_t low, int32_t high)
{
    return min_of(max_of(x, low), high);
}
",
    },
    Helper {
        name: "mul_round",
        text: "\
/** floor((coefficient signal + 2^(shift-1)) / 2^shift): rounded half up. */
static inline int32_t mul_round(int32_t coefficient, int32_t signal, uint16_t shift)
{
    const int64_t half = INT64_C(1) << (shift - 1);
    return shift_right_wide((int64_t)coefficient * signal + half, shift);
}
",
    },
    Helper {
        name: "mul_round_narrow",
        text: "\
/** As mul_round, for products that fit a word together with their rounding. */
static inline int32_t mul_round_narrow(int32_t coefficient, int32_t signal, uint16_t shift)
{
    return shift_right(coefficient * signal + (INT32_C(1) << (shift - 1)), shift);
}
",
    },
    Helper {
        name: "mul_floor",
        text: "\
/** floor(a b / 2^shift) */
static inline int32_t mul_floor(int32_t a, int32_t b, uint16_t shift)
{
    return shift_right_wide((int64_t)a * b, shift);
}
",
    },
    Helper {
        name: "mul_add_floor",
        text: "\
/** floor((a b + c d) / 2^shift) of a sum that fits 64 bits */
static inline int32_t mul_add_floor(int32_t a, int32_t b, int32_t c, int32_t d, uint16_t shift)
{
    return shift_right_wide((int64_t)a * b + (int64_t)c * d, shift);
}
",
    },
    Helper {
        name: "mul_limited",
        text: "\
/** min(a b, limit) for factors that are not negative; the product may exceed the word. */
static inline int32_t mul_limited(int32_t a, int32_t b, int32_t limit)
{
    const int64_t product = (int64_t)a * b;
    return (product < limit) ? (int32_t)product : limit;
}
",
    },
    Helper {
        name: "divide_digit",
        text: "\
/**
 * Quotient, below 2^16, of above 2^16 + next and a divisor above `above` with its highest bit set; `above` becomes the
 * rest.
 */
static inline uint32_t divide_digit(uint32_t *above, uint32_t next, uint32_t divisor)
{
    const uint32_t top = divisor >> 16;
    const uint32_t bottom = divisor & UINT32_C(0xffff);
    /* By the divisor's upper half alone the digit is up to two too large. */
    uint32_t digit = *above / top;
    uint32_t rest = *above - digit * top;
    if (digit * bottom > ((rest << 16) | next)) {
        digit -= 1U;
        rest += top;
        if ((rest >> 16) == 0U && digit * bottom > ((rest << 16) | next)) {
            digit -= 1U;
        }
    }
    *above = ((*above << 16) | next) - digit * divisor;
    return digit;
}
",
    },
    Helper {
        name: "divide",
        text: "\
/**
 * min(floor(numerator 2^shift / denominator), limit) for a numerator and a limit that are not negative, and a
 * denominator of at least 1: two digits of 16 bits (Knuth's algorithm D), for a library takes hundreds of instructions
 * to divide 64 bits. For paths off the normal one.
 */
static inline int32_t divide(int32_t numerator, int32_t denominator, int32_t limit, uint16_t shift)
{
    uint64_t dividend = (uint64_t)numerator << shift;
    uint32_t divisor = (uint32_t)denominator;
    uint32_t rest;
    uint32_t quotient;
    if ((dividend >> 32) >= divisor) {
        return limit;
    }
    if (divisor < UINT32_C(0x10000)) {
        divisor <<= 16;
        dividend <<= 16;
    }
    if (divisor < UINT32_C(0x1000000)) {
        divisor <<= 8;
        dividend <<= 8;
    }
    if (divisor < UINT32_C(0x10000000)) {
        divisor <<= 4;
        dividend <<= 4;
    }
    if (divisor < UINT32_C(0x40000000)) {
        divisor <<= 2;
        dividend <<= 2;
    }
    if (divisor < UINT32_C(0x80000000)) {
        divisor <<= 1;
        dividend <<= 1;
    }
    rest = (uint32_t)(dividend >> 32);
    quotient = divide_digit(&rest, (uint32_t)(dividend >> 16) & UINT32_C(0xffff), divisor) << 16;
    quotient |= divide_digit(&rest, (uint32_t)dividend & UINT32_C(0xffff), divisor);
    return (quotient < (uint32_t)limit) ? (int32_t)quotient : limit;
}
",
    },
    Helper {
        name: "divide_narrow",
        text: "\
/** As divide, where the shifted numerator fits 32 bits. */
static inline int32_t divide_narrow(int32_t numerator, int32_t denominator, int32_t limit, uint16_t shift)
{
    const uint32_t quotient = ((uint32_t)numerator << shift) / (uint32_t)denominator;
    return (quotient < (uint32_t)limit) ? (int32_t)quotient : limit;
}
",
    },
    Helper {
        name: "turn_over",
        text: "\
/** floor((2^32 - 1) / ticks): the angle per tick, where a turn, 2^32, lasts `ticks`, at least 2. */
static inline int32_t turn_over(int32_t ticks)
{
    return (int32_t)(UINT32_C(0xffffffff) / (uint32_t)ticks);
}
",
    },
    Helper {
        name: "angle_index",
        text: "\
/** Which of `segments` equal parts of a turn the angle lies in, from 0. */
static inline int32_t angle_index(int32_t angle, uint32_t segments)
{
    return (int32_t)(((uint64_t)(uint32_t)angle * segments) >> 32);
}
",
    },
    Helper {
        name: "angle_fraction",
        text: "\
/** The position within that part, 2^31 being its whole width. */
static inline int32_t angle_fraction(int32_t angle, uint32_t segments)
{
    return (int32_t)((uint32_t)((uint32_t)angle * segments) >> 1);
}
",
    },
];

/// The functions that a source of these words calls, and those that they call.
pub(super) fn used(words: &BTreeSet<String>) -> Vec<&'static str> {
    let mut words = words.clone();
    let mut used = vec![];
    for helper in HELPERS.iter().rev() {
        if words.contains(helper.name) {
            words.extend(super::layout::words(helper.text));
            used.push(helper.text);
        }
    }
    used.reverse();
    used
}

#[cfg(test)]
mod tests {
    use super::HELPERS;
    use std::process::Command;
    use std::{env, fs, process};

    /// Compares every helper with arithmetic in 128 bits; says the first difference.
    const COMPARISON: &str = include_str!("helpers_test.c");

    /// What the comparison says of these helpers.
    fn compared(helpers: &str, name: &str) -> String {
        let folder = env::temp_dir().join(format!("hexagen-helpers-{}-{name}", process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let source = folder.join("helpers.c");
        let text = format!("#include <stdbool.h>\n#include <stdint.h>\n{helpers}\n{COMPARISON}");
        fs::write(&source, text).expect("a file");
        let program = folder.join("helpers");
        let mut cc = Command::new(env::var_os("CC").unwrap_or_else(|| "cc".into()));
        cc.args([
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-Wconversion",
            "-Werror",
            "-O1",
        ])
        .args(["-fsanitize=undefined", "-fno-sanitize-recover", "-o"])
        .args([&program, &source]);
        let built = cc.output().expect("a C compiler: `cc`, or what `CC` names");
        assert!(
            built.status.success(),
            "{}",
            String::from_utf8_lossy(&built.stderr)
        );
        let run = Command::new(&program).output().expect("it runs");
        fs::remove_dir_all(&folder).expect("the folder goes");
        let said = [run.stdout, run.stderr].concat();
        String::from_utf8_lossy(&said).into_owned()
    }

    #[test]
    fn helpers_compute_what_their_comments_say() {
        let sound: String = HELPERS.iter().map(|helper| helper.text).collect();
        assert_eq!(compared(&sound, "sound"), "no difference\n");
        // That each of these is seen, and where.
        let faults = [
            ("abs_of", "(x < 0) ? -x", "(x < -1) ? -x"),
            ("exceeds", "limit > UINT32_C(2)", "limit >= UINT32_C(2)"),
            ("exceeding", "0) > limit)", "0) >= limit)"),
            (
                "divide",
                "return (quotient <",
                "quotient &= ~UINT32_C(1);\n    return (quotient <",
            ),
            ("divide", "< UINT32_C(0x80000000)", "< UINT32_C(0x40000000)"),
            (
                "divide",
                "(dividend >> 32) >= divisor",
                "(dividend >> 32) > divisor",
            ),
            ("divide", "        rest += top;\n", ""),
            (
                "divide_narrow",
                "/ (uint32_t)denominator",
                "/ ((uint32_t)denominator + 1U)",
            ),
            (
                "mul_round",
                "INT64_C(1) << (shift - 1)",
                "(INT64_C(1) << (shift - 1)) - 1",
            ),
            ("turn_over", "0xffffffff", "0xfffffffe"),
        ];
        for (place, (helper, old, new)) in faults.into_iter().enumerate() {
            assert!(sound.contains(old), "`{old}`");
            let said = compared(&sound.replacen(old, new, 1), &place.to_string());
            assert!(said.starts_with(&format!("{helper}(")), "`{new}`: {said}");
        }
    }
}
