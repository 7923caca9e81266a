//! A place from which one context at a time takes its own: how `main` hands a control loop to its interrupt.
#![expect(
    unsafe_code,
    reason = "a static that is written needs a promise that its users do not meet"
)]

use core::cell::UnsafeCell;

/// A value that `main` puts here before it lets an interrupt run, and that is the interrupt's own from then on.
#[derive(Debug)]
pub struct Handed<T>(UnsafeCell<Option<T>>);

// SAFETY: the callers of the two functions below promise that they do not meet.
unsafe impl<T: Send> Sync for Handed<T> {}

impl<T> Handed<T> {
    /// Nothing yet.
    #[must_use]
    #[expect(clippy::new_without_default, reason = "stands in a static")]
    pub const fn new() -> Self {
        Self(UnsafeCell::new(None))
    }

    /// Puts the value here.
    ///
    /// # Safety
    /// Once, and before anything that takes it can run.
    #[expect(
        clippy::mut_from_ref,
        reason = "the callers promise that it is the only one"
    )]
    pub unsafe fn hand_over(&'static self, value: T) -> &'static mut T {
        // SAFETY: nobody else is here yet.
        unsafe { (*self.0.get()).insert(value) }
    }

    /// The value.
    ///
    /// # Safety
    /// Only behind [`Handed::hand_over`] and never beside the reference that it returned; from one context only, which
    /// does not interrupt itself.
    #[inline]
    #[expect(
        clippy::mut_from_ref,
        reason = "the callers promise that it is the only one"
    )]
    pub unsafe fn take_turn(&'static self) -> &'static mut T {
        // SAFETY: the value is here, and so is the caller alone.
        unsafe { (*self.0.get()).as_mut().unwrap_unchecked() }
    }
}
