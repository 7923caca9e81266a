//! `hexagen simulate` and `limit`: keys, columns, models, signs and plant options.

use crate::support::{PAPER, keys, number, run};
use hexagen_lab::closed_loop::{MOST_RECORDED, RunOptions};
use hexagen_lab::engine::{MotorSource, plant_of, prepare};
use serde_json::Value;
use std::f64::consts::TAU;

const MERITS: [&str; 16] = [
    "mean_torque_nm",
    "ripple_pp_pct",
    "ripple_rms_pct",
    "h6_pct",
    "h12_pct",
    "i5_pct",
    "i7_pct",
    "i11_pct",
    "i13_pct",
    "thd_pct",
    "current_rms_a",
    "bus_current_a",
    "tracking_rms_a",
    "commutation_us",
    "switching_hz",
    "saturated_pct",
];

/// The variant that holds its torque best.
const BEST: &str = "pdcc:saturation=torque_priority,advance=2,emf=model,hall_capture=timer";

fn simulate(arguments: &[&str]) -> Value {
    let fixed = ["simulate", PAPER, "--json"];
    run(fixed.iter().chain(arguments)).json()
}

#[test]
fn json_has_the_documented_keys() {
    let result = simulate(&["--rpm", "1500"]);
    let found = keys(&result);
    for key in MERITS {
        assert!(found.contains(&key), "{key} is missing");
        assert!(result[key].is_f64(), "{key} is no number");
    }
    let about: Vec<&str> = found
        .into_iter()
        .filter(|key| !MERITS.contains(key))
        .collect();
    let mut expected = [
        "motor",
        "controller",
        "model",
        "engine",
        "rpm",
        "torque_nm",
        "tripped",
    ];
    expected.sort_unstable();
    let mut about = about;
    about.sort_unstable();
    assert_eq!(about, expected);
    assert_eq!(result["engine"], "compiled");
    assert_eq!(result["model"], "fixed");
    assert_eq!(result["tripped"], Value::Null);
}

#[test]
fn bit_true_gives_the_very_same_merits_and_ideal_nearly() {
    let of = |model: &str, controller: &str| {
        simulate(&[
            "--rpm",
            "1500",
            "--model",
            model,
            "--controller",
            controller,
        ])
    };
    // One drive that is built in, one that is interpreted.
    for (controller, engine) in [("pdcc", "compiled"), (BEST, "interpreter")] {
        let fixed = of("fixed", controller);
        let bit_true = of("bit-true", controller);
        let ideal = of("ideal", controller);
        assert_eq!(fixed["engine"], engine);
        assert_eq!(bit_true["engine"], Value::Null);
        for key in MERITS {
            assert_eq!(fixed[key], bit_true[key], "{key}");
        }
        let (fixed, ideal) = (number(&fixed, MERITS[0]), number(&ideal, MERITS[0]));
        assert!(
            (fixed - ideal).abs() < 0.001 * ideal && fixed != ideal,
            "{fixed} {ideal}"
        );
    }
}

#[test]
fn both_directions_and_both_torques_work() {
    for (rpm, torque) in [("-1200", "2Nm"), ("1200", "-2Nm"), ("-1200", "-2Nm")] {
        let result = simulate(&["--rpm", rpm, "--torque", torque, "--controller", BEST]);
        let (mean, demand) = (
            number(&result, "mean_torque_nm"),
            number(&result, "torque_nm"),
        );
        assert!(
            (mean / demand - 1.0).abs() < 0.02,
            "{rpm} rpm {torque}: {mean}"
        );
        assert_eq!(number(&result, "rpm").to_string(), rpm);
    }
}

#[test]
fn csv_has_the_documented_columns_and_a_row_per_period() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.csv");
    let path = path.to_str().expect("a plain path");
    simulate(&["--rpm", "1500", "--csv", path]);
    let text = std::fs::read_to_string(path).expect("was written");
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some(
            "t,theta_e,rpm,sector,hall,comm,ia,ib,ic,ialpha_ref,ibeta_ref,torque_mean,valpha_mean,vbeta_mean"
        )
    );
    // Six electrical turns at 1500 rpm and four pole pairs are 60 ms, 1200 periods.
    let rows: Vec<&str> = lines.collect();
    assert_eq!(rows.len(), 1200);
    for row in rows {
        assert!(
            row.split(',').all(|cell| cell.parse::<f64>().is_ok()),
            "{row}"
        );
    }
}

