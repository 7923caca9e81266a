//! Every claim with figures as the paper claims them, and with contrary ones.

use super::*;
use crate::reproduction::experiment::{Figures, Setting};
use crate::reproduction::judge::Verdict;

const SETTING: Setting = Setting {
    torque: 3.3,
    current: 20.0,
    speeds_rpm: [400.0, 1500.0],
    period_cycles: 3600.0,
};

fn at(mean: f64, [h6, h12]: [f64; 2], [i5, i7]: [f64; 2], hexagon: f64, hz: f64) -> AtSpeed {
    AtSpeed {
        mean_torque_nm: Some(mean),
        h6_pct: Some(h6),
        h12_pct: Some(h12),
        i5_pct: Some(i5),
        i7_pct: Some(i7),
        hexagon_rms_a: Some(hexagon),
        switching_hz: Some(hz),
    }
}

fn drive(limit_pct: f64, cycles: u32, low: AtSpeed, high: AtSpeed) -> Figures {
    Figures {
        limit_pct,
        speeds: [low, high],
        cycles,
        usual_cycles: Some(cycles / 2),
    }
}

/// As the paper claims.
fn claimed() -> Experiment {
    let ideal = [20.0, 14.3];
    Experiment {
        setting: SETTING,
        methods: [
            drive(
                85.0,
                800,
                at(3.0, [9.0, 8.0], [18.0, 12.0], 3.0, 20e3),
                at(3.0, [1.0, 1.0], [17.0, 11.0], 3.0, 20e3),
            ),
            drive(
                87.0,
                1200,
                at(3.3, [1.0, 1.0], ideal, 0.2, 18e3),
                at(3.3, [4.0, 3.0], [20.2, 14.4], 0.3, 18e3),
            ),
            drive(
                84.0,
                700,
                at(3.3, [2.0, 2.0], ideal, 2.0, 20e3),
                at(3.25, [4.2, 3.1], [20.9, 13.9], 2.0, 20e3),
            ),
            drive(
                67.0,
                600,
                at(3.3, [5.0, 4.0], ideal, 0.5, 20e3),
                at(2.9, [12.0, 9.0], [27.0, 16.0], 4.0, 20e3),
            ),
        ],
    }
}

/// Contrary to every statement.
fn contrary() -> Experiment {
    Experiment {
        setting: SETTING,
        methods: [
            drive(
                40.0,
                3700,
                at(3.3, [1.0, 1.0], [21.0, 15.0], 0.5, 2e3),
                at(3.3, [12.0, 9.0], [22.0, 15.0], 0.5, 2e3),
            ),
            drive(
                60.0,
                300,
                at(3.3, [9.0, 9.0], [23.0, 14.0], 5.0, 20e3),
                at(3.3, [9.0, 3.0], [25.0, 12.0], 5.0, 20e3),
            ),
            drive(
                101.0,
                700,
                at(3.3, [8.0, 8.0], [20.0, 14.0], 0.9, 2e3),
                at(3.3, [3.0, 6.0], [20.0, 14.0], 0.9, 2e3),
            ),
            drive(
                93.0,
                600,
                at(3.3, [2.0, 2.0], [20.0, 14.0], 1.5, 20e3),
                at(3.3, [1.0, 1.0], [20.0, 14.0], 0.4, 20e3),
            ),
        ],
    }
}

fn verdicts(readings: &[Experiment; 2]) -> Vec<(char, Verdict)> {
    let claims = claims(*readings);
    let verdicts = claims.iter().map(|claim| (claim.letter, claim.verdict()));
    verdicts.collect()
}

#[test]
fn every_claim_holds_with_figures_as_claimed() {
    for claim in claims([claimed(), claimed()]) {
        assert_eq!(claim.verdict(), Verdict::Holds, "{claim:#?}");
        assert!(!claim.reason().contains("False"), "{}", claim.reason());
    }
    assert_eq!(claims([claimed(), claimed()]).len(), 8);
}

#[test]
fn no_claim_holds_with_contrary_figures() {
    for claim in claims([contrary(), contrary()]) {
        assert_eq!(claim.verdict(), Verdict::DoesNotHold, "{claim:#?}");
        for statement in &claim.statements {
            assert!(claim.reason().contains(&statement.text), "{statement:?}");
        }
    }
}

#[test]
fn claims_hold_in_part_if_readings_disagree() {
    for readings in [[claimed(), contrary()], [contrary(), claimed()]] {
        for (letter, verdict) in verdicts(&readings) {
            assert_eq!(verdict, Verdict::InPart, "{letter}");
        }
    }
}

/// All drives without current at both speeds.
fn without_current() -> Experiment {
    let mut lost = claimed();
    for drive in &mut lost.methods {
        for at in &mut drive.speeds {
            at.mean_torque_nm = None;
            at.h6_pct = None;
        }
    }
    lost
}

#[test]
fn with_lost_currents_only_computation_times_are_judged() {
    for (letter, verdict) in verdicts(&[without_current(), without_current()]) {
        let expected = match letter {
            'f' => Verdict::Holds,
            _ => Verdict::CannotBeJudged,
        };
        assert_eq!(verdict, expected, "{letter}");
    }
    // The other reading can be judged.
    for (letter, verdict) in verdicts(&[without_current(), claimed()]) {
        assert_eq!(verdict, Verdict::Holds, "{letter}");
    }
}

