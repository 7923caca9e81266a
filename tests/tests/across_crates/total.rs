//! No call of the runtime panics, for any arguments: arithmetic, supervisor, drives in any state.
//! The crate is built with overflow checks.

use hexagen::arith::{
    Word, angle_fraction, angle_index, angle_index_by_halves, divide, divide_by_digits,
    divide_narrow, lookup, mul_add_floor, mul_floor, mul_limited, mul_round, mul_round_narrow,
    mul_round_without_carry, product_by_halves, remainder, row, select, turn_over,
};
use hexagen::fixed::types::{I8F24, I16F16};
use hexagen::{
    Bus, Command, Control, Drive, DynLoop, Fault, FixedBus, Format, Intervals, LegState, Legs,
    Limits, Mode, Rounding, Sample, SensedPhases, Sensor, Sensors, Supervisor, ThirdSensor,
    ToldBus, Unfit,
};
use proptest::prelude::*;
use std::hint::black_box;

hexagen::controller! {
    /// With the calls of all options.
    pub Conveyor {
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
            inertia: 1000 g cm2,
        },
        inverter: {
            bus_voltage: 48 V,
            v_bus: measured,
            bus_adc_bits: 12,
            bus_adc_range: 80 V,
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            hall_timer_clock: 1 MHz,
            adc_bits: 12,
            adc_range: 40 A,
            current_sensing: in_phase,
            stall_timeout: 5 ms,
        },
        controller: pdcc { speed_loop: on, hall_capture: timer, emf: model, saturation: torque_priority },
    }
}

hexagen::controller! {
    /// One that chooses among vectors by tables.
    pub Chooser {
        motor: "../targets/motors/trivedi-keshri-660w.toml",
        controller: fcs_mpc { candidates: all },
    }
}

/// Any word, and those next to overflow.
fn word() -> impl Strategy<Value = Word> {
    let corners = [i32::MIN, i32::MIN + 1, -1, 0, 1, i32::MAX - 1, i32::MAX];
    prop_oneof![any::<i32>(), proptest::sample::select(corners.to_vec())].prop_map(Word)
}

/// Any number of bits or segments, mostly near a word's.
fn number() -> impl Strategy<Value = u32> {
    prop_oneof![0..=70_u32, any::<u32>()]
}

fn sample() -> impl Strategy<Value = Sample> {
    let counts = prop_oneof![0..=4096_u16, 1900..=2200_u16, any::<u16>()];
    let hall = prop_oneof![0..=7_u8, 1..=6_u8, any::<u8>()];
    (
        [counts.clone(), counts.clone()],
        counts,
        hall,
        any::<u16>(),
        any::<Option<u32>>(),
    )
        .prop_map(|(adc, adc_c, hall, ticks, angle)| {
            let sample = match angle {
                Some(angle) => Sample::with_angle(adc, angle),
                None => Sample::with_hall(adc, hall).hall_ticks(ticks),
            };
            sample.third_current(adc_c)
        })
}

fn leg() -> impl Strategy<Value = LegState> {
    any::<i32>().prop_map(LegState::from_number)
}

/// Sensors that may be invalid.
fn sensors() -> impl Strategy<Value = Sensors> {
    let phases = prop_oneof![
        Just(SensedPhases::Ab),
        Just(SensedPhases::Bc),
        Just(SensedPhases::Ca)
    ];
    let second = proptest::option::of(sensor());
    let third = proptest::option::of(third_sensor());
    (phases, second, third).prop_map(|(phases, second, third)| Sensors {
        phases,
        second,
        third,
    })
}

fn sensor() -> impl Strategy<Value = Sensor> {
    let ratio = prop_oneof![Just(Sensor::ALIKE), 1 << 14..=1 << 16, any::<i32>()];
    let values = (any::<bool>(), any::<u16>(), any::<[u16; 2]>(), ratio);
    values.prop_map(|(adc_inverted, offset, offsets, ratio)| Sensor {
        adc_inverted,
        offset,
        offsets,
        ratio,
    })
}

fn third_sensor() -> impl Strategy<Value = ThirdSensor> {
    let values = (
        sensor(),
        any::<Option<u16>>(),
        any::<bool>(),
        any::<i32>(),
        any::<u16>(),
    );
    values.prop_map(
        |(sensor, readable, is_delayed, sum_tolerance, sum_samples)| ThirdSensor {
            sensor,
            readable,
            is_delayed,
            sum_tolerance,
            sum_samples,
        },
    )
}

