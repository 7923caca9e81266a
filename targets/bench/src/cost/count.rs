//! Counts a step function on recorded inputs of a closed loop.

use super::cycles::{Executed, executed, executed_addresses};
use super::elf::Image;
use super::longest::Program;
use crate::BenchError;
use crate::firmware::Firmware;
use crate::vectors::{Called, Recorder, Stretch};
use hexagen::{Legs, Sample};
use hexagen_firmware::wire::{Mode, Record, Stop, Task};
use hexagen_lab::engine::Prepared;
use hexagen_lab::plant::Truth;
use std::ops::Range;

/// Steps of a stretch; its second half counts as settled.
const STEPS: usize = 2000;

/// Steps of the stretch that is traced instruction by instruction.
const TRACED: usize = 240;

/// Shares of the rated speed from which the drive brakes: the bus ends the voltage at the higher ones.
const BRAKED: [f64; 4] = [0.9, 1.6, -0.9, -1.6];

/// Seeds of the stimulus of the bit-for-bit test.
const STIMULI: Range<u64> = 9..13;

/// Inputs of a closed loop, with the steps of the normal path marked.
#[derive(Debug)]
pub struct Inputs {
    /// Start from rest, two speeds below the limit, one above it, one backward; rated current.
    records: Vec<u8>,
    /// A short stretch.
    traced: Vec<u8>,
    /// Calibration, pre-charge, coasting, braking, and arbitrary inputs and calls, which trip the drive;
    /// only for drives.
    arbitrary: Option<Vec<u8>>,
}

/// Cost of a step in time and stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Instructions of a settled step below the speed limit: the median.
    pub normal: u32,
    /// The same of a drive with the same supervisor and an empty law, if counted.
    pub supervision: Option<u32>,
    /// Maximum instructions of a step in closed loop.
    pub worst: u32,
    /// Maximum instructions of a step in calibration, pre-charge, coasting and braking, and on arbitrary
    /// inputs; only for drives.
    pub arbitrary: Option<u32>,
    /// Bytes of stack, maximum of all these steps.
    pub stack: u32,
    /// Estimated cycles of a settled step: the median.
    pub cycles: u32,
}

impl Counts {
    /// Instructions of the longest step that was counted.
    pub fn largest(&self) -> u32 {
        self.worst.max(self.normal).max(self.arbitrary.unwrap_or(0))
    }
}

impl Inputs {
    /// Records the inputs of a drive in its own closed loop.
    ///
    /// # Errors
    /// If its plant is invalid.
    pub fn record(drive: &Prepared) -> Result<Self, BenchError> {
        let mut all = Recorder::new(drive, None);
        for stretch in stretches(drive) {
            stretch.close(drive, &mut all)?;
        }
        let mut short = Recorder::new(drive, None);
        traced(drive).close(drive, &mut short)?;
        let mut arbitrary = Recorder::new(drive, None);
        let start = Stretch {
            starts_up: true,
            ..traced(drive)
        };
        start.close(drive, &mut arbitrary)?;
        for speed in BRAKED {
            let stretch = Stretch {
                speed,
                ..traced(drive)
            };
            let stops = Some([Stop::Coast, Stop::Brake]);
            stretch.close_and_stop(drive, &mut arbitrary, stops)?;
        }
        fail_calibration(drive, &mut arbitrary);
        for seed in STIMULI {
            arbitrary.edges(drive, seed)?;
        }
        Ok(Self {
            records: all.finish().records,
            traced: short.finish().records,
            arbitrary: Some(arbitrary.finish().records),
        })
    }

    /// Records the inputs of an interrupt, which makes calls other than steps itself: its drive's
    /// inputs in closed loop.
    ///
    /// # Errors
    /// If its plant is invalid.
    pub fn record_interrupt(drive: &Prepared) -> Result<Self, BenchError> {
        let arbitrary = None;
        Ok(Self {
            arbitrary,
            ..Self::record(drive)?
        })
    }

