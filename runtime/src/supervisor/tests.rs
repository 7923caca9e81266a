//! Every count of every ADC at the ends and in the middle of the offsets, every Hall code, every
//! order of faults, and contradictory limits.

use super::{Supervisor, Turn, Unfit};
use crate::arith::Word;
use crate::{
    Checked, Fault, LegState, Limits, Mode, Sample, SensedPhases, Sensor, Sensors, ThirdSensor,
};

/// A valid Hall code.
const HALL: u8 = 0b101;

/// What a period that is not fit for control comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Done {
    Legs(LegState),
    Control,
    Against(Word),
}

impl Supervisor {
    /// Such a period, of a drive without a fault that no sample shows.
    fn go_without(
        &mut self,
        limits: &Limits,
        sensors: &Sensors,
        sample: &Sample,
    ) -> (Checked, Done) {
        let (checked, unfit) = self.examine(limits, sensors, sample, None);
        let done = match unfit {
            Unfit::Rest(fault) => Done::Legs(self.rest(limits, sensors, sample, fault).0),
            Unfit::Control => Done::Control,
            Unfit::Against(direction) => Done::Against(direction),
        };
        (checked, done)
    }
}

/// Limits of an ADC with this number of bits: offsets within a sixteenth of the middle, a trip
/// level between two counts.
const fn limits(adc_bits: u32, adc_inverted: bool, current_bits: u32) -> Limits {
    let middle = 1_u16 << (adc_bits - 1);
    let tolerance = middle / 16;
    let adc_max = (middle - 1) * 2 + 1;
    let one = 1_i32 << current_bits;
    // Symmetric, except that an ADC has one count more below its middle.
    let (least, most) = (middle - tolerance, middle + tolerance);
    let (below, above) = (-(most as i32) * one, (adc_max - least) as i32 * one);
    Limits {
        adc_max,
        adc_inverted,
        current_bits,
        offset: middle,
        offsets: [least, most],
        trip: (middle as i32 - middle as i32 / 8) * one + one / 2,
        currents: if adc_inverted {
            [-above, -below]
        } else {
            [below, above]
        },
        calibration_log2: 4,
        precharge_periods: 3,
        stall_periods: 20,
        hall_inverted: 0,
        hall_glitches: 0,
        sectors: 0x0423_6510,
        brake_periods: 5,
        start_periods: 0,
        bus_counts: [0, u16::MAX],
    }
}

/// ADCs of 8, 12 and 16 bits, both polarities, with the most fraction bits that fit, and none.
const ALL: [Limits; 12] = [
    limits(8, false, 22),
    limits(8, true, 22),
    limits(12, false, 18),
    limits(12, true, 18),
    limits(16, false, 14),
    limits(16, true, 14),
    limits(8, false, 0),
    limits(8, true, 0),
    limits(12, false, 0),
    limits(12, true, 0),
    limits(16, false, 0),
    limits(16, true, 0),
];

/// A supervisor calibrated to these offsets, words of current.
fn calibrated(limits: &Limits, [offset_a, offset_b]: [i32; 2]) -> Supervisor {
    Supervisor {
        offsets: [Word(offset_a), Word(offset_b), Word(0)],
        ..Supervisor::new(limits, &Sensors::AB)
    }
}

/// Ends and middle of the offsets, and one between two counts.
fn offsets(limits: &Limits) -> [i32; 4] {
    let word = |count: u16| i32::from(count) << limits.current_bits;
    let [least, most] = limits.offsets.map(word);
    let between = word(limits.offset) + (word(1) >> 1);
    [least, word(limits.offset), between.min(most), most]
}

/// A current as documented: the count minus the offset, negated for an inverted ADC.
fn current(limits: &Limits, count: u16, offset: i32) -> i64 {
    let current = (i64::from(count) << limits.current_bits) - i64::from(offset);
    if limits.adc_inverted {
        -current
    } else {
        current
    }
}

/// The fault of a sample in a running drive.
fn fault(limits: &Limits, adc: [u16; 2], hall: u8, offsets: [i32; 2]) -> Option<Fault> {
    let [a, b] = [0, 1].map(|phase| current(limits, adc[phase], offsets[phase]));
    let most = a.abs().max(b.abs()).max((a + b).abs());
    if adc
        .iter()
        .any(|&count| count == 0 || count >= limits.adc_max)
    {
        Some(Fault::AdcRange)
    } else if ![1, 2, 3, 4, 5, 6].contains(&hall) {
        Some(Fault::Hall)
    } else if most > i64::from(limits.trip) {
        Some(Fault::OverCurrent)
    } else {
        None
    }
}

/// Supervises one sample of a running drive: the result is as expected, and its currents lie within
/// the limits.
fn supervise(limits: &Limits, adc: [u16; 2], hall: u8, offsets: [i32; 2]) -> Option<Fault> {
    let mut supervisor = calibrated(limits, offsets);
    let before = supervisor.clone();
    let sample = Sample::with_hall(adc, hall).hall_ticks(adc[0]);
    let expected = fault(limits, adc, hall, offsets);
    let held = [0, 1].map(|phase| adc[phase].min(limits.adc_max));
    let passed = supervisor.check(limits, &Sensors::AB, &sample, || false);
    assert_eq!(
        passed.is_some(),
        expected.is_none(),
        "{limits:?} {sample:?}"
    );
    let checked = passed.unwrap_or_else(|| {
        let (checked, rest) = supervisor.go_without(limits, &Sensors::AB, &sample);
        assert_eq!(rest, Done::Legs(LegState::Off));
        let status = supervisor.status();
        assert_eq!((status.mode, status.fault), (Mode::Tripped, expected));
        checked
    });
    for (phase, found) in [checked.i_a(), checked.i_b()].into_iter().enumerate() {
        let is = current(limits, held[phase], offsets[phase]);
        assert_eq!(i64::from(found.0), is, "{limits:?} {sample:?}");
        let [least, most] = limits.currents;
        assert!(found >= least && found <= most, "{limits:?} {sample:?}");
    }
    let code = if (1..=6).contains(&hall) { hall } else { 0 };
    assert_eq!(checked.hall(), i32::from(code));
    assert_eq!(checked.hall_ticks(), i32::from(adc[0]));
    if expected.is_none() {
        assert_eq!(supervisor.offsets, before.offsets);
        assert_eq!((supervisor.mode, supervisor.fault), (Mode::Run, None));
    }
    expected
}

