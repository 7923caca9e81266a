//! Time of `cargo check` of a crate that adds hexagen: the first time, and with a hundred
//! controllers.
//!
//! Measures crates in a folder of their own, like a user's: one with a controller, checked with
//! nothing built; one with 25 motors times 4 controllers and one with none, whose dependencies are
//! built first. All use the dev profile, in which macros run unoptimised. Another program runs the
//! generator like the macro, in the same profile, and measures its parts.

mod first;

use crate::step::cargo;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// Goal for a hundred controllers.
const GOAL: Duration = Duration::from_secs(5);

/// Motors of the library that suit every controller.
const MOTORS: [&str; 11] = [
    "anaheim-bly171d",
    "anaheim-bly172s",
    "anaheim-bly341s",
    "estun-emj-04apb22",
    "hoverboard-hub",
    "hurst-long",
    "linix-45zwn24-40",
    "mit-mini-cheetah",
    "regal-5sme39dl0756",
    "teknic-m2310p",
    "trivedi-keshri-660w",
];

/// Each motor at its own control period and at others, up to this number.
const COUNT: usize = 25;
const PERIODS: [Option<&str>; 3] = [None, Some("32 kHz"), Some("40 kHz")];

const CONTROLLERS: [&str; 4] = ["fcs_mpc", "pdcc", "phcc", "pi_pwm"];

/// Number of measurements; the median counts.
const RUNS: usize = 5;

/// Prints the time of the first check and that added by a hundred controllers, with the share of
/// each part.
///
/// # Errors
/// Errors of writing, running or reading.
pub fn measure(root: &Path) -> Result<(), String> {
    let folder = Folder::new(root)?;
    folder.check_first()?;
    folder.cargo(&["build", "--package", "shares"])?;
    let shares = folder.shares()?;
    let times = folder.times()?;
    times.print();
    print_shares(&shares, times.added());
    Ok(())
}

/// The generator's parts, and the compiler's rest of the added time.
fn print_shares(shares: &[(String, f64)], added: Duration) {
    println!("of which the generator, unoptimised as in every dev build:");
    let all: f64 = shares.iter().map(|(_, seconds)| seconds).sum();
    for (part, seconds) in shares {
        println!("  {part:18} {seconds:.2} s, {:.0} %", 100.0 * seconds / all);
    }
    let rest = added.as_secs_f64() - all;
    println!(
        "  together           {all:.2} s; the compiler's own work on the emitted code is the rest, {rest:.2} s"
    );
}

/// Times of both crates.
struct Times {
    none: Spread,
    hundred: Spread,
    /// Mean processor time of the latter, if the system provides it.
    busy: Option<Duration>,
}

impl Times {
    /// Time added by a hundred controllers.
    fn added(&self) -> Duration {
        self.hundred.median.saturating_sub(self.none.median)
    }

    fn print(&self) {
        let controllers = COUNT * CONTROLLERS.len();
        println!(
            "`cargo check` from nothing, dependencies built, on two cores, median of {RUNS} runs:"
        );
        println!("  no controller      {}", self.none);
        println!("  {controllers} controllers    {}", self.hundred);
        if let Some(busy) = self.busy {
            let busy = busy.as_secs_f64();
            println!(
                "  processor time     {busy:.2} s per run of the latter: much less than its time says that the machine is shared"
            );
        }
        let added = self.added();
        let verdict = if added < GOAL { "below" } else { "ABOVE" };
        println!(
            "  added              {:.2} s, {verdict} the goal of {} s",
            added.as_secs_f64(),
            GOAL.as_secs()
        );
    }
}

/// Processor time of all child processes, if the system provides it (Linux).
fn processor_time() -> Option<Duration> {
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    // After the program's name, which may contain anything, the fields start at the third; the
    // sixteenth and seventeenth are ticks of 10 ms.
    let (_, fields) = text.rsplit_once(')')?;
    let ticks = fields.split_whitespace().skip(13).take(2);
    let ticks: Option<Vec<u64>> = ticks.map(|ticks| ticks.parse().ok()).collect();
    Some(Duration::from_millis(10 * ticks?.iter().sum::<u64>()))
}

