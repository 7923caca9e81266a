//! A crate with several motors and generic firmware code: the result of valid macro calls, and
//! their use.

use fixed::types::I16F16;
use hexagen::{
    Control, ControlLoop, Drive, DynLoop, Fault, LegState, Legs, MeasuredBus, Mode, Sample,
    SetPoint, Signals, controller,
};
use static_cell::StaticCell;

controller! {
    /// Rear hub, from a file beside the crate's Cargo.toml.
    pub RearHub {
        motor: "motors/hub.toml",
        inverter: {
            bus_voltage: 48 V,
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            adc_bits: 12,
            adc_range: 40 A,
            current_sensing: in_phase,
        },
        controller: pdcc { reference: quasi_square },
    }
}

controller! {
    /// Steering servo, stated in place.
    pub(crate) Steering {
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
            hall_timer_clock: 1 MHz,
        },
        controller: pdcc { hall_capture: timer, modulation: pair },
    }
}

controller! {
    /// Front hub, whose bus voltage is measured.
    pub FrontHub {
        motor: "motors/hub.toml",
        inverter: {
            bus_voltage: 48 V,
            v_bus: measured,
            bus_adc_bits: 12,
            bus_adc_range: 80 V,
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            adc_bits: 12,
            adc_range: 40 A,
            current_sensing: in_phase,
        },
        controller: pdcc,
    }
}

controller! {
    /// Conveyor, whose speed is held.
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
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            adc_bits: 12,
            adc_range: 40 A,
            current_sensing: in_phase,
        },
        controller: pdcc { speed_loop: on },
    }
}

/// The drive of this build, chosen by a cargo feature.
#[cfg(feature = "front")]
type Chosen = FrontHub;
#[cfg(not(feature = "front"))]
type Chosen = RearHub;

/// Made at compile time.
static REAR: Drive<RearHub> = Drive::new();

/// A sample without current.
fn sample(hall: u8) -> Sample {
    Sample::with_hall([2048, 2048], hall)
}

/// A rotor that stands, until a start is over.
fn starts<C: Control<Command = Legs>>(drive: &mut Drive<C>) {
    while drive.status().mode == Mode::Start {
        assert_eq!(drive.step(&sample(1)), Legs::OFF);
    }
}

/// Firmware code independent of the motor.
fn run<C: Control<Command = Legs>>(drive: &mut Drive<C>, milliamperes: i32) -> [LegState; 3] {
    drive.set_current_ma(milliamperes);
    let mut states = [LegState::Off; 3];
    starts(drive);
    for _ in 0..8 {
        states = drive.step(&sample(1)).state();
    }
    states
}

#[test]
fn generic_code_holds_any_drive() {
    assert!(run(&mut Drive::<Chosen>::new(), 5_000).contains(&LegState::Pulsed));
    let mut steering = const { Drive::<Steering>::new() };
    assert!(run(&mut steering, 5_000).contains(&LegState::Pulsed));
    assert!(steering.status().is_running());
    steering.step(&sample(7));
    assert_eq!(steering.status().fault, Some(Fault::Hall));
    assert_eq!(
        run(&mut steering, 5_000),
        [LegState::Off; 3],
        "a trip is latched"
    );
    // The set-point is set through a shared reference, so that a drive may be static.
    REAR.set_current(I16F16::lit("3"));
}

/// The control interrupt's part, for any motor.
struct Interrupt<'drive, C: Control> {
    control: ControlLoop<'drive, C>,
    legs: C::Command,
}

impl<C: Control> Interrupt<'_, C> {
    fn strikes(&mut self, hall: u8) {
        self.legs = self.control.step(&sample(hall));
    }
}

/// The main program sets the current and reads the status while the interrupt owns the control
/// loop.
fn halves<C: Control<Command = Legs>>() {
    let mut drive = Drive::<C>::new();
    let (set_point, mut control) = drive.split();
    control.precharge();
    let mut interrupt = Interrupt {
        control,
        legs: Legs::OFF,
    };
    assert_eq!(set_point.status().mode, Mode::Precharge, "{}", C::NAME);
    interrupt.strikes(1);
    assert_eq!(interrupt.legs, Legs::LOW, "{}", C::NAME);
    (0..5_000).for_each(|_| interrupt.strikes(1));
    // A measured bus voltage has not been set yet.
    let status = set_point.status();
    assert_eq!(status.mode, Mode::Run, "{}", C::NAME);
    let is_measured = C::SPEC.contains("bus = \"measured\"");
    assert_eq!(status.bus_is_stale, is_measured, "{}", C::NAME);
    set_point.set_current_ma(5_000);
    (0..8).for_each(|_| interrupt.strikes(1));
    assert!(set_point.status().is_running(), "{}", C::NAME);
    assert!(interrupt.legs.state().contains(&LegState::Pulsed));
    interrupt.strikes(7);
    for status in [set_point.status(), interrupt.control.status()] {
        assert_eq!(status.mode, Mode::Tripped, "{}", C::NAME);
        assert_eq!(status.fault, Some(Fault::Hall), "{}", C::NAME);
    }
    assert_eq!(interrupt.legs, Legs::OFF, "{}", C::NAME);
    interrupt.control.reset();
    interrupt.control.calibrate();
    interrupt.strikes(1);
    assert_eq!(set_point.status().mode, Mode::Calibrate, "{}", C::NAME);
    assert_eq!(drive.status().fault, None, "{}", C::NAME);
}

