//! Whether the bus voltage goes on being told.

use crate::arith::Word;
use crate::double_buffer::Place;
use core::sync::atomic::AtomicI32;

/// Counts control periods since `set_bus` last took effect, of a drive that is told its bus voltage.
///
/// [`told`](Self::told) from any context; [`pass_period`](Self::pass_period) from the control loop
/// alone, once a period. Nothing of it is lost to an interrupt of either by the other.
#[derive(Debug)]
pub(crate) struct BusWatch(Watch<AtomicI32>);

impl BusWatch {
    /// The watch of a drive that was never told: stale.
    #[must_use]
    pub(crate) const fn new() -> Self {
        Self(Watch {
            told: AtomicI32::new(NO),
            left: AtomicI32::new(0),
        })
    }

    /// `set_bus` took effect.
    #[inline]
    pub(crate) fn told(&self) {
        self.0.told();
    }

    /// A control period has passed; the voltage is stale where `periods` of them have since it was told.
    #[inline]
    pub(crate) fn pass_period(&self, periods: Word) {
        self.0.pass_period(periods.0);
    }

    /// Whether the voltage is stale, as of the last control period.
    #[inline]
    #[must_use]
    pub(crate) fn is_stale(&self) -> bool {
        self.0.is_stale()
    }
}

/// `told`: not since the last period. Any other number: since then.
pub(crate) const NO: i32 = 0;
const YES: i32 = 1;

/// The watch over any kind of place.
#[derive(Debug)]
pub(crate) struct Watch<P> {
    /// Set where the voltage is told, cleared where that is seen: a count that both sides write would
    /// lose what is told between its load and its store.
    pub(crate) told: P,
    /// Periods until the voltage is stale; the control loop's own.
    pub(crate) left: P,
}

impl<P: Place> Watch<P> {
    #[inline]
    pub(crate) fn told(&self) {
        self.told.store(YES);
    }

    #[inline]
    pub(crate) fn pass_period(&self, periods: i32) {
        if self.told.load() != NO {
            self.told.store(NO);
            self.left.store(periods);
            return;
        }
        let left = self.left.load();
        if left != 0 {
            self.left.store(left.wrapping_sub(1));
        }
    }

    #[inline]
    pub(crate) fn is_stale(&self) -> bool {
        self.left.load() == 0
    }
}
