//! The inverter's numbers: periods of whole counts, ticks with fractions, trip levels, and limits
//! that hold.

use super::diagnostics::{COMPLETE_CALL, changed, found_in_call};
use crate::diagnostics::Code;
use crate::pipeline::{generate, warnings};
use crate::spec::{BusCurrents, BusSource, Origins, RotorSensing, Spec, check, parse_toml};

const MOTOR: &str = r#"[motor]
pole_pairs = 4
resistance = "135 mohm per_phase"
inductance = "0.22 mH per_phase"
winding = "star"
back_emf = "0.1648 V/(rad/s) line_to_line peak"
emf_shape = "trapezoidal"
rated_current = "20 A peak"
rated_speed = "2000 rpm"
[inverter]
bus_voltage = "48 V"
adc_bits = 12
current_sensing = "in_phase"
"#;

const TIMER: &str = "f_pwm = \"20 kHz\"\ntimer_clock = \"72 MHz\"\n";

fn try_check(inverter: &str, controller: &str) -> Result<(Spec, Origins), String> {
    let text = format!("{MOTOR}{inverter}\n[controller]\n{controller}\n");
    parse_toml(&text, "m.toml")
        .and_then(|ast| check(&ast))
        .map_err(|errors| errors.to_string())
}

fn checked(inverter: &str, controller: &str) -> (Spec, Origins) {
    try_check(inverter, controller).unwrap_or_else(|errors| panic!("{inverter}: {errors}"))
}

#[test]
fn the_control_period_is_that_of_whole_timer_counts() {
    for (clock, asked, counts) in [
        ("170 MHz", "f_pwm = \"30 kHz\"", 2833),
        ("170 MHz", "sampling_time = \"33.35 us\"", 2835),
        ("72 MHz", "f_pwm = \"20 kHz\"", 1800),
        ("72 MHz", "sampling_time = \"50 us\"", 1800),
        ("4.02 MHz", "f_pwm = \"20 kHz\"", 101),
    ] {
        let inverter = format!("{asked}\ntimer_clock = \"{clock}\"\nadc_range = \"40 A\"\n");
        let (spec, _) = checked(&inverter, "kind = \"pdcc\"");
        let hertz: f64 = clock.trim_end_matches(" MHz").parse().expect("a number");
        assert_eq!(spec.inverter.timer_period, counts, "{inverter}");
        let t_s = 2.0 * f64::from(counts) / (hertz * 1e6);
        assert_eq!(spec.inverter.t_s, t_s, "{inverter}");
        assert!(spec.to_toml().contains(&format!("t_s = {t_s:?}\n")));
    }
    let (spec, origins) = checked(
        "f_pwm = \"30 kHz\"\ntimer_clock = \"170 MHz\"\nadc_range = \"40 A\"\n",
        "kind = \"pdcc\"",
    );
    let interface = generate(&spec, &origins).expect("generates").interface;
    assert!(
        interface
            .doc
            .join("\n")
            .contains("PWM of 30.0035298 kHz (period 33.33 us, timer of 2833 counts)")
    );
    // Counts in place of the clock leave the period as it is asked for.
    let (spec, _) = checked(
        "f_pwm = \"30 kHz\"\ntimer_period = 2833\nadc_range = \"40 A\"\n",
        "kind = \"pdcc\"",
    );
    assert_eq!(spec.inverter.t_s, 1.0 / 30e3);
}

/// Every clock that is accepted makes a frequency within 0.5 % of the one that is asked for.
#[test]
fn the_real_frequency_is_within_half_a_percent() {
    let (mut accepted, mut refused) = (0, 0);
    for hertz in (3_900_000..8_100_000).step_by(7_300) {
        let inverter =
            format!("f_pwm = \"20 kHz\"\ntimer_clock = \"{hertz} Hz\"\nadc_range = \"40 A\"\n");
        match try_check(&inverter, "kind = \"pdcc\"") {
            Ok((spec, _)) => {
                assert!((spec.inverter.t_s * 20e3 - 1.0).abs() <= 0.005, "{hertz}");
                accepted += 1;
            }
            Err(errors) => {
                assert!(errors.contains("error[HX0308]"), "{errors}");
                refused += 1;
            }
        }
    }
    assert!(accepted > 500 && refused > 10, "{accepted} {refused}");
}

