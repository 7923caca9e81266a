//! What a terminal shows: few lines of at most 100 columns, and the verdict in colour.

use crate::newcomer::assert_lines;
use crate::support::{LIBRARY, PAPER, Said, hexagen, run};
use hexagen_codegen::diagnostics::Code;
use std::fs;

/// A drive with every block that is optional, of which several are worth a warning.
const CROWDED: &str = r#"
[motor]
pole_pairs = 15
resistance = "0.4 ohm terminal"
inductance = "0.6 mH terminal"
speed_constant = "16 rpm/V peak"
torque_constant = "0.49 Nm/A per_peak_ampere"
emf_shape = "sinusoidal"
rated_current = "10 A peak"
rated_torque = "5.17 Nm"
rated_speed = "450 rpm"
inertia = "24 kg m2"
[inverter]
bus_voltage = "36 V"
v_bus = "measured"
bus_adc_bits = 12
bus_adc_range = "60 V"
bus_min = "30 V"
bus_max = "45 V"
braking_fade = "2 V"
motoring_fade = "2 V"
bus_current_limit = "5 A"
return_current_limit = "4 A"
f_pwm = "5 kHz"
timer_clock = "64 MHz"
adc_bits = 12
adc_range = "400 A"
current_sensing = "low_side"
settling_time = "1 us"
aperture_time = "200 ns"
conversion_time = "1 us"
dead_time = "750 ns"
max_current = "15 A"
trip_current = "390 A"
maximum_speed = "900 rpm"
hall_timer_clock = "1 MHz"
bus_clamp = "45 V"
[controller]
kind = "pdcc"
speed_loop = "on"
field_weakening = "on"
hall_learning = "on"
emf = "observer"
residual_timeout = "20 ms"
target = "cortex_m4"
core_clock = "64 MHz"
"#;

/// Changes of the crowded file, by lines.
const CHANGES: [&[(&str, &str)]; 4] = [
    &[],
    &[
        ("field_weakening = \"on\"", "torque_learning = \"on\""),
        ("f_pwm = \"5 kHz\"", "f_pwm = \"4 kHz\""),
    ],
    // The Hall edges of this one are sampled, and it does not hold its rating.
    &[
        ("field_weakening = \"on\"", ""),
        ("hall_learning = \"on\"", ""),
        ("hall_timer_clock = \"1 MHz\"", ""),
        ("f_pwm = \"5 kHz\"", "f_pwm = \"3 kHz\""),
    ],
    &[
        ("hall_timer_clock = \"1 MHz\"", ""),
        ("hall_learning = \"on\"", ""),
        (
            "pole_pairs = 15",
            "pole_pairs = 15\nrotor = \"angle\"\nangle_bits = 14\nangle_pole_pairs = 15",
        ),
        ("bus_current_limit = \"5 A\"", ""),
        ("return_current_limit = \"4 A\"", ""),
    ],
];

fn crowded(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(CROWDED.to_owned(), |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replace(old, new)
    })
}

#[test]
fn a_crowded_file_is_checked_in_as_few_lines() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (place, changes) in CHANGES.iter().enumerate() {
        let file = folder.path().join(format!("crowded{place}.toml"));
        let text = crowded(changes);
        fs::write(&file, &text).expect("is written");
        let file = file.to_str().expect("a path");
        let said = run(["check", file]);
        assert!(said.code <= 1, "{said:?}");
        assert!(said.stderr.contains("warning[HX0618]"), "{said:?}");
        // Of the bus current, and the voltages of a measured bus.
        let has_limits = text.contains("bus_current_limit") || text.contains("measured");
        assert_lines(&said, 10);
        assert_eq!(said.stdout.contains("\nlimits "), has_limits, "{said:?}");
        for row in ["motor ", "step ", "torque "] {
            assert!(said.stdout.contains(&format!("\n{row}")), "{row}: {said:?}");
        }
        // Nothing is lost.
        let whole = run(["check", file, "--all"]);
        assert!(whole.stdout.contains("\nnext "), "{whole:?}");
        let lines = |said: &Said| said.stdout.lines().count();
        assert!(lines(&whole) > lines(&said), "{whole:?}");
        assert_lines(&whole, 20);
        let words: Vec<&str> = whole.stdout.split_whitespace().collect();
        assert!(words.join(" ").contains("; there on "), "{whole:?}");
    }
}

#[test]
fn a_crowded_file_is_reported_in_as_few_lines() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("crowded.toml");
    fs::write(&file, crowded(CHANGES[1])).expect("is written");
    let arguments = ["report", "crowded.toml", "--out", "page"];
    let output = hexagen()
        .args(arguments)
        .current_dir(folder.path())
        .output();
    let said = Said::from(output.expect("the program starts"));
    assert_eq!(said.code, 0, "{said:?}");
    assert_lines(&said, 12);
    for row in ["limits ", "step ", "furthest ", "page "] {
        assert!(said.stdout.contains(&format!("\n{row}")), "{row}: {said:?}");
    }
}

