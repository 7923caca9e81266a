//! A log of what a drive was given, replayed: a step is a function of its words, bit for bit, so the log
//! shows every word of a drive that ran elsewhere.

use crate::Interpreted;
use crate::engine::Prepared;
use crate::log::{Call, LogError, LogRow, rows};
use hexagen::{Command, Sample};
use hexagen_codegen::interface::Unit;
use hexagen_codegen::ir::{Phase, Told, Value};
use hexagen_codegen::spec::RotorSensing;
use hexagen_reference::AnyCommand;
use hexagen_reference::Stop;
use hexagen_reference::verify::Subject;
use serde::Serialize;
use std::io::{Read, Write};

/// Bits of a set-point's fraction.
const FRACTION: f64 = 65_536.0;

/// Columns of the drive's state.
const STATE: [&str; 4] = ["period", "time_s", "mode", "fault"];

const DUTIES: [&str; 3] = ["duty_a", "duty_b", "duty_c"];

/// A log that was replayed, and what became of the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Replayed {
    /// Periods.
    pub periods: usize,
    /// The duties and the signals in SI units.
    pub quantities: Vec<Quantity>,
    /// The first period with a fault, from 0, and its fault.
    pub fault: Option<(usize, hexagen::Fault)>,
}

/// A quantity over a log; none of its values where it never exists.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Name of its column.
    pub name: &'static str,
    /// Periods in which it exists.
    pub periods: usize,
    /// Least value.
    pub least: Option<f64>,
    /// Greatest value.
    pub greatest: Option<f64>,
    /// Last value.
    pub last: Option<f64>,
}

impl Quantity {
    const fn new(name: &'static str) -> Self {
        Self {
            name,
            periods: 0,
            least: None,
            greatest: None,
            last: None,
        }
    }

    fn take(&mut self, value: f64) {
        self.periods += 1;
        self.least = Some(self.least.map_or(value, |least| least.min(value)));
        self.greatest = Some(self.greatest.map_or(value, |most| most.max(value)));
        self.last = Some(value);
    }
}

/// What a period has in a column.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cell {
    /// No value: the duty of a leg that is off, or a word that is computed in controlled periods alone.
    Absent,
    /// A word, or the number of the period.
    Word(i64),
    /// A quantity.
    Number(f64),
    /// A mode or a fault.
    Name(String),
}

impl Cell {
    /// A quantity with so many decimals.
    fn rounded(value: f64, decimals: i32) -> Self {
        let steps = 10_f64.powi(decimals);
        Self::Number((value * steps).round() / steps)
    }
}

/// Names of the columns: state, duties, signals in SI units, every word of the step.
#[must_use]
pub fn columns(drive: &Prepared) -> Vec<String> {
    View::of(drive).columns()
}

/// Replays a log from the drive's initial state; `take` receives the periods, with a cell per column.
///
/// # Errors
/// A row that the drive cannot take, by its line; an error of `take`.
pub fn replay(
    drive: &Prepared,
    log: impl Read,
    mut take: impl FnMut(Vec<Cell>) -> csv::Result<()>,
) -> Result<Replayed, LogError> {
    let view = View::of(drive);
    let mut subject = drive.interpreted();
    let mut replayed = Replayed {
        periods: 0,
        quantities: view.quantities(),
        fault: None,
    };
    for (period, row) in rows(log)?.enumerate() {
        let (row, line) = row?;
        let sample = sample(drive, &row).map_err(|what| line.error(&what))?;
        give(drive, &mut subject, &row).map_err(|what| line.error(&what))?;
        let command = subject.step(&sample);
        let row = view.row(period, &subject, command);
        for (quantity, cell) in replayed.quantities.iter_mut().zip(&row[STATE.len()..]) {
            if let Cell::Number(value) = cell {
                quantity.take(*value);
            }
        }
        take(row)?;
        let fault = subject.fault().map(|fault| (period, fault));
        replayed.fault = replayed.fault.or(fault);
        replayed.periods += 1;
    }
    if replayed.periods == 0 {
        return Err(LogError::empty());
    }
    Ok(replayed)
}

/// As [`replay`], with a row of CSV per period.
///
/// # Errors
/// A row that the drive cannot take, by its line; a writer's error.
pub fn replay_csv(drive: &Prepared, log: impl Read, out: impl Write) -> Result<Replayed, LogError> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(columns(drive))?;
    let replayed = replay(drive, log, |row| writer.serialize(row))?;
    writer.flush().map_err(csv::Error::from)?;
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

    fn columns(&self) -> Vec<String> {
        let signals = self.signals.iter().map(|(name, ..)| *name);
        let words = self.words.iter().map(|(name, _)| *name);
        let all = STATE.into_iter().chain(DUTIES).chain(signals).chain(words);
        all.map(str::to_owned).collect()
    }

    /// The quantities, whose columns follow those of the state.
    fn quantities(&self) -> Vec<Quantity> {
        let signals = self.signals.iter().map(|(name, ..)| *name);
        DUTIES
            .into_iter()
            .chain(signals)
            .map(Quantity::new)
            .collect()
    }

    fn row(&self, period: usize, drive: &Interpreted<'_>, command: AnyCommand) -> Vec<Cell> {
        let status = drive.supervisor().status();
        let mut row = vec![
            Cell::Word(period as i64),
            Cell::rounded(period as f64 * self.t_s, 9),
            Cell::Name(format!("{:?}", status.mode)),
            status
                .fault
                .map_or(Cell::Absent, |fault| Cell::Name(format!("{fault:?}"))),
        ];
        row.extend(command.on().map(|on| {
            on.map_or(Cell::Absent, |on| {
                Cell::rounded(f64::from(on) / self.timer_period, 6)
            })
        }));
        // Without control the law tracks the rotor alone, and other words are absent.
        row.extend(self.signals.iter().map(|(_, value, unit)| {
            drive.word(*value).map_or(Cell::Absent, |word| {
                let of_one = f64::from(unit.factor) / f64::from(unit.shift).exp2() / FRACTION;
                Cell::rounded(of_one * word as f64, 6)
            })
        }));
        row.extend(
            self.words
                .iter()
                .map(|(_, value)| drive.word(*value).map_or(Cell::Absent, Cell::Word)),
        );
        row
    }
}
