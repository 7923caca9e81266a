//! How long this thread has been at each part of the generator: what `cargo xtask compile-time` prints.
//!
//! A part that runs inside another takes its time from it; what a second thread does beside this one takes no time but
//! that of waiting for it. Nothing else depends on these times.

use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

/// A part of the generator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Macro tokens and motor files read and checked.
    Parsing,
    /// Gains, tables, stability, formats, lowering.
    Design,
    /// Intervals of all values verified, and their distance from the ideal ones bounded.
    ProofRanges,
    /// Tokens of the emitted code.
    Emission,
}

thread_local! {
    static TAKEN: RefCell<[Duration; 4]> = const { RefCell::new([Duration::ZERO; 4]) };
    static RUNNING: Cell<Option<(Part, Instant)>> = const { Cell::new(None) };
}

impl Part {
    /// All, in their order.
    pub const ALL: [Self; 4] = [
        Self::Parsing,
        Self::Design,
        Self::ProofRanges,
        Self::Emission,
    ];

    /// The time that this thread has been at this part.
    pub fn taken(self) -> Duration {
        TAKEN.with_borrow(|taken| taken[self as usize])
    }

    /// Does the work of this part.
    pub(crate) fn timed<T>(self, work: impl FnOnce() -> T) -> T {
        let outer = RUNNING.get().map(|(part, _)| part);
        switch(Some(self));
        let result = work();
        switch(outer);
        result
    }
}

/// Ends what runs and begins the next part.
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
