//! A crate with several motors, held by generic firmware code: what a right macro call gives.

use fixed::types::I16F16;
use hexagen::{
    Drive, DriveLoop, DriveSetPoint, Fault, LegState, Legs, Mode, Sample, Status, controller,
};

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
        },
        controller: pdcc,
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
        },
        controller: pdcc,
    }
}

/// Made at compile time.
static REAR: RearHub = RearHub::new();

/// Firmware code that knows no motor.
fn run<D: Drive>(drive: &mut D, amperes: i16) -> [LegState; 3] {
    drive.set_current(I16F16::from_num(amperes));
    let mut states = [LegState::Off; 3];
    for _ in 0..8 {
        states = drive
            .step(&Sample {
                adc_a: 2048,
                adc_b: 2048,
                hall: 1,
                hall_ticks: 0,
            })
            .state();
    }
    states
}

#[test]
fn generic_code_holds_any_drive() {
    assert!(run(&mut RearHub::new(), 5).contains(&LegState::Pulsed));
    let mut steering = const { Steering::new() };
    assert!(run(&mut steering, 5).contains(&LegState::Pulsed));
    assert!(steering.is_running());
    steering.step(2048, 2048, 7, 0);
    assert_ne!(Drive::fault(&steering), Fault::None);
    assert_eq!(
        run(&mut steering, 5),
        [LegState::Off; 3],
        "a trip is latched"
    );
    // The set-point is taken through a shared reference, so that a drive may live in a static.
    REAR.set_current(I16F16::from_num(3));
}

fn sample(hall: u8) -> Sample {
    Sample {
        adc_a: 2048,
        adc_b: 2048,
        hall,
        hall_ticks: 0,
    }
}

/// What the control interrupt owns, whatever the motor.
struct Interrupt<L> {
    control: L,
    legs: Legs,
}

impl<L: DriveLoop> Interrupt<L> {
    fn strikes(&mut self, hall: u8) {
        self.legs = self.control.step(&sample(hall));
    }
}

/// The main program sets the current and sees what the drive is doing while the interrupt owns the
/// control loop.
fn halves<D: Drive>() {
    let mut drive = D::new();
    let (set_point, mut control) = drive.split();
    control.precharge();
    let mut interrupt = Interrupt {
        control,
        legs: Legs::OFF,
    };
    assert_eq!(set_point.status().mode, Mode::Precharge, "{}", D::NAME);
    interrupt.strikes(1);
    assert_eq!(interrupt.legs, Legs::LOW, "{}", D::NAME);
    (0..100).for_each(|_| interrupt.strikes(1));
    // Nobody told the bus voltage yet, where it is to be told.
    let untold = Status {
        bus_is_stale: D::SPEC.contains("bus = \"measured\""),
        ..Status::default()
    };
    assert_eq!(set_point.status(), untold, "{}", D::NAME);
    set_point.set_current(I16F16::from_num(5));
    set_point.set_bus(2400);
    (0..8).for_each(|_| interrupt.strikes(1));
    assert!(set_point.status().is_running(), "{}", D::NAME);
    assert!(interrupt.legs.state().contains(&LegState::Pulsed));
    interrupt.strikes(7);
    let tripped = Status {
        mode: Mode::Tripped,
        fault: Fault::Hall,
        bus_is_stale: false,
    };
    assert_eq!(set_point.status(), tripped, "{}", D::NAME);
    assert_eq!(interrupt.control.status(), tripped, "{}", D::NAME);
    assert_eq!(interrupt.legs, Legs::OFF, "{}", D::NAME);
    interrupt.control.reset();
    interrupt.control.calibrate();
    interrupt.strikes(1);
    assert_eq!(set_point.status().mode, Mode::Calibrate, "{}", D::NAME);
    drop(interrupt);
    assert_eq!(drive.fault(), Fault::None, "{}", D::NAME);
}

#[test]
fn generic_firmware_splits_any_drive() {
    halves::<RearHub>();
    halves::<FrontHub>();
    halves::<Steering>();
    halves::<motors_of_any_name::DriveLoop>();
}

