//! The double buffer through which the main program hands words to the control interrupt.

use core::sync::atomic::{AtomicI32, AtomicUsize, Ordering};

/// `N` words that are replaced as one, seen from an interrupt on the same core.
///
/// The writer fills the bank that is not in use and then publishes it with one store; an
/// interrupt that strikes in between still reads the old bank whole. One writer, one core.
#[derive(Debug)]
pub struct DoubleBuffer<const N: usize> {
    banks: [[AtomicI32; N]; 2],
    published: AtomicUsize,
}

impl<const N: usize> DoubleBuffer<N> {
    /// A buffer that holds `words`.
    #[must_use]
    pub const fn new(words: [i32; N]) -> Self {
        const { assert!(N > 0) };
        let banks = [[const { AtomicI32::new(0) }; N], [const { AtomicI32::new(0) }; N]];
        let mut word = 0;
        let mut filled = banks;
        while word < N {
            filled[0][word] = AtomicI32::new(words[word]);
            filled[1][word] = AtomicI32::new(words[word]);
            word += 1;
        }
        Self { banks: filled, published: AtomicUsize::new(0) }
    }

    /// The words last published.
    #[inline]
    pub fn read(&self) -> [i32; N] {
        let bank = &self.banks[self.published.load(Ordering::Acquire) & 1];
        core::array::from_fn(|word| bank[word].load(Ordering::Relaxed))
    }

    /// Replaces one word and publishes it together with the others.
    #[inline]
    pub fn write(&self, index: usize, value: i32) {
        let current = self.published.load(Ordering::Relaxed) & 1;
        let spare = current ^ 1;
        for (word, (to, from)) in self.banks[spare].iter().zip(&self.banks[current]).enumerate() {
            let value = if word == index { value } else { from.load(Ordering::Relaxed) };
            to.store(value, Ordering::Relaxed);
        }
        self.published.store(spare, Ordering::Release);
    }
}
