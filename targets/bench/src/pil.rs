//! Processor in the loop: the host's closed-loop vectors on the emulated core, with every output
//! and state word compared.

use crate::BenchError;
use crate::firmware::{Firmware, PROGRAMS};
use crate::listing::Listed;
use crate::targets::Target;
use crate::vectors::{Answer, Vectors, drive_of, record};
use hexagen_firmware::wire::{ANSWER, Mode, RECORD, STEP_RECORD, Task};
use hexagen_lab::engine::Prepared;
use hexagen_reference::AnyCommand;
use rayon::prelude::*;
use std::fmt::Write as _;
use std::time::Instant;

/// Options of the replay.
#[derive(Debug, clap::Args)]
pub struct Options {
    /// Minimum steps per controller and target
    #[arg(long, default_value_t = 50_000)]
    pub steps: usize,
    /// Only drives whose symbol contains this
    #[arg(long)]
    pub only: Option<String>,
}

/// Replays vectors on every drive of every target.
///
/// # Errors
/// If a tool is missing, or a word differs.
pub fn run(targets: &[Target], options: &Options) -> Result<(), BenchError> {
    let mut differing = 0;
    for &target in targets {
        let firmware = Firmware::build(target)?;
        prove_that_it_can_fail(&firmware)?;
        let begin = Instant::now();
        let mut drives = vec![];
        for program in PROGRAMS {
            let core = Emulated(&firmware, program);
            drives.extend(
                firmware
                    .drives(program)?
                    .into_iter()
                    .map(|drive| (core, drive)),
            );
        }
        if let Some(part) = &options.only {
            drives.retain(|(_, drive)| drive.symbol.contains(part));
        }
        let outcomes: Vec<_> = drives
            .par_iter()
            .map(|(core, listed)| compare(core, listed, options.steps))
            .collect::<Result<_, BenchError>>()?;
        let mut steps = 0;
        for ((_, listed), outcome) in drives.iter().zip(outcomes) {
            steps += outcome.steps;
            if let Some(report) = outcome.difference {
                differing += 1;
                println!("{}: {} differs\n{report}", target.name(), listed.symbol);
            }
        }
        println!(
            "{}: {} drives, {steps} steps, {} s",
            target.name(),
            drives.len(),
            begin.elapsed().as_secs()
        );
    }
    match differing {
        0 => Ok(()),
        _ => Err(BenchError::Failed(format!(
            "{differing} drives differ from the host"
        ))),
    }
}

/// Result of a drive.
struct Outcome {
    steps: usize,
    /// The first step that differs, in full.
    difference: Option<String>,
}

fn compare(core: &impl Core, listed: &Listed, steps: usize) -> Result<Outcome, BenchError> {
    let drive = drive_of(listed)?;
    let vectors = record(&drive, steps, None)?;
    let difference = difference(core, listed, &drive, &vectors)?;
    Ok(Outcome {
        steps: vectors.steps,
        difference,
    })
}

/// Runs the records of a task: an emulator, or a test.
pub trait Core {
    /// The answers to a task.
    ///
    /// # Errors
    /// If the emulator fails or hangs.
    fn run(&self, task: Task, records: &[u8]) -> Result<Vec<u8>, BenchError>;
}

/// A program of the firmware.
#[derive(Clone, Copy)]
pub struct Emulated<'f>(pub &'f Firmware, pub &'static str);

impl Core for Emulated<'_> {
    fn run(&self, task: Task, records: &[u8]) -> Result<Vec<u8>, BenchError> {
        let Self(firmware, program) = self;
        firmware.run_program(program, task, records)
    }
}

/// The first step that differs, in full.
fn difference(
    core: &impl Core,
    listed: &Listed,
    drive: &Prepared,
    vectors: &Vectors,
) -> Result<Option<String>, BenchError> {
    let task = Task {
        mode: Mode::Digest,
        drive: listed.place,
        block: 0,
    };
    let found = core.run(task, &vectors.records)?;
    let Some(block) = first_block(vectors, &found) else {
        return Ok(None);
    };
    let task = Task {
        mode: Mode::Full,
        block: block as u32,
        ..task
    };
    let found = core.run(task, &vectors.records)?;
    let expected = record(drive, vectors.steps, Some(block))?.full;
    let has_intervals = drive.spec.controller.has_intervals();
    let report = first_step(&expected, &found, has_intervals, &listed.words);
    Ok(Some(report.unwrap_or_else(|| {
        format!("block {block} differs in its digest only")
    })))
}

