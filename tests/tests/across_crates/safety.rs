//! Response of a drive to invalid input, and start-up: one scenario each, on the step of firmware.

use hexagen::fixed::types::I16F16;
use hexagen::{Control, Drive, Fault, LegState, Legs, Mode, Sample};
use hexagen_lab::Interpreted;
use hexagen_reference::verify::Subject;
use hexagen_tests::library::{PAPER_MOTOR, motor};
use hexagen_tests::options::generate_toml;

hexagen::controller! {
    /// Twelve bits over 40 A, offset 2048, tolerance 2 A (102 counts); trip at 38 A.
    pub Guarded {
        motor: {
            pole_pairs: 4,
            resistance: 135 mohm per_phase,
            inductance: 0.22 mH per_phase,
            winding: star,
            back_emf: 0.1648 V/(rad/s) line_to_line peak,
            emf_shape: trapezoidal,
            rated_current: 20 A,
            rated_torque: 3.3 Nm,
            rated_speed: 2000 rpm,
        },
        inverter: {
            bus_voltage: 48 V,
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            adc_bits: 12,
            adc_range: 40 A,
            current_sensing: in_phase,
            offset_tolerance: 2 A,
            calibration_samples: 16,
            precharge: 200 us,
            stall_timeout: 1 ms,
        },
        controller: pdcc { emf: estimated },
    }
}

const ZERO: u16 = 2048;
const HALL: u8 = 0b101;

fn step<C: Control<Command = Legs>>(drive: &mut Drive<C>, adc: [u16; 2], hall: u8) -> Legs {
    drive.step(&Sample::with_hall(adc, hall))
}

fn quiet(drive: &mut Drive<Guarded>, periods: usize) -> Legs {
    (0..periods).fold(Legs::OFF, |_, _| step(drive, [ZERO; 2], HALL))
}

#[test]
fn an_adc_at_an_end_of_its_range_trips_at_once() {
    for count in [0, 4095, 4096, u16::MAX] {
        for on_a in [true, false] {
            let mut drive = Drive::<Guarded>::new();
            quiet(&mut drive, 3);
            let adc = if on_a { [count, ZERO] } else { [ZERO, count] };
            let legs = step(&mut drive, adc, HALL);
            assert_eq!(drive.status().fault, Some(Fault::AdcRange), "{count}");
            assert_eq!(legs, Legs::OFF);
            assert_eq!(quiet(&mut drive, 100), Legs::OFF, "the trip is latched");
        }
    }
}

hexagen::controller! {
    /// As `Guarded`, except for a trip level that a count at an end need not exceed.
    pub Late {
        motor: {
            pole_pairs: 4,
            resistance: 135 mohm per_phase,
            inductance: 0.22 mH per_phase,
            winding: star,
            back_emf: 0.1648 V/(rad/s) line_to_line peak,
            emf_shape: trapezoidal,
            rated_current: 20 A,
            rated_speed: 2000 rpm,
        },
        inverter: {
            bus_voltage: 48 V,
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            adc_bits: 12,
            adc_range: 40 A,
            current_sensing: in_phase,
            offset_tolerance: 2 A,
            trip_current: 39.5 A,
            calibration_samples: 16,
        },
        controller: pdcc { emf: estimated },
    }
}

/// With every accepted offset, a count at an end trips, distinct from an over-current.
fn check_ends<C: Control<Command = Legs>>() {
    for offset in [ZERO - 102, ZERO, ZERO + 102] {
        for count in [0, 4095] {
            for adc in [[count, offset], [offset, count]] {
                let mut drive = Drive::<C>::new();
                drive.calibrate();
                for _ in 0..100 {
                    step(&mut drive, [offset; 2], HALL);
                }
                assert!(drive.status().is_running());
                assert_eq!(step(&mut drive, adc, HALL), Legs::OFF, "{offset}: {adc:?}");
                let fault = drive.status().fault;
                assert_eq!(fault, Some(Fault::AdcRange), "{offset}: {adc:?}");
            }
        }
    }
}