    /// Records the inputs of a peer in its own closed loop, on the plant of a drive.
    ///
    /// # Errors
    /// If the plant is invalid.
    pub fn record_peer(
        drive: &Prepared,
        mut step: impl FnMut(&Sample) -> Legs,
    ) -> Result<Self, BenchError> {
        let mut run = |stretch: &Stretch| -> Result<Vec<u8>, BenchError> {
            let mut records = vec![];
            let mut noted = |sample: &Sample, _: &Truth| {
                records.extend(Record::Step(*sample).encode());
                step(sample)
            };
            stretch.run(drive, &mut noted)?;
            Ok(records)
        };
        let mut records = vec![];
        for stretch in stretches(drive) {
            records.extend(run(&stretch)?);
        }
        Ok(Self {
            records,
            traced: run(&traced(drive))?,
            arbitrary: None,
        })
    }

    /// The closed loop in the core's format.
    pub fn records(&self) -> &[u8] {
        &self.records
    }

    /// Inputs of the closed loop's steps.
    pub fn samples(&self) -> impl Iterator<Item = Sample> {
        let (records, _) = self.records.as_chunks();
        records
            .iter()
            .filter_map(|&record| match Record::decode(record) {
                Some(Record::Step(sample)) => Some(sample),
                _ => None,
            })
    }
}

/// A calibration whose offsets are out of their range, which trips the drive at its end.
fn fail_calibration(drive: &Prepared, called: &mut impl Called) {
    let inverter = &drive.spec.inverter;
    called.call(Record::New);
    called.call(Record::Calibrate);
    let [a, b, c] = [(inverter.adc_offset + inverter.offset_tolerance + 1) as u16; 3];
    for _ in 0..1_u32 << inverter.calibration_log2 {
        called.step(Sample::with_hall([a, b], 1).third_current(c));
    }
}

/// Twice below the speed limit, above it, and backward; rated current.
fn stretches(drive: &Prepared) -> [Stretch; 4] {
    let share = drive.spec.motor.rated_current / drive.spec.inverter.max_current;
    [0.2, 0.7, 1.25, -0.7].map(|speed| Stretch {
        starts_up: false,
        speed,
        currents: [share; 2],
        steps: STEPS,
    })
}

/// The short stretch.
fn traced(drive: &Prepared) -> Stretch {
    let [_, below, ..] = stretches(drive);
    Stretch {
        steps: TRACED,
        ..below
    }
}

/// Settled steps of the first two stretches.
fn settled<T: Copy>(counts: &[T]) -> Vec<T> {
    let second_half = |stretch: usize| stretch * STEPS + STEPS / 2..(stretch + 1) * STEPS;
    [0, 1]
        .into_iter()
        .filter_map(|stretch| counts.get(second_half(stretch)))
        .flatten()
        .copied()
        .collect()
}

fn median(mut numbers: Vec<u32>) -> u32 {
    numbers.sort_unstable();
    numbers.get(numbers.len() / 2).copied().unwrap_or(0)
}

/// Counts a step function of a program, given its index in the program's list and its symbol, and
/// its code if its longest paths are searched.
///
/// # Errors
/// If the emulator fails, its two ways of counting differ, or a step leaves the control-flow graph.
pub fn count(
    firmware: &Firmware,
    program: &str,
    image: &Image,
    (place, symbol): (u16, &str),
    inputs: &Inputs,
    code: Option<&Program>,
) -> Result<Counts, BenchError> {
    let task = Task {
        mode: Mode::Count,
        drive: place,
        block: 0,
    };
    let counts = numbers(&firmware.run_program(program, task, &inputs.records)?);
    let sounding = Task {
        mode: Mode::Stack,
        ..task
    };
    let depth = |records: &[u8]| -> Result<u32, BenchError> {
        let depth = firmware.run_program(program, sounding, records)?;
        Ok(depth.try_into().map_or(0, u32::from_le_bytes))
    };
    let mut stack = depth(&inputs.records)?;
    let mut arbitrary = None;
    if let Some(records) = &inputs.arbitrary {
        arbitrary = numbers(&firmware.run_program(program, task, records)?)
            .into_iter()
            .max();
        stack = stack.max(depth(records)?);
    }
    let traced = numbers(&firmware.run_program(program, task, &inputs.traced)?);
    let calls = trace(firmware, program, image, symbol, task, inputs, code)?;
    let instructions: Vec<u32> = calls.iter().map(|call| call.instructions).collect();
    if instructions != traced {
        let mut calls = 0..instructions.len().max(traced.len());
        let call = calls.find(|&call| instructions.get(call) != traced.get(call));
        let [logged, clocked] =
            [&instructions, &traced].map(|counts| call.and_then(|call| counts.get(call)));
        return Err(BenchError::Failed(format!(
            "{symbol}: the clock of the core and the log of its instructions count differently, \
             first in call {call:?}: {clocked:?} and {logged:?}"
        )));
    }
    Ok(Counts {
        normal: median(settled(&counts)),
        supervision: None,
        worst: counts.iter().copied().max().unwrap_or(0),
        arbitrary,
        stack,
        cycles: median(
            calls[calls.len() / 2..]
                .iter()
                .map(|call| call.cycles)
                .collect(),
        ),
    })
}