#[test]
fn a_default_threshold_is_at_least_one_count() {
    let sensors = format!("{TIMER}adc_range = \"1200 A\"\n");
    let (spec, _) = checked(&sensors, "kind = \"pdcc\"");
    let threshold = spec.controller.common().commutation_threshold;
    assert!((threshold - 1200.0 / 2048.0).abs() < 1e-9, "{threshold}");
}

#[test]
fn edge_ticks_may_be_fractions_of_the_period() {
    for (f_pwm, clock, ticks) in [
        ("16 kHz", "1 MHz", 62.5),
        ("20 kHz", "1 MHz", 50.0),
        ("20 kHz", "50 kHz", 2.5),
    ] {
        let inverter = format!(
            "f_pwm = \"{f_pwm}\"\ntimer_clock = \"72 MHz\"\nhall_timer_clock = \"{clock}\"\nadc_range = \"40 A\"\n"
        );
        let (spec, origins) = checked(
            &inverter,
            "kind = \"pdcc\"\nhall_capture = \"timer\"\nemf = \"model\"",
        );
        assert_eq!(
            spec.inverter.rotor_sensing,
            RotorSensing::TimedHalls { ticks }
        );
        assert!(spec.to_toml().contains(&format!("\nticks = {ticks:?}\n")));
        let program = generate(&spec, &origins).expect("generates").graph;
        let constants = &program.program().constants;
        let has = |name: &str| constants.iter().any(|constant| constant.name == name);
        assert_eq!(has("k_ticks"), ticks.fract() != 0.0, "{clock}");
        assert_eq!(has("turn_rest"), ticks.fract() != 0.0, "{clock}");
    }
}

/// Range, field and controller; trip level by default, and the codes of the warnings.
#[test]
fn the_trip_level_follows_from_the_largest_set_point() {
    for (range, field, controller, trip, codes) in [
        ("100 A", "", "pdcc", 40.0, &[][..]),
        ("400 A", "max_current = \"3.3 A\"\n", "pdcc", 6.6, &[]),
        ("40 A", "", "pdcc", 37.968_75, &[]),
        (
            "40 A",
            "max_current = \"36 A\"\n",
            "pdcc",
            38.79,
            &[Code::TripNearSetPoint],
        ),
        ("40 A", "max_current = \"30 A\"\n", "pdcc", 37.968_75, &[]),
        (
            "100 A",
            "trip_current = \"66 A\"\n",
            "pdcc",
            66.0,
            &[Code::TripFarAbove],
        ),
        ("100 A", "trip_current = \"59 A\"\n", "pdcc", 59.0, &[]),
        ("100 A", "max_current = \"10 A\"\n", "fcs-mpc", 20.0, &[]),
        (
            "100 A",
            "max_current = \"5 A\"\n",
            "fcs-mpc",
            12.78,
            &[Code::TripFarAbove],
        ),
        (
            "100 A",
            "max_current = \"5 A\"\n",
            "phcc",
            20.79,
            &[Code::TripFarAbove],
        ),
        ("40 A", "max_current = \"20 A\"\n", "phcc", 37.968_75, &[]),
        (
            "40 A",
            "max_current = \"22 A\"\n",
            "phcc",
            37.968_75,
            &[Code::SwingAboveTrip],
        ),
    ] {
        let inverter = format!("{TIMER}adc_range = \"{range}\"\n{field}");
        let (spec, origins) = checked(&inverter, &format!("kind = \"{controller}\""));
        let count = spec.inverter.adc_gain;
        let found = spec.inverter.trip_current;
        assert!((found - trip).abs() <= count, "{inverter}: {found}");
        let counts = found / count;
        assert!(
            (counts - counts.round()).abs() < 1e-6,
            "{inverter}: {counts}"
        );
        let told: Vec<Code> = warnings(&spec, &origins, &[])
            .iter()
            .map(|warning| warning.code)
            .collect();
        assert_eq!(told, codes, "{inverter} {controller}");
    }
}

