#![doc = include_str!("semantics.md")]

mod law;
mod lower;
mod options;
mod table;

pub use law::law;
pub use lower::lower;
pub(crate) use options::check_options;
pub use options::{PhccCandidates, PhccSpec, SwitchingTable};
pub use table::switching_table;
