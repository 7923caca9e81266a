//! Every motor of the library on every board: which fit follows from a few numbers of both, and
//! these generate; the others are refused for what does not fit.

use hexagen_codegen::spec::ast::{SpecAst, Value};
use hexagen_codegen::spec::{BOARDS, BoardFile, Spec, parse_board};
use hexagen_lab::boards::library_of_boards;
use hexagen_lab::closed_loop::ClosedLoop;
use hexagen_lab::engine::{Model, PlantOptions, Prepared, SelectedMotor, plant_of, run_of};
use hexagen_lab::plant::Plant;
use rayon::prelude::*;

/// What a board's file says, SI units.
struct Numbers {
    bus: [f64; 2],
    /// Ampere per count of 12 bits.
    gain: f64,
    /// Greatest current that the amplifiers show, ampere; none where the file does not tell.
    linear: Option<f64>,
    /// Second; none where the motor's file says it.
    period: Option<f64>,
}

fn numbers(file: &BoardFile) -> Numbers {
    let number = |name: &str| match file.inverter.field(name).map(|field| &field.value) {
        Some(Value::Number(number)) => Some(number.si()),
        _ => None,
    };
    let all = |name| number(name).unwrap_or_else(|| panic!("no {name}"));
    let shunt = number("shunt")
        .map(|shunt| all("adc_reference") / (4096.0 * shunt * all("amplifier_gain")));
    let linear =
        number("amplifier_swing").map(|swing| swing / (all("shunt") * all("amplifier_gain")));
    let periods = number("pwm_per_control").unwrap_or(1.0);
    Numbers {
        bus: [all("bus_min"), all("bus_max")],
        gain: shunt.or_else(|| number("adc_gain")).expect("a gain"),
        linear,
        period: number("f_pwm").map(|frequency| periods / frequency),
    }
}

/// What a motor's file states of its inverter.
struct Stated {
    /// Ampere.
    trip: Option<f64>,
    /// Whether it says the frequency of the PWM; a motor with a board of its own leaves that to it.
    frequency: bool,
}

fn stated(motor: &SpecAst) -> Stated {
    let field = |name: &str| motor.inverter.field(name).map(|field| &field.value);
    Stated {
        trip: match field("trip_current") {
            Some(Value::Number(number)) => Some(number.si()),
            _ => None,
        },
        frequency: field("f_pwm").is_some(),
    }
}

/// What keeps a motor from a board, by their numbers alone.
fn obstacle(board: &Numbers, motor: &Spec, stated: &Stated) -> Option<&'static str> {
    let converter = 2048.0 * board.gain;
    let reach = board
        .linear
        .map_or(converter, |linear| linear.min(converter));
    let max = motor.inverter.max_current;
    let period = board.period.unwrap_or(motor.inverter.t_s);
    let electrical = motor.inverter.maximum_speed * f64::from(motor.motor.pole_pairs);
    let turns = electrical * period / std::f64::consts::TAU;
    let per_period = motor.motor.resistance * period / motor.motor.inductance;
    if board.period.is_none() && !stated.frequency {
        Some("HX0105")
    } else if motor.inverter.v_bus < board.bus[0] || motor.inverter.v_bus > board.bus[1] {
        Some("HX0330")
    } else if stated.trip.is_some_and(|trip| trip > reach - board.gain) {
        Some("HX0306")
    } else if reach < motor.motor.rated_current.max(max) {
        Some("HX0305")
    } else if max < 10.0 * board.gain {
        Some("HX0317")
    } else if per_period > 0.5 {
        Some("HX0301")
    } else if turns
        > 1.0
            / if motor.angle_sensor().is_some() {
                15.0
            } else {
                6.0
            }
    {
        Some("HX0312")
    } else {
        None
    }
}

#[test]
fn a_motor_fits_a_board_by_voltage_current_and_time_constant() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("the library reads");
    let boards = library_of_boards(&()).expect("the library reads");
    let mut fitting = 0;
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
            let obstacle = obstacle(&numbers, &own.spec, &stated(&motor.ast));
            match obstacle {
                Some(code) => assert!(reason.contains(code), "{pair}: {code}, not {reason:?}"),
                None => assert!(fit.fits, "{pair}: {reason}"),
            }
            fitting += usize::from(fit.fits);
        }
    }
    assert!(fitting > 30, "{fitting} pairs fit");
}

/// The board's sensors see every current that a drive asks for, and so the drive makes its torque.
#[test]
fn no_motor_on_a_board_has_a_blind_sample() {
    let pairs = BOARDS.iter().flat_map(|board| {
        let on_board = PlantOptions {
            board: Some(board.name.to_owned()),
            ..PlantOptions::default()
        };
        let motors = SelectedMotor::library(&on_board).expect("the library reads");
        let drives = motors.into_iter().filter_map(|motor| {
            let drive = motor.prepare_for_torque(None).ok()?;
            Some((format!("{} on {}", motor.source.name, board.name), drive))
        });
        drives.collect::<Vec<_>>()
    });
    let pairs: Vec<(String, Prepared)> = pairs.collect();
    assert!(pairs.len() > 30);
    pairs.par_iter().for_each(|(pair, drive)| {
        let spec = &drive.spec;
        for share in [0.1, 0.4, -0.4] {
            let omega = share * spec.motor.rated_speed;
            let demand = drive.demand() * f64::signum(share);
            let run = run_of(spec, omega, demand);
            let plant = Plant::new(plant_of(spec), 0.117, omega).expect("a plant");
            let engine = drive.engine(Model::Fixed, drive.set_point(demand));
            let mut closed = ClosedLoop::new(plant, engine, run.delay);
            let (settling, measured) = run.periods(&plant_of(spec));
            closed.run(settling, &mut ());
            let periods = measured.min(4000);
            let torque: f64 = (0..periods)
                .map(|_| {
                    closed.run(1, &mut ());
                    closed.plant().truth().mean_torque / periods as f64
                })
                .sum();
            assert!(closed.tripped().is_none(), "{pair} at {share}");
            assert_eq!(closed.plant().blind_samples(), 0, "{pair} at {share}");
            let share_of_torque = torque / demand;
            // A motor of 5 A on a board of 300 A has few counts of its current.
            assert!(
                (share_of_torque - 1.0).abs() < 0.03,
                "{pair} at {share}: {share_of_torque}"
            );
        }
    });
}