#[test]
fn an_adc_at_an_end_trips_with_any_accepted_offset() {
    check_ends::<Guarded>();
    check_ends::<Late>();
}

/// A trip level of 1944 counts is the current of the topmost count with an offset of 2151: from a
/// tolerance of 103 counts on, that count has a fault of its own.
#[test]
fn an_adc_at_an_end_trips_with_any_tolerance_of_offsets() {
    const TRIP: i32 = 1944;
    let amperes = |counts: f64| counts * 40.0 / 2048.0;
    let paper = motor(PAPER_MOTOR).text;
    for tolerance in [1, 60, 101, 102, 103, 104, 105, 150] {
        let lines = format!(
            "[inverter]\ntrip_current = \"{} A\"\noffset_tolerance = \"{} A\"\ncalibration_samples = 16\n",
            amperes(TRIP.into()),
            amperes(f64::from(tolerance) + 0.01),
        );
        let (_, generated) = generate_toml(&paper.replacen("[inverter]\n", &lines, 1))
            .unwrap_or_else(|errors| panic!("{tolerance}: {errors}"));
        let program = generated.graph.program();
        for offset in [2048 - tolerance, 2048, 2048 + tolerance] {
            for count in [0, 1, 4094, 4095, 4096] {
                for adc in [[count, offset], [offset, count]] {
                    let mut drive = Interpreted::new(program, &generated.interface);
                    drive.calibrate();
                    let mut step = |adc: [u16; 2]| {
                        drive.step(&Sample::with_hall(adc, HALL));
                        assert_eq!(drive.escape(), None);
                        drive.fault()
                    };
                    for _ in 0..100 {
                        assert_eq!(step([offset; 2]), None, "{tolerance}");
                    }
                    let fault = if [0, 4095, 4096].contains(&count) {
                        Some(Fault::AdcRange)
                    } else if i32::from(count.abs_diff(offset)) > TRIP {
                        Some(Fault::OverCurrent)
                    } else {
                        None
                    };
                    assert_eq!(step(adc), fault, "{tolerance} {offset}: {adc:?}");
                }
            }
        }
    }
}

#[test]
fn over_current_trips_by_either_phase_and_by_the_third() {
    // 38 A are 1945.6 counts; i_c = -(i_a + i_b).
    for adc in [
        [ZERO + 1946, ZERO],
        [ZERO, ZERO - 1946],
        [ZERO + 980, ZERO + 980],
    ] {
        let mut drive = Drive::<Guarded>::new();
        assert_eq!(step(&mut drive, adc, HALL), Legs::OFF);
        assert_eq!(drive.status().fault, Some(Fault::OverCurrent));
    }
    let mut drive = Drive::<Guarded>::new();
    step(&mut drive, [ZERO + 1940, ZERO], HALL);
    assert_eq!(drive.status().fault, None);
}

#[test]
fn invalid_hall_codes_trip() {
    // A code of more than three bits is invalid, whatever its lower three.
    for hall in [0, 7, 8, 0b1000 | HALL, 0b1111, 0x80 | HALL, u8::MAX] {
        let mut drive = Drive::<Guarded>::new();
        assert_eq!(step(&mut drive, [ZERO; 2], hall), Legs::OFF);
        assert_eq!(drive.status().fault, Some(Fault::Hall));
        // With an over-current, too.
        let mut drive = Drive::<Guarded>::new();
        assert_eq!(step(&mut drive, [ZERO + 1946, ZERO], hall), Legs::OFF);
        assert_eq!(drive.status().fault, Some(Fault::Hall));
    }
}

