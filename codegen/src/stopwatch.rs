//! Time that this thread spends in each part of the generator, for `cargo xtask compile-time`.
//!
//! The time of a nested part is not counted for the outer one; work of a second thread counts as
//! the time of waiting for it. Nothing else depends on these times.

use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

/// A part of the generator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Parsing and checks of macro tokens and motor files.
    Parsing,
    /// Gains, tables, stability, formats, lowering.
    Design,
    /// Verification and error bounds.
    ProofRanges,
    /// Tokens of the emitted code.
    Emission,
}

thread_local! {
    static TAKEN: RefCell<[Duration; 4]> = const { RefCell::new([Duration::ZERO; 4]) };
    static RUNNING: Cell<Option<(Part, Instant)>> = const { Cell::new(None) };
}

impl Part {
    /// All parts, in order.
    pub const ALL: [Self; 4] = [
        Self::Parsing,
        Self::Design,
        Self::ProofRanges,
        Self::Emission,
    ];

    /// Time that this thread has spent in this part.
    pub fn taken(self) -> Duration {
        TAKEN.with_borrow(|taken| taken[self as usize])
    }

    /// Runs work of this part.
    pub(crate) fn timed<T>(self, work: impl FnOnce() -> T) -> T {
        let outer = RUNNING.get().map(|(part, _)| part);
        switch(Some(self));
        let result = work();
        switch(outer);
        result
    }
}

/// Ends the running part and begins the next one.
fn switch(next: Option<Part>) {
    let now = Instant::now();
    let ended = RUNNING.replace(next.map(|part| (part, now)));
    if let Some((part, since)) = ended {
        TAKEN.with_borrow_mut(|taken| taken[part as usize] += now - since);
    }
}

#[cfg(test)]
mod tests {
    use super::Part;
    use std::thread::sleep;
    use std::time::Duration;

    #[test]
    fn an_inner_part_takes_its_time_from_the_outer_one() {
        let nap = Duration::from_millis(20);
        let begin = Part::ALL.map(Part::taken);
        Part::Design.timed(|| {
            Part::ProofRanges.timed(|| sleep(3 * nap));
            sleep(nap);
        });
        let taken = Part::ALL.map(Part::taken);
        let [parsing, design, proof, emission] =
            [0, 1, 2, 3].map(|part| taken[part].saturating_sub(begin[part]));
        assert!(
            proof >= 3 * nap && design >= nap && design < proof,
            "{taken:?}"
        );
        assert_eq!((parsing, emission), (Duration::ZERO, Duration::ZERO));
    }
}
