//! Drives with other current sensors than two alike in phases a and b: in the low legs, of other
//! phases, unlike, or read less often than once in a PWM period.

use crate::interpreter::{compare, compare_states};
use crate::options::generate_toml;

/// The paper's motor, with fields of its inverter to come.
const MOTOR: &str = r#"[motor]
pole_pairs = 4
resistance = "135 mohm per_phase"
inductance = "0.22 mH per_phase"
winding = "star"
back_emf = "0.1648 V/(rad/s) line_to_line peak"
emf_shape = "trapezoidal"
rated_current = "20 A peak"
rated_speed = "1600 rpm"
[inverter]
bus_voltage = "48 V"
f_pwm = "20 kHz"
timer_clock = "72 MHz"
adc_bits = 12
adc_range = "40 A"
dead_time = "500 ns"
"#;

/// Few enough samples of a calibration for many start-ups.
pub const SHORT: &str = "calibration_samples = 16\n";

/// Sensors in the phases.
const SENSORS: [&str; 9] = [
    "sensed_phases = \"bc\"",
    "sensed_phases = \"ca\"\nadc_inverted = \"on\"",
    "adc_inverted = [\"off\", \"on\"]\nadc_offset = [2048, 1990]",
    "sensed_phases = \"bc\"\nadc_inverted = [\"on\", \"off\"]\nadc_offset = [2100, 2011]",
    "sensed_phases = \"ca\"\nadc_offset = [2000, 2048]\nprecharge = \"0.2 ms\"",
    "sensed_phases = \"abc\"\ncurrent_sum_samples = 3",
    "sensed_phases = \"abc\"\nadc_inverted = [\"on\", \"off\", \"on\"]\nadc_offset = [2100, 2011, 2050]",
    "adc_gain = [\"20 mA/count\", \"31 mA/count\"]",
    "sensed_phases = \"abc\"\nadc_gain = [\"20 mA/count\", \"25 mA/count\", \"18 mA/count\"]\ncurrent_sum_tolerance = \"5 A\"",
];

/// Sensors in the low legs.
pub const LOW_SIDE: &str = r#"current_sensing = "low_side"
settling_time = "1 us"
aperture_time = "200 ns"
conversion_time = "0 us"
"#;

const CONTROLLERS: [&str; 5] = [
    "kind = \"pdcc\"",
    "kind = \"pdcc\"\nmodulation = \"pair\"\nemf = \"model\"\nword = 16",
    "kind = \"fcs-mpc\"",
    "kind = \"phcc\"",
    "kind = \"pi-pwm\"",
];

/// Controllers with several periods of the PWM in one of theirs.
const SLOW: [&str; 3] = [
    "kind = \"pdcc\"\ndead_time_compensation = \"on\"",
    "kind = \"pdcc\"\nmodulation = \"pair\"\nemf = \"model\"",
    "kind = \"pi-pwm\"\nbandwidth = \"500 Hz\"",
];

/// A drive's specification: fields of the inverter, and the controller's section.
pub fn specification(inverter: &str, controller: &str) -> String {
    let motor = if inverter.contains("adc_gain") {
        MOTOR.replace("adc_range = \"40 A\"\n", "")
    } else {
        MOTOR.to_owned()
    };
    let place = if inverter.contains("current_sensing") {
        ""
    } else {
        "current_sensing = \"in_phase\"\n"
    };
    format!("{motor}{place}{inverter}\n[controller]\n{controller}\n")
}

/// What each drive is, and its specification.
pub fn drives() -> Vec<(String, String)> {
    let each = |inverter: String, controllers: &'static [&'static str]| {
        controllers.iter().map(move |controller| {
            let what = format!("{inverter}, {controller}").replace('\n', ", ");
            let inverter = format!("{SHORT}{inverter}");
            (what, specification(&inverter, controller))
        })
    };
    let slower = [
        each(
            "pwm_per_control = 3\nsensed_phases = \"bc\"".to_owned(),
            &SLOW,
        ),
        each(format!("pwm_per_control = 3\n{LOW_SIDE}"), &SLOW[..1]),
        each("pwm_per_control = 2".to_owned(), &["kind = \"fcs-mpc\""]),
    ];
    let in_phase = SENSORS
        .iter()
        .flat_map(|sensors| each((*sensors).to_owned(), &CONTROLLERS));
    let low_side = SENSORS.iter().flat_map(|sensors| {
        let inverter = format!("{sensors}\n{LOW_SIDE}");
        each(inverter, &["kind = \"pdcc\"", "kind = \"p-pwm\""])
    });
    in_phase
        .chain(low_side)
        .chain(slower.into_iter().flatten())
        .collect()
}

/// The interpreted graph of a drive takes the model's steps: so many of a stream, and a fourth of them
/// from arbitrary states.
///
/// # Panics
/// At a difference, or if the drive does not generate.
pub fn assert_graph_is_model(what: &str, toml: &str, steps: u64, seed: u64) {
    let (_, generated) = generate_toml(toml).unwrap_or_else(|errors| panic!("{what}: {errors}"));
    let program = generated.graph.program();
    compare(&generated, program, steps, seed).unwrap_or_else(|why| panic!("{what}: {why}"));
    compare_states(&generated, program, steps / 4, seed)
        .unwrap_or_else(|why| panic!("{what}: {why}"));
}
