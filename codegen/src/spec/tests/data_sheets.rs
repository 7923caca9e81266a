//! Specifications as data sheets word them, in the macro and in files: every unit and word of both,
//! and motors as a newcomer copies them.

use super::diagnostics::{COMPLETE, COMPLETE_CALL, changed};
use crate::diagnostics::Code;
use crate::pipeline::warnings;
use crate::spec::units::Unit;
use crate::spec::{MotorSpec, Spec, check, parse_macro, parse_toml};
use std::f64::consts::PI;

fn of_file(text: &str) -> Spec {
    let checked = parse_toml(text, "hub.toml").and_then(|ast| check(&ast));
    checked
        .unwrap_or_else(|errors| panic!("{errors}\n{text}"))
        .0
}

fn of_call(text: &str) -> Spec {
    let input = parse_macro(text.parse().expect("lexes")).expect("has the shape of a call");
    let checked = check(&input.ast);
    checked
        .unwrap_or_else(|errors| panic!("{errors}\n{text}"))
        .0
}

/// The specification after a delta, which both front ends must agree on.
fn both(section: &str, field: &str, value: &str) -> Spec {
    let file = COMPLETE
        .lines()
        .filter(|line| !line.starts_with(&format!("{field} =")))
        .map(|line| match line {
            line if line == format!("[{section}]") => format!("{line}\n{field} = \"{value}\""),
            line => line.to_owned(),
        });
    let from_file = of_file(&file.collect::<Vec<_>>().join("\n"));
    let is_there = COMPLETE_CALL.contains(&format!("        {field}:"));
    let delta = if is_there {
        format!("{field}: {value}")
    } else {
        format!("+{section} {field}: {value}")
    };
    let call = changed(COMPLETE_CALL, "-rated_torque");
    let from_call = of_call(&changed(&call, &delta));
    assert_eq!(
        from_call.motor,
        without_torque(from_file.motor.clone()),
        "{value}"
    );
    assert_eq!(from_call.inverter, from_file.inverter, "{value}");
    assert_eq!(from_call.controller, from_file.controller, "{value}");
    from_file
}

fn without_torque(motor: MotorSpec) -> MotorSpec {
    MotorSpec {
        rated_torque: None,
        ..motor
    }
}

#[track_caller]
fn near(got: f64, expected: f64) {
    assert!((got / expected - 1.0).abs() < 2e-6, "{got} for {expected}");
}

#[test]
fn every_word_of_a_basis_is_read_by_both_front_ends() {
    for word in ["per_phase", "per-phase", "per phase", "Per-Phase"] {
        near(
            both("motor", "resistance", &format!("135 mohm {word}"))
                .motor
                .resistance,
            0.135,
        );
    }
    for word in [
        "line_to_line",
        "line-to-line",
        "line to line",
        "line-line",
        "l-l",
        "LL",
        "phase_to_phase",
        "phase-to-phase",
        "phase to phase",
        "phase-phase",
        "terminal",
        "terminal-to-terminal",
        "Terminal",
        "lead-to-lead",
    ] {
        near(
            both("motor", "resistance", &format!("0.27 ohms {word}"))
                .motor
                .resistance,
            0.135,
        );
        near(
            both("motor", "inductance", &format!("0.44 mH {word}"))
                .motor
                .inductance,
            0.22e-3,
        );
    }
}

/// Makers of outrunners print slots and poles in one word.
#[test]
fn slots_and_poles_say_the_pole_pairs() {
    let text = COMPLETE.replace("pole_pairs = 4", "poles = \"12N14P\"");
    assert_eq!(of_file(&text).motor.pole_pairs, 7);
    let call = changed(COMPLETE_CALL, "-pole_pairs; +motor poles: 12N14P");
    assert_eq!(of_call(&call).motor.pole_pairs, 7);
    // In the other order.
    let call = changed(COMPLETE_CALL, "-pole_pairs; +motor poles: 20P18N");
    assert_eq!(of_call(&call).motor.pole_pairs, 10);
    for wrong in [
        "12N", "N14P", "12N14", "12N14P2", "xN14P", "14P", "14PN", "0N14P",
    ] {
        let text = COMPLETE.replace("pole_pairs = 4", &format!("poles = \"{wrong}\""));
        let read = parse_toml(&text, "motor.toml").and_then(|ast| check(&ast));
        assert!(read.is_err(), "{wrong}");
    }
}

