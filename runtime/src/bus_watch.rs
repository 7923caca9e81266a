//! Age of the measured bus voltage, and what is wrong with it.

use crate::Fault;
use crate::arith::Word;
use crate::double_buffer::Place;
use core::sync::atomic::AtomicI32;

/// Counts control periods since `set_bus` last took effect.
///
/// [`told`](Self::told) may be called from any context; [`pass_period`](Self::pass_period) by the
/// control loop only, once a period. An interrupt between the two loses neither.
#[derive(Debug)]
pub(crate) struct BusWatch(Watch<AtomicI32>);

impl BusWatch {
    /// Initial state: stale.
    #[must_use]
    pub(crate) const fn new() -> Self {
        Self(Watch {
            told: AtomicI32::new(NO),
            left: AtomicI32::new(0),
        })
    }

    /// `set_bus` took effect, with a voltage that has this fault.
    #[inline]
    pub(crate) fn told(&self, fault: Option<Fault>) {
        self.0.told(fault.map_or(SOUND, |fault| fault as i32));
    }

    /// A control period has passed; the voltage is stale after `periods` of them without a call.
    /// Returns the fault of the voltage that was told since the last period, if it has one.
    #[inline]
    pub(crate) fn pass_period(&self, periods: Word) -> Option<Fault> {
        Fault::from_number(self.0.pass_period(periods.0))
    }

    /// Whether the voltage is stale, as of the last control period.
    #[inline]
    #[must_use]
    pub(crate) fn is_stale(&self) -> bool {
        self.0.is_stale()
    }
}

/// `told`: not since the last period. Any other number: since then, by a call whose voltage is
/// sound, or has the fault of this number.
pub(crate) const NO: i32 = 0;
pub(crate) const SOUND: i32 = -1;

/// The watch over any kind of memory cell.
#[derive(Debug)]
pub(crate) struct Watch<P> {
    /// Set by `set_bus`, cleared by the control loop: a count that both sides write would lose a
    /// call between the control loop's load and store.
    pub(crate) told: P,
    /// Periods until the voltage is stale; written by the control loop only.
    pub(crate) left: P,
}

impl<P: Place> Watch<P> {
    #[inline]
    pub(crate) fn told(&self, what: i32) {
        self.told.store(what);
    }

    #[inline]
    pub(crate) fn pass_period(&self, periods: i32) -> i32 {
        let told = self.told.load();
        if told != NO {
            self.told.store(NO);
            self.left.store(periods);
            return told;
        }
        let left = self.left.load();
        if left != 0 {
            self.left.store(left.wrapping_sub(1));
        }
        NO
    }

    #[inline]
    pub(crate) fn is_stale(&self) -> bool {
        self.left.load() == 0
    }
}
