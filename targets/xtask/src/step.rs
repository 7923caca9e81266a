//! One step of a task.

use std::path::Path;

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

/// The repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .unwrap_or(Path::new("."))
}
