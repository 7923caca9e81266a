//! Sensors and their windows, as they are written and as the checks make numbers of them.

use super::diagnostics::COMPLETE;
use crate::spec::{CurrentSensing, InverterSpec, SensedPhases, check, parse_macro, parse_toml};
use proc_macro2::TokenStream;
use std::path::Path;

/// The inverter of a complete motor file with these lines in place of its range.
fn with_lines(lines: &str) -> InverterSpec {
    let complete = if lines.contains("current_sensing") {
        COMPLETE.replace("current_sensing = \"in_phase\"\n", "")
    } else {
        COMPLETE.to_owned()
    };
    let text = complete.replace("adc_range = \"40 A\"", lines);
    let checked = parse_toml(&text, "m.toml").and_then(|ast| check(&ast));
    match checked {
        Ok((spec, _)) => spec.inverter,
        Err(errors) => panic!("{lines}: {errors}"),
    }
}

/// The numbers of the derivation: half of the low time lies before and half behind the turning point, so that the longer
/// part counts twice; a trigger that is shifted into the middle counts both once.
#[test]
fn the_largest_readable_duty_follows_from_the_window() {
    let low_side = |lines: &str| {
        let needed =
            "adc_range = \"40 A\"\ncurrent_sensing = \"low_side\"\naperture_time = \"200 ns\"\n";
        with_lines(&format!("{needed}{lines}\n"))
    };
    for (lines, before, after, top) in [
        // 0.94 of 1800 counts.
        (
            "dead_time = \"500 ns\"\nsettling_time = \"1 us\"\nconversion_time = \"0 us\"",
            1.5e-6,
            0.2e-6,
            1692,
        ),
        // Two conversions of one ADC last longer than the settling: 2 (0.2 + 2.3) us.
        (
            "dead_time = \"500 ns\"\nsettling_time = \"1 us\"\nconversion_time = \"2.3 us\"",
            1.5e-6,
            2.5e-6,
            1620,
        ),
        // The middle of both is 2 us.
        (
            "dead_time = \"500 ns\"\nsettling_time = \"1 us\"\nconversion_time = \"2.3 us\"\nsampling_lead = \"500 ns\"",
            2e-6,
            2e-6,
            1656,
        ),
        // Of three phases two are converted at once.
        (
            "dead_time = \"500 ns\"\nsettling_time = \"1 us\"\nconversion_time = \"2 us\"\nsensed_phases = \"abc\"\ncurrent_adcs = 2",
            1.5e-6,
            2.2e-6,
            // 79.2 counts on either side, rounded up.
            1641,
        ),
    ] {
        let inverter = low_side(lines);
        let window = inverter.window().expect("a window");
        assert!(
            (window.before - before).abs() < 1e-12,
            "{lines}: {window:?}"
        );
        assert!((window.after - after).abs() < 1e-12, "{lines}: {window:?}");
        assert_eq!(inverter.readable_top(), top, "{lines}");
        assert_eq!(inverter.largest_compare(), 1800, "{lines}");
    }
}

/// The sensor of the highest leg need not be read at the end of its period, but at the beginning of the next.
#[test]
fn of_three_sensors_that_of_the_highest_leg_is_spared() {
    let tops = |lines: &str| {
        let inverter = with_lines(&format!(
            "adc_range = \"40 A\"\ncurrent_sensing = \"low_side\"\naperture_time = \"200 ns\"\n\
             dead_time = \"500 ns\"\nsettling_time = \"1 us\"\n{lines}\n"
        ));
        [inverter.highest_top(), inverter.readable_top()]
    };
    // 0.2, 0.7 and 1.2 us of 25 us, against 1.5 us.
    let three = "conversion_time = \"500 ns\"\nsensed_phases = \"abc\"";
    assert_eq!(tops(three), [1713, 1692]);
    assert_eq!(tops(&format!("{three}\ncurrent_adcs = 2")), [1749, 1692]);
    assert_eq!(tops(&format!("{three}\ncurrent_adcs = 3")), [1785, 1692]);
    assert_eq!(tops("conversion_time = \"500 ns\""), [1692; 2]);
    // The conversions take longer: all three are read.
    assert_eq!(
        tops("conversion_time = \"2 us\"\nsensed_phases = \"abc\""),
        [1497; 2]
    );
}

