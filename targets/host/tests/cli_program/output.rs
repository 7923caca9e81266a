//! Where results cannot go: full devices, closed pipes, files that cannot be.

use crate::support::{PAPER, Said, hexagen, run};
use std::fs;
use std::io::Read;
use std::process::Stdio;

#[cfg(target_os = "linux")]
#[test]
fn a_result_that_cannot_be_written_is_an_error() {
    for arguments in [
        &["generate", PAPER][..],
        &["simulate", PAPER, "--rpm", "1500", "--json"],
        &["simulate", PAPER, "--rpm", "1500"],
        &["limit", PAPER, "--start-angle", "0.1rad"],
        &["boards"],
        &["--help"],
    ] {
        let full = fs::File::create("/dev/full").expect("Linux has it");
        let output = hexagen().args(arguments).stdout(full).output();
        let said = Said::from(output.expect("the program starts"));
        assert_eq!(said.code, 2, "{arguments:?}: {said:?}");
        let told = said
            .stderr
            .contains("cannot write standard output: No space left");
        assert!(told || arguments == ["--help"], "{arguments:?}: {said:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn messages_that_cannot_be_written_change_nothing() {
    let full = || fs::File::create("/dev/full").expect("Linux has it");
    // `check` warns of this motor.
    let noted = ["check", "br2804-1700kv"];
    let said = run(noted);
    assert_ne!(said.stderr, "");
    let output = hexagen().args(noted).stderr(full()).output();
    let unheard = Said::from(output.expect("the program starts"));
    assert_eq!((unheard.code, unheard.stdout), (said.code, said.stdout));
    let output = hexagen()
        .args(["generate", "nothing"])
        .stderr(full())
        .output();
    assert_eq!(Said::from(output.expect("the program starts")).code, 2);
}

#[test]
fn a_reader_that_has_enough_is_no_error() {
    for arguments in [&["generate", PAPER][..], &["--help"]] {
        let mut program = hexagen()
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        drop(program.stdout.take());
        let mut told = String::new();
        let mut stderr = program.stderr.take().expect("a pipe");
        stderr.read_to_string(&mut told).expect("text");
        let status = program.wait().expect("the program ends");
        assert_eq!(
            (status.code(), told.as_str()),
            (Some(0), ""),
            "{arguments:?}"
        );
    }
}

#[test]
fn a_failed_csv_leaves_no_folder_behind() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("new/newer").join("n".repeat(300));
    let path = path.to_str().expect("a plain path");
    let said = run(["simulate", PAPER, "--rpm", "1500", "--csv", path]);
    said.assert_bad_input(&["cannot write"]);
    assert_eq!(fs::read_dir(folder.path()).expect("is there").count(), 0);
}