#[test]
fn a_tripped_drive_is_told_as_such() {
    let mut readings = [without_current(), without_current()];
    readings[0].methods[Phcc.index()].usual_cycles = None;
    let claims = claims(readings);
    let [tripped, lost] = &claims[0].figures;
    assert_eq!(tripped, "\u{2013} / \u{2013} / tripped / \u{2013} %");
    assert_eq!(lost, "\u{2013} / \u{2013} / \u{2013} / \u{2013} %");
}

#[test]
fn one_lost_drive_leaves_only_its_statements_open() {
    let mut readings = claimed();
    readings.methods[Phcc.index()].speeds = without_current().methods[0].speeds;
    let claims = claims([readings, readings]);
    let outcome = |letter: char, text: &str| {
        let claim = claims.iter().find(|claim| claim.letter == letter);
        let statements = &claim.expect("there is one").statements;
        let statement = statements.iter().find(|one| one.text == text);
        statement.expect("it has one").findings[0].outcome
    };
    assert_eq!(outcome('a', "PI-PWM to 67 %"), Some(true));
    assert_eq!(outcome('a', "PHCC to about 85 %"), None);
    assert_eq!(outcome('b', "FCS-MPC misses 3.30 Nm"), Some(true));
    // The claim does not name the lost drive.
    assert_eq!(outcome('b', "FCS-MPC more 6th than PI-PWM"), Some(true));
    // The lost drive might have had less.
    assert_eq!(outcome('c', "FCS-MPC least 6th"), None);
    assert_eq!(outcome('c', "PDCC and PHCC equal 6th"), None);
    assert_eq!(
        outcome('d', "PDCC and PHCC keep the ideal spectrum at 1500 rpm"),
        None
    );
    assert_eq!(outcome('g', "alike at 400 rpm"), None);
    // Another drive refutes it, whatever the lost one would have done.
    let mut refuted = readings;
    refuted.methods[PiPwm.index()].speeds[LOW].h6_pct = Some(10.0);
    refuted.methods[PiPwm.index()].speeds[LOW].switching_hz = Some(2e3);
    refuted.methods[Pdcc.index()].speeds[HIGH].i5_pct = Some(25.0);
    let claims = super::claims([refuted, refuted]);
    let outcome = |claim: usize, statement: usize| {
        let finding = &claims[claim].statements[statement].findings[0];
        (finding.outcome, finding.why.clone())
    };
    assert_eq!(
        outcome(1, 1),
        (Some(false), "FCS-MPC 9.00; PI-PWM 10.0 %".to_owned())
    );
    assert_eq!(outcome(6, 0), (Some(false), "2.0 to 20.0 kHz".to_owned()));
    assert_eq!(outcome(3, 3).0, Some(false));
}

#[test]
fn statements_change_at_their_tolerances() {
    let judged = |change: &dyn Fn(&mut Experiment), claim: usize, statement: usize| {
        let mut readings = claimed();
        change(&mut readings);
        claims([readings, readings])[claim].statements[statement].findings[0].outcome
    };
    let limit =
        |percent: f64| move |x: &mut Experiment| x.methods[PiPwm.index()].limit_pct = percent;
    assert_eq!(judged(&limit(62.0), 0, 0), Some(true));
    assert_eq!(judged(&limit(61.9), 0, 0), Some(false));
    assert_eq!(judged(&limit(72.1), 0, 0), Some(false));
    let mean = |torque: f64| {
        move |x: &mut Experiment| {
            x.methods[FcsMpc.index()].speeds[LOW].mean_torque_nm = Some(torque);
        }
    };
    assert_eq!(judged(&mean(0.96 * 3.3), 1, 0), Some(true));
    assert_eq!(judged(&mean(0.98 * 3.3), 1, 0), Some(false));
    let i5 = |percent: f64| {
        move |x: &mut Experiment| x.methods[PiPwm.index()].speeds[LOW].i5_pct = Some(percent)
    };
    assert_eq!(judged(&i5(21.4), 3, 2), Some(true));
    assert_eq!(judged(&i5(21.6), 3, 2), Some(false));
    let off = |amperes: f64| {
        move |x: &mut Experiment| x.methods[PiPwm.index()].speeds[LOW].hexagon_rms_a = Some(amperes)
    };
    assert_eq!(judged(&off(0.99), 4, 2), Some(true));
    assert_eq!(judged(&off(1.01), 4, 2), Some(false));
    let khz = |hz: f64| {
        move |x: &mut Experiment| x.methods[Pdcc.index()].speeds[LOW].switching_hz = Some(hz)
    };
    assert_eq!(judged(&khz(16.1e3), 6, 0), Some(true));
    assert_eq!(judged(&khz(15.9e3), 6, 0), Some(false));
    assert_eq!(judged(&khz(20.1e3), 7, 0), Some(false));
    let busy = |x: &mut Experiment| x.methods[Pdcc.index()].cycles = 3601;
    assert_eq!(judged(&busy, 5, 2), Some(false));
}
