//! Wrong input: code 2, nothing on stdout, and a message that says what and where.

use crate::support::{PAPER, keys, run};
use serde_json::Value;
use std::fs;

/// A motor whose file says its inertia, and a drive that regulates its speed.
const WITH_INERTIA: &str = "hurst-long";
const REGULATED: &str = "pdcc:speed_loop=on";

#[test]
fn an_unknown_motor_is_told_with_the_nearest_name() {
    run(["simulate", "trivedi-keshri", "--rpm", "1"]).assert_bad_input(&[
        "error: no motor `trivedi-keshri`",
        "did you mean `trivedi-keshri-660w`?",
    ]);
    run(["check", "teknic"]).assert_bad_input(&["did you mean `teknic-m2310p`?"]);
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("hub.toml"), cli_text()).expect("is written");
    let given = folder.path().join("hub");
    let given = given.to_str().expect("a path");
    let meant = format!("(there is none) nor a motor of the library; did you mean `{given}.toml`?");
    run(["verify", given]).assert_bad_input(&[&meant]);
    run(["verify", "nothing/like/it.toml"]).assert_bad_input(&["no motor `nothing/like/it.toml`"]);
}

#[test]
fn a_bad_variant_is_told_with_its_column() {
    for (variant, texts) in [
        (
            "pdcc:modulation=bogus",
            [
                "argument `pdcc:modulation=bogus`, character 17: error[HX0207]",
                "bogus",
            ],
        ),
        (
            "pdcc:colour=red",
            [
                "argument `pdcc:colour=red`, character 6: error[HX",
                "colour",
            ],
        ),
        (
            "pdcc:f_pwm=20kHz",
            [
                "argument `pdcc:f_pwm=20kHz`, character 6: error[HX0107]",
                "`f_pwm` is a field of `inverter`, not an option of the controller",
            ],
        ),
        (
            "pdcc:advance",
            ["argument `pdcc:advance`, character 6: error[HX", "advance"],
        ),
        (
            "pdcc:advance=9",
            ["argument `pdcc:advance=9`, character 14: error[HX", "9"],
        ),
        ("nonsense", ["argument `nonsense`: error[HX", "nonsense"]),
    ] {
        for command in ["simulate", "limit", "generate", "verify", "compare"] {
            let mut arguments = vec![command, PAPER, "--controller", variant];
            if command == "simulate" {
                arguments.extend(["--rpm", "100"]);
            }
            run(&arguments).assert_bad_input(&texts);
        }
    }
}

#[test]
fn errors_in_a_file_are_told_with_file_line_and_column() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.toml");
    let text = cli_text();
    let path_text = path.to_str().expect("a plain path");
    let check = |text: &str, expected: &[&str]| {
        fs::write(&path, text).expect("can be written");
        run(["generate", path_text]).assert_bad_input(expected);
    };
    let at = |needle: &str| {
        text.lines()
            .position(|line| line.starts_with(needle))
            .expect("is there")
            + 1
    };
    let line = at("resistance");
    let place = format!("{path_text}:{line}:14: error[HX");
    check(
        &text.replace("0.135 ohm per_phase", "0.135 V per_phase"),
        &[&place, "resistance"],
    );
    let place = format!("{path_text}:{line}:");
    check(
        &text.replace("resistance = \"", "resistance = "),
        &[&place, "error[HX"],
    );
    // Several errors come together.
    let broken = text
        .replace("0.22 mH per_phase", "0.22 mH")
        .replace("winding", "windng");
    check(&broken, &["inductance", "windng"]);
    check("", &["error[HX"]);
}

#[test]
fn a_file_that_is_no_text_is_told_with_its_byte() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.toml");
    // "é" of an editor that saves in Latin-1.
    fs::write(&path, b"[motor]\n# caf\xe9\n").expect("can be written");
    let path = path.to_str().expect("a plain path");
    for command in ["generate", "verify", "limit"] {
        let place = format!("{path}:2:6: error[HX0108]");
        run([command, path]).assert_bad_input(&[&place, "not UTF-8: byte 13 is 0xE9"]);
    }
}

/// The paper's motor as text, as a user would copy it.
fn cli_text() -> String {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../motors/trivedi-keshri-660w.toml"
    );
    fs::read_to_string(path).expect("the library is there")
}

#[test]
fn texts_of_several_files_need_a_folder() {
    for emit in ["c99", "gappa"] {
        run(["generate", PAPER, "--emit", emit]).assert_bad_input(&[emit, "--out"]);
    }
}

