//! Where control goes from an instruction.

/// Where control goes from an instruction.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Flow {
    /// To the next one.
    pub goes_on: bool,
    /// To these.
    pub jumps: Vec<u32>,
    /// To a function first.
    pub calls: Option<u32>,
    /// Back to the caller.
    pub returns: bool,
    /// Flags with which it jumps or returns; with all others it goes on. `None` for what no flags
    /// decide.
    pub condition: Option<Flags>,
    /// Whether all flags behind it are those before it.
    pub keeps_flags: bool,
}

/// Condition flags that are possible at an instruction, a bit for each of the 16 combinations of
/// N, Z, C and V.
pub type Flags = u16;

/// No flag is known.
pub const ANY: Flags = !0;

impl Flow {
    /// To the next instruction.
    pub fn on() -> Self {
        Self {
            goes_on: true,
            ..Self::default()
        }
    }

    /// To another instruction.
    pub fn jump(to: u32) -> Self {
        Self {
            jumps: vec![to],
            ..Self::default()
        }
    }

    /// To a function, and on.
    pub fn call(function: u32) -> Self {
        Self {
            calls: Some(function),
            ..Self::on()
        }
    }

    /// Back to the caller.
    pub fn back() -> Self {
        Self {
            returns: true,
            ..Self::default()
        }
    }

    /// The same, or to the next instruction, decided by no flags.
    pub fn or_on(self) -> Self {
        Self {
            goes_on: true,
            ..self
        }
    }
}