#[test]
fn every_count_at_the_ends_and_in_the_middle_of_the_offsets() {
    for limits in &ALL {
        assert!(limits.hold(&Sensors::AB), "{limits:?}");
        let mut found = [0_u32; 3];
        for offset in offsets(limits) {
            // Almost no current, for the other phase.
            let zero = (offset >> limits.current_bits) as u16;
            for count in 0..=u16::MAX {
                for adc in [[count, zero], [zero, count], [count, count]] {
                    match supervise(limits, adc, HALL, [offset; 2]) {
                        None => found[0] += 1,
                        Some(Fault::AdcRange) => found[1] += 1,
                        Some(Fault::OverCurrent) => found[2] += 1,
                        Some(other) => panic!("{other:?}"),
                    }
                }
            }
        }
        let [passed, ends, over] = found;
        let often = u32::from(limits.adc_max) / 4;
        assert!(
            passed > often && ends >= 24 && over > often,
            "{limits:?}: {found:?}"
        );
    }
}

#[test]
fn ends_of_the_currents_are_reached() {
    for limits in &ALL {
        let [least, .., most] = offsets(limits);
        let mut reached = [0; 2];
        for (count, offset) in [(0, most), (u16::MAX, least)] {
            let mut supervisor = calibrated(limits, [offset; 2]);
            let (checked, _) =
                supervisor.go_without(limits, &Sensors::AB, &Sample::with_hall([count; 2], HALL));
            let end = usize::from((count == 0) == limits.adc_inverted);
            reached[end] = checked.i_a().0;
        }
        assert_eq!(reached, limits.currents, "{limits:?}");
    }
}

#[test]
fn every_hall_code() {
    for limits in &ALL {
        let offset = offsets(limits)[1];
        let mut codes = 0;
        for hall in 0..=u8::MAX {
            let fault = supervise(limits, [limits.offset; 2], hall, [offset; 2]);
            codes += u32::from(fault.is_none());
        }
        assert_eq!(codes, 6);
    }
}

/// A trip level is exact to the word: the level itself does not trip.
#[test]
fn the_trip_level_is_exact() {
    for limits in &ALL {
        let one = 1 << limits.current_bits;
        for count in [limits.offset / 2, limits.offset + limits.offset / 2] {
            let offset = offsets(limits)[1];
            let is = current(limits, count, offset).unsigned_abs() as i32;
            for (trip, expected) in [(is, None), (is - 1, Some(Fault::OverCurrent))] {
                let limits = Limits { trip, ..*limits };
                assert!(limits.hold(&Sensors::AB));
                let adc = [count, limits.offset];
                assert_eq!(supervise(&limits, adc, HALL, [offset; 2]), expected);
                // Half of it in each of two phases: all of it in the third.
                if is % (2 * one) == 0 {
                    let half = limits.offset.abs_diff(count) / 2;
                    let count = if count < limits.offset {
                        limits.offset - half
                    } else {
                        limits.offset + half
                    };
                    assert_eq!(supervise(&limits, [count; 2], HALL, [offset; 2]), expected);
                }
            }
        }
    }
}

/// The first fault of the documented list is reported, whatever else a sample has, in every mode
/// except tripped; a tripped drive keeps its own.
#[test]
fn faults_are_reported_in_their_order() {
    let order = [
        (Fault::AdcRange, "range"),
        (Fault::Hall, "code"),
        (Fault::OverCurrent, "current"),
        (Fault::Stall, "stall"),
    ];
    for limits in &ALL {
        for set in 0_u32..16 {
            let has = |index: usize| set >> index & 1 != 0;
            // A count at the end is also an over-current: the other phase has the other cause.
            let adc_a = if has(0) {
                limits.adc_max
            } else {
                limits.offset
            };
            let adc_b = if has(2) { 1 } else { limits.offset };
            let hall = if has(1) { 7 } else { HALL };
            let sample = Sample::with_hall([adc_a, adc_b], hall);
            let expected = (0..4).find(|&index| has(index)).map(|index| order[index].0);
            for mode in [Mode::Run, Mode::Calibrate, Mode::Precharge, Mode::Tripped] {
                // The last sample of a calibration with a wrong offset is the last of all faults.
                let ends = mode == Mode::Calibrate;
                let mut supervisor = Supervisor {
                    mode,
                    fault: (mode == Mode::Tripped).then_some(Fault::Offset),
                    countdown: if ends { 1 } else { 9 },
                    hall_prev: HALL,
                    stall_count: Word(if has(3) { limits.stall_periods - 1 } else { 0 }),
                    ..Supervisor::new(limits, &Sensors::AB)
                };
                let passed = supervisor.check(limits, &Sensors::AB, &sample, || true);
                // There is no stall outside control, and no current without offsets.
                let expected = expected.filter(|&fault| match fault {
                    Fault::Stall => mode == Mode::Run,
                    Fault::OverCurrent => mode != Mode::Calibrate,
                    _ => true,
                });
                assert_eq!(passed.is_some(), mode == Mode::Run && expected.is_none());
                if passed.is_some() {
                    continue;
                }
                let (_, rest) = supervisor.go_without(limits, &Sensors::AB, &sample);
                let charges = mode == Mode::Precharge && expected.is_none();
                assert_eq!(
                    rest == Done::Legs(LegState::Low),
                    charges,
                    "{mode:?} {expected:?}"
                );
                let is = (supervisor.mode, supervisor.fault);
                let should = match (mode, expected) {
                    (Mode::Tripped, _) => (mode, Some(Fault::Offset)),
                    (_, Some(fault)) => (Mode::Tripped, Some(fault)),
                    (Mode::Calibrate, None) => (Mode::Tripped, Some(Fault::Offset)),
                    (_, None) => (mode, None),
                };
                assert_eq!(
                    supervisor.offsets,
                    Supervisor::new(limits, &Sensors::AB).offsets
                );
                assert_eq!(is, should, "{mode:?}, {set:04b}");
            }
        }
    }
    let numbers = order.map(|(fault, _)| fault as i32);
    assert_eq!(numbers, [1, 3, 2, 4]);
}