#[test]
fn without_json_there_is_a_table() {
    let said = run(["simulate", PAPER, "--rpm", "1500", "--torque", "1Nm"]);
    assert_eq!(said.code, 0);
    assert!(said.stdout.contains("| mean torque"), "{}", said.stdout);
    assert!(said.stdout.contains("compiled"), "{}", said.stdout);
    assert_eq!(said.stderr, "");
}

#[test]
fn plant_options_reach_the_plant() {
    let nominal = simulate(&["--rpm", "1500", "--start-angle", "0.1rad"]);
    for option in [
        ["--dead-time", "1us"],
        ["--adc-bits", "8"],
        ["--adc-range", "50A"],
        ["--adc-offset", "0.5A"],
        ["--adc-offset", "0.5A,-0.5A"],
        ["--scale-adc", "1.02"],
        ["--scale-adc", "1.01,0.99"],
        ["--adc-noise", "2"],
        ["--conversion-time", "1us"],
        ["--v-bus", "40V"],
        ["--scale-r", "2"],
        ["--scale-l", "0.9"],
        ["--scale-kb", "0.9"],
        ["--hall-error", "5deg"],
        ["--hall-error", "5deg,-5deg,0"],
        ["--inertia", "1e-3kgm2"],
        ["--start-angle", "10deg"],
    ] {
        let mut arguments = vec!["--rpm", "1500"];
        if option[0] != "--start-angle" {
            arguments.extend(["--start-angle", "0.1rad"]);
        }
        arguments.extend(option);
        let changed = simulate(&arguments);
        assert_ne!(
            nominal["tracking_rms_a"], changed["tracking_rms_a"],
            "{option:?}"
        );
    }
}

#[test]
fn adc_options_change_plant_and_controller_together() {
    // A range of its own would scale the torque; the same for both leaves it.
    let mean = |range: &str| {
        let result = simulate(&[
            "--rpm",
            "800",
            "--adc-range",
            range,
            "--start-angle",
            "0.1rad",
        ]);
        number(&result, "mean_torque_nm")
    };
    let (narrow, wide) = (mean("30A"), mean("60A"));
    assert!((narrow / wide - 1.0).abs() < 0.005, "{narrow} {wide}");
}

#[test]
fn a_free_shaft_settles_where_load_and_torque_balance() {
    // Without load the motor runs up; held back by more than its torque it slows down. Either way
    // the set torque is held while the voltage suffices.
    let result = simulate(&[
        "--rpm",
        "600",
        "--torque",
        "1Nm",
        "--inertia",
        "5e-3kgm2",
        "--load",
        "1Nm",
        "--start-angle",
        "0.1rad",
    ]);
    assert!(
        (number(&result, "mean_torque_nm") - 1.0).abs() < 0.01,
        "{result}"
    );
}

#[test]
fn a_speed_loop_reaches_the_speed_that_is_set() {
    for (set, load) in [("1500rpm", "0.1Nm"), ("-900rpm", "0.2Nm")] {
        let result = run([
            "simulate",
            "hurst-long",
            "--controller",
            "pdcc:speed_loop=on",
            "--rpm",
            "0",
            "--speed-set",
            set,
            "--inertia",
            "7.06e-6kgm2",
            "--load",
            load,
            "--start-angle",
            "0.1rad",
            "--json",
        ])
        .json();
        let share = number(&result, "mean_rpm") / number(&result, "set_rpm");
        assert!((share - 1.0).abs() < 0.02, "{result}");
        let opposing = load.trim_end_matches("Nm").parse::<f64>();
        let opposing = opposing.expect("a number") * share.signum();
        let torque = number(&result, "mean_torque_nm") * number(&result, "set_rpm").signum();
        assert!((torque / opposing - 1.0).abs() < 0.05, "{result}");
    }
}

