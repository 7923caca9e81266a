//! Double buffer that passes words that belong together to the control interrupt.
//!
//! On one core an interrupt runs to completion between two accesses of the context it interrupts.
//! The tests run every operation between every two accesses of every other.

#[cfg(test)]
mod tests;

use crate::arith::Word;
use core::sync::atomic::{AtomicI32, Ordering, compiler_fence};

/// `N` words that are replaced together, while other contexts of the same core may read.
///
/// A store fills the unused bank and then publishes it, so a read that interrupts it gets the old
/// words. A compiler fence keeps the order, at no cost at run time.
///
/// - Reads: from any context.
/// - Stores: from any context; one that interrupts another store of the same buffer has no effect,
///   and returns false. A store that never resumes, as in a task that was killed, blocks later ones
///   for [`GIVEN_UP`](Self::GIVEN_UP) control periods; if it does resume after them, a concurrent
///   read may get words of two stores.
/// - A store may interrupt a read, which gets either all old or all new words. The next store fills
///   the bank that the read began with: contexts that can interrupt the reader may store once per
///   read.
#[derive(Debug)]
pub struct DoubleBuffer<const N: usize>(Banks<AtomicI32, N>);

impl<const N: usize> DoubleBuffer<N> {
    /// Control periods after which an unfinished store is given up.
    pub const GIVEN_UP: i32 = 1 << 16;

    /// A buffer with these words.
    #[must_use]
    pub const fn new(words: [Word; N]) -> Self {
        const { assert!(N > 0) };
        let mut banks = [const { [const { AtomicI32::new(0) }; N] }; 2];
        let mut word = 0;
        while word < N {
            banks[0][word] = AtomicI32::new(words[word].0);
            banks[1][word] = AtomicI32::new(words[word].0);
            word += 1;
        }
        let [first, second] = banks;
        Self(Banks {
            first,
            second,
            published: AtomicI32::new(FIRST),
            storing: AtomicI32::new(NO),
        })
    }

    /// The published words.
    #[inline]
    #[must_use]
    pub fn read(&self) -> [Word; N] {
        self.0.read()
    }

    /// Replaces all words together; false, without effect, if it interrupts another store.
    #[inline]
    pub fn store(&self, words: [Word; N]) -> bool {
        self.0.store(words, Self::GIVEN_UP)
    }

    /// Ages a store in progress by a control period; called by the control loop.
    #[inline]
    pub fn pass_period(&self) {
        self.0.pass_period();
    }
}

/// `published`: the first bank. Any other number is the second.
const FIRST: i32 = 0;
const SECOND: i32 = 1;
/// `storing`: no store in progress. Any other number: periods left of one.
const NO: i32 = 0;

/// A memory cell that several contexts access.
pub(crate) trait Place {
    fn load(&self) -> i32;
    fn store(&self, value: i32);
}

impl Place for AtomicI32 {
    #[inline]
    fn load(&self) -> i32 {
        self.load(Ordering::Relaxed)
    }

    #[inline]
    fn store(&self, value: i32) {
        self.store(value, Ordering::Relaxed);
    }
}

/// The buffer over any kind of memory cell.
#[derive(Debug)]
struct Banks<P, const N: usize> {
    first: [P; N],
    second: [P; N],
    published: P,
    storing: P,
}

impl<P: Place, const N: usize> Banks<P, N> {
    #[inline]
    fn read(&self) -> [Word; N] {
        let bank = if self.published.load() == FIRST {
            &self.first
        } else {
            &self.second
        };
        compiler_fence(Ordering::Acquire);
        let mut words = [Word(0); N];
        // Without iterators, here and below: they keep bounds checks at `opt-level = "s"`.
        let mut index = 0;
        while let (Some(word), Some(place)) = (words.get_mut(index), bank.get(index)) {
            *word = Word(place.load());
            index = index.wrapping_add(1);
        }
        words
    }

    #[inline]
    fn store(&self, words: [Word; N], periods: i32) -> bool {
        // The interrupted store would go on filling the bank that this one publishes.
        if self.storing.load() != NO {
            return false;
        }
        self.storing.store(periods);
        compiler_fence(Ordering::SeqCst);
        let (spare, number) = if self.published.load() == FIRST {
            (&self.second, SECOND)
        } else {
            (&self.first, FIRST)
        };
        let mut index = 0;
        while let (Some(place), Some(word)) = (spare.get(index), words.get(index)) {
            place.store(word.0);
            index = index.wrapping_add(1);
        }
        compiler_fence(Ordering::Release);
        self.published.store(number);
        compiler_fence(Ordering::Release);
        self.storing.store(NO);
        true
    }

    #[inline]
    fn pass_period(&self) {
        let left = self.storing.load();
        if left != NO {
            self.storing.store(left.wrapping_sub(1));
        }
    }
}
