//! The list of a firmware's drives, and their step functions in the ELF.

use crate::link::{Broken, Link};
use crate::wire::Task;
use hexagen::{Control, LegState, Legs, Sample, State, Supervisor};

/// A step function in the ELF.
#[derive(Debug)]
pub enum StepFn<D> {
    /// Takes the drive, counts of phases a and b, the Hall code, and ticks since the last Hall
    /// edge, or in place of these two the upper 24 bits of an angle ([`sample_of`]); returns the bits of
    /// its command in registers.
    Bits(extern "C" fn(&mut D, u16, u16, u8, u16) -> u64),
    /// Takes the sample and returns the legs in C99's layout, both in the caller's memory.
    Structure(extern "C" fn(&mut D, &SampleInC) -> LegsInC),
}

// Derived, they would have the same bounds on `D`.
impl<D> Clone for StepFn<D> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<D> Copy for StepFn<D> {}

impl<D> StepFn<D> {
    /// One step; returns the bits of its command.
    pub fn call(self, drive: &mut D, sample: Sample) -> u64 {
        match self {
            Self::Bits(step) => {
                let [adc_a, adc_b, _] = sample.adc();
                step(drive, adc_a, adc_b, sample.hall(), sample.ticks())
            }
            Self::Structure(step) => {
                let legs = step(drive, &sample.into());
                Legs::new(legs.compare, legs.state).to_bits()
            }
        }
    }
}

/// A sample in C99's layout.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct SampleInC {
    adc: [u16; 3],
    hall: u16,
    hall_ticks: u16,
    angle: u32,
}

impl From<Sample> for SampleInC {
    fn from(sample: Sample) -> Self {
        Self {
            adc: sample.adc(),
            hall: sample.hall().into(),
            hall_ticks: sample.ticks(),
            angle: sample.angle(),
        }
    }
}

/// The legs in C99's layout.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct LegsInC {
    /// Compare values of phases a, b, c.
    pub compare: [u16; 3],
    /// States of legs a, b, c.
    pub state: [LegState; 3],
}

/// All drives of a firmware.
pub type Drives = &'static [Listed];

/// A drive of the list.
#[derive(Clone, Copy, Debug)]
pub struct Listed {
    /// Symbol of the step function.
    pub symbol: &'static str,
    /// Motor file, relative to the firmware crate.
    pub motor: &'static str,
    /// Kind of controller.
    pub kind: &'static str,
    /// Options in the notation of a macro call.
    pub options: &'static str,
    /// Bytes of the drive's type.
    pub size: usize,
    /// Names of the state words: the supervisor's, then the law's.
    pub state_names: [&'static [&'static str]; 2],
    /// Normalised specification.
    pub spec: &'static str,
    /// Replays a task on this drive.
    pub replay: fn(&mut dyn Link, &Task) -> Result<(), Broken>,
}

impl Listed {
    /// Writes the list for the bench: lines with a key and a value, the specification, and a line
    /// `end`.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn list(&self, link: &mut dyn Link) -> Result<(), Broken> {
        let mut line = |key: &str, values: &[&[&str]]| {
            link.write(key.as_bytes())?;
            for value in values.iter().copied().flatten() {
                link.write(b" ")?;
                link.write(value.as_bytes())?;
            }
            link.write(b"\n")
        };
        line("drive", &[&[self.symbol]])?;
        line("motor", &[&[self.motor]])?;
        line("kind", &[&[self.kind]])?;
        line("options", &[&[self.options]])?;
        line("words", &self.state_names)?;
        link.write(b"size ")?;
        link.write(&decimal(self.size))?;
        link.write(b"\n")?;
        link.write(self.spec.as_bytes())?;
        link.write(b"end\n")
    }
}

/// The sample of a drive from a step function's arguments, of which an angle takes two.
#[inline]
#[must_use]
pub const fn sample_of<C: Control>(adc: [u16; 2], hall: u8, hall_ticks: u16) -> Sample {
    match C::ANGLE {
        None => Sample::with_hall(adc, hall).hall_ticks(hall_ticks),
        Some(_) => Sample::with_angle(adc, (hall as u32) << 24 | (hall_ticks as u32) << 8),
    }
}

/// Names of the words of a drive: its supervisor's, then its law's.
#[must_use]
pub const fn state_names<C: Control>() -> [&'static [&'static str]; 2] {
    [&Supervisor::NAMES, C::State::NAMES]
}

/// Six decimal digits.
fn decimal(mut number: usize) -> [u8; 6] {
    let mut digits = [b'0'; 6];
    for digit in digits.iter_mut().rev() {
        *digit += (number % 10) as u8;
        number /= 10;
    }
    digits
}

/// The drives of a firmware: for each a type by `hexagen::controller!`, its step function, and a
/// row of the list `DRIVES`.
///
/// The line `Name, symbol: "motor file", controller { options };` makes a type `Name` and a
/// function `symbol`.
#[macro_export]
macro_rules! drives {
    ($($name:ident, $symbol:ident: $motor:literal, $kind:ident { $($options:tt)* };)*) => {
        $(
            $crate::hexagen::controller! {
                pub $name { motor: $motor, controller: $kind { $($options)* } }
            }

            /// One control period of the drive.
            #[unsafe(no_mangle)]
            pub extern "C" fn $symbol(
                drive: &mut $crate::hexagen::Drive<$name>,
                adc_a: u16,
                adc_b: u16,
                hall: u8,
                hall_ticks: u16,
            ) -> u64 {
                let sample = $crate::sample_of::<$name>([adc_a, adc_b], hall, hall_ticks);
                $crate::hexagen::Command::to_bits(drive.step(&sample))
            }

        )*

        /// All drives of this firmware.
        pub static DRIVES: $crate::Drives = &[$($crate::Listed {
            symbol: stringify!($symbol),
            motor: $motor,
            kind: stringify!($kind),
            options: stringify!($($options)*),
            size: size_of::<$crate::hexagen::Drive<$name>>(),
            state_names: $crate::state_names::<$name>(),
            spec: <$name as $crate::hexagen::Control>::SPEC,
            replay: |link, task| $crate::session::replay_drive::<$name>($symbol, link, task),
        },)*];
    };
}
