//! Texts about the time of a step.

use crate::diagnostics::{engineering, percent};
use crate::timing::StepTime;

/// What the cycles include.
const CYCLES: &str = "Cycles include every wait state of the chip's memory, without credit for prefetch or caches. Any step: start-up, calibration and trips included.";

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

/// A Markdown table of times, with a heading sentence; nothing if there are none.
pub(super) fn table<'a>(times: impl Iterator<Item = &'a StepTime>) -> Vec<String> {
    let (counted, estimated): (Vec<&StepTime>, _) = times.partition(|time| time.errors.is_none());
    let mut lines = vec![];
    if let Some(first) = counted.first() {
        let compiler = first.chip.compiler;
        lines.push(format!(
            "Time of a step, counted in the code of {compiler}. {CYCLES}"
        ));
        lines.extend(rows(&counted));
    }
    if !estimated.is_empty() {
        lines.push(format!(
            "Time of a step, estimated from its operations. {CYCLES} In brackets the largest error of a counted drive that the estimate was not fitted to."
        ));
        lines.extend(rows(&estimated));
    }
    lines
}

fn rows(times: &[&StepTime]) -> Vec<String> {
    let head =
        "| chip | most steps | in control at most | of the control period | any step at most |";
    let mut lines = vec![
        String::new(),
        head.to_owned(),
        "|---|---|---|---|---|".to_owned(),
    ];
    lines.extend(times.iter().map(|time| row(time)));
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
