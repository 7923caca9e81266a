//! The study of faults: classes behave as physics and the supervisor's rules say.

use crate::encoder::with_encoder;
use hexagen_lab::closed_loop::Cause;
use hexagen_lab::engine::{Model, MotorSource, PlantOptions, Prepared, prepare};
use hexagen_lab::faults::{FaultRow, FaultStudy, Part, Seen, classes, study};
use hexagen_lab::plant::SHORT_RESISTANCE;

fn drive(variant: &str) -> Prepared {
    let motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
    prepare(&motor, Some(variant)).expect("generates")
}

fn studied(drive: &Prepared) -> FaultStudy {
    let options = PlantOptions::default();
    study(drive, Model::Fixed, &options, drive.demand(), &()).expect("runs")
}

#[track_caller]
fn row<'s>(study: &'s FaultStudy, fault: &str) -> &'s FaultRow {
    let mut rows = study.rows.iter();
    rows.find(|row| row.fault == fault)
        .unwrap_or_else(|| panic!("no fault `{fault}`"))
}

/// Expects that every run trips by this cause.
#[track_caller]
fn assert_trips(row: &FaultRow, cause: Cause) {
    assert_eq!(row.seen, Seen::Always, "{row:?}");
    assert!(
        row.causes.iter().all(|known| known.cause == cause),
        "{row:?}"
    );
    assert_eq!(row.torque_pct, None, "{row:?}");
}

#[test]
fn classes_do_what_physics_says() {
    let drive = drive("pdcc:reference=quasi_square");
    let study = studied(&drive);
    assert_eq!(
        (study.points.len(), study.rows.len()),
        (8, study.totals.classes + study.totals.sound)
    );
    assert!(study.totals.classes >= 41 && study.totals.sound >= 8);

    // An ADC at an end of its range trips on its first sample; the current is still the old one.
    for phase in ["a", "b"] {
        for end in ["lowest", "highest"] {
            let row = row(
                &study,
                &format!("current sensor {phase}: stuck at the {end} count"),
            );
            assert_trips(row, Cause::AdcRange);
            assert_eq!(row.after_ms, Some(0.0));
            assert!(row.largest_over_max < 1.05, "{row:?}");
        }
    }
    // A stuck Hall line shows as an invalid code within an electrical turn: 30 ms at the low speed.
    for hall in ["Ha", "Hb", "Hc"] {
        for level in ["low", "high"] {
            let row = row(&study, &format!("Hall sensor {hall} stuck {level}"));
            assert_trips(row, Cause::Hall);
            assert!(row.after_ms.is_some_and(|ms| ms < 30.0), "{row:?}");
        }
    }
    // An open wire leaves most of the mean torque at low speed, but no even one.
    let open = row(&study, "wire of phase a open");
    let sound = study
        .of_part(Part::Sound)
        .filter_map(|row| row.ripple_pp_pct);
    let sound = sound.reduce(f64::max).expect("a sound drive");
    assert!(
        open.ripple_pp_pct
            .is_some_and(|ripple| ripple > 2.0 * sound),
        "{open:?}, {sound}"
    );
    // The supervisor documents that it does not see these: `unseen.rs`.
    let frozen = row(&study, "current sensor a: stuck at 0 A");
    assert_eq!(frozen.seen, Seen::Never);
    assert!(
        frozen.passes_unseen(2.0 * study.trip_current_a),
        "{frozen:?}"
    );
    let lost = row(&study, "interrupt lost for good");
    assert_eq!(
        lost.seen,
        Seen::Never,
        "a drive that does not run cannot trip"
    );
    assert!(lost.largest_over_max > 3.0, "{lost:?}");
    // Half of the flux makes half of the torque; two phases of three leave part of it.
    let torque = |fault: &str| row(&study, fault).torque_pct.expect("a run without a trip");
    let [least, greatest] = torque("magnets half demagnetised");
    assert!(least > 48.0 && greatest < 52.0, "{least} {greatest}");
    for phase in ["a", "b", "c"] {
        let [least, greatest] = torque(&format!("wire of phase {phase} open"));
        assert!(least > 5.0 && greatest < 90.0, "{least} {greatest}");
    }
    // The bus drives its current through a short and two switches in every period. Samples are taken
    // while pulsed legs are low: it shows in them once a leg stays high, and in phase c never, which
    // has no sensor.
    let across = drive.spec.inverter.v_bus / SHORT_RESISTANCE;
    let shorts: Vec<&FaultRow> = study
        .rows
        .iter()
        .filter(|row| row.fault.contains("shorted"))
        .collect();
    assert_eq!(shorts.len(), 6);
    for row in shorts {
        let over = row.largest_a / across;
        assert!((1.0..1.1).contains(&over), "{row:?}");
        if row.fault == "phase c shorted to minus" {
            assert_eq!(row.seen, Seen::Never, "{row:?}");
        } else {
            assert_trips(row, Cause::AdcRange);
            assert!(row.after_ms.is_some_and(|ms| ms > 1.0), "{row:?}");
        }
    }
    // A field that turns backward makes no mean torque.
    let [least, greatest] = torque("wires of phases a and b exchanged");
    assert!(least > -25.0 && greatest < 25.0, "{least} {greatest}");
}

