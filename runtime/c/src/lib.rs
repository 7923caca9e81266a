//! The runtime of emitted drives in C99: `hexagen.h` and `hexagen.c`, which the generator writes
//! beside the drives of a program, once for all of them.

/// Text of `hexagen.h`: types, arithmetic, and what a controlled period takes of the supervisor.
pub const HEADER: &str = include_str!("../hexagen.h");

/// Text of `hexagen.c`: everything off the normal path.
pub const SOURCE: &str = include_str!("../hexagen.c");

/// Both files under their names.
pub const FILES: [(&str, &str); 2] = [("hexagen.h", HEADER), ("hexagen.c", SOURCE)];

/// `HEXAGEN_ABI` of the header, which emitted drives ask for.
pub const ABI: u32 = 1;