#[test]
fn a_least_low_time_bounds_every_leg() {
    let inverter = with_lines("adc_range = \"40 A\"\nminimum_low_time = \"2 us\"");
    assert_eq!(inverter.current_sensing, CurrentSensing::InPhase);
    // 4 % of 50 us.
    assert_eq!(
        [inverter.largest_compare(), inverter.readable_top()],
        [1728; 2]
    );
}

#[test]
fn shunt_amplifier_and_reference_make_a_gain() {
    let lines = "shunt = \"0.5 mohm\"\namplifier_gain = 40\nadc_reference = \"3.3 V\"\nadc_inverted = \"on\"";
    let inverter = with_lines(lines);
    let gain = -3.3 / (4096.0 * 0.0005 * 40.0);
    assert!((inverter.adc_gain / gain - 1.0).abs() < 1e-12);
}

/// An ACS712 of 30 A has 66 mV/A; 3.3 V at 12 bits are 0.8057 mV a count.
#[test]
fn sensitivity_and_reference_make_a_gain() {
    let sensor = "adc_gain = \"66 mV/A\"\nadc_reference = \"3.3 V\"";
    let gain = 3.3 / 4096.0 / 0.066;
    let inverter = with_lines(sensor);
    assert!((inverter.adc_gain / gain - 1.0).abs() < 1e-12);
    let unlike = "adc_gain = [\"66 mV/A\", \"0.068 V/A\"]\nadc_reference = \"3.3 V\"";
    let sensors = with_lines(unlike).sensors();
    assert!((sensors[1].gain / gain - 66.0 / 68.0).abs() < 1e-12);
    let swing = format!("{sensor}\namplifier_swing = \"1.5 V\"\nmax_current = \"15 A\"");
    assert!((22.7..22.8).contains(&with_lines(&swing).shown_current()));
    let told = |lines: &str| {
        let text = COMPLETE.replace("adc_range = \"40 A\"", lines);
        let checked = parse_toml(&text, "m.toml").and_then(|ast| check(&ast));
        checked.expect_err("is in error").to_string()
    };
    let text = told("adc_gain = \"66 mV/A\"");
    assert!(
        text.contains("`adc_gain` needs the field `adc_reference`"),
        "{text}"
    );
    // A gain per count leaves nothing to say to the reference.
    let text = told("adc_gain = \"20 mA/count\"\nadc_reference = \"3.3 V\"");
    assert!(
        text.contains("`adc_reference`: 3.3 V has an effect only with `shunt`")
            && !text.contains("amplifier_gain"),
        "{text}"
    );
    let text = told(&format!(
        "{sensor}\nshunt = \"1 mohm\"\namplifier_gain = 20"
    ));
    assert!(
        text.contains("`shunt`") && text.contains("`adc_gain`"),
        "{text}"
    );
    // Ten times the sensitivity shows too small a current.
    let text = told("adc_gain = \"660 mV/A\"\nadc_reference = \"3.3 V\"");
    assert!(text.contains("less sensitive sensors"), "{text}");
}

