//! The core's end of the test bench: reads a task, replays its records, answers.

use crate::counter::{count, sound, trace};
use crate::drives::{Drives, StepFn};
use crate::link::{Broken, Link};
use crate::peers::Peer;
use crate::subject::{MOST_WORDS, Subject};
use crate::supervised::{Supervised, step_supervised};
use crate::wire::{BLOCK, Digest, HEADER, Mode, RECORD, Record, Task, encode_outputs};
use hexagen::{Control, Drive, Fault, Sample};

/// Serves one task on the drives of this firmware.
///
/// # Errors
/// If the exchange ends early.
pub fn serve(link: &mut dyn Link, drives: Drives) -> Result<(), Broken> {
    let mut header = [0; HEADER];
    if link.read(&mut header)? < HEADER {
        return Err(Broken::Format);
    }
    let task = Task::decode(header).ok_or(Broken::Format)?;
    if task.mode == Mode::List {
        return drives.iter().try_for_each(|drive| drive.list(link));
    }
    let drive = drives.get(usize::from(task.drive)).ok_or(Broken::Format)?;
    (drive.replay)(link, &task)
}

/// Replays the records of a task on a drive, or on one with only its supervisor.
///
/// # Errors
/// If the exchange ends early.
pub fn replay_drive<C: Control>(
    step: extern "C" fn(&mut Drive<C>, u16, u16, u8, u16) -> u64,
    link: &mut dyn Link,
    task: &Task,
) -> Result<(), Broken> {
    if task.mode != Mode::Supervision {
        return replay(StepFn::Bits(step), link, task);
    }
    let mode = Mode::Count;
    let step = StepFn::Bits(step_supervised::<Supervised<C>>);
    replay(step, link, &Task { mode, ..*task })
}

/// Replays the records of a task on a drive.
///
/// # Errors
/// If the exchange ends early.
pub fn replay<D: Subject>(step: StepFn<D>, link: &mut dyn Link, task: &Task) -> Result<(), Broken> {
    let drive = D::new();
    replay_on(&mut Replayed { drive, step }, link, *task)
}

/// The same, compiled once for all drives: the smallest core's flash has to hold them.
fn replay_on(replayed: &mut dyn Replay, link: &mut dyn Link, task: Task) -> Result<(), Broken> {
    let mut records = [0; BLOCK * RECORD];
    let (mut block, mut depth) = (0, 0);
    loop {
        let length = link.read(&mut records)?;
        let (records, _) = records[..length].as_chunks();
        match task.mode {
            Mode::Digest if length > 0 => link.write(&digest(replayed, records)?.encode())?,
            Mode::Full if block == task.block => return full(replayed, records, link),
            Mode::Full => {
                digest(replayed, records)?;
            }
            Mode::Count | Mode::Trace | Mode::Stack => {
                each_step(replayed, records, |replayed, sample| {
                    replayed.measure(task.mode, sample, &mut depth, link)
                })?;
            }
            Mode::Digest | Mode::List | Mode::Supervision => {}
        }
        if length < BLOCK * RECORD {
            break;
        }
        block += 1;
    }
    if task.mode == Mode::Stack {
        link.write(&depth.to_le_bytes())?;
    }
    Ok(())
}

/// Answers a peer's steps in full, counts them, or measures their stack; other calls of a task are
/// for drives only.
///
/// # Errors
/// If the exchange ends early.
pub fn replay_peer<P: Peer>(
    step: StepFn<P>,
    link: &mut dyn Link,
    task: &Task,
) -> Result<(), Broken> {
    let mut peer = P::new();
    let mut depth = 0;
    let mut record = [0; RECORD];
    while link.read(&mut record)? == RECORD {
        let Record::Step(sample) = Record::decode(record).ok_or(Broken::Format)? else {
            continue;
        };
        if task.mode == Mode::Full {
            link.write(&encode_outputs(step.call(&mut peer, sample), None))?;
        } else {
            measure(task.mode, step, &mut peer, sample, &mut depth, link)?;
        }
    }
    if task.mode == Mode::Stack {
        link.write(&depth.to_le_bytes())?;
    }
    Ok(())
}

