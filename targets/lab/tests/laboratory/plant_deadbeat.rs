//! A float64 reference experiment: an ideal deadbeat controller on the 660 W motor must give the
//! PDCC rows of the reference study (`report/expected.rs`). It uses nothing of the generator, so a
//! difference is an error of the plant or of the figures of merit.

use hexagen::{LegState, Legs, Sample};
use hexagen_lab::closed_loop::{
    CurrentLoop, FiguresOfMerit, Held, LimitOptions, LimitOutcome, RunOptions, Side, measure,
    quasi_square, speed_limit,
};
use hexagen_lab::plant::{PlantParams, Truth};
use hexagen_reference::AnyCommand;
use std::f64::consts::{PI, TAU};

const R: f64 = 0.135;
const L: f64 = 0.22e-3;
const K_PHASE: f64 = 0.1648 / 2.0;
const V_BUS: f64 = 48.0;
const T_S: f64 = 50e-6;
const N: u16 = 1800;
const TORQUE: f64 = 3.3;
const CURRENT: f64 = TORQUE / 0.1648;

fn motor() -> PlantParams {
    PlantParams::ideal(4, R, L, K_PHASE, V_BUS, T_S)
}

/// The reference's shape.
#[derive(Clone, Copy)]
enum Reference {
    QuasiSquare,
    Proportional,
}

/// PDCC, three_phase, nearest, model EMF from the true angle, `euler`, delay 1.
struct Deadbeat {
    reference: Reference,
    torque: f64,
    applied: [f64; 3],
}

impl Deadbeat {
    fn new(reference: Reference, torque: f64) -> Self {
        Self {
            reference,
            torque,
            applied: [0.0; 3],
        }
    }
}

/// Integral of the unit trapezoid (120 degree flat top) from 0 to an angle.
fn shape_integral(angle: f64) -> f64 {
    let ramp = PI / 6.0;
    let x = angle.rem_euclid(TAU);
    let half = |x: f64| match x {
        x if x < ramp => x * x / (2.0 * ramp),
        x if x < PI - ramp => x - ramp / 2.0,
        x => (PI - ramp) - (PI - x).powi(2) / (2.0 * ramp),
    };
    if x < PI {
        half(x)
    } else {
        half(PI) - half(x - PI)
    }
}

fn shape(angle: f64) -> f64 {
    let h = 1e-6;
    (shape_integral(angle + h) - shape_integral(angle - h)) / (2.0 * h)
}

fn lagged(theta: f64) -> [f64; 3] {
    [theta, theta - TAU / 3.0, theta + TAU / 3.0]
}

/// Mean EMF of a period that begins at `from`, in the three phases, common mode removed.
fn mean_emf(truth: &Truth, from: f64) -> [f64; 3] {
    let turn = truth.omega_e * T_S;
    let (begin, end) = (lagged(from), lagged(from + turn));
    let raw: [f64; 3] = std::array::from_fn(|x| {
        let mean = (shape_integral(end[x]) - shape_integral(begin[x])) / turn;
        K_PHASE * truth.omega_m * if turn == 0.0 { shape(end[x]) } else { mean }
    });
    let zero = raw.iter().sum::<f64>() / 3.0;
    raw.map(|e| e - zero)
}

