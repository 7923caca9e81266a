//! From a data sheet to a checked drive: `new`, `check`, `explain`, `completions`.

use crate::support::{LIBRARY_AS_JSON, PAPER, Said, hexagen, number, run};
use hexagen_lab::engine::MotorSource;
use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Maxon's EC 45 flat of 70 W on a board of 8 A, as its catalogue words it.
const EC_45: [&str; 15] = [
    "pole_pairs=8",
    "resistance=0.573 ohm phase to phase",
    "inductance=0.301 mH phase to phase",
    "torque_constant=40.4 mNm/A block_mean",
    "emf_shape=sine",
    "rated_current=3.29 A peak",
    "rated_torque=134 mNm",
    "rated_speed=4750 rpm",
    "no_load_speed=5600 rpm",
    "inertia=181 gcm2",
    "bus_voltage=24 V",
    "timer_clock=170 MHz",
    "adc_range=8 A",
    "current_sensing=in_phase",
    "dead_time=500 ns",
];

/// Teknic's Hudson M-2311P on 48 V.
const HUDSON: [&str; 12] = [
    "poles=8",
    "resistance=0.69 ohms phase-to-phase",
    "inductance=0.733 mH phase-to-phase",
    "back_emf=6.64 Vpeak/kRPM line-to-line",
    "emf_shape=sine",
    "rated_current=7.1 A peak",
    "rated_torque=60 oz-in",
    "rated_speed=3000 RPM",
    "bus_voltage=48 V",
    "timer_clock=72 MHz",
    "adc_range=20 A",
    "current_sensing=in_phase",
];

/// A hub motor of a balancing board, by its kV rating, on 36 V.
const HUB: [&str; 11] = [
    "poles=30",
    "resistance=0.4 ohm terminal",
    "inductance=0.6 mH terminal",
    "speed_constant=16 rpm/V peak",
    "emf_shape=sinusoidal",
    "rated_current=10 A peak",
    "rated_speed=400 rpm",
    "bus_voltage=36 V",
    "timer_clock=72 MHz",
    "adc_range=30 A",
    "current_sensing=in_phase",
];

#[test]
fn a_new_file_of_a_data_sheet_is_checked_in_ten_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, values) in [("ec45", &EC_45[..]), ("hudson", &HUDSON), ("hub", &HUB)] {
        let path = folder.path().join(format!("motors/{name}.toml"));
        let path = path.to_str().expect("a plain path");
        let made = run(["new", path].iter().chain(values));
        assert_eq!((made.code, made.stderr.as_str()), (0, ""), "{made:?}");
        assert!(made.stdout.contains("next: hexagen check"), "{made:?}");
        let text = fs::read_to_string(path).expect("is there");
        assert!(
            text.contains("# Speed under load at rated torque.\nrated_speed = "),
            "{text}"
        );

        let begin = Instant::now();
        let said = run(["check", path]);
        let took = begin.elapsed();
        assert_eq!(said.code, 0, "{said:?}");
        assert!(
            said.stdout.starts_with(&format!("{name}: works")),
            "{said:?}"
        );
        assert_short(&said);
        // A second of a machine that does nothing else, optimised.
        assert!(took < Duration::from_secs(30), "{took:?}");
        let json = run(["check", path, "--json"]).json();
        assert_eq!(json["works"], true);
        // At rated speed the bus of some has no room for commutations.
        let slow = &json["points"][0];
        assert!(number(slow, "torque_pct") > 97.0, "{slow}");
    }
}

/// A Maxon motor on a board of three shunts, of which the inverter's fields are.
#[test]
fn a_new_file_on_a_board_leaves_out_what_the_board_states() {
    const OF_BOARD: [&str; 4] = ["timer_clock", "adc_range", "current_sensing", "dead_time"];
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("flat.toml");
    let path = path.to_str().expect("a path");
    let is_own = |value: &&str| !OF_BOARD.iter().any(|name| value.starts_with(name));
    let values = EC_45.into_iter().filter(is_own);
    let arguments: Vec<&str> = ["new", path, "board=st-b-g431b-esc1"]
        .into_iter()
        .chain(values)
        .collect();
    let said = run(&arguments);
    assert_eq!(said.code, 0, "{said:?}");
    assert!(said.stdout.contains("next: hexagen check"), "{said:?}");
    let text = fs::read_to_string(path).expect("is there");
    assert!(text.contains("\nboard = \"st-b-g431b-esc1\"\n"), "{text}");
    for field in OF_BOARD {
        assert!(!text.contains(&format!("\n{field}")), "{field}: {text}");
    }
    assert!(!text.contains("\nhall_timer_clock"), "{text}");
    assert!(text.contains("\n# amplifier_gain = "), "{text}");
    let (_, controller) = text.split_once("[controller]\n").expect("a section");
    assert!(controller.contains("\n# core_clock = "), "{text}");
    let said = run(["check", path]);
    assert!(said.stdout.contains("29.37 mA a count"), "{said:?}");
    let other = folder.path().join("other.toml");
    let other = other.to_str().expect("a path");
    run(["new", other, "board=esc1", "poles=8"]).assert_bad_input(&["esc1", "st-b-g431b-esc1"]);
    assert!(!std::path::Path::new(other).exists());
}