/// Self-test: changes one ADC count of one step by one on the core; the comparison must name that
/// step.
fn prove_that_it_can_fail(firmware: &Firmware) -> Result<(), BenchError> {
    const STEP: usize = 2500;
    let [program, ..] = PROGRAMS;
    let drives = firmware.drives(program)?;
    let listed = drives.first().ok_or(BenchError::Listing)?;
    let drive = drive_of(listed)?;
    let honest = record(&drive, 2 * STEP, None)?;
    let mut planted = honest.clone();
    let mut steps = planted
        .records
        .chunks_exact_mut(RECORD)
        .filter(|record| record[0] == STEP_RECORD);
    if let Some(record) = steps.nth(STEP) {
        record[4] ^= 1;
    }
    match difference(&Emulated(firmware, program), listed, &drive, &planted)? {
        Some(report) if report.contains(&format!("step {STEP},")) => Ok(()),
        found => Err(BenchError::Failed(format!(
            "a bit planted in step {STEP} of {} was not found there: {found:?}",
            listed.symbol
        ))),
    }
}

/// The first block with another digest, or without an answer.
fn first_block(vectors: &Vectors, found: &[u8]) -> Option<usize> {
    let mut found = found.chunks(8);
    vectors
        .digests
        .iter()
        .position(|digest| found.next() != Some(digest))
}

/// The first step that differs, with all its words by name: those of the command, the fault, and the
/// state words.
pub fn first_step(
    expected: &[Answer],
    found: &[u8],
    has_intervals: bool,
    names: &[String],
) -> Option<String> {
    let length = ANSWER + 4 * names.len();
    let mut found = found.chunks(length);
    let (answer, found) = expected
        .iter()
        .map(|answer| (answer, found.next().unwrap_or_default()))
        .find(|(answer, found)| answer.bytes != *found)?;
    let mut text = format!("step {}, {:?}\n", answer.step, answer.sample);
    let mut line = |name: &str, [expected, found]: [Option<i32>; 2]| {
        let mark = if expected == found { ' ' } else { '*' };
        let shown = |word: Option<i32>| word.map_or("nothing".to_owned(), |word| word.to_string());
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{mark} {name:20} {:>12} {:>12}",
            shown(expected),
            shown(found)
        );
    };
    let sides = [answer.bytes.as_slice(), found];
    let command = |bytes: &[u8]| {
        let bits = u64::from_le_bytes(*bytes.first_chunk()?);
        Some(AnyCommand::from_bits(bits, has_intervals).named_words())
    };
    let [expected, found] = sides.map(command);
    for (place, (name, expected)) in expected.into_iter().flatten().enumerate() {
        let found = found.as_ref().map(|words| words[place].1);
        line(
            name,
            [Some(expected), found].map(|word| word.map(i32::from)),
        );
    }
    line("fault", sides.map(|bytes| number::<1>(bytes, 8)));
    for (index, name) in names.iter().enumerate() {
        line(
            name,
            sides.map(|bytes| number::<4>(bytes, ANSWER + 4 * index)),
        );
    }
    Some(format!("  {:20} {:>12} {:>12}\n{text}", "", "host", "core"))
}