/// Runs start-up with constant counts to its end.
fn start_up(limits: &Limits, supervisor: &mut Supervisor, adc: [u16; 2]) {
    supervisor.calibrate(limits);
    let sample = Sample::with_hall(adc, HALL);
    for period in 0..1_u32 << limits.calibration_log2 {
        assert_eq!(supervisor.mode, Mode::Calibrate, "{period}");
        assert!(
            supervisor
                .check(limits, &Sensors::AB, &sample, || true)
                .is_none()
        );
        assert_eq!(
            supervisor.go_without(limits, &Sensors::AB, &sample).1,
            Done::Legs(LegState::Off)
        );
    }
    for period in 0..limits.precharge_periods {
        if supervisor.mode == Mode::Tripped {
            return;
        }
        assert_eq!(supervisor.mode, Mode::Precharge, "{period}");
        assert!(
            supervisor
                .check(limits, &Sensors::AB, &sample, || true)
                .is_none()
        );
        assert_eq!(
            supervisor.go_without(limits, &Sensors::AB, &sample).1,
            Done::Legs(LegState::Low)
        );
    }
}

/// All counts that can be averaged, and those next to the least and the greatest offset.
#[test]
fn calibration_takes_offsets_within_their_range_and_no_others() {
    for limits in &ALL {
        let [least, most] = limits.offsets;
        for calibration_log2 in [0, 1, 4, 15] {
            let limits = Limits {
                calibration_log2,
                ..*limits
            };
            assert!(limits.hold(&Sensors::AB));
            for count in [least - 1, least, limits.offset, most, most + 1] {
                let is_good = (least..=most).contains(&count);
                for adc in [[count, limits.offset], [limits.offset, count]] {
                    let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
                    start_up(&limits, &mut supervisor, adc);
                    let fault = (!is_good).then_some(Fault::Offset);
                    assert_eq!(supervisor.fault, fault, "{limits:?} {adc:?}");
                    let expected = if is_good { adc } else { [limits.offset; 2] };
                    let words = expected.map(|count| Word::from(count) << limits.current_bits);
                    assert_eq!(supervisor.offsets[..2], words, "{limits:?} {adc:?}");
                }
            }
        }
    }
}

/// Offsets of which one shows more than the trip level, and two twice as much in the third phase: they
/// are judged as offsets, and the currents of pre-charge by them.
#[test]
fn calibration_judges_no_current_by_offsets_that_it_has_not_measured() {
    for limits in &ALL {
        let [least, most] = limits.offsets;
        let trip = (i32::from(most - limits.offset) / 2) << limits.current_bits;
        let limits = Limits { trip, ..*limits };
        assert!(limits.hold(&Sensors::AB));
        let ends_with = |adc: [u16; 2]| {
            let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
            supervisor.calibrate(&limits);
            let sample = Sample::with_hall(adc, HALL);
            for _ in 0..1_u32 << limits.calibration_log2 {
                let (_, rest) = supervisor.go_without(&limits, &Sensors::AB, &sample);
                assert_eq!(rest, Done::Legs(LegState::Off));
            }
            supervisor
        };
        for adc in [[most, limits.offset], [most; 2], [least; 2], [most, least]] {
            let supervisor = ends_with(adc);
            assert_eq!(supervisor.mode, Mode::Precharge, "{limits:?} {adc:?}");
            for (count, fault) in [(adc[0], None), (limits.offset, Some(Fault::OverCurrent))] {
                let mut supervisor = supervisor.clone();
                let sample = Sample::with_hall([count, adc[1]], HALL);
                supervisor.go_without(&limits, &Sensors::AB, &sample);
                assert_eq!(supervisor.fault, fault, "{limits:?} {adc:?} {count}");
            }
        }
        for (count, fault) in [
            (most + 1, Fault::Offset),
            (least - 1, Fault::Offset),
            (1, Fault::Offset),
            (limits.adc_max - 1, Fault::Offset),
            (0, Fault::AdcRange),
            (limits.adc_max, Fault::AdcRange),
        ] {
            for adc in [[count, limits.offset], [limits.offset, count], [count; 2]] {
                assert_eq!(ends_with(adc).fault, Some(fault), "{limits:?} {adc:?}");
            }
        }
    }
}

