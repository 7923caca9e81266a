//! The bus voltage of a drive: fixed by its specification, or measured.

use crate::Fault;
use crate::arith::Word;
use crate::bus_watch::BusWatch;
use crate::double_buffer::DoubleBuffer;
use core::fmt::Debug;

/// Source of a drive's bus voltage.
pub trait Bus: Debug + Send + Sync + 'static {
    /// Words of the voltage.
    type Words: Copy;
    /// Words of the last call.
    fn read(&self) -> Self::Words;
    /// Replaces them together, by those of a voltage with this fault; false, without effect, if the
    /// call interrupts another one.
    fn tell(&self, words: Self::Words, fault: Option<Fault>) -> bool;
    /// Ages the voltage by a control period. Returns the fault of the voltage that was told since the
    /// last period, if it has one.
    fn pass_period(&self) -> Option<Fault>;
    /// Whether the last call that took effect is too old.
    fn is_stale(&self) -> bool;
    /// Words of the last call, two at most; 0 where there are none.
    fn kept(&self) -> [i32; 2];
}

/// A voltage fixed by the specification: no words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FixedBus;

impl Bus for FixedBus {
    type Words = ();

    #[inline]
    fn read(&self) {}

    #[inline]
    fn tell(&self, (): (), _: Option<Fault>) -> bool {
        false
    }

    #[inline]
    fn pass_period(&self) -> Option<Fault> {
        None
    }

    #[inline]
    fn is_stale(&self) -> bool {
        false
    }

    #[inline]
    fn kept(&self) -> [i32; 2] {
        [0; 2]
    }
}

/// A voltage set by `set_bus`, as `N` words that belong together; stale before the first call, and
/// after `PERIODS` control periods without a call that takes effect.
#[derive(Debug)]
pub struct ToldBus<const N: usize, const PERIODS: i32> {
    words: DoubleBuffer<N>,
    watch: BusWatch,
}

impl<const N: usize, const PERIODS: i32> ToldBus<N, PERIODS> {
    /// Initial state, with the words of the nominal voltage.
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
    fn tell(&self, words: [Word; N], fault: Option<Fault>) -> bool {
        let takes_effect = self.words.store(words);
        if takes_effect {
            self.watch.told(fault);
        }
        takes_effect
    }

    #[inline]
    fn pass_period(&self) -> Option<Fault> {
        self.words.pass_period();
        self.watch.pass_period(Word(PERIODS))
    }

    #[inline]
    fn is_stale(&self) -> bool {
        self.watch.is_stale()
    }

    fn kept(&self) -> [i32; 2] {
        let words = self.read();
        let word = |index: usize| words.get(index).map_or(0, |word| word.0);
        [word(0), word(1)]
    }
}