/// What a message says is enough is accepted: the message's code, the field, and the word in front
/// of the limit.
#[test]
fn limits_in_messages_are_accepted() {
    let mut followed = 0;
    for clock in ["72 MHz", "170 MHz", "5.37 MHz"] {
        for (code, field, given, before, controller) in [
            (
                "HX0312",
                "maximum_speed",
                "190000 rpm",
                "lower it to ",
                "pdcc",
            ),
            ("HX0323", "over_speed", "2001 rpm", "lies outside ", "pdcc"),
            ("HX0323", "over_speed", "190000 rpm", " to ", "pdcc"),
            ("HX0312", "f_pwm", "1.7 kHz", "raise `f_pwm` to ", "pdcc"),
            ("HX0301", "f_pwm", "600 Hz", "`f_pwm` of at least ", "pdcc"),
            ("HX0406", "f_pwm", "3 kHz", "(`f_pwm`: ", "phcc"),
            ("HX0406", "f_pwm", "3.1 kHz", "(`f_pwm`: ", "fcs-mpc"),
            ("HX0315", "dead_time", "10 us", "shorten it to ", "pdcc"),
            (
                "HX0310",
                "minimum_speed",
                "0.02 rpm",
                "raise the speed to ",
                "pdcc",
            ),
            ("HX0317", "max_current", "17 mA", "at least ", "pdcc"),
            (
                "HX0317",
                "bus_adc_range",
                "333 V",
                "narrow the range to ",
                "pdcc",
            ),
        ] {
            let base = |value: &str| {
                let mut text = format!("timer_clock = \"{clock}\"\nadc_range = \"77.7 A\"\n");
                if field != "f_pwm" {
                    text += "f_pwm = \"23.3 kHz\"\n";
                }
                if field == "bus_adc_range" {
                    text += "v_bus = \"measured\"\nbus_adc_bits = 8\n";
                }
                if code == "HX0312" && field == "f_pwm" {
                    text += "maximum_speed = \"9000 rpm\"\n";
                }
                text + &format!("{field} = \"{value}\"\n")
            };
            let errors =
                |value: &str| match try_check(&base(value), &format!("kind = \"{controller}\"")) {
                    Err(errors) => errors,
                    Ok((spec, origins)) => match generate(&spec, &origins) {
                        Err(errors) => errors.to_string(),
                        Ok(_) => String::new(),
                    },
                };
            let first = errors(given);
            let Some(message) = first.lines().find(|line| line.contains(code)) else {
                panic!("{clock} {field} {given}: {first}")
            };
            let limit = message.rsplit(before).next().unwrap_or_default();
            let mut words = limit.split([' ', ',', ';', ')']);
            let limit = [words.next(), words.next()].map(Option::unwrap_or_default);
            let limit = limit.join(" ");
            let then = errors(&limit);
            assert!(
                !then.contains(code),
                "{clock} {field} {limit}: {then}\n{message}"
            );
            followed += 1;
        }
    }
    assert_eq!(followed, 33);
}

#[test]
fn a_drive_with_a_speed_loop_detects_a_stall_by_default() {
    let periods = |inverter: &str, speed_loop: &str| {
        let motor = MOTOR.replace("[inverter]\n", "inertia = \"3 kg cm2\"\n[inverter]\n");
        let text = format!(
            "{motor}{TIMER}adc_range = \"40 A\"\n{inverter}\n[controller]\nkind = \"pdcc\"\n\
             speed_loop = \"{speed_loop}\"\n"
        );
        let spec = parse_toml(&text, "m.toml").and_then(|ast| check(&ast));
        let (spec, _) = spec.unwrap_or_else(|errors| panic!("{inverter}: {errors}"));
        spec.inverter.stall_periods
    };
    assert_eq!(periods("", "on"), 20_000);
    // Five sectors of 625 ms.
    let slow = periods("minimum_speed = \"4 rpm\"", "on");
    assert!((62_500..=62_501).contains(&slow), "{slow}");
    assert_eq!(periods("stall_timeout = \"0 s\"", "on"), 0);
    assert_eq!(periods("stall_timeout = \"200 ms\"", "on"), 4_000);
    assert_eq!(periods("", "off"), 0);
}

