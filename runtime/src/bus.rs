//! The bus voltage that a drive goes by: its specification's, or one that it is told.

use crate::arith::Word;
use crate::bus_watch::BusWatch;
use crate::double_buffer::DoubleBuffer;
use core::fmt::Debug;

/// Where a drive has its bus voltage from.
pub trait Bus: Debug + Send + Sync + 'static {
    /// What a step reads of it.
    type Words: Copy;
    /// The words last told.
    fn read(&self) -> Self::Words;
    /// Replaces them together; false where the call interrupts another one, and does nothing.
    fn tell(&self, words: Self::Words) -> bool;
    /// A control period has passed.
    fn pass_period(&self);
    /// Whether no call took effect for long.
    fn is_stale(&self) -> bool;
}

/// A voltage that the specification fixes: no word at all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FixedBus;

impl Bus for FixedBus {
    type Words = ();

    #[inline]
    fn read(&self) {}

    #[inline]
    fn tell(&self, (): ()) -> bool {
        false
    }

    #[inline]
    fn pass_period(&self) {}

    #[inline]
    fn is_stale(&self) -> bool {
        false
    }
}

/// A voltage that is told by `set_bus`, as `N` words that belong together; stale where `PERIODS`
/// control periods pass without a call that takes effect, and until the first.
#[derive(Debug)]
pub struct ToldBus<const N: usize, const PERIODS: i32> {
    words: DoubleBuffer<N>,
    watch: BusWatch,
}

impl<const N: usize, const PERIODS: i32> ToldBus<N, PERIODS> {
    /// A voltage that was not told yet, with the nominal one's words.
    #[must_use]
    pub const fn new(words: [Word; N]) -> Self {
        Self {
            words: DoubleBuffer::new(words),
            watch: BusWatch::new(),
        }
    }
}

impl<const N: usize, const PERIODS: i32> Bus for ToldBus<N, PERIODS> {
    type Words = [Word; N];

    #[inline]
    fn read(&self) -> [Word; N] {
        self.words.read()
    }

    #[inline]
    fn tell(&self, words: [Word; N]) -> bool {
        let takes_effect = self.words.store(words);
        if takes_effect {
            self.watch.told();
        }
        takes_effect
    }

    #[inline]
    fn pass_period(&self) {
        self.words.pass_period();
        self.watch.pass_period(Word(PERIODS));
    }

    #[inline]
    fn is_stale(&self) -> bool {
        self.watch.is_stale()
    }
}
