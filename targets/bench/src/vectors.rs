//! Vectors: inputs of a drive in closed loop on the simulated plant, and at the edges of their
//! ranges, with its answers on the host.
//!
//! Nine stretches in ten run on the switched plant of the `hexagen` program: start-up, then speeds
//! and set-points of both signs, up to above the speed limit. The tenth is the stimulus of the
//! bit-for-bit test: arbitrary words, corner cases, interspersed calls.

use crate::BenchError;
use crate::listing::Listed;
use hexagen::{Command as _, Fault, Sample};
use hexagen_firmware::wire::{BLOCK, Digest, Record, Stop, encode_outputs};
use hexagen_lab::closed_loop::{ClosedLoop, CurrentLoop, Delay};
use hexagen_lab::engine::{MotorSource, Prepared, plant_of, prepare};
use hexagen_lab::plant::{Plant, Truth};
use hexagen_reference::verify::{Action, Context, Stimulus, Subject};
use hexagen_reference::{self as reference, AnyCommand};
use std::f64::consts::TAU;

/// Steps of a stretch.
const STRETCH: usize = 2048;

/// The recorded run of a drive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vectors {
    /// Records in the core's format.
    pub records: Vec<u8>,
    /// Digest of each block's answers.
    pub digests: Vec<[u8; 8]>,
    /// Answers of the requested block, step by step.
    pub full: Vec<Answer>,
    /// Steps among the records.
    pub steps: usize,
}

/// Outputs of a step, and the state words after it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Inputs of the step.
    pub sample: Sample,
    /// Step from the beginning of the run.
    pub step: usize,
    /// Outputs and state words in the core's format.
    pub bytes: Vec<u8>,
}

/// The host's drive for one of the firmware's list.
///
/// # Errors
/// If the host's drive of the same motor and options differs, or does not exist.
pub fn drive_of(listed: &Listed) -> Result<Prepared, BenchError> {
    let drive = prepared(&listed.symbol, &listed.motor, &listed.variant)?;
    let nameless = |spec: &str| spec.split_once('\n').map(|(_, rest)| rest.to_owned());
    if nameless(&drive.generated.interface.spec_toml) != nameless(&listed.spec) {
        return Err(BenchError::Other(listed.symbol.clone()));
    }
    Ok(drive)
}

/// The drive of a motor of the library, with its symbol for messages.
///
/// # Errors
/// If there is no such motor, or no such drive of it.
pub fn prepared(symbol: &str, motor: &str, variant: &str) -> Result<Prepared, BenchError> {
    let motor =
        MotorSource::of_library(motor).ok_or_else(|| BenchError::Motor(motor.to_owned()))?;
    prepare(&motor, Some(variant))
        .map_err(|errors| BenchError::Drive(symbol.to_owned(), errors.to_string()))
}

/// Records a run of at least `steps` steps, with the full answers of one block, if requested.
///
/// # Errors
/// If the plant is invalid, which a valid specification does not cause.
pub fn record(drive: &Prepared, steps: usize, full: Option<usize>) -> Result<Vectors, BenchError> {
    let mut recorder = Recorder::new(drive, full);
    let mut stretches = Stretches::default();
    let mut stretch = 0;
    while recorder.vectors.steps < steps {
        if stretch % 10 == 9 {
            recorder.edges(drive, stretch)?;
        } else {
            stretches.draw().close(drive, &mut recorder)?;
        }
        stretch += 1;
    }
    Ok(recorder.finish())
}

/// Receives a stretch's calls: a drive, or a recorder.
pub trait Called {
    /// A call other than a step.
    fn call(&mut self, record: Record);

    /// A control period.
    fn step(&mut self, sample: Sample) -> AnyCommand;
}

/// The stretches of a run in closed loop, always the same ones: start-up at standstill, then speeds
/// and set-points of both signs, up to above the speed limit.
#[derive(Clone, Debug)]
pub struct Stretches {
    random: fastrand::Rng,
    starts_up: bool,
}

