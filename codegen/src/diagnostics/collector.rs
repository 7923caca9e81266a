//! Collecting errors so that one run reports all of them.

use super::{Code, Diagnostic};

/// All errors of one run; never empty.
#[derive(Clone, Debug)]
pub struct Diagnostics {
    errors: Vec<Diagnostic>,
}

impl Diagnostics {
    /// The errors in the order in which they were found.
    pub fn as_slice(&self) -> &[Diagnostic] {
        &self.errors
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(error: Diagnostic) -> Self {
        Self {
            errors: vec![error],
        }
    }
}

impl IntoIterator for Diagnostics {
    type Item = Diagnostic;
    type IntoIter = std::vec::IntoIter<Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.errors.into_iter()
    }
}

impl std::error::Error for Diagnostics {}

/// Takes errors while a stage goes on; must be finished by [`Collector::into_result`] or
/// [`Collector::finish`], else dropping it panics in debug builds.
#[derive(Debug, Default)]
#[must_use = "a collector holds errors until it is finished"]
pub struct Collector {
    errors: Vec<Diagnostic>,
    finished: bool,
}

impl Collector {
    /// An empty collector.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes an error.
    pub fn push(&mut self, error: Diagnostic) {
        self.errors.push(error);
    }

    /// Takes several errors.
    pub fn extend(&mut self, errors: impl IntoIterator<Item = Diagnostic>) {
        self.errors.extend(errors);
    }

    /// Takes the error of a result; the value goes on.
    pub fn take<T>(&mut self, result: Result<T, Diagnostic>) -> Option<T> {
        result.map_err(|error| self.push(error)).ok()
    }

    /// Whether an error of this code was taken.
    pub fn has(&self, code: Code) -> bool {
        self.errors.iter().any(|error| error.code == code)
    }

    /// Whether no error was taken so far.
    pub fn is_empty(&self) -> bool {
        self.errors.is_empty()
    }

    /// The barrier: `value` if no error was taken.
    ///
    /// # Errors
    /// All errors that were taken.
    pub fn into_result<T>(self, value: T) -> Result<T, Diagnostics> {
        self.finish().map_or(Ok(value), Err)
    }

    /// The errors that were taken, if any.
    pub fn finish(mut self) -> Option<Diagnostics> {
        self.finished = true;
        let errors = std::mem::take(&mut self.errors);
        (!errors.is_empty()).then_some(Diagnostics { errors })
    }
}

impl Drop for Collector {
    fn drop(&mut self) {
        debug_assert!(
            self.finished || std::thread::panicking(),
            "a collector of diagnostics was dropped without being finished"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::Collector;

    #[test]
    #[should_panic(expected = "without being finished")]
    #[cfg(debug_assertions)]
    fn a_forgotten_collector_panics() {
        let forgotten = Collector::new();
        drop(forgotten);
    }

    #[test]
    fn an_empty_collector_lets_the_value_pass() {
        assert_eq!(Collector::new().into_result(7).ok(), Some(7));
    }
}
