//! What emitted code says about itself, whatever the language.

use super::plan::{Context, Outcome};
use super::set_point::Shared;
use crate::diagnostics::list;
use crate::interface::Interface;
use crate::ir::{Input, Op, PathCost, Program};

/// Control periods after which a call that replaces several words counts as given up, as the runtime has it.
pub(super) const GIVEN_UP: i32 = 1 << 16;

/// The header: the interface's, what a step costs, how far it is from the ideal one at most, and the
/// specification that all of it was made from.
pub(super) fn header(program: &Program, interface: &Interface) -> Vec<String> {
    let cost = PathCost::of_function(&program.step, &program.tables);
    let mut lines = interface.header.clone();
    if cost.worst.total() > 0 {
        lines.extend([
            String::new(),
            format!("Operations of a step, normal path: {}.", cost.normal),
            format!("Operations of a step, worst case: {}.", cost.worst),
        ]);
    }
    let errors = interface.constants.iter().filter(|constant| {
        constant.name.ends_with("_ERROR") || constant.name.ends_with("_ERROR_LIMITED")
    });
    let errors: Vec<String> = errors
        .map(|constant| format!("- `{}`: {}", constant.name, constant.doc.join(" ")))
        .collect();
    if !errors.is_empty() {
        lines.extend([
            String::new(),
            "Worst-case errors:".to_owned(),
            String::new(),
        ]);
        lines.extend(errors);
    }
    lines.extend([
        String::new(),
        "Specification, with every default filled in:".to_owned(),
        String::new(),
        "```toml".to_owned(),
    ]);
    lines.extend(interface.spec_toml.trim_end().lines().map(str::to_owned));
    lines.push("```".to_owned());
    lines
}

/// A stage: what it computes, and the proven ranges of its results, which `name` spells.
pub(super) fn stage<'o>(
    context: &Context<'_>,
    doc: &[String],
    outcomes: impl Iterator<Item = &'o Outcome>,
    name: impl Fn(&str) -> String,
) -> Vec<String> {
    let mut lines = doc.to_vec();
    let mut ranges: Vec<(String, String)> = vec![];
    for outcome in outcomes {
        let node = context.function.node(outcome.value);
        if outcome.signal.shape.is_word() && !matches!(node.op, Op::Literal(_)) {
            let name = format!("`{}`", name(&outcome.signal.name));
            let range = node.interval.to_string();
            match ranges.iter_mut().find(|(_, known)| *known == range) {
                Some((names, _)) => *names = format!("{names}, {name}"),
                None => ranges.push((name, range)),
            }
        }
    }
    if !ranges.is_empty() {
        let ranges: Vec<String> = ranges
            .into_iter()
            .map(|(names, range)| format!("{names} in `{range}`"))
            .collect();
        if !lines.is_empty() {
            lines.push(String::new());
        }
        lines.push(format!("Proven: {}.", ranges.join("; ")));
    }
    lines
}

/// What a step does, and what it takes.
pub(super) fn step(interface: &Interface, measurements: &[(&str, Option<&Input>)]) -> Vec<String> {
    let effect = match interface.delay {
        0 => "The command takes effect at once, in the period that the measurements begin.",
        _ => {
            "The command takes effect with the next period, while its own step computes the one after."
        }
    };
    let mut lines = vec![
        "Runs one control period: takes the measurements of its start, returns the inverter's command.".to_owned(),
        String::new(),
        effect.to_owned(),
        String::new(),
    ];
    lines.extend(measurements.iter().map(|(name, input)| match input {
        Some(input) => format!("- `{name}`: {}", input.doc),
        None => format!("- `{name}`: not used by this controller."),
    }));
    lines
}

/// What the public step takes: names, and the step's input of that name. The hardware's side follows the
/// specification: a captured time comes in even where this controller makes no use of it.
pub(super) fn measurements<'p>(
    program: &'p Program,
    interface: &Interface,
) -> Vec<(&'static str, Option<&'p Input>)> {
    let inputs = &program.step.inputs;
    let input = |name: &str| inputs.iter().find(|input| input.name == name);
    let mut names = vec!["adc_a", "adc_b", "hall"];
    if interface.timer_capture {
        names.push("hall_ticks");
    }
    names.into_iter().map(|name| (name, input(name))).collect()
}

/// What `calibrate` does.
pub(super) fn calibrate(interface: &Interface) -> String {
    let samples = interface.calibration_samples;
    let charged = match interface.precharge_periods {
        0 => String::new(),
        periods => format!("then {periods} of pre-charge, "),
    };
    format!(
        "Starts current-offset calibration: {samples} steps with all legs off, the motor at rest; {charged}then control at the set-point that stands. Ignored when tripped."
    )
}

/// What `precharge` does.
pub(super) fn precharge(interface: &Interface) -> String {
    match interface.precharge_periods {
        0 => "Does nothing: the specification has no bootstrap pre-charge.".to_owned(),
        periods => format!(
            "Starts bootstrap pre-charge: {periods} steps with all lower switches on, which short-circuits a motor that turns; then control at the set-point that stands. Accepted while running, too: call it at rest only. Ignored when tripped and while calibrating."
        ),
    }
}

/// Who may call which setter from where.
pub(super) fn set_point(program: &Program, shared: &[Shared<'_>]) -> Vec<String> {
    let mut lines = vec![
        "What other code tells the control loop, which may interrupt it at any place. All on one core.".to_owned(),
        String::new(),
    ];
    let names = |single: bool| {
        let setters = program.setters.iter().filter(|setter| {
            if setter.next_params.is_empty() {
                return false;
            }
            let mut written = setter.next_params.iter().map(|(param, _)| param.index());
            written.all(|param| {
                let mut groups = shared.iter();
                groups.any(|shared| {
                    (shared.words.len() == 1) == single
                        && shared.words.iter().any(|&(word, _)| word == param)
                })
            })
        });
        let names: Vec<&str> = setters.map(|setter| setter.name.as_str()).collect();
        (!names.is_empty()).then(|| list(&names, "and"))
    };
    if let Some(names) = names(true) {
        lines.push(format!(
            "From anywhere, interrupts included: {names}; the last call wins, and none disturbs another setter."
        ));
    }
    if let Some(names) = names(false) {
        lines.extend([
            String::new(),
            format!("{names} replaces several words as one. A call that interrupts another call of it has no effect; one that was"),
            format!("interrupted for good keeps later calls from having an effect for {GIVEN_UP} control periods. From an interrupt that can"),
            "interrupt the control loop: at most once per control period.".to_owned(),
        ]);
    }
    lines
}
