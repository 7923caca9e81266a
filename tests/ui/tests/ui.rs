//! Diagnostics of `hexagen::controller!` as the compiler shows them: one case for each kind of
//! marked place. Their wording is tested in `codegen/src/spec/tests/diagnostics.rs`.

use std::fs;
use std::path::{Path, PathBuf};

/// `TRYBUILD=overwrite cargo test -p hexagen-ui` refreshes the expected messages.
#[test]
fn errors_read_as_expected() {
    copy_motor_files();
    let cases = trybuild::TestCases::new();
    cases.compile_fail("*.rs");
    cases.compile_fail("generation/*.rs");
    cases.compile_fail("motor_file/*.rs");
    // Calls of an option on a drive without it: these messages are the compiler's.
    cases.compile_fail("options/*.rs");
}

/// The cases are compiled as a crate of their own in the target folder, and `motor: "…"` is
/// relative to the crate.
fn copy_motor_files() {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .parent()
        .expect("lies in the target folder");
    let folder = target
        .join("tests/trybuild")
        .join(env!("CARGO_PKG_NAME"))
        .join("motors");
    fs::create_dir_all(&folder).expect("the folder of the cases' crate");
    for file in files("motors", "toml") {
        let name = file.file_name().expect("is a file");
        fs::copy(&file, folder.join(name)).expect("a motor file is copied");
    }
}

/// Expectations contain no path of this machine, no follow-on error and no obsolete case.
#[test]
fn expectations_tell_the_specification_only() {
    let machine = Path::new(env!("CARGO_MANIFEST_DIR"));
    let expectations: Vec<PathBuf> = ["", "generation", "motor_file"]
        .into_iter()
        .flat_map(|folder| files(folder, "stderr"))
        .collect();
    assert!(expectations.len() >= 19, "{}", expectations.len());
    for file in expectations {
        let text = fs::read_to_string(&file).expect("readable expectation");
        let name = file.display();
        assert!(file.with_extension("rs").is_file(), "{name} has no case");
        assert!(
            !text.contains(&*machine.to_string_lossy()) && !text.contains("$DIR"),
            "{name} tells a place: {text}"
        );
        for error in text.lines().filter(|line| line.starts_with("error")) {
            assert!(error.contains("HX"), "{name} follows on: {error}");
        }
    }
}

/// Calls of an option exist only with that option, and the message names it.
#[test]
fn calls_of_options_name_the_option() {
    for (case, words) in [
        ("set_speed_without_speed_loop", "speed_loop: on"),
        ("set_bus_of_fixed_bus", "v_bus: measured"),
        ("drive_of_no_controller", "hexagen::controller!"),
    ] {
        let file = Path::new("options").join(case).with_extension("stderr");
        let text = fs::read_to_string(file).expect("readable expectation");
        assert!(text.contains(words), "{case}: {text}");
    }
}

/// Files of this package with an extension, sorted.
fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files: Vec<PathBuf> = fs::read_dir(folder)
        .expect("a folder of cases")
        .map(|entry| entry.expect("readable entry").path())
        .filter(|path| path.extension().is_some_and(|found| found == extension))
        .collect();
    files.sort();
    files
}
