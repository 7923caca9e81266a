//! A hand-written controller: the runtime's interface, with commands of several intervals, and
//! samples with an angle.

use hexagen::arith::Word;
use hexagen::{
    Checked, Command, Control, Drive, DynLoop, Fault, FixedBus, Format, Intervals, LegState,
    Limits, Mode, Observation, Sample, State, Unit, Units, Words,
};

/// Six-step voltage control: the set-point is the duty cycle, and after a code change the motor
/// coasts for a period.
struct SixStep;

/// State.
#[derive(State)]
struct Kept {
    /// Hall code of the last period; 0 after a rest.
    hall_prev: Word,
    /// Controlled periods.
    #[initial(-1)]
    periods: Word,
}

/// Timer counts of a period.
const PERIOD: u16 = 1800;

const UNIT: Unit = Unit {
    factor: 1 << 20,
    shift: 20,
};

impl Control for SixStep {
    type State = Kept;
    /// Whether the code is unchanged.
    type Rotor = bool;
    type Command = Intervals;
    type Bus = FixedBus;

    const NAME: &'static str = "SixStep";
    const SPEC: &'static str = "";
    const FORMATS: &'static [Format] = &[];
    const LIMITS: Limits = Limits {
        adc_max: 4095,
        adc_inverted: false,
        current_bits: 0,
        offset: 2048,
        offsets: [2000, 2100],
        trip: 1900,
        currents: [-2100, 2095],
        calibration_log2: 4,
        precharge_periods: 2,
        stall_periods: 0,
        hall_inverted: 0,
        hall_glitches: 0,
        sectors: 0x0423_6510,
        brake_periods: 0,
        start_periods: 0,
        bus_counts: [0, u16::MAX],
    };
    const UNITS: Units = Units {
        ampere: UNIT,
        volt: UNIT,
        volt_per_count: UNIT,
        rpm: UNIT,
        sectors: [0, 1, 5, 6, 3, 2, 4, 0],
    };
    const SET_POINT: Word = Word(0);
    const BUS: FixedBus = FixedBus;

    /// An ampere is a hundredth of the period.
    fn current(bits: Word) -> Word {
        (bits >> 16).clamp(0, 100) * i32::from(PERIOD / 100)
    }

    fn torque(bits: Word) -> Word {
        Self::current(bits)
    }

    fn track(kept: &mut Kept, sample: &Checked) -> bool {
        let is_same = sample.hall() == kept.hall_prev;
        kept.hall_prev = sample.hall();
        is_same
    }

    fn rest(kept: &mut Kept, _: &Checked, _: bool) {
        kept.hall_prev = Word(0);
    }

    fn step(
        kept: &mut Kept,
        set_point: &Words<Self>,
        sample: &Checked,
        is_same: bool,
        observation: &mut Observation,
    ) -> Intervals {
        use LegState::{Low, Off, Pulsed};
        kept.periods = kept.periods + 1;
        observation.speed = Some(Word(SPEED));
        let [high, low] = match sample.hall().0 {
            1 => [2, 1],
            5 => [0, 1],
            4 => [0, 2],
            6 => [1, 2],
            2 => [1, 0],
            _ => [2, 0],
        };
        if !is_same {
            return Intervals::OFF;
        }
        let mut driven = [Off; 3];
        (driven[high], driven[low]) = (Pulsed, Low);
        let mut freewheeling = [Off; 3];
        (freewheeling[high], freewheeling[low]) = (Low, Low);
        let on = set_point.current().to_u16();
        Intervals::new([on, PERIOD], [driven, freewheeling, freewheeling])
    }
}

const HALL: u8 = 5;

/// An angle per period.
const SPEED: i32 = -3;

fn sample(hall: u8) -> Sample {
    Sample::with_hall([2048; 2], hall)
}

#[test]
fn a_hand_written_law_runs_in_a_drive() {
    let mut drive = Drive::<SixStep>::new();
    let (set_point, mut control) = drive.split();
    let control: &mut dyn DynLoop<Intervals> = &mut control;
    control.calibrate();
    for _ in 0..16 {
        assert_eq!(control.step(&sample(HALL)), Intervals::OFF);
    }
    assert_eq!(set_point.status().mode, Mode::Precharge);
    for _ in 0..2 {
        assert_eq!(
            control.step(&sample(HALL)),
            Intervals::at_rest(LegState::Low)
        );
    }
    set_point.set_current_ma(25_000);
    // The first code after a rest is a new one.
    assert_eq!(control.step(&sample(HALL)), Intervals::OFF);
    let command = control.step(&sample(HALL));
    assert_eq!(command.ends(), [450, PERIOD]);
    assert_eq!(command.on(), [Some(450), Some(0), None]);
    assert_eq!(
        control.step(&Sample::with_hall([2048, 4000], HALL)),
        Intervals::OFF
    );
    assert_eq!(control.status().fault, Some(Fault::OverCurrent));
    control.reset();
    control.step(&sample(HALL));
    // The reset has cleared the set-point.
    assert_eq!(control.step(&sample(HALL)).on(), [Some(0), Some(0), None]);
}

