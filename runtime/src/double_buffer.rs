//! The double buffer through which the main program hands words to the control interrupt.

use crate::arith::Word;
use core::sync::atomic::{AtomicI32, AtomicUsize, Ordering, compiler_fence};

/// `N` words that are replaced as one, seen from an interrupt on the same core.
///
/// The writer fills the bank that is not in use and then publishes it with one store; an
/// interrupt that strikes in between still reads the old bank whole. One writer at a time, and
/// one core: order is kept by the compiler alone, which costs the interrupt no barrier.
#[derive(Debug)]
pub struct DoubleBuffer<const N: usize> {
    banks: [[AtomicI32; N]; 2],
    published: AtomicUsize,
}

impl<const N: usize> DoubleBuffer<N> {
    /// A buffer that holds `words`.
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
        Self {
            banks,
            published: AtomicUsize::new(0),
        }
    }

    /// The words last published.
    #[inline]
    #[must_use]
    pub fn read(&self) -> [Word; N] {
        let bank = &self.banks[self.published.load(Ordering::Relaxed) & 1];
        compiler_fence(Ordering::Acquire);
        core::array::from_fn(|word| Word(bank[word].load(Ordering::Relaxed)))
    }

    /// Lets `change` replace any of the words, and publishes all of them together.
    #[inline]
    pub fn update(&self, change: impl FnOnce(&mut [Word; N])) {
        let mut words = self.read();
        change(&mut words);
        let spare = (self.published.load(Ordering::Relaxed) & 1) ^ 1;
        for (to, from) in self.banks[spare].iter().zip(words) {
            to.store(from.0, Ordering::Relaxed);
        }
        compiler_fence(Ordering::Release);
        self.published.store(spare, Ordering::Relaxed);
    }
}
