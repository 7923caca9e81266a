//! Errors in motor files: places by file, line and column, and what only files can get wrong.

use crate::spec::{check, parse_toml};

fn errors(text: &str) -> String {
    match parse_toml(text, "motors/hub.toml").and_then(|ast| check(&ast)) {
        Ok(_) => "no error".to_owned(),
        Err(errors) => errors.to_string(),
    }
}

/// A motor file without errors.
pub(super) const COMPLETE: &str = r#"[motor]
pole_pairs = 4
resistance = "135 mohm per_phase"
inductance = "0.22 mH per_phase"
winding = "star"
back_emf = "0.1648 V/(rad/s) line_to_line peak"
emf_shape = "trapezoidal"
rated_current = "20 A"
rated_speed = "2000 rpm"
[inverter]
bus_voltage = "48 V"
f_pwm = "20 kHz"
timer_clock = "72 MHz"
adc_bits = 12
adc_range = "40 A"
[controller]
kind = "pdcc"
"#;

/// Each change of the complete file, and the errors that it makes.
#[test]
fn changes_of_a_complete_file() {
    let cases = [
        ("", "", "no error"),
        (
            "[motor]\n",
            "[motor]\nname = 7\n",
            "motors/hub.toml:2:8: error[HX0208]: `name`: 7, but text is wanted; write it like `\"HubDrive\"`",
        ),
        (
            "[motor]\n",
            "[motor]\ndescription = true\n",
            "motors/hub.toml:2:15: error[HX0208]: `description`: true, but text is wanted; write it like `\"Rear hub drive\"`",
        ),
        (
            "adc_bits = 12\n",
            "adc_bits = 12.0\n",
            "motors/hub.toml:14:12: error[HX0208]: `adc_bits`: 12.0, but a whole number is wanted; write it like `12`",
        ),
        (
            "pole_pairs = 4\n",
            "pole_pairs = 4\npole_pairs = 5\n",
            "motors/hub.toml:3:1: error[HX0104]: `pole_pairs` is given twice; keep one of the two\nmotors/hub.toml:2:1: note: `pole_pairs` is given here first",
        ),
        (
            "[controller]",
            "[motor]\n[controller]",
            "motors/hub.toml:16:2: error[HX0104]: `motor` is given twice; keep one of the two\nmotors/hub.toml:1:2: note: `motor` is given here first",
        ),
        (
            "\"135 mohm per_phase\"",
            "135 mohm",
            "motors/hub.toml:3:14: error[HX0101]: no TOML: string values must be quoted, expected literal string",
        ),
        (
            "135 mohm per_phase",
            "135 mH per_phase",
            "motors/hub.toml:3:14: error[HX0203]: `resistance`: 135 mH per_phase is an inductance, but a resistance is wanted; write it like `135 mohm per_phase`",
        ),
        (
            "135 mohm",
            "1.5 ohm",
            "motors/hub.toml:11:15: error[HX0302]: `bus_voltage`: 48 V, but `rated_current` 20 A at `rated_speed` 2000 rpm take 94.52 V: an EMF of 34.52 V line to line and 2 R I = 60 V; raise the bus to 94.52 V, lower `rated_current` below 16 A, or check the bases of `back_emf` (0.1648 V/(rad/s) line_to_line peak) and `resistance` (1.5 ohm per_phase)\nmotors/hub.toml:9:15: note: `rated_speed` 2000 rpm\nmotors/hub.toml:8:17: note: `rated_current` 20 A\nmotors/hub.toml:6:12: note: `back_emf` 0.1648 V/(rad/s) line_to_line peak\nmotors/hub.toml:3:14: note: `resistance` 1.5 ohm per_phase",
        ),
        (
            "pole_pairs = 4",
            "pole_pairs = 4.0e0\ninductance_tolerance = 0.1",
            "motors/hub.toml:2:14: error[HX0208]: `pole_pairs`: 4.0e0, but a whole number is wanted; write it like `4`\nmotors/hub.toml:3:24: error[HX0204]: `inductance_tolerance`: 0.1 has no unit; write it like `10 %`",
        ),
        (
            "pole_pairs = 4",
            "pole_pairs = 1979-05-27",
            "motors/hub.toml:2:14: error[HX0201]: `pole_pairs`: cannot read `1979-05-27`; write it like `4`",
        ),
        (
            "\"40 A\"",
            "\"40 A\"\nadc_inverted = true",
            "motors/hub.toml:16:16: error[HX0207]: `adc_inverted`: unknown word `true`; it takes `off` or `on`",
        ),
        (
            "[controller]",
            "[controler]",
            "motors/hub.toml:16:2: error[HX0102]: unknown section `controler`; there are `motor`, `inverter`, `controller`, `assumed` and `source`; did you mean `controller`?",
        ),
        (
            "[controller]",
            "[assumed.motor]\nrated_current = { value = \"20 A\", reason = \"x\" }\n[controller]",
            "motors/hub.toml:17:1: error[HX0104]: `rated_current` is given twice; keep one of the two\nmotors/hub.toml:8:1: note: `rated_current` is given here first",
        ),
        (
            "rated_current = \"20 A\"\n",
            "[assumed.motor]\nrated_current = { value = \"20 A\" }\n[inverters]\n[assumed.controller]\nx = 1\n[assumed2]\n",
            "motors/hub.toml:9:1: error[HX0201]: `rated_current`: an assumption needs a value and a reason; write it like `{ value = \"20 A\", reason = \"not in the data sheet\" }`\nmotors/hub.toml:11:10: error[HX0102]: unknown section `controller`; there are `motor` and `inverter`\nmotors/hub.toml:10:2: error[HX0102]: unknown section `inverters`; there are `motor`, `inverter`, `controller`, `assumed` and `source`; did you mean `inverter`?\nmotors/hub.toml:13:2: error[HX0102]: unknown section `assumed2`; there are `motor`, `inverter`, `controller`, `assumed` and `source`; did you mean `assumed`?",
        ),
        (
            "[motor]",
            "assumed = 3\n[motor]",
            "motors/hub.toml:1:1: error[HX0101]: `assumed` is a section; write `[assumed]` and its fields below",
        ),
        (
            "[motor]",
            "[motor]\nname = \"hub drive\"",
            "motors/hub.toml:2:8: error[HX0109]: `name`: \"hub drive\" is no name of a type; use a capital letter first, then letters and digits, for example \"HubDrive\"",
        ),
    ];
    for (old, new, expected) in cases {
        assert_eq!(errors(&COMPLETE.replace(old, new)), expected, "{new}");
    }
}

#[test]
fn an_empty_file_lacks_all_sections() {
    let lines = errors("");
    assert_eq!(lines.matches("error[HX0106]").count(), 3, "{lines}");
}

/// A file that was cut or mangled anywhere gives errors or passes, and never panics.
#[test]
fn mangled_files_never_panic() {
    for position in 0..COMPLETE.len() {
        let without = format!("{}{}", &COMPLETE[..position], &COMPLETE[position + 1..]);
        let doubled = format!("{}{}", &COMPLETE[..=position], &COMPLETE[position..]);
        for text in [&COMPLETE[..position], &without, &doubled] {
            assert!(!errors(text).is_empty());
        }
    }
}