/// The halves go where firmware has them: the set-point is shared between contexts, the control loop
/// moves into one.
#[test]
fn the_halves_live_in_contexts_of_their_own() {
    let mut drive = FrontHub::new();
    let (set_point, mut control) = drive.split();
    std::thread::scope(|contexts| {
        contexts.spawn(|| set_point.set_current(I16F16::from_num(5)));
        contexts.spawn(|| DriveSetPoint::set_bus(set_point, 2400));
        contexts.spawn(move || control.step(2048, 2048, 1));
    });
    // Both arrived: the current asks for voltage, and the lower bus for longer pulses than the nominal.
    let mut told = |counts| {
        drive.set_bus(counts);
        drive.reset();
        let compare = drive.step(2048, 2048, 1).compare();
        compare.iter().max().expect("three legs") - compare.iter().min().expect("three legs")
    };
    assert!(told(2000) > told(2400) && told(2400) > 0);
}

/// Periods of 50 us for which a bus voltage that was told is fresh.
const FRESH: usize = 2000;

#[test]
fn the_status_shows_a_bus_voltage_that_is_no_longer_told() {
    let mut drive = FrontHub::new();
    let (set_point, mut control) = drive.split();
    let mut steps = |count: usize| {
        let stale = (0..count).filter(|_| {
            control.step(2048, 2048, 1);
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
    assert!(drive.is_running(), "it is a warning");
    // A reset keeps the set-point, and so its age.
    drive.reset();
    assert!(!drive.status().bus_is_stale);
    // A fixed bus is never stale.
    let mut rear = RearHub::new();
    for _ in 0..2 * FRESH {
        rear.step(2048, 2048, 1);
        assert!(!rear.status().bus_is_stale);
    }
}

#[test]
fn drives_know_their_motors() {
    assert_eq!(<RearHub as Drive>::NAME, "RearHub");
    assert_eq!(<Steering as Drive>::NAME, "Steering");
    assert!(<RearHub as Drive>::SPEC.contains("pole_pairs = 4"));
    assert!(<Steering as Drive>::SPEC.contains("modulation = \"pair\""));
}

/// Motors named like the types that emitted code uses, and like a word of the language.
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
                    },
                    controller: pdcc { emf: model },
                }
            }
        )*};
    }

    drives! {
        BusWatch ControlLoop Default DoubleBuffer Drive DriveLoop DriveSetPoint Fault Format I16F16 LegState Legs
        Loop LoopHalf Mode Rounding Sample SetPoint SharedWord State Status TrackRotorResults Word
    }
}

#[test]
fn a_motor_may_be_named_like_a_type_of_emitted_code() {
    assert!(run(&mut motors_of_any_name::Drive::new(), 5).contains(&LegState::Pulsed));
    assert!(run(&mut motors_of_any_name::Word::default(), 5).contains(&LegState::Pulsed));
    assert!(run(&mut motors_of_any_name::Legs::new(), 5).contains(&LegState::Pulsed));
    assert_eq!(<motors_of_any_name::Drive as Drive>::NAME, "Drive");
    assert_eq!(<motors_of_any_name::State as Drive>::NAME, "State");
}

#[test]
fn the_owner_of_a_drive_needs_neither_its_halves_nor_the_trait() {
    let mut drive = const { motors_of_any_name::Mode::new() };
    drive.set_current(I16F16::from_num(5));
    drive.set_torque(I16F16::from_num(1));
    drive.precharge();
    assert!(!drive.is_running());
    assert_eq!(drive.step(2048, 2048, 1).state(), [LegState::Low; 3]);
    drive.calibrate();
    assert_eq!(drive.step(2048, 2048, 1).state(), [LegState::Off; 3]);
    drive.step(2048, 2048, 0);
    assert_eq!(drive.fault(), Fault::Hall);
    drive.reset();
    assert!(drive.is_running());
    assert_eq!(drive.fault(), Fault::None);
}
