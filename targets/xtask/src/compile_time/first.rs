//! The first `cargo check` of a crate that adds hexagen: its time, and the share of each crate.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::time::Duration;

/// Goal of the first check on two cores.
const GOAL: Duration = Duration::from_secs(30);

/// Number of crates listed by name; the others together.
const LISTED: usize = 10;

/// Prints the time and the shares, from cargo's own report of a clean build.
///
/// # Errors
/// Errors of reading the report.
pub fn print(report: &Path, taken: Duration) -> Result<(), String> {
    let text =
        fs::read_to_string(report).map_err(|error| format!("{}: {error}", report.display()))?;
    let mut crates = crates(&text)
        .ok_or_else(|| format!("{}: no list of crates with times", report.display()))?;
    crates.sort_by(|one, other| other.1.total_cmp(&one.1));
    let all: f64 = crates.iter().map(|(_, seconds)| seconds).sum();
    let verdict = if taken < GOAL { "below" } else { "ABOVE" };
    println!(
        "first `cargo check` of a crate with one controller, nothing built, on two cores: {:.1} s, {verdict} the goal of {} s",
        taken.as_secs_f64(),
        GOAL.as_secs()
    );
    println!("of the compiler's time, {all:.1} s, by crate:");
    let (listed, others) = crates.split_at(LISTED.min(crates.len()));
    let row = |name: &str, seconds: f64| {
        println!(
            "  {name:18} {seconds:5.1} s, {:.0} %",
            100.0 * seconds / all
        );
    };
    for (name, seconds) in listed {
        row(name, *seconds);
    }
    row(
        &format!("{} others", others.len()),
        others.iter().map(|(_, seconds)| seconds).sum(),
    );
    Ok(())
}

/// Crates with their seconds: a build script counts for its crate.
fn crates(report: &str) -> Option<Vec<(String, f64)>> {
    let (_, list) = report.split_once("const UNIT_DATA = ")?;
    let units = serde_json::Deserializer::from_str(list).into_iter::<Vec<Value>>();
    let units = units.take(1).next()?.ok()?;
    let mut crates: Vec<(String, f64)> = vec![];
    for unit in &units {
        let (name, seconds) = (unit["name"].as_str()?, unit["duration"].as_f64()?);
        match crates.iter_mut().find(|(known, _)| known == name) {
            Some((_, sum)) => *sum += seconds,
            None => crates.push((name.to_owned(), seconds)),
        }
    }
    (!crates.is_empty()).then_some(crates)
}
