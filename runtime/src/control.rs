//! What a generated controller gives to the runtime: its constants, and the entries of its law.
//!
//! `hexagen::controller!` implements [`Control`] for the type that it emits; [`Drive`](crate::Drive)
//! runs it. Options of the specification that bring calls of their own bring a trait each.

use crate::arith::Word;
use crate::bus::Bus;
use crate::{Checked, Command, Format, Limits};

/// The words that a law keeps from one control period to the next.
///
/// Derived for emitted code by `#[derive(hexagen::State)]`.
pub trait State: Send + 'static {
    /// The words of a drive that begins.
    const INITIAL: Self;
    /// Names of the words, in the order of [`words`](Self::words).
    const NAMES: &'static [&'static str];
    /// Copies the words to the front of `words`, as many as fit. For verification.
    fn words(&self, words: &mut [i32]);
    /// Overwrites word `index` with a value inside its range. For verification.
    fn set_word(&mut self, index: usize, value: i32);
}

/// A generated current controller of one motor, inverter and control period.
///
/// ```
/// use hexagen::{Control, ControlLoop, DynLoop, Fault, Legs, Sample, SetPoint};
///
/// /// What the PWM interrupt does, for any drive.
/// fn interrupt<C: Control<Command = Legs>>(control: &mut ControlLoop<'_, C>, adc: [u16; 2], hall: u8) -> Legs {
///     control.step(&Sample::with_hall(adc, hall))
/// }
///
/// /// What the main program does meanwhile.
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
    message = "`{Self}` is no controller",
    label = "a type that `hexagen::controller!` makes is wanted here",
    note = "`Drive<C>`, `SetPoint<C>` and `ControlLoop<C>` take the type that the macro emits as `C`"
)]
pub trait Control: Sized + 'static {
    /// What outlives a control period.
    type State: State;
    /// What the law's tracking tells its step of the rotor.
    type Rotor: Copy;
    /// What a step commands: [`Legs`](crate::Legs), or [`Intervals`](crate::Intervals).
    type Command: Command;
    /// The words of the bus voltage: [`FixedBus`](crate::FixedBus), or with `v_bus: measured`
    /// [`ToldBus`](crate::ToldBus).
    type Bus: Bus;

    /// The type's name as written in the macro call.
    const NAME: &'static str;
    /// The specification with every default filled in: TOML, SI units.
    const SPEC: &'static str;
    /// The fixed-point format of every kind of signals, coefficient and table.
    const FORMATS: &'static [Format];
    /// What samples are judged by, and how the drive starts up.
    const LIMITS: Limits;
    /// Units of the words of an [`Observation`] and of commands.
    const UNITS: Units;
    /// The set-point word of a drive that begins: 0, or with `speed_loop: on` the greatest current.
    const SET_POINT: Word;
    /// The bus voltage of a drive that begins.
    const BUS: Self::Bus;
    /// [`SpeedLoop::speed`] of a drive whose speed loop asks for the current; none of others. The macro
    /// sets it wherever it implements `SpeedLoop`.
    const SPEED: Option<fn(Word) -> Word> = None;
    /// [`MeasuredBus::bus`] of a drive that is told its bus voltage; none of others. The macro sets it
    /// wherever it implements `MeasuredBus`.
    const TOLD_BUS: Option<fn(Word) -> BusWords<Self>> = None;

    /// The set-point word of a current: bits of a number with 16 fraction bits, ampere.
    fn current(bits: Word) -> Word;
    /// The set-point word of a torque: bits of a number with 16 fraction bits, newton metres.
    fn torque(bits: Word) -> Word;

    /// Follows the rotor; every period, at rest too.
    fn track(state: &mut Self::State, sample: &Checked) -> Self::Rotor;
    /// A period without control: forgets what was commanded.
    fn rest(state: &mut Self::State, sample: &Checked, rotor: Self::Rotor);
    /// A controlled period. `observation` is for people and begins empty: what the law knows of the
    /// motor it tells there, and where nobody asks nothing of it is left once this is inlined.
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

/// A drive whose current is asked for by a speed loop: `speed_loop: on`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no speed loop",
    label = "`set_speed` wants a drive with `speed_loop: on`",
    note = "add `speed_loop: on` to the controller's options, or set a current or a torque"
)]
pub trait SpeedLoop: Control {
    /// The set-point word of a speed: bits of a number with 16 fraction bits, rpm.
    fn speed(bits: Word) -> Word;
}

/// A drive that is told its bus voltage: `v_bus: measured`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not told its bus voltage",
    label = "`set_bus` wants a drive with `v_bus: measured`",
    note = "add `v_bus: measured` and the ADC of the bus to the inverter, or leave the call out: this drive goes by the nominal voltage"
)]
pub trait MeasuredBus: Control {
    /// The words of a voltage, an ADC count.
    fn bus(counts: Word) -> BusWords<Self>;
}

/// What the main program last asked for, in words, as a step takes it.
#[derive(Debug)]
pub struct Words<C: Control> {
    pub(crate) current: crate::shared::SharedWord,
    pub(crate) speed: crate::shared::SharedWord,
    pub(crate) bus: C::Bus,
}

impl<C: Control> Words<C> {
    /// The current or torque that is asked for; with a speed loop the greatest that it may ask for.
    #[inline]
    #[must_use]
    pub fn current(&self) -> Word {
        self.current.load()
    }

    /// The speed that is asked for.
    #[inline]
    #[must_use]
    pub fn speed(&self) -> Word
    where
        C: SpeedLoop,
    {
        self.speed.load()
    }

    /// The bus voltage that was told.
    #[inline]
    #[must_use]
    pub fn bus(&self) -> BusWords<C> {
        self.bus.read()
    }
}

/// What a word of a law stands for: a factor in bits of a number with 16 fraction bits, shifted left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// The factor times 2^`shift`.
    pub factor: i32,
    /// 1 to 62.
    pub shift: u32,
}

/// Units of what a drive tells of itself.
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
    /// Sector 1 to 6 by Hall code; 0 for codes that cannot be.
    pub sectors: [u8; 8],
}

/// What a law knows of the motor in one control period, in its own words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Observation {
    /// EMF of phases a and b, words of voltage, of a law that works one out.
    pub emf: Option<[Word; 2]>,
    /// Speed, forward positive, of a law that times the Hall edges; 0 while it is unknown.
    pub speed: Option<Word>,
}