/// What commands print of the motor of the paper and of one with deviations.
#[test]
fn no_command_prints_a_line_of_more_than_a_hundred_columns() {
    let speed = [
        "--controller",
        "pdcc:speed_loop=on",
        "--speed-set",
        "1500rpm",
    ];
    let shaft = ["--inertia", "7.06e-6kgm2", "--load-step", "0.01Nm"];
    let set = [&["simulate", "hurst-long"][..], &speed, &shaft].concat();
    let one = [
        "compare",
        PAPER,
        "--controller",
        "pdcc",
        "--start-angle",
        "0.1rad",
    ];
    let robust = [&one[..], &["--robustness"]].concat();
    let variant = "pdcc:advance=2,hall_capture=timer,reference=quasi_square,emf=observer";
    let long = ["simulate", PAPER, "--controller", variant, "--rpm", "2900"];
    let verified = ["verify", PAPER, "hoverboard-hub", "--controller", "all"];
    let verified = [&verified[..], &["--steps", "1000"]].concat();
    let commands: [&[&str]; 18] = [
        &["simulate", PAPER, "--rpm", "1500"],
        &long,
        &set,
        &["limit", PAPER],
        &["limit", "hoverboard-hub", "--torque", "5Nm"],
        &["faults", PAPER],
        &["advise", "br2804-1700kv"],
        &["compare", "odrive-d6374-150kv", "--start-angle", "0.1rad"],
        &["compare"],
        &one,
        &robust,
        &["check", PAPER, "--reasons"],
        &["motors", "--all"],
        &["boards"],
        &["verify", PAPER, "--steps", "1000"],
        &verified,
        &["advise", "hoverboard-hub"],
        &["explain"],
    ];
    for arguments in commands {
        let said = run(arguments);
        assert!(said.code <= 1, "{arguments:?} {said:?}");
        assert_columns(&said, &arguments.join(" "));
    }
    assert_columns(&LIBRARY, "motors");
}

#[track_caller]
fn assert_columns(said: &Said, of: &str) {
    assert!(!said.stdout.is_empty(), "{of}: {said:?}");
    for line in said.stdout.lines() {
        assert!(line.chars().count() <= 100, "{of}: {line}");
    }
}

#[test]
fn every_explanation_keeps_to_a_hundred_columns() {
    for code in Code::ALL {
        let code = code.to_string();
        assert_columns(&run(["explain", &code]), &code);
    }
}

#[test]
fn the_verdict_is_coloured_on_a_terminal() {
    let shown = |arguments: &[&str], variable: &str| {
        let mut program = hexagen();
        for variable in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
            program.env_remove(variable);
        }
        let output = program.args(arguments).env(variable, "1").output();
        Said::from(output.expect("the program starts")).stdout
    };
    let (green, yellow, amber) = ("\u{1b}[1;32m", "\u{1b}[1;33m", "\u{1b}[48;5;230m");
    for (arguments, coloured) in [
        (
            &["check", PAPER][..],
            format!("{PAPER}: {green}works\u{1b}[0m: "),
        ),
        (
            &["check", "br2804-1700kv"],
            format!("br2804-1700kv: {yellow}works, but\u{1b}[0m "),
        ),
    ] {
        let forced = shown(arguments, "CLICOLOR_FORCE");
        assert!(forced.contains(&coloured), "{coloured:?} in {forced:?}");
        for variable in ["CLICOLOR", "NO_COLOR"] {
            let plain = shown(arguments, variable);
            assert!(!plain.contains('\u{1b}'), "{variable}: {plain:?}");
        }
    }
    assert!(shown(&["motors"], "CLICOLOR_FORCE").contains(amber));
    assert!(!LIBRARY.stdout.contains('\u{1b}'), "{}", LIBRARY.stdout);
}

/// Answers of somebody with a data sheet, some of them wrong; a line each.
#[cfg(target_os = "linux")]
const ANSWERS: &str = include_str!("../answers.txt");

/// The questions of `new` on a terminal of its own, which `script` makes.
#[cfg(target_os = "linux")]
#[test]
fn the_questions_of_a_new_file_lead_to_a_drive_that_works() {
    use std::io::Write;
    use std::process::{Command, Stdio};
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = format!("'{}' new db42.toml", env!("CARGO_BIN_EXE_hexagen"));
    let mut asked = Command::new("script")
        .args(["-qec", &program, "/dev/null"])
        .current_dir(folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("`script` of util-linux makes the terminal");
    let mut answers = asked.stdin.take().expect("a pipe");
    answers.write_all(ANSWERS.as_bytes()).expect("is read");
    let shown = asked.wait_with_output().expect("the program ends");
    let shown = String::from_utf8_lossy(&shown.stdout).into_owned();
    // Of a resistance without basis, an inductance a thousandfold off and an unknown shape.
    let again = shown
        .matches("Answer again; empty to fill it in later.")
        .count();
    assert_eq!(again, 3, "{shown}");
    assert!(
        shown.contains("db42.toml is written; next: hexagen check db42.toml"),
        "{shown}"
    );
    let text = fs::read_to_string(folder.path().join("db42.toml")).expect("is written");
    assert!(
        text.contains("\nresistance = \"0.56 ohm terminal\"\n"),
        "{text}"
    );
    let file = folder.path().join("db42.toml");
    let said = run(["check", file.to_str().expect("a path")]);
    assert_eq!(said.code, 0, "{said:?}");
    assert!(said.stdout.starts_with("db42: works"), "{said:?}");
}
