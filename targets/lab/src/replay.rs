//! A log of what a drive was given, replayed: a step is a function of its words, bit for bit, so the log
//! shows every word of a drive that ran elsewhere.

use crate::Interpreted;
use crate::engine::Prepared;
use crate::log::{Call, LogError, LogRow, rows};
use hexagen::{Command, Legs, Sample};
use hexagen_codegen::interface::Unit;
use hexagen_codegen::ir::{Phase, Told, Value};
use hexagen_codegen::spec::RotorSensing;
use hexagen_reference::Stop;
use hexagen_reference::verify::Subject;
use std::io::{Read, Write};

/// Bits of a set-point's fraction.
const FRACTION: f64 = 65_536.0;

/// Rows of a log that were replayed, and what became of the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Replayed {
    /// Periods.
    pub periods: usize,
    /// The first period with a fault, from 0, and its fault.
    pub fault: Option<(usize, hexagen::Fault)>,
}

/// Replays a log from the drive's initial state, and writes one row of CSV per period.
///
/// # Errors
/// A row that the drive cannot take, by its line; a writer's error.
pub fn replay(drive: &Prepared, log: impl Read, out: impl Write) -> Result<Replayed, LogError> {
    let mut writer = csv::Writer::from_writer(out);
    let view = View::of(drive);
    writer.write_record(view.header())?;
    let mut subject = drive.interpreted();
    let mut replayed = Replayed {
        periods: 0,
        fault: None,
    };
    for (period, row) in rows(log)?.enumerate() {
        let (row, line) = row?;
        let sample = sample(drive, &row).map_err(|what| line.error(&what))?;
        give(drive, &mut subject, &row).map_err(|what| line.error(&what))?;
        let legs = subject.step(&sample);
        let row = view.row(period, &subject, legs);
        writer.write_record(row)?;
        let fault = subject.fault().map(|fault| (period, fault));
        replayed.fault = replayed.fault.or(fault);
        replayed.periods += 1;
    }
    writer.flush().map_err(csv::Error::from)?;
    if replayed.periods == 0 {
        return Err(LogError::empty());
    }
    Ok(replayed)
}

/// The sample of a row.
fn sample(drive: &Prepared, row: &LogRow) -> Result<Sample, String> {
    let inverter = &drive.spec.inverter;
    row.check(inverter)?;
    // A phase without a sensor has no count.
    let mut adc = [0; 3];
    for (phase, count) in inverter.sensed_phases.phases().iter().zip(row.counts()) {
        adc[*phase] = count;
    }
    let [adc_a, adc_b, adc_c] = adc;
    let adc_ab = [adc_a, adc_b];
    let sample = match (inverter.rotor_sensing, row.hall, row.angle) {
        (RotorSensing::Angle(_), None, Some(angle)) => Sample::with_angle(adc_ab, angle),
        (RotorSensing::Angle(_), ..) => {
            return Err("the drive has an angle sensor: give `angle`, and no `hall`".to_owned());
        }
        (_, Some(hall), None) => Sample::with_hall(adc_ab, hall),
        _ => return Err("the drive has Hall sensors: give `hall`, and no `angle`".to_owned()),
    };
    let sample = sample.third_current(adc_c);
    match (inverter.rotor_sensing, row.ticks) {
        (RotorSensing::TimedHalls { .. }, Some(ticks)) => Ok(sample.hall_ticks(ticks)),
        (RotorSensing::TimedHalls { .. }, None) => {
            Err("`ticks` is missing: the drive has an edge timer".to_owned())
        }
        (_, Some(_)) => Err("`ticks`: the drive has no edge timer; leave it out".to_owned()),
        (_, None) => Ok(sample),
    }
}

