//! Every motor of the library on every board: which fit follows from a few numbers of both, and
//! these generate; the others are refused for what does not fit.

use hexagen_codegen::spec::ast::{SpecAst, Value};
use hexagen_codegen::spec::{BOARDS, BoardFile, Spec, parse_board};
use hexagen_lab::boards::library_of_boards;
use hexagen_lab::engine::{PlantOptions, SelectedMotor};

/// What a board's file says, SI units.
struct Numbers {
    bus: [f64; 2],
    /// Ampere per count of 12 bits.
    gain: f64,
    /// Second; none where the motor's file says it.
    period: Option<f64>,
    /// Its sensors are such as no controller is generated for yet.
    waits: bool,
}

fn numbers(file: &BoardFile) -> Numbers {
    let number = |name: &str| match file.inverter.field(name).map(|field| &field.value) {
        Some(Value::Number(number)) => Some(number.si()),
        _ => None,
    };
    let all = |name| number(name).unwrap_or_else(|| panic!("no {name}"));
    let shunt = number("shunt")
        .map(|shunt| all("adc_reference") / (4096.0 * shunt * all("amplifier_gain")));
    let periods = number("pwm_per_control").unwrap_or(1.0);
    let phases = file
        .inverter
        .field("sensed_phases")
        .map(|field| &field.value);
    let is_abc = phases.is_some_and(|value| matches!(value, Value::Word(word) if word == "abc"));
    Numbers {
        bus: [all("bus_min"), all("bus_max")],
        gain: shunt.or_else(|| number("adc_gain")).expect("a gain"),
        period: number("f_pwm").map(|frequency| periods / frequency),
        waits: is_abc,
    }
}

/// The trip level that a motor's file states, ampere.
fn stated_trip(motor: &SpecAst) -> Option<f64> {
    match &motor.inverter.field("trip_current")?.value {
        Value::Number(number) => Some(number.si()),
        _ => None,
    }
}

/// What keeps a motor from a board, by their numbers alone.
fn obstacle(board: &Numbers, motor: &Spec, trip: Option<f64>) -> Option<&'static str> {
    let (reach, max) = (2048.0 * board.gain, motor.inverter.max_current);
    let period = board.period.unwrap_or(motor.inverter.t_s);
    let electrical = motor.inverter.maximum_speed * f64::from(motor.motor.pole_pairs);
    let turns = electrical * period / std::f64::consts::TAU;
    let per_period = motor.motor.resistance * period / motor.motor.inductance;
    if motor.inverter.v_bus < board.bus[0] || motor.inverter.v_bus > board.bus[1] {
        Some("HX0330")
    } else if trip.is_some_and(|trip| trip > reach - board.gain) {
        Some("HX0306")
    } else if reach < motor.motor.rated_current.max(max) {
        Some("HX0305")
    } else if max < 10.0 * board.gain {
        Some("HX0317")
    } else if per_period > 0.5 {
        Some("HX0301")
    } else if turns > 1.0 / 6.0 {
        Some("HX0312")
    } else if board.waits {
        Some("HX0402")
    } else {
        None
    }
}

#[test]
fn a_motor_fits_a_board_by_voltage_current_and_time_constant() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("the library reads");
    let boards = library_of_boards(&()).expect("the library reads");
    let (mut fitting, mut waiting) = (0, 0);
    for (board, entry) in BOARDS.iter().zip(&boards) {
        let numbers = numbers(&parse_board(board.text, board.name).expect("is TOML"));
        for (motor, fit) in motors.iter().zip(&entry.motors) {
            // A motor that generates for no inverter fits none.
            let Ok(own) = motor.prepare(None) else {
                assert!(!fit.fits);
                continue;
            };
            let pair = format!("{} on {}", fit.motor, entry.name);
            let reason = fit.reason.as_deref().unwrap_or_default();
            let obstacle = obstacle(&numbers, &own.spec, stated_trip(&motor.ast));
            waiting += usize::from(obstacle == Some("HX0402"));
            match obstacle {
                Some(code) => assert!(reason.contains(code), "{pair}: {code}, not {reason:?}"),
                None => assert!(fit.fits, "{pair}: {reason}"),
            }
            fitting += usize::from(fit.fits);
        }
    }
    assert!(
        fitting + waiting > 30,
        "{fitting} pairs fit, {waiting} but for their sensors"
    );
}