#[test]
fn calibration_averages_then_charges_then_runs() {
    let mut drive = Drive::<Guarded>::new();
    drive.calibrate();
    for _ in 0..16 {
        assert_eq!(step(&mut drive, [ZERO + 100, ZERO - 50], HALL), Legs::OFF);
        assert!(!drive.status().is_running());
    }
    for period in 0..4 {
        assert!(!drive.status().is_running(), "{period}");
        assert_eq!(step(&mut drive, [ZERO + 100, ZERO - 50], HALL), Legs::LOW);
    }
    assert!(drive.status().is_running());
    // The new zero is 2148 and 1998 counts: no current, so the legs are at half.
    let legs = step(&mut drive, [ZERO + 100, ZERO - 50], HALL);
    assert_eq!(legs.compare(), [900; 3]);
}

/// The effective offsets, in counts: a new drive has the nominal ones.
fn offsets(drive: &Drive<Guarded>) -> [i32; 2] {
    let words = |drive: &Drive<Guarded>| {
        let mut words = vec![0; Drive::<Guarded>::state_names().count()];
        drive.state_words(&mut words);
        let place = |name| Drive::<Guarded>::state_names().position(|known| known == name);
        ["offset_a", "offset_b"].map(|name| words[place(name).expect("a word of every drive")])
    };
    let unit = words(&Drive::<Guarded>::new())[0] / i32::from(ZERO);
    words(drive).map(|word| {
        assert_eq!(word % unit, 0, "{word}");
        word / unit
    })
}

/// A whole start-up with these offsets and its expected results: the samples of pre-charge and
/// control are others.
#[track_caller]
fn starts_up(drive: &mut Drive<Guarded>, a: u16, b: u16) {
    for _ in 0..16 {
        assert_eq!(drive.status().mode, Mode::Calibrate);
        assert_eq!(step(drive, [a, b], HALL), Legs::OFF);
    }
    assert_eq!(offsets(drive), [a, b].map(i32::from));
    for _ in 0..4 {
        assert_eq!(drive.status().mode, Mode::Precharge);
        assert_eq!(step(drive, [ZERO - 18, ZERO + 12], HALL), Legs::LOW);
    }
    for _ in 0..15 {
        assert!(drive.status().is_running());
        let legs = step(drive, [ZERO - 8, ZERO + 2], HALL);
        assert_eq!(legs.state(), [LegState::Pulsed; 3]);
    }
    assert_eq!(offsets(drive), [a, b].map(i32::from));
}

#[test]
fn every_calibration_averages_its_own_samples_once() {
    let mut drive = Drive::<Guarded>::new();
    drive.calibrate();
    assert_eq!(drive.status().mode, Mode::Calibrate, "published at once");
    starts_up(&mut drive, ZERO + 100, ZERO - 50);
    drive.calibrate();
    starts_up(&mut drive, ZERO - 100, ZERO + 50);
    // Halfway: the first half is discarded.
    drive.calibrate();
    for _ in 0..8 {
        step(&mut drive, [ZERO + 100, ZERO - 100], HALL);
    }
    drive.calibrate();
    starts_up(&mut drive, ZERO + 20, ZERO - 40);
    // In pre-charge.
    drive.calibrate();
    for _ in 0..18 {
        step(&mut drive, [ZERO + 100, ZERO - 100], HALL);
    }
    assert_eq!(drive.status().mode, Mode::Precharge);
    drive.calibrate();
    assert_eq!(drive.status().mode, Mode::Calibrate);
    starts_up(&mut drive, ZERO, ZERO - 20);
}

#[test]
fn an_offset_far_from_nominal_is_a_fault_and_changes_nothing() {
    for (a, b, fault) in [
        (ZERO + 102, ZERO - 102, None),
        (ZERO + 103, ZERO, Some(Fault::Offset)),
        (ZERO, ZERO - 103, Some(Fault::Offset)),
        (3990, ZERO, Some(Fault::Offset)),
    ] {
        let mut drive = Drive::<Guarded>::new();
        drive.calibrate();
        for _ in 0..16 {
            step(&mut drive, [a, b], HALL);
        }
        assert_eq!(drive.status().fault, fault, "{a} {b}");
        drive.reset();
        if fault.is_some() {
            assert_eq!(
                quiet(&mut drive, 1).compare(),
                [900; 3],
                "the old zero holds"
            );
        }
    }
}