/// One EMF, in every unit and basis; the phase constant of the paper's motor is 0.0824 V s/rad.
#[test]
fn every_unit_of_an_emf_is_read_by_both_front_ends() {
    let phase = 0.0824;
    let per_krpm = phase * 1000.0 * PI / 30.0;
    let trapezoid_rms = (7.0_f64 / 9.0).sqrt();
    for (value, unit) in [
        (2.0 * phase, "V/(rad/s) line_to_line peak"),
        (2.0 * phase, "V s/rad terminal peak"),
        (2.0 * phase, "V-s/rad l-l pk"),
        (2000.0 * phase, "mV s/rad line-to-line peak"),
        (2.0 * per_krpm, "V/krpm line-to-line peak"),
        (2.0 * per_krpm, "V/1000rpm phase-to-phase peak"),
        (2.0 * per_krpm, "V/1000 RPM phase-to-phase amplitude"),
        (2.0 * per_krpm, "Vpk/kRPM line-to-line"),
        (2.0 * per_krpm, "Vpeak/krpm line-to-line"),
        (2.0 * per_krpm, "mV/rpm terminal peak"),
        (2.0 * per_krpm, "mV/min-1 terminal peak"),
        (2.0 * per_krpm, "V/(1000 min-1) terminal peak"),
        (2.0 * per_krpm, "V/krpm block_mean"),
        (2.0 * per_krpm, "V/krpm block-mean line-to-line"),
        (4.0 * per_krpm, "V/krpm line-to-line peak-to-peak"),
        (0.8 * per_krpm, "Vpp/200rpm line-to-line"),
        (2.0 * per_krpm, "V/krpm phase p-p"),
        (per_krpm, "V/krpm phase peak"),
        (per_krpm, "V/krpm per-phase peak"),
        (per_krpm * trapezoid_rms, "Vrms/krpm phase"),
        (per_krpm * (20.0_f64 / 9.0).sqrt(), "Vrms/krpm line-to-line"),
        (
            per_krpm * (20.0_f64 / 9.0).sqrt(),
            "V/krpm line_to_line rms",
        ),
        (phase / 4.0 * 1000.0, "mWb"),
        (phase / 4.0 * 2.0 * PI, "V/Hz"),
        (30.0 / PI / (2.0 * phase), "rpm/V peak"),
        (30.0 / PI / (2.0 * phase), "min-1/V peak"),
        (30.0 / PI / (2.0 * phase), "min^-1/V peak"),
        (1.0 / (2.0 * phase), "(rad/s)/V peak"),
    ] {
        let spec = both("motor", "back_emf", &format!("{value:.9} {unit}"));
        near(spec.motor.emf_constant, phase);
    }
}

