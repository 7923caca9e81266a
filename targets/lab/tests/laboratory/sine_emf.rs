//! An estimated sine EMF keeps its amplitude when rotated from period to period: the torque meets
//! the demand.

use hexagen_lab::closed_loop::mean_torque;
use hexagen_lab::engine::{Model, MotorSource, plant_of, prepare, run_of};

/// Tolerance below the demand: a quasi-square reference is up to a period late.
const LOST: f64 = 0.08;

/// Tolerance above the demand.
const GAINED: f64 = 0.03;

#[test]
fn an_estimated_sine_makes_the_demanded_torque() {
    let motor = MotorSource::of_library("br2804-1700kv").expect("is in the library");
    let mut wrong = vec![];
    for variant in ["word=32", "word=16", "delay=0", "emf_filter=1"] {
        let variant = format!("pdcc:reference=quasi_square,{variant}");
        let drive = prepare(&motor, Some(&variant)).expect("generates");
        let (plant, demand) = (plant_of(&drive.spec), drive.demand());
        // 3.1, 9.5 and 12.6 electrical degrees per period.
        for rpm in [3000.0_f64, 9000.0, 12000.0] {
            let run = run_of(&drive.spec, rpm.to_radians() * 6.0, demand);
            let maker = drive.maker(Model::Fixed, drive.set_point(demand));
            let torque = mean_torque(&plant, &run, &maker).expect("runs");
            let share = torque.map(|torque| torque / demand);
            println!("{variant} at {rpm} rpm: {share:?}");
            if !share.is_ok_and(|share| (1.0 - LOST..1.0 + GAINED).contains(&share)) {
                wrong.push(format!("{variant} at {rpm} rpm: {share:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
