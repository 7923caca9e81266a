//! Hall edges out of place, stated by `hall_angles`: the drive runs as with sensors in their places;
//! without the statement the torque is wrong.

use hexagen_lab::closed_loop::{FiguresOfMerit, measure};
use hexagen_lab::engine::{Model, MotorSource, Prepared, plant_of, prepare, run_of};

/// No two sectors are alike: 52 to 72 degrees.
const EDGES: [f64; 6] = [-38.0, 34.0, 88.0, 143.0, 215.0, 270.0];

fn drive(motor: &str, law: &str, is_stated: bool) -> Prepared {
    let mut source = MotorSource::of_library(motor).expect("is in the library");
    if is_stated {
        let list: Vec<String> = EDGES.iter().map(|edge| format!("\"{edge} deg\"")).collect();
        let line = format!("[motor]\nhall_angles = [{}]\n", list.join(", "));
        source.text = source.text.replacen("[motor]\n", &line, 1);
    }
    prepare(&source, Some(law)).unwrap_or_else(|why| panic!("{motor}: {why}"))
}

/// At a part of the rated speed with a torque in part of the rating; `edges`: those of the plant.
fn run(drive: &Prepared, edges: [f64; 6], [speed, torque]: [f64; 2]) -> FiguresOfMerit {
    let mut plant = plant_of(&drive.spec);
    plant.hall_edges_deg = edges;
    let torque = torque * drive.demand();
    let options = run_of(&drive.spec, speed * drive.spec.motor.rated_speed, torque);
    let maker = drive.maker(Model::Fixed, drive.set_point(torque));
    let measured = measure(&plant, &options, maker).expect("a plant");
    assert_eq!(measured.tripped, None);
    measured.figures
}

#[test]
fn stated_edges_cost_nothing_and_unstated_ones_torque() {
    let mut worse = 0;
    for (motor, law) in [
        ("trivedi-keshri-660w", "pdcc"),
        ("hoverboard-hub", "pi-pwm"),
        ("teknic-m2310p", "pdcc:emf=model"),
    ] {
        let (plain, stated) = (drive(motor, law, false), drive(motor, law, true));
        let even = plant_of(&plain.spec).hall_edges_deg;
        assert_eq!(plant_of(&stated.spec).hall_edges_deg, EDGES);
        // Motoring and braking, both ways.
        for point in [
            [0.25, 0.8],
            [0.6, 0.8],
            [0.6, -0.5],
            [-0.6, -0.8],
            [-0.25, 0.5],
        ] {
            let right = run(&plain, even, point);
            let known = run(&stated, EDGES, point);
            let unknown = run(&plain, EDGES, point);
            let ripple = |of: &FiguresOfMerit| of.ripple_pp_pct.expect("a torque");
            let torque = |of: &FiguresOfMerit| of.mean_torque_nm.expect("a torque");
            let what = format!(
                "{motor}, {law}, {point:?}: ripple {:.2} in place, {:.2} stated, {:.2} unstated",
                ripple(&right),
                ripple(&known),
                ripple(&unknown),
            );
            assert!(ripple(&known) < ripple(&right) + 0.4, "{what}");
            let deviation = torque(&known) / torque(&right) - 1.0;
            assert!(deviation.abs() < 0.003, "{what}: {deviation}");
            worse += usize::from(ripple(&unknown) > ripple(&known) + 1.0);
        }
    }
    // Of 15; the observer makes up for some of it at low speed.
    assert!(
        worse >= 12,
        "{worse} points at which unstated edges make more ripple"
    );
}
