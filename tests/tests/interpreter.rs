//! The interpreted IR equals the bit-true model in every output and state bit.

use hexagen_codegen::ir::{Machine, Output, Program};
use hexagen_tests::covering::SPECIFICATIONS;
use hexagen_tests::interpreter::{compare, compare_all_set_points, compare_states};
use hexagen_tests::is_whole;
use hexagen_tests::library::{Motor, PAPER_MOTOR, motor, motors};
use hexagen_tests::options::{Kind, Meeting, generate_toml, kind, kinds};
use hexagen_tests::sensors::assert_graph_is_model;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Steps of the paper's default drive of each kind.
const DEFAULT_STEPS: u64 = 100_000;

/// Steps of each element of the full product; the seeds differ, so all streams take part.
const PRODUCT_STEPS: u64 = 500;

/// Elements of a kind's product in a push; the environment's `HEXAGEN_WHOLE_PRODUCTS` takes all.
const MOST_OF_A_PRODUCT: usize = 2_500;

/// Steps of each row of the covering arrays.
const ROW_STEPS: u64 = 4_000;

/// Drives of each library motor and kind, in a push and in the nightly run, and steps of each of them.
const SAMPLE: [usize; 2] = [8, 24];
const SAMPLE_STEPS: u64 = 2_000;

/// Codes of options that exclude each other, and of boards whose legs exclude an option.
const RULED_OUT: [&str; 4] = [
    "DependentField",
    "IntervalsUnavailable",
    "OptionWithoutEffect",
    "UnreadableLeg",
];

/// Results of many drives.
#[derive(Debug, Default)]
struct Tally {
    compared: usize,
    steps: u64,
    /// Codes of the diagnostics that rejected a drive, with the number of drives and the first one.
    refused: BTreeMap<String, (usize, String)>,
    failures: Vec<String>,
    /// Values of independent options met with those of others, and the first choice with each value
    /// of the others.
    met: BTreeSet<Meeting>,
    shown: BTreeMap<(usize, usize), Vec<usize>>,
}

impl Tally {
    fn of(kind: &Kind, motor: &Motor, choice: &[usize], steps: u64, seed: u64) -> Self {
        let name = || format!("{}: {}", motor.name, kind.describe(choice));
        let mut tally = Self::default();
        match generate_toml(&kind.drive_toml(motor, choice, None)) {
            Err(errors) => {
                for error in errors {
                    tally.refused.insert(
                        format!("{:?}", error.code),
                        (1, format!("{}\n      {error}", name())),
                    );
                }
            }
            Ok((_, generated)) => {
                tally.compared = 1;
                tally.met = kind.meetings(choice).into_iter().collect();
                let shown = tally.met.iter().map(|(_, value)| (*value, choice.to_vec()));
                tally.shown = shown.collect();
                let program = generated.graph.program();
                // A step from an arbitrary state costs as much as many of a stream, and finds as
                // much.
                let from_states = steps / 8;
                let compared = compare(&generated, program, steps, seed).and_then(|report| {
                    compare_states(&generated, program, from_states, seed).map(|()| report)
                });
                match compared {
                    Ok(report) => tally.steps = report.steps + from_states,
                    Err(what) => tally.failures.push(format!("{}\n{what}", name())),
                }
            }
        }
        tally
    }

    fn add(mut self, other: Self) -> Self {
        self.compared += other.compared;
        self.steps += other.steps;
        self.failures.extend(other.failures);
        self.met.extend(other.met);
        for (value, choice) in other.shown {
            self.shown.entry(value).or_insert(choice);
        }
        for (code, (count, example)) in other.refused {
            let entry = self.refused.entry(code).or_insert((0, example));
            entry.0 += count;
        }
        self
    }

    fn check(&self, what: &str) {
        println!(
            "{what}: {} drives compared over {} steps",
            self.compared, self.steps
        );
        for (code, (count, example)) in &self.refused {
            println!("  refused by {code}: {count}, such as {example}");
        }
        assert!(
            self.failures.is_empty(),
            "{what}: {} of {} drives differ from the model, such as\n{}",
            self.failures.len(),
            self.compared,
            self.failures
                .iter()
                .take(3)
                .cloned()
                .collect::<Vec<_>>()
                .join("\n")
        );
    }
}

