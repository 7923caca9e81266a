//! The steps of each task: cargo commands with their prerequisites.

use crate::step::{Step, cargo, root, step};
use crate::{install, packages, readme};
use std::env;
use std::process::Command;
use std::time::Instant;

/// All checks of a push.
///
/// # Errors
/// Errors of reading the workspace.
pub fn checks() -> Result<Vec<Step>, String> {
    Ok(vec![
        Step {
            needs: Some(("fmt", "rustup component add rustfmt")),
            ..step("format", &["fmt", "--all", "--check"])
        },
        firmware_format("targets/cortex-m4/Cargo.toml"),
        firmware_format("targets/cortex-m0/Cargo.toml"),
        firmware_format("targets/riscv32/Cargo.toml"),
        firmware_format("targets/firmware-c/Cargo.toml"),
        firmware_format("targets/frameworks/b-g431b-esc1/Cargo.toml"),
        firmware_format("targets/frameworks/vesc-4/Cargo.toml"),
        packages::pack(false)?,
        Step {
            needs: Some(("clippy", "rustup component add clippy")),
            ..step(
                "lints",
                &[
                    "clippy",
                    "--workspace",
                    "--all-targets",
                    "--",
                    "-D",
                    "warnings",
                ],
            )
        },
        packages::documentation()?,
        step("tests", &["test", "--workspace", "--no-fail-fast"]),
        step(
            "a drive chosen by a feature",
            &[
                "test",
                "--package",
                "hexagen-ui",
                "--features",
                "front",
                "--test",
                "crate_of_drives",
            ],
        ),
        readme::first_drive()?,
        on_target("firmware", &[]),
        on_target("pil", &[]),
        on_target("cost", &[]),
    ])
}

/// The format of a firmware crate, which is not in the workspace.
fn firmware_format(manifest: &str) -> Step {
    step(
        "format",
        &["fmt", "--manifest-path", manifest, "--", "--check"],
    )
}

/// A command of the test bench.
pub fn bench(command: &'static str, options: &[String]) -> Step {
    let mut step = step(
        command,
        &[
            "run",
            "--quiet",
            "--package",
            "hexagen-bench",
            "--",
            command,
        ],
    );
    step.arguments.extend_from_slice(options);
    step
}

/// A command of the test bench among the checks. In continuous integration its tools must be
/// present; elsewhere missing ones are reported and skipped.
fn on_target(command: &'static str, options: &[&str]) -> Step {
    let mut options: Vec<String> = options.iter().map(|&option| option.to_owned()).collect();
    if env::var_os("CI").is_none() {
        options.push("--where-possible".to_owned());
    }
    bench(command, &options)
}

/// Ensures that proofs can be checked: as root of a Debian system, installs Gappa if it is missing.
///
/// # Errors
/// What to install, if it is missing and this is not root, or it cannot be installed from here.
pub fn checker() -> Result<(), String> {
    let runs = || {
        let version = Command::new("gappa").arg("--version").output();
        version.is_ok_and(|output| output.status.success())
    };
    if runs() || (is_root() && install("gappa") && runs()) {
        return Ok(());
    }
    Err("`gappa` is missing, which checks the proofs; install it: `apt-get update && apt-get install --no-install-recommends gappa` as root on Debian and Ubuntu, else from https://gappa.gitlabpages.inria.fr".to_owned())
}

/// Ensures that Gappa's proofs can be checked again by Coq: as root of a Debian system, installs it
/// and the library of Gappa if they are missing.
///
/// # Errors
/// As [`checker`].
pub fn certificate_checker() -> Result<(), String> {
    let runs = || {
        let library = ["-q", "-batch", "-require-import", "Gappa.Gappa_library"];
        let loaded = Command::new("coqtop").args(library).output();
        loaded.is_ok_and(|output| output.status.success())
    };
    if runs() || (is_root() && install("coq") && install("libcoq-gappa") && runs()) {
        return Ok(());
    }
    Err("`coqtop` with the library of Gappa is missing, which checks certificates; install it: `apt-get update && apt-get install --no-install-recommends coq libcoq-gappa` as root on Debian and Ubuntu, else `opam install coq-gappa`".to_owned())
}

/// Ensures that the page can be tested: as root of a Debian system, installs Chromium if it is
/// missing.
///
/// # Errors
/// As [`checker`].
pub fn browser() -> Result<(), String> {
    let runs = || {
        let version = Command::new("chromium").arg("--version").output();
        version.is_ok_and(|output| output.status.success()) || env::var_os("CHROME").is_some()
    };
    if runs() || (is_root() && install("chromium") && runs()) {
        return Ok(());
    }
    Err("`chromium` is missing, in which the report's page is tested; install it: `apt-get update && apt-get install --no-install-recommends chromium` as root on Debian and Ubuntu, else from https://www.chromium.org, and name it by the variable CHROME".to_owned())
}

