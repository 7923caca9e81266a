//! Current sensors in the low legs, in closed loop: an accepted drive has no blind sample, and without the window the
//! same controller loses its currents.

use hexagen::Fault;
use hexagen_codegen::pipeline::generate;
use hexagen_codegen::spec::{check, parse_toml};
use hexagen_lab::Interpreted;
use hexagen_lab::closed_loop::{FiguresOfMerit, measure};
use hexagen_lab::engine::{Model, MotorSource, plant_of, prepare, run_of};
use hexagen_lab::plant::{Plant, PlantParams};
use hexagen_reference::AnyCommand;
use hexagen_reference::verify::Subject;
use hexagen_tests::sensors::{LOW_SIDE, specification};
use std::f64::consts::TAU;

/// Periods of a run, and from which on the torque counts.
const PERIODS: u32 = 1200;
const SETTLED: u32 = 600;

struct Run {
    blind: u64,
    torque: f64,
    turn_ons: u64,
    fault: Option<Fault>,
}

/// A drive that was generated for `sensors`, at full current, on a plant whose sensors are in the low legs.
fn run(sensors: &str, controller: &str, rpm: f64) -> Run {
    run_on(sensors, LOW_SIDE, controller, rpm)
}

/// The same on a plant with its own sensors.
fn run_on(sensors: &str, own: &str, controller: &str, rpm: f64) -> Run {
    run_with(sensors, own, controller, rpm, |_| {})
}

/// The same on a plant that differs from its specification.
fn run_with(
    sensors: &str,
    own: &str,
    controller: &str,
    rpm: f64,
    change: fn(&mut PlantParams),
) -> Run {
    let checked = |sensors: &str| {
        let text = specification(sensors, controller);
        parse_toml(&text, "m.toml")
            .and_then(|ast| check(&ast))
            .expect("a right specification")
    };
    let (spec, origins) = checked(sensors);
    let generated = generate(&spec, &origins).expect("a drive");
    let mut drive = Interpreted::new(generated.graph.program(), &generated.interface);
    drive.set_current(20 << 16);
    let mut params = plant_of(&checked(own).0);
    change(&mut params);
    let mut plant = Plant::new(params, 0.117, rpm * TAU / 60.0).expect("a plant");
    let mut pending = AnyCommand::default();
    let mut torque = 0.0;
    for period in 0..PERIODS {
        let sampled = plant.sample(pending);
        let command = drive.step(&sampled);
        let applied = std::mem::replace(&mut pending, command);
        plant.run_period(applied, &mut ());
        if period >= SETTLED {
            torque += plant.truth().mean_torque / f64::from(PERIODS - SETTLED);
        }
    }
    Run {
        blind: plant.blind_samples(),
        torque,
        turn_ons: plant.turn_ons(),
        fault: drive.fault(),
    }
}

/// The same controller with its sensors in any two legs, and unlike: it reads the currents of the right ones.
#[test]
fn sensors_of_any_two_legs_show_the_same_torque() {
    let controller = "kind = \"pdcc\"";
    let expected = run(LOW_SIDE, controller, 1500.0).torque;
    for sensors in [
        "sensed_phases = \"bc\"\n",
        "sensed_phases = \"ca\"\n",
        "sensed_phases = \"ca\"\nadc_inverted = [\"on\", \"off\"]\nadc_offset = [2100, 2011]\n",
    ] {
        let sensors = format!("{LOW_SIDE}{sensors}");
        let own = run_on(&sensors, &sensors, controller, 1500.0);
        assert_eq!(own.blind, 0, "{sensors}");
        assert!(
            (own.torque / expected - 1.0).abs() < 0.01,
            "{sensors}: {} Nm",
            own.torque
        );
        let other = run_on(&sensors, LOW_SIDE, controller, 1500.0);
        assert!(
            other.torque < 0.5 * expected,
            "{sensors}: {} Nm",
            other.torque
        );
    }
}

/// Three sensors in the low legs, as hardware has them.
fn three() -> String {
    let one_adc = LOW_SIDE.replace("conversion_time = \"0 us\"", "conversion_time = \"400 ns\"");
    format!("{one_adc}sensed_phases = \"abc\"\n")
}

/// The leg that is highest need not be read: the other two show its current, so that it may be high for longer. Near
/// the voltage limit that is torque; two thirds of the corners of the hexagon lie further out, the others where they
/// were.
#[test]
fn of_three_sensors_two_are_enough_and_the_legs_reach_further() {
    let worsen = |plant: &mut PlantParams| {
        for (channel, sign) in plant.adc.iter_mut().zip([1.0, -1.0, 0.5]) {
            channel.amperes_per_count *= 1.0 + 0.01 * sign;
            channel.offset += 5.0 * sign;
            channel.noise = 1.0;
        }
    };
    for controller in CONTROLLERS {
        for rpm in SPEEDS {
            let two = run(LOW_SIDE, controller, rpm);
            let three = run_with(&three(), &three(), controller, rpm, worsen);
            let text = format!(
                "{controller} at {rpm} rpm: {} and {} Nm",
                two.torque, three.torque
            );
            assert_eq!((three.blind, three.fault), (0, None), "{text}");
            let gained = three.torque / two.torque;
            assert!((0.99..1.2).contains(&gained), "{text}");
            let is_limited = rpm >= 2200.0 && !controller.contains("centred");
            assert!(!is_limited || gained > 1.01, "{text}");
        }
    }
}