/// Means keep as many fraction bits as currents have, and round down.
#[test]
fn a_mean_between_two_counts_keeps_its_fraction() {
    let mut limits = limits(12, false, 17);
    for (current_bits, expected) in [
        (17, (2048 << 17) + (3 << 13)),
        (4, 32771),
        (3, 16385),
        (0, 2048),
    ] {
        limits.current_bits = current_bits;
        let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
        supervisor.calibrate(&limits);
        // Three of sixteen samples are one count higher.
        for period in 0..16 {
            let count = 2048 + u16::from(period % 5 == 1);
            let sample = Sample::with_hall([count; 2], HALL);
            supervisor.go_without(&limits, &Sensors::AB, &sample);
        }
        assert_eq!(
            supervisor.offsets[..2],
            [Word(expected); 2],
            "{current_bits}"
        );
    }
}

/// Without an edge under demand the last period of the time-out trips, and not the one before; an
/// edge, no demand, or start-up restarts the count; samples without a code are no edges.
#[test]
fn stalls_are_counted_between_codes() {
    let limits = limits(12, false, 17);
    let sample = |hall| Sample::with_hall([limits.offset; 2], hall);
    let periods_until_stall = |supervisor: &mut Supervisor, hall: u8| {
        (1..=2 * limits.stall_periods).find(|_| {
            let passed = supervisor.check(&limits, &Sensors::AB, &sample(hall), || true);
            passed.is_none() && supervisor.is_stalled(&limits)
        })
    };
    let stall = Some(limits.stall_periods);
    // The first code is no edge.
    let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
    assert_eq!(periods_until_stall(&mut supervisor, 1), stall);
    let begun = |periods: i32| {
        let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
        for _ in 0..periods {
            assert!(
                supervisor
                    .check(&limits, &Sensors::AB, &sample(1), || true)
                    .is_some()
            );
        }
        supervisor
    };
    let mut supervisor = begun(7);
    assert_eq!(
        periods_until_stall(&mut supervisor, 1),
        Some(limits.stall_periods - 7)
    );
    // A period with an edge does not count.
    let mut supervisor = begun(7);
    assert_eq!(
        periods_until_stall(&mut supervisor, 5),
        Some(limits.stall_periods + 1)
    );
    let mut supervisor = begun(7);
    assert!(
        supervisor
            .check(&limits, &Sensors::AB, &sample(1), || false)
            .is_some()
    );
    assert_eq!(periods_until_stall(&mut supervisor, 1), stall);
    for lost in [0, 7, 8, 0xff] {
        let mut supervisor = begun(7);
        assert!(
            supervisor
                .check(&limits, &Sensors::AB, &sample(lost), || true)
                .is_none()
        );
        assert_eq!(supervisor.stall_count, 8);
        assert_eq!(supervisor.hall_prev, 1);
    }
    let mut supervisor = begun(7);
    supervisor.calibrate(&limits);
    assert!(
        supervisor
            .check(&limits, &Sensors::AB, &sample(1), || true)
            .is_none()
    );
    assert_eq!(supervisor.stall_count, 0);
    // Without a time-out no stall is detected, whatever the demand.
    let unwatched = Limits {
        stall_periods: 0,
        ..limits
    };
    let mut supervisor = Supervisor::new(&unwatched, &Sensors::AB);
    for hall in [1, 5, 1, 1] {
        assert!(
            supervisor
                .check(&unwatched, &Sensors::AB, &sample(hall), || true)
                .is_some()
        );
    }
    assert_eq!(supervisor, Supervisor::new(&unwatched, &Sensors::AB));
}

/// A period of control: its code for the law, or the fault.
fn followed(supervisor: &mut Supervisor, limits: &Limits, hall: u8) -> Result<i32, Fault> {
    let sample = Sample::with_hall([limits.offset; 2], hall);
    if let Some(checked) = supervisor.check(limits, &Sensors::AB, &sample, || false) {
        return Ok(checked.hall().0);
    }
    let (checked, rest) = supervisor.go_without(limits, &Sensors::AB, &sample);
    if let Some(fault) = supervisor.status().fault {
        return Err(fault);
    }
    assert_eq!(rest, Done::Control);
    Ok(checked.hall().0)
}

#[test]
fn a_disturbed_hall_code_is_bridged_by_the_last_one_so_long_and_no_longer() {
    let limits = Limits {
        hall_glitches: 2,
        ..limits(12, false, 17)
    };
    // No code, one that skips a sector, and more than three bits.
    for disturbed in [0, 7, 6, 4, 9, 0xff] {
        let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
        let mut seen = |hall| followed(&mut supervisor, &limits, hall);
        assert_eq!(
            [1, disturbed, disturbed, 5].map(&mut seen),
            [1, 1, 1, 5].map(Ok)
        );
        assert_eq!([0, 0, 1].map(&mut seen), [5, 5, 1].map(Ok));
        assert_eq!([0, 7].map(&mut seen), [Ok(1), Ok(1)]);
        assert_eq!(seen(disturbed), Err(Fault::Hall));
        assert_eq!(supervisor.status().hall_glitches, 6);
        supervisor.reset(&limits, &Sensors::AB);
        assert_eq!(supervisor.status().hall_glitches, 0);
        assert_eq!(followed(&mut supervisor, &limits, 6), Ok(6));
    }
    // Without a code there is nothing to bridge with.
    let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
    assert_eq!(followed(&mut supervisor, &limits, 0), Err(Fault::Hall));
}

