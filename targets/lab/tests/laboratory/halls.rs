//! A shorted motor turned by hand: the log tells the Hall sensors' codes and places, whatever the stated ones are.

use hexagen::Legs;
use hexagen_lab::engine::{PlantOptions, Prepared, SelectedMotor, plant_of};
use hexagen_lab::halls::{Halls, find};
use hexagen_lab::log::LogError;
use hexagen_lab::plant::{Plant, PlantParams};
use std::f64::consts::TAU;
use std::fmt::Write;

/// Codes of sensors in another order, and of some 60 degrees apart.
const ORDERS: [[u8; 6]; 3] = [[1, 5, 4, 6, 2, 3], [6, 2, 3, 1, 5, 4], [0, 1, 3, 7, 6, 4]];

/// Edges in degrees that the true sensors have.
const EDGES: [f64; 6] = [-37.0, 26.0, 90.5, 146.0, 214.0, 269.0];

/// How a hand turns the shaft: electrical turns of each stroke, the sign is the direction.
const STROKES: [f64; 4] = [3.2, -1.3, 2.4, 0.0];

fn drive(motor: &str) -> Prepared {
    SelectedMotor::find(motor, &PlantOptions::default())
        .and_then(|motor| motor.prepare(None))
        .expect("generates")
}

/// A log of the shorted plant turned by hand. The current peaks at this share of the sensors' range.
fn turned(drive: &Prepared, plant: PlantParams, share: f64, strokes: &[f64]) -> String {
    let (spec, t_s) = (&drive.spec, drive.spec.inverter.t_s);
    let range = spec.inverter.adc_gain.abs() * f64::from(spec.inverter.adc_max()) / 2.0;
    let poles = f64::from(spec.motor.pole_pairs);
    let most = share * range * spec.motor.resistance / spec.motor.emf_constant;
    let sensed = spec.inverter.sensed_phases.phases();
    let mut log = String::from(if sensed.len() == 3 {
        "adc_1,adc_2,adc_3,hall,call\n"
    } else {
        "adc_1,adc_2,hall,call\n"
    });
    let mut plant = Plant::new(plant, 1.0, 0.0).expect("a plant");
    let mut call = "brake";
    for stroke in strokes {
        // From rest to rest, a sine's arch; a stroke of nothing is a pause.
        let turn = stroke * TAU / poles;
        let time = (1.57 * turn.abs() / most).max(0.05);
        let periods = (time / t_s).ceil() as usize;
        for period in 0..periods {
            let arch = (0.5 * TAU * period as f64 / periods as f64).sin();
            plant.set_speed(0.25 * TAU * turn / (periods as f64 * t_s) * arch);
            let sample = plant.sample(Legs::LOW);
            for phase in sensed {
                let _ = write!(log, "{},", sample.adc()[*phase]);
            }
            let _ = writeln!(log, "{},{}", sample.hall(), std::mem::take(&mut call));
            plant.run_period(Legs::LOW, &mut ());
        }
    }
    log
}

fn found(drive: &Prepared, log: &str) -> Result<Halls, LogError> {
    find(drive, log.as_bytes(), drive.spec.inverter.t_s)
}

/// A motor whose sensors, offsets and data are not the stated ones.
fn disturbed(drive: &Prepared, codes: [u8; 6]) -> PlantParams {
    let mut plant = plant_of(&drive.spec).scaled(1.3, 0.8, 1.1);
    plant.hall_codes = codes;
    plant.hall_edges_deg = EDGES;
    let shift = f64::from(drive.spec.inverter.adc_max()) / 100.0;
    for (channel, share) in plant.adc.iter_mut().zip([1.0, -0.6, 0.4]) {
        channel.offset += share * shift;
        channel.noise = 1.0;
    }
    plant
}

