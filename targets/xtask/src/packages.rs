//! Published packages: every crate of the workspace without `publish = false`.

use crate::step::{Step, cargo, root, step};
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Files at the top of every package.
const LICENCES: [&str; 2] = ["LICENSE-APACHE", "LICENSE-MIT"];
const README: &str = "README.md";

/// A crate of the workspace.
struct Member {
    name: String,
    folder: PathBuf,
    is_published: bool,
}

/// Packs all published crates; with `verify`, builds each from its package, against the other
/// packages.
///
/// # Errors
/// Errors of reading the workspace.
pub fn pack(verify: bool) -> Result<Step, String> {
    // Also before a commit: the folder is packed as it is.
    let mut pack = step("packages", &["package", "--workspace", "--allow-dirty"]);
    if verify {
        // A package has no profiles of its own; with the workspace's, the tests have built its
        // dependencies already.
        for variable in [
            "CARGO_PROFILE_DEV_DEBUG",
            "CARGO_PROFILE_DEV_BUILD_OVERRIDE_DEBUG",
        ] {
            pack.environment.push((variable, "line-tables-only"));
        }
    } else {
        pack.arguments.push("--no-verify".to_owned());
    }
    of_published(pack)
}

/// The documentation of all published crates, without warnings and with the guide.
///
/// # Errors
/// Errors of reading the workspace.
pub fn documentation() -> Result<Step, String> {
    of_published(Step {
        environment: vec![("RUSTDOCFLAGS", "-D warnings")],
        check: Some(check_front_page),
        ..step("documentation", &["doc", "--workspace", "--no-deps"])
    })
}

/// Checks that the page of `hexagen` is the library's, which leads to the guide: the program of that
/// name would write its own page over it.
fn check_front_page() -> Result<(), String> {
    let builds = env::var_os("CARGO_TARGET_DIR");
    let builds = root().join(builds.unwrap_or_else(|| "target".into()));
    let page = builds.join("doc/hexagen/index.html");
    if read(&page)?.contains("guide/index.html") {
        return Ok(());
    }
    Err(format!("{} does not lead to the guide", page.display()))
}

/// A step of the whole workspace, without the crates that are not published.
fn of_published(mut step: Step) -> Result<Step, String> {
    let unpublished = members()?.into_iter().filter(|member| !member.is_published);
    step.arguments
        .extend(unpublished.flat_map(|member| ["--exclude".to_owned(), member.name]));
    Ok(step)
}

/// Checks that each package holds both licences, word for word, and a README.
///
/// # Errors
/// What a package lacks, or an error of reading.
pub fn check_contents() -> Result<(), String> {
    for member in members()?.iter().filter(|member| member.is_published) {
        let files = packed_files(&member.name)?;
        if let Some(missing) = LICENCES
            .into_iter()
            .chain([README])
            .find(|&file| !files.lines().any(|line| line == file))
        {
            return Err(format!("the package {} has no {missing}", member.name));
        }
        for licence in LICENCES {
            if read(&member.folder.join(licence))? != read(&root().join(licence))? {
                return Err(format!(
                    "{licence} of the package {} is not that of the repository",
                    member.name
                ));
            }
        }
    }
    println!("== contents of packages: passed");
    Ok(())
}

/// The paths of all files of a package, one per line.
fn packed_files(package: &str) -> Result<String, String> {
    let output = cargo(root())
        .args(["package", "--list", "--allow-dirty", "--package", package])
        .output()
        .map_err(|error| format!("cannot run cargo: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The crates of the workspace.
fn members() -> Result<Vec<Member>, String> {
    let workspace = read(&root().join("Cargo.toml"))?;
    let (_, rest) = workspace
        .split_once("\nmembers = [")
        .ok_or("Cargo.toml has no list of members")?;
    let (folders, _) = rest.split_once(']').unwrap_or((rest, ""));
    folders
        .split('"')
        .skip(1)
        .step_by(2)
        .map(|folder| member(root().join(folder)))
        .collect()
}

fn member(folder: PathBuf) -> Result<Member, String> {
    let file = folder.join("Cargo.toml");
    let manifest = read(&file)?;
    let name = manifest
        .lines()
        .find_map(|line| line.strip_prefix("name = \"")?.strip_suffix('"'))
        .ok_or_else(|| format!("{} names no package", file.display()))?;
    Ok(Member {
        name: name.to_owned(),
        is_published: !manifest.lines().any(|line| line == "publish = false"),
        folder,
    })
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}
