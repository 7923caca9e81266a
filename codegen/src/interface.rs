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

/// Names, documentation and fixed numbers of one controller type.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// `UpperCamelCase` type name.
    pub type_name: String,
    /// Documentation of the type, Markdown lines: what it controls, how, derived values, stable range.
    pub doc: Vec<String>,
    /// Header of the emitted module, Markdown lines: generator version, derived values, operation count.
    pub header: Vec<String>,
    /// The normalised specification.
    pub spec_toml: String,
    /// Every format.
    pub formats: Vec<FormatEntry>,
    /// Associated constants.
    pub constants: Vec<PublicConstant>,
    /// Periods after which a command takes effect.
    pub delay: u32,
    /// Whether `step` takes `hall_ticks`.
    pub timer_capture: bool,
    /// Periods without a call of `set_bus` after which the bus voltage is stale; none where it is fixed, and
    /// no inherent method tells it.
    pub bus_periods: Option<i32>,
    /// Samples of the offset calibration.
    pub calibration_samples: i32,
    /// Periods of bootstrap pre-charge.
    pub precharge_periods: i32,
}