#[test]
fn sensors_60_degrees_apart_are_told_by_the_codes_that_are_missing() {
    let read = |codes: &str| {
        let motor = MOTOR.replace(
            "[inverter]\n",
            &format!("hall_codes = {codes}\n[inverter]\n"),
        );
        let text = format!("{motor}{TIMER}adc_range = \"40 A\"\n[controller]\nkind = \"pdcc\"\n");
        parse_toml(&text, "m.toml")
            .and_then(|ast| check(&ast))
            .map(|(spec, _)| (spec.motor.hall_inverted(), spec.motor.upright_codes()))
            .map_err(|errors| errors.to_string())
    };
    for (codes, inverted, upright) in [
        ("[1, 5, 4, 6, 2, 3]", 0, [1, 5, 4, 6, 2, 3]),
        ("[0, 1, 3, 7, 6, 4]", 0b010, [2, 3, 1, 5, 4, 6]),
        ("[0, 2, 3, 7, 5, 4]", 0b001, [1, 3, 2, 6, 4, 5]),
        ("[7, 5, 1, 0, 2, 6]", 0b100, [3, 1, 5, 4, 6, 2]),
    ] {
        assert_eq!(read(codes), Ok((inverted, upright)), "{codes}");
    }
    for (codes, why) in [
        (
            "[0, 2, 6, 7, 5, 4]",
            "a sensor does not show a one for half a turn",
        ),
        ("[0, 1, 3, 7, 6, 0]", "0 stands twice"),
        ("[0, 1, 3, 7, 6]", "5 codes instead of 6"),
        ("[0, 1, 3, 7, 4, 6]", "7 and 4 differ by more than one bit"),
    ] {
        let told = read(codes).expect_err(codes);
        assert!(told.contains(why), "{codes}: {told}");
    }
}

#[test]
fn disturbed_hall_codes_are_bridged_for_less_than_a_sector() {
    let check = |samples: u32| {
        let inverter = format!("{TIMER}adc_range = \"40 A\"\nhall_glitches = {samples}");
        try_check(&inverter, "kind = \"pdcc\"").map(|(spec, _)| spec.inverter.hall_glitches)
    };
    // A sector at 3000 rpm lasts 0.833 ms, 16.7 periods.
    assert_eq!([0, 3, 15].map(check), [Ok(0), Ok(3), Ok(15)]);
    let told = check(16).expect_err("longer than a sector");
    assert!(
        told.contains("`hall_glitches`: 16 samples and one more take longer than a sector at `maximum_speed` 3000 rpm")
            && told.contains("give at most 15, or lower `maximum_speed`"),
        "{told}"
    );
}

/// A drive that measures its bus at 20 mV a count, with further lines of the inverter.
fn of_measured_bus(lines: &str) -> Result<(Spec, Origins), String> {
    let inverter = format!(
        "{TIMER}adc_range = \"40 A\"\nv_bus = \"measured\"\nbus_adc_bits = 12\n\
         bus_adc_range = \"81.92 V\"\n{lines}"
    );
    try_check(&inverter, "kind = \"pdcc\"")
}

#[test]
fn a_measured_bus_trips_at_its_limits_or_where_told() {
    let counts = |lines: &str| of_measured_bus(lines).map(|(spec, _)| spec.inverter.bus_counts());
    // 20 mV a count; 70 % and 130 % of 48 V.
    assert_eq!(counts(""), Ok([1680, 3120]));
    assert_eq!(
        counts("bus_max = \"60 V\"\nbus_min = \"40 V\""),
        Ok([2000, 3000])
    );
    // A bus at a level reads the nearest count, which is no fault.
    for (levels, nearest) in [
        (["30.008", "56.008"], [1500, 2800]),
        (["30.012", "56.012"], [1501, 2801]),
    ] {
        let [under, over] = levels;
        let lines = format!("over_voltage = \"{over} V\"\nunder_voltage = \"{under} V\"");
        assert_eq!(counts(&lines), Ok(nearest));
    }
    assert_eq!(
        counts("over_voltage = \"0 V\"\nunder_voltage = \"0 V\""),
        Ok([0, u16::MAX])
    );
    // The greatest count may be any voltage above.
    assert_eq!(counts("over_voltage = \"81.92 V\""), Ok([1680, 4094]));
    for (lines, told) in [
        (
            "over_voltage = \"48 V\"",
            "`over_voltage`: 48 V is not above `bus_voltage` 48 V",
        ),
        (
            "under_voltage = \"50 V\"",
            "`under_voltage`: 50 V is not below `bus_voltage` 48 V",
        ),
        (
            "over_voltage = \"90 V\"",
            "`bus_adc_range`: 81.92 V is not at least `over_voltage` 90 V",
        ),
    ] {
        let found = counts(lines).expect_err(lines);
        assert!(found.contains(told), "{found}");
    }
    let fixed = try_check(
        &format!("{TIMER}adc_range = \"40 A\"\nover_voltage = \"56 V\""),
        "kind = \"pdcc\"",
    );
    assert!(fixed.is_err_and(|told| told.contains("`over_voltage`")));
}