#[test]
fn the_best_controller_of_a_motor_is_recommended_with_the_reason() {
    let said = run(["advise", "linix-45zwn24-40"]);
    assert_eq!(said.code, 0, "{said:?}");
    for text in [
        "recommended",
        "with deviations",
        // Of phcc and the like.
        "Held for a control period, one vector changes a current by up to",
        "Why: 16 of 17",
        "more than the fewest",
    ] {
        assert!(said.stdout.contains(text), "{text}: {said:?}");
    }
    let without_integral = "p-pwm has no integral: its current stays below the reference";
    assert!(said.stdout.contains(without_integral), "{said:?}");
    let board = ["--board", "st-b-g431b-esc1", "--json"];
    let advice = run(["advise", "teknic-m2310p"].iter().chain(&board)).json();
    let place = advice["recommended"].as_u64().expect("a place") as usize;
    assert!(advice["tried"][place]["why_not"].is_null(), "{advice}");
    let refused = advice["tried"].as_array().expect("a list").iter();
    let refused = refused.filter(|tried| tried["refused"].is_string());
    let codes = refused.map(|tried| {
        let code = tried["refused_by"].as_str().expect("a code");
        assert_eq!(tried["why_not"], format!("not as the file stands: {code}"));
        assert!(
            tried["refused"]
                .as_str()
                .is_some_and(|text| text.contains(code))
        );
    });
    assert!(codes.count() > 0, "{advice}");
    let told = run(["advise", "teknic-m2310p"].iter().chain(&board[..2])).stdout;
    assert!(told.contains("\nNot as the file stands (HX04"), "{told}");
    assert!(!told.contains("error["), "{told}");
    run(["advise", "no-motor"]).assert_bad_input(&["no-motor"]);
    run(["advise", "teknic-m2310p", "--board", "esc1"]).assert_bad_input(&["esc1"]);
}

/// A step of the default drive takes two of three PWM periods of such a core, and what fits one ripples.
#[test]
fn a_slow_core_is_given_the_time_for_a_good_drive() {
    let motors = concat!(env!("CARGO_MANIFEST_DIR"), "/../motors/teknic-m2310p.toml");
    let text = fs::read_to_string(motors).expect("is in the library");
    let core = "[controller]\ntarget = \"cortex_m0\"\ncore_clock = \"48 MHz\"\n";
    let text = text.replacen("[controller]\n", core, 1);
    let advice = on_file("advise", &text, &["--json"]).json();
    assert_eq!(advice["pwm_per_control"], 3, "{advice}");
    let place = advice["recommended"].as_u64().expect("a place") as usize;
    let runs = advice["tried"][place]["nominal"].as_array().expect("runs");
    for run in runs {
        let ripple = run["ripple_pct"].as_f64().expect("a ripple");
        assert!(ripple < 3.0, "{run}");
    }
    let other = text.replace("\"pdcc\"", "\"pi-pwm\"");
    assert_ne!(other, text);
    let advice = on_file("advise", &other, &["--json"]).json();
    assert_eq!(advice["pwm_per_control"], 3, "{advice}");
    let told = on_file("advise", &text, &[]).stdout;
    let lines = "\nIn the motor file:\n  [inverter]\n  pwm_per_control = 3\n";
    assert!(told.contains(lines), "{told}");
}

/// The recommended drive ripples as `check` says of it.
#[test]
fn advice_tells_of_ripple_what_check_tells() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("sampled.toml");
    fs::write(&file, SAMPLED).expect("is written");
    let file = file.to_str().expect("a path");
    let advice = run(["advise", file, "--json"]).json();
    let ripples = advice["ripples"].as_str().expect("it ripples");
    let place = advice["recommended"].as_u64().expect("a place") as usize;
    let variant = advice["tried"][place]["variant"].as_str().expect("a name");
    let checked = run(["check", file, "--controller", variant, "--json"]).json();
    let verdict = checked["verdict"].as_str().expect("a verdict");
    assert!(verdict.contains(ripples), "{ripples}: {verdict}");
    let told = run(["advise", file]).stdout;
    let told = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.contains(ripples), "{told}");
}

/// A motor of little inductance whose Hall edges no timer captures.
const SAMPLED: &str = r#"
[motor]
pole_pairs = 7
resistance = "0.1 ohm terminal"
inductance = "0.05 mH terminal"
speed_constant = "400 rpm/V block_mean"
emf_shape = "sinusoidal"
rated_current = "10 A peak"
rated_speed = "3000 rpm"
[inverter]
bus_voltage = "14 V"
f_pwm = "20 kHz"
timer_clock = "72 MHz"
adc_bits = 12
adc_range = "40 A"
current_sensing = "in_phase"
[controller]
kind = "pdcc"
"#;

#[test]
fn usage_of_a_run_names_both_ways_to_say_its_speed() {
    let usage = "Usage: hexagen simulate [OPTIONS] --rpm <RPM> <MOTOR>\n       hexagen simulate [OPTIONS] --speed-set <SPEED> <MOTOR>\n";
    for arguments in [
        &["simulate", "--help"][..],
        &["simulate", PAPER, "--torque", "1Nm"],
    ] {
        let said = run(arguments);
        let told = said.stdout + &said.stderr;
        assert_eq!(told.matches(usage).count(), 1, "{told}");
    }
}

