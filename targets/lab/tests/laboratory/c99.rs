//! Emitted C passes strict flags, equals the bit-true model in every output and state bit, and has
//! no undefined behaviour, for the covering arrays of all kinds of controllers: in a push the rows that
//! together have every value, in the nightly all.

use hexagen_codegen::emit::c99::{RUNTIME, Sources, emit_c99};
use hexagen_codegen::spec::parse_toml;
use hexagen_lab::engine::{Prepared, Verifier, prepare_ast};
use hexagen_tests::covering::{Row, SPECIFICATIONS};
use hexagen_tests::is_whole;
use hexagen_tests::library::{PAPER_MOTOR, motor, motors};
use hexagen_tests::options::kinds;
use hexagen_tests::sensors;
use rayon::prelude::*;
use std::process::Command;
use std::{env, fs};

/// Steps per drive.
const STEPS: u64 = 20_000;

/// One in so many drives is compiled with a check for undefined behaviour, the rest as in firmware;
/// all of them both ways if `HEXAGEN_WHOLE_PRODUCTS` is set.
const CHECKED: usize = 6;

/// One in so many drives with other sensors is compiled in a push: at least one of each set of sensors.
const SHARE: usize = 2;

/// Makes the compiled code stop at undefined behaviour.
const CHECK: &str = "-fsanitize=undefined -fno-sanitize-recover -O1";

fn prepared(toml: &str, what: &str) -> Prepared {
    let prepared = parse_toml(toml, "drive.toml").and_then(|ast| prepare_ast(ast, what, None));
    prepared.unwrap_or_else(|errors| panic!("{what}\n{errors}"))
}

/// Compares a drive's C, compiled with these additional flags; returns the difference.
fn difference(drive: &Prepared, flags: &str, seed: u64) -> Option<String> {
    let verifier = match Verifier::of_c99(drive, flags) {
        Ok(verifier) => verifier,
        Err(error) => panic!("{}: {error}", drive.motor),
    };
    match verifier.verify(STEPS, seed) {
        Ok(report) => {
            assert_eq!(report.steps, STEPS);
            None
        }
        Err(error) => Some(format!("{}\n{error}", drive.motor)),
    }
}

