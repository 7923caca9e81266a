//! The main program's half of a drive.

use crate::arith::{TORQUE_RATIO_BITS, Word, mul_round, scaled_torque};
use crate::bus::Bus;
use crate::control::Words;
use crate::shared::SharedWord;
use crate::signals::Port;
#[cfg(feature = "signals")]
use crate::signals::Signals;
use crate::trip::{Trip, TripRecord};
use crate::{Control, MeasuredBus, SpeedLoop, Status, Supervisor};
use core::fmt;
use fixed::types::I16F16;

/// The main program's half of a drive, shared with the control interrupt, which may interrupt it
/// anywhere. Both run on one core.
///
/// Setters of current, torque and speed may be called from anywhere, interrupts included: the last
/// call wins, and none disturbs another setter. Setters of an option, such as
/// [`set_speed`](Self::set_speed), exist only for drives with that option.
pub struct SetPoint<C: Control> {
    pub(crate) words: Words<C>,
    pub(crate) status: SharedWord,
    pub(crate) signals: Port,
    pub(crate) trip: TripRecord<C>,
    /// Stated over learnt torque constant, with `torque_learning: on` only.
    pub(crate) torque_ratio: SharedWord,
}

impl<C: Control> SetPoint<C> {
    pub(crate) const fn new() -> Self {
        Self {
            words: Words {
                current: SharedWord::new(C::SET_POINT),
                speed: SharedWord::new(Word(0)),
                bus: C::BUS,
            },
            status: SharedWord::new(Word(Supervisor::new(&C::LIMITS, &C::SENSORS).status_bits())),
            signals: Port::new(),
            trip: TripRecord::new(),
            torque_ratio: SharedWord::new(Word(1 << TORQUE_RATIO_BITS)),
        }
    }

    /// Sets the current in amperes, peak of the quasi-square wave; saturates at +-`max_current` of
    /// the specification.
    ///
    /// A positive current makes forward torque, a negative one backward torque, in either direction
    /// of rotation; against the rotation it brakes into the bus
    /// ([`conventions`](crate::conventions)). With a speed loop it limits the loop's current in
    /// both directions, whatever its sign.
    #[inline]
    pub fn set_current(&self, current: I16F16) {
        self.words
            .current
            .store(C::current(Word(current.to_bits())));
    }

    /// [`set_current`](Self::set_current) in milliamperes.
    #[inline]
    pub fn set_current_ma(&self, current: i32) {
        self.set_current(thousandths(current));
    }

    /// Sets the torque in newton metres; sign, saturation and speed loop as with
    /// [`set_current`](Self::set_current).
    ///
    /// With `torque_learning: on` the torque constant learnt so far makes the current: a program that sets the torque
    /// once uses what was known then.
    #[inline]
    pub fn set_torque(&self, torque: I16F16) {
        let mut bits = Word(torque.to_bits());
        if C::TORQUE_RATIO.is_some() {
            bits = scaled_torque(bits, self.torque_ratio.load());
        }
        self.words.current.store(C::torque(bits));
    }

    /// [`set_torque`](Self::set_torque) in millinewton metres.
    #[inline]
    pub fn set_torque_mnm(&self, torque: i32) {
        self.set_torque(thousandths(torque));
    }

    /// Sets the speed in rpm, forward positive; saturates at +-`max_speed` of the specification.
    /// Speed 0 brakes a turning rotor, and holds it, with up to the current limit; for no current
    /// set that to 0.
    #[inline]
    pub fn set_speed(&self, speed: I16F16)
    where
        C: SpeedLoop,
    {
        self.words.speed.store(C::speed(Word(speed.to_bits())));
    }

    /// [`set_speed`](Self::set_speed) in whole rpm.
    #[inline]
    pub fn set_speed_rpm(&self, speed: i32)
    where
        C: SpeedLoop,
    {
        self.set_speed(I16F16::saturating_from_num(speed));
    }

    /// Sets the bus voltage as an ADC count.
    ///
    /// A voltage above `over_voltage` or below `under_voltage` of the specification trips the drive in
    /// the next control period, as any call that takes effect does again after a reset. The law takes
    /// a voltage outside `bus_min` to `bus_max` as the nearer of them, and before the first call the
    /// nominal one. The status reports 100 ms without a call ([`Status::bus_is_stale`]).
    ///
    /// A call that interrupts another one has no effect; one that never resumes after an
    /// interruption blocks later calls for 65,536 control periods. From an interrupt that can
    /// interrupt the control loop: at most once per control period.
    #[inline]
    pub fn set_bus(&self, counts: u16)
    where
        C: MeasuredBus,
    {
        let fault = C::LIMITS.bus_fault(counts);
        self.words.bus.tell(C::bus(counts.into()), fault);
    }

    /// Mode and fault as of the last control period; may be called from anywhere while the control
    /// loop runs.
    #[inline]
    #[must_use]
    pub fn status(&self) -> Status {
        Status::from_bits(self.status.load().0, self.words.bus.is_stale())
    }

    /// The learnt torque constant over the stated one, two thirds to 1.5; 1 before anything is learnt, behind a
    /// `reset()`, and without `torque_learning: on`.
    #[must_use]
    pub fn torque_constant_ratio(&self) -> I16F16 {
        // 2^16/ratio with 15 of the ratio's fraction bits, which are enough for 16 of the quotient.
        const SHIFT: u32 = 13;
        let ratio = self.torque_ratio.load() >> SHIFT;
        let quotient = (1_i32 << 30).checked_div(ratio.0).unwrap_or_default();
        I16F16::from_bits(quotient << 1)
    }