/// One counted, traced or measured call.
pub(crate) fn measure<D>(
    mode: Mode,
    step: StepFn<D>,
    drive: &mut D,
    sample: Sample,
    depth: &mut u32,
    link: &mut dyn Link,
) -> Result<(), Broken> {
    match mode {
        Mode::Count => {
            let instructions = count(step, drive, sample).ok_or(Broken::Uncounted)?;
            link.write(&(instructions as u16).to_le_bytes())
        }
        Mode::Trace => trace(step, drive, sample).ok_or(Broken::Uncounted),
        Mode::Stack => {
            *depth = (*depth).max(sound(step, drive, sample).ok_or(Broken::Uncounted)?);
            Ok(())
        }
        Mode::List | Mode::Digest | Mode::Full | Mode::Supervision => Err(Broken::Format),
    }
}

/// A drive of any kind with its step function.
trait Replay {
    /// A call other than a step.
    fn call(&mut self, record: Record);
    /// One step; returns the bits of its command.
    fn step(&mut self, sample: Sample) -> u64;
    /// One counted, traced or measured step.
    fn measure(
        &mut self,
        mode: Mode,
        sample: Sample,
        depth: &mut u32,
        link: &mut dyn Link,
    ) -> Result<(), Broken>;
    /// Fault of the drive.
    fn fault(&self) -> Option<Fault>;
    /// The state words, at the front of `words`.
    fn state_words<'w>(&self, words: &'w mut [i32; MOST_WORDS]) -> &'w [i32];
}

struct Replayed<D> {
    drive: D,
    step: StepFn<D>,
}

impl<D: Subject> Replay for Replayed<D> {
    fn call(&mut self, record: Record) {
        match record {
            Record::Step(_) => {}
            Record::New => self.drive = D::new(),
            Record::SetCurrent(bits) => self.drive.set_current(bits),
            Record::SetTorque(bits) => self.drive.set_torque(bits),
            Record::SetSpeed(bits) => self.drive.set_speed(bits),
            Record::SetBus(counts) => self.drive.set_bus(counts),
            Record::Reset => self.drive.reset(),
            Record::Calibrate => self.drive.calibrate(),
            Record::Precharge => self.drive.precharge(),
            Record::Stop(stop) => self.drive.stop(stop),
            Record::SetStateWord { index, value } => {
                self.drive.set_state_word(usize::from(index), value);
            }
        }
    }

    fn step(&mut self, sample: Sample) -> u64 {
        self.step.call(&mut self.drive, sample)
    }

    fn measure(
        &mut self,
        mode: Mode,
        sample: Sample,
        depth: &mut u32,
        link: &mut dyn Link,
    ) -> Result<(), Broken> {
        measure(mode, self.step, &mut self.drive, sample, depth, link)
    }

    fn fault(&self) -> Option<Fault> {
        self.drive.fault()
    }

    fn state_words<'w>(&self, words: &'w mut [i32; MOST_WORDS]) -> &'w [i32] {
        const { assert!(D::WORDS <= MOST_WORDS) };
        self.drive.state_words(words);
        &words[..D::WORDS]
    }
}

/// Takes the samples of the steps among the records in turn, and executes the calls between them.
fn each_step(
    replayed: &mut dyn Replay,
    records: &[[u8; RECORD]],
    mut take: impl FnMut(&mut dyn Replay, Sample) -> Result<(), Broken>,
) -> Result<(), Broken> {
    for &record in records {
        match Record::decode(record).ok_or(Broken::Format)? {
            Record::Step(sample) => take(replayed, sample)?,
            call => replayed.call(call),
        }
    }
    Ok(())
}

fn digest(replayed: &mut dyn Replay, records: &[[u8; RECORD]]) -> Result<Digest, Broken> {
    let (mut digest, mut words) = (Digest::default(), [0; MOST_WORDS]);
    each_step(replayed, records, |replayed, sample| {
        let command = replayed.step(sample);
        digest.answer(command, replayed.fault());
        for &word in replayed.state_words(&mut words) {
            digest.word(word as u32);
        }
        Ok(())
    })?;
    Ok(digest)
}

fn full(
    replayed: &mut dyn Replay,
    records: &[[u8; RECORD]],
    link: &mut dyn Link,
) -> Result<(), Broken> {
    let mut words = [0; MOST_WORDS];
    each_step(replayed, records, |replayed, sample| {
        let command = replayed.step(sample);
        link.write(&encode_outputs(command, replayed.fault()))?;
        for word in replayed.state_words(&mut words) {
            link.write(&word.to_le_bytes())?;
        }
        Ok(())
    })
}