/// Elements of the product in an order of which any part visits all values of every axis: the
/// stride is coprime to the axes' lengths.
fn spread_element(kind: &Kind, index: usize) -> Vec<usize> {
    kind.product_element(index * 13_831 % kind.product_len())
}

#[test]
fn every_set_point_of_the_paper_motor() {
    let kind = kind("pdcc");
    let choice = kind.choice_of(&[("v_bus", "measured")]);
    let toml = kind.drive_toml(&motor(PAPER_MOTOR), &choice, None);
    let (_, generated) = generate_toml(&toml).expect("the paper's motor generates");
    compare_all_set_points(&generated, generated.graph.program())
        .unwrap_or_else(|what| panic!("{what}"));
}

#[test]
fn default_drive_of_the_paper_motor() {
    for kind in kinds() {
        let toml = kind.drive_toml(&motor(PAPER_MOTOR), &kind.choice_of(&[]), None);
        let (_, generated) = generate_toml(&toml).expect("the paper's motor generates");
        let program = generated.graph.program();
        let report =
            compare(&generated, program, DEFAULT_STEPS, 1).unwrap_or_else(|what| panic!("{what}"));
        println!("{}: {report}", kind.name);
        compare_states(&generated, program, DEFAULT_STEPS, 1)
            .unwrap_or_else(|what| panic!("{what}"));
    }
}

#[test]
fn every_pair_of_option_values() {
    let rows = SPECIFICATIONS.par_iter().enumerate();
    rows.for_each(|(seed, row)| assert_graph_is_model(row.what, row.toml, ROW_STEPS, seed as u64));
}

/// All combinations of the options that depend on each other, or [`MOST_OF_A_PRODUCT`] of them. The
/// independent ones alternate; then each of their values follows with the values of other options that
/// it has not met.
#[test]
fn full_product_of_options_on_the_paper_motor() {
    let paper = motor(PAPER_MOTOR);
    for kind in kinds() {
        let most = if is_whole() {
            usize::MAX
        } else {
            MOST_OF_A_PRODUCT
        };
        let compared = |choices: Vec<Vec<usize>>| {
            let choices = choices.into_par_iter().enumerate();
            choices
                .map(|(seed, choice)| Tally::of(&kind, &paper, &choice, PRODUCT_STEPS, seed as u64))
                .reduce(Tally::default, Tally::add)
        };
        let elements = 0..kind.product_len().min(most);
        let first = compared(elements.map(|k| spread_element(&kind, k)).collect());
        let mut missing = BTreeSet::new();
        for (loose, value) in kind.all_meetings() {
            let shown = first.shown.get(&value);
            let shown = shown.unwrap_or_else(|| panic!("{}: {value:?} never shows", kind.name));
            if !first.met.contains(&(loose, value)) {
                let mut choice = shown.clone();
                choice[loose.0] = loose.1;
                missing.insert(choice);
            }
        }
        let tally = first.add(compared(missing.into_iter().collect()));
        tally.check(&format!("full product of {}", kind.name));
        let all: BTreeSet<Meeting> = kind.all_meetings().collect();
        assert_eq!(tally.met, all);
        let is_known = |code: &String| RULED_OUT.contains(&code.as_str());
        assert!(
            !tally.refused.is_empty() && tally.refused.keys().all(is_known),
            "refused for another reason than options that rule each other out"
        );
    }
}