impl Default for Stretches {
    fn default() -> Self {
        Self {
            random: fastrand::Rng::with_seed(1),
            starts_up: true,
        }
    }
}

impl Stretches {
    /// The next one.
    pub fn draw(&mut self) -> Stretch {
        let starts_up = std::mem::take(&mut self.starts_up);
        let mut share = || 2.0 * self.random.f64() - 1.0;
        Stretch {
            starts_up,
            speed: if starts_up { 0.0 } else { 1.3 * share() },
            currents: [share(), share()],
            steps: STRETCH,
        }
    }
}

/// A stretch in closed loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Whether calibration and pre-charge come first.
    pub starts_up: bool,
    /// Share of the rated speed.
    pub speed: f64,
    /// Set-points of the halves, relative to the largest one.
    pub currents: [f64; 2],
    /// Steps under control.
    pub steps: usize,
}

impl Stretch {
    /// The drive's plant at the stretch's speed.
    fn plant(&self, drive: &Prepared) -> Result<Plant, BenchError> {
        let omega = self.speed * drive.rated_rpm() * TAU / 60.0;
        Ok(Plant::new(plant_of(&drive.spec), 0.1, omega)?)
    }

    /// Set-point of a speed loop, bits of an `I16F16` in rpm: a little more than the speed, so that
    /// it demands current.
    fn wanted_rpm(&self, drive: &Prepared) -> i32 {
        let share = self.speed + 0.02_f64.copysign(self.speed);
        (share * drive.rated_rpm() * 65_536.0) as i32
    }

    /// Runs a controller with a fixed set-point on the drive's plant.
    ///
    /// # Errors
    /// If the plant is invalid.
    pub fn run(&self, drive: &Prepared, controller: impl CurrentLoop) -> Result<(), BenchError> {
        ClosedLoop::new(self.plant(drive)?, controller, delay(drive)).run(self.steps, &mut ());
        Ok(())
    }

    /// Runs a drive on its plant, from its initial state. Set-points are set after start-up, which
    /// need not keep them.
    ///
    /// # Errors
    /// If the plant is invalid.
    pub fn close(&self, drive: &Prepared, called: &mut impl Called) -> Result<(), BenchError> {
        self.close_and_stop(drive, called, None)
    }

    /// The same, with a call that turns the drive off on purpose before each half.
    ///
    /// # Errors
    /// If the plant is invalid.
    pub fn close_and_stop(
        &self,
        drive: &Prepared,
        called: &mut impl Called,
        stops: Option<[Stop; 2]>,
    ) -> Result<(), BenchError> {
        called.call(Record::New);
        if let Some(counts) = drive.bus_counts(drive.spec.inverter.v_bus) {
            called.call(Record::SetBus(counts));
        }
        let inverter = &drive.spec.inverter;
        let mut closed = ClosedLoop::new(self.plant(drive)?, InLoop(called), delay(drive));
        if self.starts_up {
            closed.controller().0.call(Record::Calibrate);
            closed.run(1 << inverter.calibration_log2, &mut ());
            closed.controller().0.call(Record::Precharge);
            closed.run(inverter.precharge_periods as usize, &mut ());
        }
        if drive.spec.controller.common().speed.is_some() {
            let wanted = Record::SetSpeed(self.wanted_rpm(drive));
            closed.controller().0.call(wanted);
        }
        for (half, share) in self.currents.into_iter().enumerate() {
            if let Some(stops) = stops {
                closed.controller().0.call(Record::Stop(stops[half]));
            }
            let bits = (share * inverter.max_current * 65_536.0) as i32;
            closed.controller().0.call(Record::SetCurrent(bits));
            closed.run(self.steps / 2, &mut ());
        }
        Ok(())
    }
}

