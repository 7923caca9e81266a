//! The envelope is where the simulated bus begins to cut the current, and within it the torque is reached; no
//! profile does better than the linear program's.

use hexagen_codegen::spec::Envelope;
use hexagen_codegen::spec::{EmfShape, Reference};
use hexagen_lab::any_profile;
use hexagen_lab::engine::{PlantOptions, Prepared, SelectedMotor};
use std::f64::consts::TAU;

/// Motors of every shape, inductance and board of the library that hold more than their rated speed.
const MOTORS: [&str; 8] = [
    "trivedi-keshri-660w",
    "anaheim-bly172s",
    "anaheim-bly341s",
    "mit-mini-cheetah",
    "odrive-d6374-150kv",
    "hoverboard-hub",
    "teknic-m2310p",
    "regal-5sme39dl0756",
];

fn drive(motor: &str, variant: &str) -> Prepared {
    SelectedMotor::find(motor, &PlantOptions::default())
        .and_then(|motor| motor.prepare_for_torque(Some(variant)))
        .expect("generates")
}

/// Mean torque over the demand and share of saturated periods, percent.
fn measured(drive: &Prepared, omega_m: f64, torque: f64) -> (f64, f64) {
    let run = drive.measure_at(omega_m, torque).expect("runs");
    assert_eq!(run.tripped, None);
    let figures = run.figures;
    (
        100.0 * figures.mean_torque_nm.expect("a mean") / torque,
        figures.saturated_pct.expect("a share"),
    )
}

/// All motors of the library, with both controllers whose pulses reach every voltage of the hexagon, both ways.
#[test]
fn the_torque_of_the_envelope_is_reached_within_two_percent() {
    let library = SelectedMotor::library(&PlantOptions::default()).expect("is read");
    let mut missed = vec![];
    for (motor, variant) in library
        .iter()
        .flat_map(|motor| ["pdcc", "pi-pwm"].map(|variant| (motor, variant)))
    {
        let drive = motor.prepare_for_torque(Some(variant)).expect("generates");
        let envelope = Envelope::of(&drive.spec);
        let lasts = envelope.speed(drive.demand()).expect("is held");
        // A fast motor turns too far in a period beyond its greatest speed.
        let most = drive.spec.inverter.maximum_speed;
        for (share, sign) in [0.7, 1.0, 1.05]
            .into_iter()
            .flat_map(|share| [(share, 1.0), (share, -1.0)])
        {
            let omega_m = (share * lasts).min(most);
            let torque = envelope.torque(omega_m).min(drive.demand());
            if torque <= 0.0 {
                continue;
            }
            let (reached, _) = measured(&drive, sign * omega_m, sign * torque);
            if !(98.0..=101.0).contains(&reached) {
                missed.push(format!(
                    "{} {variant} at {}: {reached:.2} %",
                    drive.motor,
                    sign * share
                ));
            }
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// On boards whose legs reach the whole bus; a dead time takes a little besides.
#[test]
fn the_bus_cuts_the_current_beyond_the_envelope_and_not_within() {
    for motor in MOTORS {
        let drive = drive(motor, "pdcc");
        let envelope = Envelope::of(&drive.spec);
        if envelope.reach < 1.0 {
            continue;
        }
        let torque = drive.demand();
        let lasts = envelope.speed(torque).expect("is held");
        let (_, within) = measured(&drive, 0.98 * lasts, torque);
        let (_, beyond) = measured(&drive, 1.02 * lasts, torque);
        assert!(within < 0.5 && beyond > 10.0, "{motor}: {within} {beyond}");
    }
}

/// The 660 W motor of the paper, of which independent bounds are known: 20 and 22 A of peak.
#[test]
fn no_profile_has_more_torque_than_the_bound() {
    let rpm = TAU / 60.0;
    let of = |peak| Envelope {
        emf_shape: EmfShape::Trapezoidal {
            flat_top_deg: 120.0,
        },
        reference: Reference::QuasiSquare,
        pole_pairs: 4.0,
        resistance: 0.135,
        inductance: 0.22e-3,
        emf_constant: 0.0824,
        t_s: 50e-6,
        v_bus: 48.0,
        pairs: false,
        reach: 1.0,
        max_current: peak,
        bus_current: None,
        weakening: None,
    };
    for (speed, at_20, at_22) in [
        (2400.0, 3.20, 3.48),
        (2600.0, 3.01, 3.27),
        (2800.0, 2.73, 2.97),
        (3000.0, 1.96, 2.25),
    ] {
        for (peak, known) in [(20.0, at_20), (22.0, at_22)] {
            let torque = any_profile::torque(&of(peak), speed * rpm);
            assert!((torque - known).abs() < 0.01, "{speed} {peak}: {torque}");
        }
    }
    // The paper's torque: nothing passes 132 % of rated speed at 22 A.
    let lasts = any_profile::speed(&of(22.0), 3.3, 0.0) / rpm / 2000.0;
    assert!((lasts - 1.32).abs() < 0.04, "{lasts}");
}

#[test]
fn the_bound_of_any_profile_is_never_below_the_envelope() {
    for motor in MOTORS {
        let envelope = Envelope::of(&drive(motor, "pdcc").spec);
        for share in [0.2, 0.6, 0.9, 0.97] {
            let omega_m = share * envelope.idle_speed();
            let (own, any) = (
                envelope.torque(omega_m),
                any_profile::torque(&envelope, omega_m),
            );
            // The program's steps are chords of the currents.
            assert!(any >= own * 0.998, "{motor} at {share}: {any} {own}");
        }
    }
}