#[test]
fn options_out_of_range_or_at_odds_are_told() {
    for (arguments, text) in [
        (&["simulate", PAPER][..], "--rpm"),
        (&["simulate", PAPER, "--rpm", "fast"], "not a number"),
        (
            &["simulate", PAPER, "--rpm", "1", "--dead-time", "1V"],
            "is a voltage",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--dead-time", "1s"],
            "dead_time",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--dead-time", "500"],
            "`500` has no unit; write it like `500s` or `500ms`",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--scale-l", "-1"],
            "inductance",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--load", "1Nm"],
            "--inertia",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--load=-1Nm"],
            "give it without a sign",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--adc-bits", "30"],
            "adc_bits",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--adc-range", "1A"],
            "adc_range",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--model", "magic"],
            "magic",
        ),
        (
            &[
                "simulate",
                PAPER,
                "--rpm",
                "1500",
                "--csv",
                "/proc/nowhere/x.csv",
            ],
            "cannot write",
        ),
        (&["simulate", PAPER, "--rpm", "0.001"], "at least"),
        (&["simulate", PAPER, "--rpm", "1e9"], "at most 50000 rpm"),
        (&["simulate", PAPER, "--rpm", "nan"], "not a number"),
        (
            &["simulate", PAPER, "--rpm", "1", "--torque", "1e300Nm"],
            "out of range",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--scale-l", "1e-9"],
            "out of range",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--inertia", "1e-300kgm2"],
            "out of range",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--adc-range", "-4A"],
            "adc_range",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--adc-offset", "1V"],
            "is a voltage",
        ),
        (
            &[
                "simulate",
                PAPER,
                "--rpm",
                "1",
                "--adc-offset",
                "1A,2A,3A,4A",
            ],
            "one value for all sensed phases, or one of each",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--scale-adc", "1,0"],
            "out of range",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--adc-noise", "1A"],
            "is not a number of counts",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--adc-noise", "-1"],
            "--adc-noise: plant: adc noise is -1, but must be from 0 to 4095 counts",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--conversion-time", "-1us"],
            "--conversion-time: plant: adc instant is -1 us, but must be from 0 s",
        ),
        (
            &["faults", PAPER, "--conversion-time", "30us"],
            "--conversion-time: plant: adc instant is 30 us",
        ),
        (
            &["simulate", PAPER, "--rpm", "1", "--adc-offset", "41A"],
            "adc offset",
        ),
        (
            &["compare", PAPER, "--robustness", "--adc-offset", "-41A"],
            "--adc-offset: plant: adc offset",
        ),
        (
            &["compare", PAPER, "--robustness", "--inertia", "1kgm2"],
            "--inertia",
        ),
        (&["compare", PAPER, "--csv", "sheet.csv"], "--robustness"),
        (
            &["compare", PAPER, "--robustness", "--controller", "pdcc:a=1"],
            "argument `pdcc:a=1`, character 6",
        ),
        (&["compare", "unheard-of", "--robustness"], "unheard-of"),
        (&["verify", PAPER, "--steps", "-5"], "--steps"),
        (&["report", PAPER, "--out", "/proc/nowhere"], "cannot write"),
        (
            &["generate", PAPER, "--out", "/proc/nowhere"],
            "cannot write",
        ),
        (
            &["simulate", PAPER, "--rpm", "0", "--speed-set", "900rpm"],
            "`speed_loop=on`",
        ),
        (
            &[
                "simulate",
                WITH_INERTIA,
                "--controller",
                REGULATED,
                "--rpm",
                "0",
                "--speed-set",
                "900rpm",
                "--inertia",
                "50kgm2",
            ],
            "the run-up takes",
        ),
        (&["limit", PAPER, "--torque", "0"], "--torque 0"),
        (&["limit", PAPER, "--inertia", "1kgm2"], "--inertia"),
        (&["verify", PAPER, "--steps", "0"], "--steps"),
        (
            &["verify", PAPER, "--steps", "18446744073709551615"],
            "give a whole number from 1 to 100000000000",
        ),
        (
            &["verify", PAPER, "--steps", "100000000001"],
            "give a whole number from 1 to 100000000000",
        ),
        (&["report", "unheard-of"], "unheard-of"),
    ] {
        run(arguments).assert_bad_input(&[text]);
    }
}

#[test]
fn a_command_line_that_cannot_be_read_is_an_error_in_json_too() {
    let help = run(["--help"]).stdout;
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let commands = commands.take_while(|line| !line.is_empty());
    // Further lines of a description stand further to the right.
    let names = commands.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let names: Vec<_> = names.filter(|name| !["", "help"].contains(name)).collect();
    assert!(names.len() > 15, "{names:?}");
    for name in names {
        let refused = run([name, "--no-such-option", "--json"]);
        assert_eq!(refused.code, 2, "{refused:?}");
        let told = refused.json_whatever_the_code();
        let keys = keys(&told);
        assert_eq!(keys, ["error"], "{name}");
        let text = told["error"].as_str().expect("a text");
        assert!(text.contains("--no-such-option"), "{name}: {text}");
        assert!(refused.stderr.contains("--no-such-option"), "{refused:?}");
    }
    assert_eq!(run(["check", "--json", "--help"]).code, 0);
}

