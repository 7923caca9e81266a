//! Roles of outputs, observations, set-point words and setters: emitters and engines use these,
//! never names.

use std::fmt;

/// A phase of the machine, or the leg of the inverter that feeds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Phase {
    /// Phase a.
    A,
    /// Phase b.
    B,
    /// Phase c.
    C,
}

impl Phase {
    /// All three, in order.
    pub const ALL: [Self; 3] = [Self::A, Self::B, Self::C];
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::A => "a",
            Self::B => "b",
            Self::C => "c",
        })
    }
}

/// Role of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Output {
    /// The compare value of a leg.
    Compare(Phase),
    /// The state of a leg.
    Leg(Phase),
    /// The end of one of the first two intervals, from 0.
    End(u8),
    /// The states of the legs in an interval, two bits each; from 0.
    States(u8),
    /// A probed value, by its name.
    Probe(&'static str),
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Compare(phase) => write!(f, "compare_{phase}"),
            Self::Leg(phase) => write!(f, "leg_{phase}"),
            Self::End(interval) => write!(f, "end_{}", interval + 1),
            Self::States(interval) => write!(f, "states_{}", interval + 1),
            Self::Probe(name) => f.write_str(name),
        }
    }
}

/// Role of an observation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Told {
    /// The EMF of a phase, words of voltage.
    Emf(Phase),
    /// The speed, electrical angle per tick.
    Speed,
}

impl fmt::Display for Told {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Emf(phase) => write!(f, "e_{phase}"),
            Self::Speed => f.write_str("speed"),
        }
    }
}

/// Role of a set-point word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Demand {
    /// The current as a voltage; with a speed loop its limit.
    Current,
    /// The speed.
    Speed,
    /// The measured bus voltage.
    Bus,
    /// The ratio of nominal to measured bus voltage.
    BusRatio,
    /// 1 while the measured bus voltage is fresh, else 0: the runtime's, no setter's.
    BusIsFresh,
}

impl Demand {
    /// The words of a measured bus, in order.
    pub const OF_BUS: [Self; 2] = [Self::Bus, Self::BusRatio];
}

/// Role of a setter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Setter {
    /// The current, in amperes.
    Current,
    /// The current, by its torque in newton metres.
    Torque,
    /// The speed, in rpm.
    Speed,
    /// The bus voltage, as an ADC count.
    Bus,
}

impl Setter {
    /// The name of the function.
    pub fn name(self) -> &'static str {
        match self {
            Self::Current => "set_current",
            Self::Torque => "set_torque",
            Self::Speed => "set_speed",
            Self::Bus => "set_bus",
        }
    }
}
