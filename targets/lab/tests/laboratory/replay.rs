//! A run on the simulated plant, logged and replayed: the commands are the same, and the words are those of the run.

use hexagen::Command;
use hexagen_lab::engine::{PlantOptions, Prepared, SelectedMotor, plant_of};
use hexagen_lab::plant::Plant;
use hexagen_lab::replay::{columns, replay, replay_csv};
use hexagen_reference::AnyCommand;
use hexagen_reference::verify::Subject;
use std::f64::consts::TAU;
use std::fmt::Write;

const PERIODS: usize = 600;

fn drive(motor: &str, board: Option<&str>, variant: &str) -> Prepared {
    let options = PlantOptions {
        board: board.map(str::to_owned),
        ..PlantOptions::default()
    };
    SelectedMotor::find(motor, &options)
        .and_then(|motor| motor.prepare(Some(variant)))
        .expect("generates")
}

/// The log of a run at half of rated speed with a step of the set-point, and its commands.
fn logged(drive: &Prepared) -> (String, Vec<AnyCommand>) {
    let omega_m = 0.5 * drive.spec.motor.rated_speed;
    let mut plant = Plant::new(plant_of(&drive.spec), 0.117, omega_m).expect("a plant");
    let mut engine = drive.interpreted();
    let sensed = drive.spec.inverter.sensed_phases.phases();
    let has_timer = drive.generated.interface.timer_capture;
    let third = if sensed.len() == 3 { "adc_3," } else { "" };
    let ticks = if has_timer { "ticks," } else { "" };
    let has_angle = drive.spec.angle_sensor().is_some();
    let rotor = if has_angle { "angle" } else { "hall" };
    let mut log = format!("adc_1,adc_2,{third}{rotor},{ticks}current_a\n");
    let mut pending = AnyCommand::default();
    let mut commands = Vec::new();
    for period in 0..PERIODS {
        let sample = plant.sample(pending);
        for phase in sensed {
            let _ = write!(log, "{},", sample.adc()[*phase]);
        }
        let _ = if has_angle {
            write!(log, "{},", sample.angle())
        } else {
            write!(log, "{},", sample.hall())
        };
        if has_timer {
            let _ = write!(log, "{},", sample.ticks());
        }
        if period == 100 {
            let current = (drive.spec.motor.rated_current * 0.7 * 16.0).round() / 16.0;
            engine.set_current((current * 65_536.0) as i32);
            let _ = write!(log, "{current}");
        }
        log.push('\n');
        let command = engine.step(&sample);
        commands.push(command);
        plant.run_period(std::mem::replace(&mut pending, command), &mut ());
    }
    (log, commands)
}

/// The columns of a replayed log by name, and its rows as CSV has them.
fn rows(drive: &Prepared, log: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let mut out = Vec::new();
    let replayed = replay_csv(drive, log.as_bytes(), &mut out).expect("replays");
    assert_eq!((replayed.periods, replayed.fault), (PERIODS, None));
    let mut reader = csv::Reader::from_reader(out.as_slice());
    let rows = reader.deserialize::<Vec<String>>();
    let rows = rows.map(|row| row.expect("a row")).collect();
    (columns(drive), rows)
}