/// Torque constants stand in place of the EMF, and speed constants too.
#[test]
fn torque_and_speed_constants_state_the_emf() {
    let phase = 0.0824;
    for shape in ["trapezoidal", "sinusoidal"] {
        let is_sine = shape == "sinusoidal";
        let block = if is_sine { 27_f64.sqrt() / PI } else { 2.0 };
        let per_peak = if is_sine { 1.5 } else { 2.0 };
        let per_rms = if is_sine {
            1.5 * 2_f64.sqrt()
        } else {
            2.0 * 1.5_f64.sqrt()
        };
        let line_peak = if is_sine { 3_f64.sqrt() } else { 2.0 };
        for (field, value, unit) in [
            ("torque_constant", block * phase, "Nm/A block_mean"),
            ("torque_constant", block * phase * 1e3, "mNm/A block-mean"),
            (
                "torque_constant",
                block * phase / 0.007_061_551_8,
                "oz-in/A block_mean",
            ),
            (
                "torque_constant",
                block * phase / 1.355_817_9,
                "lb-ft/A block_mean",
            ),
            (
                "torque_constant",
                block * phase / 0.098_066_5,
                "kgf cm/A block_mean",
            ),
            ("torque_constant", per_peak * phase, "Nm/A per_peak_ampere"),
            ("torque_constant", per_peak * phase, "Nm/Apk"),
            ("torque_constant", per_rms * phase, "N m/A per_rms_ampere"),
            ("torque_constant", per_rms * phase, "Nm/Arms"),
            (
                "speed_constant",
                30.0 / PI / (line_peak * phase),
                "rpm/V peak",
            ),
            (
                "speed_constant",
                30.0 / PI / (line_peak * phase),
                "RPM/V line-line peak",
            ),
            (
                "speed_constant",
                30.0 / PI / (2.0 * line_peak * phase),
                "rpm/Vpp",
            ),
            (
                "speed_constant",
                30.0 / PI / (line_peak * phase),
                "min-1/V amplitude",
            ),
            (
                "speed_constant",
                30.0 / PI / (block * phase),
                "rpm/V block_mean",
            ),
            (
                "speed_constant",
                30.0 / PI / (block * phase),
                "KV block_mean",
            ),
            ("speed_constant", 30.0 / PI / (line_peak * phase), "kV peak"),
            (
                "back_emf",
                30.0 / PI / (line_peak * phase),
                "Kv line_to_line peak",
            ),
        ] {
            let emf = "back_emf = \"0.1648 V/(rad/s) line_to_line peak\"";
            let text = COMPLETE
                .replace(emf, &format!("{field} = \"{value:.9} {unit}\""))
                .replace("trapezoidal", shape);
            near(of_file(&text).motor.emf_constant, phase);
            let call = changed(COMPLETE_CALL, "-rated_torque; -back_emf");
            let call = changed(&call, &format!("+motor {field}: {value:.9} {unit}"));
            let call = call.replace("trapezoidal", shape);
            near(of_call(&call).motor.emf_constant, phase);
        }
    }
}

#[test]
fn units_of_speed_torque_inertia_and_current_are_read_by_both_front_ends() {
    for unit in ["rpm", "RPM", "min-1", "1/min", "/min", "r/min", "rev/min"] {
        near(
            both("motor", "rated_speed", &format!("2000 {unit}"))
                .motor
                .rated_speed,
            209.439_51,
        );
    }
    for (value, unit) in [
        (24.0, "g cm2"),
        (24.0, "g-cm2"),
        (0.024, "kg cm2"),
        (2400.0, "g mm2"),
        (0.000_339_868_7, "oz-in-s2"),
        (0.000_339_868_7, "oz-in-s^2"),
        (0.131_219_4, "oz-in2"),
        (2.124_179e-5, "lb-in-s2"),
    ] {
        let inertia = both("motor", "inertia", &format!("{value} {unit}"))
            .motor
            .inertia;
        near(inertia.expect("is given"), 2.4e-6);
    }
    for unit in ["mA/count", "mA/LSB", "mA/lsb"] {
        let gain = format!("adc_gain = \"19.5 {unit}\"");
        let from_file = of_file(&COMPLETE.replace("adc_range = \"40 A\"", &gain));
        let call = changed(COMPLETE_CALL, "-adc_range");
        let from_call = of_call(&changed(&call, &format!("+inverter adc_gain: 19.5 {unit}")));
        assert_eq!(from_call.inverter, from_file.inverter);
        near(from_call.inverter.adc_gain, 0.0195);
    }
    // So much heats as the block wave of this peak, which is off for a third of the turn.
    near(
        both("motor", "rated_current", "16.329931619 Arms")
            .motor
            .rated_current,
        20.0,
    );
    near(
        both("motor", "rated_current", "16.329931619 A rms")
            .motor
            .rated_current,
        20.0,
    );
    near(
        both("motor", "rated_current", "20 Apk").motor.rated_current,
        20.0,
    );
    let text = COMPLETE.replace(
        "rated_current",
        "rated_torque = \"29.206 lb-in\"\nrated_current",
    );
    near(
        of_file(&text).motor.rated_torque.expect("is given"),
        3.299_83,
    );
}