#[test]
fn fades_end_a_quarter_of_their_width_before_the_voltage_that_trips() {
    let fades = |lines: &str| {
        of_measured_bus(lines).map(|(spec, _)| match spec.inverter.bus {
            BusSource::Measured {
                braking, motoring, ..
            } => [braking, motoring].map(|fade| fade.map(|fade| [fade.full, fade.none])),
            BusSource::Fixed => panic!("a fixed bus"),
        })
    };
    assert_eq!(fades(""), Ok([None, None]));
    assert_eq!(fades("braking_fade = \"0 V\""), Ok([None, None]));
    let both = "braking_fade = \"4 V\"\nmotoring_fade = \"8 V\"\n";
    // The lower of the trip and the limit of the measurement, or the higher.
    let told = fades(&format!(
        "{both}over_voltage = \"58 V\"\nunder_voltage = \"36 V\""
    ));
    assert_eq!(told, Ok([Some([54.0, 57.0]), Some([44.0, 38.0])]));
    let told = fades(&format!(
        "{both}bus_max = \"60 V\"\nover_voltage = \"70 V\"\nbus_min = \"32 V\"\nunder_voltage = \"0 V\""
    ));
    assert_eq!(told, Ok([Some([56.0, 59.0]), Some([40.0, 34.0])]));
    let told = fades("braking_fade = \"20 V\"\nbus_max = \"60 V\"").expect_err("too wide");
    assert!(
        told.contains("`braking_fade`: 20 V lies outside 0 V to 12 V, from `bus_voltage` to 60 V"),
        "{told}"
    );
}

#[test]
fn bus_currents_lie_between_ten_counts_and_the_trip_level() {
    let limits = |lines: &str| {
        let inverter = format!("{TIMER}adc_range = \"40 A\"\ntrip_current = \"30 A\"\n{lines}");
        try_check(&inverter, "kind = \"pdcc\"").map(|(spec, _)| spec.inverter.bus_currents)
    };
    let both = "bus_current_limit = \"8 A\"\nreturn_current_limit = \"500 mA\"";
    for (lines, drawn, returned) in [
        ("", None, None),
        (both, Some(8.0), Some(0.5)),
        ("return_current_limit = \"2 A\"", None, Some(2.0)),
    ] {
        assert_eq!(
            limits(lines),
            Ok(BusCurrents { drawn, returned }),
            "{lines}"
        );
    }
    for (line, limit) in [
        (
            "bus_current_limit = \"31 A\"",
            "31 A lies outside 195.4 mA, ten ADC counts, to 30 A, the trip level",
        ),
        (
            "return_current_limit = \"100 mA\"",
            "100 mA lies outside 195.4 mA",
        ),
    ] {
        let told = limits(line).expect_err(line);
        assert!(told.contains(limit), "{told}");
    }
}

