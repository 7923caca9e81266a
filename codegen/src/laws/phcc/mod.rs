#![doc = include_str!("semantics.md")]

mod law;
mod lower;
mod table;

pub use law::law;
pub use lower::lower;
pub use table::switching_table;