/// Counts the supervision of a drive: the median of settled steps of a drive with the same limits
/// and an empty law.
///
/// # Errors
/// If the emulator fails.
pub fn supervision(
    firmware: &Firmware,
    program: &str,
    place: u16,
    inputs: &Inputs,
) -> Result<u32, BenchError> {
    let task = Task {
        mode: Mode::Supervision,
        drive: place,
        block: 0,
    };
    let counts = numbers(&firmware.run_program(program, task, &inputs.records)?);
    Ok(median(settled(&counts)))
}

fn trace(
    firmware: &Firmware,
    program: &str,
    image: &Image,
    symbol: &str,
    task: Task,
    inputs: &Inputs,
    code: Option<&Program>,
) -> Result<Vec<Executed>, BenchError> {
    let function = image.function(symbol)?;
    let caller = image.function("hexagen_counted_call")?;
    let task = Task {
        mode: Mode::Trace,
        ..task
    };
    let log = firmware.trace(program, task, &inputs.traced)?;
    if let Some(code) = code {
        code.check_executed(executed_addresses(&log), &function, &caller)?;
    }
    Ok(executed(&log, image, firmware.target, &function, &caller))
}

/// The counts of all steps.
fn numbers(answers: &[u8]) -> Vec<u32> {
    answers
        .chunks_exact(2)
        .map(|bytes| u32::from(u16::from_le_bytes([bytes[0], bytes[1]])))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::{INTERRUPT_VARIANT, paper_drive};
    use hexagen::{Fault, LegState};

    #[test]
    fn the_largest_step_is_that_of_any_input() {
        let counts = |worst, arbitrary| Counts {
            normal: 90,
            supervision: None,
            worst,
            arbitrary,
            stack: 8,
            cycles: 100,
        };
        assert_eq!(counts(207, Some(375)).largest(), 375);
        assert_eq!(counts(207, Some(206)).largest(), 207);
        assert_eq!(counts(207, None).largest(), 207);
    }

    /// Checks the documentation of the table's column of arbitrary inputs.
    #[test]
    fn arbitrary_inputs_calibrate_pre_charge_brake_and_trip() {
        let drive = paper_drive(INTERRUPT_VARIANT).expect("a drive of the library");
        let inputs = Inputs::record(&drive).expect("a plant");
        let (records, _) = inputs.arbitrary.as_deref().expect("of a drive").as_chunks();
        let records: Vec<Record> = records.iter().copied().filter_map(Record::decode).collect();
        let steps_behind = |call: Record| {
            let at = records.iter().position(|&record| record == call);
            let behind = &records[at.expect("the call is there") + 1..];
            let steps = behind
                .iter()
                .take_while(|record| matches!(record, Record::Step(_)));
            steps.count()
        };
        let inverter = &drive.spec.inverter;
        assert!(steps_behind(Record::Calibrate) >= 1 << inverter.calibration_log2);
        assert!(steps_behind(Record::Precharge) >= inverter.precharge_periods as usize);

        let mut replayed = Recorder::new(&drive, None);
        let (mut faults, mut brakes, mut opposes) = (vec![], false, false);
        for record in records {
            match record {
                Record::Step(sample) => {
                    let command = replayed.step(sample);
                    opposes |= brakes && command.state().contains(&LegState::Pulsed);
                }
                call => {
                    if let Record::New | Record::Reset | Record::Stop(_) = call {
                        brakes = call == Record::Stop(Stop::Brake);
                    }
                    replayed.call(call);
                }
            }
            faults.extend(replayed.fault());
        }
        for fault in [
            Fault::OverCurrent,
            Fault::AdcRange,
            Fault::Hall,
            Fault::Offset,
        ] {
            assert!(faults.contains(&fault), "{fault:?}");
        }
        assert!(opposes, "no period of braking was controlled");
    }
}