#[test]
fn generic_firmware_splits_any_drive() {
    halves::<RearHub>();
    halves::<FrontHub>();
    halves::<Steering>();
    halves::<Conveyor>();
    halves::<motors_of_any_name::DynLoop>();
}

/// Two drives in one program, one of which a switch on the board selects at run time.
#[test]
fn a_drive_is_chosen_at_run_time() {
    let mut rear = Drive::<RearHub>::new();
    let mut steering = Drive::<Steering>::new();
    rear.set_current_ma(5_000);
    steering.set_current_ma(5_000);
    let (mut rear, mut steering) = (rear.control(), steering.control());
    for is_steering in [false, true] {
        let control: &mut dyn DynLoop = if is_steering {
            &mut steering
        } else {
            &mut rear
        };
        assert!(control.step(&sample(5)).state().contains(&LegState::Pulsed));
        control.step(&sample(0));
        assert_eq!(control.status().fault, Some(Fault::Hall));
        control.reset();
        control.precharge();
        assert_eq!(control.step(&sample(5)), Legs::LOW);
        control.calibrate();
        assert_eq!(control.step(&sample(5)), Legs::OFF);
    }
}

/// The set-point goes to a task, the control loop to the context of an interrupt.
fn task<C: MeasuredBus>(set_point: &SetPoint<C>) {
    set_point.set_bus(2400);
    set_point.set_current_ma(10_000);
}

#[test]
fn a_drive_in_a_static_is_handed_over_in_halves() {
    static FRONT: StaticCell<Drive<FrontHub>> = StaticCell::new();
    let (set_point, mut control) = FRONT.init(Drive::new()).split();
    let interrupt = std::thread::spawn(move || {
        (0..100_000)
            .map(|_| control.step(&sample(1)))
            .any(|legs| legs.compare().iter().any(|&compare| compare > 1000))
    });
    task(set_point);
    assert!(interrupt.join().expect("it ends"), "the set-point arrives");
    assert!(set_point.status().is_running());
}

/// Both take effect: the current demands voltage, and the lower bus longer pulses than the nominal
/// one.
#[test]
fn current_and_bus_reach_the_step() {
    let mut drive = Drive::<FrontHub>::new();
    let mut told = |counts| {
        drive.reset();
        starts(&mut drive);
        drive.set_bus(counts);
        drive.set_current_ma(1_000);
        let compare = drive.step(&sample(1)).compare();
        compare.iter().max().expect("three legs") - compare.iter().min().expect("three legs")
    };
    assert!(told(2000) > told(2400) && told(2400) > 0);
}

#[test]
fn a_reset_sets_the_set_point_to_0() {
    // Half the bus on each leg: no voltage.
    let idle = |legs: Legs| legs.compare().iter().all(|&compare| compare == 900);
    let mut rear = Drive::<RearHub>::new();
    rear.set_current_ma(5_000);
    assert!(!idle(rear.step(&sample(1))));
    rear.reset();
    assert!(idle(rear.step(&sample(1))));
    rear.set_torque_mnm(500);
    assert!(!idle(rear.step(&sample(1))));
    // Start-up ignores a reset, and its effect on the set-point.
    rear.reset();
    rear.set_current_ma(5_000);
    rear.precharge();
    rear.reset();
    while !rear.status().is_running() {
        rear.step(&sample(1));
    }
    assert!(!idle(rear.step(&sample(1))));
    // With a speed loop the set-point is the speed; the current limit is kept.
    let mut conveyor = Drive::<Conveyor>::new();
    assert_eq!(conveyor.status().mode, Mode::Start, "of a new drive, too");
    starts(&mut conveyor);
    conveyor.set_speed_rpm(1_000);
    assert!(!idle(conveyor.step(&sample(1))));
    conveyor.reset();
    starts(&mut conveyor);
    assert!(idle(conveyor.step(&sample(1))));
    conveyor.set_speed(I16F16::lit("1000"));
    assert!(!idle(conveyor.step(&sample(1))));
}