#[test]
fn words_and_flags_of_data_sheets_are_read() {
    for winding in ["star", "wye", "Y", "Wye", "Star"] {
        both("motor", "winding", winding);
    }
    for shape in ["sinusoidal", "sine", "Sine"] {
        let spec = both("motor", "emf_shape", shape);
        near(spec.motor.emf_constant, 0.1648 / 3_f64.sqrt());
    }
    for (flag, sign) in [("true", -1.0), ("on", -1.0), ("false", 1.0), ("off", 1.0)] {
        let spec = both("inverter", "adc_inverted", flag);
        assert_eq!(spec.inverter.adc_gain.signum(), sign);
    }
    let text = COMPLETE.replace("[inverter]", "[inverter]\nadc_inverted = true");
    assert!(of_file(&text).inverter.adc_gain < 0.0);
    let poles = of_file(&COMPLETE.replace("pole_pairs = 4", "poles = 16"));
    assert_eq!(poles.motor.pole_pairs, 8);
    let call = COMPLETE_CALL.replace("pole_pairs: 4", "poles: 16");
    assert_eq!(of_call(&call).motor.pole_pairs, 8);
    let text = COMPLETE.replace("\"pdcc\"", "\"pdcc\"\nmodulation = \"three-phase\"");
    of_file(&text);
    // A winding says nothing where every value lies between terminals.
    let text = COMPLETE
        .replace("winding = \"star\"\n", "")
        .replace("135 mohm per_phase", "270 mohm terminal")
        .replace("0.22 mH per_phase", "0.44 mH terminal");
    near(of_file(&text).motor.resistance, 0.135);
}

/// Whatever unit a value is printed in, it reads back, to the last bit.
#[test]
fn a_value_that_is_printed_reads_back() {
    let mut random = fastrand::Rng::with_seed(24);
    for spelling in crate::spec::units::usual_spellings() {
        let unit = Unit::from_symbol(spelling).expect("is a unit");
        let field = crate::spec::fields::field_of(unit.dimension);
        let field = crate::spec::fields::field(field);
        for _ in 0..50 {
            let value = random.f64() * 10_f64.powi(random.i32(-6..7));
            let written = format!("{value} {spelling}");
            let at = crate::diagnostics::Location::in_file("t", "", 0);
            let read = crate::spec::value::parse_value(field, &written, &at);
            assert_eq!(read.to_string(), written);
            let crate::spec::ast::Value::Number(number) = &read else {
                panic!("{written} is no number");
            };
            assert_eq!(number.si(), unit.to_si(value), "{written}");
            let again = crate::spec::value::parse_value(field, &read.to_string(), &at);
            assert_eq!(again, read);
        }
    }
}

/// A file as a newcomer writes it, with the fields of the sheet.
fn newcomer(motor: &str, voltage: u32, range: u32) -> String {
    format!(
        "[motor]\n{motor}\n[inverter]\nbus_voltage = \"{voltage} V\"\nf_pwm = \"20 kHz\"\n\
         timer_clock = \"170 MHz\"\nadc_bits = 12\nadc_range = \"{range} A\"\n\
         current_sensing = \"in_phase\"\n\
         dead_time = \"300 ns\"\n[controller]\nkind = \"pdcc\"\n"
    )
}

/// Maxon's EC 45 flat of 70 W and 24 V, with the words of its catalogue. Torque and speed constant
/// are one number there: means over block commutation.
const EC_45: &str = r#"pole_pairs = 8
resistance = "0.573 ohm phase to phase"
inductance = "0.301 mH phase to phase"
torque_constant = "40.4 mNm/A block_mean"
speed_constant = "236 rpm/V block_mean"
emf_shape = "sine"
rated_current = "3.29 A peak"
rated_torque = "134 mNm"
rated_speed = "4750 rpm"
no_load_speed = "5600 rpm"
inertia = "181 gcm2""#;

