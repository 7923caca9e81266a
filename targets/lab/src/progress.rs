//! Progress of long computations.

/// Observer of a long computation.
pub trait Progress: Sync {
    /// A computation of this many units begins.
    fn begin(&self, what: &'static str, units: u64);
    /// This many more units are done.
    fn advance(&self, units: u64);
}

/// No observer.
impl Progress for () {
    fn begin(&self, _: &'static str, _: u64) {}
    fn advance(&self, _: u64) {}
}