#[test]
fn sensors_of_a_macro_call_and_of_a_file_are_alike() {
    let file = with_lines(
        "sensed_phases = \"bc\"\nadc_gain = [\"19.5 mA/count\", \"19.7 mA/count\"]\nadc_offset = [2048, 2051]\nadc_inverted = [\"on\", \"off\"]\n",
    );
    assert_eq!(file.sensed_phases, SensedPhases::Bc);
    let sensors = file.sensors();
    assert_eq!([sensors[0].gain, sensors[1].gain], [-0.0195, 0.0197]);
    assert_eq!([sensors[0].offset, sensors[1].offset], [2048, 2051]);
    let call = "pub Hub { motor: { pole_pairs: 4, resistance: 135 mohm per_phase, inductance: 0.22 mH per_phase, winding: star,
        back_emf: 0.1648 V/(rad/s) line_to_line peak, emf_shape: trapezoidal, rated_current: 20 A, rated_speed: 2000 rpm },
        inverter: { bus_voltage: 48 V, f_pwm: 20 kHz, timer_clock: 72 MHz, adc_bits: 12, sensed_phases: bc,
        adc_gain: [19.5 mA/count, 19.7 mA/count], adc_offset: [2048, 2051], adc_inverted: [on, off], current_sensing: in_phase }, controller: pdcc }";
    let tokens = call.parse::<TokenStream>().expect("lexes");
    let ast = parse_macro(tokens).and_then(|input| input.load(Path::new("nowhere"), &mut vec![]));
    let (spec, _) = ast.and_then(|ast| check(&ast)).expect("is right");
    assert_eq!(spec.inverter, file);
}

/// Fields of a call replace those of a file that say the same thing.
#[test]
fn a_gain_replaces_a_shunt() {
    let shunt = "shunt = \"0.5 mohm\"\namplifier_gain = 40\nadc_reference = \"3.3 V\"";
    let text = COMPLETE.replace("adc_range = \"40 A\"", shunt);
    let mut ast = parse_toml(&text, "m.toml").expect("is TOML");
    let over = parse_toml("[inverter]\nadc_gain = \"20 mA/count\"\n", "n.toml").expect("is TOML");
    ast.overlay(over);
    let (spec, _) = check(&ast).expect("is right");
    assert_eq!(spec.inverter.adc_gain, 0.02);
}

#[test]
fn a_control_period_is_so_many_pwm_periods() {
    let inverter = with_lines("adc_range = \"40 A\"\npwm_per_control = 3");
    assert_eq!(inverter.timer_period, 1800);
    assert!((inverter.t_s - 150e-6).abs() < 1e-12);
    assert!((inverter.pwm_period() - 50e-6).abs() < 1e-12);
}

/// A slow motor with a fast edge timer: the timer stops at 65535 ticks.
#[test]
fn the_least_speed_is_by_default_what_the_hall_timer_measures() {
    let minimum = |lines: &str| {
        let inverter = with_lines(&format!("adc_range = \"40 A\"\n{lines}"));
        inverter.minimum_speed / (std::f64::consts::TAU / 60.0)
    };
    // Of 2000 rpm and four pole pairs: 2 % of it, and 60 degrees of 130 ms and of 32.5 ms.
    assert!((minimum("hall_timer_clock = \"500 kHz\"") - 40.0).abs() < 1e-9);
    assert!((minimum("hall_timer_clock = \"2 MHz\"") - 10.0 / (4.0 * 0.0325)).abs() < 1e-3);
}

#[test]
fn an_amplifier_that_saturates_bounds_the_trip_level() {
    const SHUNT: &str = "shunt = \"0.5 mohm\"\namplifier_gain = 20\nadc_reference = \"3.3 V\"\n";
    let of_converter = with_lines(SHUNT);
    // 1.35 V over 10 mV/A.
    let swing = format!("{SHUNT}amplifier_swing = \"1.35 V\"\nmax_current = \"100 A\"");
    let inverter = with_lines(&swing);
    assert_eq!(inverter.sensors(), of_converter.sensors());
    assert!(inverter.trip_current < 135.0, "{}", inverter.trip_current);
    // What offsets take of the converter's range is not taken of the amplifiers'.
    let near = format!("{SHUNT}amplifier_swing = \"0.3 V\"");
    let trip = with_lines(&near).trip_current;
    assert!((29.8..30.0).contains(&trip), "{trip}");
    let told = |lines: &str| {
        let text = COMPLETE.replace("adc_range = \"40 A\"", lines);
        let checked = parse_toml(&text, "m.toml").and_then(|ast| check(&ast));
        checked.expect_err("is in error").to_string()
    };
    let text = told(&format!("{swing}\ntrip_current = \"140 A\""));
    assert!(text.contains("HX0306"), "{text}");
    assert!(text.contains("measure up to 134.9 A only"), "{text}");
    assert!(text.contains("raise `amplifier_swing`"), "{text}");
    let text = told(&format!("{SHUNT}amplifier_swing = \"0.135 V\""));
    let named = "HX0305]: `amplifier_swing`: 0.135 V measures up to 13.5 A";
    assert!(text.contains(named), "{text}");
    let text = told("adc_range = \"40 A\"\namplifier_swing = \"1.35 V\"");
    assert!(text.contains("has an effect only with `shunt`"), "{text}");
}

