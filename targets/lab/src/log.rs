//! A log of what a program passed to its drive: one row of CSV for each control period.

use hexagen_codegen::spec::InverterSpec;
use serde::Deserialize;
use std::io::{Cursor, Read};

/// One period of a log, a row of CSV: what the program passed to the drive. An empty set-point leaves the
/// last one.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogRow {
    /// ADC count of the first sensed phase.
    pub adc_1: u16,
    /// Of the second.
    pub adc_2: u16,
    /// Of the third, with `sensed_phases: abc` only.
    pub adc_3: Option<u16>,
    /// Hall code, Ha in bit 2, with Hall sensors.
    pub hall: Option<u8>,
    /// Angle of the sensor, 2^32 a turn, with `rotor: angle`.
    pub angle: Option<u32>,
    /// Ticks since the last edge, with an edge timer only.
    pub ticks: Option<u16>,
    /// Current set-point, ampere.
    pub current_a: Option<f64>,
    /// Torque set-point, newton metres.
    pub torque_nm: Option<f64>,
    /// Speed set-point, rpm.
    pub speed_rpm: Option<f64>,
    /// ADC count of the bus voltage.
    pub bus: Option<u16>,
    /// A call before the step: `calibrate`, `precharge`, `reset`, `coast`, `brake` or `resume`.
    pub call: Option<String>,
}

/// What is wrong with a log, with its line; or why a result cannot be written.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{0}")]
pub struct LogError(pub(crate) String);

impl LogError {
    /// A log without periods.
    pub(crate) fn empty() -> Self {
        Self("no periods; give a header and a row per period".to_owned())
    }
}

impl From<csv::Error> for LogError {
    fn from(error: csv::Error) -> Self {
        Self(error.to_string())
    }
}

/// A call before a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Call {
    Calibrate,
    Precharge,
    Reset,
    Coast,
    Brake,
    Resume,
}

impl Call {
    const WORDS: [(&str, Self); 6] = [
        ("calibrate", Self::Calibrate),
        ("precharge", Self::Precharge),
        ("reset", Self::Reset),
        ("coast", Self::Coast),
        ("brake", Self::Brake),
        ("resume", Self::Resume),
    ];
}

/// A line of a log, from 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line(u64);

impl Line {
    /// What is wrong in the line.
    pub(crate) fn error(self, what: &str) -> LogError {
        LogError(format!("line {}: {what}", self.0))
    }
}

/// The rows of a log, each with its line.
pub(crate) fn rows(
    mut log: impl Read,
) -> Result<impl Iterator<Item = Result<(LogRow, Line), LogError>>, LogError> {
    let mut text = String::new();
    log.read_to_string(&mut text)
        .map_err(|error| LogError(error.to_string()))?;
    // A blank line is no record.
    let numbers: Vec<u64> = (text.lines().zip(1..))
        .filter(|(line, _)| !line.is_empty())
        .map(|(_, number)| number)
        .collect();
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(Cursor::new(text));
    let columns = reader.headers()?.clone();
    let records = reader.into_records().enumerate();
    Ok(records.map(move |(place, record)| {
        let record = record?;
        // A lone carriage return ends a record, but no line.
        let number = numbers.get(place + 1).copied();
        let line = Line(number.unwrap_or_else(|| record.position().map_or(0, csv::Position::line)));
        let row = record.deserialize(Some(&columns));
        let row = row.map_err(|error| line.error(&cell(&error, &columns, &record)))?;
        Ok((row, line))
    }))
}

/// What is wrong with a cell, by its column.
fn cell(error: &csv::Error, columns: &csv::StringRecord, record: &csv::StringRecord) -> String {
    let csv::ErrorKind::Deserialize { err, .. } = error.kind() else {
        return error.to_string();
    };
    let place = err.field().and_then(|place| usize::try_from(place).ok());
    let named = place.and_then(|place| Some((columns.get(place)?, record.get(place)?)));
    match named {
        Some((column, given)) => format!(
            "`{column}`: `{given}` is no {}",
            if ["current_a", "torque_nm", "speed_rpm"].contains(&column) {
                "number"
            } else {
                "whole number from 0 to 65535"
            }
        ),
        None => err.kind().to_string(),
    }
}

impl LogRow {
    /// What was called.
    pub(crate) fn call(&self) -> Result<Option<Call>, String> {
        let word = self.call.as_deref().unwrap_or_default();
        let known = Call::WORDS.iter().find(|(own, _)| *own == word);
        match known {
            Some((_, call)) => Ok(Some(*call)),
            None if word.is_empty() => Ok(None),
            None => Err(format!(
                "`call`: {word} is none of {}",
                Call::WORDS.map(|(own, _)| own).join(", ")
            )),
        }
    }

    /// Counts in the order of the sensed phases.
    pub(crate) fn counts(&self) -> impl Iterator<Item = u16> + use<> {
        [self.adc_1, self.adc_2].into_iter().chain(self.adc_3)
    }

    /// Checks counts and Hall code against the sensors.
    pub(crate) fn check(&self, inverter: &InverterSpec) -> Result<(), String> {
        let most = inverter.adc_max();
        for (count, name) in self.counts().zip(["adc_1", "adc_2", "adc_3"]) {
            if u32::from(count) > most {
                return Err(format!(
                    "`{name}`: {count} is above {most}, the largest count of {} bits",
                    inverter.adc_bits
                ));
            }
        }
        if let Some(hall) = self.hall
            && hall > 7
        {
            return Err(format!(
                "`hall`: {hall} is no code of three sensors; give 0 to 7"
            ));
        }
        self.call()?;
        match (inverter.sensed_phases.phases().len(), self.adc_3) {
            (3, None) => Err("`adc_3` is missing: the drive has three current sensors".to_owned()),
            (2, Some(_)) => {
                Err("`adc_3`: the drive has two current sensors; leave it out".to_owned())
            }
            _ => Ok(()),
        }
    }
}
