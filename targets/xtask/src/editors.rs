//! What editors show of a macro call, by the language server rust-analyzer.

use crate::step::{Step, step};
use std::path::PathBuf;
use std::process::Command;

/// The language server of the toolchain, and the source of the standard library, without which it
/// shows no error of a macro.
const COMPONENTS: [&str; 2] = ["rust-analyzer", "rust-src"];

/// Installs the components, unless they are there.
///
/// # Errors
/// What to install, where rustup cannot.
pub fn install() -> Result<(), String> {
    let succeeds = |command: &mut Command| command.status().is_ok_and(|status| status.success());
    let has_server = succeeds(Command::new(COMPONENTS[0]).arg("--version"));
    if has_server && has_library_source()? {
        return Ok(());
    }
    if succeeds(
        Command::new("rustup")
            .args(["component", "add"])
            .args(COMPONENTS),
    ) {
        return Ok(());
    }
    Err("rust-analyzer or the source of the standard library is missing, and rustup did not install them; by hand: `rustup component add rust-analyzer rust-src`, or the packages rust-analyzer and rust-src of your system".to_owned())
}

fn has_library_source() -> Result<bool, String> {
    let output = Command::new("rustc")
        .args(["--print", "sysroot"])
        .output()
        .map_err(|error| format!("cannot run rustc: {error}"))?;
    let sysroot = PathBuf::from(String::from_utf8_lossy(&output.stdout).trim());
    Ok(sysroot.join("lib/rustlib/src/rust/library").exists())
}

/// Tests a session with the language server.
pub fn session() -> Step {
    step(
        "editors",
        &["test", "--package", "hexagen-editors", "--", "--ignored"],
    )
}
