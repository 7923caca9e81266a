//! Boards: three layers, each error in the file or call that it was written in.

use super::front_ends::macro_input;
use crate::spec::{BOARDS, Origins, Spec, check, parse_board, parse_toml};
use std::path::Path;

const MOTOR: &str = r#"
[motor]
pole_pairs = 4
resistance = "135 mohm per_phase"
inductance = "0.22 mH per_phase"
winding = "star"
back_emf = "0.1648 V/(rad/s) line_to_line peak"
emf_shape = "trapezoidal"
rated_current = "20 A"
rated_torque = "3.3 Nm"
rated_speed = "2000 rpm"
[inverter]
bus_voltage = "48 V"
sampling_time = "50 us"
timer_clock = "72 MHz"
adc_bits = 12
adc_range = "40 A"
current_sensing = "in_phase"
[controller]
kind = "pdcc"
"#;

const BOARD: &str = r#"
[board]
description = "Mine"
[inverter]
bus_min = "10 V"
bus_max = "50 V"
bus_adc_bits = 12
bus_adc_range = "60 V"
f_pwm = "16 kHz"
timer_clock = "170 MHz"
dead_time = "500 ns"
adc_bits = 12
adc_gain = "29 mA/count"
"#;

/// A crate with a motor and a board, in folders of their own; gone when dropped.
struct Folder(std::path::PathBuf);

impl Folder {
    fn new(name: &str, motor: &str, board: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("hexagen-{name}-{}", std::process::id()));
        for (part, file, text) in [
            ("motors", "hub.toml", motor),
            ("boards", "mine.toml", board),
        ] {
            std::fs::create_dir_all(folder.join(part)).expect("creates a folder");
            std::fs::write(folder.join(part).join(file), text).expect("writes a file");
        }
        Self(folder)
    }

    /// The specification of a call, and the files that it rests on.
    fn check(&self, call: &str) -> (Result<(Spec, Origins), String>, Vec<String>) {
        let mut files = vec![];
        let ast = macro_input(call).load(&self.0, &mut files);
        let checked = ast.and_then(|ast| check(&ast));
        (checked.map_err(|errors| errors.to_string()), files)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn a_call_stands_over_its_board_and_that_over_the_motor_file() {
    let folder = Folder::new("layers", MOTOR, BOARD);
    let (checked, files) = folder.check(
        r#"Rear { motor: "motors/hub.toml", board: "boards/mine.toml",
            inverter: { dead_time: 300 ns }, controller: pdcc }"#,
    );
    let (spec, origins) = checked.unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(files, ["boards/mine.toml", "motors/hub.toml"]);
    let inverter = &spec.inverter;
    assert_eq!((inverter.v_bus, inverter.adc_gain), (48.0, 0.029));
    // 5313 counts of 170 MHz, up and down.
    assert_eq!(inverter.timer_period, 5313);
    let at = |path| origins.at(path).to_string();
    assert_eq!(at("inverter.bus_voltage"), "motors/hub.toml:13:15");
    assert_eq!(at("inverter.adc_gain"), "boards/mine.toml:13:12");
    assert!(at("inverter.dead_time").starts_with("macro:"));
}

