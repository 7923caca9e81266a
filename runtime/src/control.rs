//! Interface of a generated controller to the runtime: constants and functions of its law.
//!
//! `hexagen::controller!` implements [`Control`] for the type that it emits;
//! [`Drive`](crate::Drive) runs it. Options that add calls have a trait each.

use crate::arith::Word;
use crate::bus::Bus;
use crate::{AngleSensor, Checked, Command, Format, Limits, Places, Sensors};

/// State of a law: the words kept from one control period to the next.
///
/// Derived for emitted code by `#[derive(hexagen::State)]`.
pub trait State: Send + 'static {
    /// Initial state.
    const INITIAL: Self;
    /// Names of the words, in the order of [`words`](Self::words).
    const NAMES: &'static [&'static str];
    /// Where the words of a drive that tripped are kept.
    type Kept: Places;
    /// Keeps the words there.
    fn keep(&self, kept: &Self::Kept);
    /// Copies the words to the front of `words`, as many as fit. For verification.
    fn words(&self, words: &mut [i32]);
    /// Overwrites word `index` with a value inside its range. For verification.
    fn set_word(&mut self, index: usize, value: i32);
}

/// Angles of Hall edges, 2^32 a turn.
pub type HallShifts = [Word; 3];

/// A generated current controller of one motor, inverter and control period.
///
/// ```
/// use hexagen::{Control, ControlLoop, DynLoop, Fault, Legs, Sample, SetPoint};
///
/// /// The PWM interrupt, for any drive.
/// fn interrupt<C: Control<Command = Legs>>(control: &mut ControlLoop<'_, C>, adc: [u16; 2], hall: u8) -> Legs {
///     control.step(&Sample::with_hall(adc, hall))
/// }
///
/// /// The main program, for any drive.
/// fn main_program<C: Control>(set_point: &SetPoint<C>) -> Result<(), Fault> {
///     set_point.set_current_ma(5_000);
///     set_point.status().fault.map_or(Ok(()), Err)
/// }
///
/// /// One of several drives, chosen at run time.
/// fn restart(control: &mut dyn DynLoop) {
///     control.reset();
/// }
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a controller",
    label = "expected a type emitted by `hexagen::controller!`",
    note = "`Drive<C>`, `SetPoint<C>` and `ControlLoop<C>` take the emitted type as `C`"
)]
pub trait Control: Sized + 'static {
    /// State of the law.
    type State: State;
    /// The rotor's state that tracking passes to the step.
    type Rotor: Copy;
    /// The command of a step: [`Legs`](crate::Legs), or [`Intervals`](crate::Intervals).
    type Command: Command;
    /// Storage of the bus voltage: [`FixedBus`](crate::FixedBus), or with `v_bus: measured`
    /// [`ToldBus`](crate::ToldBus).
    type Bus: Bus;

    /// The type's name as written in the macro call.
    const NAME: &'static str;
    /// The specification with every default filled in: TOML, SI units.
    const SPEC: &'static str;
    /// Fixed-point formats of signals, coefficients and tables.
    const FORMATS: &'static [Format];
    /// Limits of samples, and start-up times.
    const LIMITS: Limits;
    /// The current sensors. The macro sets it unless they are alike and in phases a and b.
    const SENSORS: Sensors = Sensors::AB;
    /// The angle sensor of a drive with `rotor: angle`; none with Hall sensors.
    const ANGLE: Option<AngleSensor> = None;
    /// Units of an [`Observation`] and of commands.
    const UNITS: Units;
    /// Initial set-point word: 0, or with `speed_loop: on` the greatest current.
    const SET_POINT: Word;
    /// Initial bus voltage.
    const BUS: Self::Bus;
    /// [`SpeedLoop::speed`] of a drive with a speed loop, else `None`. The macro sets it wherever
    /// it implements `SpeedLoop`.
    const SPEED: Option<fn(Word) -> Word> = None;
    /// [`MeasuredBus::bus`] of a drive with a measured bus voltage, else `None`. The macro sets it
    /// wherever it implements `MeasuredBus`.
    const TOLD_BUS: Option<fn(Word) -> BusWords<Self>> = None;

    /// Tells from the law's state that the currents have not followed the voltages for the
    /// `residual_timeout`. The macro sets it with that option.
    const HAS_LOST_CURRENTS: Option<fn(&Self::State) -> bool> = None;

    /// Tells from the law's state that the rotor turns faster than `over_speed`. The macro sets it with
    /// that field.
    const IS_TOO_FAST: Option<fn(&Self::State) -> bool> = None;

    /// Reads from the law's state how far Hall edges stand from their places, 2^32 a turn: those at which sectors 1 and 4,
    /// and 2 and 5, begin, and what all have in common. The macro sets it with `hall_learning: on`.
    const HALL_SHIFTS: Option<fn(&Self::State) -> HallShifts> = None;

    /// Reads from the law's state the stated over the learnt torque constant, 28 fraction bits. The macro sets it with
    /// `torque_learning: on`.
    const TORQUE_RATIO: Option<fn(&Self::State) -> Word> = None;

    /// Set-point word of a current: bits of a number with 16 fraction bits, ampere.
    fn current(bits: Word) -> Word;
    /// Set-point word of a torque: bits of a number with 16 fraction bits, newton metres.
    fn torque(bits: Word) -> Word;

    /// Tracks the rotor; called every period, also at rest.
    fn track(state: &mut Self::State, sample: &Checked) -> Self::Rotor;
    /// A period without control: clears the state of past commands.
    fn rest(state: &mut Self::State, sample: &Checked, rotor: Self::Rotor);
    /// A controlled period. `observation`, initially empty, receives the law's estimates; unused
    /// parts of it vanish once this is inlined.
    fn step(
        state: &mut Self::State,
        set_point: &Words<Self>,
        sample: &Checked,
        rotor: Self::Rotor,
        observation: &mut Observation,
    ) -> Self::Command;
}