#[test]
fn currents_are_sampled_in_the_middle_of_pulses_that_the_dead_time_delays() {
    let in_phase = with_lines("adc_range = \"40 A\"\ndead_time = \"600 ns\"");
    assert!((in_phase.sampling_delay(1) - 300e-9).abs() < 1e-15);
    // A command that acts at once begins before such a sample.
    assert_eq!(in_phase.sampling_delay(0), 0.0);
    let shunts = "adc_range = \"40 A\"\ncurrent_sensing = \"low_side\"\naperture_time = \"200 ns\"\n\
         dead_time = \"600 ns\"\nsettling_time = \"1 us\"\nconversion_time = \"0 us\"\nsampling_lead = \"100 ns\"";
    assert!((with_lines(shunts).sampling_delay(1) + 100e-9).abs() < 1e-15);
}

/// 17.3 V of EMF in half of 600 ns move the current of 20 uH by 260 mA, that of 220 uH by 24 mA, where 100 mA are felt.
#[test]
fn shunts_are_read_behind_the_turning_point_where_the_dead_time_is_felt() {
    let sensors = "adc_range = \"40 A\"\ncurrent_sensing = \"low_side\"\naperture_time = \"200 ns\"\n\
         dead_time = \"600 ns\"\nsettling_time = \"1 us\"\nconversion_time = \"0 us\"";
    let text = COMPLETE
        .replace("current_sensing = \"in_phase\"\n", "")
        .replace("adc_range = \"40 A\"", sensors);
    let stiff = text.replace("0.22 mH", "20 uH");
    let checked = |text: &str| {
        let checked = parse_toml(text, "m.toml").and_then(|ast| check(&ast));
        checked.map(|(spec, _)| spec)
    };
    let right = |text: &str| checked(text).expect("a right specification");
    assert_eq!(right(&text).sampling_instant(), None);
    let late = right(&stiff);
    let told = "300 ns (half the dead time) behind the turning point of the timer";
    assert_eq!(late.sampling_instant().as_deref(), Some(told));
    // Less time to settle is needed before, and more behind.
    let window = late.inverter.window().expect("a window");
    assert!((window.before - 1.3e-6).abs() < 1e-12, "{window:?}");
    assert!((window.after - 0.5e-6).abs() < 1e-12, "{window:?}");
    let stated = |lead: &str| {
        let lead = format!("dead_time = \"600 ns\"\nsampling_lead = \"{lead}\"");
        stiff.replace("dead_time = \"600 ns\"", &lead)
    };
    assert_eq!(right(&stated("0 ns")).sampling_instant(), None);
    let at_once = stiff.replace("kind = \"pdcc\"", "kind = \"pdcc\"\ndelay = 0");
    assert_eq!(right(&at_once).sampling_instant(), None);
    let [early, behind] = ["100 ns", "-100 ns"].map(|lead| right(&stated(lead)).sampling_instant());
    assert_eq!(
        early.as_deref(),
        Some("100 ns before the turning point of the timer")
    );
    assert_eq!(
        behind.as_deref(),
        Some("100 ns behind the turning point of the timer")
    );
    let behind = stated("-100 ns").replace("kind = \"pdcc\"", "kind = \"pdcc\"\ndelay = 0");
    for text in [&behind, &behind.replace("dead_time = \"600 ns\"\n", "")] {
        let told = checked(text).expect_err("acts at once").to_string();
        let named = "`sampling_lead`: -100 ns lies outside 0 s (with a `delay` of 0 ";
        assert!(told.contains(named), "{told}");
    }
}