#[test]
fn every_motor_of_the_library_tells_its_codes_and_edges() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("reads");
    let have_halls = motors.iter().filter(|motor| !motor.has_angle());
    let motors: Vec<&SelectedMotor> = have_halls.collect();
    assert_eq!(motors.len(), 12);
    for (motor, codes) in motors.into_iter().zip(ORDERS.into_iter().cycle()) {
        let drive = motor.prepare(None).expect("generates");
        let name = &drive.motor;
        let log = turned(&drive, disturbed(&drive, codes), 0.15, &STROKES);
        let halls = found(&drive, &log).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(halls.codes, codes, "{name}");
        for (edge, truth) in halls.edges.iter().zip(EDGES) {
            let error = edge.angle - truth;
            assert!(error.abs() < 1.5, "{name}: {edge:?} at {truth}");
            assert!(
                edge.passes >= 5 && edge.hysteresis.is_some(),
                "{name}: {edge:?}"
            );
        }
        let [forward, backward] = halls.turns;
        assert!(
            (forward - 5.6).abs() < 0.1 && (backward - 1.3).abs() < 0.1,
            "{name}: {:?}",
            halls.turns
        );
        // The EMF by the stated resistance, which is 1.3 times too small.
        let ratio = halls.emf_constant / drive.spec.motor.emf_constant * 1.3 / 1.1;
        assert!((ratio - 1.0).abs() < 0.04, "{name}: {ratio}");
    }
}

#[test]
fn sound_sensors_are_found_in_their_places_and_in_either_direction() {
    let drive = drive("trivedi-keshri-660w");
    for strokes in [[2.5, 0.3, 0.0], [-2.5, -0.4, 0.0]] {
        let log = turned(&drive, plant_of(&drive.spec), 0.1, &strokes);
        let halls = found(&drive, &log).expect("tells");
        assert_eq!(halls.codes, drive.spec.motor.hall_codes);
        let [forward, backward] = halls.turns;
        assert_eq!(backward > forward, strokes[0] < 0.0);
        assert_eq!(halls.begins_forward, strokes[0] > 0.0);
        assert!(halls.roundness > 0.98, "{}", halls.roundness);
        for (edge, place) in halls.edges.iter().zip(drive.spec.motor.hall_angles) {
            assert!((edge.angle - place).abs() < 0.5, "{edge:?} at {place}");
            assert!(edge.hysteresis.is_none() && edge.spread < 0.5, "{edge:?}");
        }
    }
}

#[test]
fn only_the_rows_between_a_brake_and_the_next_call_count() {
    let drive = drive("hoverboard-hub");
    let log = turned(&drive, plant_of(&drive.spec), 0.1, &STROKES);
    let whole = found(&drive, &log).expect("tells");
    // A calibration before, and another state behind: rows of no use.
    let calibrated = log.replacen(
        '\n',
        &format!(
            "\n{}",
            "2048,2048,1,calibrate\n".to_owned() + &"2048,2048,1,\n".repeat(300)
        ),
        1,
    );
    let longer = calibrated + "2048,2048,1,coast\n" + &"4000,4000,7,\n".repeat(300);
    let cut = found(&drive, &longer).expect("tells");
    assert_eq!(format!("{whole:?}"), format!("{cut:?}"));
    let never = log.replacen("brake", "coast", 1);
    let told = found(&drive, &never)
        .expect_err("is not shorted")
        .to_string();
    assert!(told.contains("no `brake` among the calls"), "{told}");
    // A program may call it in each period.
    let every = log.lines().fold(String::new(), |log, line| {
        if line.ends_with(',') {
            log + line + "brake\n"
        } else {
            log + line + "\n"
        }
    });
    let in_each = found(&drive, &every).expect("tells");
    assert_eq!(format!("{whole:?}"), format!("{in_each:?}"));
    // A log without that column is of a shorted motor.
    let without: String = log
        .lines()
        .map(|line| line.rsplit_once(',').expect("columns").0.to_owned() + "\n")
        .collect();
    let plain = found(&drive, &without).expect("tells");
    assert_eq!(format!("{whole:?}"), format!("{plain:?}"));
}