#[test]
fn signals_are_those_of_one_period() {
    let mut drive = Drive::<RearHub>::new();
    drive.set_current_ma(1_000);
    drive.step(&sample(1));
    assert_eq!(drive.signals(), None, "the first request");
    let legs = drive.step(&Sample::with_hall([2098, 2048], 5));
    drive.step(&sample(1));
    let Some(Signals {
        currents,
        voltages,
        emf,
        speed,
        sector,
        ..
    }) = drive.signals()
    else {
        panic!("the period after the request answers");
    };
    // 50 counts of 19.53 mA, and c as their negative sum.
    let amperes = currents.map(I16F16::to_num::<f64>);
    assert!((amperes[0] - 0.9766).abs() < 1e-3, "{amperes:?}");
    assert_eq!(amperes[1], 0.0);
    assert!((amperes[2] + amperes[0]).abs() < 1e-4);
    for (volts, compare) in voltages.iter().zip(legs.compare()) {
        let volts: f64 = volts.expect("every leg is driven").to_num();
        assert!((volts - f64::from(compare) * 48.0 / 1800.0).abs() < 1e-3);
    }
    assert!(emf.is_some(), "the law estimates one");
    assert_eq!(speed, None, "it follows no edges");
    assert_eq!(sector, 2);
    assert_eq!(drive.signals(), None, "an answer is taken once");
    // A resting drive answers when it runs again.
    drive.step(&sample(0));
    assert_eq!(drive.signals(), None);
}

/// Periods of 50 us until a bus voltage is stale.
const FRESH: usize = 2000;

#[test]
fn the_status_reports_a_stale_bus_voltage() {
    let mut drive = Drive::<FrontHub>::new();
    let (set_point, mut control) = drive.split();
    let mut steps = |count: usize| {
        let stale = (0..count).filter(|_| {
            control.step(&sample(1));
            assert_eq!(control.status(), set_point.status());
            set_point.status().bus_is_stale
        });
        stale.count()
    };
    assert!(set_point.status().bus_is_stale, "before the first step");
    assert_eq!(steps(3), 3, "before the first call");
    for _ in 0..2 {
        set_point.set_bus(2400);
        assert_eq!(steps(FRESH), 0);
        assert_eq!(steps(3 * FRESH), 3 * FRESH, "where calls have ceased");
    }
    for _ in 0..5 {
        set_point.set_bus(2400);
        assert_eq!(steps(FRESH - 1), 0);
    }
    assert!(drive.status().is_running(), "it is a warning");
    // A reset keeps the voltage and its age.
    drive.reset();
    assert!(!drive.status().bus_is_stale);
    // A fixed bus is never stale.
    let mut rear = Drive::<RearHub>::new();
    for _ in 0..2 * FRESH {
        rear.step(&sample(1));
        assert!(!rear.status().bus_is_stale);
    }
}

#[test]
fn drives_know_their_motors() {
    assert_eq!(RearHub::NAME, "RearHub");
    assert_eq!(Steering::NAME, "Steering");
    assert!(RearHub::SPEC.contains("pole_pairs = 4"));
    assert!(Steering::SPEC.contains("modulation = \"pair\""));
}

/// Motors named like types of emitted code, and like a word of the language.
#[allow(dead_code, reason = "most only have to compile")]
mod motors_of_any_name {
    use hexagen::controller;

    macro_rules! drives {
        ($($name:ident)*) => {$(
            controller! {
                pub $name {
                    motor: "motors/hub.toml",
                    inverter: {
                        bus_voltage: 48 V,
                        f_pwm: 20 kHz,
                        timer_clock: 72 MHz,
                        adc_bits: 12,
                        adc_range: 40 A,
                        current_sensing: in_phase,
                    },
                    controller: pdcc { emf: model },
                }
            }
        )*};
    }

    drives! {
        Checked Control ControlLoop Default Drive DynLoop Fault FixedBus Format I16F16 LegState Legs Limits Loop
        MeasuredBus Mode Observation Rotor Rounding Sample SetPoint State Status TrackRotorResults Unit Units Word Words
    }
}

#[test]
fn a_motor_may_be_named_like_a_type_of_emitted_code() {
    assert!(run(&mut Drive::<motors_of_any_name::Drive>::new(), 5_000).contains(&LegState::Pulsed));
    assert!(
        run(&mut Drive::<motors_of_any_name::Word>::default(), 5_000).contains(&LegState::Pulsed)
    );
    assert!(run(&mut Drive::<motors_of_any_name::Legs>::new(), 5_000).contains(&LegState::Pulsed));
    assert_eq!(motors_of_any_name::Drive::NAME, "Drive");
    assert_eq!(motors_of_any_name::State::NAME, "State");
}