/// Limits that may be invalid.
fn limits() -> impl Strategy<Value = Limits> {
    (
        (any::<u16>(), any::<bool>(), number()),
        (
            any::<u16>(),
            any::<[u16; 2]>(),
            any::<i32>(),
            any::<[i32; 2]>(),
        ),
        (number(), any::<u16>(), prop_oneof![Just(0), any::<i32>()]),
        (any::<u8>(), any::<u16>()),
        (
            any::<u32>(),
            (any::<i32>(), prop_oneof![Just(0), any::<u16>()]),
            any::<[u16; 2]>(),
        ),
    )
        .prop_map(
            |(
                (adc_max, adc_inverted, current_bits),
                (offset, offsets, trip, currents),
                (calibration_log2, precharge_periods, stall_periods),
                (hall_inverted, hall_glitches),
                (sectors, (brake_periods, start_periods), bus_counts),
            )| Limits {
                adc_max,
                adc_inverted,
                current_bits,
                offset,
                offsets,
                trip,
                currents,
                calibration_log2,
                precharge_periods,
                stall_periods,
                hall_inverted,
                hall_glitches,
                sectors,
                brake_periods,
                start_periods,
                bus_counts,
            },
        )
}

/// A call of a drive.
#[derive(Clone, Copy, Debug)]
enum Call {
    Step(Sample),
    Current(i32),
    Milliamperes(i32),
    Torque(i32),
    Millinewtonmetres(i32),
    Speed(i32),
    Rpm(i32),
    Bus(u16),
    Reset,
    Calibrate,
    Precharge,
    Coast,
    Brake,
    Resume,
    Words(usize),
}

fn call() -> impl Strategy<Value = Call> {
    prop_oneof![
        8 => sample().prop_map(Call::Step),
        1 => word().prop_map(|word| Call::Current(word.0)),
        1 => word().prop_map(|word| Call::Milliamperes(word.0)),
        1 => word().prop_map(|word| Call::Torque(word.0)),
        1 => word().prop_map(|word| Call::Millinewtonmetres(word.0)),
        1 => word().prop_map(|word| Call::Speed(word.0)),
        1 => word().prop_map(|word| Call::Rpm(word.0)),
        1 => any::<u16>().prop_map(Call::Bus),
        1 => Just(Call::Reset),
        1 => Just(Call::Calibrate),
        1 => Just(Call::Precharge),
        1 => Just(Call::Coast),
        1 => Just(Call::Brake),
        1 => Just(Call::Resume),
        1 => (0..100_usize).prop_map(Call::Words),
    ]
}

/// The calls of all drives.
fn carry_out<C: Control>(drive: &mut Drive<C>, call: Call) {
    match call {
        Call::Step(sample) => {
            let on = drive.step(&sample).on();
            black_box(on);
        }
        Call::Current(bits) => drive.set_current(I16F16::from_bits(bits)),
        Call::Milliamperes(current) => drive.set_current_ma(current),
        Call::Torque(bits) => drive.set_torque(I16F16::from_bits(bits)),
        Call::Millinewtonmetres(torque) => drive.set_torque_mnm(torque),
        Call::Speed(bits) => drive.set_speed_bits(bits),
        Call::Rpm(_) => {}
        Call::Bus(counts) => drive.set_bus_counts(counts),
        Call::Reset => drive.reset(),
        Call::Calibrate => drive.calibrate(),
        Call::Precharge => drive.precharge(),
        Call::Coast => drive.coast(),
        Call::Brake => drive.brake(),
        Call::Resume => drive.resume(),
        Call::Words(length) => drive.state_words(&mut vec![0; length]),
    }
    let status = drive.status();
    black_box((drive.signals(), format!("{drive:?} {status:?}")));
    black_box(drive.trip(&mut [0; 30]));
}

/// Any calls, in a possibly unreachable state.
fn run<C: Control<Command = Legs>>(state: &[i32], calls: &[Call]) {
    let mut drive = Drive::<C>::new();
    drive.set_state_words(state);
    for &call in calls {
        carry_out(&mut drive, call);
    }
    let control: &mut dyn DynLoop = &mut drive.control();
    control.step(&Sample::default());
    control.reset();
}