#[test]
fn a_log_that_does_not_tell_the_angle_is_refused_with_the_reason() {
    let drive = drive("trivedi-keshri-660w");
    let told = |plant: PlantParams, share: f64, strokes: &[f64]| {
        let log = turned(&drive, plant, share, strokes);
        found(&drive, &log).expect_err("does not tell").to_string()
    };
    let sound = || plant_of(&drive.spec);
    let mut of_wrong_sign = sound();
    of_wrong_sign.adc[1].amperes_per_count *= -1.0;
    let mut open = sound();
    open.wiring.open = [false, false, true];
    let mut dead = sound();
    dead.hall_codes = dead.hall_codes.map(|code| code & 0b101);
    for (text, words) in [
        (
            told(of_wrong_sign, 0.1, &STROKES),
            "wrong sign (`adc_inverted`)",
        ),
        (told(open, 0.1, &STROKES), "a phase is open"),
        (
            told(sound(), 0.004, &STROKES),
            "counts to either side, 20 are needed",
        ),
        (told(sound(), 0.1, &[1.2]), "turn it farther, by at least 2"),
        (told(sound(), 0.1, &[0.3]), "turn it farther"),
        (told(dead, 0.1, &STROKES), "never changing: Hb;"),
        (told(sound(), 0.98, &STROKES), "beyond the trip level"),
    ] {
        assert!(text.contains(words), "{text}\n{words}");
    }
    let empty = found(&drive, "adc_1,adc_2,hall\n")
        .expect_err("is empty")
        .to_string();
    assert!(empty.contains("no periods"), "{empty}");
    let word = found(&drive, "adc_1,adc_2,hall,call\n\n9,x,1,\n")
        .expect_err("is no count")
        .to_string();
    assert!(
        word.contains("line 3: `adc_2`: `x` is no whole number"),
        "{word}"
    );
    let call = found(&drive, "adc_1,adc_2,hall,call\n9,9,1,brak\n")
        .expect_err("is no call")
        .to_string();
    assert!(call.contains("line 2: `call`: brak is none of"), "{call}");
    let code = found(&drive, "adc_1,adc_2,hall\n1,2,9\n")
        .expect_err("is no code")
        .to_string();
    assert!(code.contains("line 2: `hall`: 9"), "{code}");
}

#[test]
fn glitches_are_counted_and_move_no_edge() {
    let drive = drive("anaheim-bly171d");
    let log = turned(&drive, plant_of(&drive.spec), 0.1, &STROKES);
    let sound = found(&drive, &log).expect("tells");
    let disturbed = log
        .lines()
        .enumerate()
        .fold(String::new(), |log, (line, text)| {
            let is_hit = line > 10 && line % 97 == 0;
            match text.rsplitn(3, ',').last().filter(|_| is_hit) {
                Some(counts) => log + counts + ",7,\n",
                None => log + text + "\n",
            }
        });
    let halls = found(&drive, &disturbed).expect("tells");
    assert!(halls.glitches > 100, "{}", halls.glitches);
    assert_eq!((sound.glitches, sound.codes), (0, halls.codes));
    for (edge, other) in halls.edges.iter().zip(&sound.edges) {
        assert!((edge.angle - other.angle).abs() < 0.5, "{edge:?} {other:?}");
    }
}

/// What makes angles doubtful shows in the figures.
#[test]
fn unequal_gains_and_drifting_offsets_show() {
    let drive = drive("trivedi-keshri-660w");
    let mut unequal = plant_of(&drive.spec);
    unequal.adc[0].amperes_per_count *= 1.1;
    let halls = found(&drive, &turned(&drive, unequal, 0.1, &STROKES)).expect("tells");
    assert!(
        (0.85..0.95).contains(&halls.roundness),
        "{}",
        halls.roundness
    );
    // An offset that grows to eight counts.
    let log = turned(&drive, plant_of(&drive.spec), 0.1, &STROKES);
    let rows = log.lines().count();
    let drifting = log
        .lines()
        .enumerate()
        .fold(String::new(), |log, (line, text)| {
            let (count, rest) = text.split_once(',').expect("columns");
            match count.parse::<usize>() {
                Ok(count) => format!("{log}{},{rest}\n", count + 8 * line * line / (rows * rows)),
                Err(_) => format!("{log}{text}\n"),
            }
        });
    let halls = found(&drive, &drifting).expect("tells");
    let spread = halls
        .edges
        .iter()
        .map(|edge| edge.spread)
        .fold(0.0, f64::max);
    assert!(spread > 4.0, "{spread}");
}

#[test]
fn rows_may_lie_several_periods_apart() {
    let drive = drive("trivedi-keshri-660w");
    let log = turned(&drive, plant_of(&drive.spec), 0.1, &STROKES);
    let (head, rows) = log.split_once('\n').expect("a header");
    let kept: Vec<&str> = rows.lines().step_by(10).collect();
    let sparse = format!("{head}\n{}\n", kept.join("\n"));
    let halls = find(&drive, sparse.as_bytes(), 10.0 * drive.spec.inverter.t_s).expect("tells");
    for (edge, place) in halls.edges.iter().zip(drive.spec.motor.hall_angles) {
        assert!((edge.angle - place).abs() < 1.0, "{edge:?} at {place}");
    }
    assert!((halls.emf_constant / drive.spec.motor.emf_constant - 1.0).abs() < 0.03);
}
