//! Builds the firmware of a target and runs it on the emulated core.

use crate::BenchError;
use crate::listing::{Listed, parse};
use crate::targets::{Purpose, Target};
use crate::toolchain::{Toolchain, find};
use hexagen_firmware::wire::{Mode, Task};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longest run of the emulator.
const PATIENCE: Duration = Duration::from_mins(15);

/// Built firmware.
#[derive(Debug)]
pub struct Firmware {
    /// Its target.
    pub target: Target,
    /// What compiled it.
    pub toolchain: Toolchain,
    folder: PathBuf,
}

impl Firmware {
    /// Builds all programs of a target's firmware crate.
    ///
    /// # Errors
    /// When a tool is missing, or the build fails.
    pub fn build(target: Target) -> Result<Self, BenchError> {
        let toolchain = find(target)?;
        let root = workspace();
        let built = root_of_builds(&root).join("firmware");
        let status = toolchain
            .cargo_build(target)
            .arg("--target-dir")
            .arg(&built)
            // The crate's own `.cargo/config.toml` counts in its folder only.
            .current_dir(root.join("targets").join(target.name()))
            .status()?;
        if !status.success() {
            return Err(BenchError::Build(target.name()));
        }
        Ok(Self {
            target,
            toolchain,
            folder: built.join(target.triple()).join("release"),
        })
    }

    /// A program's ELF.
    pub fn elf(&self, program: &str) -> PathBuf {
        self.folder.join(program)
    }

    /// The drives that the bench program knows.
    ///
    /// # Errors
    /// When the emulator fails.
    pub fn drives(&self) -> Result<Vec<Listed>, BenchError> {
        let task = Task {
            mode: Mode::List,
            drive: 0,
            block: 0,
        };
        let text = self.run(&task, &[])?;
        parse(&String::from_utf8_lossy(&text)).ok_or(BenchError::Listing)
    }

    /// Runs a task on the bench program; returns its answers.
    ///
    /// # Errors
    /// When the emulator fails or hangs.
    pub fn run(&self, task: &Task, records: &[u8]) -> Result<Vec<u8>, BenchError> {
        let purpose = match task.mode {
            Mode::Count => Purpose::Counts,
            _ => Purpose::Answers,
        };
        let folder = tempfile::tempdir()?;
        fs::write(
            folder.path().join("task"),
            [task.encode().as_slice(), records].concat(),
        )?;
        self.emulate("bench", purpose, folder.path())?;
        Ok(fs::read(folder.path().join("answers"))?)
    }

    /// Runs a program on the emulated core, in a folder of the host; returns what it printed.
    ///
    /// # Errors
    /// When it does not end well, or not in time.
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

/// The repository.
pub fn workspace() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_path_buf()
}

/// Where this workspace builds.
fn root_of_builds(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root.join("target"), |folder| root.join(folder))
}