#[test]
fn a_flat_motor_as_its_catalogue_words_it() {
    let motor = of_file(&newcomer(EC_45, 24, 8)).motor;
    near(motor.resistance, 0.2865);
    near(motor.inductance, 0.1505e-3);
    near(motor.inertia.expect("is given"), 1.81e-5);
    // Peak = printed x pi/3 between two lines, and 1/sqrt(3) of it in a phase.
    let printed = 1.0 / (236.0 * PI / 30.0);
    near(motor.emf_constant, printed * PI / 3.0 / 3_f64.sqrt());
    // What the motor needs at its no-load speed is the 24 V, but for friction: 3 V of EMF less.
    let line_mean = printed * 5600.0 * PI / 30.0;
    assert!((line_mean / 24.0 - 1.0).abs() < 0.02, "{line_mean}");
    // Without its words, the two agree only as what they are.
    let is_warned = |text: &str| {
        let ast = parse_toml(&newcomer(text, 24, 8), "ec45.toml").expect("is TOML");
        let (spec, origins) = check(&ast).expect("passes");
        let warnings = warnings(&spec, &origins, &[]);
        let mut codes = warnings.iter().map(|warning| warning.code);
        (
            codes.any(|code| code == Code::BasisByAgreement),
            spec.motor.emf_constant,
        )
    };
    let (warned, constant) = is_warned(&EC_45.replace(" block_mean", ""));
    assert!(warned);
    near(constant, motor.emf_constant);
    let of_peak = EC_45
        .replace("mNm/A block_mean", "mNm/A per_peak_ampere")
        .replace("rpm/V block_mean", "rpm/V");
    let ast = parse_toml(&newcomer(&of_peak, 24, 8), "ec45.toml").expect("is TOML");
    let told = check(&ast).expect_err("13 % apart").to_string();
    assert!(told.contains("HX0318"), "{told}");
    // The constant that states its basis is taken.
    let (warned, constant) = is_warned(&EC_45.replace("rpm/V block_mean", "rpm/V"));
    assert!(!warned);
    near(constant, 40.4e-3 * PI / 3.0 / 3_f64.sqrt());
}

/// Two constants of which none says its basis: one reading is taken, several and none are refused.
#[test]
fn constants_without_basis_are_taken_only_where_one_reading_fits() {
    let told = |torque: f64, shape: &str| {
        // 236 rpm/V are 40.46 mV/(rad/s).
        let text = format!(
            "pole_pairs = 8\nresistance = \"0.573 ohm terminal\"\ninductance = \"0.301 mH terminal\"\n\
             speed_constant = \"236 rpm/V\"\ntorque_constant = \"{} mNm/A\"\nemf_shape = \"{shape}\"\n\
             rated_current = \"3.29 A peak\"\nrated_speed = \"1000 rpm\"",
            40.463 * torque
        );
        let ast = parse_toml(&newcomer(&text, 24, 8), "ec45.toml").expect("is TOML");
        match check(&ast) {
            Ok((spec, origins)) => {
                let all = warnings(&spec, &origins, &[]);
                all.iter().map(ToString::to_string).collect::<String>()
            }
            Err(errors) => errors.to_string(),
        }
    };
    let words = |speed: &str, torque: &str| {
        format!("`speed_constant` as `{speed}` and `torque_constant` as `{torque}`")
    };
    // Torque over EMF constant, of a sine, under each pair of readings.
    for (ratio, speed, torque) in [
        (1.0, "block_mean", "block_mean"),
        (0.866, "line_to_line peak", "per_peak_ampere"),
        (1.732, "line_to_line rms", "per_rms_ampere"),
    ] {
        let told = told(ratio, "sine");
        assert!(told.contains("warning[HX0619]"), "{told}");
        assert!(told.contains(&words(speed, torque)), "{told}");
    }
    let several = told(1.2247, "sine");
    assert!(several.contains("error[HX0205]"), "{several}");
    for reading in [
        words("line_to_line peak", "per_rms_ampere"),
        words("line_to_line rms", "per_peak_ampere"),
    ] {
        assert!(several.contains(&reading), "{several}");
    }
    let none = told(3.0, "sine");
    assert!(none.contains("error[HX0205]"), "{none}");
    assert!(none.contains("agree under no reading"), "{none}");
    // What each reading would mean.
    for told in [several, none] {
        assert!(
            told.contains("rms\"` (root mean square between two terminals: "),
            "{told}"
        );
        assert!(told.contains("look up in the data sheet"), "{told}");
    }
    // All that agree mean the same.
    assert_eq!(told(1.0, "trapezoid"), "");
}