#[test]
fn a_speed_is_set_from_rest_with_the_inertia_of_the_file_and_else_a_torque() {
    let drive = [
        "simulate",
        "hurst-long",
        "--controller",
        "pdcc:speed_loop=on",
    ];
    let set = ["--speed-set", "1500rpm", "--start-angle", "0.1rad"];
    let said = run(drive.iter().chain(&set));
    assert_eq!(said.code, 0, "{said:?}");
    assert!(
        said.stdout.contains(": from 0 rpm with at most "),
        "{said:?}"
    );
    assert!(said.stdout.contains(", settled"), "{said:?}");
    let said = run(drive.iter().chain(&["--rpm", "400", "--torque", "-0.1Nm"]));
    assert_eq!(said.code, 0, "{said:?}");
    assert!(
        said.stderr.contains("the speed loop is left out"),
        "{said:?}"
    );
    // 2 % of a standstill could not be met.
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("wheel.toml");
    let motor = MotorSource::of_library("hoverboard-hub").expect("is in the library");
    let heavy = "[motor]\ninertia = \"0.01 kg m2\"\n";
    std::fs::write(&file, motor.text.replace("[motor]\n", heavy)).expect("is written");
    let file = file.to_str().expect("a path");
    let stop = [
        "--rpm",
        "200",
        "--speed-set",
        "0",
        "--start-angle",
        "0.1rad",
        "--json",
    ];
    let drive = ["simulate", file, "--controller", "pdcc:speed_loop=on"];
    let result = run(drive.iter().chain(&stop)).json();
    assert_eq!(result["settled"], true, "{result}");
}

#[test]
fn a_limit_of_the_bus_current_is_named_where_it_cuts_the_torque() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("limited.toml");
    let motor = MotorSource::of_library("hoverboard-hub").expect("is in the library");
    let limits = "[inverter]\nreturn_current_limit = \"1 A\"\n";
    std::fs::write(&file, motor.text.replace("[inverter]\n", limits)).expect("is written");
    let file = file.to_str().expect("a path");
    let cut = ", with `return_current_limit` of 1 A";
    let said = run(["simulate", file, "--rpm", "400", "--torque", "-5.9Nm"]);
    assert!(said.stderr.contains(cut), "{said:?}");
    let said = run(["limit", file, "--torque", "-5Nm"]);
    assert!(said.stdout.contains(cut), "{said:?}");
    let said = run(["limit", file, "--torque", "5.9Nm"]);
    assert!(!said.stdout.contains(cut), "{said:?}");
    // The bus ends the torque long before so much is drawn.
    let wide = "[inverter]\nbus_current_limit = \"200 A\"\n";
    std::fs::write(file, motor.text.replace("[inverter]\n", wide)).expect("is written");
    let said = run(["limit", file]);
    assert!(!said.stdout.contains("bus_current_limit"), "{said:?}");
}

#[test]
fn a_set_point_beyond_the_limit_is_told() {
    let at = |torque: &str| {
        run([
            "simulate", PAPER, "--rpm", "300", "--torque", torque, "--json",
        ])
    };
    let said = at("5Nm");
    let result = said.json();
    assert!(said.stderr.contains("max_current"), "{}", said.stderr);
    let table = run(["simulate", PAPER, "--rpm", "300", "--torque", "5Nm"]);
    let header = "5.000 Nm, limited to 3.626 Nm, at 300 rpm";
    assert!(table.stdout.contains(header), "{table:?}");
    let reached = number(&result, "mean_torque_nm");
    assert!(reached < 4.0, "{result}");
    // Tracking is judged by the current that the drive may ask for, not by the one that it may not.
    let asked = at(&format!("{reached}Nm")).json();
    let [beyond, within] = [&result, &asked].map(|run| number(run, "tracking_rms_a"));
    assert!(
        (beyond / within - 1.0).abs() < 0.05,
        "{beyond} A, {within} A"
    );
}

#[test]
fn a_percentage_of_nothing_is_absent() {
    let torque = &MERITS[1..5];
    let current = &MERITS[5..10];
    let [harmonics, both] = [[&torque[2..], current].concat(), [torque, current].concat()];
    for controller in ["pdcc", "pi-pwm", "fcs-mpc", "phcc"] {
        for (rpm, torque, absent) in [
            ("1500", "0", &both),
            ("0", "0", &both),
            ("0", "3Nm", &harmonics),
        ] {
            let arguments = ["--rpm", rpm, "--torque", torque, "--controller", controller];
            let result = simulate(&[&arguments[..], &["--start-angle", "0.1rad"]].concat());
            for key in MERITS {
                let is_absent = absent.contains(&key) || (rpm, key) == ("0", "commutation_us");
                let place = format!("{controller}, {rpm} rpm, {torque} Nm, {key}: {result}");
                assert!(keys(&result).contains(&key), "{place}");
                assert_eq!(result[key].is_null(), is_absent, "{place}");
            }
        }
    }
    let said = run(["simulate", PAPER, "--rpm", "0", "--start-angle", "0.1rad"]);
    assert!(
        said.stdout
            .contains("| current distortion          |       - |"),
        "{}",
        said.stdout
    );
}

