//! `hexagen compare --robustness`: what is called what, the same plant as `simulate`, and colours only where wanted.

use crate::support::{PAPER, hexagen, keys, number, run};
use hexagen_lab::engine::MotorSource;
use serde_json::Value;
use std::process::Output;

/// The controller that believes each period's EMF as it is: stable from 79 to 126 % of the inductance.
const HASTY: &str = "pdcc:emf_filter=1";

/// That controller from one start.
const SHEET: [&str; 7] = [
    "compare",
    PAPER,
    "--robustness",
    "--controller",
    HASTY,
    "--start-angle",
    "0.1rad",
];

fn cells(sheet: &Value) -> &Vec<Value> {
    sheet["controllers"][0]["cells"].as_array().expect("a list")
}

fn cell<'s>(sheet: &'s Value, disturbance: &str, rpm: f64) -> &'s Value {
    let mut cells = cells(sheet).iter();
    cells
        .find(|cell| cell["disturbance"] == disturbance && (number(cell, "rpm") - rpm).abs() < 1e-6)
        .unwrap_or_else(|| panic!("no {disturbance} at {rpm} rpm"))
}

#[test]
fn the_sheet_tells_disturbed_loops_from_oscillating_ones() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sheet.csv");
    let path = path.to_str().expect("a plain path");
    let sheet = run(SHEET.iter().chain(&["--json", "--csv", path])).json();
    assert_eq!(
        keys(&sheet),
        ["controllers", "disturbances", "motor", "speeds_rpm"]
    );
    let names: Vec<&str> = sheet["disturbances"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|name| name.as_str().expect("a text"))
        .collect();
    assert_eq!(
        names,
        [
            "none",
            "R x 0.5",
            "R x 2",
            "L x 0.75",
            "L x 1.3",
            "k_b x 0.8",
            "k_b x 1.2",
            "bus -15 %",
            "dead time 500 ns",
            "dead time 1 us",
            "dead time 2 us",
            "Hall -5 deg",
            "Hall +5 deg",
            "Hall +5, -5, 0 deg",
            "10-bit ADC, 200 mA off",
            "12-bit ADC, 200 mA off",
            "current sensors 2 % apart",
            "ADC noise 1 count rms",
        ]
    );
    assert_eq!(cells(&sheet).len(), 2 * names.len());
    for rpm in [400.0, 1500.0] {
        for name in names.iter().copied() {
            let outcome = if name.starts_with('L') {
                "oscillates"
            } else {
                "runs"
            };
            let cell = cell(&sheet, name, rpm);
            assert_eq!(cell["outcome"], outcome, "{name} at {rpm} rpm: {cell}");
            assert_eq!(cell["heat"] == "broken", outcome != "runs", "{cell}");
            assert_eq!(cell["refused"], Value::Null);
        }
        let of = |name: &str, key: &str| number(cell(&sheet, name, rpm), key);
        // The same current gives torque in proportion to the EMF constant.
        for (name, factor) in [("k_b x 0.8", 0.8), ("none", 1.0), ("k_b x 1.2", 1.2)] {
            let expected = of(name, "expected_torque_nm");
            assert!((expected - 3.3 * factor).abs() < 1e-9, "{name}: {expected}");
            let held = of(name, "mean_torque_nm") / expected;
            assert!((held - 1.0).abs() < 0.03, "{name} at {rpm} rpm: {held}");
        }
        assert!(of("dead time 2 us", "ripple_rms_pct") > 1.2 * of("none", "ripple_rms_pct"));
    }
    assert_eq!(cell(&sheet, "none", 400.0)["heat"], "none");
    assert_eq!(cell(&sheet, "none", 400.0)["engine"], "interpreter");

    let file = std::fs::read_to_string(path).expect("was written");
    let mut rows = csv::Reader::from_reader(file.as_bytes());
    let header = rows.headers().expect("a header").clone();
    let rows: Vec<csv::StringRecord> = rows.records().collect::<Result<_, _>>().expect("rows");
    assert_eq!(rows.len(), cells(&sheet).len());
    let column = |name: &str| {
        header
            .iter()
            .position(|known| known == name)
            .expect("is there")
    };
    for (row, cell) in rows.iter().zip(cells(&sheet)) {
        assert_eq!(cell["disturbance"], row[column("disturbance")]);
        assert_eq!(cell["outcome"], row[column("outcome")]);
        let torque: f64 = row[column("mean_torque_nm")].parse().expect("a number");
        let in_json = number(cell, "mean_torque_nm");
        assert!((torque / in_json - 1.0).abs() < 1e-12, "{torque} {in_json}");
    }
}

#[test]
fn no_default_controller_that_modulates_oscillates_under_any_disturbance() {
    for controller in ["pdcc", "pi-pwm"] {
        let options = [
            "--robustness",
            "--controller",
            controller,
            "--start-angle",
            "0.1rad",
        ];
        let sheet = run(["compare", PAPER, "--json"].iter().chain(&options)).json();
        for cell in cells(&sheet) {
            assert_eq!(cell["outcome"], "runs", "{controller}: {cell}");
            let is_built_in = !cell["disturbance"]
                .as_str()
                .expect("a name")
                .starts_with("10-bit");
            assert_eq!(cell["engine"] == "compiled", is_built_in, "{cell}");
        }
    }
}

