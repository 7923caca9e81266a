//! A word shared by contexts of one core.

use crate::arith::Word;
use core::sync::atomic::{AtomicI32, Ordering};

/// A word that the main program and interrupts may store and load in one instruction each: a load
/// gets one whole store, and the last store wins.
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
