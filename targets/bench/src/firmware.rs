//! Builds the firmware of a target and runs it on the emulated core.

use crate::BenchError;
use crate::listing::{Listed, parse};
use crate::log;
use crate::targets::{Purpose, Target};
use crate::toolchain::{Toolchain, find};
use hexagen_firmware::wire::{Mode, Task};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The programs of every firmware with drives: in Rust, and emitted as C.
pub const PROGRAMS: [&str; 2] = ["bench", "c99"];

/// The programs of `targets/frameworks`, and whether they report over defmt.
const FRAMEWORKS: [(&str, bool); 2] = [("hexagen-b-g431b-esc1", true), ("hexagen-vesc-4", false)];

/// Time-out of the emulator.
const PATIENCE: Duration = Duration::from_mins(15);

/// Built firmware.
#[derive(Debug)]
pub struct Firmware {
    /// Its target.
    pub target: Target,
    /// The compiler.
    pub toolchain: Toolchain,
    built: PathBuf,
}

impl Firmware {
    /// Builds all programs of a target's firmware crate.
    ///
    /// # Errors
    /// If a tool is missing, or the build fails.
    pub fn build(target: Target) -> Result<Self, BenchError> {
        let firmware = Self::find(target)?;
        if firmware.cargo(&[]).status()?.success() {
            Ok(firmware)
        } else {
            Err(BenchError::Build(target.name()))
        }
    }

    /// A target's firmware, not built yet.
    fn find(target: Target) -> Result<Self, BenchError> {
        Ok(Self {
            target,
            toolchain: find(target)?,
            built: root_of_builds(&workspace()).join("firmware"),
        })
    }

    /// Lints the firmware and the programs of `targets/frameworks`, which are for the Cortex-M4.
    ///
    /// # Errors
    /// If there are findings.
    pub fn lint(&self) -> Result<(), BenchError> {
        self.lint_folder(self.target.name())?;
        if self.target == Target::CortexM4 {
            self.lint_folder("frameworks")?;
        }
        Ok(())
    }

    /// Builds the programs of `targets/frameworks`, one by one: as members of one build they would
    /// share the features of what both use. Looks into what they log.
    ///
    /// # Errors
    /// If a tool is missing, or a program does not build, logs nothing, or masks interrupts to log.
    pub fn build_frameworks() -> Result<(), BenchError> {
        let cortex = Self::find(Target::CortexM4)?;
        for (program, is_logging) in FRAMEWORKS {
            let mut build = cortex.command("frameworks", "build");
            if !build.args(["--package", program]).status()?.success() {
                return Err(BenchError::Build(program));
            }
            if is_logging {
                log::check(&cortex.elf(program))?;
            }
        }
        Ok(())
    }

    /// Lints a folder of `targets`.
    fn lint_folder(&self, folder: &str) -> Result<(), BenchError> {
        let mut command = self.command(folder, "clippy");
        command.args(["--", "-D", "warnings"]);
        if command.status()?.success() {
            Ok(())
        } else {
            Err(BenchError::Failed(format!("targets/{folder} has findings")))
        }
    }

    /// `cargo build` of this firmware.
    fn cargo(&self, arguments: &[&str]) -> Command {
        let mut command = self.command(self.target.name(), "build");
        command.args(arguments);
        command
    }

    /// A cargo command in a folder of `targets`.
    fn command(&self, folder: &str, name: &str) -> Command {
        let mut command = self.toolchain.cargo(name, self.target);
        command
            .arg("--target-dir")
            .arg(&self.built)
            // `.cargo/config.toml` of a crate applies in its folder only.
            .current_dir(workspace().join("targets").join(folder));
        command
    }

    /// A program's ELF.
    pub fn elf(&self, program: &str) -> PathBuf {
        self.built
            .join(self.target.triple())
            .join("release")
            .join(program)
    }

    /// Builds the peers again with a floating-point unit, if the target has one: the drives are
    /// built without.
    ///
    /// # Errors
    /// If the build fails.
    pub fn build_peers(&self) -> Result<(), BenchError> {
        if self.target != Target::CortexM4 {
            return Ok(());
        }
        let status = self
            .cargo(&["--bin", "peers"])
            .env("RUSTFLAGS", "-C target-cpu=cortex-m4")
            .status()?;
        if status.success() {
            Ok(())
        } else {
            Err(BenchError::Build(self.target.name()))
        }
    }

    /// The drives of a program.
    ///
    /// # Errors
    /// If the emulator fails.
    pub fn drives(&self, program: &str) -> Result<Vec<Listed>, BenchError> {
        let task = Task {
            mode: Mode::List,
            drive: 0,
            block: 0,
        };
        let text = self.run_program(program, task, &[])?;
        parse(&String::from_utf8_lossy(&text)).ok_or(BenchError::Listing)
    }

    /// Runs a task on a program; returns its answers.
    ///
    /// # Errors
    /// If the emulator fails or hangs.
    pub fn run_program(
        &self,
        program: &str,
        task: Task,
        records: &[u8],
    ) -> Result<Vec<u8>, BenchError> {
        let purpose = match task.mode {
            Mode::Count | Mode::Supervision => Purpose::Counts,
            _ => Purpose::Answers,
        };
        let folder = folder_of(task, records)?;
        self.emulate(program, purpose, folder.path())?;
        Ok(fs::read(folder.path().join("answers"))?)
    }

    /// Runs a task on a program; returns the log of all instructions.
    ///
    /// # Errors
    /// If the emulator fails or hangs.
    pub fn trace(&self, program: &str, task: Task, records: &[u8]) -> Result<String, BenchError> {
        let folder = folder_of(task, records)?;
        self.emulate(program, Purpose::Trace, folder.path())?;
        Ok(fs::read_to_string(folder.path().join("log"))?)
    }

    /// Runs a program on the emulated core, in a folder of the host; returns its output.
    ///
    /// # Errors
    /// If it fails, or does not end in time.
    pub fn emulate(
        &self,
        program: &str,
        purpose: Purpose,
        folder: &Path,
    ) -> Result<String, BenchError> {
        let mut child = Command::new(self.target.emulator())
            .args(self.target.machine(purpose))
            .args(["-display", "none", "-monitor", "none", "-serial", "none"])
            .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
            .arg(self.elf(program))
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()?;
        let begin = Instant::now();
        while child.try_wait()?.is_none() {
            if begin.elapsed() > PATIENCE {
                child.kill()?;
                child.wait()?;
                return Err(BenchError::Hangs(self.target.name()));
            }
            sleep(Duration::from_millis(5));
        }
        let output = child.wait_with_output()?;
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        if output.status.success() {
            Ok(printed)
        } else {
            Err(BenchError::Ended(
                self.target.name(),
                output.status,
                printed,
            ))
        }
    }
}

/// A folder with a task, for the emulator to run in.
fn folder_of(task: Task, records: &[u8]) -> Result<tempfile::TempDir, BenchError> {
    let folder = tempfile::tempdir()?;
    let bytes = [task.encode().as_slice(), records].concat();
    fs::write(folder.path().join("task"), bytes)?;
    Ok(folder)
}

/// The repository.
pub fn workspace() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_path_buf()
}

/// Target folder of this workspace.
fn root_of_builds(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root.join("target"), |folder| root.join(folder))
}
