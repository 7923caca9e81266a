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
        " Where an error stands in brackets, the figure before it is estimated from the operations of the step: it is the largest among the counted drives, each estimated from the others; those that learn their Hall sensors, or turn legs off within a period, count for such drives only."
    } else {
        ""
    };
    let compiler = first.chip.compiler;
    let mut lines = vec![format!(
        "Time of a step in Rust ({compiler}, `opt-level = 3`, `lto = \"fat\"`, without the feature `signals`), cycles with every wait state that the chip's memory takes at the clock and without credit for prefetch and caches, and their share of a control period. Any step includes start-up, trips, braking of a fast rotor and bridged Hall codes.{estimated}"
    )];
    lines.extend(times.into_iter().flat_map(item));
    lines
}

/// Lines that are short enough not to be wrapped, which would depend on the figures.
fn item(time: &StepTime) -> [String; 4] {
    let told = time.told();
    let errors = time
        .errors
        .map(|errors| errors.map(|error| format!(" (+- {} %)", (100.0 * error).ceil())))
        .unwrap_or_default();
    let chip = time.chip;
    let clock = engineering(time.clock, "Hz");
    let at = if time.clock <= chip.clock() {
        let waits = match chip.waits(time.clock) {
            0 => "no wait states".to_owned(),
            1 => "1 wait state".to_owned(),
            waits => format!("{waits} wait states"),
        };
        format!(
            "{}, {} at {clock}, {}, {waits}",
            chip.name, chip.core, chip.assumed
        )
    } else {
        let of_chip = engineering(chip.clock(), "Hz");
        format!(
            "{} at {clock}, cycles as on {} at {of_chip}, {}",
            chip.core, chip.name, chip.assumed
        )
    };
    let most = if time.is_bound() {
        "at most "
    } else {
        "about "
    };
    [
        format!("- {at}:"),
        format!(
            "  - in most steps {} instructions{};",
            told.normal, errors.normal
        ),
        format!(
            "  - in control {most}{} instructions{}, {} cycles{}, {} %;",
            told.control,
            errors.control,
            told.control_cycles,
            errors.control_cycles,
            time.percent_of_period(told.control_cycles),
        ),
        format!(
            "  - in any step {most}{} instructions{}, {} cycles{}, {} %.",
            told.any,
            errors.any,
            told.any_cycles,
            errors.any_cycles,
            time.percent_of_period(told.any_cycles),
        ),
    ]
}
