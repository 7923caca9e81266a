//! The emitters' input besides the verified graph: names, documentation and constants, without
//! types of the specification.

use crate::timing::StepTime;

/// A value shown to the user as an associated constant of the emitted type.
#[derive(Clone, Debug, PartialEq)]
pub enum PublicValue {
    /// An integer of the given Rust type name.
    Integer {
        /// `u16`, `u32`, `i32`, …
        rust_type: &'static str,
        /// Value.
        value: i64,
    },
    /// A `fixed` number of 32 bits (`FixedI32<Uf>`).
    Fixed {
        /// Two's complement bits.
        bits: i32,
        /// Fraction bits, 0 to 31.
        frac_bits: u32,
    },
    /// A list of vectors in the stationary plane (alpha, beta), each coordinate a `fixed` number.
    Vectors {
        /// Coordinates as bits.
        bits: Vec<[i32; 2]>,
        /// Fraction bits, 0 to 31.
        frac_bits: u32,
    },
    /// A list of integers.
    Integers {
        /// Element type.
        rust_type: &'static str,
        /// Values.
        values: Vec<i64>,
    },
    /// A text.
    Text(String),
}

/// An associated constant of the emitted type.
#[derive(Clone, Debug, PartialEq)]
pub struct PublicConstant {
    /// `SCREAMING_SNAKE_CASE` name.
    pub name: String,
    /// Value.
    pub value: PublicValue,
    /// Meaning, physical value with unit and formula, format, quantisation error.
    pub doc: Vec<String>,
}

/// Rounding into a format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// Towards minus infinity.
    Floor,
    /// To nearest, ties up.
    RoundHalfUp,
}

/// One row of the format table.
#[derive(Clone, Debug, PartialEq)]
pub struct FormatEntry {
    /// Signals, coefficient or table.
    pub name: String,
    /// Two's complement bits: for signals those of state words, else those of the values.
    pub storage_bits: u32,
    /// Fraction bits relative to the base; for coefficients the shift of products.
    pub frac_bits: i32,
    /// Rounding.
    pub rounding: Rounding,
    /// Segments of a turn, for a table.
    pub segments: Option<u32>,
    /// Base and range in words: "timer counts of 26.67 mV, +-512 V".
    pub meaning: String,
}

/// An option of the controller.
#[derive(Clone, Debug, PartialEq)]
pub struct OptionEntry {
    /// Its name.
    pub name: &'static str,
    /// Its value, as the normalised specification has it.
    pub value: String,
    /// Meaning.
    pub meaning: &'static str,
    /// Why it has this value, where nobody stated one and a rule chose it.
    pub reason: Option<&'static str>,
    /// Whether it is one of some words or numbers.
    pub is_choice: bool,
}

/// Names, documentation and fixed numbers of one controller type.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// `UpperCamelCase` type name.
    pub type_name: String,
    /// Documentation of the type, Markdown lines: motor, method, derived values, stable range.
    pub doc: Vec<String>,
    /// Documentation after it, Markdown lines: generator version, scale.
    pub header: Vec<String>,
    /// The normalised specification.
    pub spec_toml: String,
    /// Greatest torque over speed, mechanical rad/s and Nm.
    pub envelope: Vec<[f64; 2]>,
    /// Time of a step, by chip.
    pub times: Vec<StepTime>,
    /// The controller's options, defaults included.
    pub options: Vec<OptionEntry>,
    /// Every format.
    pub formats: Vec<FormatEntry>,
    /// Associated constants.
    pub constants: Vec<PublicConstant>,
    /// Delay of a command, periods.
    pub delay: u32,
    /// Whether `step` takes `hall_ticks`.
    pub timer_capture: bool,
    /// Periods without a call of `set_bus` after which the bus voltage is stale; none if it is
    /// fixed.
    pub bus_periods: Option<i32>,
    /// Watch of the residual; with a `residual_timeout` only.
    pub residual: Option<Watch>,
    /// Watch of the speed; with an `over_speed` only.
    pub over_speed: Option<Watch>,
    /// Names of the state words of the learnt displacements of Hall edges; with `hall_learning` only.
    pub hall_shifts: Option<[&'static str; 3]>,
    /// Name of the state word that holds the stated over the learnt torque constant; with `torque_learning` only.
    pub torque_ratio: Option<&'static str>,
    /// Limits of samples, and start-up.
    pub limits: Limits,
    /// Units of the observations.
    pub units: Units,
}

/// What a law watches itself: it counts in a state word, and the drive trips at a count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watch {
    /// Name of the state word.
    pub word: &'static str,
    /// Count at which the drive trips.
    pub most: i32,
}