#[test]
fn sound_drives_do_not_trip() {
    for variant in ["pdcc", "pi-pwm", "pdcc:reference=quasi_square"] {
        let study = studied(&drive(variant));
        for row in study.of_part(Part::Sound) {
            assert_eq!((row.tripped, row.runs), (0, 8), "{variant}: {row:?}");
            assert!(row.largest_a < study.trip_current_a, "{variant}: {row:?}");
        }
        assert_eq!(study.totals.false_alarms, 0);
        let specified = row(&study, "as specified");
        let torque = specified.torque_pct.expect("no run trips");
        assert!(torque.iter().all(|percent| (percent - 100.0).abs() < 1e-9));
    }
}

#[test]
fn a_blocked_shaft_is_noticed_where_stalls_are_watched() {
    let blocked = |text: &str| {
        let motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
        let text = motor
            .text
            .replace("max_current", &format!("{text}max_current"));
        let drive = prepare(&MotorSource { text, ..motor }, Some("pdcc")).expect("generates");
        let study = studied(&drive);
        (study.stall_timeout_s, row(&study, "shaft blocked").clone())
    };
    let (timeout, row) = blocked("");
    assert_eq!((timeout, row.seen), (None, Seen::Never));
    let (timeout, row) = blocked("stall_timeout = \"150 ms\"\n");
    assert_eq!(timeout, Some(0.15));
    assert_trips(&row, Cause::Stall);
    let after = row.after_ms.expect("trips");
    // The last edge came up to a sector before the shaft was blocked.
    assert!((140.0..=150.1).contains(&after), "{after}");
}

/// An angle that stays shows as a rotor that stays, though the shaft turns on.
#[test]
fn an_angle_that_stays_is_noticed_where_stalls_are_watched() {
    let mut source = with_encoder("trivedi-keshri-660w", 4);
    let stall = "[inverter]\nstall_timeout = \"1 s\"\n";
    source.text = source.text.replacen("[inverter]\n", stall, 1);
    let drive = prepare(&source, Some("pdcc")).expect("generates");
    let study = studied(&drive);
    assert_trips(row(&study, "angle stuck"), Cause::Stall);
}

#[test]
fn parts_that_a_drive_lacks_have_no_classes() {
    let has = |variant: &str, part: Part| {
        let drive = drive(variant);
        classes(&drive.spec).iter().any(|class| class.part == part)
    };
    assert!(!has("pdcc:hall_capture=sampled", Part::EdgeTimer));
    assert!(has("pdcc", Part::EdgeTimer));
    let names = |of: &Prepared| -> Vec<String> {
        let all = classes(&of.spec).into_iter();
        all.map(|class| class.name).collect()
    };
    let mut names = names(&drive("pdcc"));
    let count = names.len();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), count, "a name stands for one class");
}

#[test]
fn a_free_shaft_is_refused() {
    let drive = drive("pdcc");
    let options = PlantOptions {
        inertia: Some(1e-3),
        ..PlantOptions::default()
    };
    let error = study(&drive, Model::Fixed, &options, 1.0, &()).expect_err("is free");
    assert!(error.to_string().contains("inertia"), "{error}");
}
