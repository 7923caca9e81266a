//! Model A in closed loop meets the rows of the reference study of the 660 W motor (`three_phase`).

mod plant;

use hexagen_reference::Ideal;
use plant::{Merits, merits, spec_660w};

const RATED_RPM: f64 = 2000.0;
/// 20 A times 0.1648 Nm/A.
const DEMAND: f64 = 3.296;

fn run(saturation: &str, emf: &str, reference: &str, advance: f64, rpm: f64) -> Merits {
    let spec = spec_660w(&format!(
        r#"
modulation = "three_phase"
saturation = "{saturation}"
emf = "{emf}"
emf_filter = 1.0
reference = "{reference}"
advance = {advance:?}
delay = 1
discretisation = "euler"
word = 32
commutation_threshold = 0.5
commutation_timeout = 20
"#
    ));
    merits(&spec, rpm, || {
        let mut ideal = Ideal::new(&spec).expect("a valid specification");
        ideal.set_current_amps(20.0);
        Box::new(move |sample| ideal.step(sample).duty)
    })
}

fn assert_row(found: Merits, mean: f64, pp: f64) {
    assert!(
        (found.mean / mean - 1.0).abs() < 0.01,
        "mean torque {} Nm, expected {mean}",
        found.mean
    );
    assert!(
        (found.pp - pp).abs() < (0.15 * pp).max(0.6),
        "ripple {} %, expected {pp}",
        found.pp
    );
}

#[test]
fn torque_priority_keeps_the_torque() {
    let run = |pct: f64| {
        run(
            "torque_priority",
            "model",
            "quasi_square",
            2.0,
            pct / 100.0 * RATED_RPM,
        )
    };
    assert_row(run(20.0), 3.30, 1.8);
    assert_row(run(75.0), 3.30, 1.8);
    assert!(run(106.0).mean > 0.97 * DEMAND);
    assert!(run(109.0).mean < 0.97 * DEMAND);
}

#[test]
fn torque_priority_with_estimated_emf() {
    let run = |pct: f64| {
        run(
            "torque_priority",
            "estimated",
            "quasi_square",
            2.0,
            pct / 100.0 * RATED_RPM,
        )
    };
    // As with the model: the estimate is extrapolated with the EMF shape.
    assert_row(run(75.0), 3.30, 1.9);
    assert!(run(106.0).mean > 0.97 * DEMAND);
    assert!(run(109.0).mean < 0.97 * DEMAND);
}

#[test]
fn nearest_row() {
    let run = |pct: f64| {
        run(
            "nearest",
            "model",
            "quasi_square",
            0.0,
            pct / 100.0 * RATED_RPM,
        )
    };
    assert_row(run(20.0), 3.30, 2.3);
    assert_row(run(75.0), 3.25, 12.7);
    assert!(run(86.0).mean > 0.97 * DEMAND);
    assert!(run(88.0).mean < 0.97 * DEMAND);
}

#[test]
fn proportional_row() {
    let run = |pct: f64| {
        run(
            "nearest",
            "model",
            "proportional",
            0.0,
            pct / 100.0 * RATED_RPM,
        )
    };
    assert_row(run(20.0), 3.30, 0.13);
    assert_row(run(75.0), 3.30, 0.5);
    assert!(run(116.0).mean > 0.97 * DEMAND);
    assert!(run(119.0).mean < 0.97 * DEMAND);
}

#[test]
fn torque_priority_with_proportional_reference() {
    let run = |pct: f64| {
        run(
            "torque_priority",
            "model",
            "proportional",
            0.0,
            pct / 100.0 * RATED_RPM,
        )
    };
    assert_row(run(75.0), 3.30, 0.5);
    assert!(run(117.0).mean > 0.97 * DEMAND);
}

#[test]
fn beyond_the_limit_torque_priority_equals_nearest() {
    for pct in [110.0, 115.0, 120.0, 130.0] {
        let rpm = pct / 100.0 * RATED_RPM;
        let priority = run("torque_priority", "model", "quasi_square", 2.0, rpm).mean;
        let nearest = run("nearest", "model", "quasi_square", 2.0, rpm).mean;
        assert!(
            priority > 0.97 * nearest,
            "{pct} %: {priority} Nm, nearest {nearest} Nm"
        );
    }
}