/// One ADC that reads the phases in turn is late by itself; and no default costs what was readable before.
#[test]
fn the_mean_of_all_conversions_is_in_the_middle_of_late_pulses() {
    let told = |sensors: &str, controller: &str| {
        let sensors = format!(
            "adc_range = \"40 A\"\ncurrent_sensing = \"low_side\"\ndead_time = \"600 ns\"\nsettling_time = \"1 us\"\n{sensors}"
        );
        let text = COMPLETE
            .replace("current_sensing = \"in_phase\"\n", "")
            .replace("adc_range = \"40 A\"", &sensors)
            .replace("0.22 mH", "20 uH")
            .replace("kind = \"pdcc\"", controller);
        let checked = parse_toml(&text, "m.toml").and_then(|ast| check(&ast));
        let (spec, _) = checked.expect("a right specification");
        spec.sampling_instant()
    };
    let at = |time: &str| Some(format!("{time} behind the turning point of the timer"));
    let in_turn = "aperture_time = \"200 ns\"\nconversion_time";
    let pdcc = "kind = \"pdcc\"";
    assert_eq!(told(&format!("{in_turn} = \"300 ns\""), pdcc), at("150 ns"));
    assert_eq!(told(&format!("{in_turn} = \"700 ns\""), pdcc), None);
    let three = format!("sensed_phases = \"abc\"\n{in_turn} = \"150 ns\"");
    assert_eq!(told(&three, pdcc), at("150 ns"));
    let at_once = format!("{three}\ncurrent_adcs = 2");
    assert_eq!(told(&at_once, pdcc), at("250 ns"));
    // Behind the turning point for longer than before it.
    let slow = "aperture_time = \"1.2 us\"\nconversion_time = \"0 us\"";
    assert_eq!(told(slow, pdcc), None);
    // Legs that are off are read before the next command acts.
    let early = "sensed_phases = \"abc\"\naperture_time = \"0 us\"\nconversion_time = \"0 us\"";
    assert_eq!(told(early, "kind = \"pdcc\"\nmodulation = \"pair\""), None);
}

/// 10 bits a turn of the shaft are 64 periods of filter, 3.2 ms.
#[test]
fn the_filter_of_an_angle_sensor_limits_the_speed_loop() {
    let check_with = |bits: u32, bandwidth: u32| {
        let text = COMPLETE
            .replace("rated_speed = \"2000 rpm\"", "rated_speed = \"8000 rpm\"")
            .replace("bus_voltage = \"48 V\"", "bus_voltage = \"200 V\"")
            .replace(
                "[motor]\n",
                &format!(
                    "[motor]\ninertia = \"1e-4 kg m2\"\nrotor = \"angle\"\nangle_pole_pairs = 4\nangle_bits = {bits}\n"
                ),
            );
        let text = format!("{text}speed_loop = \"on\"\nspeed_bandwidth = \"{bandwidth} Hz\"\n");
        parse_toml(&text, "m.toml").and_then(|ast| check(&ast))
    };
    for (bits, bandwidth) in [(10, 31), (16, 66)] {
        assert!(check_with(bits, bandwidth).is_ok(), "{bits} bits");
        let text = check_with(bits, bandwidth + 1)
            .expect_err("is too fast")
            .to_string();
        assert!(text.contains("HX0210]: `speed_bandwidth`"), "{text}");
        let is_of_filter = text.contains("31.25 Hz, 0.1 over the time constant");
        assert_eq!(is_of_filter, bits == 10, "{text}");
    }
}