#[test]
fn counting_disturbed_codes_ends_and_does_not_begin_again() {
    let limits = Limits {
        hall_glitches: 1,
        ..limits(12, false, 17)
    };
    let mut supervisor = Supervisor {
        hall_prev: 1,
        hall_glitches: 0x7ffe,
        ..Supervisor::new(&limits, &Sensors::AB)
    };
    for _ in 0..3 {
        assert_eq!(followed(&mut supervisor, &limits, 0), Ok(1));
        assert_eq!(followed(&mut supervisor, &limits, 1), Ok(1));
        assert_eq!(supervisor.status().hall_glitches, 0x7fff);
        assert_eq!(supervisor.status().fault, None);
    }
}

#[test]
fn one_of_three_sensors_60_degrees_apart_is_inverted() {
    let limits = Limits {
        hall_inverted: 0b010,
        ..limits(12, false, 17)
    };
    for (hall, code) in [(0, 2), (1, 3), (3, 1), (7, 5), (6, 4), (4, 6)] {
        let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
        assert_eq!(followed(&mut supervisor, &limits, hall), Ok(code));
        for wrong in [0b010, 0b101, hall | 8] {
            let mut supervisor = supervisor.clone();
            let found = followed(&mut supervisor, &limits, wrong);
            assert_eq!(found, Err(Fault::Hall), "{wrong}");
        }
    }
}

#[test]
fn a_bus_voltage_beyond_its_counts_is_a_fault() {
    let limits = Limits {
        bus_counts: [1000, 3000],
        ..limits(12, false, 17)
    };
    assert_eq!(
        [1000, 3000].map(|counts| limits.bus_fault(counts)),
        [None; 2]
    );
    assert_eq!(limits.bus_fault(999), Some(Fault::UnderVoltage));
    assert_eq!(limits.bus_fault(3001), Some(Fault::OverVoltage));
    let any = Limits {
        bus_counts: [0, u16::MAX],
        ..limits
    };
    assert_eq!([0, u16::MAX].map(|counts| any.bus_fault(counts)), [None; 2]);
    // It comes before what the sample shows, here a Hall code that no sensors give; the first is kept.
    let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
    let sample = Sample::with_hall([limits.offset; 2], 7);
    for known in [Fault::OverVoltage, Fault::UnderVoltage] {
        let known = Some(known);
        let (_, unfit) = supervisor.examine(&limits, &Sensors::AB, &sample, known);
        assert_eq!(unfit, Unfit::Rest(known));
        let tripped = known.filter(|_| supervisor.mode != Mode::Tripped);
        let done = supervisor.rest(&limits, &Sensors::AB, &sample, known);
        assert_eq!(done, (LegState::Off, tripped));
    }
    let status = supervisor.status();
    assert_eq!(
        (status.mode, status.fault),
        (Mode::Tripped, Some(Fault::OverVoltage))
    );
}

#[test]
fn commands_are_accepted_in_their_modes_only() {
    let limits = limits(12, false, 17);
    for mode in (0..7).map(Mode::from_number) {
        for start_periods in [0, 7] {
            accepts(
                &Limits {
                    start_periods,
                    ..limits
                },
                mode,
            );
        }
    }
}

/// Each command, given in this mode with two periods left to count.
fn accepts(limits: &Limits, mode: Mode) {
    let begun = Supervisor {
        mode,
        fault: (mode == Mode::Tripped).then_some(Fault::Hall),
        countdown: 2,
        offsets: [Word(123); 3],
        sums: [Word(5); 3],
        sum_count: 3,
        unread: 0,
        hall_prev: 3,
        hall_gap: 1,
        hall_glitches: 2,
        stall_count: Word(4),
        turn: TURN,
    };
    let mut supervisor = begun.clone();
    let is_reset = supervisor.reset(limits, &Sensors::AB);
    let is_off = matches!(mode, Mode::Coast | Mode::Brake);
    let is_ready = matches!(mode, Mode::Run | Mode::Start) || is_off;
    assert_eq!(is_reset, is_ready || mode == Mode::Tripped);
    let cleared = Supervisor {
        offsets: [Word(123); 3],
        ..Supervisor::new(limits, &Sensors::AB)
    };
    let starts = limits.start_periods > 0;
    let first = if starts { Mode::Start } else { Mode::Run };
    assert_eq!(
        (cleared.mode, cleared.countdown),
        (first, limits.start_periods)
    );
    assert_eq!(supervisor, if is_reset { cleared } else { begun.clone() });

    let mut supervisor = begun.clone();
    supervisor.calibrate(limits);
    let calibrates = Supervisor {
        mode: Mode::Calibrate,
        countdown: 16,
        sums: [Word(0); 3],
        ..begun.clone()
    };
    let is_ignored = mode == Mode::Tripped;
    let expected = if is_ignored {
        begun.clone()
    } else {
        calibrates
    };
    assert_eq!(supervisor, expected);

    for stopped in [Mode::Coast, Mode::Brake] {
        let mut supervisor = begun.clone();
        match stopped {
            Mode::Coast => supervisor.coast(),
            _ => supervisor.brake(),
        }
        // The rotor of a start, or of the other kind of stop, is known; that of control is not.
        let turn = if mode == Mode::Run {
            Turn::UNKNOWN
        } else {
            TURN
        };
        let stops = Supervisor {
            mode: stopped,
            turn,
            ..begun.clone()
        };
        assert_eq!(supervisor, if is_ready { stops } else { begun.clone() });
    }
    for countdown in [2, 0] {
        let mut supervisor = Supervisor {
            countdown,
            ..begun.clone()
        };
        assert_eq!(supervisor.resume(), is_off);
        // What is left of a start goes on.
        let resumed = if countdown > 0 {
            Mode::Start
        } else {
            Mode::Run
        };
        assert_eq!(supervisor.mode, if is_off { resumed } else { mode });
    }

    for precharge_periods in [3, 0] {
        let limits = Limits {
            precharge_periods,
            ..*limits
        };
        let mut supervisor = begun.clone();
        supervisor.precharge(&limits);
        let charges = Supervisor {
            mode: Mode::Precharge,
            countdown: 3,
            ..begun.clone()
        };
        let may_begin = matches!(mode, Mode::Run | Mode::Start | Mode::Precharge);
        let is_taken = precharge_periods > 0 && may_begin;
        assert_eq!(supervisor, if is_taken { charges } else { begun.clone() });
    }
}

