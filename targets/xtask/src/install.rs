//! The program as its users install it.

use crate::step::{Step, root, step};
use std::fs;
use std::process::Command;

/// Where it is installed to.
const FOLDER: &str = "target/installed";

/// Greatest size of the program, bytes.
const MOST_BYTES: u64 = 30_000_000;

/// Installs the program as the README says.
pub fn program() -> Step {
    Step {
        check: Some(check_program),
        ..step(
            "the installed program",
            &[
                "install",
                "--path",
                "targets/host",
                "--locked",
                "--force",
                "--root",
                FOLDER,
            ],
        )
    }
}

/// Checks that it runs and is small.
fn check_program() -> Result<(), String> {
    let path = root().join(FOLDER).join("bin/hexagen");
    let told = |error: std::io::Error| format!("{}: {error}", path.display());
    let bytes = fs::metadata(&path).map_err(told)?.len();
    let size = format!("{}: {bytes} bytes of at most {MOST_BYTES}", path.display());
    if bytes > MOST_BYTES {
        return Err(format!("{size}; find what has grown with `cargo bloat`"));
    }
    let version = Command::new(&path)
        .arg("--version")
        .output()
        .map_err(told)?;
    let text = String::from_utf8_lossy(&version.stdout).into_owned();
    if !version.status.success() || !text.starts_with("hexagen ") {
        return Err(format!("{} --version says: {text}", path.display()));
    }
    println!("{size}; {}", text.trim_end());
    Ok(())
}