proptest! {
    #[test]
    fn arithmetic(a in word(), b in word(), c in word(), d in word(), bits in number()) {
        black_box([
            mul_round(a, b, bits),
            mul_round_without_carry(a, b, bits),
            mul_round_narrow(a, b, bits),
            mul_floor(a, b, bits),
            mul_add_floor(a, b, c, d, bits),
            mul_limited(a, b, c),
            divide(a, b, c, bits),
            divide_by_digits(a, b, c, bits),
            divide_narrow(a, b, c, bits),
            remainder(a, bits),
            turn_over(a),
            angle_index(a, bits),
            angle_index_by_halves(a, bits),
            angle_fraction(a, bits),
            lookup(&[0_i8, 1, 2, 3], a),
            Word::from(*row(&[0_i16; 8], a)),
            select(a < b, c, d),
        ]);
        black_box(product_by_halves(a, b));
        black_box([a + b, a - b, a * b, -a, a << bits, a >> bits, a.abs(), a.min(b), a.max(b)]);
        black_box([a.lesser(b), a.greater(b), a.clamp(b, c), Word::from(a.to_u16())]);
        black_box(a.exceeds(b));
    }

    #[test]
    fn commands(
        compare in any::<[u16; 3]>(),
        states in [[leg(), leg(), leg()], [leg(), leg(), leg()], [leg(), leg(), leg()]],
        bits in any::<u64>(),
    ) {
        let [state, ..] = states;
        for legs in [Legs::new(compare, state), Legs::from_bits(bits), Legs::at_rest(state[0])] {
            black_box((legs.compare(), legs.state(), legs.states(), legs.on(), format!("{legs:?}")));
        }
        let [first, second, third] = compare;
        let coded = Intervals::of_states([first, second], [second, third, first]);
        for intervals in [Intervals::new([first, second], states), coded, Intervals::from_bits(bits)] {
            black_box((intervals.ends(), intervals.states(), intervals.state()));
            black_box((intervals.on(), format!("{intervals:?}")));
        }
        black_box(Intervals::at_rest(state[0]).on());
    }

    #[test]
    fn numbers_and_formats(number in any::<i32>(), bits in any::<(u8, i8, u8)>()) {
        let (storage_bits, frac_bits, segments) = bits;
        black_box((Mode::from_number(number), Fault::from_number(number)));
        black_box(Format::new("x", storage_bits, frac_bits, Rounding::Floor).over(segments));
        let pairs: [[I8F24; 2]; 1] = hexagen::pairs_from_bits([[number; 2]]);
        black_box(pairs);
    }

    #[test]
    fn buses(words in [word(), word()], periods in 0..5_usize) {
        let bus = ToldBus::<2, { i32::MIN }>::new(words);
        for _ in 0..periods {
            bus.pass_period();
            black_box((bus.tell(words, None), bus.read(), bus.is_stale()));
        }
        FixedBus.pass_period();
        black_box((FixedBus.tell((), None), FixedBus.read(), FixedBus.is_stale()));
    }

    #[test]
    fn supervision(
        limits in limits(),
        sensors in sensors(),
        words in any::<[i32; Supervisor::NAMES.len()]>(),
        samples in proptest::collection::vec((sample(), any::<bool>(), 0..8_u8), 1..20),
    ) {
        black_box(limits.hold(&sensors));
        let mut supervisor = Supervisor::new(&limits, &sensors);
        supervisor.set_words(words);
        for (sample, is_demanded, call) in samples {
            let known = (call == 6).then_some(Fault::OverSpeed);
            let checked = supervisor.check(&limits, &sensors, &sample, || is_demanded);
            if checked.is_none() || known.is_some() {
                let (_, unfit) = black_box(supervisor.examine(&limits, &sensors, &sample, known));
                if let Unfit::Rest(fault) = unfit {
                    black_box(supervisor.rest(&limits, &sensors, &sample, fault));
                }
            } else {
                let [a, b, c] = sample.adc();
                supervisor.follow_command(&sensors, [Some(a), Some(b), (c != 0).then_some(c)]);
            }
            match call {
                0 => supervisor.calibrate(&limits),
                1 => supervisor.precharge(&limits),
                2 => {
                    supervisor.reset(&limits, &sensors);
                }
                3 => supervisor.coast(),
                4 => supervisor.brake(),
                5 => {
                    supervisor.resume();
                }
                _ => {}
            }
            black_box((supervisor.status(), supervisor.words()));
        }
    }

    #[test]
    fn drives(
        state in proptest::collection::vec(word().prop_map(|word| word.0), 0..60),
        calls in proptest::collection::vec(call(), 1..60),
    ) {
        run::<Conveyor>(&state, &calls);
        run::<Chooser>(&state, &calls);
        let drive = Drive::<Conveyor>::new();
        for call in calls {
            match call {
                Call::Speed(bits) => drive.set_speed(I16F16::from_bits(bits)),
                Call::Rpm(speed) => drive.set_speed_rpm(speed),
                Call::Bus(counts) => drive.set_bus(counts),
                _ => {}
            }
        }
    }
}

/// A set-point far above the limit counts as the limit.
#[test]
fn extreme_set_points_saturate() {
    let first = |set: &dyn Fn(&Drive<Chooser>)| {
        let mut drive = Drive::<Chooser>::new();
        set(&drive);
        (0..50)
            .map(|period| drive.step(&Sample::with_hall([2048; 2], 1 + (period / 25) as u8 * 4)))
            .collect::<Vec<_>>()
    };
    let largest = |sign: i32| first(&move |drive| drive.set_current_ma(sign * 22_000));
    assert_ne!(largest(1), largest(-1));
    for (extreme, sign) in [
        (i32::MAX, 1),
        (i32::MIN, -1),
        (32_768_000, 1),
        (-32_768_001, -1),
    ] {
        assert_eq!(
            first(&|drive| drive.set_current_ma(extreme)),
            largest(sign),
            "{extreme}"
        );
        assert_eq!(
            first(&|drive| drive.set_torque_mnm(extreme)),
            first(&|drive| drive.set_torque(I16F16::from_num(sign * 1000))),
            "{extreme}"
        );
    }
    assert_eq!(first(&|drive| drive.set_current(I16F16::MAX)), largest(1));
    assert_eq!(first(&|drive| drive.set_current(I16F16::MIN)), largest(-1));
}
