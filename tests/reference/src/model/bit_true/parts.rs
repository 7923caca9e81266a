//! Groups of state words by variant.

/// A group of state words of some variants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Edges,
    Direction,
    Rotor,
    Angle,
    Rise,
    HallLearning,
    OverSpeed,
    Speed,
    Ramp,
    Slew,
    BusCurrent,
    LineCommand,
    Commutation,
    SectorInForce,
    Sight,
    VoltageCommand,
    TerminalCommand,
    OffMemory,
    EmfMemory,
    EmfNext,
    NetMemory,
    NetNext,
    VoltageMemory,
    EmfError,
    Weakening,
    Residual,
    TorqueLearning,
    Integral,
    PairIntegral,
    ReferenceNext,
    ReferenceDue,
    Hysteresis,
    VectorMemory,
    Due,
    Later,
}

/// The groups of a variant.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parts(u64);

impl Parts {
    /// The groups whose condition is true.
    pub fn new(groups: &[(Part, bool)]) -> Self {
        Self(
            groups
                .iter()
                .filter(|(_, present)| *present)
                .fold(0, |set, (part, _)| set | 1 << *part as u8),
        )
    }

    /// Whether the variant has the group.
    #[inline]
    pub fn has(self, part: Part) -> bool {
        self.0 >> part as u8 & 1 != 0
    }
}