#[track_caller]
fn assert_short(said: &Said) {
    assert_lines(said, 10);
}

#[track_caller]
pub fn assert_lines(said: &Said, most: usize) {
    let lines: Vec<&str> = said.stdout.lines().collect();
    assert!(lines.len() <= most, "{}", said.stdout);
    for line in lines {
        assert!(line.chars().count() <= 100, "{line}");
    }
}

#[test]
fn every_motor_of_the_library_is_checked() {
    for motor in LIBRARY_AS_JSON["motors"].as_array().expect("motors") {
        let name = motor["name"].as_str().expect("a name");
        let said = run(["check", name]);
        if motor["generates"] == true {
            assert!(said.code <= 1, "{said:?}");
            assert!(said.stdout.starts_with(&format!("{name}: ")), "{said:?}");
            assert_short(&said);
            assert_eq!(said.code == 0, said.stdout.contains(": works"), "{said:?}");
        } else {
            said.assert_bad_input(&["error[HX"]);
        }
    }
}

/// A flat motor of 45 mm with an encoder on a board of three shunts.
const FLAT_45: &str = r#"[motor]
name = "Flat45"
description = "flat motor of 45 mm"
poles = 16
resistance = "0.608 ohm terminal"
inductance = "0.463 mH terminal"
torque_constant = "36.9 mNm/A block_mean"
emf_shape = "sine"
rated_current = "3.21 A peak"
rated_torque = "128 mNm"
rated_speed = "4860 rpm"
inertia = "181 g cm2"
rotor = "angle"
angle_pole_pairs = 8
[inverter]
bus_voltage = "24 V"
f_pwm = "20 kHz"
timer_clock = "170 MHz"
adc_bits = 12
adc_range = "15 A"
current_sensing = "low_side"
sensed_phases = "abc"
settling_time = "1 us"
aperture_time = "200 ns"
conversion_time = "500 ns"
[controller]
kind = "pdcc"
"#;

/// No data sheet tells how the encoder sits on the shaft; 128 mNm are more than a sine makes that heats as the sheet's
/// block current does.
#[test]
fn what_nobody_measured_is_told_and_why_the_current_is_limited() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("flat.toml");
    let mut text = FLAT_45.to_owned();
    fs::write(&path, &text).expect("can be written");
    let path = path.to_str().expect("a path");
    let said = run(["check", path]);
    let note = "assumed, so measure: `angle_offset` 0 deg, `angle_direction` forward, `adc_inverted` off\n";
    assert!(said.stderr.contains(note), "{said:?}");
    let but = "works, but `max_current` allows 124 mNm of the rated 128 mNm only";
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words(&said.stdout).contains(but), "{said:?}");
    // 36.9 mNm/A times 3.21 A, and that times 1.5 pi/(3 sqrt(3)).
    let stated = "`rated_torque` 128 mNm is taken as stated; the rated 3.21 A makes 118.4 mNm as a block, in the mean (36.9 mNm/A), and 107.4 mNm as the peak of a sine (33.46 mNm/A)\n";
    assert!(said.stderr.contains(stated), "{said:?}");
    let motor = "; 33.46 mNm/A of a sine; 181 g cm2 controller";
    assert!(words(&said.stdout).contains(motor), "{said:?}");
    let heat = "heats no more than a block of the rated 3.21 A";
    assert!(words(&said.stdout).contains(heat), "{said:?}");
    text = text.replace(
        "angle_pole_pairs = 8\n",
        "angle_pole_pairs = 8\nangle_offset = \"12 deg\"\n",
    );
    let stated = "max_current = \"4 A\"\nadc_inverted = \"off\"\n[controller]";
    text = text.replace("[controller]", stated);
    fs::write(path, text).expect("can be written");
    let said = run(["check", path]);
    let note = "assumed, so measure: `angle_direction` forward\n";
    assert!(said.stderr.contains(note), "{said:?}");
    let heat = "heats more than a block of the rated 3.21 A";
    assert!(words(&said.stdout).contains(heat), "{said:?}");
}

/// A rated torque that is the rated current's as a sine, or as a block, needs no word.
#[test]
fn a_rated_torque_of_the_rated_current_is_not_noted() {
    for motor in ["teknic-m2310p", PAPER] {
        let said = run(["check", motor]);
        assert!(!said.stderr.contains("is taken as stated"), "{said:?}");
    }
    let said = run(["check", PAPER]);
    assert!(
        said.stdout.contains("; 164.8 mNm/A of a block\n"),
        "{said:?}"
    );
}