#[test]
fn a_free_shaft_tells_the_speed_that_it_reached() {
    // 1 Nm against 0.5 Nm: 100 rad/s^2 for 50 ms of settling and 150 ms of measurement.
    // Of the laws that wait for no angle, so that the torque acts from the beginning.
    let free = [
        "--controller",
        "pdcc:emf=estimated",
        "--rpm",
        "600",
        "--torque",
        "1Nm",
        "--inertia",
        "5e-3kgm2",
        "--load",
        "0.5Nm",
        "--start-angle",
        "0.1rad",
    ];
    let result = simulate(&free);
    let gained = |seconds: f64| 600.0 + 100.0 * seconds * 60.0 / std::f64::consts::TAU;
    for (key, expected) in [("mean_rpm", gained(0.125)), ("final_rpm", gained(0.2))] {
        let found = number(&result, key);
        assert!(
            (found / expected - 1.0).abs() < 0.01,
            "{key}: {found}, {expected}"
        );
    }
    assert_eq!(number(&result, "rpm"), 600.0);
    assert_eq!(
        (&result["set_rpm"], &result["settled"]),
        (&Value::Null, &Value::Null)
    );
    let said = run(["simulate", PAPER].iter().chain(&free));
    assert!(said.stdout.contains("free shaft: 719"), "{}", said.stdout);
}

#[test]
fn a_load_step_has_its_dip_overshoot_and_recovery() {
    let asked = |load: &str| {
        let drive = ["hurst-long", "--controller", "pdcc:speed_loop=on"];
        let speed = ["--speed-set", "1500rpm", "--start-angle", "0.1rad"];
        let step = ["--inertia", "7.06e-6kgm2", "--load-step", load];
        let all = drive.into_iter().chain(speed).chain(step);
        all.map(str::to_owned).collect::<Vec<_>>()
    };
    let simulated = |load: &str, more: &[&str]| {
        let asked = asked(load);
        let fixed = ["simulate"]
            .into_iter()
            .chain(asked.iter().map(String::as_str));
        run(fixed.chain(more.iter().copied()))
    };
    let [small, large] = ["0.005Nm", "0.01Nm"].map(|load| simulated(load, &["--json"]).json());
    for result in [&small, &large] {
        assert_eq!(result["settled"], true, "{result}");
        assert!(number(result, "recovery_ms") > 0.0, "{result}");
        assert_eq!(result["mean_torque_nm"], Value::Null, "{result}");
    }
    let ratio = number(&large, "dip_rpm") / number(&small, "dip_rpm");
    assert!((1.5..2.5).contains(&ratio), "{small} {large}");
    let said = simulated("0.01Nm", &[]);
    assert!(
        said.stdout.contains(", settled before the load step, "),
        "{said:?}"
    );
    let words: Vec<&str> = said.stdout.split_whitespace().collect();
    let words = words.join(" ");
    assert!(words.contains("; back within 2 % after "), "{said:?}");
    assert_eq!(said.stderr, "", "{said:?}");
    // More than the motor makes.
    let said = simulated("0.4Nm", &[]);
    assert!(said.stdout.contains("; NOT back within 2 %"), "{said:?}");
    let warning = "--load-step: the speed has not come back to 1500 rpm; it is 0 rpm at the end";
    assert!(said.stderr.contains(warning), "{said:?}");
    for load in ["-0.1Nm", "0"] {
        simulated(load, &[]).assert_bad_input(&["--load-step", "give it above 0"]);
    }
}