/// A little-endian number of `N` bytes.
fn number<const N: usize>(bytes: &[u8], at: usize) -> Option<i32> {
    let bytes = bytes.get(at..at + N)?;
    let mut word = [0; 4];
    word[..N].copy_from_slice(bytes);
    Some(i32::from_le_bytes(word))
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use hexagen::{Drive, Fault, Legs, Sample};
    use hexagen_firmware::link::{Broken, Link};
    use hexagen_firmware::session::{replay, serve};
    use hexagen_firmware::{Drives, StepFn, Subject, Supervised};
    use std::cell::Cell;

    hexagen_firmware::drives! {
        Nearest, step_of_the_test: "../motors/trivedi-keshri-660w.toml", pdcc { saturation: nearest };
    }

    type Tested = Drive<Nearest>;

    /// A task and its answers in memory.
    pub struct Memory<'t> {
        pub input: &'t [u8],
        pub answers: Vec<u8>,
    }

    impl Link for Memory<'_> {
        fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Broken> {
            let length = bytes.len().min(self.input.len());
            let (taken, rest) = self.input.split_at(length);
            bytes[..length].copy_from_slice(taken);
            self.input = rest;
            Ok(length)
        }

        fn write(&mut self, bytes: &[u8]) -> Result<(), Broken> {
            self.answers.extend(bytes);
            Ok(())
        }
    }

    /// The core's end in this process, with a given step function.
    struct InProcess(StepFn<Tested>);

    impl Core for InProcess {
        fn run(&self, task: Task, records: &[u8]) -> Result<Vec<u8>, BenchError> {
            let mut link = Memory {
                input: records,
                answers: vec![],
            };
            replay(self.0, &mut link, &task).expect("a task in order");
            Ok(link.answers)
        }
    }

    fn listed() -> Listed {
        let drives: Drives = DRIVES;
        let task = Task {
            mode: Mode::List,
            drive: 0,
            block: 0,
        };
        let mut link = Memory {
            input: &task.encode(),
            answers: vec![],
        };
        serve(&mut link, drives).expect("a task in order");
        let text = String::from_utf8(link.answers).expect("text");
        crate::listing::parse(&text).expect("a list").remove(0)
    }

    const STEPS: usize = 20_000;

    #[test]
    fn the_same_code_on_both_ends_agrees() {
        let outcome =
            compare(&InProcess(StepFn::Bits(step_of_the_test)), &listed(), STEPS).expect("runs");
        assert!(outcome.steps >= STEPS);
        assert_eq!(outcome.difference, None);
    }

    thread_local! {
        static CALLS: Cell<usize> = const { Cell::new(0) };
    }

    /// Flips the lowest bit of `i_b_prev` once, after step 12345 of each replay.
    extern "C" fn wrong_state(drive: &mut Tested, a: u16, b: u16, hall: u8, ticks: u16) -> u64 {
        let command = step_of_the_test(drive, a, b, hall, ticks);
        let call = CALLS.get();
        CALLS.set(call + 1);
        if call == 12_345 {
            let index = Tested::state_names()
                .position(|name| name == "i_b_prev")
                .expect("is there");
            let mut words = vec![0; Tested::WORDS];
            drive.state_words(&mut words);
            drive.set_state_word(index, words[index] ^ 1);
        }
        command
    }

    /// One compare value one count too high, in step 777.
    extern "C" fn wrong_output(drive: &mut Tested, a: u16, b: u16, hall: u8, ticks: u16) -> u64 {
        let command = step_of_the_test(drive, a, b, hall, ticks);
        let call = CALLS.get();
        CALLS.set(call + 1);
        if call == 777 {
            return command ^ 1 << 32;
        }
        command
    }

    /// The report of a core whose call counter restarts in each of its replays.
    fn report(step: StepFn<Tested>) -> String {
        struct Afresh(InProcess);
        impl Core for Afresh {
            fn run(&self, task: Task, records: &[u8]) -> Result<Vec<u8>, BenchError> {
                CALLS.set(0);
                self.0.run(task, records)
            }
        }
        let core = Afresh(InProcess(step));
        let outcome = compare(&core, &listed(), STEPS).expect("runs");
        outcome.difference.expect("a wrong bit is found")
    }

    /// The counted supervision is that of the drive: the same samples trip it.
    #[test]
    fn a_drive_with_an_empty_law_has_the_same_supervision() {
        let mut drives = (Tested::new(), Drive::<Supervised<Nearest>>::new());
        let mut random = fastrand::Rng::with_seed(1);
        let mut faults = vec![];
        for _ in 0..STEPS {
            let adc = [(); 2].map(|()| random.u16(0..4200));
            let sample = Sample::with_hall(adc, random.u8(0..=7));
            let off =
                [drives.0.step(&sample), drives.1.step(&sample)].map(|legs| legs == Legs::OFF);
            assert_eq!(off[0], off[1], "{sample:?}");
            let statuses = [drives.0.status(), drives.1.status()];
            assert_eq!(statuses[0], statuses[1], "{sample:?}");
            faults.extend(statuses[0].fault);
            drives.0.reset();
            drives.1.reset();
        }
        for fault in [Fault::AdcRange, Fault::Hall, Fault::OverCurrent] {
            assert!(faults.contains(&fault), "{fault}");
        }
    }

    #[test]
    fn a_wrong_bit_of_the_state_is_found_in_its_step() {
        let report = report(StepFn::Bits(wrong_state));
        assert!(report.contains("step 12345, Sample"), "{report}");
        let marked: Vec<&str> = report
            .lines()
            .filter(|line| line.starts_with('*'))
            .collect();
        assert_eq!(marked.len(), 1, "{report}");
        assert!(marked[0].starts_with("* i_b_prev"), "{report}");
    }

    #[test]
    fn a_wrong_bit_of_an_output_is_found_in_its_step() {
        let report = report(StepFn::Bits(wrong_output));
        assert!(report.contains("step 777, Sample"), "{report}");
        let marked: Vec<&str> = report
            .lines()
            .filter(|line| line.starts_with('*'))
            .collect();
        assert_eq!(marked.len(), 1, "{report}");
        assert!(marked[0].starts_with("* compare_c"), "{report}");
    }
}
