//! What may stand in a value, and the remedies for what may not: none turns a number into another
//! quantity, and none puts a basis into the mouth of a user who did not name it.

use super::diagnostics::COMPLETE;
use crate::diagnostics::Location;
use crate::spec::{check, load_motor_file, parse_macro, parse_toml};

fn errors(text: &str) -> String {
    match parse_toml(text, "hub.toml").and_then(|ast| check(&ast)) {
        Ok(_) => "no error".to_owned(),
        Err(errors) => errors.to_string(),
    }
}

/// Errors after a change of the complete file.
#[track_caller]
fn changed(old: &str, new: &str) -> String {
    assert!(COMPLETE.contains(old), "{old}");
    errors(&COMPLETE.replacen(old, new, 1))
}

/// Errors of the fields of a motor in the macro.
fn in_macro(fields: &str) -> String {
    let call = format!("pub Hub {{ motor: {{ {fields} }}, inverter: {{}}, controller: pdcc }}");
    let input = parse_macro(call.parse().expect("lexes")).expect("has the shape of a call");
    check(&input.ast).expect_err("lacks fields").to_string()
}

#[test]
fn stray_signs_are_no_part_of_a_quantity() {
    for (value, message) in [
        (
            "20 ^^**\u{b7} A",
            "cannot read `^^**\u{b7}` in `20 ^^**\u{b7} A`; write it like `rated_current = \"20 A peak\"`",
        ),
        (
            "20 A ^",
            "cannot read `^` in `20 A ^`; write it like `rated_current = \"20 A peak\"`",
        ),
        (
            "20 A *",
            "cannot read `*` in `20 A *`; write it like `rated_current = \"20 A peak\"`",
        ),
        (
            "20 * A!",
            "cannot read `*` in `20 * A!`; write it like `rated_current = \"20 A peak\"`",
        ),
        (
            "20 $A",
            "cannot read `$` in `20 $A`; write it like `rated_current = \"20 A peak\"`",
        ),
        (
            "2__0 A",
            "cannot read `2__0 A`; write it like `rated_current = \"20 A peak\"`",
        ),
        (
            "20_ A",
            "cannot read `20_ A`; write it like `rated_current = \"20 A peak\"`",
        ),
    ] {
        let told = changed("\"20 A peak\"", &format!("\"{value}\""));
        assert_eq!(
            told,
            format!("hub.toml:8:17: error[HX0201]: `rated_current`: {message}"),
            "{value}"
        );
    }
    assert_eq!(
        changed("135 mohm per_phase", "135 mohm * per_phase"),
        "hub.toml:3:14: error[HX0201]: `resistance`: cannot read `*` in `135 mohm * per_phase`; write it like `resistance = \"135 mohm per_phase\"`"
    );
    // A product and a power that are written out are units.
    assert_eq!(
        changed("rated_speed", "inertia = \"2.4e-6 kg*m^2\"\nrated_speed"),
        "no error"
    );
}

#[test]
fn numbers_are_decimal() {
    for (old, new, message) in [
        (
            "adc_bits = 12",
            "adc_bits = 0xc",
            "hub.toml:14:12: error[HX0201]: `adc_bits`: cannot read `0xc`; write it like `adc_bits = 12`",
        ),
        (
            "adc_bits = 12",
            "adc_bits = 0b1100",
            "hub.toml:14:12: error[HX0201]: `adc_bits`: cannot read `0b1100`; write it like `adc_bits = 12`",
        ),
        (
            "adc_bits = 12",
            "adc_bits = 0o14",
            "hub.toml:14:12: error[HX0201]: `adc_bits`: cannot read `0o14`; write it like `adc_bits = 12`",
        ),
        (
            "adc_bits = 12",
            "adc_bits = \"0xc\"",
            "hub.toml:14:12: error[HX0201]: `adc_bits`: cannot read `0xc`; write it like `adc_bits = 12`",
        ),
        ("adc_bits = 12", "adc_bits = 1_2", "no error"),
        ("adc_bits = 12", "adc_bits = +12", "no error"),
        (
            "pole_pairs = 4\n",
            "pole_pairs = 4\nhall_codes = [0x1, 5, 4, 6, 2, 3]\n",
            "hub.toml:3:14: error[HX0201]: `hall_codes`: cannot read `[0x1, 5, 4, 6, 2, 3]`; write it like `hall_codes = [1, 5, 4, 6, 2, 3]`",
        ),
        (
            "pole_pairs = 4\n",
            "pole_pairs = 4\nhall_codes = [1, 5, 4, 6, 2, 3]\n",
            "no error",
        ),
    ] {
        assert_eq!(changed(old, new), message, "{new}");
    }
    let told = in_macro("hall_codes: [0b001, 0b101, 4, 6, 2, 3], pole_pairs: 0xc");
    for text in [
        "cannot read `[0b001, 0b101, 4, 6, 2, 3]`",
        "cannot read `0xc`",
    ] {
        assert!(told.contains(text), "{told}");
    }
}

