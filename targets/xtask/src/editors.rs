//! What editors show of a macro call, by the language server rust-analyzer.

use crate::step::{Step, step};
use std::path::PathBuf;
use std::process::Command;

/// The newest version that Rust 1.95 builds, with whose macro server it speaks.
const VERSION: &str = "=0.0.348";

/// Where it is installed, in the repository.
const FOLDER: &str = "target/tools";
const SERVER: &str = "target/tools/bin/rust-analyzer";

/// Ensures that the server finds the source of the standard library, without which it shows no error
/// of a macro.
///
/// # Errors
/// What to install, if it is missing.
pub fn library_source() -> Result<(), String> {
    let output = Command::new("rustc")
        .args(["--print", "sysroot"])
        .output()
        .map_err(|error| format!("cannot run rustc: {error}"))?;
    let sysroot = PathBuf::from(String::from_utf8_lossy(&output.stdout).trim());
    if sysroot.join("lib/rustlib/src/rust/library").exists() {
        return Ok(());
    }
    Err("the source of the standard library is missing, which rust-analyzer reads; install it: `rustup component add rust-src`".to_owned())
}

/// Builds the language server, unless that was done before, and tests a session with it.
pub fn steps() -> [Step; 2] {
    let install = Step {
        // A session of seconds needs no better: the build takes half the time.
        environment: vec![("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1")],
        ..step(
            "language server",
            &[
                "install",
                "ra_ap_rust-analyzer",
                "--version",
                VERSION,
                "--locked",
                "--root",
                FOLDER,
                "--target-dir",
                "target/tools/build",
            ],
        )
    };
    let session = Step {
        environment: vec![("HEXAGEN_RUST_ANALYZER", SERVER)],
        ..step(
            "editors",
            &["test", "--package", "hexagen-editors", "--", "--ignored"],
        )
    };
    [install, session]
}