/// Teknic's Hudson M-2311P: 8 poles, peak volts between lines, ounce-inches per ampere, which agree
/// with either shape of current within 8 %.
#[test]
fn a_servo_motor_in_ounces_and_inches() {
    let motor = of_file(&newcomer(
        r#"poles = 8
resistance = "0.69 ohms phase to phase"
inductance = "0.733 mH phase to phase"
back_emf = "6.64 Vpeak/kRPM line-to-line"
torque_constant = "8.37 oz-in/A"
emf_shape = "sine"
rated_current = "7.1 A peak"
rated_torque = "60 oz-in"
rated_speed = "3000 RPM""#,
        48,
        20,
    ))
    .motor;
    assert_eq!(motor.pole_pairs, 4);
    near(motor.resistance, 0.345);
    near(motor.emf_constant, 6.64e-3 * 30.0 / PI / 3_f64.sqrt());
    near(motor.rated_torque.expect("is given"), 0.423_693);
}

/// A servo motor whose torque is stated per rms ampere: sqrt(3) times its rms EMF between lines.
#[test]
fn rms_volts_and_rms_amperes_agree() {
    let constants = "back_emf = \"36 Vrms/krpm line-to-line\"\ntorque_constant = \"0.595 Nm/Arms\"";
    let text = format!(
        "poles = 10\nresistance = \"1.3 ohm terminal\"\ninductance = \"4 mH terminal\"\n{constants}\n\
         emf_shape = \"sine\"\nrated_current = \"5 Arms\"\nrated_torque = \"3 Nm\"\nrated_speed = \"3000 rpm\""
    );
    let motor = of_file(&newcomer(&text, 320, 20)).motor;
    near(
        motor.emf_constant,
        36e-3 * 30.0 / PI * 2_f64.sqrt() / 3_f64.sqrt(),
    );
    near(motor.rated_current, 5.0 * 2_f64.sqrt());
    near(3_f64.sqrt() * 36e-3 * 30.0 / PI, 0.595_435_3);
}

/// An outrunner with a kV rating and a hub motor, whose sheets say nothing else of the EMF.
#[test]
fn a_kv_rating_is_enough() {
    let text = "poles = 14\nresistance = \"50.8 mohm terminal\"\ninductance = \"17.46 uH terminal\"\n\
                speed_constant = \"150 rpm/V peak\"\nemf_shape = \"sine\"\nrated_current = \"30 A peak\"\nrated_speed = \"4000 rpm\"";
    let motor = of_file(&newcomer(text, 48, 80)).motor;
    assert_eq!(motor.pole_pairs, 7);
    near(motor.emf_constant, 30.0 / PI / 150.0 / 3_f64.sqrt());
    let text = "poles = 30\nresistance = \"0.4 ohm phase-to-phase\"\ninductance = \"0.6 mH phase-to-phase\"\n\
                speed_constant = \"16 rpm/V peak\"\nemf_shape = \"trapezoid\"\nrated_current = \"10 A peak\"\nrated_speed = \"400 rpm\"";
    let motor = of_file(&newcomer(text, 36, 30)).motor;
    near(motor.emf_constant, 30.0 / PI / 16.0 / 2.0);
    // What a meter shows is no peak.
    for shape in ["sine", "trapezoid"] {
        let text = text
            .replace("rpm/V peak", "rpm/V")
            .replace("trapezoid", shape);
        let parsed = parse_toml(&newcomer(&text, 36, 30), "hub.toml");
        let errors = parsed.and_then(|ast| check(&ast)).expect_err(shape);
        let codes: Vec<Code> = errors.as_slice().iter().map(|error| error.code).collect();
        assert_eq!(codes, [Code::MissingBasis], "{errors}");
    }
}