#[test]
fn a_slew_rate_is_the_rated_current_in_a_minute_at_least_and_not_beside_a_speed_loop() {
    let rate = |options: &str| {
        let inverter = format!("{TIMER}adc_range = \"40 A\"");
        let checked = try_check(&inverter, &format!("kind = \"pdcc\"\n{options}"));
        checked.map(|(spec, _)| spec.controller.common().slew_rate)
    };
    assert_eq!(rate(""), Ok(None));
    assert_eq!(rate("slew_rate = \"0.4 A/ms\""), Ok(Some(400.0)));
    let told = rate("slew_rate = \"300 mA/s\"").expect_err("too slow");
    assert!(
        told.contains(
            "`slew_rate`: 300 mA/s lies outside 333.4 mA/s (`rated_current` in a minute) to 1 GA/s"
        ),
        "{told}"
    );
    let told = rate("slew_rate = \"20 V/s\"").expect_err("no such quantity");
    assert!(told.contains("slew_rate"), "{told}");
    let motor = MOTOR.replace("[inverter]\n", "inertia = \"3 kg cm2\"\n[inverter]\n");
    let text = format!(
        "{motor}{TIMER}adc_range = \"40 A\"\n[controller]\nkind = \"pdcc\"\nspeed_loop = \"on\"\n\
         slew_rate = \"400 A/s\"\n"
    );
    let both = parse_toml(&text, "m.toml").and_then(|ast| check(&ast));
    let told = both.expect_err("both").to_string();
    assert!(
        told.contains("`slew_rate`: 400 A/s has no effect"),
        "{told}"
    );
}

#[test]
fn a_residual_timeout_is_whole_periods_from_50_up_and_needs_the_observer() {
    let periods = |options: &str| {
        let inverter = format!("{TIMER}adc_range = \"40 A\"");
        let checked = try_check(&inverter, &format!("kind = \"pdcc\"\n{options}"));
        checked.map(|(spec, _)| spec.controller.common().residual_periods)
    };
    let observer = "reference = \"proportional\"\nemf = \"observer\"\n";
    assert_eq!(periods(observer), Ok(None));
    let timeout = |time: &str| periods(&format!("{observer}residual_timeout = \"{time}\""));
    assert_eq!(timeout("5.01 ms"), Ok(Some(101)));
    let told = timeout("2 ms").expect_err("too short");
    assert!(
        told.contains("`residual_timeout`: 2 ms lies outside 2.5 ms (50 control periods) to "),
        "{told}"
    );
    let told = periods("emf = \"model\"\nresidual_timeout = \"5 ms\"").expect_err("no observer");
    assert!(
        told.contains("`residual_timeout`: 5 ms has no effect with `emf = \"model\"`: only `emf = \"observer\"` tells"),
        "{told}"
    );
}

#[test]
fn hall_sensors_are_learnt_with_timed_edges_and_the_observer() {
    let learns = |clock: &str, options: &str| {
        let inverter = format!("{TIMER}{clock}adc_range = \"40 A\"");
        let checked = try_check(&inverter, &format!("kind = \"pdcc\"\n{options}"));
        checked.map(|(spec, _)| spec.controller.common().learning.halls)
    };
    let clock = "hall_timer_clock = \"1 MHz\"\n";
    assert_eq!(learns(clock, ""), Ok(false));
    assert_eq!(learns(clock, "hall_learning = \"on\""), Ok(true));
    let told = learns("", "hall_learning = \"on\"").expect_err("edges at samples");
    assert!(
        told.contains("`hall_learning = \"on\"` needs the field `hall_timer_clock` of `inverter`"),
        "{told}"
    );
    let told = learns(clock, "emf = \"model\"\nhall_learning = \"on\"").expect_err("no observer");
    assert!(
        told.contains("`hall_learning`: on has no effect with `emf = \"model\"`: only `emf = \"observer\"` tells"),
        "{told}"
    );
}

#[test]
fn the_torque_constant_is_learnt_with_a_measured_bus_and_the_observer_and_without_field_weakening()
{
    let measured = "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"65 V\"\n";
    let clock = "hall_timer_clock = \"1 MHz\"\n";
    let learns = |fields: [&str; 2], options: &str| {
        let fields = fields.concat();
        let inverter = format!("{TIMER}{fields}adc_range = \"40 A\"");
        let options = format!("kind = \"pdcc\"\n{options}torque_learning = \"on\"");
        let checked = try_check(&inverter, &options);
        checked.map(|(spec, _)| spec.controller.common().learning.torque)
    };
    let observer = "emf = \"observer\"\n";
    assert_eq!(learns([measured, clock], observer), Ok(true));
    for (fields, options, part) in [
        (
            [measured, ""],
            observer,
            "`torque_learning = \"on\"` needs the field `hall_timer_clock` of `inverter`",
        ),
        (
            ["", clock],
            observer,
            "`torque_learning`: on has no effect with `v_bus = \"fixed\"`",
        ),
        (
            [measured, clock],
            "emf = \"model\"\n",
            "`torque_learning`: on has no effect with `emf = \"model\"`",
        ),
        (
            [measured, clock],
            "emf = \"observer\"\nreference = \"proportional\"\nfield_weakening = \"on\"\n",
            "`torque_learning`: on has no effect with `field_weakening = \"on\"`",
        ),
    ] {
        let told = learns(fields, options).expect_err(part);
        assert!(told.contains(part), "{told}");
    }
}

