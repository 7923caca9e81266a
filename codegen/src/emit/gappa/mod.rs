//! Gappa scripts: the interval of every value of a program, and its distance from the ideal one.
//!
//! A segment is a stage in one case of [`cases`]. Its inputs are variables with the interval and
//! error proved by earlier segments; sums, products and shifts are defined twice, with the code's
//! rounding and without. All other operators cut: a minimum, maximum, clamp or magnitude does not
//! increase the distance of two values, a selected value is one of two, a table's entry has its
//! documented error, so their results are variables again.
//!
//! A script is one implication; with constants alone it has no hypotheses. Its goals are the
//! generator's own bounds.

mod segment;

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fmt::{self, Write};

use crate::ir::{ErrorInterval, Function, Interval, Real, Value, VerifiedGraph, cases};
use segment::segments;

/// A script: one implication.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Script {
    /// Function, stage and case.
    pub name: String,
    /// Names of the identical scripts of other cases, which this one represents.
    pub also: Vec<String>,
    /// Definitions, in order.
    definitions: Vec<String>,
    /// Hypotheses on the variables.
    hypotheses: Vec<String>,
    /// Rewriting rules.
    hints: Vec<String>,
    /// Goals.
    pub goals: Vec<Goal>,
}

/// A bound on an expression of a script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Goal {
    /// The expression.
    pub expression: String,
    /// Subject of the bound.
    pub subject: Subject,
    /// Lower bound of the generator.
    pub low: Real,
    /// Upper bound of the generator.
    pub high: Real,
}

/// Subject of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Subject {
    /// A value: it stays in its interval, and so in its word.
    Value,
    /// A value's distance from the ideal one.
    Error,
    /// Distance of the compared difference of a decision from the ideal one.
    TieBand,
}

impl Goal {
    fn value(name: &str, interval: Interval) -> Self {
        Self {
            expression: name.to_owned(),
            subject: Subject::Value,
            low: Real::of(interval.low as f64),
            high: Real::of(interval.high as f64),
        }
    }

    fn error(expression: String, subject: Subject, error: ErrorInterval) -> Self {
        Self {
            expression,
            subject,
            low: error.low(),
            high: error.high(),
        }
    }
}

impl Script {
    /// The script with open goals, for the checker to bound.
    pub fn question(&self) -> String {
        self.with_goals(|goal| format!("{} in ?", goal.expression))
    }

    /// The script with these bounds as goals, in the order of [`Self::goals`].
    pub fn pinned(&self, bounds: &[[Real; 2]]) -> String {
        let mut bounds = bounds.iter();
        self.with_goals(|goal| {
            let [low, high] = bounds.next().copied().unwrap_or([goal.low, goal.high]);
            format!("{} in [{low},{high}]", goal.expression)
        })
    }

    fn with_goals(&self, text: impl FnMut(&Goal) -> String) -> String {
        let mut script = format!(
            "# {}\n@floor = int<dn>;\n@nearest = fixed<0,nu>;\n",
            self.name
        );
        for definition in &self.definitions {
            let _ = writeln!(script, "{definition};");
        }
        let goals: Vec<String> = self.goals.iter().map(text).collect();
        let [known, goals] = [&self.hypotheses, &goals].map(|parts| parts.join("\n  /\\ "));
        // With constants alone there are no hypotheses.
        let implies = if known.is_empty() { "" } else { "\n  ->\n  " };
        let _ = writeln!(script, "{{ {known}{implies}{goals} }}");
        for hint in &self.hints {
            let _ = writeln!(script, "{hint};");
        }
        script
    }
}

impl fmt::Display for Script {
    /// The script with the generator's own bounds as goals.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            &self.with_goals(|goal| format!("{} in [{},{}]", goal.expression, goal.low, goal.high)),
        )
    }
}

/// The name of a value in scripts; the ideal value has the prefix `M`.
pub fn variable(function: &Function, value: Value) -> String {
    let name = &function.node(value).name;
    if name.is_empty() {
        format!("t{}", value.index())
    } else {
        format!("{name}_{}", value.index())
    }
}

/// The name of a decision's difference in scripts.
pub fn gap(decision: Value) -> String {
    format!("gap{}", decision.index())
}

/// The scripts of all functions of a controller; a segment equal in several cases comes once.
pub fn emit_gappa(graph: &VerifiedGraph) -> Vec<Script> {
    let program = graph.program();
    let mut known = HashMap::new();
    let mut scripts: Vec<Script> = vec![];
    for function in program.functions() {
        for case in cases(program, function) {
            for script in segments(program, function, &case) {
                // All but the name, which contains the case.
                let text = script.to_string();
                let text = text
                    .split_once('\n')
                    .map_or("", |(_, rest)| rest)
                    .to_owned();
                match known.entry((function.name.clone(), text)) {
                    Entry::Vacant(place) => {
                        place.insert(scripts.len());
                        scripts.push(script);
                    }
                    Entry::Occupied(place) => scripts[*place.get()].also.push(script.name),
                }
            }
        }
    }
    scripts
}