#[test]
fn words_round_trip() {
    let supervisor = Supervisor {
        mode: Mode::Precharge,
        fault: Some(Fault::Stall),
        countdown: 65_535,
        hall_prev: 6,
        hall_gap: 5,
        hall_glitches: 0x7fff,
        stall_count: Word(-7),
        sums: [Word(8), Word(i32::MIN), Word(5)],
        sum_count: 7,
        unread: 14,
        offsets: [Word(-9), Word(i32::MAX), Word(6)],
        turn: TURN,
    };
    let mut other = Supervisor::new(&ALL[0], &Sensors::AB);
    other.set_words(supervisor.words());
    assert_eq!(other, supervisor);
    let names = Supervisor::NAMES.iter().zip(supervisor.words());
    for (name, value) in [("countdown", 65_535), ("hall_prev", 6), ("offset_a", -9)] {
        assert!(names.clone().any(|pair| pair == (&name, value)), "{name}");
    }
}

/// Some rotation.
const TURN: Turn = Turn {
    hall: 3,
    age: Word(1),
    interval: Word(2),
    direction: Word(-1),
};

/// What each of so many periods with a Hall code comes to.
fn rests<const N: usize>(supervisor: &mut Supervisor, limits: &Limits, hall: u8) -> [Done; N] {
    [(); N].map(|()| {
        let sample = Sample::with_hall([limits.offset; 2], hall);
        assert!(
            supervisor
                .check(limits, &Sensors::AB, &sample, || true)
                .is_none()
        );
        supervisor.go_without(limits, &Sensors::AB, &sample).1
    })
}

#[test]
fn coasting_turns_all_legs_off_without_a_fault_and_still_watches() {
    let limits = limits(12, false, 17);
    let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
    supervisor.coast();
    let off = rests(&mut supervisor, &limits, HALL);
    assert_eq!(off, [Done::Legs(LegState::Off); 40]);
    assert_eq!(supervisor.status().fault, None);
    assert!(supervisor.resume());
    let sample = Sample::with_hall([limits.offset; 2], HALL);
    assert!(
        supervisor
            .check(&limits, &Sensors::AB, &sample, || false)
            .is_some()
    );
    supervisor.coast();
    rests::<1>(&mut supervisor, &limits, 7);
    assert_eq!(supervisor.status().fault, Some(Fault::Hall));
}

/// Sectors of at least five periods are shorted; shorter ones ask for torque against the rotation.
#[test]
fn braking_shorts_a_slow_rotor_and_opposes_a_fast_one() {
    let limits = limits(12, false, 17);
    let (off, low) = (Done::Legs(LegState::Off), Done::Legs(LegState::Low));
    let [forward, backward] = [1, -1].map(|direction| Done::Against(Word(direction)));
    let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
    supervisor.brake();
    // Nothing is known of the rotor, until it has stood for five periods.
    let unknown = Done::Against(Word(0));
    assert_eq!(
        rests(&mut supervisor, &limits, 1),
        [unknown, unknown, unknown, unknown, low, low, low]
    );
    // It accelerates: the first sector behind two edges in one direction is the first short interval.
    assert_eq!(rests(&mut supervisor, &limits, 5), [low; 3]);
    assert_eq!(rests(&mut supervisor, &limits, 4), [low; 3]);
    assert_eq!(rests(&mut supervisor, &limits, 6), [forward; 2]);
    // A sector that is skipped tells no direction; two edges back do.
    assert_eq!(rests(&mut supervisor, &limits, 3), [unknown; 2]);
    assert_eq!(rests(&mut supervisor, &limits, 2), [unknown; 4]);
    assert_eq!(
        rests(&mut supervisor, &limits, 6),
        [backward, backward, backward, backward, low, low]
    );
    // The interval that has passed was long.
    assert_eq!(rests(&mut supervisor, &limits, 4), [low; 2]);
    // A call while it brakes changes nothing; a fault ends it.
    supervisor.brake();
    assert_eq!(rests(&mut supervisor, &limits, 5), [backward; 2]);
    assert_eq!(rests(&mut supervisor, &limits, 0), [off]);
    assert_eq!(supervisor.status().fault, Some(Fault::Hall));
    let always = Limits {
        brake_periods: 0,
        ..limits
    };
    let mut supervisor = Supervisor::new(&always, &Sensors::AB);
    supervisor.brake();
    assert_eq!(rests(&mut supervisor, &always, 1), [low; 9]);
    assert_eq!(rests(&mut supervisor, &always, 5), [low; 9]);
}

/// What each of these codes comes to while a drive brakes.
fn braked<const N: usize>(supervisor: &mut Supervisor, codes: [u8; N]) -> [Done; N] {
    let limits = limits(12, false, 17);
    codes.map(|hall| rests::<1>(supervisor, &limits, hall)[0])
}