#[test]
fn a_speed_loop_that_does_not_settle_says_so() {
    let common = [
        "simulate",
        "hurst-long",
        "--controller",
        "pdcc:speed_loop=on",
        "--rpm",
        "0",
        "--inertia",
        "7.06e-6kgm2",
        "--start-angle",
        "0.1rad",
    ];
    for (speed, settled) in [("1500rpm", true), ("5400rpm", false)] {
        let asked = ["--load", "0.1Nm", "--speed-set", speed];
        let said = run(common.iter().chain(&asked).chain(&["--json"]));
        let result = said.json();
        assert_eq!(result["settled"], settled, "{result}");
        assert_eq!(
            said.stderr.contains("has not settled"),
            !settled,
            "{}",
            said.stderr
        );
        let table = run(common.iter().chain(&asked));
        assert_eq!(table.code, 0);
        assert_eq!(
            table.stdout.contains(", NOT settled"),
            !settled,
            "{}",
            table.stdout
        );
        assert_eq!(
            table.stdout.contains(", settled"),
            settled,
            "{}",
            table.stdout
        );
    }
    // A load that the motor cannot move.
    let stalled = run(common
        .iter()
        .chain(&["--load", "0.4Nm", "--speed-set", "1500rpm"]));
    assert_eq!(stalled.code, 1, "{stalled:?}");
    assert!(
        stalled
            .stderr
            .contains("no Hall edge and no new angle came within the stall time-out"),
        "{}",
        stalled.stderr
    );
}

/// The conventional drive gives the more torque beyond what is asked for, the faster it turns.
#[test]
fn limit_ends_where_the_torque_rises_above_the_demand() {
    let drive = "pi-pwm:six_step=on,bandwidth=600Hz";
    let options = ["--controller", drive, "--start-angle", "0.1rad"];
    let common = ["limit", "trivedi-keshri-660w"];
    let result = run(common.iter().chain(&options).chain(&["--json"])).json();
    let demand = number(&result, "torque_nm");
    let curve: Vec<(f64, f64)> =
        serde_json::from_value(result["curve"].clone()).expect("pairs of numbers");
    let [.., before, last] = curve[..] else {
        panic!("too short: {result}");
    };
    assert!(
        before.1 / demand <= 1.03 && last.1 / demand > 1.03,
        "{before:?} {last:?}"
    );
    let part = (1.03 * demand - before.1) / (last.1 - before.1);
    let expected = before.0 + part * (last.0 - before.0);
    let found = number(&result, "limit_rpm");
    assert!(
        (found - expected).abs() < 1e-6 && found < 1000.0,
        "{found} {expected}"
    );
    assert_eq!(
        (&result["outcome"], &result["lost"]),
        (&"found".into(), &"above".into())
    );
    let text = run(common.iter().chain(&options)).stdout;
    assert!(text.contains("; beyond, torque above the demand"), "{text}");

    // PHCC overshoots the set torque of this motor from the first speed on.
    let said = run([
        "limit",
        PAPER,
        "--controller",
        "phcc",
        "--start-angle",
        "0.1rad",
        "--json",
    ]);
    let result = said.json();
    assert_eq!(
        (&result["outcome"], &result["lost"]),
        (&"never_held".into(), &"above".into())
    );
    assert_eq!(
        (&result["limit_rpm"], &result["limit_pct"]),
        (&Value::Null, &Value::Null)
    );
}

#[test]
fn limit_has_its_keys_and_agrees_with_simulate() {
    let controller = "pdcc:saturation=torque_priority,hall_capture=timer";
    let said = run([
        "limit",
        PAPER,
        "--controller",
        controller,
        "--json",
        "--start-angle",
        "0.1rad",
    ]);
    let result = said.json();
    let (rpm, percent) = (number(&result, "limit_rpm"), number(&result, "limit_pct"));
    assert!((percent - rpm / 20.0).abs() < 1e-9, "{rpm} {percent}");
    assert_eq!(result["outcome"], "found");
    assert_eq!(result["lost"], "below");
    assert_eq!(result["tripped"], Value::Null);
    assert_eq!(result["engine"], "interpreter");
    let held = |rpm: f64| {
        let rpm = rpm.to_string();
        let arguments = [
            "--rpm",
            &rpm,
            "--controller",
            controller,
            "--start-angle",
            "0.1rad",
        ];
        number(&simulate(&arguments), "mean_torque_nm") >= 0.97 * 3.3
    };
    assert!(held(rpm - 30.0) && !held(rpm + 30.0), "{rpm}");
}

