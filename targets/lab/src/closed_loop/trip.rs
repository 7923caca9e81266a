//! Trips of drives: fault and time.

use hexagen::Fault;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Trip of a drive in a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trip {
    /// The fault.
    pub fault: Cause,
    /// Time from the start of the run to the sample that tripped it, in seconds.
    pub time_s: f64,
    /// Mechanical speed at that sample, in rpm.
    pub rpm: f64,
}

/// A fault by its name in reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// [`Fault::AdcRange`]
    AdcRange,
    /// [`Fault::OverCurrent`]
    OverCurrent,
    /// [`Fault::Hall`]
    Hall,
    /// [`Fault::Stall`]
    Stall,
    /// [`Fault::Offset`]
    Offset,
    /// [`Fault::OverVoltage`]
    OverVoltage,
    /// [`Fault::UnderVoltage`]
    UnderVoltage,
    /// [`Fault::Residual`]
    Residual,
    /// [`Fault::CurrentSum`]
    CurrentSum,
    /// [`Fault::OverSpeed`]
    OverSpeed,
}

impl Cause {
    /// Converts a fault.
    ///
    /// # Panics
    /// On a fault that this program does not know.
    pub fn of(fault: Fault) -> Self {
        match fault {
            Fault::AdcRange => Self::AdcRange,
            Fault::OverCurrent => Self::OverCurrent,
            Fault::Hall => Self::Hall,
            Fault::Stall => Self::Stall,
            Fault::Offset => Self::Offset,
            Fault::OverVoltage => Self::OverVoltage,
            Fault::UnderVoltage => Self::UnderVoltage,
            Fault::Residual => Self::Residual,
            Fault::CurrentSum => Self::CurrentSum,
            Fault::OverSpeed => Self::OverSpeed,
            other => unreachable!("unknown fault: {other:?}"),
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AdcRange => "a current ADC was at an end of its range",
            Self::OverCurrent => "a phase current exceeded the trip level",
            Self::Hall => "a Hall code was invalid",
            Self::Stall => "no Hall edge and no new angle came within the stall time-out",
            Self::Offset => "a current offset was too far from its nominal value",
            Self::OverVoltage => "the bus voltage was above `over_voltage`",
            Self::UnderVoltage => "the bus voltage was below `under_voltage`",
            Self::Residual => "the currents did not follow the voltages for the `residual_timeout`",
            Self::CurrentSum => "three measured currents did not add up to zero",
            Self::OverSpeed => "the rotor turned faster than `over_speed`",
        })
    }
}

impl fmt::Display for Trip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { fault, time_s, rpm } = self;
        write!(
            f,
            "the drive tripped {:.2} ms after the start at {rpm:.0} rpm: {fault}",
            1e3 * time_s
        )
    }
}

#[cfg(test)]
mod tests {
    use super::{Cause, Fault};

    #[test]
    fn every_fault_has_a_cause_of_its_own() {
        let faults = (0..256).filter_map(Fault::from_number);
        let causes: Vec<String> = faults.map(|fault| Cause::of(fault).to_string()).collect();
        assert!(causes.len() >= 10, "{causes:?}");
        for (index, cause) in causes.iter().enumerate() {
            assert!(!causes[..index].contains(cause), "{cause}");
        }
    }
}