impl CurrentLoop for Deadbeat {
    fn step(&mut self, _: &Sample, truth: &Truth) -> AnyCommand {
        let (a, b) = (1.0 - R * T_S / L, T_S / L);
        let turn = truth.omega_e * T_S;
        let (e_now, e_next) = (
            mean_emf(truth, truth.theta_e),
            mean_emf(truth, truth.theta_e + turn),
        );
        let i_ref = match self.reference {
            Reference::QuasiSquare => {
                // Advance 0: the corner of the sector seen at the sample.
                let (alpha, beta) = quasi_square(truth.theta_e, self.torque / 0.1648);
                let half = 3.0_f64.sqrt() / 2.0;
                [
                    alpha,
                    -alpha / 2.0 + half * beta,
                    -alpha / 2.0 - half * beta,
                ]
            }
            Reference::Proportional => {
                let f = lagged(truth.theta_e + 2.0 * turn).map(|angle| K_PHASE * shape(angle));
                let zero = f.iter().sum::<f64>() / 3.0;
                let f = f.map(|x| x - zero);
                let square: f64 = f.iter().map(|x| x * x).sum();
                f.map(|x| self.torque * x / square)
            }
        };
        let v: [f64; 3] = std::array::from_fn(|x| {
            (i_ref[x] - a * a * truth.currents[x]) / b - a * self.applied[x]
                + a * e_now[x]
                + e_next[x]
        });
        let most = v.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = v.iter().copied().fold(f64::INFINITY, f64::min);
        let t = v.map(|x| (x - f64::midpoint(most, least) + V_BUS / 2.0).clamp(0.0, V_BUS));
        let mean = t.iter().sum::<f64>() / 3.0;
        self.applied = t.map(|x| x - mean);
        Legs::new(
            t.map(|x| (x / V_BUS * f64::from(N)).round() as u16),
            [LegState::Pulsed; 3],
        )
        .into()
    }
}

fn at(reference: Reference, rpm: f64, torque: f64) -> FiguresOfMerit {
    let options = RunOptions::new(rpm * TAU / 60.0, torque / 0.1648);
    let measurement = measure(&motor(), &options, |_: &Truth| {
        Deadbeat::new(reference, torque)
    })
    .unwrap();
    measurement.figures
}

fn assert_near(
    what: &str,
    got: impl Into<Option<f64>>,
    want: impl Into<Option<f64>>,
    tolerance: f64,
) {
    let (got, want) = (got.into(), want.into());
    let distance = got.zip(want).map(|(got, want)| (got - want).abs());
    assert!(
        distance.is_some_and(|distance| distance <= tolerance),
        "{what}: {got:?}, expected {want:?} +- {tolerance}"
    );
}

#[test]
fn quasi_square_row_of_the_design_is_met() {
    let slow = at(Reference::QuasiSquare, 400.0, TORQUE);
    assert_near("mean at 400 rpm", slow.mean_torque_nm, 3.30, 0.01);
    assert_near("pp at 400 rpm", slow.ripple_pp_pct, 2.3, 0.1);
    assert_near("rms at 400 rpm", slow.ripple_rms_pct, 0.2, 0.05);
    let fast = at(Reference::QuasiSquare, 1500.0, TORQUE);
    assert_near("mean at 1500 rpm", fast.mean_torque_nm, 3.25, 0.01);
    assert_near("pp at 1500 rpm", fast.ripple_pp_pct, 12.7, 0.3);
    assert_near("rms at 1500 rpm", fast.ripple_rms_pct, 3.4, 0.1);
}

#[test]
fn proportional_row_of_the_design_is_met() {
    let slow = at(Reference::Proportional, 400.0, TORQUE);
    assert_near("pp at 400 rpm", slow.ripple_pp_pct, 0.13, 0.05);
    assert_near("rms at 400 rpm", slow.ripple_rms_pct, 0.01, 0.02);
    let fast = at(Reference::Proportional, 1500.0, TORQUE);
    assert_near("mean at 1500 rpm", fast.mean_torque_nm, 3.30, 0.01);
    assert_near("pp at 1500 rpm", fast.ripple_pp_pct, 0.5, 0.05);
    assert_near("rms at 1500 rpm", fast.ripple_rms_pct, 0.06, 0.02);
}

#[test]
fn speed_limits_of_the_design_are_met() {
    let run = RunOptions::new(1.0, CURRENT);
    for (reference, percent) in [
        (Reference::QuasiSquare, 87.0),
        (Reference::Proportional, 117.0),
    ] {
        let options = LimitOptions::new(2000.0, TORQUE);
        let limit = speed_limit(&motor(), &run, &options, |_: &Truth| {
            Deadbeat::new(reference, TORQUE)
        })
        .unwrap();
        assert_eq!(limit.outcome, LimitOutcome::Found);
        assert_near("limit", limit.limit_pct.unwrap(), percent, 1.0);
    }
}

