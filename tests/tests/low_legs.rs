//! Drives whose legs must be low for a while in every period: the interpreted graph equals the bit-true model, and no
//! command leaves the range in which each leg can be read.

use hexagen_codegen::ir::{Output, Phase};
use hexagen_lab::formats;
use hexagen_reference::verify::{Action, Context, Stimulus};
use hexagen_reference::{BitTrue, FormatTable, Mode, Spec};
use hexagen_tests::options::generate_toml;
use hexagen_tests::sensors::{LOW_SIDE, assert_graph_is_model, specification};

/// Steps of each drive's stream, and a fourth of them from arbitrary states.
const STEPS: u64 = 4_000;

const BUS: &str = "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"80 V\"\n";

const BOOTSTRAP: &str = "minimum_low_time = \"4 us\"\n";

const THREE: &str = "sensed_phases = \"abc\"\n";

const CONTROLLERS: [&str; 7] = [
    "kind = \"pdcc\"\nsaturation = \"keep_angle\"",
    "kind = \"pdcc\"\nsaturation = \"nearest\"\ndead_time_compensation = \"on\"",
    "kind = \"pdcc\"\nemf = \"model\"\nadvance = 2",
    "kind = \"pdcc\"\nemf = \"held\"",
    "kind = \"pi-pwm\"",
    "kind = \"pi-pwm\"\nsaturation = \"torque_priority\"\nemf = \"model\"\nword = 16",
    "kind = \"p-pwm\"",
];

/// The default, and each common mode by name.
const COMMON_MODES: [&str; 4] = [
    "",
    "common_mode = \"centred\"",
    "common_mode = \"readable\"",
    "common_mode = \"clamped_low\"",
];

fn each_drive(check: impl Fn(&str, &str)) {
    let measured = format!("{LOW_SIDE}{BUS}");
    let three = format!("{LOW_SIDE}{THREE}");
    let three_measured = format!("{measured}{THREE}");
    for inverter in ["", LOW_SIDE, BOOTSTRAP, &measured, &three, &three_measured] {
        for controller in CONTROLLERS {
            for common_mode in COMMON_MODES {
                let text = specification(inverter, &format!("{controller}\n{common_mode}"));
                check(&format!("{inverter}{controller}\n{common_mode}"), &text);
            }
        }
    }
}

#[test]
fn graph_and_model_agree() {
    each_drive(|name, text| assert_graph_is_model(name, text, STEPS, 7));
}

/// Largest compare value of the highest leg, and of the second: 0.94 and 0.992 of 1800 counts, for 1.5 us before the
/// turning point and 0.2 us behind it.
fn tops(text: &str) -> [u16; 2] {
    let is_spared = text.contains("abc") && !text.contains("centred");
    if text.contains("low_side") {
        [if is_spared { 1785 } else { 1692 }, 1692]
    } else if text.contains("minimum_low_time") {
        [1656; 2]
    } else {
        [1800; 2]
    }
}

/// Of three sensors those of the two lower legs are read: no step of a stream makes two legs higher than they may be,
/// and some make the highest of them higher.
#[test]
fn the_second_highest_leg_can_always_be_read() {
    each_drive(|name, text| {
        let (_, generated) =
            generate_toml(text).unwrap_or_else(|errors| panic!("{name}: {errors}"));
        let interface = &generated.interface;
        let spec = Spec::from_toml(&interface.spec_toml).expect("a specification");
        let table = FormatTable::new(&formats(&interface.formats));
        let mut model: BitTrue = BitTrue::new(&spec, &table).expect("a model");
        let mut stimulus = Stimulus::new(&spec, 3).expect("a stimulus");
        let [top, second_top] = tops(text);
        let mut largest = 0;
        for _ in 0..10 * STEPS {
            let context = Context {
                offset: model.offset_counts(),
                tripped: model.mode() == Mode::Tripped,
            };
            let (action, sample) = stimulus.next(&context);
            match action {
                Some(Action::SetCurrent(bits)) => model.set_current(bits),
                Some(Action::SetBus(counts)) => model.set_bus(counts),
                Some(Action::Reset) => model.reset(),
                _ => {}
            }
            let legs = model.step(&sample);
            stimulus.respond(legs);
            let mut compares = legs.compare();
            compares.sort_unstable();
            let [_, second, highest] = compares;
            assert!(highest <= top && second <= second_top, "{name}: {legs:?}");
            largest = largest.max(highest);
        }
        assert_eq!(largest, top, "{name}");
    });
}

/// The verifier has proved these intervals; the largest compare value is worked out here once more.
#[test]
fn every_compare_value_leaves_each_leg_its_low_time() {
    each_drive(|name, text| {
        let (_, generated) =
            generate_toml(text).unwrap_or_else(|errors| panic!("{name}: {errors}"));
        let [top, _] = tops(text).map(i64::from);
        let step = &generated.graph.program().step;
        for phase in Phase::ALL {
            let mut outputs = step.outputs.iter();
            let output = outputs.find(|(output, _)| *output == Output::Compare(phase));
            let (_, value) = output.expect("a compare value");
            let interval = step.node(*value).interval;
            assert!(
                interval.low >= 0 && interval.high <= top,
                "{name}: {interval:?}"
            );
        }
    });
}