#[test]
fn hall_angles_are_near_their_places_whatever_the_turn() {
    let angles = |list: &str| {
        let motor = MOTOR.replace(
            "[inverter]\n",
            &format!("hall_angles = [{list}]\n[inverter]\n"),
        );
        let text = format!("{motor}{TIMER}adc_range = \"40 A\"\n[controller]\nkind = \"pdcc\"\n");
        parse_toml(&text, "m.toml")
            .and_then(|ast| check(&ast))
            .map(|(spec, _)| (spec.motor.hall_angles, spec.to_toml()))
            .map_err(|told| told.to_string())
    };
    let quoted = |degrees: [f64; 6]| degrees.map(|x| format!("\"{x} deg\"")).join(", ");
    let (found, text) = angles(&quoted([334.0, 31.7, 90.0, 150.0, 210.0, -90.0])).expect("right");
    assert_eq!(found, [-26.0, 31.7, 90.0, 150.0, 210.0, 270.0]);
    assert!(
        text.contains("hall_angles = [-26.0, 31.7, 90.0, 150.0, 210.0, 270.0]"),
        "{text}"
    );
    let (_, text) = angles(&quoted(crate::spec::HALL_ANGLES)).expect("right");
    assert!(!text.contains("hall_angles"), "{text}");
    let told = angles(&quoted([-30.0, 30.0, 90.0, 171.0, 210.0, 270.0])).expect_err("far");
    assert!(
        told.contains("that of sector 4 is 21 deg from its place, 150 deg"),
        "{told}"
    );
    let told = angles("\"-30 deg\", \"30 deg\"").expect_err("two");
    assert!(told.contains("2 angles instead of 6"), "{told}");
    let told = angles("-30, 30, 90, 150, 210, 270").expect_err("no unit");
    assert_eq!(told.matches("error[HX0204]").count(), 1, "{told}");
}

/// A slip of the prefix is told of the value itself, once.
#[test]
fn a_thousandth_of_a_value_is_one_error() {
    let lines = format!("{TIMER}adc_range = \"40 A\"\n[controller]\nkind = \"pdcc\"\n");
    let told = |old: &str, new: &str| {
        let text = format!("{MOTOR}{lines}").replace(old, new);
        let checked = parse_toml(&text, "m.toml").and_then(|ast| check(&ast));
        checked.expect_err("is in error").to_string()
    };
    for (old, new, field) in [
        ("\"20 A peak\"", "\"20 mA\"", "`rated_current`: 20 mA is "),
        ("0.22 mH", "0.22 uH", "`inductance`: 0.22 uH per_phase is "),
        ("135 mohm", "135 ohm", "`resistance`: 135 ohm per_phase is "),
    ] {
        let told = told(old, new);
        assert!(told.contains(field), "{told}");
        assert!(told.contains("likely a thousandfold off"), "{told}");
        assert_eq!(told.matches(": error[").count(), 1, "{told}");
    }
    let text = told("2000 rpm", "40000 rpm");
    assert!(
        text.contains("HX0302") && !text.contains("HX0312"),
        "{text}"
    );
    let text = told(
        "0.1648 V/(rad/s) line_to_line peak",
        "40.4 mNm/A block_mean",
    );
    assert!(
        text.contains("write `torque_constant = \"40.4 mNm/A block_mean\"`"),
        "{text}"
    );
    let told = told("\"20 A peak\"", "\"100 mA\"");
    assert!(told.contains("or give at least 195.4 mA"), "{told}");
}