/// A tenth of the stated inductance lets the current run away from every model.
#[test]
fn a_drive_that_trips_is_told_with_fault_and_time() {
    for (model, controller) in [
        ("fixed", "pdcc"),
        ("fixed", BEST),
        ("bit-true", "pdcc"),
        ("ideal", "pdcc"),
    ] {
        let plant = ["--scale-l", "0.1", "--start-angle", "0.1rad"];
        let common = ["--controller", controller, "--model", model, "--json"];
        let said = run(["simulate", PAPER, "--rpm", "1500"]
            .iter()
            .chain(&common)
            .chain(&plant));
        assert_eq!(said.code, 1, "{said:?}");
        assert!(said.stderr.contains("tripped"), "{}", said.stderr);
        let result = said.json_whatever_the_code();
        let trip = &result["tripped"];
        let is_of_currents = |trip: &Value| {
            let fault = trip["fault"].as_str().expect("a fault");
            ["over_current", "adc_range"].contains(&fault)
        };
        assert!(is_of_currents(trip), "{trip}");
        let time = number(trip, "time_s");
        assert!(time > 0.0 && time < 0.1, "{trip}");
        assert!((number(trip, "rpm") - 1500.0).abs() < 1e-6, "{trip}");
        for key in MERITS {
            assert!(keys(&result).contains(&key), "{result}");
            assert_eq!(result[key], Value::Null, "{key} of a drive that tripped");
        }

        let said = run(["limit", PAPER].iter().chain(&common).chain(&plant));
        assert_eq!(said.code, 1, "{said:?}");
        assert!(said.stderr.contains("tripped"), "{}", said.stderr);
        let result = said.json_whatever_the_code();
        assert_eq!(result["outcome"], "never_held", "{result}");
        assert_eq!(result["limit_rpm"], Value::Null);
        assert_eq!(result["curve"], serde_json::json!([]), "{result}");
        assert_eq!(result["lost"], Value::Null);
        assert!(is_of_currents(&result["tripped"]), "{result}");
        assert!((number(&result["tripped"], "rpm") - 400.0).abs() < 1e-6);
    }
    let said = run(["simulate", PAPER, "--rpm", "1500", "--scale-l", "0.1"]);
    assert_eq!(said.code, 1);
    assert!(said.stdout.contains("It tripped"), "{}", said.stdout);
    assert!(said.stderr.contains("the drive tripped"), "{}", said.stderr);
    assert!(!said.stdout.contains('|'), "{}", said.stdout);
}

/// A motor file's controller is the one that is named, with the options that the file gives it; so
/// are those that a variant of the same kind leaves as they are.
#[test]
fn the_controller_of_a_motor_file_is_named_by_what_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.toml");
    let library = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../motors/trivedi-keshri-660w.toml"
    );
    let text = std::fs::read_to_string(library).expect("the library is there");
    let named = |kind: &str, variant: Option<&str>| {
        let own = text.replace("kind = \"pdcc\"", kind);
        assert_ne!(own, text, "the library's file has the default");
        std::fs::write(&path, own).expect("can be written");
        let path = path.to_str().expect("a plain path");
        let arguments = [
            "simulate",
            path,
            "--rpm",
            "1500",
            "--start-angle",
            "0.1rad",
            "--json",
        ];
        let variant = variant.map_or(vec![], |variant| vec!["--controller", variant]);
        let result = run(arguments.into_iter().chain(variant)).json();
        result["controller"].as_str().expect("a name").to_owned()
    };
    let nearest = "kind = \"pdcc\"\nsaturation = \"nearest\"";
    assert_eq!(named(nearest, None), "pdcc:saturation=nearest");
    assert_eq!(
        named(nearest, Some("pdcc:emf=model")),
        "pdcc:saturation=nearest,emf=model"
    );
    assert_eq!(named(nearest, Some("phcc")), "phcc");
    let slow = "kind = \"pi-pwm\"\nbandwidth = \"600 Hz\"";
    assert_eq!(named(slow, None), "pi-pwm:bandwidth=600Hz");
}