/// Set-points and calls of a row.
fn give(drive: &Prepared, subject: &mut Interpreted<'_>, row: &LogRow) -> Result<(), String> {
    if let Some(counts) = row.bus {
        if drive.bus_counts(0.0).is_none() {
            return Err("`bus`: the drive measures no bus; leave it out".to_owned());
        }
        subject.set_bus(counts);
    }
    if let Some(current) = row.current_a {
        subject.set_current(fixed("current_a", current)?);
    }
    if let Some(torque) = row.torque_nm {
        subject.set_torque(fixed("torque_nm", torque)?);
    }
    if let Some(speed) = row.speed_rpm {
        if drive.spec.controller.common().speed.is_none() {
            return Err("`speed_rpm`: the drive has no speed loop; leave it out".to_owned());
        }
        subject.set_speed(fixed("speed_rpm", speed)?);
    }
    match row.call()? {
        None => {}
        Some(Call::Calibrate) => subject.calibrate(),
        Some(Call::Precharge) => subject.precharge(),
        Some(Call::Reset) => subject.reset(),
        Some(Call::Coast) => subject.stop(Stop::Coast),
        Some(Call::Brake) => subject.stop(Stop::Brake),
        Some(Call::Resume) => subject.stop(Stop::Resume),
    }
    Ok(())
}

/// A set-point with 16 bits of fraction.
fn fixed(name: &str, value: f64) -> Result<i32, String> {
    const MOST: f64 = 32_767.0;
    if value.abs() <= MOST {
        Ok((value * FRACTION).round() as i32)
    } else {
        Err(format!("`{name}`: {value} is outside -{MOST} to {MOST}"))
    }
}

/// What is shown of a drive's period.
struct View<'g> {
    t_s: f64,
    timer_period: f64,
    /// Signals in SI units, by name.
    signals: Vec<(&'static str, Value, Unit)>,
    /// Every named word of the step.
    words: Vec<(&'g str, Value)>,
}

impl<'g> View<'g> {
    fn of(drive: &'g Prepared) -> Self {
        let (step, units) = (
            &drive.generated.graph.program().step,
            &drive.generated.interface.units,
        );
        let named = |value: &Value| !step.node(*value).name.is_empty();
        let words: Vec<(&str, Value)> = (step.values().filter(named))
            .map(|value| (step.node(value).name.as_str(), value))
            .collect();
        let word = |name: &str| words.iter().find(|(own, _)| *own == name);
        let currents = [("i_a_ampere", "i_a"), ("i_b_ampere", "i_b")]
            .map(|(name, own)| word(own).map(|(_, value)| (name, *value, units.ampere)));
        let told = [
            ("e_a_volt", Told::Emf(Phase::A), units.volt),
            ("e_b_volt", Told::Emf(Phase::B), units.volt),
            ("speed_rpm", Told::Speed, units.rpm),
        ]
        .map(|(name, told, unit)| step.told(told).map(|value| (name, value, unit)));
        Self {
            t_s: drive.spec.inverter.t_s,
            timer_period: f64::from(drive.spec.inverter.timer_period),
            signals: currents.into_iter().chain(told).flatten().collect(),
            words,
        }
    }

    fn header(&self) -> Vec<&str> {
        let fixed = [
            "period", "time_s", "mode", "fault", "duty_a", "duty_b", "duty_c",
        ];
        let signals = self.signals.iter().map(|(name, ..)| *name);
        let words = self.words.iter().map(|(name, _)| *name);
        fixed.into_iter().chain(signals).chain(words).collect()
    }

    fn row(&self, period: usize, drive: &Interpreted<'_>, legs: Legs) -> Vec<String> {
        let status = drive.supervisor().status();
        let fault = status
            .fault
            .map_or(String::new(), |fault| format!("{fault:?}"));
        let mut row = vec![
            period.to_string(),
            format!("{:.9}", period as f64 * self.t_s),
            format!("{:?}", status.mode),
            fault,
        ];
        // An off leg has no duty.
        row.extend(legs.on().map(|on| {
            on.map_or(String::new(), |on| {
                format!("{:.6}", f64::from(on) / self.timer_period)
            })
        }));
        // Without control the law tracks the rotor alone, and other words are empty.
        row.extend(self.signals.iter().map(|(_, value, unit)| {
            drive.word(*value).map_or(String::new(), |word| {
                let of_one = f64::from(unit.factor) / f64::from(unit.shift).exp2() / FRACTION;
                format!("{:.6}", of_one * word as f64)
            })
        }));
        row.extend(self.words.iter().map(|(_, value)| {
            drive
                .word(*value)
                .map_or(String::new(), |word| word.to_string())
        }));
        row
    }
}
