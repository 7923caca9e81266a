//! Texts about the time of a step.

use crate::diagnostics::{engineering, percent};
use crate::timing::StepTime;

/// What the documentation of a type in Rust says: times that were counted, and those on the core
/// that is named.
pub(super) fn documentation(times: &[StepTime]) -> Vec<String> {
    let told = times.iter();
    let mut lines = table(told.filter(|time| time.is_named || time.errors.is_none()));
    if times.iter().any(StepTime::is_too_long) {
        lines.extend([
            String::new(),
            "**A step may take longer than the control period on this core.**".to_owned(),
        ]);
    }
    lines
}

/// A Markdown table of times behind a sentence; nothing if there are none.
pub(super) fn table<'a>(times: impl Iterator<Item = &'a StepTime>) -> Vec<String> {
    let times: Vec<&StepTime> = times.collect();
    let Some(first) = times.first() else {
        return vec![];
    };
    let estimated = if times.iter().any(|time| time.errors.is_some()) {
        " Figures with an error in brackets are estimated from the operations of the step: it is the largest of the counted drives that the estimate was not fitted to."
    } else {
        ""
    };
    let mut lines = vec![
        format!(
            "Time of a step in the code of {}. Cycles include every wait state of the chip's memory, without credit for prefetch or caches; any step includes start-up, calibration and trips.{estimated}",
            first.chip.compiler
        ),
        String::new(),
        "| chip | most steps | in control at most | of the control period | any step at most |"
            .to_owned(),
        "|---|---|---|---|---|".to_owned(),
    ];
    lines.extend(times.into_iter().map(row));
    lines
}

fn row(time: &StepTime) -> String {
    let told = time.told();
    let errors = time
        .errors
        .map(|errors| errors.map(|error| format!(" (+- {})", percent(round(error)))));
    let [normal, control, control_cycles, any, any_cycles] = match errors {
        Some(errors) => errors.into_array(),
        None => Default::default(),
    };
    format!(
        "| {}, {} at {} | {} instructions{normal} | {} instructions{control}, {} cycles{control_cycles} | {} | {} instructions{any}, {} cycles{any_cycles} |",
        time.chip.name,
        time.chip.core,
        engineering(time.clock, "Hz"),
        told.normal,
        told.control,
        told.control_cycles,
        percent(time.share()),
        told.any,
        told.any_cycles,
    )
}

/// Whole percents.
fn round(error: f64) -> f64 {
    (100.0 * error).ceil() / 100.0
}