#[test]
fn a_motor_file_stands_over_the_board_that_it_names() {
    let motor = format!("board = \"../boards/mine.toml\"\n{MOTOR}");
    let folder = Folder::new("named", &motor, BOARD);
    let (checked, files) = folder.check(r#"Rear { motor: "motors/hub.toml" }"#);
    let (spec, origins) = checked.unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(files, ["motors/hub.toml", "motors/../boards/mine.toml"]);
    assert_eq!(
        (spec.inverter.t_s, spec.inverter.timer_period),
        (50e-6, 1800)
    );
    assert_eq!(
        origins.at("inverter.dead_time").to_string(),
        "motors/../boards/mine.toml:11:13"
    );
    // Read as text alone, the file is not at hand.
    let alone = parse_toml(&motor, "hub.toml").and_then(|ast| check(&ast));
    let alone = alone.expect_err("has no board").to_string();
    assert!(
        alone.contains("hub.toml:1:9: error[HX0108]: `board`"),
        "{alone}"
    );
}

/// Sensitivity and reference make one gain together: a call that states one of them keeps the other of its board, and a
/// gain per count replaces both.
#[test]
fn a_call_replaces_a_sensitivity_or_its_reference_alone() {
    let fields = ["adc_gain = \"66 mV/A\"\n", "adc_reference = \"3.3 V\"\n"];
    let [sensor, reference] = fields;
    for (name, stated) in [
        ("sensor-first", [sensor, reference].concat()),
        ("reference-first", [reference, sensor].concat()),
    ] {
        let board = BOARD.replace("adc_gain = \"29 mA/count\"\n", &stated);
        let motor = MOTOR.replace("adc_range = \"40 A\"\n", "");
        let folder = Folder::new(name, &motor, &board);
        for (over, gain) in [
            ("adc_reference: 5 V", 5.0 / 4096.0 / 0.066),
            ("adc_gain: 60 mV/A", 3.3 / 4096.0 / 0.060),
            (
                "adc_reference: 5 V, adc_gain: 60 mV/A",
                5.0 / 4096.0 / 0.060,
            ),
            (
                "adc_gain: 60 mV/A, adc_reference: 5 V",
                5.0 / 4096.0 / 0.060,
            ),
            ("adc_gain: 20 mA/count", 0.02),
        ] {
            let (checked, _) = folder.check(&format!(
                r#"Rear {{ motor: "motors/hub.toml", board: "boards/mine.toml", inverter: {{ {over} }} }}"#
            ));
            let (spec, _) = checked.unwrap_or_else(|errors| panic!("{name}, {over}: {errors}"));
            let found = spec.inverter.adc_gain;
            assert!(
                (found / gain - 1.0).abs() < 1e-12,
                "{name}, {over}: {found}"
            );
        }
    }
}

#[test]
fn errors_point_into_the_board_s_file() {
    let board = BOARD
        .replace("500 ns", "500 nss")
        .replace("[board]", "[motor]");
    let folder = Folder::new("errors", MOTOR, &board);
    let call = r#"Rear { motor: "motors/hub.toml", board: "boards/mine.toml" }"#;
    let text = folder.check(call).0.expect_err("has errors");
    assert!(
        text.contains("boards/mine.toml:2:2: error[HX0102]"),
        "{text}"
    );
    assert!(
        text.contains("boards/mine.toml:11:13: error[HX0202]"),
        "{text}"
    );
}

#[test]
fn a_bus_that_is_not_the_board_s_is_refused_with_both_places() {
    let folder = Folder::new("bus", &MOTOR.replace("48 V", "60 V"), BOARD);
    let call = r#"Rear { motor: "motors/hub.toml", board: "boards/mine.toml" }"#;
    let text = folder.check(call).0.expect_err("the bus is too high");
    assert_eq!(
        text,
        "motors/hub.toml:13:15: error[HX0330]: `bus_voltage`: 60 V is above the board's `bus_max` of 50 V; \
         give the voltage of its supply, state your own `bus_max` with `v_bus = \"measured\"` where that one is of another battery and the parts bear yours, or take another board\n\
         boards/mine.toml:6:11: note: `bus_max` 50 V"
    );
}

/// As the remedy says: limits of the drive's own replace those of the board's battery.
#[test]
fn limits_of_the_drive_replace_those_of_its_board() {
    let told = |bus_voltage: &str, own: &str| {
        let motor = MOTOR.replace("48 V", bus_voltage);
        let motor = motor.replace("2000 rpm", "400 rpm");
        let folder = Folder::new("own-limits", &motor, &BOARD.replace("10 V", "33.7 V"));
        let call = format!(
            "Rear {{ motor: \"motors/hub.toml\", board: \"boards/mine.toml\", inverter: {{ {own} }} }}"
        );
        folder.check(&call).0.err().unwrap_or_default()
    };
    let below = told("24 V", "");
    assert!(
        below.contains("24 V is below the board's `bus_min` of 33.7 V"),
        "{below}"
    );
    assert_eq!(told("24 V", "v_bus: measured, bus_min: 20 V"), "");
    assert_eq!(told("54 V", "v_bus: measured, bus_max: 58 V"), "");
    assert_eq!(
        told("48 V", "v_bus: measured, bus_max: 58 V, over_voltage: 56 V"),
        ""
    );
    // One limit replaces itself alone, and holds.
    let above = told("54 V", "v_bus: measured, bus_min: 20 V");
    assert!(
        above.contains("above the board's `bus_max` of 50 V"),
        "{above}"
    );
    let below = told("24 V", "v_bus: measured, bus_min: 30 V");
    assert!(below.contains("`bus_min`: 30 V"), "{below}");
}

#[test]
fn sensors_that_the_board_does_not_have_are_refused() {
    const LOW_SIDE: &str = "current_sensing = \"low_side\"\nsensed_phases = \"bc\"\nsettling_time = \"1 us\"\naperture_time = \"200 ns\"\nconversion_time = \"0 us\"\n";
    let folder = Folder::new("sensors", MOTOR, &format!("{BOARD}{LOW_SIDE}"));
    let told = |inverter: &str| {
        let call = format!(
            "Rear {{ motor: \"motors/hub.toml\", board: \"boards/mine.toml\", inverter: {{ {inverter} }}, controller: pdcc }}"
        );
        folder.check(&call).0.err().unwrap_or_default()
    };
    assert_eq!(told("sensed_phases: ab"), "");
    for (field, own) in [
        ("sensed_phases: abc", "bc"),
        ("current_sensing: in_phase", "low_side"),
    ] {
        let text = told(field);
        let name = field.split(':').next().expect("a name");
        assert!(text.contains("error[HX0330]"), "{text}");
        assert!(text.contains(&format!("its `{name}` is {own}")), "{text}");
    }
    // What cannot be read says nothing of the board.
    for (field, code) in [
        ("current_sensing: lowside", "HX0207"),
        ("current_sensing: in phase", "HX0201"),
        ("sensed_phases: a b", "HX0201"),
    ] {
        let text = told(field);
        assert!(text.contains(&format!("error[{code}]")), "{text}");
        assert!(!text.contains("HX0330"), "{text}");
    }
}

#[test]
fn of_a_board_that_there_is_not_no_field_is_missing() {
    let motor = format!(
        "board = \"vesc-44\"\n{}",
        MOTOR.replace(
            "adc_bits = 12\nadc_range = \"40 A\"\ncurrent_sensing = \"in_phase\"\n",
            ""
        )
    );
    assert!(!motor.contains("adc_bits"));
    let errors = crate::spec::parse_toml(&motor, "m.toml")
        .and_then(|ast| crate::spec::check(&ast))
        .expect_err("is unknown");
    assert_eq!(errors.as_slice().len(), 1, "{errors}");
    assert!(errors.to_string().contains("vesc-44"), "{errors}");
}

#[test]
fn values_that_the_drive_does_without_are_read() {
    const LOW_SIDE: &str = "current_sensing = \"in_phase\"\n";
    let board = format!("{BOARD}{LOW_SIDE}");
    for (old, new, words) in [
        ("bus_min = \"10 V\"", "bus_min = \"10 A\"", "a current, but"),
        ("bus_max = \"50 V\"", "bus_max = \"1 MV\"", "`bus_max`"),
        ("bus_adc_bits = 12", "bus_adc_bits = 99", "`bus_adc_bits`"),
        (
            LOW_SIDE,
            "current_sensing = \"in_phase\"\nsettling_time = \"1 kg\"\n",
            "`settling_time`",
        ),
    ] {
        let wrong = board.replace(old, new);
        assert_ne!(wrong, board);
        let folder = Folder::new("unread", MOTOR, &wrong);
        let call = r#"Rear { motor: "motors/hub.toml", board: "boards/mine.toml" }"#;
        let text = folder.check(call).0.expect_err("is in error");
        assert!(text.contains(words), "{new}: {text}");
        assert!(!text.contains("no supply fits"), "{new}: {text}");
    }
}

#[test]
fn limits_that_leave_no_bus_voltage_are_told() {
    let exchanged = BOARD.replace("bus_min = \"", "bus_min = \"9");
    let folder = Folder::new("limits", MOTOR, &exchanged);
    let call = r#"Rear { motor: "motors/hub.toml", board: "boards/mine.toml" }"#;
    let text = folder.check(call).0.expect_err("no supply fits");
    assert!(
        text.contains("so that no supply fits it; correct the board's file"),
        "{text}"
    );
}

#[test]
fn an_empty_file_is_no_board() {
    let folder = Folder::new("empty", MOTOR, "");
    let call = r#"Rear { motor: "motors/hub.toml", board: "boards/mine.toml" }"#;
    let text = folder.check(call).0.expect_err("is empty");
    assert!(text.contains("this is no board"), "{text}");
}

#[test]
fn what_a_board_has_and_the_drive_does_without_is_no_error() {
    let folder = Folder::new("measured", MOTOR, BOARD);
    let call = |bus: &str| {
        format!(
            r#"Rear {{ motor: "motors/hub.toml", board: "boards/mine.toml", inverter: {{ {bus} }} }}"#
        )
    };
    assert!(folder.check(&call("")).0.is_ok());
    assert!(folder.check(&call("v_bus: measured")).0.is_ok());
    // Of the call it is one.
    let own = folder
        .check(&call("bus_min: 12 V"))
        .0
        .expect_err("is of no use");
    assert!(own.contains("v_bus: measured"), "{own}");
}

#[test]
fn a_board_that_there_is_not_is_told_by_name() {
    let folder = Folder::new("unknown", MOTOR, BOARD);
    let told = |board: &str| {
        let call = format!(r#"Rear {{ motor: "motors/hub.toml", board: {board} }}"#);
        folder.check(&call).0.expect_err("there is none")
    };
    let text = told("\"vesc4\"");
    assert!(
        text.contains("`board`: the library has no \"vesc4\"; did you mean \"vesc-4\"?"),
        "{text}"
    );
    assert!(told("\"boards/other.toml\"").contains("cannot be read"));
    assert!(told("\"/boards/mine.toml\"").contains("absolute"));
    assert!(told("vesc").contains("in quotes"));
    // A board of the library names itself.
    let text = folder.check(r#"Rear { motor: "motors/hub.toml", board: "st-b-g431b-esc1" }"#);
    let text = text.0.expect_err("25 V are its most");
    assert!(text.contains("board st-b-g431b-esc1:6:11: note"), "{text}");
}

/// No remedy raises the bus above what the board bears, nor names a speed that low-side sensing does not leave.
#[test]
fn remedies_keep_to_the_board() {
    const HUB: &str = "board = \"hoverboard\"\n[motor]\npoles = 30\nresistance = \"0.4 ohm terminal\"\ninductance = \"0.68 mH terminal\"\nback_emf = \"16 rpm/V line_to_line peak\"\nemf_shape = \"trapezoidal\"\nrated_current = \"10 A\"\nrated_speed = \"700 rpm\"\n[inverter]\nbus_voltage = \"36 V\"\n[controller]\nkind = \"pdcc\"\n";
    let told = |text: &str| {
        let checked = crate::spec::parse_toml(text, "hub.toml");
        let checked = checked.and_then(|ast| crate::spec::check(&ast));
        checked.map_err(|errors| errors.to_string())
    };
    let text = told(HUB).expect_err("the EMF alone takes the bus");
    assert!(
        text.contains("HX0302") && !text.contains("raise `bus_voltage`"),
        "{text}"
    );
    assert!(text.contains("lower `rated_speed` below "), "{text}");
    let (spec, origins) = told(&HUB.replace("700 rpm", "540 rpm")).expect("passes");
    let warnings = crate::pipeline::warnings(&spec, &origins, &[]);
    let text: String = warnings.iter().map(ToString::to_string).collect();
    assert!(text.contains("HX0604"), "{text}");
    assert!(!text.contains("raise `bus_voltage`"), "{text}");
}

#[test]
fn a_board_of_a_call_takes_the_place_of_the_motor_file_s() {
    let motor = format!("board = \"vesc-4\"\n{MOTOR}");
    let folder = Folder::new("replaced", &motor, BOARD);
    let call = r#"Rear { motor: "motors/hub.toml", board: "boards/mine.toml" }"#;
    let (checked, files) = folder.check(call);
    let (spec, _) = checked.unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(files, ["boards/mine.toml", "motors/hub.toml"]);
    assert_eq!(spec.inverter.dead_time, 500e-9);
    assert!(Path::new(&files[1]).is_relative());
}

#[test]
fn the_library_is_its_folder() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("boards");
    let files = std::fs::read_dir(folder).expect("the folder of boards");
    let mut names: Vec<String> = files
        .map(|file| file.expect("an entry").file_name())
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    names.sort_unstable();
    let known = BOARDS.map(|board| format!("{}.toml", board.name));
    assert_eq!(names, known);
}

#[test]
fn every_board_reads_and_says_where_its_numbers_are_from() {
    for board in BOARDS {
        let file = parse_board(board.text, board.name).expect("is TOML");
        assert!(
            file.malformed.is_empty(),
            "{}: {:?}",
            board.name,
            file.malformed
        );
        assert!(file.description.is_some(), "{}", board.name);
        for field in &file.inverter.fields {
            let has_source = |key: &str| {
                file.source
                    .iter()
                    .any(|(name, text)| name == key && !text.is_empty())
            };
            assert!(
                field.assumed.is_some() || has_source(&field.name),
                "{}: no source of `{}`",
                board.name,
                field.name
            );
        }
    }
}

#[test]
fn a_board_names_its_core_where_the_drive_names_none() {
    let core = "[controller]\ntarget = \"cortex_m0\"\ncore_clock = \"24 MHz\"\n";
    let folder = Folder::new("core", MOTOR, &format!("{BOARD}{core}"));
    let core_of = |controller: &str| {
        let call = format!(
            "Rear {{ motor: \"motors/hub.toml\", board: \"boards/mine.toml\", controller: {controller} }}"
        );
        let (checked, _) = folder.check(&call);
        let (spec, _) = checked.expect("is right");
        let options = *spec.controller.common();
        (options.core.name(), options.core.clock, options.word)
    };
    assert_eq!(core_of("pdcc"), (Some("cortex_m0"), Some(24e6), 16));
    assert_eq!(core_of("phcc"), (Some("cortex_m0"), Some(24e6), 16));
    // A core of the drive has the clock of the drive, not that of another core.
    let own = core_of("pdcc { target: cortex_m4 }");
    assert_eq!(own, (Some("cortex_m4"), None, 32));
    // A clock alone is that of the board's core.
    let faster = core_of("pdcc { core_clock: 48 MHz }");
    assert_eq!(faster, (Some("cortex_m0"), Some(48e6), 16));
}

/// The gain of sensors that a file states over its board's.
#[test]
fn a_gain_far_from_the_boards_is_warned_of() {
    let told = |adc_gain: &str| {
        let folder = Folder::new("gain", MOTOR, BOARD);
        let call = format!(
            "Rear {{ motor: \"motors/hub.toml\", board: \"boards/mine.toml\", inverter: {{ adc_gain: {adc_gain}, max_current: 20 A }} }}"
        );
        let (checked, _) = folder.check(&call);
        let (_, origins) = checked.expect("is right");
        let told: Vec<String> = origins.warnings().iter().map(ToString::to_string).collect();
        told.join("; ")
    };
    let coarse = told("59 mA/count");
    let follows = "0.4915 times what is asked, and the loop";
    assert!(
        coarse.contains("HX0622") && coarse.contains(follows),
        "{coarse}"
    );
    let fine = told("14 mA/count");
    assert!(fine.contains("2.071 times what is asked"), "{fine}");
    for close in ["57 mA/count", "15 mA/count"] {
        assert!(!told(close).contains("HX0622"), "{close}");
    }
}

#[test]
fn a_board_chooses_no_controller() {
    let text = format!("{BOARD}[controller]\nkind = \"phcc\"\n");
    let board = parse_board(&text, "boards/mine.toml").expect("is TOML");
    let told: Vec<String> = board.malformed.iter().map(ToString::to_string).collect();
    assert_eq!(
        told,
        [
            "boards/mine.toml:15:1: error[HX0107]: a board's `controller` has no field `kind`, only `target` and `core_clock`; move it to a motor's"
        ]
    );
}