#[test]
fn emitted_c_is_bit_true() {
    let is_whole = is_whole();
    let rows = SPECIFICATIONS.iter().filter(|row| row.is_compiled);
    let rows: Vec<&Row> = rows.collect();
    let failures: Vec<String> = rows
        .par_iter()
        .enumerate()
        .flat_map_iter(|(place, row)| {
            let drive = prepared(row.toml, row.what);
            let is_checked = place % CHECKED == 0;
            let checked = (is_whole || is_checked).then_some(CHECK);
            let plain = (is_whole || !is_checked).then_some("");
            let flags = checked.into_iter().chain(plain);
            let failures = flags.filter_map(|flags| difference(&drive, flags, place as u64));
            failures.collect::<Vec<_>>()
        })
        .collect();
    for kind in kinds() {
        let rows = rows.iter().filter(|row| row.kind == kind.name).count();
        println!("{}: {rows} drives", kind.name);
        assert!(rows >= if is_whole { 16 } else { 8 }, "{}", kind.name);
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn emitted_c_of_other_sensors_is_bit_true() {
    let mut drives = sensors::drives();
    if !is_whole() {
        drives = drives.into_iter().step_by(SHARE).collect();
    }
    let failures: Vec<String> = drives
        .par_iter()
        .enumerate()
        .filter_map(|(place, (what, toml))| {
            let flags = if place % CHECKED == 0 { CHECK } else { "" };
            difference(&prepared(toml, what), flags, place as u64)
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Every motor of the library, with each kind of controller that suits it.
fn library() -> impl Iterator<Item = Prepared> {
    let drives = motors().into_iter().flat_map(|motor| {
        let kinds = kinds().into_iter().map(|kind| kind.name.to_owned());
        kinds.map(move |kind| (motor.clone(), kind))
    });
    drives.filter_map(|(motor, kind)| {
        let ast = parse_toml(&motor.text, "motor.toml").ok()?;
        prepare_ast(ast, &format!("{} {kind}", motor.name), Some(&kind)).ok()
    })
}

/// Words of code, without comments.
fn code(text: &str) -> String {
    let mut parts = text.split("/*");
    let first = parts.next().unwrap_or_default().to_owned();
    let rest = parts.filter_map(|part| part.split_once("*/"));
    rest.fold(first, |code, (_, behind)| code + behind)
}

#[test]
fn no_float_no_loop_no_type_of_eight_bits_and_no_division_on_the_normal_path() {
    let never = [
        "float",
        "double",
        "for",
        "while",
        "do",
        "goto",
        "char",
        "int8_t",
        "uint8_t",
        "int_least8_t",
        "malloc",
        "memcpy",
    ];
    let dividing = [
        "hexagen_divide",
        "hexagen_divide_narrow",
        "hexagen_turn_over",
    ];
    let (mut drives, mut functions) = (0, 0);
    for (_, text) in RUNTIME {
        assert_has_none(&code(text), &never, "the runtime");
    }
    for drive in library() {
        let generated = &drive.generated;
        let sources = emit_c99(&generated.graph, &generated.interface, "HubDrive");
        for text in [&sources.source, &sources.header] {
            assert!(
                text.lines().all(|line| line.chars().count() <= 100),
                "{}",
                drive.motor
            );
        }
        let source = code(&sources.source);
        for text in [&source, &code(&sources.header)] {
            assert_has_none(text, &never, &drive.motor);
        }
        assert!(!source.contains(['%', '/']), "{}", drive.motor);
        for function in source.split("\n}\n") {
            let (head, body) = function.split_once("\n{\n").unwrap_or_default();
            if dividing
                .iter()
                .any(|name| body.contains(&format!("{name}(")))
            {
                functions += 1;
                assert!(
                    head.contains("HEXAGEN_COLD\n") || head.contains(" hub_drive_set_"),
                    "{}: {head}",
                    drive.motor
                );
            }
        }
        drives += 1;
    }
    assert!(
        drives > 40 && functions > 10,
        "{drives} drives, {functions} functions"
    );
}

fn assert_has_none(text: &str, never: &[&str], what: &str) {
    let words = text.split(|letter: char| !(letter.is_alphanumeric() || letter == '_'));
    for word in words {
        assert!(!never.contains(&word), "{what}: {word}");
    }
}

/// Type names reserved by C, C++, a header or the runtime; that of a function of every source; the
/// beginning of a stage's name, and of a constant's.
#[test]
fn names_reserved_in_c_are_changed() {
    let paper = motor(PAPER_MOTOR);
    for (name, prefix) in [
        ("Int", "drive_int"),
        ("Class", "drive_class"),
        ("Stdint", "drive_stdint"),
        ("Hexagen", "drive_hexagen"),
        ("Track", "drive_track"),
        ("Find", "find"),
        ("I", "i"),
    ] {
        let mut ast = parse_toml(&paper.text, "drive.toml").expect("a motor of the library");
        name.clone_into(&mut ast.name.text);
        let drive = prepare_ast(ast, name, None).expect("it generates");
        let sources = emit_c99(&drive.generated.graph, &drive.generated.interface, name);
        assert_eq!(sources.name, prefix);
        assert_eq!(difference(&drive, "", 1), None);
    }
}

/// Compiles these files with a drive and the runtime; returns the output of the program, or of the
/// compiler if it fails.
fn said(sources: &Sources, files: &[(&str, &str)]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let own = [
        (format!("{}.h", sources.name), sources.header.as_str()),
        (format!("{}.c", sources.name), &sources.source),
    ];
    for (name, text) in own {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    for (name, text) in RUNTIME.iter().chain(files) {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    let mut cc = Command::new(env::var_os("CC").unwrap_or_else(|| "cc".into()));
    cc.current_dir(folder.path())
        .args(["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror"])
        .args(["-DHEXAGEN_SIGNALS", "-DHEXAGEN_VERIFICATION"])
        .args(CHECK.split_whitespace())
        .args([&format!("{}.c", sources.name), "hexagen.c"])
        .args(files.iter().map(|(name, _)| name).filter(|name| {
            name.strip_suffix(".c")
                .is_some_and(|stem| stem != "hexagen")
        }))
        .args(["-o", "program"]);
    let built = cc.output().expect("a C compiler: `cc`, or what `CC` names");
    if !built.status.success() {
        return String::from_utf8_lossy(&built.stderr).into_owned();
    }
    let run = Command::new(folder.path().join("program"))
        .output()
        .expect("it runs");
    String::from_utf8_lossy(&run.stdout).into_owned()
}

/// Start-up as in firmware, with the expected results: [`c99_start_up.c`].
const START_UP: &str = include_str!("c99_start_up.c");

fn starting() -> Sources {
    let text = motor(PAPER_MOTOR).text.replacen(
        "[inverter]\n",
        "[inverter]\ncalibration_samples = 16\nprecharge = \"200 us\"\n",
        1,
    );
    let drive = prepared(&text, "start-up");
    emit_c99(&drive.generated.graph, &drive.generated.interface, "Hub")
}

/// Offsets are averaged once per call of `calibrate`; every call publishes the status; signals are
/// of the next controlled period.
#[test]
fn start_up_in_c_averages_once_per_call_and_publishes_its_status_at_once() {
    assert_eq!(said(&starting(), &[("start_up.c", START_UP)]), "passed\n");
}

/// Two drives share one runtime; the error for one of another version names the remedy.
#[test]
fn a_runtime_of_another_version_is_refused() {
    let [(_, header), _] = RUNTIME;
    let other = header.replace("#define HEXAGEN_ABI ", "#define HEXAGEN_ABI 9");
    let files = [("start_up.c", START_UP), ("hexagen.h", other.as_str())];
    let said = said(&starting(), &files);
    let message = "hub.h and hexagen.h are of different versions of hexagen: take both from one.";
    assert!(said.contains(message), "{said}");
}
