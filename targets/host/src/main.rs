//! The hexagen program.
fn main() {}
