//! `hexagen faults`: what a drive notices of what may break.

use crate::support::{PAPER, keys, number, run};
use serde_json::Value;

fn rows(study: &Value) -> &Vec<Value> {
    study["rows"].as_array().expect("a list")
}

#[test]
fn the_study_is_one_json_object_whose_totals_are_those_of_its_rows() {
    let study = run(["faults", PAPER, "--json"]).json();
    assert_eq!(
        keys(&study),
        [
            "controller",
            "engine",
            "max_current_a",
            "model",
            "motor",
            "over_speed_rpm",
            "points",
            "residual_timeout_s",
            "rows",
            "stall_timeout_s",
            "totals",
            "trip_current_a"
        ]
    );
    assert_eq!(study["engine"], "compiled");
    assert_eq!(study["stall_timeout_s"], Value::Null);
    assert_eq!(study["over_speed_rpm"], Value::Null);
    let is_sound = |row: &&Value| row["part"] == "sound";
    let (sound, broken): (Vec<&Value>, Vec<&Value>) = rows(&study).iter().partition(is_sound);
    let totals = &study["totals"];
    assert_eq!(number(totals, "classes"), broken.len() as f64);
    assert_eq!(number(totals, "sound"), sound.len() as f64);
    for seen in ["always", "sometimes", "never", "untried"] {
        let found = broken.iter().filter(|row| row["seen"] == seen).count();
        assert_eq!(number(totals, seen), found as f64, "{seen}");
    }
    assert!(broken.len() >= 41 && sound.len() >= 8);
    for row in rows(&study) {
        assert_eq!(number(row, "runs"), 8.0, "{row}");
        let causes = row["causes"].as_array().expect("a list");
        let tripped: f64 = causes.iter().map(|cause| number(cause, "runs")).sum();
        assert_eq!(number(row, "tripped"), tripped, "{row}");
        assert_eq!(row["after_ms"].is_null(), tripped == 0.0, "{row}");
        assert_eq!(row["torque_pct"].is_null(), tripped == 8.0, "{row}");
        assert_eq!(row["ripple_pp_pct"].is_null(), tripped == 8.0, "{row}");
        let ratio = number(row, "largest_a") / number(&study, "max_current_a");
        assert!((number(row, "largest_over_max") / ratio - 1.0).abs() < 1e-12);
    }
    let at_end = rows(&study)
        .iter()
        .find(|row| row["fault"] == "current sensor a: stuck at the highest count");
    let at_end = at_end.expect("is tried");
    assert_eq!(
        (&at_end["seen"], number(at_end, "after_ms")),
        (&"always".into(), 0.0)
    );
    assert_eq!(at_end["causes"][0]["cause"], "adc_range");
}

#[test]
fn the_table_says_what_trips_by_what_and_what_follows() {
    let said = run(["faults", PAPER, "--controller", "pi-pwm"]);
    assert_eq!(said.code, 0, "{said:?}");
    for part in [
        "trivedi-keshri-660w, pi-pwm (fixed point): one thing breaks at a time",
        "| what breaks",
        "| current sensor a: gain halved ",
        "| ADC range ",
        "| nothing broken:",
        "| ripple |",
        "50 mohm of switches and cables, until",
        "sound drives that trip: 0 of",
        "Stall detection is off",
        "a comparator of the current on the timer's break input",
        "watchdog on the control interrupt",
    ] {
        assert!(
            said.stdout.contains(part),
            "no `{part}` in\n{}",
            said.stdout
        );
    }
    for line in said.stdout.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
}

#[test]
fn a_trip_where_nothing_is_broken_is_a_false_alarm() {
    // The file says three times the inductance that the motor has: the loop is unstable.
    let options = ["--scale-l", "0.3", "--controller", "pdcc:emf_filter=1"];
    let said = run(["faults", PAPER].iter().chain(&options));
    assert_eq!(said.code, 0, "{said:?}");
    assert!(said.stdout.contains("| false alarm:"), "{}", said.stdout);
    let study = run(["faults", PAPER, "--json"].iter().chain(&options)).json();
    assert!(number(&study["totals"], "false_alarms") > 0.0);
    let untried = rows(&study).iter().filter(|row| row["seen"] == "untried");
    assert_eq!(number(&study["totals"], "untried"), untried.count() as f64);
}

#[test]
fn wrong_input_is_told() {
    for (arguments, texts) in [
        (
            &["faults", "trivedi-keshri"][..],
            &[
                "error: no motor `trivedi-keshri`",
                "did you mean `trivedi-keshri-660w`?",
            ][..],
        ),
        (&["faults"], &["<MOTOR>"]),
        (
            &["faults", PAPER, "--torque", "0"],
            &["--torque 0", "not 0"],
        ),
        (
            &["faults", PAPER, "--inertia", "1kgm2"],
            &["--inertia", "remove it"],
        ),
        (
            &["faults", PAPER, "--controller", "pdcc:advance=9"],
            &["argument `pdcc:advance=9`, character 14"],
        ),
        (&["faults", PAPER, "--scale-l", "1e-9"], &["out of range"]),
    ] {
        run(arguments).assert_bad_input(texts);
    }
}