#[test]
fn options_of_the_report_stand_before_no_command() {
    let refused = run(["--json", "check", PAPER]);
    assert_eq!(refused.code, 2, "{refused:?}");
    let told = refused.json_whatever_the_code();
    assert!(
        told["error"]
            .as_str()
            .is_some_and(|text| text.contains("--json"))
    );
    run(["--all", "motors"]).assert_bad_input(&["--all"]);
    let help = run(["--help"]).stdout;
    for option in ["--all", "--json", "--out"] {
        assert!(help.contains(option), "{option}");
    }
}

#[test]
fn emitted_texts_are_data_too() {
    let texts = run(["generate", PAPER, "--emit", "c99", "--json"]).json();
    let files = texts["files"].as_array().expect("files");
    assert_eq!(files.len(), 4);
    let has_text = |file: &Value| file["text"].as_str().is_some_and(|text| text.len() > 1000);
    assert!(files.iter().all(has_text));
}

/// A log of three periods, the last with a count at the end of its range.
fn log_of_three_periods() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("log.csv");
    let rows = "2048,2048,5,100\n2048,2048,5,100\n4095,2048,5,100\n";
    fs::write(&log, format!("adc_1,adc_2,hall,ticks\n{rows}")).expect("is written");
    let path = log.to_str().expect("a path").to_owned();
    (folder, path)
}

#[test]
fn replayed_periods_are_data() {
    let (_folder, log) = log_of_three_periods();
    let replayed = run(["replay", PAPER, "--log", &log, "--json"]).json();
    let periods = replayed["periods"].as_array().expect("periods");
    assert_eq!(periods.len(), 3);
    assert_eq!(replayed["tripped"]["period"], 2);
    let numbers = periods[0].as_object().expect("columns").values();
    assert!(numbers.filter(|value| value.is_number()).count() > 10);
    assert_eq!(
        (periods[1]["period"].as_u64(), &periods[1]["duty_a"]),
        (Some(1), &Value::Null)
    );
}

#[test]
fn a_replay_is_told_in_a_few_lines_unless_all_is_asked_for() {
    let (folder, log) = log_of_three_periods();
    let told = run(["replay", PAPER, "--log", &log]).stdout;
    assert!(
        told.contains(": 3 periods, ") && told.contains("; tripped in period 2, at "),
        "{told}"
    );
    assert!(
        told.contains("| i_a_ampere |") && told.lines().count() < 16,
        "{told}"
    );
    let all = run(["replay", PAPER, "--log", &log, "--all"]);
    assert_eq!(all.stdout.lines().count(), 4, "{}", all.stdout);
    assert!(
        all.stdout.starts_with("period,time_s,mode,fault,duty_a,"),
        "{}",
        all.stdout
    );
    assert!(all.stderr.contains("tripped in period 2"), "{}", all.stderr);
    let csv = folder.path().join("words.csv");
    let csv = csv.to_str().expect("a path");
    let told = run(["replay", PAPER, "--log", &log, "--csv", csv]).stdout;
    assert!(told.contains("tripped in period 2"), "{told}");
    assert_eq!(fs::read_to_string(csv).expect("is written"), all.stdout);
}

#[test]
fn help_and_version_are_no_errors() {
    let help = run(["--help"]);
    assert_eq!((help.code, help.stderr.as_str()), (0, ""));
    for command in [
        "report", "generate", "simulate", "limit", "faults", "replay", "halls", "verify",
        "compare", "motors",
    ] {
        assert!(help.stdout.contains(command), "{command}");
        assert_eq!(run([command, "--help"]).code, 0);
    }
    assert_eq!(run(["--version"]).code, 0);
    for arguments in [
        &["--help"][..],
        &["new", "--help"],
        &["simulate", "--help"],
        &["explain"],
    ] {
        let said = run(arguments);
        let longest = said.stdout.lines().map(|line| line.chars().count()).max();
        assert!(
            longest.is_some_and(|longest| longest <= 100),
            "{longest:?}: {}",
            said.stdout
        );
    }
}

#[test]
fn the_greatest_speed_that_a_message_gives_is_accepted() {
    const BEFORE: &str = "give at most ";
    for motor in [PAPER, "br2804-1700kv"] {
        let refused = run(["simulate", motor, "--rpm", "1e9"]).stderr;
        let (_, most) = refused.split_once(BEFORE).expect("a limit");
        let most = most.split(' ').next().expect("a number");
        let run = run(["simulate", motor, "--rpm", most]);
        assert!(
            !run.stderr.contains(BEFORE),
            "{motor} {most}: {}",
            run.stderr
        );
    }
}
