//! Mutation score: how many small changes of the sources the tests notice.
//!
//! cargo-mutants makes the changes and runs the tests, in a work tree of the last commit. Here is which
//! mutants it takes, which tests each meets, and the score. Snapshots always pass: a mutant must be noticed
//! by something else.

use crate::step::root;
use clap::Args;
use statrs::distribution::{Beta, ContinuousCDF};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Instant, SystemTime, UNIX_EPOCH};
use std::{env, fs, io};

/// Version of cargo-mutants.
const VERSION: &str = "27.1.0";

/// Least share of mutants that are noticed.
const LEAST: f64 = 0.95;

/// Confidence of the interval of the score.
const CONFIDENCE: f64 = 0.95;

/// A test that takes so many times as long as without a mutant has noticed it: it waits for ever.
const PATIENCE: u64 = 5;

/// Least time for a test, seconds.
const LEAST_TIME: u64 = 60;

/// A part of the sources.
struct Part {
    name: &'static str,
    package: &'static str,
    /// A mutant meets the next tests if it passes those before.
    tests: &'static [Tests],
}

/// Packages, and arguments of their tests.
type Tests = (&'static [&'static str], &'static [&'static str]);

/// Tests of a crate's own library come first, for they take seconds.
const PARTS: [Part; 3] = [
    Part {
        name: "generator",
        package: "hexagen-codegen",
        tests: &[
            (&["hexagen-codegen"], &["--lib"]),
            (&["hexagen-tests"], &[]),
            (&["hexagen-lab", "hexagen-host"], &[]),
        ],
    },
    Part {
        name: "laboratory",
        package: "hexagen-lab",
        tests: &[
            (&["hexagen-lab"], &["--lib"]),
            (&["hexagen-lab", "hexagen-host"], &[]),
        ],
    },
    Part {
        name: "runtime",
        package: "hexagen",
        tests: &[(&["hexagen"], &[]), (&["hexagen-tests"], &[])],
    },
];

/// Options of the command.
#[derive(Args)]
pub struct Options {
    /// Mutants of generator and laboratory together; of the runtime all are taken
    #[arg(long, default_value_t = 300)]
    sample: usize,
    /// Which mutants: another number takes others, until all were taken
    #[arg(long, default_value_t = 0)]
    seed: usize,
    /// One part only, and of the runtime a sample, too
    #[arg(long, value_parser = PARTS.map(|part| part.name))]
    only: Option<String>,
}

impl Options {
    /// Another sample each day.
    pub fn tonight() -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        Self {
            sample: 300,
            seed: since.map_or(0, |since| since.as_secs() / 86_400) as usize,
            only: None,
        }
    }
}

/// What became of the mutants.
#[derive(Default)]
struct Outcome {
    noticed: usize,
    survivors: Vec<String>,
    /// They do not compile.
    unviable: usize,
}

/// Plants the mutants and tells the score with its confidence interval and the survivors.
///
/// # Errors
/// If cargo-mutants cannot be installed or run, tests fail without a mutant, or less than [`LEAST`] of the
/// mutants are noticed.
pub fn score(options: &Options) -> Result<(), String> {
    install()?;
    let tree = tree()?;
    let is_asked = |part: &&Part| options.only.as_deref().is_none_or(|only| only == part.name);
    let mut lists = vec![];
    for part in PARTS.iter().filter(is_asked) {
        lists.push((part, list(&tree, part)?));
    }
    let is_sampled = |part: &Part| options.only.is_some() || part.name != "runtime";
    let sampled = lists.iter().filter(|(part, _)| is_sampled(part));
    let all: usize = sampled.map(|(_, names)| names.len()).sum();
    let mut whole = Outcome::default();
    // One list through all parts: each part, folder and file has its share.
    let (step, mut place) = ((all / options.sample.max(1)).max(1), 0);
    for (part, names) in lists {
        let mut chosen = names.clone();
        if is_sampled(part) {
            chosen.retain(|_| {
                place += 1;
                (place - 1) % step == options.seed % step
            });
        }
        let outcome = of_part(&tree, part, &names, chosen)?;
        println!("== {}: {}", part.name, outcome.text());
        whole.noticed += outcome.noticed;
        whole.unviable += outcome.unviable;
        whole.survivors.extend(outcome.survivors);
    }
    println!("== mutation score: {}", whole.text());
    for survivor in &whole.survivors {
        println!("not noticed: {survivor}");
    }
    if whole.share() < LEAST {
        return Err(format!(
            "less than {:.0} % of the mutants are noticed; write a test for a survivor, or remove what it changes",
            100.0 * LEAST
        ));
    }
    Ok(())
}