#[test]
fn all_four_quadrants_agree() {
    let forward = at(Reference::QuasiSquare, 400.0, TORQUE);
    let backward = at(Reference::QuasiSquare, -400.0, -TORQUE);
    assert_near(
        "reverse motoring mean",
        backward.mean_torque_nm,
        forward.mean_torque_nm.map(|torque| -torque),
        0.003,
    );
    assert_near(
        "reverse motoring rms",
        backward.ripple_rms_pct,
        forward.ripple_rms_pct,
        0.05,
    );
    assert_near(
        "reverse motoring tracking",
        backward.tracking_rms_a,
        forward.tracking_rms_a,
        0.1,
    );
    for (rpm, torque) in [(400.0, -TORQUE), (-400.0, TORQUE)] {
        let braking = at(Reference::QuasiSquare, rpm, torque);
        assert_near("braking mean", braking.mean_torque_nm, torque, 0.01);
        assert_near(
            "braking tracking",
            braking.tracking_rms_a,
            forward.tracking_rms_a,
            0.5,
        );
        assert!(
            braking
                .commutation_us
                .is_some_and(|time| time > 20.0 && time < 400.0),
            "{braking:?}"
        );
    }
    let standstill = at(Reference::Proportional, 0.0, TORQUE);
    assert_near("standstill", standstill.mean_torque_nm, TORQUE, 1e-3);
}

/// The deadbeat controller, without voltage in a narrow band of speeds.
struct Faltering(Option<Deadbeat>);

impl CurrentLoop for Faltering {
    fn step(&mut self, sample: &Sample, truth: &Truth) -> AnyCommand {
        self.0
            .as_mut()
            .map(|controller| controller.step(sample, truth))
            .unwrap_or_default()
    }
}

#[test]
fn speed_limit_is_the_first_crossing_even_if_the_torque_recovers() {
    let run = RunOptions::new(1.0, CURRENT);
    let options = LimitOptions {
        to_rpm: 1000.0,
        ..LimitOptions::new(2000.0, TORQUE)
    };
    let faltering = |from: f64, to: f64| {
        move |initial: &Truth| {
            let rpm = initial.omega_m * 60.0 / TAU;
            let fails = (from..to).contains(&rpm);
            Faltering((!fails).then(|| Deadbeat::new(Reference::Proportional, TORQUE)))
        }
    };
    let found = speed_limit(&motor(), &run, &options, faltering(750.0, 770.0)).unwrap();
    assert_eq!(found.outcome, LimitOutcome::Found);
    assert_near("limit", found.limit_rpm.unwrap(), 740.6, 0.2);
    let never = speed_limit(&motor(), &run, &options, faltering(0.0, 410.0)).unwrap();
    assert_eq!(
        (never.outcome, never.limit_rpm),
        (LimitOutcome::NeverHeld, None)
    );
    assert_eq!(
        (found.lost, never.lost),
        (Some(Side::Below), Some(Side::Below))
    );
    let beyond = speed_limit(&motor(), &run, &options, faltering(0.0, 0.0)).unwrap();
    assert_eq!(
        (beyond.outcome, beyond.limit_pct, beyond.lost),
        (LimitOutcome::NotReached, Some(50.0), None)
    );
}

/// A controller whose torque rises with speed: by 1 % per 100 rpm above 500 rpm.
#[test]
fn a_torque_above_the_demand_is_not_held() {
    let run = RunOptions::new(1.0, CURRENT);
    let scan = |held| {
        let options = LimitOptions {
            held,
            to_rpm: 1000.0,
            ..LimitOptions::new(2000.0, TORQUE)
        };
        let growing = |initial: &Truth| {
            let rpm = initial.omega_m * 60.0 / TAU;
            let torque = TORQUE * (1.0 + 1e-4 * (rpm - 500.0));
            Deadbeat::new(Reference::Proportional, torque)
        };
        speed_limit(&motor(), &run, &options, growing).unwrap()
    };
    let within = scan(Held::Within);
    assert_eq!(
        (within.outcome, within.lost),
        (LimitOutcome::Found, Some(Side::Above))
    );
    assert_near("limit", within.limit_rpm, 800.0, 3.0);
    let at_least = scan(Held::AtLeast);
    assert_eq!(at_least.outcome, LimitOutcome::NotReached);
}
