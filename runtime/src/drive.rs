//! The traits of generated drives: the whole, and the two halves that firmware splits it into.

use crate::{Fault, Format, Legs, Sample, Status};
use fixed::types::I16F16;

/// A generated current controller of one motor, inverter and sampling time.
///
/// Generic firmware code holds any drive through this trait; the inherent methods of the emitted
/// type do the same with exactly the arguments that it needs.
///
/// ```
/// use hexagen::{Drive, DriveLoop, DriveSetPoint, Fault, Legs, Sample};
/// use hexagen::fixed::types::I16F16;
///
/// /// What the PWM interrupt owns.
/// fn interrupt(control: &mut impl DriveLoop, sample: &Sample) -> Legs {
///     control.step(sample)
/// }
///
/// /// What the main program does meanwhile.
/// fn main_program(set_point: &impl DriveSetPoint) -> Result<(), Fault> {
///     set_point.set_current(I16F16::from_num(5));
///     match set_point.status().fault {
///         Fault::None => Ok(()),
///         fault => Err(fault),
///     }
/// }
///
/// fn firmware<D: Drive>(drive: &'static mut D) {
///     let (set_point, mut control) = drive.split();
///     let legs = interrupt(&mut control, &Sample::default());
///     let outcome = main_program(set_point);
/// }
/// ```
pub trait Drive {
    /// The half that the main program shares with the interrupt.
    type SetPointHalf: DriveSetPoint;
    /// The half that the control interrupt owns.
    type LoopHalf<'drive>: DriveLoop
    where
        Self: 'drive;
    /// The type's name as written in the macro call.
    const NAME: &'static str;
    /// The normalised specification: TOML, SI units, defaults filled in.
    const SPEC: &'static str;
    /// The fixed-point format of every kind of signals, coefficient and table.
    const FORMATS: &'static [Format];
    /// Names of the state words, in the order of [`Drive::state_words`].
    const STATE_NAMES: &'static [&'static str];

    /// A drive with zero set-point that controls currents from its first step on, with nominal current offsets.
    /// Where offsets or bootstrap capacitors need it, call [`Drive::calibrate`] before the first step.
    fn new() -> Self
    where
        Self: Sized;
    /// The two halves: an interrupt owns the control loop, the main program the set-point.
    fn split(&mut self) -> (&Self::SetPointHalf, Self::LoopHalf<'_>);
    /// The set-point of a drive that is not split.
    fn set_point(&self) -> &Self::SetPointHalf;
    /// Copies the state words, in the order of [`Drive::STATE_NAMES`], to the front of `words`; does nothing where they
    /// do not fit. For verification.
    fn state_words(&self, words: &mut [i32]);
    /// Overwrites state word `index` (of [`Drive::STATE_NAMES`]) with a value inside its range. For verification.
    fn set_state_word(&mut self, index: usize, value: i32);

    /// See [`DriveLoop::step`].
    #[inline]
    fn step(&mut self, sample: &Sample) -> Legs {
        self.split().1.step(sample)
    }
    /// See [`DriveSetPoint::set_current`].
    fn set_current(&self, current: I16F16) {
        self.set_point().set_current(current);
    }
    /// See [`DriveSetPoint::set_torque`].
    fn set_torque(&self, torque: I16F16) {
        self.set_point().set_torque(torque);
    }
    /// See [`DriveSetPoint::set_speed`].
    fn set_speed(&self, speed: I16F16) {
        self.set_point().set_speed(speed);
    }
    /// See [`DriveSetPoint::set_bus`].
    fn set_bus(&self, counts: u16) {
        self.set_point().set_bus(counts);
    }
    /// See [`DriveLoop::reset`].
    fn reset(&mut self) {
        self.split().1.reset();
    }
    /// See [`DriveLoop::calibrate`].
    fn calibrate(&mut self) {
        self.split().1.calibrate();
    }
    /// See [`DriveLoop::precharge`].
    fn precharge(&mut self) {
        self.split().1.precharge();
    }
    /// What the drive is doing, and what tripped it.
    fn status(&self) -> Status {
        self.set_point().status()
    }
    /// Why the drive is tripped, or [`Fault::None`].
    fn fault(&self) -> Fault {
        self.status().fault
    }
    /// Whether currents are controlled: neither calibrating, pre-charging nor tripped.
    fn is_running(&self) -> bool {
        self.status().is_running()
    }
}

/// The half of a drive that the main program shares with the control interrupt.
///
/// `set_current` and `set_torque` may be called from anywhere, interrupts included: the last call
/// wins. A call of `set_bus` that interrupts another one of the same drive has no effect, and from
/// an interrupt that can interrupt the control loop it may be called once per control period. One that
/// was interrupted for good keeps later calls from having an effect for
/// [65536 control periods](crate::DoubleBuffer::GIVEN_UP), and [`Status::bus_is_stale`] says so meanwhile.
pub trait DriveSetPoint: Sync {
    /// Sets the current set-point in amperes (peak of the quasi-square wave); saturates at the
    /// largest current of the specification to both sides. Positive makes torque forward, negative backward,
    /// whichever way the rotor turns; against the rotation it brakes into the bus
    /// ([`conventions`](crate::conventions)).
    fn set_current(&self, current: I16F16);
    /// Sets the torque set-point in newton metres; sign and saturation likewise.
    fn set_torque(&self, torque: I16F16);
    /// Sets the speed in rpm, forward positive; saturates at the greatest speed of the specification. Does nothing for
    /// drives without `speed_loop: on`; with it, `set_current` and `set_torque` set the greatest current that the speed
    /// regulator asks for.
    fn set_speed(&self, _speed: I16F16) {}
    /// Tells the bus voltage as an ADC count. A voltage outside `bus_min` to `bus_max` of the specification counts as the
    /// nearer of these, without a fault; until the first call the nominal voltage holds. Where calls cease, the
    /// status says so from 100 ms on ([`Status::bus_is_stale`]). Does nothing for drives with `v_bus: fixed`.
    fn set_bus(&self, counts: u16);
    /// What the drive is doing, and what tripped it: as its control loop last said, which may go on
    /// meanwhile.
    fn status(&self) -> Status;
}

/// The half of a drive that the control interrupt owns.
pub trait DriveLoop: Send {
    /// Runs one control period: reads the sample, returns the command for the inverter, publishes
    /// the status.
    fn step(&mut self, sample: &Sample) -> Legs;
    /// Clears a trip and all control state; keeps calibrated offsets and the set-point, at which the next step
    /// goes on. Ignored while calibrating and pre-charging.
    fn reset(&mut self);
    /// Starts current-offset calibration: all legs off, the motor at rest. Pre-charge, where the specification has
    /// one, and control at the set-point that stands follow by themselves. Ignored when tripped.
    fn calibrate(&mut self);
    /// Starts bootstrap pre-charge: all lower switches on, which short-circuits a motor that turns; control follows by
    /// itself. Accepted from control, too: call it at rest only. Ignored when tripped, while calibrating,
    /// and where the specification has no pre-charge.
    fn precharge(&mut self);
    /// What the drive is doing, and what tripped it.
    fn status(&self) -> Status;
}