/// A trip that braking does not reach, a fade before it, and a start within the time-out.
#[test]
fn trips_out_of_reach_are_no_warnings() {
    const BUS: &str =
        "+inverter v_bus: measured; +inverter bus_adc_bits: 12; +inverter bus_adc_range: 80 V";
    const HEAVY: &str = "+motor inertia: 24 kg cm2";
    for delta in [
        // 130 % of the nominal voltage.
        format!("{BUS}; +inverter return_current_limit: 4 A"),
        format!("{BUS}; +inverter bus_max: 57 V; +inverter braking_fade: 4.5 V"),
        format!("{BUS}; +inverter bus_max: 57 V; +inverter over_voltage: 0 V"),
        // A fixed bus has no voltage to fade by.
        "+inverter return_current_limit: 4 A".to_owned(),
        // A sector of 15 degrees takes 19.5 ms with 3.3 Nm.
        format!("{HEAVY}; +inverter stall_timeout: 20 ms"),
        format!("{HEAVY}; +inverter stall_timeout: 0 s"),
        "+inverter stall_timeout: 1 ms".to_owned(),
    ] {
        let found = found_in_call(&changed(COMPLETE_CALL, &delta));
        assert!(found.is_empty(), "{delta}: {found:?}");
    }
}

/// The motor's current moves by 0.218 A, 1.09 % of the rated one, in a microsecond of dead time.
#[test]
fn a_dead_time_that_is_felt_is_compensated_by_default() {
    let compensates = |inverter: &str, controller: &str| {
        let (spec, _) = checked(
            &format!("{TIMER}adc_range = \"40 A\"\n{inverter}"),
            controller,
        );
        spec.to_toml().contains("dead_time_compensation = \"on\"")
    };
    let [short, long] = ["dead_time = \"1.8 us\"\n", "dead_time = \"1.9 us\"\n"];
    let twice = "dead_time = \"1 us\"\npwm_per_control = 2\n";
    let pdcc = "kind = \"pdcc\"\n";
    let with = |options: &str| format!("{pdcc}{options}\n");
    for (inverter, controller, expected) in [
        (short, pdcc, false),
        (long, pdcc, true),
        (twice, pdcc, true),
        (long, "kind = \"pi-pwm\"", true),
        ("", pdcc, false),
        (short, &with("reference = \"quasi_square\""), true),
        (short, &with("emf = \"model\""), true),
        ("", &with("emf = \"model\""), false),
        (long, &with("dead_time_compensation = \"off\""), false),
        (short, &with("dead_time_compensation = \"on\""), true),
        (long, &with("modulation = \"pair\""), false),
        (long, &with("modulation = \"table2\""), false),
        (long, "kind = \"pi-pwm\"\nsix_step = \"on\"", false),
    ] {
        assert_eq!(
            compensates(inverter, controller),
            expected,
            "{inverter}{controller}"
        );
    }
}

/// The voltage of a count of a timer of 4.3 MHz moves the motor's current by 0.101 A, 0.51 % of the rated one.
#[test]
fn a_rounding_that_is_felt_is_predicted_by_default() {
    let predicts = |clock: &str, controller: &str| {
        let inverter =
            format!("f_pwm = \"20 kHz\"\ntimer_clock = \"{clock}\"\nadc_range = \"40 A\"\n");
        let (spec, _) = checked(&inverter, controller);
        spec.to_toml().contains("rounding_prediction = \"on\"")
    };
    let pdcc = |options: &str| format!("kind = \"pdcc\"\n{options}");
    for (clock, controller, expected) in [
        ("4.4 MHz", pdcc(""), false),
        ("4.3 MHz", pdcc(""), true),
        ("4.4 MHz", pdcc("rounding_prediction = \"on\""), true),
        ("4.3 MHz", pdcc("rounding_prediction = \"off\""), false),
        ("4.3 MHz", pdcc("delay = 0"), false),
        ("4.3 MHz", pdcc("modulation = \"pair\""), false),
        ("4.3 MHz", pdcc("modulation = \"table2\""), false),
        ("4.3 MHz", "kind = \"pi-pwm\"".to_owned(), false),
    ] {
        assert_eq!(
            predicts(clock, &controller),
            expected,
            "{clock} {controller}"
        );
    }
}