#[test]
fn start_up_is_not_interrupted() {
    let mut drive = Drive::<Guarded>::new();
    drive.calibrate();
    quiet(&mut drive, 3);
    drive.reset();
    drive.precharge();
    assert_eq!(quiet(&mut drive, 12), Legs::OFF, "calibration went on");
    quiet(&mut drive, 1);
    drive.reset();
    assert!(!drive.status().is_running(), "pre-charge went on");
    assert_eq!(quiet(&mut drive, 2).state(), [LegState::Low; 3]);
    drive.calibrate();
    assert_eq!(
        quiet(&mut drive, 1),
        Legs::OFF,
        "a calibration may begin in pre-charge"
    );
}

#[test]
fn a_tripped_drive_accepts_only_reset() {
    let mut drive = Drive::<Guarded>::new();
    drive.set_current(I16F16::from_num(10));
    step(&mut drive, [ZERO; 2], 0);
    drive.calibrate();
    drive.precharge();
    assert_eq!(quiet(&mut drive, 40), Legs::OFF);
    assert_eq!(drive.status().fault, Some(Fault::Hall));
    drive.reset();
    assert_eq!(drive.status().fault, None);
    assert!(drive.status().is_running());
}

#[test]
fn a_reset_clears_the_set_point() {
    let mut drive = Drive::<Guarded>::new();
    drive.set_current(I16F16::from_num(10));
    let driven = quiet(&mut drive, 1);
    assert_ne!(driven.compare(), [900; 3]);
    step(&mut drive, [ZERO; 2], 0);
    drive.reset();
    assert_eq!(quiet(&mut drive, 1).compare(), [900; 3]);
    drive.set_current(I16F16::from_num(10));
    assert_eq!(quiet(&mut drive, 1), driven);
}

#[test]
fn a_stall_is_counted_under_demand_while_running() {
    let mut drive = Drive::<Guarded>::new();
    quiet(&mut drive, 100);
    assert_eq!(drive.status().fault, None, "no demand, no stall");
    drive.set_current(I16F16::from_num(1));
    drive.calibrate();
    quiet(&mut drive, 16 + 3);
    assert_eq!(drive.status().fault, None, "start-up is no stall");
    // 1 ms are 20 periods, the first of which ends the pre-charge.
    quiet(&mut drive, 20);
    assert_eq!(drive.status().fault, None);
    quiet(&mut drive, 1);
    assert_eq!(drive.status().fault, Some(Fault::Stall));
}

hexagen::controller! {
    /// The currents are watched: 60 periods.
    pub Watched {
        motor: "../targets/motors/trivedi-keshri-660w.toml",
        controller: pdcc { residual_timeout: 3 ms },
    }
}

/// A drive whose rotor is known to stand, at 10 A.
fn watched() -> Drive<Watched> {
    let mut drive = Drive::<Watched>::new();
    while !drive.status().is_running() {
        step(&mut drive, [ZERO; 2], HALL);
    }
    drive.set_current(I16F16::from_num(10));
    drive
}

#[test]
fn currents_that_do_not_follow_the_voltages_trip_after_their_time_and_no_sooner() {
    // No current flows, whatever the voltage.
    let mut drive = watched();
    let first = (1..200).find(|_| {
        step(&mut drive, [ZERO; 2], HALL);
        drive.status().fault.is_some()
    });
    assert_eq!(drive.status().fault, Some(Fault::Residual));
    // The voltage of the first step takes effect in the second, and shows in the third; the trip comes
    // with the period behind the sixtieth.
    assert_eq!(first, Some(2 + 60 + 1));
    assert_eq!(step(&mut drive, [ZERO; 2], HALL), Legs::OFF);
    let trip = drive.trip(&mut []).expect("a trip is kept");
    assert_eq!(trip.fault, Fault::Residual);
    drive.reset();
    assert_eq!(drive.status().fault, None);
}