    /// Largest torque against a direction of rotation, 0 for none; with a speed loop speed 0.
    pub(crate) fn oppose(&self, direction: Word) {
        if C::SPEED.is_some() {
            self.words.speed.store(Word(0));
        } else {
            let most = match direction.0.signum() {
                1 => -i32::MAX,
                0 => 0,
                _ => i32::MAX,
            };
            self.words.current.store(C::current(Word(most)));
        }
    }

    /// The control period in which the drive tripped, kept until a reset: what was sampled, the
    /// set-point, and at the front of `words`, as many as fit, the state words that
    /// [`Drive::state_names`](crate::Drive::state_names) names: those of the supervisor behind that
    /// period (the current offsets are among them), those of the law before it. `None` while the
    /// drive is not tripped, and if a reset interrupts the call.
    ///
    /// A step is a function of these words, with `torque_learning` also of whether the bus voltage was
    /// stale: the period can be computed again from them, bit for bit.
    /// A debugger finds them in the field `set_point.trip` of the drive.
    #[must_use]
    pub fn trip(&self, words: &mut [i32]) -> Option<Trip> {
        self.trip.read(words)
    }

    /// The set-point words, as the step of a trip reads them.
    pub(crate) fn demands(&self) -> [Word; 2] {
        [self.words.current.load(), self.words.speed.load()]
    }

    /// Whether the set-point (speed with a speed loop, else current) is not 0.
    #[inline]
    pub(crate) fn is_demanded(&self) -> bool {
        let set_point = if C::SPEED.is_some() {
            &self.words.speed
        } else {
            &self.words.current
        };
        set_point.load() != 0
    }

    /// Sets it to 0.
    pub(crate) fn clear(&self) {
        let set_point = if C::SPEED.is_some() {
            &self.words.speed
        } else {
            &self.words.current
        };
        set_point.store(Word(0));
    }

    /// The signals of one controlled period; `None`, and a request for those of the next one, if
    /// there are none yet.
    ///
    /// The control loop answers in its next controlled period. So a program that polls gets signals
    /// of a period that began after its first call:
    ///
    /// ```
    /// # use hexagen::{Control, SetPoint, Signals};
    /// /// To be called every few control periods.
    /// fn log<C: Control>(set_point: &SetPoint<C>) {
    ///     if let Some(Signals { currents: [a, b, c], .. }) = set_point.signals() {
    ///         // Send them.
    ///     }
    /// }
    /// ```
    ///
    /// Neither side waits for the other. Several contexts may ask: each gets all words of one
    /// period, or none. Feature `signals`, which takes about ten instructions of every control
    /// period.
    #[cfg(feature = "signals")]
    #[must_use]
    pub fn signals(&self) -> Option<Signals> {
        self.signals.take().map(|words| words.signals(&C::UNITS))
    }
}

/// Thousandths as a number with 16 fraction bits, rounded to the nearest; saturates.
fn thousandths(number: i32) -> I16F16 {
    const MOST: i32 = 32_767_999;
    // 2^16/1000 = 65.536: the integer part, and the fraction with 31 bits, for which one 32-bit
    // coefficient is too short.
    const WHOLE: i32 = 65;
    const REST: Word = Word(1_151_051_235);
    let number = Word(number).clamp(-MOST, MOST);
    I16F16::from_bits((number * WHOLE + mul_round(REST, number, 31)).0)
}

impl<C: Control> fmt::Debug for SetPoint<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        debug::<C>("SetPoint", self.status(), f)
    }
}

/// A drive or one of its halves: controller's name and status.
pub(crate) fn debug<C: Control>(
    part: &str,
    status: Status,
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    write!(f, "{part}<{}> ", C::NAME)?;
    fmt::Debug::fmt(&status, f)
}

#[cfg(test)]
mod tests {
    use super::{TORQUE_RATIO_BITS, Word, scaled_torque, thousandths};
    use fixed::types::I16F16;

    #[test]
    fn a_learnt_ratio_scales_a_torque_and_saturates() {
        let scaled = |bits: i32, ratio: f64| {
            let ratio = Word((ratio * f64::from(1 << TORQUE_RATIO_BITS)).round() as i32);
            scaled_torque(Word(bits), ratio).0
        };
        assert_eq!(scaled(65_536, 1.0), 65_536);
        assert_eq!(scaled(-65_536, 1.25), -81_920);
        assert_eq!(scaled(i32::MAX, 1.5), 3 << 29);
        assert_eq!(scaled(i32::MIN, 1.5), -(3 << 29));
    }

    #[test]
    fn thousandths_round_to_the_nearest_bit_and_saturate() {
        for number in (-32_767_999..=32_767_999).step_by(997) {
            let exact = f64::from(number) * 65.536;
            let found = f64::from(thousandths(number).to_bits());
            assert!(
                (found - exact).abs() < 0.51,
                "{number}: {found} for {exact}"
            );
        }
        assert_eq!(thousandths(5_000), I16F16::lit("5"));
        assert_eq!(thousandths(i32::MAX), thousandths(32_767_999));
        assert_eq!(thousandths(i32::MIN), thousandths(-32_767_999));
    }
}
