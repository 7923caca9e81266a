//! Gappa scripts: that no value of a program leaves its interval, and how far each is from the ideal one.
//!
//! A segment is a stage in one case of [`cases`]: what comes in are variables with the interval and the
//! error that earlier segments prove; sums, products and shifts are defined twice, as the code rounds them
//! and as the ideal computation does not. Everything else cuts: a minimum, maximum, clamp or magnitude
//! moves no two values further apart, a selected value is one of two, a table's entry is as exact as its
//! document says, so their results come into the next definitions as variables again.
//!
//! A script holds one implication, or of constants alone what follows from nothing. Its goals are
//! the bounds that the generator found itself.

mod segment;

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fmt::{self, Write};

use crate::ir::{ErrorInterval, Function, Interval, Real, Value, VerifiedGraph, cases};
use segment::segments;

/// A script of one implication.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Script {
    /// Function, stage and case.
    pub name: String,
    /// Names of the scripts of other cases that say the same: this one stands for them.
    pub also: Vec<String>,
    /// Definitions, in order.
    definitions: Vec<String>,
    /// What is known of the variables.
    hypotheses: Vec<String>,
    /// Rewriting rules.
    hints: Vec<String>,
    /// What is to be proved.
    pub goals: Vec<Goal>,
}

/// A bound on an expression of a script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Goal {
    /// The expression.
    pub expression: String,
    /// What it is.
    pub subject: Subject,
    /// Least value that the generator finds.
    pub low: Real,
    /// Greatest value that the generator finds.
    pub high: Real,
}

/// What a goal bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Subject {
    /// A value: that it stays in its interval, and so in its word.
    Value,
    /// A value's distance from the ideal one.
    Error,
    /// How far what a decision compares is from the ideal.
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
    /// The script with goals that the checker shall find itself.
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
        // Of constants alone nothing needs to be known.
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

/// The name of a value in scripts: as the code computes it; as the ideal computation does, with `M`
/// before it.
pub fn variable(function: &Function, value: Value) -> String {
    let name = &function.node(value).name;
    if name.is_empty() {
        format!("t{}", value.index())
    } else {
        format!("{name}_{}", value.index())
    }
}

/// The name of the difference that a decision goes by, in scripts.
pub fn gap(decision: Value) -> String {
    format!("gap{}", decision.index())
}

/// The scripts of all functions of a controller; segments that are the same in several cases come once.
pub fn emit_gappa(graph: &VerifiedGraph) -> Vec<Script> {
    let program = graph.program();
    let mut known = HashMap::new();
    let mut scripts: Vec<Script> = vec![];
    for function in program.functions() {
        for case in cases(program, function) {
            for script in segments(program, function, &case) {
                // All but the name, in which the case stands.
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