/// Delay of a drive's commands.
fn delay(drive: &Prepared) -> Delay {
    match drive.spec.controller.common().delay {
        0 => Delay::None,
        _ => Delay::OnePeriod,
    }
}

/// Receives a stretch's calls, in place of the controller.
struct InLoop<'c, C>(&'c mut C);

impl<C: Called> CurrentLoop for InLoop<'_, C> {
    fn step(&mut self, sample: &Sample, _: &Truth) -> AnyCommand {
        self.0.step(*sample)
    }
}

/// A drive on the host: compiled code if built in, else the interpreted program, which is equal.
pub struct OnHost<'g> {
    drive: &'g Prepared,
    subject: Box<dyn Subject + 'g>,
}

impl<'g> OnHost<'g> {
    /// In its initial state.
    pub fn new(drive: &'g Prepared) -> Self {
        let subject: Box<dyn Subject + 'g> = match drive.compiled() {
            Some(compiled) => Box::new(compiled),
            None => Box::new(drive.interpreted()),
        };
        Self { drive, subject }
    }
}

impl Called for OnHost<'_> {
    fn call(&mut self, record: Record) {
        match record {
            Record::New => *self = Self::new(self.drive),
            Record::SetCurrent(bits) => self.subject.set_current(bits),
            Record::SetTorque(bits) => self.subject.set_torque(bits),
            Record::SetSpeed(bits) => self.subject.set_speed(bits),
            Record::SetBus(counts) => self.subject.set_bus(counts),
            Record::Reset => self.subject.reset(),
            Record::Calibrate => self.subject.calibrate(),
            Record::Precharge => self.subject.precharge(),
            Record::Stop(stop) => self.subject.stop(match stop {
                Stop::Coast => reference::Stop::Coast,
                Stop::Brake => reference::Stop::Brake,
                Stop::Resume => reference::Stop::Resume,
            }),
            Record::Step(_) | Record::SetStateWord { .. } => {}
        }
    }

    fn step(&mut self, sample: Sample) -> AnyCommand {
        self.subject.step(&sample)
    }
}

/// A drive of the host that records all calls and answers.
pub struct Recorder<'g> {
    host: OnHost<'g>,
    words: Vec<i32>,
    digest: Digest,
    in_block: usize,
    full: Option<usize>,
    vectors: Vectors,
}

impl<'g> Recorder<'g> {
    /// A drive in its initial state.
    pub fn new(drive: &'g Prepared, full: Option<usize>) -> Self {
        Self {
            host: OnHost::new(drive),
            words: vec![0; drive.state_names().len()],
            digest: Digest::default(),
            in_block: 0,
            full,
            vectors: Vectors::default(),
        }
    }

    /// Ends the run.
    pub fn finish(mut self) -> Vectors {
        if self.in_block > 0 {
            self.vectors.digests.push(self.digest.encode());
        }
        self.vectors
    }

    fn note(&mut self, record: Record) {
        if self.in_block == BLOCK {
            let digest = std::mem::take(&mut self.digest);
            self.vectors.digests.push(digest.encode());
            self.in_block = 0;
        }
        self.in_block += 1;
        self.vectors.records.extend(record.encode());
    }

    /// Overwrites all state words.
    fn recall(&mut self, words: &[i32]) {
        for (index, &value) in words.iter().enumerate() {
            let index = index as u8;
            self.note(Record::SetStateWord { index, value });
        }
        self.host.subject.set_state_words(words);
    }

    /// The sample that a record holds: of an angle the upper bits, and with an angle sensor nothing else.
    fn recorded(&self, sample: Sample) -> Sample {
        if self.host.drive.spec.angle_sensor().is_none() {
            return sample;
        }
        let [adc_a, adc_b, adc_c] = sample.adc();
        Sample::with_angle([adc_a, adc_b], sample.angle() & !0xff).third_current(adc_c)
    }

    /// Fault of the drive.
    pub fn fault(&self) -> Option<Fault> {
        self.host.subject.fault()
    }