/// A speed loop leaves room for the ripple of a PWM period and the trip level, by which sensors and inductors are chosen.
#[test]
fn ten_lines_of_a_drive_with_a_speed_loop_tell_ripple_and_trip_level() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("flat.toml");
    let text = FLAT_45.replace("kind = \"pdcc\"", "kind = \"pdcc\"\nspeed_loop = \"on\"");
    fs::write(&path, text).expect("can be written");
    let flat = path.to_str().expect("a path");
    let variant = "pdcc:speed_loop=on";
    for arguments in [
        &["check", flat][..],
        &["check", "hurst-long", "--controller", variant],
        &["check", PAPER, "--controller", "pdcc:hall_capture=sampled"],
    ] {
        let said = run(arguments);
        assert_short(&said);
        for text in ["; PWM ripple to ", "; trips at "] {
            assert!(said.stdout.contains(text), "{text}: {said:?}");
        }
    }
}

#[test]
fn check_runs_a_drive_at_another_speed() {
    let at = |rpm: &str| run(["check", PAPER, "--rpm", rpm]);
    for (asked, told) in [
        ("1200", "; at 1200 rpm 100 %,"),
        ("125.66rad/s", "; at 1200 rpm 100.0 %,"),
    ] {
        let said = at(asked);
        assert_eq!(said.code, 0, "{said:?}");
        assert_short(&said);
        let words = said.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(told), "{said:?}");
    }
    let json = run(["check", PAPER, "--rpm", "1200", "--json"]).json();
    assert!(number(&json["asked"], "torque_pct") > 97.0, "{json}");
    assert!(run(["check", PAPER, "--json"]).json()["asked"].is_null());
    at("90000").assert_bad_input(&["--rpm 90000: beyond maximum_speed = "]);
    at("1").assert_bad_input(&["--rpm 1: slower than", "`hexagen simulate`"]);
    at("1200Nm").assert_bad_input(&["--rpm", "a speed"]);
}

/// A board of three shunts.
#[test]
fn a_motor_is_checked_on_a_board() {
    let said = run(["check", "teknic-m2310p", "--board", "st-b-g431b-esc1"]);
    assert_eq!(said.code, 0, "{said:?}");
    let assumed = "assumed, so measure: `rated_speed` 4000 rpm, `settling_time` 800 ns\n";
    assert!(said.stderr.ends_with(assumed), "{said:?}");
    assert!(said.stdout.contains("29.37 mA a count"), "{said:?}");
    let next = "hexagen report teknic-m2310p --board st-b-g431b-esc1";
    let whole = run([
        "check",
        "teknic-m2310p",
        "--board",
        "st-b-g431b-esc1",
        "--all",
    ]);
    assert!(whole.stdout.contains(next), "{whole:?}");
    run(["check", "teknic-m2310p", "--board", "esc1"]).assert_bad_input(&["esc1"]);
}

#[test]
fn check_tells_the_limits_of_the_bus_current() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("limited.toml");
    let motor = MotorSource::of_library("hoverboard-hub").expect("is in the library");
    let limits = "[inverter]\nbus_current_limit = \"5 A\"\nreturn_current_limit = \"1 A\"\n";
    let text = motor.text.replace("[inverter]\n", limits);
    fs::write(&file, text).expect("is written");
    let said = run(["check", file.to_str().expect("a path")]);
    // The limits have a line of their own.
    assert_lines(&said, 11);
    for text in [
        "the limit of the bus current leaves 75.",
        "limits      at most 5 A drawn from the bus, 1 A returned to it",
    ] {
        assert!(said.stdout.contains(text), "{text}: {}", said.stdout);
    }
}

/// A motor of the library in a file, with more lines under `[inverter]`.
fn with_inverter(folder: &std::path::Path, lines: &str) -> String {
    let motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
    let kept = motor
        .text
        .lines()
        .filter(|line| !line.starts_with("max_current"));
    let kept: String = kept.map(|line| line.to_owned() + "\n").collect();
    let text = kept.replace("[inverter]\n", &format!("[inverter]\n{lines}"));
    let file = folder.join("changed.toml");
    fs::write(&file, text).expect("is written");
    file.to_str().expect("a path").to_owned()
}

/// A motor whose rotor turns 23 electrical degrees in a control period, with Hall edges that are sampled.
const COARSE: &str = r#"
[motor]
pole_pairs = 12
resistance = "135 mohm per_phase"
inductance = "0.22 mH per_phase"
winding = "star"
back_emf = "0.4 V/(rad/s) line_to_line peak"
emf_shape = "trapezoidal"
rated_current = "20 A peak"
rated_speed = "800 rpm"
[inverter]
bus_voltage = "48 V"
f_pwm = "2.5 kHz"
timer_clock = "72 MHz"
adc_bits = 12
adc_range = "40 A"
current_sensing = "in_phase"
[controller]
kind = "pdcc"
"#;

/// The remedy of a coarse period is one: with the frequency that is named the drive works.
#[test]
fn check_names_the_frequency_that_makes_the_period_short_enough() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let verdict_at = |f_pwm: &str| {
        let file = folder.path().join("coarse.toml");
        fs::write(&file, COARSE.replace("2.5 kHz", f_pwm)).expect("is written");
        let said = run(["check", file.to_str().expect("a path"), "--json"]);
        let judgement = said.json_whatever_the_code();
        assert_eq!(said.code == 0, judgement["works"] == true, "{said:?}");
        judgement["verdict"].as_str().expect("a text").to_owned()
    };
    let verdict = verdict_at("2.5 kHz");
    let told = "the rotor turns 23.0 electrical degrees in a control period: use one of at most 256.4 us (`f_pwm` of at least 3.9 kHz)";
    assert!(verdict.contains(told), "{verdict}");
    let finer = verdict_at("3.9 kHz");
    assert!(finer.starts_with("works"), "{finer}");
}

