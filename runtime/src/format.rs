//! Fixed-point formats of a drive, for verification and documentation.

/// Rounding of results to a format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Rounding {
    /// Towards minus infinity.
    Floor,
    /// To the nearest, ties towards plus infinity.
    RoundHalfUp,
}

/// Fixed-point format of a drive's signals of one kind (`current`, `voltage`, …), of a coefficient
/// or of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Format {
    /// Name of the signals, coefficient or table.
    pub name: &'static str,
    /// Bits of the stored two's complement number: of signals, in the state (within a step all are
    /// 32-bit words); of a coefficient or table, of its values.
    pub storage_bits: u8,
    /// Fraction bits relative to the signals' base (negative: the ulp is larger than the base); of
    /// a coefficient, the bits that its products are shifted by.
    pub frac_bits: i8,
    /// Rounding of results into this format.
    pub rounding: Rounding,
    /// Equal parts of a turn that a table covers; 0 if it is no table.
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

    /// The same for a table over this number of equal parts of a turn.
    #[must_use]
    pub const fn over(self, segments: u8) -> Self {
        Self { segments, ..self }
    }
}