/// Controllers that turn a leg off: its current, which may flow through the upper diode, is the rest of the other two.
const TURNING_OFF: [&str; 5] = [
    "kind = \"pdcc\"\nmodulation = \"pair\"\nemf = \"model\"",
    "kind = \"pi-pwm\"\nsix_step = \"on\"",
    "kind = \"fcs-mpc\"",
    "kind = \"fcs-mpc\"\ncandidates = \"all\"",
    "kind = \"phcc\"",
];

#[test]
fn of_three_sensors_two_show_the_current_of_a_leg_that_is_off() {
    // All three conversions end before the next command may turn a leg off.
    let early = three() + "sampling_lead = \"1 us\"\n";
    for controller in TURNING_OFF {
        for rpm in [-1000.0, 300.0, 700.0, 1200.0] {
            let in_phase = run_on("", "", controller, rpm);
            let three = run_on(&early, &early, controller, rpm);
            let text = format!(
                "{controller} at {rpm} rpm: {} and {} Nm",
                three.torque, in_phase.torque
            );
            assert_eq!((three.blind, three.fault), (0, None), "{text}");
            assert!(
                (three.torque / in_phase.torque - 1.0).abs() < 0.03,
                "{text}"
            );
        }
    }
}

/// Their sum shows a sensor that is wrong, and nothing else: no other fault comes first.
#[test]
fn the_sum_of_three_currents_shows_a_wrong_sensor() {
    for sensors in ["sensed_phases = \"abc\"\n".to_owned(), three()] {
        for sensor in 0..3 {
            let change: fn(&mut PlantParams) = match sensor {
                0 => |plant| plant.adc[0].amperes_per_count *= 2.0,
                1 => |plant| plant.adc[1].amperes_per_count *= 2.0,
                _ => |plant| plant.adc[2].amperes_per_count *= 2.0,
            };
            let broken = run_with(&sensors, &sensors, "kind = \"pdcc\"", 500.0, change);
            assert_eq!(broken.fault, Some(Fault::CurrentSum), "{sensors}, {sensor}");
        }
    }
}

/// Each sensor's own gain is in the controller: twice as coarse a sensor leaves the torque as it is.
#[test]
fn sensors_of_different_gains_show_the_same_currents() {
    let alike = run_on("", "", "kind = \"pdcc\"", 800.0);
    for gains in [
        "[\"20 mA/count\", \"35 mA/count\"]",
        "[\"35 mA/count\", \"20 mA/count\"]",
    ] {
        let sensors = format!("adc_gain = {gains}\n");
        let own = run_on(&sensors, &sensors, "kind = \"pdcc\"", 800.0);
        let torque = own.torque / alike.torque;
        assert!(
            (torque - 1.0).abs() < 0.003,
            "{gains}: {torque} times the torque"
        );
    }
}

/// A control period of two PWM periods: the legs switch as often, currents are read half as often, at instants that
/// every command leaves readable.
#[test]
fn a_command_is_repeated_in_each_pwm_period() {
    let controller = "kind = \"pdcc\"";
    let every = run(LOW_SIDE, controller, 1000.0);
    let sensors = format!("{LOW_SIDE}pwm_per_control = 2\n");
    let second = run_on(&sensors, &sensors, controller, 1000.0);
    assert_eq!(second.blind, 0);
    let ratio = second.turn_ons as f64 / every.turn_ons as f64;
    assert!(
        (1.9..2.1).contains(&ratio),
        "{ratio} times as many turn-ons in twice the time"
    );
    let torque = second.torque / every.torque;
    assert!((torque - 1.0).abs() < 0.02, "{torque} times the torque");
}

/// Controllers that may read their currents in the low legs, and speeds up to beyond the limit.
const CONTROLLERS: [&str; 6] = [
    "kind = \"pdcc\"\nsaturation = \"keep_angle\"",
    "kind = \"pdcc\"",
    "kind = \"pdcc\"\ncommon_mode = \"clamped_low\"",
    "kind = \"pdcc\"\ncommon_mode = \"centred\"",
    "kind = \"pi-pwm\"",
    "kind = \"p-pwm\"",
];
const SPEEDS: [f64; 6] = [-1500.0, 300.0, 1000.0, 1500.0, 1800.0, 2200.0];

