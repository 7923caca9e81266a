//! Fixed and ideal runs on the same ADC counts: every figure of merit of all rows with a modulator,
//! and, within 1 %, the mean torque of the others.
//!
//! A controller that applies one of a few vectors may decide a near tie either way, after which the
//! patterns differ. The tests of `hexagen-reference` compare its single decisions from the same
//! state.

use hexagen_lab::accuracy::{differences, side_by_side};
use hexagen_lab::engine::{EngineKind, MotorSource, plant_of, prepare, run_of};
use hexagen_lab::results::design_table;
use std::f64::consts::TAU;

const TORQUE: f64 = 3.3;

#[test]
fn fixed_and_ideal_agree_in_all_figures_of_rows_with_a_modulator_and_in_the_torque_of_all() {
    let motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
    let (mut compared, mut different) = (0, 0);
    for row in design_table() {
        for capture in ["timer", "sampled"] {
            let capture = format!("hall_capture={capture}");
            let variant = row.variant.replace("hall_capture=timer", &capture);
            let drive = prepare(&motor, Some(&variant)).expect("generates");
            assert_eq!(drive.engine_kind(), EngineKind::Compiled, "{variant}");
            let plant = plant_of(&drive.spec);
            let set_point = drive.set_point(TORQUE);
            for rpm in [400.0, 1500.0] {
                let run = run_of(&drive.spec, rpm * TAU / 60.0, TORQUE);
                let both = side_by_side(&drive, &plant, &run, set_point).expect("runs");
                let ideal = &both.ideal.figures;
                let decides = !drive.spec.controller.modulates();
                for figure in differences(
                    drive.spec.controller.common().reference,
                    &both.fixed.figures,
                    ideal,
                    ideal,
                ) {
                    if decides && figure.figure != "mean torque" {
                        continue;
                    }
                    // An extreme can come of one sample, whose count of the edge timer is rounded.
                    let is_extreme = figure.figure == "torque ripple, peak to peak";
                    let most = match (decides, is_extreme) {
                        (true, _) => 2.0,
                        (false, true) => 3.0,
                        (false, false) => 1.0,
                    };
                    assert!(
                        figure.of_allowance <= most,
                        "{variant} at {rpm} rpm: {figure:?}"
                    );
                    compared += 1;
                }
                different += usize::from(both.fixed.figures != both.ideal.figures);
            }
        }
    }
    // Nine rows have a modulator. That with a current in proportion to the EMF has none of the two
    // figures that compare with a quasi-square current.
    assert_eq!(compared, (8 * 16 + 14 + 3) * 2 * 2);
    // A run may round every compare value equally, but all of them only if both were the same
    // model.
    assert!(different > 12, "only {different} of 48 runs differ at all");
}