#[test]
fn check_names_the_frequency_that_suits_the_inductance() {
    let said = run(["check", "br2804-1700kv"]);
    let told = "warning[HX0625]: `f_pwm`: 40 kHz: a PWM period changes the current by 6.9 times the rated one: use one of at most 17.85 us (`f_pwm` of at least 56 kHz)";
    assert!(said.stderr.contains(told), "{said:?}");
}

/// A ramp changes nothing of what lasts.
#[test]
fn a_slew_rate_is_waited_for() {
    let drive = ["hoverboard-hub", "--controller", "pdcc:slew_rate=100A/s"];
    let said = run(["check"].iter().chain(&drive));
    let works = "hoverboard-hub: works: ";
    assert!(said.stdout.starts_with(works), "{said:?}");
    let at = ["--rpm", "400", "--json"];
    let found = run(["simulate"].iter().chain(&drive).chain(&at)).json();
    let torque = found["mean_torque_nm"].as_f64().expect("a torque");
    assert!((torque / 5.169 - 1.0).abs() < 0.01, "{torque}");
}

/// The EMF of a rotor that is faster than the bus allows drives the current, whatever is asked.
#[test]
fn simulate_says_where_the_emf_brakes() {
    for torque in ["3Nm", "0"] {
        let at = ["--rpm", "2900", "--v-bus", "40V", "--torque", torque];
        let said = run(["simulate", "trivedi-keshri-660w"].iter().chain(&at));
        assert!(said.stderr.contains("whatever is asked"), "{said:?}");
    }
}

/// In C the longest path takes more, and of that alone is told where C is made.
#[test]
fn c_that_may_not_fit_the_period_is_warned_of() {
    let of = |language, variant| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let out = folder.path().to_str().expect("a path").to_owned();
        let drive = ["generate", "hoverboard-hub", "--controller", variant];
        let emit = ["--emit", language, "--out", &out];
        run(drive.iter().chain(&emit)).stderr
    };
    let tight = "pdcc:target=cortex_m4,core_clock=62MHz";
    let told = of("c99", tight);
    assert!(told.contains("HX0614"), "{told}");
    assert!(told.contains("until control runs at"), "{told}");
    assert!(told.contains("the largest ratio of C to Rust"), "{told}");
    assert!(!of("rust", tight).contains("in C a step"));
    assert!(of("datasheet", tight).contains("in Rust the step fits"));
    // Nothing says there that the drive is to be in C.
    let checked = run(["check", "hoverboard-hub", "--controller", tight]).stderr;
    assert!(!checked.contains("HX0614"), "{checked}");
    let fast = "pdcc:target=cortex_m4,core_clock=170MHz";
    assert!(!of("c99", fast).contains("in C a step"));
    // Where nobody names the core, that of `check` is named.
    let out = tempfile::tempdir().expect("a temporary folder");
    let out = out.path().to_str().expect("a path");
    let told = run(["generate", "br2804-1700kv", "--emit", "c99", "--out", out]).stderr;
    let longest = "in C the longest step may take up to 116 % of the control period (estimated) if the core is a Cortex-M4 at 170 MHz";
    assert!(told.contains(longest), "{told}");
}

/// A motor whose stated limits of the bus current end its torque at rated speed, and whose EMF exceeds an empty battery.
const LIMITED: &str = r#"
[motor]
poles = 20
resistance = "0.024 ohm terminal"
inductance = "14 uH terminal"
emf_shape = "sinusoidal"
speed_constant = "130 rpm/V block_mean"
rated_current = "40 A peak"
rated_speed = "5000 rpm"

[inverter]
f_pwm = "24 kHz"
timer_clock = "170 MHz"
dead_time = "500 ns"
current_sensing = "in_phase"
adc_bits = 12
adc_range = "82.5 A"
hall_timer_clock = "2 MHz"
bus_voltage = "44 V"
v_bus = "measured"
bus_adc_bits = 12
bus_adc_range = "66 V"
bus_min = "33 V"
motoring_fade = "3 V"
braking_fade = "4 V"
bus_max = "51.4 V"
bus_current_limit = "20 A"
return_current_limit = "10 A"
over_speed = "5800 rpm"

[controller]
kind = "pdcc"
dead_time_compensation = "on"
"#;

/// Runs a command on a file of this text.
fn on_file(command: &str, text: &str, options: &[&str]) -> Said {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("bike.toml");
    fs::write(&file, text).expect("is written");
    let file = file.to_str().expect("a path");
    run([command, file].iter().chain(options))
}

#[test]
fn a_limit_of_the_bus_current_does_not_rank_controllers() {
    let advice = on_file("advise", LIMITED, &["--json"]).json();
    let place = advice["recommended"].as_u64().expect("a recommendation") as usize;
    let tried = &advice["tried"];
    assert_ne!(tried[place]["variant"], "p-pwm");
    let default = &tried[0]["nominal"][2]["torque_pct"];
    assert!(
        default.as_f64().is_some_and(|torque| torque > 97.0),
        "{default}"
    );
}