#[test]
fn a_replayed_log_has_the_commands_and_words_of_the_run() {
    for (motor, board, variant) in [
        ("trivedi-keshri-660w", None, "pdcc"),
        ("trivedi-keshri-660w", None, "phcc"),
        ("hoverboard-hub", None, "pi-pwm"),
        ("anaheim-bly172s", Some("st-b-g431b-esc1"), "pdcc"),
        // An encoder, and current sensors in phases b and c.
        ("odrive-d6374-150kv", None, "pdcc"),
    ] {
        let drive = drive(motor, board, variant);
        let (log, commands) = logged(&drive);
        let (names, rows) = rows(&drive, &log);
        let column = |name: &str| {
            let place = names.iter().position(|own| own == name);
            place.unwrap_or_else(|| panic!("{name} in {names:?}"))
        };
        let top = f64::from(drive.spec.inverter.timer_period);
        for (row, command) in rows.iter().zip(&commands) {
            for (name, on) in ["duty_a", "duty_b", "duty_c"].into_iter().zip(command.on()) {
                let duty = row[column(name)].parse::<f64>().ok();
                let on = on.map(|on| f64::from(on) / top);
                assert!(
                    match (duty, on) {
                        (Some(duty), Some(on)) => (duty - on).abs() < 1e-6,
                        (None, None) => true,
                        _ => false,
                    },
                    "{motor} {variant}: {duty:?} {on:?}"
                );
            }
        }
        // The rotor is tracked while a start waits for its angle.
        let has_angle = drive.spec.angle_sensor().is_some();
        let rotor = if has_angle { "angle" } else { "hall" };
        let word = rows[1][column(rotor)].parse::<i32>();
        assert!(word.is_ok(), "{motor}");
        let last = &rows[PERIODS - 1];
        assert_eq!(last[column("mode")], "Run", "{motor}");
        let word: f64 = last[column("i_a")].parse().expect("a word");
        let ampere: f64 = last[column("i_a_ampere")].parse().expect("a current");
        let scale = drive.spec.motor.rated_current;
        assert!(ampere.abs() < 2.0 * scale && (word == 0.0) == (ampere == 0.0));
        if variant == "phcc" {
            // It measures no speed.
            assert!(!names.iter().any(|name| name == "speed_rpm"));
            continue;
        }
        let speed: f64 = last[column("speed_rpm")].parse().expect("a speed");
        let turned = 0.5 * drive.spec.motor.rated_speed * 60.0 / TAU;
        assert!((speed / turned - 1.0).abs() < 0.03, "{motor}: {speed} rpm");
    }
}

#[test]
fn rows_that_end_with_a_carriage_return_count() {
    let drive = drive("trivedi-keshri-660w", None, "pdcc");
    let log = "adc_1,adc_2,hall,ticks\r2048,2048,1,5\r\n2048,2048,1,6\r2048,2048,1,7\n";
    let replayed = replay(&drive, log.as_bytes(), |_| Ok(())).expect("replays");
    assert_eq!(replayed.periods, 3);
}

#[test]
fn a_log_that_does_not_fit_is_told_with_its_line() {
    let drive = drive("trivedi-keshri-660w", None, "pdcc");
    for (log, told) in [
        (
            "adc_1,adc_2,hall\n2048,2048,1\n",
            "line 2: `ticks` is missing",
        ),
        (
            "adc_1,adc_2,hall,ticks\n2048,2048,1,5\n4096,2048,1,5\n",
            "line 3: `adc_1`: 4096 is above 4095",
        ),
        (
            "adc_1,adc_2,hall,ticks\n2048,2048,8,5\n",
            "line 2: `hall`: 8",
        ),
        (
            "adc_1,adc_2,adc_3,hall,ticks\n2048,2048,2048,1,5\n",
            "line 2: `adc_3`: the drive has two",
        ),
        (
            "adc_1,adc_2,hall,ticks,call\n2048,2048,1,5,go\n",
            "line 2: `call`: go is none of",
        ),
        ("adc_1,adc_2,hall,ticks,amps\n2048,2048,1,5,1\n", "amps"),
        (
            "adc_1,adc_2,hall,ticks\n2048,x,1,5\n",
            "line 2: `adc_2`: `x` is no whole number",
        ),
        (
            "adc_1,adc_2,hall,ticks,current_a\n2048,2048,1,5,NaN\n",
            "line 2: `current_a`: NaN is outside",
        ),
        (
            "adc_1,adc_2,hall,ticks,torque_nm\n2048,2048,1,5,1e30\n",
            "line 2: `torque_nm`: 1000000000000000000000000000000 is outside",
        ),
        (
            "adc_1,adc_2,hall,ticks,speed_rpm\n2048,2048,1,5,100\n",
            "line 2: `speed_rpm`: the drive has no speed loop",
        ),
        (
            "adc_1,adc_2,hall,ticks,bus\n2048,2048,1,5,100\n",
            "line 2: `bus`: the drive measures no bus",
        ),
        ("adc_1,adc_2,hall,ticks\n", "no periods"),
    ] {
        let error = replay(&drive, log.as_bytes(), |_| Ok(())).expect_err(log);
        assert!(error.to_string().contains(told), "{error}");
    }
}
