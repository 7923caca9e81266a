//! Long work, watched.

/// Whoever wants to know how far long work has come.
pub trait Progress: Sync {
    /// Work of so many units begins.
    fn begin(&self, what: &'static str, units: u64);
    /// So many more units are done.
    fn advance(&self, units: u64);
}

/// Nobody.
impl Progress for () {
    fn begin(&self, _: &'static str, _: u64) {}
    fn advance(&self, _: u64) {}
}