#[test]
fn every_library_motor_in_a_sample_of_the_product() {
    let motors = motors();
    let sample = SAMPLE[usize::from(is_whole())];
    for kind in kinds() {
        let tally = (0..motors.len() * sample)
            .into_par_iter()
            .map(|index| {
                let motor = &motors[index % motors.len()];
                let choice = spread_element(&kind, index);
                Tally::of(&kind, motor, &choice, SAMPLE_STEPS, index as u64)
            })
            .reduce(Tally::default, Tally::add);
        tally.check(&format!("library sample of {}", kind.name));
        // One vector can be too strong for a motor, a sector too short for a gap of Hall codes, and 16 bits too few for a
        // speed loop.
        let is_known = |(code, (_, example)): (&String, &(usize, String))| {
            RULED_OUT.contains(&code.as_str())
                || code == "VectorTooStrong"
                || code == "WordTooNarrow" && example.contains("`k_speed`")
                || code == "OutOfRange" && example.contains("`hall_glitches`")
        };
        assert!(tally.refused.iter().all(is_known));
    }
}

/// The ratio of bus and spread drops bits of voltages below the count where a period has more counts than 16
/// bits hold.
#[test]
fn long_periods_limit_the_voltage() {
    let text = motor(PAPER_MOTOR).text.replace("20 kHz", "2 kHz");
    let text = text.replace("timer_clock = \"72 MHz\"", "timer_clock = \"180 MHz\"");
    for options in ["", "modulation = \"table2\"\n"] {
        let lines = format!("[controller]\nsaturation = \"keep_angle\"\n{options}");
        let text = text.replacen("[controller]\n", &lines, 1);
        assert_graph_is_model(options, &text, ROW_STEPS, 1);
    }
}

/// A drive's angle per period, in degrees, at a constant speed of the rotor in degrees per period.
fn angle_per_period(program: &Program, degrees: f64) -> f64 {
    const CODES: [i32; 6] = [0b001, 0b101, 0b100, 0b110, 0b010, 0b011];
    const TICKS: f64 = 50.0;
    let mut probe = program.clone();
    let mut values = probe.step.values();
    let angle = values.find(|&value| probe.step.node(value).name == "step_angle_next");
    probe.step.outputs = vec![(
        Output::Probe("step_angle"),
        angle.expect("the rotor is followed"),
    )];
    let mut machine = Machine::of_program(&probe);
    let mut seen = 0;
    for period in 0..200 {
        // Sixths of a turn since the beginning of sector 1.
        let sixths = (10.0 + f64::from(period) * degrees + 30.0) / 60.0;
        let edge = if degrees > 0.0 {
            sixths.floor()
        } else {
            sixths.ceil()
        };
        let since = (sixths - edge) * 60.0 / degrees * TICKS;
        let hall = CODES[sixths.rem_euclid(6.0) as usize];
        let inputs = probe
            .step
            .inputs
            .iter()
            .map(|input| match input.name.as_str() {
                "i_a" | "i_b" => 0,
                "hall" => hall,
                _ => since as i32,
            });
        let inputs: Vec<i32> = inputs.collect();
        seen = machine.step(&inputs).expect("stays in its intervals")[0];
    }
    f64::from(seen) * 360.0 / f64::from(32).exp2()
}

/// Only the rotor's speed reveals it: model and generator limit it by constants of their own.
#[test]
fn the_rotors_angle_per_period_is_limited_to_30_degrees() {
    let lines = "[controller]\nhall_capture = \"timer\"\nemf = \"model\"\n";
    let text = motor(PAPER_MOTOR).text.replacen("[controller]\n", lines, 1);
    let text = text.replacen(
        "[inverter]\n",
        "[inverter]\nmaximum_speed = \"45000 rpm\"\n",
        1,
    );
    let (_, generated) = generate_toml(&text).unwrap_or_else(|errors| panic!("{errors}"));
    for degrees in [3.0, 11.0, 20.0, 28.0, 29.5, 30.5, 33.0, 41.0, 52.0] {
        for turned in [degrees, -degrees] {
            let seen = angle_per_period(generated.graph.program(), turned);
            // A turn is measured to two ticks, of 600 or more at up to 30 degrees, and the change of half a
            // turn's time, which counts 7/3 times, to three.
            let believed = f64::min(degrees, 30.0).copysign(turned);
            let limit = degrees.powi(2) / 2000.0;
            assert!((seen - believed).abs() < limit, "{turned}: {seen}");
            assert!(seen.abs() < 30.0 + 1e-6, "{turned}: {seen}");
        }
    }
}
