//! Two tasks in parallel: the compiler uses one core, and waits for its macros.

use std::panic::resume_unwind;
use std::thread::scope;

/// Runs both, the first in a second thread.
pub fn at_once<A: Send, B>(first: impl FnOnce() -> A + Send, second: impl FnOnce() -> B) -> (A, B) {
    scope(|scope| {
        let first = scope.spawn(first);
        let second = second();
        let first = first.join();
        (first.unwrap_or_else(|panic| resume_unwind(panic)), second)
    })
}
