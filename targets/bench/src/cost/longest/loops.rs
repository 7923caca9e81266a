//! Loops of library functions: how often each of their instructions is executed at most.
//!
//! Emitted steps have no loops. Those of the compilers' libraries are bounded here by what the
//! library's source proves; any other loop is refused.

/// Why a loop ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// After this many passes.
    Passes(u32),
    /// It writes bytes or words of a memory block, whose length is in this argument.
    Length(usize),
}

/// Library functions with loops, by a part of their names.
const BOUNDS: [(&str, Bound); 5] = [
    // Division of compiler_builtins by shift and subtraction: a pass for each bit by which the
    // dividend is longer than the divisor, both of 32 bits.
    ("u32_div_rem", Bound::Passes(31)),
    ("memcpy", Bound::Length(2)),
    // The length before the value, unlike in C's function.
    ("__aeabi_memset", Bound::Length(1)),
    ("memset", Bound::Length(2)),
    ("memclr", Bound::Length(1)),
];

/// Bytes from which the functions of compiler_builtins write words: shorter blocks byte by byte, of
/// longer ones less than a word in front and less than one behind.
const WORDS_FROM: u32 = 16;

/// The bound of a function's loops.
pub fn bound(function: &str) -> Option<Bound> {
    let mut bounds = BOUNDS.iter();
    bounds.find_map(|&(part, bound)| function.contains(part).then_some(bound))
}

/// Passes of a loop over a block of `length` bytes.
pub fn passes(length: u32, writes_bytes: bool) -> u32 {
    match writes_bytes {
        true if length < WORDS_FROM => length,
        true => 3,
        false => length / 4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_blocks_are_written_in_words() {
        assert_eq!([15, 16, 72].map(|length| passes(length, true)), [15, 3, 3]);
        assert_eq!([15, 16, 72].map(|length| passes(length, false)), [3, 4, 18]);
    }

    #[test]
    fn the_length_is_where_the_function_takes_it() {
        assert_eq!(bound("__aeabi_memset4"), Some(Bound::Length(1)));
        assert_eq!(bound("memset"), Some(Bound::Length(2)));
        assert_eq!(bound("step_x"), None);
    }
}
