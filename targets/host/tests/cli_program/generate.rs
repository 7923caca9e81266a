//! `hexagen generate` and `motors`: the same bytes every time, to stdout and to files.

use crate::support::{LIBRARY, LIBRARY_AS_JSON, PAPER, keys, number, run};
use serde_json::Value;
use std::fs;

#[test]
fn the_same_drive_gives_the_same_bytes() {
    for (emit, ending, sign) in [
        ("rust", "rs", "pub struct TrivediKeshri660w"),
        ("ir", "ir", "program TrivediKeshri660w"),
        ("datasheet", "md", "# TrivediKeshri660w"),
    ] {
        let arguments = ["generate", PAPER, "--emit", emit];
        let first = run(arguments);
        assert_eq!((first.code, first.stderr.as_str()), (0, ""), "{emit}");
        assert!(first.stdout.contains(sign), "{emit}: {}", first.stdout);
        assert_eq!(run(arguments).stdout, first.stdout, "{emit}");
        assert!(
            !first.stdout.contains(env!("CARGO_MANIFEST_DIR")),
            "{emit} names a folder"
        );

        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path().to_str().expect("a plain path");
        let path = folder.path().join(format!("{PAPER}.{ending}"));
        fs::write(&path, "what was there before").expect("can be written");
        let written = run(arguments.iter().chain(&["--out", out]));
        assert_eq!((written.code, written.stdout.as_str()), (0, ""));
        let text = fs::read_to_string(&path).expect("was written");
        assert_eq!(text.trim_end(), first.stdout.trim_end(), "{emit}");
        assert_eq!(fs::read_dir(folder.path()).expect("is there").count(), 1);
    }
}

#[test]
fn c99_is_a_header_and_a_source_of_the_type() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().to_str().expect("a plain path");
    let arguments = ["generate", PAPER, "--emit", "c99", "--out", out];
    let read = || {
        let said = run(arguments);
        assert_eq!((said.code, said.stdout.as_str()), (0, ""), "{said:?}");
        ["h", "c"].map(|ending| {
            let path = folder.path().join(format!("trivedi_keshri_660w.{ending}"));
            fs::read_to_string(path).expect("was written")
        })
    };
    let [header, source] = read();
    assert!(header.contains("} trivedi_keshri_660w;"), "{header}");
    assert!(
        source.contains("#include \"trivedi_keshri_660w.h\""),
        "{source}"
    );
    assert_eq!(read(), [header, source]);
    // Beside them the runtime, header and source.
    assert_eq!(fs::read_dir(folder.path()).expect("is there").count(), 4);
}

#[test]
fn a_copy_of_a_file_elsewhere_gives_the_same_code() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("copy.toml");
    let library = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../motors/trivedi-keshri-660w.toml"
    );
    fs::copy(library, &path).expect("can be copied");
    let copy = run(["generate", path.to_str().expect("a plain path")]);
    assert_eq!(copy.stdout, run(["generate", PAPER]).stdout);
    assert_eq!(copy.code, 0);
}

#[test]
fn a_variant_changes_the_code() {
    let own = run(["generate", PAPER]).stdout;
    let other = run([
        "generate",
        PAPER,
        "--controller",
        "pdcc:reference=quasi_square",
    ])
    .stdout;
    assert!(own.contains("interpolate_angle") && !other.contains("interpolate_angle"));
}

#[test]
fn the_library_is_listed() {
    let file = run(["motors", "hoverboard-hub"]);
    assert!(
        file.stdout.starts_with("board = \"hoverboard\"\n"),
        "{file:?}"
    );
    let motors = LIBRARY_AS_JSON["motors"].as_array().expect("a list");
    assert_eq!(keys(&LIBRARY_AS_JSON), ["motors"]);
    assert!(motors.len() >= 12);
    let paper = motors
        .iter()
        .find(|motor| motor["name"] == PAPER)
        .expect("is there");
    assert_eq!(number(paper, "pole_pairs"), 4.0);
    assert_eq!(number(paper, "v_bus_v"), 48.0);
    assert_eq!(number(paper, "emf_constant_v_s"), 0.0824);
    assert_eq!(paper["generates"], true);
    assert_eq!(paper["is_right"], true);
    assert_eq!(paper["starts"], serde_json::json!([12, 12]));
    assert!((number(paper, "envelope_torque_nm") / 3.63 - 1.0).abs() < 0.01);
    assert!((number(paper, "sampled_ripple_pct") - 3.0).abs() < 0.1);
    let simulated = ["simulate", PAPER, "--controller", "pdcc", "--rpm", "2000"];
    let alone = run(simulated
        .iter()
        .chain(&["--start-angle", "0.1rad", "--json"]))
    .json();
    let points = |motor: &Value| motor["points"].as_array().expect("a list").clone();
    let rated = points(paper).pop().expect("points");
    assert_eq!(number(&rated, "speed_pct"), 100.0);
    let (percent, torque) = (
        number(&rated, "torque_pct"),
        number(&alone, "mean_torque_nm"),
    );
    assert!(
        (percent / 100.0 * 3.3 / torque - 1.0).abs() < 1e-4,
        "{percent} % {torque} Nm"
    );
    assert_eq!(LIBRARY.code, 0, "{LIBRARY:?}");
    let table = &LIBRARY.stdout;
    for motor in motors {
        let most = if number(motor, "degrees_per_period") <= 8.0 {
            3.0
        } else {
            7.0
        };
        // More than the demanded torque is wrong, too; a drive that trips has no torque.
        let is_right = |point: &Value| {
            let within = |torque: f64| (torque - 100.0).abs() <= 1.0;
            let ripples = |ripple: f64| ripple <= most;
            point["torque_pct"].as_f64().is_some_and(within)
                && point["ripple_pct"].as_f64().is_some_and(ripples)
        };
        let all = points(motor);
        assert_eq!(all.len(), 4, "{motor}");
        assert_eq!(
            motor["is_right"] == true,
            all.iter().all(is_right),
            "{motor}"
        );
        assert_eq!(
            motor["limit"].is_null(),
            motor["is_right"] == true,
            "{motor}"
        );
        let name = motor["name"].as_str().expect("a name");
        let row = table
            .lines()
            .find(|row| row.starts_with(&format!("| {name} ")));
        let row = row.unwrap_or_else(|| panic!("no {name} in\n{table}"));
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let torques = all.iter().filter_map(|point| point["torque_pct"].as_f64());
        let least = torques.fold(f64::INFINITY, f64::min);
        let limit = match motor["limit"].as_str() {
            None => "-",
            Some("bus_voltage") => "bus voltage",
            Some("control_period") => "control period",
            Some(other) => other,
        };
        assert_eq!(
            [cells[6], cells[8]],
            [&format!("{least:.1}"), limit],
            "{row}"
        );
        assert_eq!(
            run(["generate", name]).code == 0,
            motor["generates"] == true,
            "{name}"
        );
    }
}

#[test]
fn a_warning_goes_to_stderr_and_the_drive_is_generated() {
    let variant = ["--controller", "phcc:table=printed"];
    for command in ["generate", "verify"] {
        let run = run([command, PAPER].iter().chain(&variant));
        assert_eq!(run.code, 0, "{command}: {}", run.stderr);
        assert!(
            run.stderr.contains(
                "argument `phcc:table=printed`, character 12: warning[HX0601]: `table`: "
            ) && run.stderr.contains("use `derived`"),
            "{command}: {}",
            run.stderr
        );
        assert!(!run.stdout.contains("HX0601"), "{command}");
    }
}