/// Edges of a rotor that stands go there and back, whether one sample is disturbed or a sensor
/// chatters; and so do those of one that is rocked by hand.
#[test]
fn a_rotor_that_stands_stays_shorted_whatever_one_sensor_does() {
    let low = Done::Legs(LegState::Low);
    let unknown = Done::Against(Word(0));
    let limits = limits(12, false, 17);
    let braking = || {
        let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
        supervisor.brake();
        supervisor
    };
    // Stood since the call, turned forward before, and turned backward.
    for before in [[4; 4], [1, 1, 5, 5], [2, 2, 6, 6]] {
        for disturbed in [
            [6, 6, 6, 6],
            [5, 5, 5, 5],
            [6, 4, 6, 4],
            [5, 4, 5, 4],
            [1; 4],
        ] {
            for samples in 1..=4 {
                let mut supervisor = braking();
                braked(&mut supervisor, before);
                braked(&mut supervisor, [4; 6]);
                for hall in [disturbed; 3]
                    .into_iter()
                    .flat_map(|codes| codes.into_iter().take(samples).chain([4; 6]))
                {
                    let rest = braked(&mut supervisor, [hall]);
                    assert_eq!(rest, [low], "{before:?} {disturbed:?} {samples}");
                }
            }
        }
    }
    // Chatter from the call on: no torque, and a short circuit as soon as without it.
    let mut supervisor = braking();
    let chatter = braked(&mut supervisor, [4, 6, 4, 6, 4, 6, 4, 6, 4, 6]);
    assert_eq!(chatter[..5], [unknown; 5]);
    assert_eq!(chatter[5..], [low; 5]);
    // Chatter of a rotor that stops in the middle of braking torque.
    let mut supervisor = braking();
    braked(&mut supervisor, [1, 1, 5, 5, 4, 4]);
    let chatter = braked(&mut supervisor, [6, 4, 6, 4, 6, 4, 6, 4]);
    assert_eq!(chatter[1..4], [unknown; 3]);
    assert_eq!(chatter[4..], [low; 4]);
    // Turned to and fro by hand, five periods and more in each sector.
    let mut supervisor = braking();
    braked(&mut supervisor, [4; 6]);
    for hall in [6, 2, 6, 4, 5, 4, 6, 2, 3, 2] {
        assert_eq!(braked(&mut supervisor, [hall; 5]), [low; 5], "{hall}");
    }
}

/// Two edges in one direction tell it; a disturbed sample costs the rest of its sector, and the next
/// interval is that of the sector.
#[test]
fn a_turning_rotor_is_opposed_behind_two_edges_in_one_direction() {
    let unknown = Done::Against(Word(0));
    let limits = limits(12, false, 17);
    for (codes, sign) in [([1_u8, 5, 4, 6, 2, 3], 1), ([3, 2, 6, 4, 5, 1], -1)] {
        let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
        supervisor.brake();
        let against = Done::Against(Word(sign));
        for (place, hall) in codes.into_iter().enumerate() {
            let expected = if place < 2 { unknown } else { against };
            assert_eq!(braked(&mut supervisor, [hall; 4]), [expected; 4], "{hall}");
        }
        let [first, second, third, ..] = codes;
        let disturbed = [first, codes[5], first, first];
        let lost = braked(&mut supervisor, disturbed);
        assert_eq!(lost, [against, unknown, unknown, unknown]);
        assert_eq!(braked(&mut supervisor, [second; 4]), [against; 4]);
        assert_eq!(supervisor.turn.interval, 4);
        assert_eq!(braked(&mut supervisor, [third; 4]), [against; 4]);
    }
}

/// A start of at most nine periods, which two Hall edges in one direction end.
#[test]
fn a_start_ends_behind_two_edges_in_one_direction_or_so_many_periods() {
    let limits = Limits {
        start_periods: 9,
        ..limits(12, false, 17)
    };
    let off = Done::Legs(LegState::Off);
    let ends_with = |codes: &[u8]| {
        let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
        for (period, &hall) in (1..).zip(codes) {
            assert_eq!(supervisor.status().mode, Mode::Start, "{codes:?}, {period}");
            assert_eq!(rests(&mut supervisor, &limits, hall), [off]);
        }
        assert_eq!(supervisor.status().mode, Mode::Run, "{codes:?}");
    };
    // A rotor that stands, one that turns forward, backward, and one that turns round.
    ends_with(&[1; 9]);
    ends_with(&[1, 1, 5, 5, 4]);
    ends_with(&[1, 3, 2]);
    ends_with(&[1, 5, 1, 3]);
    // A skipped sector tells no direction; a rotor that swings about an edge ends no start before
    // its time.
    ends_with(&[1, 6, 2, 3]);
    ends_with(&[1, 5, 6, 2, 3]);
    ends_with(&[1, 5, 1, 5, 1, 5, 1, 5, 1]);

    // Braking and coasting go on with it: legs are off until it is over.
    let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
    assert_eq!(rests(&mut supervisor, &limits, 1), [off; 2]);
    supervisor.coast();
    assert_eq!(rests(&mut supervisor, &limits, 5), [off; 2]);
    supervisor.brake();
    let forward = Done::Against(Word(1));
    assert_eq!(rests(&mut supervisor, &limits, 5), [off; 1]);
    assert_eq!(rests(&mut supervisor, &limits, 4), [forward; 2]);
    // Control follows without another start.
    assert!(supervisor.resume());
    assert_eq!(supervisor.status().mode, Mode::Run);
    supervisor.coast();
    assert!(supervisor.resume());
    assert_eq!(supervisor.status().mode, Mode::Run);

    // A fault ends a start; calibration and pre-charge come before one.
    let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
    rests::<1>(&mut supervisor, &limits, 7);
    assert_eq!(supervisor.status().fault, Some(Fault::Hall));
    let mut supervisor = Supervisor::new(&limits, &Sensors::AB);
    supervisor.calibrate(&limits);
    rests::<19>(&mut supervisor, &limits, 1);
    assert_eq!(supervisor.status().mode, Mode::Start);
    assert_eq!(rests(&mut supervisor, &limits, 1), [off; 9]);
    assert_eq!(supervisor.status().mode, Mode::Run);
}

