//! Time of a step on named chips, as text and as data.

use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::timing::StepTime;
use serde::Serialize;

/// Time of a step on a chip, with every wait state of its memory. Any step: start-up, calibration,
/// trips, braking of a fast rotor and bridged Hall codes included.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Time {
    /// Chip.
    pub chip: &'static str,
    /// Core.
    pub core: &'static str,
    /// Clock of the core, hertz.
    pub clock_hz: f64,
    /// Instructions of most steps.
    pub instructions: u32,
    /// Instructions of the longest path of a step in control.
    pub instructions_in_control: u32,
    /// Cycles of a step in control at most.
    pub cycles_in_control: u32,
    /// The same in whole percents of the control period, rounded up.
    pub period_pct: f64,
    /// Instructions of the longest path of any step.
    pub instructions_of_any: u32,
    /// Cycles of any step at most.
    pub cycles_of_any: u32,
    /// Largest error of an estimate of the cycles in control, percent; none for a counted drive.
    pub error_pct: Option<f64>,
}

impl From<&StepTime> for Time {
    fn from(time: &StepTime) -> Self {
        let told = time.told();
        Self {
            chip: time.chip.name,
            core: time.chip.core,
            clock_hz: time.clock,
            instructions: told.normal,
            instructions_in_control: told.control,
            cycles_in_control: told.control_cycles,
            period_pct: time.percent_of_period(told.control_cycles),
            instructions_of_any: told.any,
            cycles_of_any: told.any_cycles,
            error_pct: time.errors.map(|errors| 100.0 * errors.control_cycles),
        }
    }
}

/// A line of the first core: that which is named, else the Cortex-M4. Estimates are told as about; the worst, with
/// start, trips and braking, includes their error, that in C the most that a counted drive takes more there.
pub fn sentence(times: &[StepTime]) -> String {
    let Some(time) = times.first() else {
        return "not known".to_owned();
    };
    let in_control = time.told().control_cycles;
    format!(
        "{} {in_control} cycles, {} % of a period, worst {} %; in C {}, {} %; {}{}, {}",
        if time.is_bound() { "up to" } else { "about" },
        time.percent_of_period(in_control),
        time.percent_of_period(time.most_cycles() as u32),
        time.percent_of_period(time.control_cycles_in_c() as u32),
        time.percent_of_period(time.most_cycles_in_c() as u32),
        if time.is_named { "" } else { "if " },
        time.chip.core,
        engineering(time.clock, "Hz"),
    )
}

/// What is told of a step that may take longer than the control period in C, on the core of [`sentence`].
pub fn longer_in_c(times: &[StepTime]) -> Option<String> {
    let time = times.first().filter(|time| time.is_too_long_in_c())?;
    Some(format!(
        "in C the longest step may take up to {} % of the control period (estimated) {} {} at {}: raise `pwm_per_control`",
        time.percent_of_period(time.most_cycles_in_c() as u32),
        if time.is_named {
            "on the"
        } else {
            "if the core is a"
        },
        time.chip.core,
        engineering(time.clock, "Hz"),
    ))
}

#[cfg(test)]
mod tests {
    use super::{Time, sentence};
    use crate::engine::{MotorSource, prepare};

    #[test]
    fn a_counted_drive_is_told_as_at_most_and_another_as_about() {
        let motor = MotorSource::of_library("trivedi-keshri-660w").expect("a motor");
        let told = |variant: &str| {
            let drive = prepare(&motor, Some(variant)).expect("a drive");
            let times = drive.generated.interface.times;
            let data: Vec<Time> = times.iter().map(Time::from).collect();
            (sentence(&times), data)
        };
        let (counted, data) = told("pdcc");
        assert!(counted.starts_with("up to "), "{counted}");
        let core = " %; if Cortex-M4, 170 MHz";
        assert!(counted.ends_with(core), "{counted}");
        assert_eq!(data.len(), 3);
        assert_eq!(data[0].error_pct, None);
        let (estimated, data) = told("pdcc:delay=0,target=cortex_m0,core_clock=64 MHz");
        assert!(estimated.starts_with("about "), "{estimated}");
        assert!(estimated.ends_with(" %; Cortex-M0, 64 MHz"), "{estimated}");
        assert!(data[0].error_pct.is_some_and(|error| error > 1.0));
    }
}
