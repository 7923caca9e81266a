//! Documentation of types and stages in emitted code, whatever the language.

use super::plan::{Context, Outcome};
use super::signal::Shape;
use crate::interface::Interface;
use crate::ir::{Op, PathCost, Program};

/// Documentation of the type: interface, generator and scale, operations of a step.
pub(super) fn of_type(program: &Program, interface: &Interface) -> Vec<String> {
    let cost = PathCost::of_function(&program.step);
    let mut lines = interface.doc.clone();
    lines.push(String::new());
    lines.extend(interface.header.iter().cloned());
    if cost.worst.total() > 0 {
        lines.extend([
            String::new(),
            format!(
                "Operations of a step: {}; at worst {}.",
                cost.normal, cost.worst
            ),
        ]);
    }
    lines
}

/// Documentation of a stage, with the proven ranges of its results; `name` spells their names.
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
        if outcome.signal.shape == Shape::Word && !matches!(node.op, Op::Literal(_)) {
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
        lines.push(format!("Proven: {}.", ranges.join("; ")));
    }
    lines
}
