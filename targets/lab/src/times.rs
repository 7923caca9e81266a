//! Time of a step on named chips, as text and as data.

use crate::text::significant;
use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::timing::StepTime;
use serde::Serialize;

/// Time of a step on a chip, with every wait state of its memory. Any step: start-up, calibration
/// and trips included.
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
    /// The same in percent of the control period.
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
            period_pct: 100.0 * time.share(),
            instructions_of_any: told.any,
            cycles_of_any: told.any_cycles,
            error_pct: time.errors.map(|errors| 100.0 * errors.control_cycles),
        }
    }
}

/// One line: cycles on the first chip, and shares of the control period on all.
pub fn sentence(times: &[StepTime]) -> String {
    let Some(first) = times.first() else {
        return "not known".to_owned();
    };
    let about = if first.errors.is_some() { "about " } else { "" };
    let cycles = first.told().control_cycles;
    let shares = times.iter().enumerate().map(|(k, time)| {
        let period = if k == 0 { " of the period" } else { "" };
        format!(
            "{} %{period} on {} at {}",
            significant(100.0 * time.share(), 2),
            time.chip.name,
            engineering(time.clock, "Hz")
        )
    });
    let shares: Vec<String> = shares.collect();
    format!("at most {about}{cycles} cycles: {}", shares.join(", "))
}
