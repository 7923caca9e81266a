//! The trait that every generated drive implements.

use crate::{Fault, Format, Legs, Sample};
use fixed::types::I16F16;

/// A generated current controller of one motor, inverter and sampling time.
///
/// Generic firmware code holds any drive through this trait; the inherent methods of the emitted
/// type do the same with exactly the arguments that it needs.
pub trait Drive {
    /// The type's name as written in the macro call.
    const NAME: &'static str;
    /// The normalised specification: TOML, SI units, defaults filled in.
    const SPEC: &'static str;
    /// The fixed-point format of every named signal and coefficient.
    const FORMATS: &'static [Format];
    /// Names of the state words, in the order of [`Drive::state_word`].
    const STATE_NAMES: &'static [&'static str];

    /// A drive at rest with zero set-point.
    fn new() -> Self
    where
        Self: Sized;
    /// Runs one control period: reads the sample, returns the command for the inverter.
    fn step(&mut self, sample: &Sample) -> Legs;
    /// Sets the current set-point in amperes (peak of the quasi-square wave); saturates at the
    /// largest current of the specification.
    fn set_current(&self, current: I16F16);
    /// Sets the torque set-point in newton metres; saturates likewise.
    fn set_torque(&self, torque: I16F16);
    /// Tells the bus voltage as an ADC count. Does nothing for drives with `v_bus: fixed`.
    fn set_bus(&self, counts: u16);
    /// Clears a trip and all control state; keeps calibrated offsets and the set-point, which drives the
    /// motor at once unless it is zero. Ignored while calibration or pre-charge runs.
    fn reset(&mut self);
    /// Starts current-offset calibration: all legs off, the motor at rest. Ignored when tripped. An offset that
    /// is too far from its nominal value trips the drive with [`Fault::Offset`].
    fn calibrate(&mut self);
    /// Starts bootstrap pre-charge: all lower switches on, the motor at rest. Ignored when tripped or
    /// calibrating, which ends in pre-charge by itself.
    fn precharge(&mut self);
    /// Why the drive is tripped, or [`Fault::None`].
    fn fault(&self) -> Fault;
    /// Whether currents are controlled: neither calibrating, pre-charging nor tripped.
    fn is_running(&self) -> bool;
    /// State word `index` (see [`Drive::STATE_NAMES`]); 0 past the end. For verification.
    fn state_word(&self, index: usize) -> i32;
    /// Overwrites state word `index` with a value inside its range. For verification.
    fn set_state_word(&mut self, index: usize, value: i32);
}
