//! A motor that shall turn the other way: which two Hall sensors to exchange with which two phases,
//! as chapter 8 of the guide and `BRING-UP.md` say.

use hexagen_lab::closed_loop::{Cause, ClosedLoop, Measurement, measure};
use hexagen_lab::engine::{Model, MotorSource, Prepared, plant_of, prepare, run_of};
use hexagen_lab::plant::{Mechanics, Plant, PlantParams};

/// Two of three wires, 0 to 2 for a to c.
type Pair = [usize; 2];

const PAIRS: [Pair; 3] = [[0, 1], [1, 2], [2, 0]];

/// Phases, and the Hall sensors that belong to them: a and b with Ha and Hc, b and c with Ha and Hb,
/// c and a with Hb and Hc.
const REVERSED: [[Pair; 2]; 3] = [[[0, 1], [2, 0]], [[1, 2], [0, 1]], [[2, 0], [1, 2]]];

fn drive() -> Prepared {
    let motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
    prepare(&motor, Some("pdcc:reference=quasi_square")).expect("generates")
}

/// The plant with two phases and two Hall sensors exchanged.
fn exchanged(drive: &Prepared, phases: Pair, halls: Pair) -> PlantParams {
    let mut plant = plant_of(&drive.spec);
    plant.wiring.windings.swap(phases[0], phases[1]);
    plant.hall_codes = plant.hall_codes.map(|code| {
        let mut lines = [code >> 2 & 1, code >> 1 & 1, code & 1];
        lines.swap(halls[0], halls[1]);
        lines[0] << 2 | lines[1] << 1 | lines[2]
    });
    plant
}

/// At a held speed, with four fifths of the rated torque for a set-point.
fn held(drive: &Prepared, plant: &PlantParams, speed: f64) -> Measurement {
    let torque = 0.8 * drive.demand();
    let options = run_of(&drive.spec, speed * drive.spec.motor.rated_speed, torque);
    measure(
        plant,
        &options,
        drive.maker(Model::Fixed, drive.set_point(torque)),
    )
    .expect("a plant")
}

/// Speed in rad/s of a free rotor, a tenth of a second after its start from rest; or why it tripped.
fn free(drive: &Prepared, mut plant: PlantParams) -> Result<f64, Cause> {
    plant.mechanics = Some(Mechanics {
        inertia: 2e-3,
        opposing_torque: 0.01,
        external_torque: 0.0,
        viscous: 0.0,
    });
    let torque = 0.8 * drive.demand();
    let periods = (0.1 / plant.t_s) as usize;
    let delay = run_of(&drive.spec, 0.0, torque).delay;
    let plant = Plant::new(plant, 0.3, 0.0).expect("a plant");
    let engine = drive.engine(Model::Fixed, drive.set_point(torque));
    let mut closed = ClosedLoop::new(plant, engine, delay);
    closed.run(periods, &mut ());
    match closed.tripped() {
        Some(trip) => Err(trip.fault),
        None => Ok(closed.plant().truth().omega_m),
    }
}

#[test]
fn of_nine_exchanges_three_reverse_the_motor_and_six_halve_its_torque() {
    let drive = drive();
    let straight = plant_of(&drive.spec);
    let torque = |measured: &Measurement| measured.figures.mean_torque_nm;
    let forward = torque(&held(&drive, &straight, 0.5)).expect("turns");
    let speed = free(&drive, straight).expect("turns");
    for phases in PAIRS {
        for halls in PAIRS {
            let plant = exchanged(&drive, phases, halls);
            let backward = held(&drive, &plant, -0.5);
            let reached = free(&drive, plant);
            let found = torque(&backward).filter(|_| backward.tripped.is_none());
            let torque = found.map(|torque| torque / forward);
            let speed = reached.map(|reached| reached / speed);
            let what = format!("phases {phases:?}, Halls {halls:?}: {torque:?}, {speed:?}");
            let is_reversed = |ratio: f64| (ratio + 1.0).abs() < 0.005;
            let is_rough = |ratio: f64| (0.4..0.6).contains(&ratio);
            if REVERSED.contains(&[phases, halls]) {
                assert!(torque.is_some_and(is_reversed), "{what}");
                assert!(speed.is_ok_and(is_reversed), "{what}");
            } else {
                assert!(torque.is_some_and(is_rough), "{what}");
                assert!(speed.is_ok_and(is_rough), "{what}");
            }
        }
    }
}
