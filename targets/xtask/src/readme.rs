//! The README's first drive as a crate of its own, with the lines that a reader copies.

use crate::step::{Step, root, step};
use std::fs;
use std::path::Path;

/// The repository as the README's lines of dependencies name it: beside the reader's crate.
const BESIDE: &str = "\"../hexagen/";

/// Folder of the crate.
const CRATE: &str = "target/readme";

/// Writes a crate that has the README's dependencies and macro call; the README's lines of firmware, and `verify!`, are
/// its tests. Of the dependencies only the path to the repository is replaced. The step builds and tests the crate,
/// offline, with the versions of the workspace's lock file.
///
/// # Errors
/// A part that the README lacks, or an error of reading or writing.
pub fn first_drive() -> Result<Step, String> {
    let path = root().join("README.md");
    let readme = fs::read_to_string(&path).map_err(|error| format!("README.md: {error}"))?;
    let folder = root().join(CRATE);
    write(
        &folder.join("Cargo.toml"),
        &manifest(block(&readme, "toml")?)?,
    )?;
    write(
        &folder.join("src/lib.rs"),
        &library(block(&readme, "rust")?)?,
    )?;
    let lock = fs::read_to_string(root().join("Cargo.lock"));
    let lock = lock.map_err(|error| format!("Cargo.lock: {error}"))?;
    write(&folder.join("Cargo.lock"), &lock)?;
    Ok(Step {
        // What the workspace has built is used.
        environment: vec![("CARGO_TARGET_DIR", "target")],
        ..step(
            "the README's first drive",
            &[
                "test",
                "--offline",
                "--manifest-path",
                "target/readme/Cargo.toml",
            ],
        )
    })
}

/// The first block of a language.
fn block<'a>(readme: &'a str, language: &str) -> Result<&'a str, String> {
    let begin = format!("\n```{language}\n");
    let (_, rest) = readme
        .split_once(&begin)
        .ok_or_else(|| format!("README.md has no block in {language}"))?;
    Ok(rest.split("\n```").next().unwrap_or(rest))
}

fn manifest(dependencies: &str) -> Result<String, String> {
    if !dependencies.contains(BESIDE) {
        return Err(format!(
            "README.md: no line of dependencies names {BESIDE}…; name the repository so, or change `BESIDE` with it"
        ));
    }
    let here = format!("\"{}/", root().display());
    let dependencies = dependencies.replace(BESIDE, &here);
    Ok(format!(
        "[package]\nname = \"first-drive\"\nedition = \"2024\"\n\n{dependencies}\n\n[workspace]\n"
    ))
}

/// The crate's text: the README's macro call, and a test that runs the lines which follow it.
fn library(example: &str) -> Result<String, String> {
    let (call, lines) = example
        .split_once("\nuse ")
        .ok_or("README.md: no `use` behind the macro call")?;
    Ok(format!(
        "{call}\n#[cfg(test)]\nmod tests {{\nuse super::HubDrive;\n\nhexagen::verify!(HubDrive);\n\n#[test]\nfn the_lines_run() {{\nuse {lines}\n}}\n}}\n"
    ))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    let told = |error: std::io::Error| format!("{}: {error}", path.display());
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(told)?;
    }
    fs::write(path, text).map_err(told)
}