impl Outcome {
    fn viable(&self) -> usize {
        self.noticed + self.survivors.len()
    }

    fn share(&self) -> f64 {
        self.noticed as f64 / self.viable().max(1) as f64
    }

    fn text(&self) -> String {
        let [low, high] = interval(self.noticed, self.viable());
        format!(
            "{} of {} noticed, {:.1} % ({:.1} to {:.1} % with {:.0} % confidence); {} more do not compile",
            self.noticed,
            self.viable(),
            100.0 * self.share(),
            100.0 * low,
            100.0 * high,
            100.0 * CONFIDENCE,
            self.unviable
        )
    }
}

/// Interval of Clopper and Pearson of a share, of which `hits` of `tries` were seen.
fn interval(hits: usize, tries: usize) -> [f64; 2] {
    let (hits, tries) = (hits as f64, tries as f64);
    let tail = (1.0 - CONFIDENCE) / 2.0;
    let bound = |alpha: f64, beta: f64, share: f64| {
        // One of the two is 0 where all or none was seen.
        Beta::new(alpha, beta).map(|beta| beta.inverse_cdf(share))
    };
    [
        bound(hits, tries - hits + 1.0, tail).unwrap_or(0.0),
        bound(hits + 1.0, tries - hits, 1.0 - tail).unwrap_or(1.0),
    ]
}

/// Installs cargo-mutants, unless it is there.
fn install() -> Result<(), String> {
    let is_there = || {
        let output = cargo(root()).args(["mutants", "--version"]).output();
        output.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains(VERSION))
    };
    let installs = || {
        let arguments = ["install", "cargo-mutants", "--version", VERSION, "--locked"];
        cargo(root())
            .args(arguments)
            .status()
            .is_ok_and(|status| status.success())
    };
    if is_there() || (installs() && is_there()) {
        return Ok(());
    }
    Err(format!(
        "cargo-mutants is missing, and cargo did not install it; by hand: `cargo install cargo-mutants --version {VERSION} --locked`"
    ))
}

fn cargo(tree: &Path) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command
        .current_dir(tree)
        .env("INSTA_FORCE_PASS", "1")
        .env("INSTA_UPDATE", "no")
        .env("CARGO_INCREMENTAL", "1");
    command
}

/// A work tree of the last commit, in which mutants are planted; what is built there is kept.
fn tree() -> Result<PathBuf, String> {
    let tree = folder().join("tree");
    let git = |folder: &Path, arguments: &[&str]| {
        let output = Command::new("git")
            .current_dir(folder)
            .args(arguments)
            .output();
        let output = output.map_err(|error| format!("git: {error}"))?;
        if output.status.success() {
            return Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned());
        }
        Err(format!(
            "git {}: {}",
            arguments.join(" "),
            String::from_utf8_lossy(&output.stderr).trim()
        ))
    };
    let commit = git(root(), &["rev-parse", "HEAD"])?;
    if tree.join(".git").exists() {
        git(
            &tree,
            &["checkout", "--quiet", "--force", "--detach", &commit],
        )?;
    } else {
        let place = tree.to_string_lossy();
        git(root(), &["worktree", "prune"])?;
        git(
            root(),
            &["worktree", "add", "--quiet", "--detach", &place, &commit],
        )?;
    }
    Ok(tree)
}

/// Where the tree and the results of the last runs are.
fn folder() -> PathBuf {
    root().join("target/mutants")
}

/// Names of all mutants of a part, in the order of its files.
fn list(tree: &Path, part: &Part) -> Result<Vec<String>, String> {
    let output = cargo(tree)
        .args(["mutants", "--list", "--package", part.package])
        .output()
        .map_err(|error| format!("cargo mutants: {error}"))?;
    let names = String::from_utf8_lossy(&output.stdout);
    let names: Vec<String> = names.lines().map(str::to_owned).collect();
    if names.is_empty() {
        return Err(format!("{} has no mutants", part.package));
    }
    Ok(names)
}

