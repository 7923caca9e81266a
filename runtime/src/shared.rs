//! A word that one part of the firmware writes and another reads.

use crate::arith::Word;
use core::sync::atomic::{AtomicI32, Ordering};

/// A word that may be stored and loaded from the main program and from interrupts alike, in one
/// instruction each: a load sees one store whole, and the last store stays.
#[derive(Debug)]
pub(crate) struct SharedWord(AtomicI32);

impl SharedWord {
    pub(crate) const fn new(word: Word) -> Self {
        Self(AtomicI32::new(word.0))
    }

    #[inline]
    pub(crate) fn load(&self) -> Word {
        Word(self.0.load(Ordering::Relaxed))
    }

    #[inline]
    pub(crate) fn store(&self, word: Word) {
        self.0.store(word.0, Ordering::Relaxed);
    }
}