#[test]
fn check_says_first_that_the_emf_brakes_and_what_ends_the_current() {
    let said = on_file("check", LIMITED, &[]);
    let first = "works, but on a bus of 36";
    assert!(said.stdout.contains(first), "{said:?}");
    assert!(said.stdout.contains("its EMF brakes it"), "{said:?}");
    let whole = on_file("check", LIMITED, &["--all"]).stdout;
    let words: Vec<&str> = whole.split_whitespace().collect();
    let words = words.join(" ");
    for told in [
        "(20 magnets)",
        "rpm (by 20 A of bus current)",
        "below `over_speed` of 5800 rpm",
        "trips below 33 V, above 51.4 V; braking fades from 47.4 V; EMF 33 V at ",
    ] {
        assert!(words.contains(told), "{told}: {whole}");
    }
}

#[test]
fn a_speed_set_below_what_the_loop_holds_is_told_with_its_remedy() {
    let text = format!("{LIMITED}speed_loop = \"on\"\n")
        .replace("rated_speed =", "inertia = \"0.02 kg m2\"\nrated_speed =")
        .replace("rated_speed = \"5000 rpm\"", "rated_speed = \"3000 rpm\"");
    let said = on_file(
        "simulate",
        &text,
        &["--speed-set", "60rpm", "--load", "1Nm"],
    );
    assert!(
        said.stderr.contains("lower `speed_bandwidth` to"),
        "{said:?}"
    );
    let said = on_file("simulate", &text, &["--speed-set", "0rpm", "--load", "1Nm"]);
    assert!(said.stderr.contains("does not drive the shaft"), "{said:?}");
    let said = on_file("check", &text, &["--all"]);
    assert!(said.stdout.contains("speed loop "), "{said:?}");
}

/// The page is written, and says what `check` says.
#[test]
fn a_report_of_a_drive_that_does_not_work_fails_as_its_check() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("coarse.toml");
    let limited = "[inverter]\nreturn_current_limit = \"5 A\"\n";
    fs::write(&file, COARSE.replace("[inverter]\n", limited)).expect("is written");
    let file = file.to_str().expect("a path");
    let out = folder.path().to_str().expect("a path");
    let checked = run(["check", file]);
    let reported = run(["report", file, "--out", out]);
    assert_eq!([checked.code, reported.code], [1, 1], "{reported:?}");
    let error = checked
        .stderr
        .lines()
        .find(|line| line.starts_with("error: "));
    assert!(
        reported.stderr.contains(error.expect("is told")),
        "{reported:?}"
    );
    let limits = "limits      at most 5 A returned to it";
    for said in [&checked, &reported] {
        assert!(said.stdout.contains(limits), "{said:?}");
    }
    assert!(folder.path().join("report-coarse.html").is_file());
}

#[test]
fn check_runs_at_the_least_bus_voltage_that_the_file_states() {
    const MEASURED: &str = "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"80 V\"\n";
    let folder = tempfile::tempdir().expect("a temporary folder");
    let of = |more: &str| with_inverter(folder.path(), &format!("{MEASURED}{more}"));
    // The EMF at rated speed alone takes 34.5 V.
    for (bus_min, verdict, runs) in [
        ("", "works: it holds", 2),
        ("bus_min = \"46 V\"\n", "works: it holds", 3),
        ("bus_min = \"36 V\"\n", "works, but on a bus of 36", 3),
        (
            "bus_min = \"30 V\"\n",
            "works, but on a bus of 30 V its EMF brakes it at rated speed with 24.5 %",
            3,
        ),
        ("bus_min = \"47.99 V\"\n", "works: it holds", 3),
        // The nearest count is that of a bus above 48 V.
        ("bus_min = \"47.999 V\"\n", "works: it holds", 2),
    ] {
        let file = of(bus_min);
        let said = run(["check", &file]);
        assert_eq!(said.code, 0, "{bus_min}{said:?}");
        assert!(
            said.stdout.starts_with(&format!("changed: {verdict}")),
            "{bus_min}{said:?}"
        );
        let whole = run(["check", &file, "--all"]);
        let words: Vec<&str> = whole.stdout.split_whitespace().collect();
        let is_told = words.join(" ").contains("; there on ");
        assert_eq!(is_told, runs == 3, "{said:?}");
        // A line more for the voltages of the bus.
        assert!(said.stdout.lines().count() <= 11, "{said:?}");
        let json = run(["check", &file, "--json"]).json();
        let points = json["points"].as_array().expect("runs");
        assert_eq!(points.len(), runs, "{bus_min}");
    }
}

#[test]
fn check_tells_what_the_largest_set_point_makes_of_the_rating() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = with_inverter(folder.path(), "max_current = \"10 A\"\n");
    let said = run(["check", &file]);
    let verdict = "works, but `max_current` allows 1.648 Nm of the rated 3.3 Nm only";
    assert!(said.stdout.contains(verdict), "{said:?}");
    let file = with_inverter(folder.path(), "max_current = \"30 A\"\n");
    let said = run(["check", &file]);
    let words: Vec<&str> = said.stdout.split_whitespace().collect();
    let reach = "; max_current 30 A gives 4.944 Nm to ";
    assert!(words.join(" ").contains(reach), "{said:?}");
}

