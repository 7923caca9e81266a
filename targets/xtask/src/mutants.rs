//! Mutation score: how many small changes of the sources the tests notice.
//!
//! cargo-mutants makes the changes and runs the tests, in a work tree of the last commit. Here is which
//! mutants it takes, which tests each meets, and the score. Snapshots always pass: a mutant must be noticed
//! by something else.

use crate::step::{cargo, root};
use clap::Args;
use statrs::distribution::{Beta, ContinuousCDF};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Instant, SystemTime, UNIX_EPOCH};
use std::{fs, io};

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
    /// Whether all its mutants are taken, not a sample.
    is_whole: bool,
    /// A mutant meets the next tests if it passes those before.
    tests: &'static [Tests],
}

/// Packages, and arguments of their tests.
type Tests = (&'static [&'static str], &'static [&'static str]);

/// Tests that take less time come first.
const PARTS: [Part; 3] = [
    Part {
        name: "generator",
        package: "hexagen-codegen",
        is_whole: false,
        tests: &[
            (&["hexagen-codegen"], &["--lib"]),
            // Compiles no emitted code.
            (&["hexagen-tests"], &["--test", "interpreter"]),
            (&["hexagen-tests"], &[]),
            (&["hexagen-lab", "hexagen-host"], &[]),
        ],
    },
    Part {
        name: "laboratory",
        package: "hexagen-lab",
        is_whole: false,
        tests: &[
            (&["hexagen-lab"], &["--lib"]),
            (&["hexagen-lab", "hexagen-host"], &[]),
        ],
    },
    Part {
        name: "runtime",
        package: "hexagen",
        is_whole: true,
        tests: &[
            (&["hexagen"], &[]),
            (&["hexagen-tests"], &["--test", "supervisor"]),
            (&["hexagen-tests"], &[]),
            (&["hexagen-lab"], &[]),
        ],
    },
];

/// Options of `cargo xtask mutants`.
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

/// Plants the mutants and tells the score of each part, of a sample with its confidence interval, and the
/// survivors. What does not compile is no mutant: the compiler refuses it.
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
    let is_sampled = |part: &Part| options.only.is_some() || !part.is_whole;
    let sampled = lists.iter().filter(|(part, _)| is_sampled(part));
    let all: usize = sampled.map(|(_, names)| names.len()).sum();
    // One list through all parts: each part, folder and file has its share.
    let (step, mut place) = (all.div_ceil(options.sample.max(1)).max(1), 0);
    let mut missed = vec![];
    for (part, names) in lists {
        let mut chosen = names.clone();
        if is_sampled(part) {
            chosen.retain(|_| {
                place += 1;
                (place - 1) % step == options.seed % step
            });
        }
        let outcome = of_part(&tree, part, &names, chosen)?;
        println!("== {}: {}", part.name, outcome.text(is_sampled(part)));
        for survivor in &outcome.survivors {
            println!("not noticed: {survivor}");
        }
        if outcome.viable() > 0 && outcome.share() < LEAST {
            missed.push(part.name);
        }
    }
    if missed.is_empty() {
        return Ok(());
    }
    Err(format!(
        "less than {:.0} % of the mutants of {} are noticed; write a test for a survivor, or remove what it changes",
        100.0 * LEAST,
        missed.join(" and ")
    ))
}

impl Outcome {
    fn viable(&self) -> usize {
        self.noticed + self.survivors.len()
    }

    fn share(&self) -> f64 {
        self.noticed as f64 / self.viable().max(1) as f64
    }

    /// The share, of a sample with its interval.
    fn text(&self, is_sampled: bool) -> String {
        let (noticed, viable) = (self.noticed, self.viable());
        let share = 100.0 * self.share();
        let [low, high] = interval(noticed, viable).map(|bound| 100.0 * bound);
        let within = if is_sampled {
            format!(
                " ({low:.1} to {high:.1} % with {:.0} % confidence)",
                100.0 * CONFIDENCE
            )
        } else {
            String::new()
        };
        let unviable = self.unviable;
        format!(
            "{noticed} of {viable} noticed, {share:.1} %{within}; {unviable} more do not compile"
        )
    }
}

/// Confidence interval (Clopper and Pearson) of a share that was seen in `hits` of `tries`.
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

/// Cargo in the tree, for which snapshots always pass.
fn cargo_in(tree: &Path) -> Command {
    let mut command = cargo(tree);
    command
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
    println!("== mutants of commit {commit}");
    let at_commit = || {
        git(
            &tree,
            &["checkout", "--quiet", "--force", "--detach", &commit],
        )?;
        git(&tree, &["clean", "--quiet", "--force", "-d"])
    };
    if !tree.join(".git").exists() || at_commit().is_err() {
        // None, or that of a repository which was moved.
        if tree.exists() {
            fs::remove_dir_all(&tree).map_err(|error| format!("{}: {error}", tree.display()))?;
        }
        git(root(), &["worktree", "prune"])?;
        let place = tree.to_string_lossy();
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
    let output = cargo_in(tree)
        .args(["mutants", "--list", "--package", part.package])
        .output()
        .map_err(|error| format!("cargo mutants: {error}"))?;
    if !output.status.success() {
        let told = String::from_utf8_lossy(&output.stderr);
        return Err(format!("cargo mutants --list: {}", told.trim()));
    }
    let names = String::from_utf8_lossy(&output.stdout);
    Ok(names.lines().map(str::to_owned).collect())
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
        let mut command = cargo_in(tree);
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
    let others = all.iter().filter(|name| !chosen.contains(name));
    let others: Vec<&str> = others.map(String::as_str).collect();
    fs::write(results.join("previously_caught.txt"), others.join("\n"))?;
    let timeout = (PATIENCE * seconds).max(LEAST_TIME).to_string();
    let mut command = cargo_in(tree);
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