#[test]
fn records_of_slow_runs_are_bounded_and_hold_whole_turns() {
    let motor = MotorSource::of_library(PAPER).expect("is in the library");
    let plant = plant_of(&prepare(&motor, None).expect("generates").spec);
    for (rpm, turns) in [
        (1500.0, 6.0),
        (7.2, 6.0),
        (7.1, 5.0),
        (2.5, 2.0),
        (1.25, 1.0),
    ] {
        let (settling, measured) = RunOptions::new(rpm * TAU / 60.0, 20.0).periods(&plant);
        let turn = 60.0 / (rpm * 4.0 * plant.t_s);
        assert_eq!(measured, (turns * turn).round() as usize, "{rpm}");
        assert!(measured <= MOST_RECORDED, "{rpm}: {measured}");
        assert!(settling as f64 >= 2.0 * turn, "{rpm}: {settling}");
    }
    let (_, at_rest) = RunOptions::new(0.0, 20.0).periods(&plant);
    assert_eq!(at_rest, 1000);
}

/// What low-side sensors cost is told beside the limit.
#[test]
fn limit_tells_what_the_window_of_low_side_sensors_costs() {
    let common = [
        "limit",
        "hurst-long",
        "--board",
        "vesc-4",
        "--controller",
        "pdcc",
    ];
    let options = ["--start-angle", "0.1rad"];
    let result = run(common.iter().chain(&options).chain(&["--json"])).json();
    let limited = number(&result, "limit_rpm");
    let free = number(&result["without_window"], "limit_rpm");
    assert!(limited < free, "{limited} {free}");
    let text = run(common.iter().chain(&options)).stdout;
    assert!(
        text.contains("; with in-phase sensors held up to"),
        "{text}"
    );
    // A board that says how many ADCs its three sensors share.
    let shared = ["limit", "linix-45zwn24-40", "--board", "st-b-g431b-esc1"];
    let text = run(shared.iter().chain(&options)).stdout;
    assert!(text.contains("in-phase sensors"), "{text}");
    let result = run(["limit", PAPER, "--start-angle", "0.1rad", "--json"]).json();
    assert!(result["without_window"].is_null(), "{result}");
}

#[test]
fn a_demand_beyond_the_envelope_is_a_warning() {
    let warned = |rpm: &str| {
        let output = run(["simulate", "hoverboard-hub", "--rpm", rpm]);
        output.stderr
    };
    let short = warned("560");
    assert!(
        short.contains(
            "5.169 Nm at 560 rpm: the bus of 36 V drives the whole current only up to 0 Nm there"
        ),
        "{short}"
    );
    let fast = warned("900");
    assert!(
        fast.contains("--rpm 900: beyond maximum_speed = 600 rpm"),
        "{fast}"
    );
    assert_eq!(warned("300"), "");
}

#[test]
fn check_and_simulate_tell_the_same_ripple() {
    let check = run(["check", PAPER, "--json"]).json();
    let point = &check["points"][0];
    let rpm = number(point, "rpm").to_string();
    let simulated = run(["simulate", PAPER, "--rpm", &rpm, "--json"]).json();
    let ripples = [point, &simulated].map(|of| number(of, "ripple_pp_pct"));
    assert!((ripples[0] - ripples[1]).abs() < 1e-9, "{ripples:?}");
}

#[test]
fn the_bus_gives_the_power_of_shaft_and_windings() {
    let motor = MotorSource::of_library(PAPER).expect("is in the library");
    let spec = prepare(&motor, None).expect("generates").spec;
    for rpm in ["400", "2000"] {
        let run = run(["simulate", PAPER, "--rpm", rpm, "--json"]).json();
        let omega_m = number(&run, "rpm") * TAU / 60.0;
        let shaft = number(&run, "mean_torque_nm") * omega_m;
        let copper = 3.0 * spec.motor.resistance * number(&run, "current_rms_a").powi(2);
        let bus = spec.inverter.v_bus * number(&run, "bus_current_a");
        assert!(
            (bus / (shaft + copper) - 1.0).abs() < 0.005,
            "{bus} {shaft} {copper}"
        );
    }
    let check = run(["check", PAPER]).stdout;
    let check = check.split_whitespace().collect::<Vec<_>>().join(" ");
    let told = "; bus mean 16.44 A, 12 A back in braking;";
    assert!(check.contains(told), "{check}");
}
