//! A drive with an empty law: the cost of its step is supervision.

use crate::drives::sample_of;
use core::marker::PhantomData;
use hexagen::arith::Word;
use hexagen::{
    AngleSensor, Bus, Checked, Command, Control, Drive, Format, LegState, Limits, Observation,
    Sensors, Units, Words,
};

/// The supervisor of `C` around a law without state that pulses all legs.
#[derive(Clone, Copy, Debug)]
pub struct Supervised<C>(PhantomData<C>);

/// No words.
#[derive(Debug, hexagen::State)]
pub struct Nothing {}

impl<C: Control> Control for Supervised<C> {
    type State = Nothing;
    type Rotor = ();
    type Command = C::Command;
    type Bus = C::Bus;

    const NAME: &'static str = C::NAME;
    const SPEC: &'static str = C::SPEC;
    const FORMATS: &'static [Format] = &[];
    const LIMITS: Limits = C::LIMITS;
    const SENSORS: Sensors = C::SENSORS;
    const ANGLE: Option<AngleSensor> = C::ANGLE;
    const UNITS: Units = C::UNITS;
    const SET_POINT: Word = C::SET_POINT;
    const BUS: C::Bus = C::BUS;
    const SPEED: Option<fn(Word) -> Word> = C::SPEED;
    const TOLD_BUS: Option<fn(Word) -> <Self::Bus as Bus>::Words> = C::TOLD_BUS;

    fn current(bits: Word) -> Word {
        C::current(bits)
    }

    fn torque(bits: Word) -> Word {
        C::torque(bits)
    }

    #[inline]
    fn track(_: &mut Nothing, _: &Checked) {}

    #[inline]
    fn rest(_: &mut Nothing, _: &Checked, (): ()) {}

    #[inline]
    fn step(
        _: &mut Nothing,
        _: &Words<Self>,
        _: &Checked,
        (): (),
        _: &mut Observation,
    ) -> C::Command {
        Command::at_rest(LegState::Pulsed)
    }
}

/// One control period of such a drive, called like a step function.
pub extern "C" fn step_supervised<C: Control>(
    drive: &mut Drive<C>,
    adc_a: u16,
    adc_b: u16,
    hall: u8,
    hall_ticks: u16,
) -> u64 {
    let sample = sample_of::<C>([adc_a, adc_b], hall, hall_ticks);
    drive.step(&sample).to_bits()
}