/// Limits of the supervisor; words of current are ADC counts with `current_bits` fraction bits. Where
/// the current sensors differ, sign and offset are those of the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest count of the phase-current ADC.
    pub adc_max: u16,
    /// Whether counts fall with the current into the motor.
    pub adc_inverted: bool,
    /// Fraction bits of currents.
    pub current_bits: u32,
    /// ADC count at zero current before calibration.
    pub offset: u16,
    /// Least and greatest offset that calibration accepts, counts.
    pub offsets: [u16; 2],
    /// Largest phase current, words of current.
    pub trip: i32,
    /// Least and greatest current over all counts and accepted offsets, words of current.
    pub currents: [i32; 2],
    /// Base-2 logarithm of the samples of a calibration.
    pub calibration_log2: u32,
    /// Control periods of bootstrap pre-charge; 0 for none.
    pub precharge_periods: u16,
    /// Control periods without a Hall edge under demand that are a stall; 0 for no stall detection.
    pub stall_periods: i32,
    /// Hall sensors that are inverted, as bits of the code.
    pub hall_inverted: u8,
    /// Samples in a row with a disturbed Hall code that are bridged; 0 for none.
    pub hall_glitches: u16,
    /// Sector 1 to 6 by Hall code, four bits each, code 0 lowest; 0 of an invalid code.
    pub sectors: u32,
    /// Control periods of a sector below which braking shorts the motor.
    pub brake_periods: i32,
    /// Control periods that a start waits at most for the rotor's angle; 0 for none.
    pub start_periods: u16,
    /// Least and greatest count of the bus ADC without a fault; 0 and 65535 for none.
    pub bus_counts: [u16; 2],
    /// The current sensors.
    pub sensors: Sensors,
    /// The angle sensor; none with Hall sensors.
    pub angle: Option<AngleSensor>,
}

/// What the angle of a sample has to do with the electrical angle; see the runtime's `AngleSensor`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AngleSensor {
    /// Electrical turns in a turn of the sensor, signed.
    pub turns: i32,
    /// Electrical angle at the sensor's angle 0, 2^32 a turn.
    pub offset: u32,
}

/// The current sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sensors {
    /// The phases of the first two.
    pub phases: SensedPhases,
    /// The second one, where it differs from the first.
    pub second: Option<Sensor>,
    /// The third, if there is one.
    pub third: Option<ThirdSensor>,
}

impl Sensors {
    /// Alike, of phases a and b.
    pub const AB: Self = Self {
        phases: SensedPhases::Ab,
        second: None,
        third: None,
    };
}

/// The phases of two current sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensedPhases {
    /// Phases a and b.
    Ab,
    /// Phases b and c.
    Bc,
    /// Phases c and a.
    Ca,
}

/// The third current sensor, and what is made of it; see the runtime's `ThirdSensor`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThirdSensor {
    /// Its sign, gain and offset.
    pub sensor: Sensor,
    /// Largest compare value of a leg that is read at the end of its period; none for sensors in the phases.
    pub readable: Option<u16>,
    /// Whether a command takes effect one period after its sample.
    pub is_delayed: bool,
    /// Largest sum of the three currents without a fault, words of current.
    pub sum_tolerance: i32,
    /// Samples in a row with a larger one that trip; 0 for none.
    pub sum_samples: u16,
}

/// Sign, gain and offset of a current sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sensor {
    /// Whether counts fall with the current into the motor.
    pub adc_inverted: bool,
    /// ADC count at zero current before calibration.
    pub offset: u16,
    /// Least and greatest offset that calibration accepts, counts.
    pub offsets: [u16; 2],
    /// Gain over that of the first sensor, with 15 fraction bits.
    pub ratio: i32,
}

impl Sensor {
    /// The ratio of equal gains.
    pub const ALIKE: i32 = 1 << 15;
}

/// Units of the observations, in numbers with 16 fraction bits.
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

/// A factor in bits of a number with 16 fraction bits, shifted left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// The factor times 2^`shift`.
    pub factor: i32,
    /// 1 to 62.
    pub shift: u32,
}

impl Unit {
    /// The unit `value`, rounded to 30 bits.
    pub fn of(value: f64) -> Self {
        let factor = value * 65536.0;
        // The largest shift at which the factor fits.
        let shift = (30.0 - factor.abs().max(1e-9).log2())
            .floor()
            .clamp(1.0, 62.0);
        let bits = (factor * shift.exp2()).round();
        Self {
            factor: bits.clamp(f64::from(i32::MIN), f64::from(i32::MAX)) as i32,
            shift: shift as u32,
        }
    }
}
