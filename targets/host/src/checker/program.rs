//! Runs an external program on a text, with a time limit.

use std::io::{self, Read, Seek, Write};
use std::process::{Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Polling interval: 1 % of the shortest run.
const LOOK: Duration = Duration::from_micros(500);

/// A run that has ended, or was ended.
#[derive(Clone, Debug)]
pub(super) struct Ended {
    /// None where it took too long.
    pub(super) status: Option<ExitStatus>,
    /// Standard output.
    pub(super) printed: String,
    /// Standard error.
    pub(super) said: String,
    pub(super) took: Duration,
}

impl Ended {
    /// The first lines of standard error that are no warnings.
    pub(super) fn reason(&self) -> String {
        let lines = self
            .said
            .lines()
            .filter(|line| !line.starts_with("Warning"));
        let lines: Vec<&str> = lines.take(4).map(str::trim).collect();
        lines.join(" ")
    }
}

/// Runs a command with `input` on its standard input.
pub(super) fn run_within(command: &mut Command, input: &str, limit: Duration) -> io::Result<Ended> {
    // Files instead of pipes, which block when they are full.
    let mut file = tempfile::tempfile()?;
    file.write_all(input.as_bytes())?;
    file.rewind()?;
    let (mut printed, mut said) = (tempfile::tempfile()?, tempfile::tempfile()?);
    let begin = Instant::now();
    let mut child = command
        .stdin(Stdio::from(file))
        .stdout(Stdio::from(printed.try_clone()?))
        .stderr(Stdio::from(said.try_clone()?))
        .spawn()?;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break Some(status);
        }
        if begin.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            break None;
        }
        sleep(LOOK);
    };
    let took = begin.elapsed();
    let text = |file: &mut std::fs::File| {
        let mut text = String::new();
        file.rewind()?;
        file.read_to_string(&mut text)?;
        io::Result::Ok(text)
    };
    Ok(Ended {
        status,
        printed: text(&mut printed)?,
        said: text(&mut said)?,
        took,
    })
}