/// A planted variant of limits.
type Variant = fn(&mut Limits);

/// Contradictory limits, and limits whose sums or words would not fit.
const CONTRADICTIONS: [(&str, Variant); 23] = [
    ("no range", |limits| limits.adc_max = 0),
    ("a range without a middle", |limits| limits.adc_max = 1),
    ("a count more", |limits| limits.adc_max -= 1),
    ("inverted", |limits| {
        limits.adc_inverted = !limits.adc_inverted;
    }),
    ("a fraction bit more", |limits| limits.current_bits += 1),
    ("fraction bits beyond the word", |limits| {
        limits.current_bits = 31;
    }),
    ("fraction bits beyond all", |limits| {
        limits.current_bits = u32::MAX;
    }),
    ("offset below the least", |limits| {
        limits.offset = limits.offsets[0] - 1;
    }),
    ("offset above the greatest", |limits| {
        limits.offset = limits.offsets[1] + 1;
    }),
    ("least offset one less", |limits| limits.offsets[0] -= 1),
    ("least offset one more", |limits| limits.offsets[0] += 1),
    ("greatest offset one less", |limits| limits.offsets[1] -= 1),
    ("greatest offset one more", |limits| limits.offsets[1] += 1),
    ("offsets beyond the range", |limits| {
        limits.offsets[1] = limits.adc_max + 1;
    }),
    ("least current one more", |limits| limits.currents[0] += 1),
    ("least current one less", |limits| limits.currents[0] -= 1),
    ("greatest current one less", |limits| {
        limits.currents[1] -= 1;
    }),
    ("greatest current one more", |limits| {
        limits.currents[1] += 1;
    }),
    ("no trip level", |limits| limits.trip = 0),
    ("too many samples", |limits| limits.calibration_log2 = 16),
    ("stall counted beyond the word", |limits| {
        limits.stall_periods = i32::MAX;
    }),
    ("sectors counted beyond the word", |limits| {
        limits.brake_periods = i32::MAX;
    }),
    ("sectors of less than no period", |limits| {
        limits.brake_periods = -1;
    }),
];

#[test]
fn contradictory_limits_do_not_hold() {
    for limits in &ALL[..4] {
        for (what, variant) in CONTRADICTIONS {
            let mut planted = *limits;
            variant(&mut planted);
            assert!(!planted.hold(&Sensors::AB), "{what}: {planted:?}");
        }
    }
}

/// Sensors that contradict these limits, or themselves.
#[test]
fn contradictory_sensors_do_not_hold() {
    let limits = ALL[0];
    let sensor = Sensor {
        adc_inverted: limits.adc_inverted,
        offset: limits.offset,
        offsets: limits.offsets,
        ratio: Sensor::ALIKE,
    };
    let third = ThirdSensor {
        sensor,
        readable: None,
        is_delayed: true,
        sum_tolerance: 0,
        sum_samples: 1,
    };
    // Three currents are added: a fraction bit less.
    let limits = Limits {
        current_bits: limits.current_bits - 1,
        trip: limits.trip / 2,
        currents: limits.currents.map(|current| current / 2),
        ..limits
    };
    let sound = Sensors {
        phases: SensedPhases::Ab,
        second: Some(sensor),
        third: Some(third),
    };
    assert!(limits.hold(&sound));
    let with_third = |change: fn(&mut ThirdSensor)| {
        let mut changed = third;
        change(&mut changed);
        Sensors {
            third: Some(changed),
            ..sound
        }
    };
    let with_second = |ratio| Sensors {
        second: Some(Sensor { ratio, ..sensor }),
        ..sound
    };
    for wrong in [
        Sensors {
            phases: SensedPhases::Bc,
            ..sound
        },
        with_third(|third| third.sum_tolerance = -1),
        with_third(|third| third.sensor.ratio = Sensor::ALIKE / 2 - 1),
        with_third(|third| third.sensor.offsets[1] += 1),
        with_third(|third| third.sensor.offset = third.sensor.offsets[0] - 1),
        with_second(2 * Sensor::ALIKE + 1),
        // The limits hold the currents of equal gains.
        with_second(Sensor::ALIKE + 100),
    ] {
        assert!(!limits.hold(&wrong), "{wrong:?}");
    }
    // Half the gain reaches less far.
    assert!(limits.hold(&with_second(Sensor::ALIKE / 2)));
}

/// The most fraction bits that fit, and one more with consistent limits.
#[test]
fn words_that_do_not_fit_do_not_hold() {
    for adc_bits in [8, 12, 16] {
        for adc_inverted in [false, true] {
            let holds = |bits| limits(adc_bits, adc_inverted, bits).hold(&Sensors::AB);
            assert!(holds(30 - adc_bits));
            assert!(!holds(31 - adc_bits), "the third current needs a bit more");
        }
    }
}
