//! What an emitter knows of a controller besides its verified graph: names, documentation and
//! ready-made values. Filled by the controller's lowering; holds no specification types.

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
    /// A `fixed` number: bits of a 32-bit word with so many fraction bits (`FixedI32<Uf>`).
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

/// How results are rounded into a format.
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
    /// Bits of two's complement that hold it: of signals, every one that outlives a call; of a
    /// coefficient or table, its values.
    pub storage_bits: u32,
    /// Fraction bits relative to its base; for coefficients the shift of `mul`.
    pub frac_bits: i32,
    /// Rounding.
    pub rounding: Rounding,
    /// Equal parts of a turn, of a table.
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
    /// What it is.
    pub meaning: &'static str,
}

/// Names, documentation and fixed numbers of one controller type.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// `UpperCamelCase` type name.
    pub type_name: String,
    /// Documentation of the type, Markdown lines: what it controls, how, derived values, stable range.
    pub doc: Vec<String>,
    /// What stands behind it, Markdown lines: generator version, derived values.
    pub header: Vec<String>,
    /// The normalised specification.
    pub spec_toml: String,
    /// The controller's options, as they are in effect.
    pub options: Vec<OptionEntry>,
    /// Every format.
    pub formats: Vec<FormatEntry>,
    /// Associated constants.
    pub constants: Vec<PublicConstant>,
    /// Periods after which a command takes effect.
    pub delay: u32,
    /// Whether `step` takes `hall_ticks`.
    pub timer_capture: bool,
    /// Periods without a call of `set_bus` after which the bus voltage is stale; none where it is fixed.
    pub bus_periods: Option<i32>,
    /// Limits of samples, and start-up.
    pub limits: Limits,
    /// Units of what a drive tells of itself.
    pub units: Units,
}

/// What the supervisor judges samples by; words of current are ADC counts with `current_bits` fraction bits.
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
    /// Least and greatest current of any count at any accepted offset, words of current.
    pub currents: [i32; 2],
    /// Base-2 logarithm of the samples of a calibration.
    pub calibration_log2: u32,
    /// Control periods of bootstrap pre-charge; 0 where there is none.
    pub precharge_periods: u16,
    /// Control periods without a Hall edge under demand that count as a stall; 0 where none are counted.
    pub stall_periods: i32,
}

/// Units of the words that a drive tells of itself, in numbers with 16 fraction bits.
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
    /// Sector 1 to 6 by Hall code; 0 for the codes that cannot be.
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
    /// The unit of words that are worth `value` each, rounded to 30 bits.
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
