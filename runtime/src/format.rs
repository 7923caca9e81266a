//! The fixed-point formats of a drive, for those who verify or read it.

/// How a result is rounded to its format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Rounding {
    /// Towards minus infinity.
    Floor,
    /// To the nearest, ties towards plus infinity.
    RoundHalfUp,
}

/// The fixed-point format of a kind of signals (`current`, `voltage`, …), a coefficient or a table of
/// a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Format {
    /// Name of the signals, coefficient or table.
    pub name: &'static str,
    /// Bits of two's complement that hold it: of signals, every one that outlives a call (within a
    /// step all are 32-bit words); of a coefficient or table, its values.
    pub storage_bits: u8,
    /// Fraction bits relative to the signals' base (negative: the ulp is larger than the base); of a
    /// coefficient, the bits that its products are shifted by.
    pub frac_bits: i8,
    /// Rounding of results into this format.
    pub rounding: Rounding,
    /// Equal parts of a turn that the table has; 0 for what is no table.
    pub segments: u8,
}

impl Format {
    /// A row of the format table.
    #[must_use]
    pub const fn new(
        name: &'static str,
        storage_bits: u8,
        frac_bits: i8,
        rounding: Rounding,
    ) -> Self {
        Self {
            name,
            storage_bits,
            frac_bits,
            rounding,
            segments: 0,
        }
    }

    /// The same for a table over so many equal parts of a turn.
    #[must_use]
    pub const fn over(self, segments: u8) -> Self {
        Self { segments, ..self }
    }
}