#[test]
fn an_accepted_drive_has_no_blind_sample() {
    for controller in CONTROLLERS {
        for rpm in SPEEDS {
            let run = run(LOW_SIDE, controller, rpm);
            assert_eq!(run.blind, 0, "{controller} at {rpm} rpm");
        }
    }
}

/// Sensors as hardware has them: one ADC converts both currents, one after the other, with errors of gain and offset
/// and with noise. The errors of gain are of 1 %, those of the mean torque no larger.
#[test]
fn real_sensors_leave_no_sample_blind_and_the_torque_as_it_is() {
    let one_adc = LOW_SIDE.replace("conversion_time = \"0 us\"", "conversion_time = \"1 us\"");
    let worsen = |plant: &mut PlantParams| {
        for (channel, sign) in plant.adc.iter_mut().zip([1.0, -1.0]) {
            channel.amperes_per_count *= 1.0 + 0.01 * sign;
            channel.offset += 5.0 * sign;
            channel.noise = 1.0;
        }
    };
    for controller in CONTROLLERS {
        for rpm in SPEEDS {
            let ideal = run(LOW_SIDE, controller, rpm);
            let real = run_with(&one_adc, &one_adc, controller, rpm, worsen);
            assert_eq!(real.blind, 0, "{controller} at {rpm} rpm");
            let torque = real.torque / ideal.torque;
            assert!(
                (torque - 1.0).abs() < 0.01,
                "{controller} at {rpm} rpm: {torque} times the torque"
            );
        }
    }
}

/// A drive that was told of two ADCs, on a board with one: the second conversion comes too late for its window.
#[test]
fn an_unstated_conversion_time_costs_samples() {
    let one_adc = LOW_SIDE.replace("conversion_time = \"0 us\"", "conversion_time = \"2 us\"");
    let controller = "kind = \"pdcc\"";
    let told = run_on(&one_adc, &one_adc, controller, 1800.0);
    let untold = run_on(LOW_SIDE, &one_adc, controller, 1800.0);
    assert_eq!(told.blind, 0);
    assert!(untold.blind > 50, "{} blind samples", untold.blind);
}

/// The reason for the window: near the voltage limit a controller that does not know of it reads 0 A of legs that carry
/// the whole current.
#[test]
fn without_the_window_the_currents_are_lost() {
    let controller = "kind = \"pdcc\"";
    let (with, without) = (
        run(LOW_SIDE, controller, 1800.0),
        run("", controller, 1800.0),
    );
    assert_eq!(with.blind, 0);
    assert!(without.blind > 50, "{} blind samples", without.blind);
    assert!(
        without.torque < 0.5 * with.torque,
        "{} Nm, {} Nm",
        without.torque,
        with.torque
    );
}

/// Figures of merit of a drive on low-side sensors with this policy for its common mode, at full current.
fn figures(common_mode: &str, rpm: f64) -> FiguresOfMerit {
    let controller = format!("kind = \"pdcc\"\ncommon_mode = \"{common_mode}\"");
    let motor = MotorSource {
        name: "m".to_owned(),
        file: "m.toml".to_owned(),
        text: specification(LOW_SIDE, &controller),
    };
    let drive = prepare(&motor, None).expect("a drive");
    let torque = drive.demand();
    let run = run_of(&drive.spec, rpm * TAU / 60.0, torque);
    let maker = drive.maker(Model::Fixed, drive.set_point(torque));
    let measured = measure(&plant_of(&drive.spec), &run, maker).expect("a plant");
    assert_eq!(measured.tripped, None);
    measured.figures
}

/// A leg that stays low for a third of the turn does not switch in it. The price is at most 0.9 points of ripple, peak
/// to peak.
#[test]
fn clamped_legs_switch_a_third_less_for_little_more_ripple() {
    for rpm in [400.0, 1000.0, 1500.0] {
        let [centred, readable, clamped] =
            ["centred", "readable", "clamped_low"].map(|policy| figures(policy, rpm));
        let switching = |of: &FiguresOfMerit| of.switching_hz.expect("is counted") / 20e3;
        let of_each = [&centred, &readable, &clamped].map(switching);
        let text = format!("{of_each:?} of 20 kHz at {rpm} rpm");
        assert!((of_each[0] - 1.0).abs() < 1e-9, "{text}");
        // A leg that reaches an end of the period does not switch in it.
        assert!((0.94..=1.0).contains(&of_each[1]), "{text}");
        assert!((0.64..0.67).contains(&of_each[2]), "{text}");
        let ripple = |of: &FiguresOfMerit| of.ripple_pp_pct.zip(of.ripple_rms_pct);
        let (pp, rms) = ripple(&clamped).expect("has torque");
        let (pp_centred, rms_centred) = ripple(&centred).expect("has torque");
        let text = format!("{pp} % pp, {rms} % RMS; centred {pp_centred} %, {rms_centred} %");
        assert!(pp < pp_centred + 0.9, "{text} at {rpm} rpm");
        assert!(rms < rms_centred + 0.1, "{text} at {rpm} rpm");
    }
}