#[test]
fn reasons_of_defaults_are_told_on_demand() {
    let short = run(["check", PAPER]).stdout;
    assert!(!short.contains("\nby default"), "{short}");
    let long = run(["check", PAPER, "--reasons"]).stdout;
    assert!(
        long.contains("\nby default  saturation nearest: as fast as "),
        "{long}"
    );
    assert!(long.lines().count() > short.lines().count());
}

#[test]
fn every_board_has_motors_and_says_why_others_do_not_fit() {
    let said = run(["boards"]);
    assert_eq!(said.code, 0, "{said:?}");
    assert!(said.stdout.lines().count() < 40, "{said:?}");
    let list = run(["boards", "--json"]).json();
    for board in list["boards"].as_array().expect("boards") {
        let name = board["name"].as_str().expect("a name");
        let motors = board["motors"].as_array().expect("motors");
        assert!(motors.iter().any(|motor| motor["fits"] == true), "{name}");
        let said = run(["boards", name]);
        for motor in motors.iter().filter(|motor| motor["fits"] == false) {
            let motor = motor["motor"].as_str().expect("a name");
            let line = said
                .stdout
                .lines()
                .find(|line| line.starts_with(&format!("{motor}: ")));
            assert!(
                line.is_some_and(|line| line.contains("error[HX")),
                "{motor}: {said:?}"
            );
        }
    }
    run(["boards", "vesc"]).assert_bad_input(&["vesc-4"]);
}

#[test]
fn a_drive_with_a_speed_loop_is_judged_by_its_torque() {
    let drive = ["hurst-long", "--controller", "pdcc:speed_loop=on"];
    for command in ["check", "limit"] {
        let said = run([command].iter().chain(&drive));
        assert_eq!(said.code, 0, "{said:?}");
        let note = "the speed loop is left out: this command sets the torque";
        assert!(said.stderr.contains(note), "{said:?}");
    }
    // The time of its step is that of the whole drive.
    let cycles = |variant: &str| {
        let json = run(["check", "hurst-long", "--controller", variant, "--json"]).json();
        number(&json["step"][0], "instructions")
    };
    assert!(cycles("pdcc:speed_loop=on") > cycles("pdcc") + 20.0);
}

#[test]
fn a_step_that_takes_most_of_the_period_is_told() {
    let check = |variant: &str| run(["check", PAPER, "--controller", variant]);
    let said = check("pdcc:target=cortex_m4,core_clock=35 MHz");
    let words: Vec<&str> = said.stdout.split_whitespace().collect();
    assert!(words.join(" ").contains("a step may take "), "{said:?}");
    let said = check("pdcc:target=cortex_m0,core_clock=8 MHz");
    assert_eq!(said.code, 1, "{said:?}");
    let why = "does not work: a step in control may take ";
    assert!(said.stdout.contains(why), "{said:?}");
    // The board's own chip is not the one whose cycles are counted.
    let said = run(["check", "hoverboard-hub"]);
    assert!(
        said.stderr.contains("the board's chip: STM32F103"),
        "{said:?}"
    );
}

#[test]
fn check_tells_how_often_the_switches_turn_on() {
    // At 20 kHz; a leg that reaches an end of the period does not switch in it.
    for (variant, kilohertz) in [
        ("pdcc:common_mode=centred", 19.0..20.1),
        ("pdcc:common_mode=clamped_low", 12.7..13.4),
    ] {
        let arguments = ["check", PAPER, "--controller", variant];
        let json = run(arguments.iter().chain(&["--json"])).json();
        let slow = 1e-3 * number(&json["points"][0], "switching_hz");
        assert!(kilohertz.contains(&slow), "{variant}: {slow} kHz");
        let said = run(arguments);
        let text = format!("; PWM ripple to 1.82 A pp; switches at {slow:.1} kHz");
        assert!(said.stdout.contains(&text), "{variant}: {said:?}");
    }
}

/// Whether a comment is a field, and not a sentence.
fn is_field(comment: &str) -> bool {
    let is_name = |name: &str| name.chars().all(|c| c.is_ascii_lowercase() || c == '_');
    comment
        .split_once(" = ")
        .is_some_and(|(name, _)| is_name(name))
}