/// A dozen slips of newcomers: where each is marked, and what it is told.
#[test]
fn slips_are_told_at_the_most_likely_place() {
    let slips = [
        (
            "0.573 ohm phase to phase",
            "0.573 ohm",
            Code::MissingBasis,
            "resistance",
        ),
        (
            "40.4 mNm/A block_mean",
            "40.4 mNm",
            Code::WrongDimension,
            "torque_constant",
        ),
        (
            "40.4 mNm/A block_mean",
            "40.4 Nm/A block_mean",
            Code::TorqueConstantContradiction,
            "torque_constant",
        ),
        (
            "236 rpm/V block_mean",
            "23.6 rpm/V block_mean",
            Code::TorqueContradiction,
            "speed_constant",
        ),
        (
            "5600 rpm",
            "56000 rpm",
            Code::SpeedContradiction,
            "no_load_speed",
        ),
        (
            "134 mNm",
            "1.34 Nm",
            Code::TorqueContradiction,
            "rated_torque",
        ),
        ("\"sine\"", "\"sinus\"", Code::UnknownWord, "emf_shape"),
        ("pole_pairs = 8", "poles = 15", Code::OutOfRange, "poles"),
        (
            "pole_pairs = 8",
            "pole_pairs = 8\npoles = 16",
            Code::ExclusiveFields,
            "poles",
        ),
        ("181 gcm2", "181 gcm", Code::WrongDimension, "inertia"),
        ("4750 rpm", "4750", Code::MissingUnit, "rated_speed"),
        ("3.29 A", "3.29 mA", Code::OutOfRange, "rated_current"),
        ("4750 rpm", "6000 rpm", Code::BusTooLow, "rated_speed"),
    ];
    for (old, new, code, field) in slips {
        assert!(EC_45.contains(old), "{old}");
        let text = newcomer(&EC_45.replacen(old, new, 1), 24, 8);
        let checked = parse_toml(&text, "ec45.toml").and_then(|ast| check(&ast));
        let errors = checked.expect_err(new);
        let [error] = errors.as_slice() else {
            panic!("{new}: {errors}");
        };
        assert_eq!(error.code, code, "{errors}");
        let line = text
            .lines()
            .position(|line| line.starts_with(&format!("{field} =")));
        let line = line.expect("the field is there") + 1;
        let place = format!("ec45.toml:{line}:");
        assert!(errors.to_string().starts_with(&place), "{new}: {errors}");
    }
}

#[test]
fn a_rating_a_little_beyond_the_bus_is_a_warning_with_what_the_bus_allows() {
    let text = newcomer(&EC_45.replacen("4750 rpm", "5300 rpm", 1), 24, 8);
    let ast = parse_toml(&text, "ec45.toml").expect("is read");
    let (spec, origins) = check(&ast).expect("is accepted");
    let told = warnings(&spec, &origins, &[]);
    let told: Vec<String> = told.iter().map(ToString::to_string).collect();
    // No timer captures the edges of this drive.
    let [halls, told] = told.as_slice() else {
        panic!("{told:?}");
    };
    assert!(halls.contains("warning[HX0620]"), "{halls}");
    assert!(
        told.contains("warning[HX0604]: `rated_speed`: 5300 rpm: there the bus of 24 V drives the whole current up to "),
        "{told}"
    );
    assert!(told.contains("; the rating lasts to "), "{told}");
}