    /// A stretch of the bit-for-bit test's stimulus: arbitrary words, corner cases, interspersed
    /// calls.
    ///
    /// # Errors
    /// If there is no stimulus for the drive.
    pub fn edges(&mut self, drive: &Prepared, seed: u64) -> Result<(), BenchError> {
        let mut stimulus = Stimulus::new(&drive.reference, seed)
            .map_err(|error| BenchError::Stimulus(error.to_string()))?;
        self.call(Record::New);
        let mut remembered: Option<Vec<i32>> = None;
        let offset = f64::from(drive.spec.inverter.adc_offset);
        for _ in 0..STRETCH {
            let context = Context {
                offset: [offset; 3],
                tripped: self.fault().is_some(),
            };
            let (action, sample) = stimulus.next(&context);
            match action {
                Some(Action::SetCurrent(bits)) => self.call(Record::SetCurrent(bits)),
                Some(Action::SetTorque(bits)) => self.call(Record::SetTorque(bits)),
                Some(Action::SetBus(counts)) => self.call(Record::SetBus(counts)),
                Some(Action::Reset) => self.call(Record::Reset),
                Some(Action::Calibrate) => self.call(Record::Calibrate),
                Some(Action::Precharge) => self.call(Record::Precharge),
                Some(Action::Remember) => remembered = Some(self.words.clone()),
                Some(Action::Recall) => {
                    if let Some(words) = remembered.clone() {
                        self.recall(&words);
                    }
                }
                Some(Action::SetSpeed(bits)) => self.call(Record::SetSpeed(bits)),
                Some(Action::Stop(stop)) => self.call(Record::Stop(match stop {
                    reference::Stop::Coast => Stop::Coast,
                    reference::Stop::Brake => Stop::Brake,
                    reference::Stop::Resume => Stop::Resume,
                })),
                None => {}
            }
            let command = self.step(sample);
            stimulus.respond(command);
        }
        Ok(())
    }
}

impl Called for Recorder<'_> {
    fn call(&mut self, record: Record) {
        self.note(record);
        self.host.call(record);
    }

    fn step(&mut self, sample: Sample) -> AnyCommand {
        let sample = self.recorded(sample);
        self.note(Record::Step(sample));
        let command = self.host.step(sample);
        let fault = self.host.subject.fault();
        self.host.subject.state_words(&mut self.words);
        self.digest.answer(command.to_bits(), fault);
        for &word in &self.words {
            self.digest.word(word as u32);
        }
        if self.full == Some(self.vectors.digests.len()) {
            let words = self.words.iter().flat_map(|word| word.to_le_bytes());
            self.vectors.full.push(Answer {
                sample,
                step: self.vectors.steps,
                bytes: encode_outputs(command.to_bits(), fault)
                    .into_iter()
                    .chain(words)
                    .collect(),
            });
        }
        self.vectors.steps += 1;
        command
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_record_is_read_as_it_was_written() {
        let sample = Sample::with_hall([17, 4095], 5).hall_ticks(54_321);
        for record in [
            Record::New,
            Record::Step(sample),
            Record::SetCurrent(-5),
            Record::SetTorque(i32::MIN),
            Record::SetBus(4000),
            Record::Reset,
            Record::Calibrate,
            Record::Precharge,
            Record::SetSpeed(65_537),
            Record::Stop(Stop::Coast),
            Record::Stop(Stop::Brake),
            Record::Stop(Stop::Resume),
            Record::SetStateWord {
                index: 200,
                value: -1,
            },
        ] {
            assert_eq!(Record::decode(record.encode()), Some(record));
        }
        let [_, rest @ ..] = Record::New.encode();
        let operation = |number: u8| [&[number][..], &rest[..]].concat();
        let unknown = operation(11).try_into().expect("a record");
        assert_eq!(Record::decode(unknown), None);
    }
}