/// Times of one crate.
struct Spread {
    least: Duration,
    median: Duration,
    most: Duration,
}

impl Spread {
    fn of(mut times: Vec<Duration>) -> Self {
        times.sort_unstable();
        Self {
            least: times[0],
            median: times[times.len() / 2],
            most: times[times.len() - 1],
        }
    }
}

impl std::fmt::Display for Spread {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [least, median, most] =
            [self.least, self.median, self.most].map(|time| time.as_secs_f64());
        write!(f, "{median:.2} s ({least:.2} to {most:.2})")
    }
}

/// The scratch workspace.
struct Folder(PathBuf);

impl Folder {
    fn new(root: &Path) -> Result<Self, String> {
        let builds = std::env::var_os("CARGO_TARGET_DIR");
        let builds = builds.map_or_else(|| root.join("target"), |folder| root.join(folder));
        let folder = Self(builds.join("compile-time"));
        folder
            .fill(root)
            .map_err(|error| format!("{}: {error}", folder.0.display()))?;
        Ok(folder)
    }

    /// Writes the three crates. Their dependencies have the versions of this workspace.
    fn fill(&self, root: &Path) -> std::io::Result<()> {
        let write = |file: &str, text: &str| {
            let file = self.0.join(file);
            fs::create_dir_all(file.parent().unwrap_or(&self.0))?;
            fs::write(file, text)
        };
        write(
            "Cargo.toml",
            "[workspace]\nresolver = \"3\"\nmembers = [\"hundred\", \"none\", \"one\", \"shares\"]\n",
        )?;
        fs::copy(root.join("Cargo.lock"), self.0.join("Cargo.lock"))?;
        let runtime = toml_text(&root.join("runtime"));
        let user = format!("hexagen = {{ path = {runtime} }}\n");
        let codegen = toml_text(&root.join("codegen"));
        let inside = format!("hexagen-codegen = {{ path = {codegen} }}\nproc-macro2 = \"1\"\n");
        for (name, dependencies) in [
            ("none", &user),
            ("one", &user),
            ("hundred", &user),
            ("shares", &inside),
        ] {
            let manifest = format!(
                "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\n{dependencies}"
            );
            write(&format!("{name}/Cargo.toml"), &manifest)?;
        }
        let mut calls = vec![];
        for (motor, period) in motors() {
            let text = fs::read_to_string(root.join(format!("targets/motors/{motor}.toml")))?;
            let (name, text) = with_period(motor, &text, period);
            write(&format!("hundred/motors/{name}.toml"), &text)?;
            for controller in CONTROLLERS {
                let number = calls.len();
                calls.push(format!(
                    "pub Drive{number} {{ motor: \"motors/{name}.toml\", controller: {controller} {{}} }}\n"
                ));
            }
        }
        let calls = calls.concat();
        let macros = calls
            .lines()
            .map(|call| format!("hexagen::controller! {{ {call} }}\n"));
        let macros: String = macros.collect();
        // The generator's warnings are deprecations.
        let allowed = "#![no_std]\n#![allow(deprecated)]\n";
        write("hundred/src/lib.rs", &format!("{allowed}{macros}"))?;
        write("none/src/lib.rs", "#![no_std]\n")?;
        let first = calls.lines().next().unwrap_or_default();
        let first = first.replace("motors/", "../hundred/motors/");
        write(
            "one/src/lib.rs",
            &format!("#![no_std]\nhexagen::controller! {{ {first} }}\n"),
        )?;
        write("shares/src/calls", &calls)?;
        write("shares/src/main.rs", include_str!("compile_time/shares.rs"))
    }

    /// Checks a crate with one controller with nothing built.
    fn check_first(&self) -> Result<(), String> {
        let builds = self.0.join("first");
        if builds.exists() {
            fs::remove_dir_all(&builds)
                .map_err(|error| format!("{}: {error}", builds.display()))?;
        }
        let begin = Instant::now();
        self.cargo_into(&builds, &["check", "--package", "one", "--timings"])?;
        first::print(
            &builds.join("cargo-timings/cargo-timing.html"),
            begin.elapsed(),
        )
    }

