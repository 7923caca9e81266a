//! The pipe to an external program.
//!
//! Calls are collected and sent as one batch: its length in bytes, then one record per call. The
//! program reads a whole batch before it answers, and answers one record per step. `driver.rs` is
//! the other end.

use super::{External, Terms};
use hexagen::{Command as _, Fault, Sample};
use hexagen_reference::{AnyCommand, Stop};
use std::io::{self, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// Steps per batch.
const BATCH: u64 = 4096;

/// Error of the pipe.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// It could not be opened, written or read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The program failed.
    #[error("it ended with {0}")]
    Ended(std::process::ExitStatus),
}

/// A call other than a step.
#[derive(Clone, Copy, Debug)]
pub enum Call<'w> {
    New,
    SetCurrent(i32),
    SetTorque(i32),
    SetSpeed(i32),
    SetBus(u16),
    Reset,
    Calibrate,
    Precharge,
    Stop(Stop),
    SetStateWords(&'w [i32]),
}

/// A running program.
#[derive(Debug)]
pub struct Link {
    child: Child,
    input: Option<ChildStdin>,
    output: ChildStdout,
    state_words: usize,
    /// Whether commands have intervals.
    has_intervals: bool,
    calls: Vec<u8>,
    expected: Vec<u8>,
    found: Vec<u8>,
    /// Steps whose answers are in `expected`.
    pending: u64,
    /// Steps before them.
    done: u64,
    different: Option<u64>,
    broken: Option<LinkError>,
}

impl Link {
    /// Starts the program.
    pub fn open(external: &External, terms: &Terms<'_>) -> Result<Self, LinkError> {
        let mut child = Command::new(external.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::inherit())
            .spawn()?;
        let missing = || io::Error::from(io::ErrorKind::BrokenPipe);
        let input = child.stdin.take().ok_or_else(missing)?;
        let output = child.stdout.take().ok_or_else(missing)?;
        Ok(Self {
            child,
            input: Some(input),
            output,
            state_words: terms.state_names.len(),
            has_intervals: terms.model.has_intervals(),
            calls: vec![],
            expected: vec![],
            found: vec![],
            pending: 0,
            done: 0,
            different: None,
            broken: None,
        })
    }

    /// Bytes of a step's answer: the command's 64 bits, fault, staleness of the bus voltage, state
    /// words.
    fn answer_length(&self) -> usize {
        8 + 1 + 1 + 4 * self.state_words
    }

    /// Adds a call to the batch.
    pub fn send(&mut self, call: Call<'_>) {
        let calls = &mut self.calls;
        match call {
            Call::New => calls.push(0),
            Call::SetCurrent(bits) => {
                calls.push(2);
                calls.extend(bits.to_le_bytes());
            }
            Call::SetTorque(bits) => {
                calls.push(3);
                calls.extend(bits.to_le_bytes());
            }
            Call::SetSpeed(bits) => {
                calls.push(9);
                calls.extend(bits.to_le_bytes());
            }
            Call::SetBus(counts) => {
                calls.push(4);
                calls.extend(counts.to_le_bytes());
            }
            Call::Reset => calls.push(5),
            Call::Calibrate => calls.push(6),
            Call::Precharge => calls.push(7),
            Call::Stop(stop) => calls.push(match stop {
                Stop::Coast => 10,
                Stop::Brake => 11,
                Stop::Resume => 12,
            }),
            Call::SetStateWords(words) => {
                calls.push(8);
                calls.extend(words.iter().flat_map(|word| word.to_le_bytes()));
            }
        }
    }

    fn send_step(&mut self, sample: Sample) {
        self.calls.push(1);
        let counts = sample.adc().into_iter();
        self.calls.extend(counts.flat_map(u16::to_le_bytes));
        self.calls.push(sample.hall());
        self.calls.extend(sample.ticks().to_le_bytes());
        self.calls.extend(sample.angle().to_le_bytes());
        self.pending += 1;
    }

    /// Adds a step and its expected answer.
    pub fn step(
        &mut self,
        sample: Sample,
        command: AnyCommand,
        (fault, bus_is_stale): (Option<Fault>, bool),
        words: &[i32],
    ) {
        self.send_step(sample);
        let expected = &mut self.expected;
        expected.extend(command.to_bits().to_le_bytes());
        let fault = fault.map_or(0, |fault| fault as u8);
        expected.extend([fault, u8::from(bus_is_stale)]);
        expected.extend(words.iter().flat_map(|word| word.to_le_bytes()));
        if self.pending >= BATCH {
            self.compare();
        }
    }

    /// Runs a step and waits for its answer; `None` if the program stopped.
    pub fn step_and_wait(
        &mut self,
        sample: Sample,
        words: &mut [i32],
    ) -> Option<(AnyCommand, Option<Fault>, bool)> {
        self.send_step(sample);
        self.exchange();
        self.done += self.pending;
        self.pending = 0;
        if self.broken.is_some() {
            return None;
        }
        let (&command, answer) = self.found.split_first_chunk()?;
        let (&[fault, bus_is_stale], answer) = answer.split_first_chunk()?;
        let (answered, _) = answer.as_chunks();
        for (word, &bytes) in words.iter_mut().zip(answered) {
            *word = i32::from_le_bytes(bytes);
        }
        let command = AnyCommand::from_bits(u64::from_le_bytes(command), self.has_intervals);
        let fault = Fault::from_number(fault.into());
        Some((command, fault, bus_is_stale != 0))
    }

    /// Sends the batch and reads its answers into `found`.
    fn exchange(&mut self) {
        self.found
            .resize(self.answer_length() * self.pending as usize, 0);
        if self.broken.is_none()
            && let Err(error) = self.try_exchange()
        {
            self.broken = Some(error.into());
        }
        self.calls.clear();
    }

    fn try_exchange(&mut self) -> io::Result<()> {
        let Some(input) = &mut self.input else {
            return Err(io::ErrorKind::BrokenPipe.into());
        };
        input.write_all(&(self.calls.len() as u32).to_le_bytes())?;
        input.write_all(&self.calls)?;
        input.flush()?;
        self.output.read_exact(&mut self.found)
    }

    /// Exchanges the batch and compares its answers.
    fn compare(&mut self) {
        self.exchange();
        if self.broken.is_none() && self.different.is_none() && self.found != self.expected {
            let length = self.answer_length();
            let pairs = self.found.chunks(length).zip(self.expected.chunks(length));
            let first = pairs
                .take_while(|(found, expected)| found == expected)
                .count();
            self.different = Some(self.done + first as u64);
        }
        self.expected.clear();
        self.done += self.pending;
        self.pending = 0;
    }

    /// Compares the rest and ends the program. Returns the first step that differed.
    pub fn close(mut self) -> Result<Option<u64>, LinkError> {
        if self.pending > 0 {
            self.compare();
        }
        // The program ends when its input does.
        drop(self.input.take());
        let status = self.child.wait()?;
        match self.broken.take() {
            _ if !status.success() => Err(LinkError::Ended(status)),
            Some(error) => Err(error),
            None => Ok(self.different),
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        // After an early return: closing the input ends the program.
        if self.input.take().is_some() {
            let _ = self.child.wait();
        }
    }
}