#[test]
fn what_is_missing_stands_in_the_file_to_be_filled_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hub.toml");
    let path = path.to_str().expect("a plain path");
    // The answers come from a pipe: no questions.
    let output = hexagen()
        .args(["new", path, "poles=30", "emf_shape=trapezoid"])
        .stdin(Stdio::null())
        .output();
    let said = Said::from(output.expect("the program starts"));
    assert_eq!(said.code, 0, "{said:?}");
    assert!(
        said.stdout
            .contains("fill in resistance, inductance, back_emf, "),
        "{said:?}"
    );
    let text = fs::read_to_string(path).expect("is there");
    assert!(text.contains("\npoles = 30\n"), "{text}");
    assert!(
        text.contains("\n# resistance = \"0.27 ohm terminal\"\n"),
        "{text}"
    );
    run(["check", path]).assert_bad_input(&["error[HX0105]: `motor` lacks the field `resistance`"]);
    // Uncommented, the examples are a drive.
    let filled = text
        .lines()
        .map(|line| match line.strip_prefix("# ") {
            Some(field) if is_field(field) => field,
            _ => line,
        })
        .collect::<Vec<_>>()
        .join("\n")
        .replace("poles = 30", "poles = 8")
        .replace("angle_pole_pairs = 15", "angle_pole_pairs = 4");
    fs::write(path, filled).expect("can be written");
    let said = run(["check", path]);
    assert_eq!(said.code, 0, "{said:?}");
}

#[test]
fn a_file_that_is_there_is_not_replaced_without_being_told_to() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hub.toml");
    fs::write(&path, "mine").expect("can be written");
    let name = path.to_str().expect("a plain path");
    let new = |more: &[&str]| run(["new", name].iter().chain(more).chain(&HUB));
    new(&[]).assert_bad_input(&["is there already", "--force"]);
    assert_eq!(fs::read_to_string(&path).expect("is there"), "mine");
    assert_eq!(new(&["--force"]).code, 0);
    assert!(
        fs::read_to_string(&path)
            .expect("is there")
            .starts_with("# A motor")
    );
    assert_eq!(fs::read_dir(folder.path()).expect("is there").count(), 1);
}

#[test]
fn values_in_error_are_told_and_nothing_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hub.toml");
    let name = path.to_str().expect("a plain path");
    for (value, texts) in [
        (
            "resistance=0.4 ohm",
            &["HX0205", "line_to_line", "Nothing was written"][..],
        ),
        ("poles=15", &["HX0210", "15 is odd"]),
        (
            "resistence=0.4 ohm terminal",
            &["HX0103", "did you mean `resistance`?"],
        ),
        ("colour=red", &["HX0103"]),
        ("controller=pdcc", &["HX0103", "takes `kind=pdcc`"]),
        ("poles", &["write FIELD=VALUE"]),
        ("rated_speed=400", &["HX0204", "give a unit such as `rpm`"]),
        ("winding=triangle", &["HX0207", "`star` or `delta`"]),
    ] {
        run(["new", name, value]).assert_bad_input(texts);
        assert!(!path.exists(), "{value}");
    }
    run(["new", name, "poles=8", "poles=10"]).assert_bad_input(&["given twice"]);
}

#[test]
fn a_drive_that_does_not_work_fails() {
    let said = run(["check", PAPER, "--controller", "pdcc:colour=red"]);
    said.assert_bad_input(&["colour"]);
    run(["check", "trivedi"]).assert_bad_input(&["no motor `trivedi`"]);
    let said = run(["check", "trivedi", "--json"]);
    let json = said.json_whatever_the_code();
    assert_eq!(said.code, 2, "{said:?}");
    assert!(
        json["error"]
            .as_str()
            .is_some_and(|text| said.stderr.contains(text)),
        "{said:?}"
    );
}

#[test]
fn codes_are_explained() {
    for code in ["HX0302", "hx302", "302"] {
        let said = run(["explain", code]);
        assert_eq!(said.code, 0, "{said:?}");
        for text in [
            "HX0302 (error)",
            "rated_speed = \"5000 rpm\"",
            "no_load_speed",
        ] {
            assert!(said.stdout.contains(text), "{said:?}");
        }
    }
    let json = run(["explain", "HX0603", "--json"]).json();
    assert_eq!(json["is_warning"], true);
    let all = run(["explain", "--json"]).json();
    assert!(all["codes"].as_array().expect("a list").len() > 50);
    run(["explain", "HX9999"]).assert_bad_input(&["no code `HX9999`"]);
}

#[test]
fn shells_complete_commands_motors_boards_and_files() {
    for shell in ["bash", "zsh", "fish"] {
        let said = run(["completions", shell]);
        assert_eq!(said.code, 0, "{said:?}");
        let asks = said.stdout.contains("HEXAGEN_COMPLETE");
        assert!(asks, "{shell}: {said:?}");
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("triangle.toml"), "").expect("is written");
    fs::write(folder.path().join("trial.txt"), "").expect("is written");
    let offered = |typed: &[&str]| {
        let mut asked = hexagen();
        asked
            .current_dir(folder.path())
            .env("HEXAGEN_COMPLETE", "fish");
        let output = asked.args(["--", "hexagen"].iter().chain(typed)).output();
        let said = Said::from(output.expect("the program starts"));
        let words = said
            .stdout
            .lines()
            .filter_map(|line| line.split('\t').next());
        words.map(str::to_owned).collect::<Vec<String>>()
    };
    assert_eq!(offered(&["expl"]), ["explain"]);
    assert_eq!(offered(&["check", "tri"]), [PAPER, "triangle.toml"]);
    assert_eq!(offered(&["check", "--contr"]), ["--controller"]);
    let boards = offered(&["report", PAPER, "--board", "vesc"]);
    assert_eq!(boards, ["vesc-4", "vesc-75-300"]);
}