/// The words of a drive's bus voltage.
pub type BusWords<C> = <<C as Control>::Bus as Bus>::Words;

/// A drive with a speed loop: `speed_loop: on`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no speed loop",
    label = "`set_speed` needs a drive with `speed_loop: on`",
    note = "add `speed_loop: on` to the controller's options, or set a current or a torque"
)]
pub trait SpeedLoop: Control {
    /// Set-point word of a speed: bits of a number with 16 fraction bits, rpm.
    fn speed(bits: Word) -> Word;
}

/// A drive with a measured bus voltage: `v_bus: measured`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has a fixed bus voltage",
    label = "`set_bus` needs a drive with `v_bus: measured`",
    note = "add `v_bus: measured` and the ADC of the bus to the inverter, or remove the call: this drive uses the nominal voltage"
)]
pub trait MeasuredBus: Control {
    /// Words of a voltage, from an ADC count.
    fn bus(counts: Word) -> BusWords<Self>;
}

/// The main program's requests, as words for a step.
#[derive(Debug)]
pub struct Words<C: Control> {
    pub(crate) current: crate::shared::SharedWord,
    pub(crate) speed: crate::shared::SharedWord,
    pub(crate) bus: C::Bus,
}

impl<C: Control> Words<C> {
    /// Current or torque set-point; with a speed loop, the limit of its current.
    #[inline]
    #[must_use]
    pub fn current(&self) -> Word {
        self.current.load()
    }

    /// Speed set-point.
    #[inline]
    #[must_use]
    pub fn speed(&self) -> Word
    where
        C: SpeedLoop,
    {
        self.speed.load()
    }

    /// Words of the bus voltage.
    #[inline]
    #[must_use]
    pub fn bus(&self) -> BusWords<C> {
        self.bus.read()
    }

    /// 1 while the measured bus voltage is fresh, as of this control period, else 0.
    #[inline]
    #[must_use]
    pub fn bus_is_fresh(&self) -> Word {
        Word(i32::from(!self.bus.is_stale()))
    }
}

/// Unit of a word: a factor in bits of a number with 16 fraction bits, shifted left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// The factor times 2^`shift`.
    pub factor: i32,
    /// 1 to 62.
    pub shift: u32,
}

/// Units of a drive's signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Units {
    /// Ampere per word of current.
    pub ampere: Unit,
    /// Volt per word of voltage.
    pub volt: Unit,
    /// Volt per timer count at the nominal bus.
    pub volt_per_count: Unit,
    /// Revolutions per minute per word of speed.
    pub rpm: Unit,
    /// Sector 1 to 6 by Hall code; 0 for invalid codes.
    pub sectors: [u8; 8],
}

/// Estimates of a law in one control period, in its own words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Observation {
    /// EMF of phases a and b, words of voltage, if the law estimates it.
    pub emf: Option<[Word; 2]>,
    /// Speed, forward positive, if the law measures it; 0 while unknown.
    pub speed: Option<Word>,
}
