//! Groups of state words, and which of them a variant has.

/// A group of state words that not every variant has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Edges,
    Direction,
    Rotor,
    Speed,
    Commutation,
    SectorInForce,
    Sight,
    VoltageCommand,
    TerminalCommand,
    OffMemory,
    EmfMemory,
    Integral,
    PairIntegral,
    Hysteresis,
    VectorMemory,
    Due,
    Later,
}

/// The groups that a variant has.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parts(u32);

impl Parts {
    /// Those of the groups whose condition is true.
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