#[test]
fn hall_codes_beyond_the_range_are_named() {
    for (codes, code) in [
        ("[9, 5, 4, 6, 2, 3]", "9"),
        ("[1, 5, 4, 6, 2, 11]", "11"),
        ("[1, 5, 4, 6, 2, 3, 8]", "8"),
        ("[257, 5, 4, 6, 2, 3]", "257"),
    ] {
        let message = format!(
            "`hall_codes`: {codes}: {code} lies outside 0 to 7; give the codes of sectors 1 to 6, each one bit from the next, for example `[1, 5, 4, 6, 2, 3]`, or with sensors 60 degrees apart `[0, 1, 3, 7, 6, 4]`"
        );
        let told = changed(
            "pole_pairs = 4\n",
            &format!("pole_pairs = 4\nhall_codes = {codes}\n"),
        );
        assert_eq!(told, format!("hub.toml:3:14: error[HX0211]: {message}"));
        let told = in_macro(&format!("hall_codes: {codes}"));
        assert!(told.contains(&message), "{told}");
    }
}

/// Characters of each place where a text stands.
#[test]
fn characters_that_compilers_refuse_in_comments_are_refused_here() {
    let directions = ('\u{202a}'..='\u{202e}').chain('\u{2066}'..='\u{2069}');
    let controls = ['\0', '\u{8}', '\u{1b}', '\u{7f}', '\u{9b}'];
    for c in directions.chain(controls) {
        let code = format!("U+{:04X}", u32::from(c));
        let escaped = format!("\\u{:04X}", u32::from(c));
        let told = changed(
            "[motor]\n",
            &format!("[motor]\ndescription = \"Hub {escaped}\"\n"),
        );
        let message = format!(
            "hub.toml:2:15: error[HX0201]: `description`: character 5 of the text is {code} ("
        );
        assert!(told.starts_with(&message), "{told}");
        let told = changed(
            "[controller]",
            &format!("[source]\ntext = \"{escaped}\"\n[controller]"),
        );
        assert!(
            told.contains("`text`: character 1") && told.contains(&code),
            "{told}"
        );
        let reason = format!(
            "[assumed.motor]\ninertia = {{ value = \"1e-5 kg m2\", reason = \"x{escaped}\" }}\n[controller]"
        );
        let told = changed("[controller]", &reason);
        assert!(
            told.contains("`inertia`: character 2") && told.contains(&code),
            "{told}"
        );
        let told = in_macro(&format!("description: \"Hub \\u{{{:x}}}\"", u32::from(c)));
        assert!(
            told.contains("`description`: character 5") && told.contains(&code),
            "{told}"
        );
    }
    // Lines and other scripts are text.
    assert_eq!(
        changed(
            "[motor]\n",
            "[motor]\ndescription = \"\"\"Nabe\n\t\u{5d0}\u{3a9} */ ??/ \\\\\"\"\"\n"
        ),
        "no error"
    );
    assert_eq!(
        changed("[motor]\n", "[motor]\ndescription = \"Hub \\u202E\"\n"),
        "hub.toml:2:15: error[HX0201]: `description`: character 5 of the text is U+202E (right-to-left override), which compilers reject in comments; remove it"
    );
}

