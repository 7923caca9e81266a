//! Proofs by Gappa: runs it, reads the bounds that it finds, proves them again as goals, and
//! compares them with the generator's own.
//!
//! A script that asks for bounds always succeeds and prints them on stderr. So the number of bounds
//! read must match, and only bounds proved as goals count.

mod coq;
mod goals;
mod program;
mod run;

use hexagen_codegen::emit::gappa::{Script, Subject};
use hexagen_codegen::ir::Real;
use run::{Bounds, Finding, Run};
use std::time::Duration;

pub use coq::{MissingCoq, certificate, check_certificate, coq_version};
pub use goals::missing_goals;
pub use run::{Missing, gappa_version};

/// Time limit of a proof; the longest of the library takes 1 % of it.
pub const TIME_LIMIT: Duration = Duration::from_secs(20);

/// Greatest ratio of the generator's own bounds to those that Gappa finds.
pub const WIDEST: f64 = 4.0;

/// Errors below this, in units of the last place, are ignored: own bounds are rounded outward in
/// these steps.
const NEGLIGIBLE: f64 = 1e-3;

/// Result of a script.
#[derive(Clone, Debug)]
pub struct Proof {
    /// Goals.
    pub goals: usize,
    /// Of these, goals that are proved as the generator states them.
    pub proved: usize,
    /// Largest ratio of the generator's own bound on an error to the one that Gappa finds.
    pub widest: f64,
    /// Time of all runs.
    pub took: Duration,
    /// The failure, if any.
    pub failure: Option<String>,
}

/// Proves a script.
///
/// # Errors
/// Without Gappa.
pub fn prove(script: &Script) -> Result<Proof, Missing> {
    let mut took = Duration::ZERO;
    let mut run = |text: &str| -> Result<Run, Missing> {
        let run = Run::new(text, TIME_LIMIT)?;
        took += run.took;
        Ok(run)
    };
    // What the generator states.
    let stated = run(&script.to_string())?;
    // What the checker finds, and whether that holds.
    let asked = run(&script.question())?;
    let found = asked.bounds(script);
    let pinned = match &found {
        Ok(bounds) => Some(run(&script.pinned(bounds))?),
        Err(_) => None,
    };
    let (mut widest, mut narrow) = (1.0_f64, None);
    for (goal, &[low, high]) in script
        .goals
        .iter()
        .zip(found.as_deref().unwrap_or_default())
    {
        let own = [goal.low, goal.high].map(Real::value);
        let found = [low, high].map(Real::value);
        // The checker stops refining at one percent: where its bound is wider, the stated goal decides.
        let ratio = magnitude(own) / magnitude(found).max(NEGLIGIBLE);
        if goal.subject != Subject::Value {
            widest = widest.max(ratio);
            if ratio > WIDEST {
                narrow.get_or_insert_with(|| {
                    format!(
                        "{}: the generator's bound is {ratio:.1} times the one found",
                        goal.expression
                    )
                });
            }
        }
    }
    let holds = stated.finding == Finding::Proved;
    let failure = match (stated.finding, found, pinned.map(|run| run.finding)) {
        (Finding::Proved, Ok(_), Some(Finding::Proved)) => narrow,
        (Finding::Proved, Err(reason), _) => Some(reason),
        (Finding::Proved, Ok(_), refused) => Some(format!(
            "the bounds that were found do not hold as goals: {}",
            refused.map_or_else(|| "not run".to_owned(), |finding| finding.to_string())
        )),
        (refused, ..) => Some(refused.to_string()),
    };
    Ok(Proof {
        goals: script.goals.len(),
        proved: if holds { script.goals.len() } else { 0 },
        widest,
        took,
        failure: failure.map(|failure| format!("{}: {failure}", script.name)),
    })
}

/// Whether all goals of a script are proved.
///
/// # Errors
/// Without Gappa.
pub fn is_proved(script: &str) -> Result<bool, Missing> {
    Ok(Run::new(script, TIME_LIMIT)?.finding == Finding::Proved)
}

fn magnitude([low, high]: Bounds) -> f64 {
    low.abs().max(high.abs())
}