/// Whether this process may install packages.
fn is_root() -> bool {
    let user = Command::new("id").arg("-u").output();
    user.is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

/// Installs a package of the system; true on success.
fn install(package: &str) -> bool {
    let apt = |arguments: &[&str]| {
        println!("== set-up: apt-get {}", arguments.join(" "));
        let status = Command::new("apt-get")
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .status();
        status.is_ok_and(|status| status.success())
    };
    // A stale index does not matter: it may have the package, or another list does.
    apt(&["update", "-qq"]);
    apt(&["install", "-y", "-qq", "--no-install-recommends", package])
}

/// All planted faults, with the detector of each.
pub fn faults() -> Step {
    let arguments = [
        "test",
        "--workspace",
        "--test",
        "planted_faults",
        "--",
        "--nocapture",
    ];
    Step {
        environment: vec![("HEXAGEN_ALL_FAULTS", "1")],
        ..step("planted faults", &arguments)
    }
}

/// Programs with tests whose size the environment sets; in a push they are small.
const SIZED: [&str; 6] = [
    "across_crates",
    "equivalence",
    "interpreter",
    "laboratory",
    "planted_faults",
    "proofs",
];

/// Steps too long for a push.
///
/// # Errors
/// Errors of reading the workspace.
pub fn long_checks(steps: u64) -> Result<Vec<Step>, String> {
    let steps = steps.to_string();
    let verify = [
        "run",
        "--release",
        "--",
        "verify",
        "--controller",
        "all",
        "--steps",
        &steps,
    ];
    let prove = ["run", "--release", "--", "prove", "--controller", "all"];
    let certify = ["run", "--release", "--", "prove", "--coq"];
    let certify_all = [
        "run",
        "--release",
        "--",
        "prove",
        "trivedi-keshri-660w",
        "--controller",
        "all",
        "--coq",
    ];
    let studies = ["test", "--workspace", "--no-fail-fast", "--", "--ignored"];
    let mut whole = vec!["test", "--workspace", "--no-fail-fast"];
    whole.extend(SIZED.iter().flat_map(|test| ["--test", test]));
    whole.extend(["--", "--nocapture"]);
    Ok(vec![
        packages::pack(true)?,
        step("verification", &verify),
        Step {
            environment: vec![
                ("HEXAGEN_WHOLE_PRODUCTS", "1"),
                ("HEXAGEN_DECISIONS", "100000000"),
                ("HEXAGEN_ALL_FAULTS", "1"),
                ("HEXAGEN_COQ", "1"),
                ("HEXAGEN_RANDOM_MOTORS", "1000"),
            ],
            ..step("whole products of options, all faults, many motors", &whole)
        },
        // The session of `editors` is among them.
        step("studies", &studies),
        on_target("pil", &["--steps", "1000000"]),
        bench("commands", &[]),
        on_target("programs", &[]),
        install::program(),
        step("proofs", &prove),
        step("certificates of the library", &certify),
        step("certificates of all controllers", &certify_all),
    ])
}

/// Rewrites recorded expectations.
pub fn refresh() -> Vec<Step> {
    vec![
        // Before the snapshots, in which the generator tells the times that this writes.
        on_target("cost", &["--accept"]),
        Step {
            environment: vec![("INSTA_UPDATE", "always"), ("TRYBUILD", "overwrite")],
            ..step("refresh", &["test", "--workspace", "--no-fail-fast"])
        },
    ]
}

/// Runs the steps in order; stops at the first failure.
///
/// # Errors
/// The name of the failing step, or what is missing and how to get it.
pub fn run(steps: &[Step]) -> Result<(), String> {
    for step in steps {
        if let Some((subcommand, remedy)) = step.needs {
            let known = cargo(root()).args([subcommand, "--version"]).output();
            if !known.is_ok_and(|output| output.status.success()) {
                return Err(format!(
                    "`cargo {subcommand}` is missing; install it: {remedy}"
                ));
            }
        }
        println!("== {}: cargo {}", step.name, step.arguments.join(" "));
        let begin = Instant::now();
        let mut command = cargo(root());
        command
            .args(&step.arguments)
            .envs(step.environment.iter().copied());
        if env::var_os("CI").is_some() {
            // Without incremental data, builds are faster and use a third less of the disk.
            command.env("CARGO_INCREMENTAL", "0");
        }
        let status = command
            .status()
            .map_err(|error| format!("cannot run cargo: {error}"))?;
        let outcome = match step.check {
            _ if !status.success() => Err(format!("step `{}` failed", step.name)),
            Some(check) => check(),
            None => Ok(()),
        };
        println!(
            "== {}: {} after {} s",
            step.name,
            if outcome.is_ok() { "passed" } else { "FAILED" },
            begin.elapsed().as_secs()
        );
        outcome?;
    }
    Ok(())
}
