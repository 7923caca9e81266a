//! What emitted code says about itself, whatever the language.

use super::plan::{Context, Outcome};
use super::signal::Shape;
use crate::interface::Interface;
use crate::ir::{Op, PathCost, Program};

/// What the type says of itself: what it controls, then what it was made of, what a step costs and how far it is from
/// the ideal one at most.
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
