//! Texts about the time of a step.

use crate::diagnostics::engineering;
use crate::timing::StepTime;

/// What the documentation of a type in Rust says: times that were counted, and those on the core
/// that is named.
pub(super) fn documentation(times: &[StepTime]) -> Vec<String> {
    let told = times.iter();
    let mut lines = list(told.filter(|time| time.is_named || time.errors.is_none()));
    if times.iter().any(StepTime::is_too_long) {
        lines.extend([
            String::new(),
            "**A step may take longer than the control period on this core.**".to_owned(),
        ]);
    }
    lines
}

/// A list of times behind a sentence; nothing if there are none.
pub(super) fn list<'a>(times: impl Iterator<Item = &'a StepTime>) -> Vec<String> {
    let times: Vec<&StepTime> = times.collect();
    let Some(first) = times.first() else {
        return vec![];
    };
    let estimated = if times.iter().any(|time| time.errors.is_some()) {
        " Where an error stands in brackets, a figure is estimated from the operations of the step: it is the largest of the counted drives that the estimate was not fitted to."
    } else {
        ""
    };
    let compiler = first.chip.compiler;
    let mut lines = vec![format!(
        "Time of a step in the code of {compiler}, cycles with every wait state of the chip's memory and without credit for prefetch and caches.{estimated}"
    )];
    lines.extend(times.into_iter().map(item));
    lines
}

fn item(time: &StepTime) -> String {
    let told = time.told();
    let errors = time
        .errors
        .map(|errors| errors.map(|error| format!(" (+- {})", whole_percent(error))));
    let [normal, control, control_cycles, any, any_cycles] = match errors {
        Some(errors) => errors.into_array(),
        None => Default::default(),
    };
    format!(
        "- {}, {} at {}: {} instructions in most steps{normal}, at most {} in control{control} and {} with start-up and trips{any}; at most {} cycles in control{control_cycles}, {} of the control period, and {} with start-up and trips{any_cycles}.",
        time.chip.name,
        time.chip.core,
        engineering(time.clock, "Hz"),
        told.normal,
        told.control,
        told.any,
        told.control_cycles,
        whole_percent(time.share()),
        told.any_cycles,
    )
}

/// In whole percents, rounded up.
fn whole_percent(part: f64) -> String {
    format!("{:.0} %", (100.0 * part).ceil())
}