#[test]
fn bytes_that_are_no_text_are_told_with_their_place() {
    let folder = std::env::temp_dir().join(format!("hexagen-bytes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    // "é" of an editor that saves in Latin-1.
    std::fs::write(folder.join("hub.toml"), b"[motor]\n# caf\xe9\n").expect("a file");
    let at = Location::in_file("macro", "", 0);
    let told = load_motor_file(&folder, "hub.toml", &at, &mut vec![]);
    std::fs::remove_dir_all(&folder).expect("the folder is ours");
    assert_eq!(
        told.expect_err("is Latin-1").to_string(),
        "hub.toml:2:6: error[HX0108]: the file is not UTF-8: byte 13 is 0xE9; save it as UTF-8"
    );
}

const BOTH: &str =
    r#"`resistance = "135 mohm per_phase"` or `resistance = "135 mohm line_to_line"`"#;
const UNIT: &str = "give a unit such as `mohm`";
const UNIT_OF_BOTH: &str = "give a unit such as `mohm`, with `per_phase` (of one winding) or `line_to_line` (between two terminals)";
const CHOICE: &str = "write `per_phase` (of one winding) or `line_to_line` (between two terminals)";

#[test]
fn no_remedy_offers_a_basis_that_was_not_named() {
    for (value, remedy) in [
        ("135 mohm line", CHOICE.to_owned()),
        ("135 mohm typical", CHOICE.to_owned()),
        ("135 mohm line_to_neutral", CHOICE.to_owned()),
        ("135 mohm phase to", CHOICE.to_owned()),
        (
            "135 mohm",
            r#"write `resistance = "135 mohm per_phase"` (of one winding) or `resistance = "135 mohm line_to_line"` (between two terminals: 67.5 mohm per phase of a star)"#.to_owned(),
        ),
        ("135 mohm phase", "write either `per_phase` or `line_to_line`".to_owned()),
        ("0.135", UNIT_OF_BOTH.to_owned()),
        ("0.135 line_to_line", UNIT.to_owned()),
        ("135 furlong", UNIT_OF_BOTH.to_owned()),
        ("135 furlong terminal", UNIT.to_owned()),
        ("135 furlong line-to-line", UNIT.to_owned()),
        ("135 mH line_to_line", UNIT.to_owned()),
        ("135 mH", UNIT_OF_BOTH.to_owned()),
        ("135 mohm!", format!("write it like {BOTH}")),
        ("0x87 mohm", format!("write it like {BOTH}")),
        ("small", format!("write it like {BOTH}")),
    ] {
        let told = changed("135 mohm per_phase", value);
        assert!(told.ends_with(&format!("; {remedy}")), "{value}: {told}");
        assert_eq!(told.lines().count(), 1, "{told}");
    }
    for (value, remedy) in [
        (
            "17.3 V/krpm typical",
            "write `phase` (of one phase) or `line_to_line` (between two terminals), with `peak` (the amplitude) or `rms`".to_owned(),
        ),
        (
            "12.2 V/krpm rms",
            r#"write `back_emf = "12.2 V/krpm phase rms"` (root mean square of one phase: 264.2 mNm/A in block commutation) or `back_emf = "12.2 V/krpm line_to_line rms"` (root mean square between two terminals: 156.3 mNm/A in block commutation)"#.to_owned(),
        ),
        (
            "17.3 V/krpm phase",
            r#"write `back_emf = "17.3 V/krpm phase peak"` (amplitude of one phase: 330.4 mNm/A in block commutation) or `back_emf = "17.3 V/krpm phase rms"` (root mean square of one phase: 374.6 mNm/A in block commutation)"#.to_owned(),
        ),
        (
            "550 rpm/V phase",
            "a speed constant refers to the voltage between two terminals; give V/krpm with `phase peak` instead".to_owned(),
        ),
        (
            "0.02 Wb line_to_line",
            "a flux linkage refers to the phase; give V/krpm with `line_to_line peak` instead".to_owned(),
        ),
    ] {
        let told = changed("0.1648 V/(rad/s) line_to_line peak", value);
        assert!(told.ends_with(&format!("; {remedy}")), "{value}: {told}");
    }
    // Readings that fit are facts; which one is meant the data sheet says.
    let emf = "\"0.1648 V/(rad/s) line_to_line peak\"";
    for (value, code) in [
        (
            "\"0.0824 V/(rad/s) line_to_line peak\"\nrated_torque = \"3.3 Nm\"".to_owned(),
            "HX0303",
        ),
        (format!("{emf}\nspeed_constant = \"78 rpm/V\""), "HX0318"),
    ] {
        let told = changed(emf, &value);
        let told = told.lines().next().unwrap_or_default();
        assert!(told.contains(code), "{told}");
        assert!(told.contains("; readings that fit: `"), "{told}");
        let remedy = "; look up in the data sheet which is meant, and write that";
        assert!(told.ends_with(remedy), "{told}");
    }
    let told = changed("resistance = \"135 mohm per_phase\"\n", "");
    assert!(
        told.ends_with(&format!("add it, for example {BOTH}")),
        "{told}"
    );
    let assumed = "[assumed.motor]\nresistance = \"135 mohm line_to_line\"\n[inverter]";
    let told = changed("[inverter]", assumed);
    assert!(
        told.contains(
            r#"write it like `resistance = { value = "135 mohm line_to_line", reason = "#
        ),
        "{told}"
    );
}

#[test]
fn poles_are_not_taken_for_pairs_nor_pairs_for_poles() {
    for (given, expected) in [
        (
            "pole_pairs = \"8 poles\"",
            "8 poles are not pairs; write `poles = 8` or `pole_pairs = 4`",
        ),
        (
            "pole_pairs = \"7 poles\"",
            "7 poles are not pairs; write `pole_pairs = 7` if pairs are meant",
        ),
        (
            "poles = \"4 pairs\"",
            "4 pairs are pairs, half of the poles; write `pole_pairs = 4`",
        ),
    ] {
        let told = changed("pole_pairs = 4", given);
        assert!(told.ends_with(expected), "{given}: {told}");
    }
}

#[test]
fn a_voltage_at_a_speed_is_divided_by_it_and_one_at_a_temperature_is_not() {
    let was = "back_emf = \"0.1648 V/(rad/s) line_to_line peak\"";
    for (given, expected) in [
        (
            "3.6 Vpp line_to_line at 200 rpm",
            Some("divide by the speed: `back_emf = \"3.6 Vpp/200 rpm line_to_line\"`"),
        ),
        ("0.1648 V/(rad/s) line_to_line peak at 25 degC", None),
        ("3.6 V at", None),
    ] {
        let told = changed(was, &format!("back_emf = \"{given}\""));
        match expected {
            Some(expected) => assert!(told.ends_with(expected), "{given}: {told}"),
            None => assert!(!told.contains("divide by"), "{given}: {told}"),
        }
    }
}

#[test]
fn nominal_ratings_lead_to_rated_ones() {
    let told = changed("rated_speed = \"2000 rpm\"", "nominal_speed = \"2000 rpm\"");
    let line = told.lines().next().unwrap_or_default();
    let expected = "`motor` has no field `nominal_speed`; did you mean `rated_speed`?";
    assert!(line.ends_with(expected), "{told}");
}

#[test]
fn names_of_data_sheets_lead_to_the_field_and_its_number() {
    let told = changed("pole_pairs = 4", "Pole_Count = 8");
    assert_eq!(
        told,
        "hub.toml:2:1: error[HX0103]: `motor` has no field `Pole_Count`; write `poles = 8`"
    );
    for (name, value, remedy) in [
        ("kv", "550 rpm/V", "write `speed_constant = \"550 rpm/V\"`"),
        ("kv", "550", "write `speed_constant` with the unit `rpm/V`"),
        ("kt", "0.16 Nm/A", "did you mean `torque_constant`?"),
        (
            "emf_constant",
            "0.1648 V/(rad/s) line_to_line peak",
            "did you mean `back_emf`?",
        ),
    ] {
        let told = changed(
            "back_emf = \"0.1648 V/(rad/s) line_to_line peak\"",
            &format!("{name} = \"{value}\""),
        );
        assert_eq!(
            told,
            format!("hub.toml:6:1: error[HX0103]: `motor` has no field `{name}`; {remedy}")
        );
    }
}

#[test]
fn data_of_a_shape_say_which_it_is_and_are_told_shortly() {
    let samples =
        "emf_samples = [0.0, 0.5, 1.0, 0.5, 0.0, -0.5, -1.0, -0.5, 0.0, 0.5, 1.0, 0.5, 0.0]";
    let shape = "emf_shape = \"trapezoidal\"";
    let told = changed(shape, samples);
    assert!(
        told.contains("`emf_shape = \"samples\"` (those of `emf_samples`)"),
        "{told}"
    );
    assert!(!told.contains("sinusoidal"), "{told}");
    let told = changed(shape, "emf_orders = [5, 7]\nemf_amplitudes = [0.1, 0.2]");
    assert!(told.contains("`emf_shape = \"harmonics\"`"), "{told}");
    let told = changed(shape, &format!("{shape}\n{samples}"));
    let begin =
        "`emf_samples`: [0.0, 0.5, 1.0, 0.5, 0.0, -0.5, -1.0, -0\u{2026} has an effect only with";
    assert!(told.contains(begin), "{told}");
    let one = "emf_shape = \"samples\"\nemf_samples = [\"0.5 V\", 1.0]";
    let told = changed(shape, one);
    assert!(
        told.contains("but a plain number is expected; write `0.5`"),
        "{told}"
    );
}
