//! Words behind a number's unit that say what it refers to.

/// What a resistance, inductance or EMF constant refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Of one phase winding.
    PerPhase,
    /// Between two terminals.
    LineToLine,
    /// Of the phase voltage.
    Phase,
    /// Amplitude.
    Peak,
    /// From the least to the greatest, twice the amplitude.
    PeakToPeak,
    /// Root mean square.
    Rms,
    /// Mean over a sector of block commutation, between two terminals.
    BlockMean,
    /// Torque per ampere of the current's peak.
    PerPeakAmpere,
    /// Torque per ampere of the current's root mean square.
    PerRmsAmpere,
}

impl Basis {
    /// The word as written.
    pub fn word(self) -> &'static str {
        match self {
            Self::PerPhase => "per_phase",
            Self::LineToLine => "line_to_line",
            Self::Phase => "phase",
            Self::Peak => "peak",
            Self::PeakToPeak => "peak_to_peak",
            Self::Rms => "rms",
            Self::BlockMean => "block_mean",
            Self::PerPeakAmpere => "per_peak_ampere",
            Self::PerRmsAmpere => "per_rms_ampere",
        }
    }
}