/// Runs the chosen mutants of a part through its tests.
fn of_part(
    tree: &Path,
    part: &Part,
    all: &[String],
    chosen: Vec<String>,
) -> Result<Outcome, String> {
    let mut outcome = Outcome {
        survivors: chosen,
        ..Outcome::default()
    };
    for (pass, tests) in part.tests.iter().enumerate() {
        if outcome.survivors.is_empty() {
            break;
        }
        let survivors = std::mem::take(&mut outcome.survivors);
        println!(
            "== {}: {} mutants meet {tests:?}",
            part.name,
            survivors.len()
        );
        let found = seconds(tree, tests)
            .and_then(|seconds| run((tree, part), (pass, tests), (all, &survivors), seconds))
            .map_err(|error| format!("mutants of {}: {error}", part.package))?;
        outcome.noticed += found.noticed;
        outcome.unviable += found.unviable;
        outcome.survivors = found.survivors;
    }
    Ok(outcome)
}

/// Time of tests without a mutant.
fn seconds(tree: &Path, (packages, arguments): &Tests) -> io::Result<u64> {
    let run = |more: &[&str]| {
        let mut command = cargo(tree);
        let packages = packages.iter().flat_map(|package| ["--package", package]);
        command.args(["test", "--quiet"]).args(packages);
        let status = command.args(*arguments).args(more).status()?;
        if status.success() {
            return Ok(());
        }
        Err(io::Error::other(format!(
            "{command:?} fails without a mutant"
        )))
    };
    run(&["--no-run"])?;
    let before = Instant::now();
    run(&[])?;
    Ok(before.elapsed().as_secs())
}

/// One run of cargo-mutants, which leaves out what a file lists as noticed before.
fn run(
    (tree, part): (&Path, &Part),
    (pass, (packages, arguments)): (usize, &Tests),
    (all, chosen): (&[String], &[String]),
    seconds: u64,
) -> io::Result<Outcome> {
    let folder = folder().join(format!("{}-{pass}", part.name));
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let results = folder.join("mutants.out");
    fs::create_dir_all(&results)?;
    let chosen: BTreeSet<&String> = chosen.iter().collect();
    let others: String = all
        .iter()
        .filter(|name| !chosen.contains(name))
        .map(|name| format!("{name}\n"))
        .collect();
    fs::write(results.join("previously_caught.txt"), others)?;
    let timeout = (PATIENCE * seconds).max(LEAST_TIME).to_string();
    let mut command = cargo(tree);
    command
        .args(["mutants", "--in-place", "--iterate", "--baseline", "skip"])
        .args(["--timeout", &timeout, "--package", part.package, "--output"])
        .arg(&folder)
        .args(
            packages
                .iter()
                .flat_map(|package| ["--test-package", package]),
        )
        .arg("--")
        .args(*arguments);
    let status = command.status()?;
    let names = |file: &str| -> io::Result<Vec<String>> {
        let text = fs::read_to_string(results.join(file))?;
        Ok(text.lines().map(str::to_owned).collect())
    };
    let [caught, timeout, unviable, missed] =
        ["caught.txt", "timeout.txt", "unviable.txt", "missed.txt"].map(names);
    let mut outcome = Outcome {
        noticed: caught?.len() + timeout?.len(),
        survivors: missed?,
        unviable: unviable?.len(),
    };
    let met = outcome.viable() + outcome.unviable;
    if pass > 0 {
        // It compiled before: its macros refuse a drive, or emit code that does not compile.
        outcome.noticed += std::mem::take(&mut outcome.unviable);
    }
    if met != chosen.len() {
        return Err(io::Error::other(format!(
            "{met} of {} mutants were met ({status}); do the tests pass without them?",
            chosen.len()
        )));
    }
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::interval;

    /// Bounds of the literature: 0 of 10 has 0 to 30.85 %, 9 of 10 has 55.50 to 99.75 %.
    #[test]
    fn the_interval_is_that_of_clopper_and_pearson() {
        for (hits, [low, high]) in [
            (0, [0.0, 0.3085]),
            (9, [0.5550, 0.9975]),
            (10, [0.6915, 1.0]),
        ] {
            let found = interval(hits, 10);
            assert!(
                (found[0] - low).abs() < 1e-4 && (found[1] - high).abs() < 1e-4,
                "{found:?}"
            );
        }
    }
}