    fn cargo(&self, arguments: &[&str]) -> Result<(), String> {
        self.cargo_into(&self.0.join("target"), arguments)
    }

    fn cargo_into(&self, builds: &Path, arguments: &[&str]) -> Result<(), String> {
        let status = cargo(&self.0)
            .args(arguments)
            .args(["--quiet", "--jobs", "2", "--target-dir"])
            .arg(builds)
            .status()
            .map_err(|error| format!("cannot run cargo: {error}"))?;
        if status.success() {
            Ok(())
        } else {
            Err(format!("`cargo {}` failed", arguments.join(" ")))
        }
    }

    /// Checks both crates in turn.
    fn times(&self) -> Result<Times, String> {
        for name in ["none", "hundred"] {
            self.check(name)?;
        }
        let (mut none, mut hundred) = (vec![], vec![]);
        let mut busy = Some(Duration::ZERO);
        for _ in 0..RUNS {
            none.push(self.check("none")?);
            let begin = processor_time();
            hundred.push(self.check("hundred")?);
            let passed = processor_time()
                .zip(begin)
                .map(|(end, begin)| end.saturating_sub(begin));
            busy = busy
                .zip(passed)
                .map(|(sum, passed)| sum + passed / RUNS as u32);
        }
        Ok(Times {
            none: Spread::of(none),
            hundred: Spread::of(hundred),
            busy,
        })
    }

    /// Checks a crate for the first time.
    fn check(&self, name: &str) -> Result<Duration, String> {
        self.forget(name)
            .map_err(|error| format!("{}: {error}", self.0.display()))?;
        let begin = Instant::now();
        self.cargo(&["check", "--package", name])?;
        Ok(begin.elapsed())
    }

    /// Removes the compiler's incremental data of a crate.
    fn forget(&self, name: &str) -> std::io::Result<()> {
        for kept in ["incremental", ".fingerprint"] {
            let Ok(entries) = fs::read_dir(self.0.join("target/debug").join(kept)) else {
                continue;
            };
            for entry in entries {
                let entry = entry?;
                if entry
                    .file_name()
                    .to_string_lossy()
                    .starts_with(&format!("{name}-"))
                {
                    fs::remove_dir_all(entry.path())?;
                }
            }
        }
        Ok(())
    }

    /// The generator's parts with their seconds.
    fn shares(&self) -> Result<Vec<(String, f64)>, String> {
        let output = Command::new(self.0.join("target/debug/shares"))
            .current_dir(self.0.join("hundred"))
            .output()
            .map_err(|error| format!("cannot run the generator: {error}"))?;
        let text = String::from_utf8_lossy(&output.stdout);
        let read = |line: &str| {
            let (part, seconds) = line.split_once(':')?;
            Some((part.to_owned(), seconds.trim().parse().ok()?))
        };
        let shares: Option<Vec<_>> = text.lines().map(read).collect();
        shares
            .filter(|_| output.status.success())
            .ok_or_else(|| format!("the generator says: {text}"))
    }
}

fn motors() -> impl Iterator<Item = (&'static str, Option<&'static str>)> {
    let all = PERIODS
        .into_iter()
        .flat_map(|period| MOTORS.map(|motor| (motor, period)));
    all.take(COUNT)
}

/// A motor's file with another control period, and its name.
fn with_period(motor: &str, text: &str, period: Option<&str>) -> (String, String) {
    let Some(period) = period else {
        return (motor.to_owned(), text.to_owned());
    };
    let line = |line: &str| {
        if line.starts_with("f_pwm") {
            format!("f_pwm = \"{period}\"\n")
        } else {
            format!("{line}\n")
        }
    };
    let digits = period.trim_end_matches(" kHz");
    (
        format!("{motor}-{digits}"),
        text.lines().map(line).collect(),
    )
}

/// A path as a text of TOML.
fn toml_text(path: &Path) -> String {
    format!("'{}'", path.display())
}
