//! Drives whose current sensors are in other phases than a and b, or unlike: interpreted, and compiled as in firmware,
//! they equal the bit-true model; the supervisor watches the right phases.

use hexagen::{Drive, Fault, LegState, Sample, controller, verify};
use hexagen_tests::sensors::{assert_graph_is_model, drives};

/// Steps of each drive's stream, and a fourth of them from arbitrary states.
const STEPS: u64 = 6_000;

#[test]
fn graph_and_model_agree() {
    for (what, toml) in drives() {
        assert_graph_is_model(&what, &toml, STEPS, 11);
    }
}

/// Drives of the paper's motor.
macro_rules! drives {
    ($($name:ident { $($sensors:tt)* })*) => {$(
        controller! {
            pub $name {
                motor: "../targets/motors/trivedi-keshri-660w.toml",
                inverter: { $($sensors)* },
                controller: pdcc { emf: estimated },
            }
        }
    )*};
}

drives! {
    OfBAndC { sensed_phases: bc }
    OfCAndA { sensed_phases: ca, adc_inverted: on }
    Unlike { adc_inverted: [off, on], adc_offset: [2048, 1990] }
    UnlikeOfCAndA { sensed_phases: ca, adc_inverted: [on, off], adc_offset: [2100, 2011] }
    UnlikeGains { adc_gain: [20 mA/count, 31 mA/count] }
    Three { sensed_phases: abc, adc_offset: [2100, 2011, 2048] }
    ThreeInLowLegs {
        sensed_phases: abc,
        current_sensing: low_side,
        settling_time: 1 us,
        aperture_time: 200 ns,
        conversion_time: 400 ns,
        current_adcs: 2,
    }
}

verify!(
    OfBAndC,
    OfCAndA,
    Unlike,
    UnlikeOfCAndA,
    UnlikeGains,
    Three,
    ThreeInLowLegs
);

/// Three sensors whose currents do not add up trip after the stated samples in a row, no sooner.
#[test]
fn three_currents_that_do_not_add_up_trip() {
    let mut drive = Drive::<Three>::new();
    // A start without Hall edges ends after its time.
    let of = |c: u16| Sample::with_hall([2100, 2011], 0b101).third_current(c);
    while !drive.status().is_running() {
        drive.step(&of(2048));
    }
    for c in [2048 + 300, 2048 - 300] {
        for _ in 0..19 {
            drive.step(&of(c));
        }
        assert_eq!(drive.status().fault, None, "{c}");
        drive.step(&of(2048));
    }
    for _ in 0..19 {
        drive.step(&of(2348));
    }
    assert_eq!(drive.status().fault, None);
    drive.step(&of(2348));
    assert_eq!(drive.status().fault, Some(Fault::CurrentSum));
}

/// A sample of the three phases' currents, counts above the middle.
fn sample([a, b, c]: [i32; 3]) -> Sample {
    let [a, b, c] = [a, b, c].map(|counts| (2048 + counts) as u16);
    Sample::with_hall([a, b], 0b101).third_current(c)
}

#[test]
fn each_phase_trips_and_a_count_without_a_sensor_says_nothing() {
    // The trip level lies between; one phase each is above it, first that without a sensor.
    for far in [[0, 995, 995], [0, 1990, -995], [0, -995, 1990]] {
        let mut drive = Drive::<OfBAndC>::new();
        drive.step(&sample(far));
        assert_eq!(drive.status().fault, Some(Fault::OverCurrent), "{far:?}");
    }
    let mut drive = Drive::<OfBAndC>::new();
    drive.step(&sample([1990, 900, -900]));
    assert_eq!(drive.status().fault, None);
    // Phase a has no sensor: any count of it passes.
    for counts in [0, 2048, 4095, 65535] {
        let mut drive = Drive::<OfBAndC>::new();
        let legs = drive.step(&Sample::with_hall([counts, 2050], 0b101).third_current(2046));
        assert_eq!(drive.status().fault, None, "{counts}");
        assert_eq!(legs.state(), [LegState::Pulsed; 3]);
        let end = Sample::with_hall([2048, 2048], 0b101).third_current(counts);
        drive.step(&end);
        let fault = (counts != 2048).then_some(Fault::AdcRange);
        assert_eq!(drive.status().fault, fault, "{counts}");
    }
}
