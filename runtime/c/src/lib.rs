//! The C99 runtime of emitted drives: `hexagen.h` and `hexagen.c`, which the generator writes once,
//! next to the drives of a program.

/// Text of `hexagen.h`: types, arithmetic, and the supervisor's part of a controlled period.
pub const HEADER: &str = include_str!("../hexagen.h");

/// Text of `hexagen.c`: everything off the normal path.
pub const SOURCE: &str = include_str!("../hexagen.c");

/// Both files by name.
pub const FILES: [(&str, &str); 2] = [("hexagen.h", HEADER), ("hexagen.c", SOURCE)];

/// `HEXAGEN_ABI` of the header, which emitted drives check.
pub const ABI: u32 = 7;