#[test]
fn a_disturbed_plant_is_the_one_that_simulate_has() {
    // Options that all plants have in common are kept: here a bus voltage.
    let sheet = run(SHEET.iter().chain(&["--json", "--v-bus", "46V"])).json();
    for (name, options) in [
        ("none", &["--v-bus", "46V"][..]),
        ("L x 1.3", &["--v-bus", "46V", "--scale-l", "1.3"]),
        ("bus -15 %", &["--v-bus", "39.1V"]),
        ("dead time 1 us", &["--v-bus", "46V", "--dead-time", "1us"]),
        (
            "Hall +5, -5, 0 deg",
            &["--v-bus", "46V", "--hall-error", "5deg,-5deg,0"],
        ),
        (
            "10-bit ADC, 200 mA off",
            &["--v-bus", "46V", "--adc-bits", "10", "--adc-offset", "0.2A"],
        ),
        (
            "current sensors 2 % apart",
            &["--v-bus", "46V", "--scale-adc", "1.01,0.99"],
        ),
        (
            "ADC noise 1 count rms",
            &["--v-bus", "46V", "--adc-noise", "1"],
        ),
    ] {
        let simulated = ["simulate", PAPER, "--rpm", "1500", "--controller", HASTY];
        let rest = ["--start-angle", "0.1rad", "--json"];
        let simulated = run(simulated.iter().chain(&rest).chain(options)).json();
        let cell = cell(&sheet, name, 1500.0);
        // The speeds differ in their last bits, and with them the rounding of single samples.
        for (key, tolerance) in [("mean_torque_nm", 1e-4), ("ripple_rms_pct", 0.02)] {
            let (of_sheet, alone) = (number(cell, key), number(&simulated, key));
            assert!(
                (of_sheet / alone - 1.0).abs() < tolerance,
                "{name}, {key}: {of_sheet} {alone}"
            );
        }
    }
}

/// On a board that converts one current after the other this is part of every plant; the sheet says what it costs.
#[test]
fn conversions_one_after_the_other_are_compared_with_both_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one-adc.toml");
    let motor = MotorSource::of_library(PAPER).expect("is in the library");
    let sensing = "current_sensing = \"low_side\"\nsettling_time = \"1 us\"\naperture_time = \"200 ns\"\n\
                   conversion_time = \"1 us\"\n";
    let text = motor
        .text
        .replacen("current_sensing = \"in_phase\"\n", sensing, 1);
    std::fs::write(&path, text).expect("can be written");
    let path = path.to_str().expect("a plain path");
    let options = ["--controller", "pdcc", "--start-angle", "0.1rad", "--json"];
    let sheet = run(["compare", path, "--robustness"].iter().chain(&options)).json();
    for rpm in [400.0, 1500.0] {
        let one_by_one = cell(&sheet, "none", rpm);
        let at_once = cell(&sheet, "both currents at once", rpm);
        assert_eq!(one_by_one["outcome"], "runs", "{one_by_one}");
        assert_ne!(one_by_one["mean_torque_nm"], at_once["mean_torque_nm"]);
    }
}

#[test]
fn a_drive_that_trips_says_so_in_its_cell() {
    let options = ["--scale-l", "0.3", "--json"];
    let sheet = run(SHEET.iter().chain(&options)).json();
    let cell = cell(&sheet, "L x 0.75", 1500.0);
    assert_eq!(cell["outcome"], "trips", "{cell}");
    assert_eq!(cell["tripped"]["fault"], "over_current");
    for figure in [
        "mean_torque_nm",
        "ripple_pp_pct",
        "ripple_rms_pct",
        "swing_voltage_pct",
    ] {
        assert!(keys(cell).contains(&figure), "{cell}");
        assert_eq!(cell[figure], Value::Null, "{figure}: {cell}");
    }
}

#[test]
fn colours_are_for_terminals_and_for_those_who_ask() {
    let shown = |name: &str, value: &str| -> String {
        let mut program = hexagen();
        for variable in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
            program.env_remove(variable);
        }
        let output: Output = program
            .args(SHEET)
            .env(name, value)
            .output()
            .expect("the program starts");
        assert!(output.status.success());
        String::from_utf8(output.stdout).expect("text")
    };
    let piped = shown("CLICOLOR", "1");
    assert!(!piped.contains('\u{1b}'), "{piped}");
    for part in [
        "400 rpm:",
        "1500 rpm:",
        "| L x 0.75",
        "oscillates |",
        "mean torque in Nm",
        "colour",
        "A run oscillates if",
    ] {
        assert!(piped.contains(part), "no `{part}` in\n{piped}");
    }
    let forced = shown("CLICOLOR_FORCE", "1");
    assert!(forced.contains("\u{1b}[48;5;124m"), "{forced}");
    let plain: String = strip(&forced);
    assert_eq!(plain, piped);
}

#[test]
fn no_color_wins_over_force() {
    let output = hexagen()
        .args(SHEET)
        .env("NO_COLOR", "1")
        .env("CLICOLOR_FORCE", "1")
        .output();
    let stdout = output.expect("the program starts").stdout;
    assert!(!stdout.contains(&0x1b));
}

/// Text without escape sequences.
fn strip(text: &str) -> String {
    let mut parts = text.split('\u{1b}');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |plain, part| {
        plain + part.split_once('m').map_or("", |(_, rest)| rest)
    })
}

#[test]
fn a_controller_that_does_not_generate_is_told_beside_the_others() {
    // One vector moves this motor's current by more than its rated current.
    let said = run([
        "compare",
        "odrive-d6374-150kv",
        "--robustness",
        "--start-angle",
        "0.1rad",
        "--json",
    ]);
    let sheet = said.json();
    for column in sheet["controllers"].as_array().expect("a list") {
        let count = column["cells"].as_array().expect("a list").len();
        let is_refused = column["refused"].is_string();
        assert_eq!(count == 0, is_refused, "{column}");
        let chooses = ["fcs-mpc", "phcc"]
            .iter()
            .any(|kind| column["controller"] == *kind);
        assert_eq!(chooses, is_refused, "{}", column["controller"]);
    }
}