#[test]
fn its_words_stand_behind_the_supervisors() {
    let mut drive = Drive::<SixStep>::new();
    let names: Vec<_> = Drive::<SixStep>::state_names().collect();
    assert_eq!(names.last_chunk(), Some(&["hall_prev", "periods"]));
    let mut words = vec![0; names.len()];
    drive.state_words(&mut words);
    assert_eq!(words.last_chunk(), Some(&[0, -1]));
    drive.step(&sample(HALL));
    drive.state_words(&mut words);
    assert_eq!(words.last_chunk(), Some(&[i32::from(HALL), 0]));
}

/// The step in which a drive trips is kept whole until a reset, whatever comes after it.
#[test]
fn the_period_of_a_trip_is_kept_until_a_reset() {
    let mut drive = Drive::<SixStep>::new();
    drive.set_current_ma(7_000);
    for _ in 0..3 {
        drive.step(&sample(HALL));
    }
    let mut words = [0; 24];
    assert_eq!(drive.trip(&mut words), None);
    let mut before = [0; 24];
    drive.state_words(&mut before);
    let bad = Sample::with_hall([2048, 4000], 4)
        .hall_ticks(312)
        .third_current(77);
    drive.step(&bad);
    for _ in 0..3 {
        drive.set_current_ma(9_000);
        drive.step(&Sample::with_hall([2050, 2050], 7));
        let trip = drive.trip(&mut words).expect("it has tripped");
        assert_eq!((trip.fault, trip.sample), (Fault::OverCurrent, bad));
        assert_eq!((trip.current, trip.speed, trip.bus), (126, 0, [0; 2]));
        // The supervisor's words with the fault, the law's as that period found them.
        assert_eq!(
            words[..2],
            [Mode::Tripped as i32, Fault::OverCurrent as i32]
        );
        assert_eq!(words[2..], before[2..]);
    }
    // Fewer words than there are, and none.
    assert_eq!(drive.trip(&mut words[..1]), drive.trip(&mut []));
    drive.reset();
    assert_eq!(drive.trip(&mut words), None);
    drive.step(&Sample::with_hall([2048; 2], 0));
    let trip = drive.trip(&mut []).expect("it has tripped again");
    assert_eq!(
        (trip.fault, trip.sample.hall(), trip.current),
        (Fault::Hall, 0, 0)
    );
}

/// An angle is no Hall code: a drive that needs codes, as all do, trips on it.
#[test]
fn an_angle_is_not_taken_for_a_hall_code() {
    let turned = Sample::with_angle([2048; 2], 0x4000_0000).third_current(2048);
    assert_eq!((turned.angle(), turned.hall()), (0x4000_0000, 0));
    assert_eq!(turned.adc(), [2048; 3]);
    let mut drive = Drive::<SixStep>::new();
    assert_eq!(drive.step(&turned), Intervals::OFF);
    assert_eq!(drive.status().fault, Some(Fault::Hall));
}

/// Each call, on a drive and on its loop behind the trait.
#[test]
fn calls_change_the_mode_of_a_drive_and_of_any_loop() {
    type Calls = (
        fn(&mut Drive<SixStep>),
        fn(&mut dyn DynLoop<Intervals>),
        Mode,
    );
    let calls: [Calls; 4] = [
        (Drive::calibrate, |any| any.calibrate(), Mode::Calibrate),
        (Drive::precharge, |any| any.precharge(), Mode::Precharge),
        (Drive::coast, |any| any.coast(), Mode::Coast),
        (Drive::brake, |any| any.brake(), Mode::Brake),
    ];
    for (of_drive, of_loop, mode) in calls {
        let (mut drive, mut other) = (Drive::<SixStep>::new(), Drive::<SixStep>::new());
        let any: &mut dyn DynLoop<Intervals> = &mut other.control();
        let modes = |drive: &mut Drive<SixStep>, any: &mut dyn DynLoop<Intervals>| {
            drive.step(&sample(HALL));
            any.step(&sample(HALL));
            [drive.status().mode, any.status().mode]
        };
        assert_eq!(modes(&mut drive, any), [Mode::Run; 2]);
        of_drive(&mut drive);
        of_loop(any);
        assert_eq!(modes(&mut drive, any), [mode; 2]);
        if matches!(mode, Mode::Coast | Mode::Brake) {
            drive.resume();
            any.resume();
            assert_eq!(modes(&mut drive, any), [Mode::Run; 2]);
        }
    }
}
