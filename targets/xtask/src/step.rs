//! One step of a task.

use std::env;
use std::path::Path;
use std::process::Command;

/// One cargo command.
pub struct Step {
    pub name: &'static str,
    pub arguments: Vec<String>,
    pub environment: Vec<(&'static str, &'static str)>,
    /// A cargo subcommand that must be installed, and how to get it.
    pub needs: Option<(&'static str, &'static str)>,
    /// What must hold behind it.
    pub check: Option<fn() -> Result<(), String>>,
}

/// A cargo command without prerequisites.
pub fn step(name: &'static str, arguments: &[&str]) -> Step {
    let arguments = arguments
        .iter()
        .map(|&argument| argument.to_owned())
        .collect();
    Step {
        name,
        arguments,
        environment: vec![],
        needs: None,
        check: None,
    }
}

/// The cargo that runs this, in a folder.
pub fn cargo(folder: &Path) -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(folder);
    cargo
}

/// The repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .unwrap_or(Path::new("."))
}
