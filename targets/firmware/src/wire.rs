//! The format between the test bench and the core: a task, records for replay, answers.
//!
//! All numbers are little-endian. A task is one header and records up to the end of the input; the
//! core answers each block of records, and the rest at the end, according to the task's mode.

use hexagen::{Fault, Sample};

/// Bytes of a record.
pub const RECORD: usize = 8;

/// Records of a block.
pub const BLOCK: usize = 512;

/// Bytes of a task's header.
pub const HEADER: usize = 12;

/// Bytes of a full answer, besides four per state word: command, fault.
pub const ANSWER: usize = 9;

/// First byte of a step's record.
pub const STEP_RECORD: u8 = 1;

/// Magic number of every task.
const MAGIC: [u8; 4] = *b"HXG1";

/// Mode of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Lists its drives; reads no records.
    List = 0,
    /// Answers each block with its [`Digest`].
    Digest = 1,
    /// Answers every step of one block in full; of a peer, every step.
    Full = 2,
    /// Answers each step with its count of instructions, 16 bits.
    Count = 3,
    /// Answers once: the maximum stack depth in bytes, 32 bits.
    Stack = 4,
    /// Calls each step as for a count, without answers: the emulator logs the instructions.
    Trace = 5,
    /// Like [`Mode::Count`], on a drive with the same supervisor and an empty law.
    Supervision = 6,
}

/// Header of the input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Task {
    /// Mode.
    pub mode: Mode,
    /// Index in the list of drives.
    pub drive: u16,
    /// The block with full answers.
    pub block: u32,
}

impl Task {
    /// As bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; HEADER] {
        let [m0, m1, m2, m3] = MAGIC;
        let [d0, d1] = self.drive.to_le_bytes();
        let [b0, b1, b2, b3] = self.block.to_le_bytes();
        [m0, m1, m2, m3, self.mode as u8, 0, d0, d1, b0, b1, b2, b3]
    }

    /// From bytes; `None` if they are not a task.
    #[must_use]
    pub fn decode(bytes: [u8; HEADER]) -> Option<Self> {
        let [m0, m1, m2, m3, mode, _, d0, d1, b0, b1, b2, b3] = bytes;
        if [m0, m1, m2, m3] != MAGIC {
            return None;
        }
        Some(Self {
            mode: match mode {
                0 => Mode::List,
                1 => Mode::Digest,
                2 => Mode::Full,
                3 => Mode::Count,
                4 => Mode::Stack,
                5 => Mode::Trace,
                6 => Mode::Supervision,
                _ => return None,
            },
            drive: u16::from_le_bytes([d0, d1]),
            block: u32::from_le_bytes([b0, b1, b2, b3]),
        })
    }
}

/// Being off on purpose, or its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// All legs off.
    Coast = 0,
    /// Slowing the rotor down.
    Brake = 1,
    /// The end of both.
    Resume = 2,
}

/// A call of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Record {
    /// Resets to a drive in its initial state.
    New,
    /// A control period.
    Step(Sample),
    /// Current set-point, bits of an `I16F16` in ampere.
    SetCurrent(i32),
    /// Torque set-point, bits of an `I16F16` in newton metres.
    SetTorque(i32),
    /// Bus voltage, ADC counts.
    SetBus(u16),
    /// Reset.
    Reset,
    /// Start of the offset calibration.
    Calibrate,
    /// Start of the bootstrap pre-charge.
    Precharge,
    /// Speed set-point, bits of an `I16F16` in rpm.
    SetSpeed(i32),
    /// Coasting, braking, or the end of both.
    Stop(Stop),
    /// Overwrites a state word.
    SetStateWord {
        /// Index among the state words.
        index: u8,
        /// Its new value.
        value: i32,
    },
}

/// Hall code and ticks; of an angle the upper 8 and the next 16 bits, which are all that a record holds of it.
fn registers(sample: Sample) -> (u8, u16) {
    match sample.angle() {
        0 => (sample.hall(), sample.ticks()),
        angle => ((angle >> 24) as u8, (angle >> 8) as u16),
    }
}

impl Record {
    /// As bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; RECORD] {
        let number = |operation: u8, value: i32, index: u8| {
            let [v0, v1, v2, v3] = value.to_le_bytes();
            [operation, index, 0, 0, v0, v1, v2, v3]
        };
        match *self {
            Self::New => number(0, 0, 0),
            Self::Step(sample) => {
                let [adc_a, adc_b, _] = sample.adc();
                let (hall, ticks) = registers(sample);
                let [t0, t1] = ticks.to_le_bytes();
                let [a0, a1] = adc_a.to_le_bytes();
                let [b0, b1] = adc_b.to_le_bytes();
                [STEP_RECORD, hall, t0, t1, a0, a1, b0, b1]
            }
            Self::SetCurrent(bits) => number(2, bits, 0),
            Self::SetTorque(bits) => number(3, bits, 0),
            Self::SetBus(counts) => number(4, i32::from(counts), 0),
            Self::Reset => number(5, 0, 0),
            Self::Calibrate => number(6, 0, 0),
            Self::Precharge => number(7, 0, 0),
            Self::SetStateWord { index, value } => number(8, value, index),
            Self::SetSpeed(bits) => number(9, bits, 0),
            Self::Stop(stop) => number(10, stop as i32, 0),
        }
    }

    /// From bytes; `None` if they are not a record.
    #[must_use]
    pub fn decode(bytes: [u8; RECORD]) -> Option<Self> {
        let [operation, index, t0, t1, v0, v1, v2, v3] = bytes;
        let value = i32::from_le_bytes([v0, v1, v2, v3]);
        Some(match operation {
            0 => Self::New,
            STEP_RECORD => {
                let adc = [[v0, v1], [v2, v3]].map(u16::from_le_bytes);
                let ticks = u16::from_le_bytes([t0, t1]);
                Self::Step(Sample::with_hall(adc, index).hall_ticks(ticks))
            }
            2 => Self::SetCurrent(value),
            3 => Self::SetTorque(value),
            4 => Self::SetBus(value as u16),
            5 => Self::Reset,
            6 => Self::Calibrate,
            7 => Self::Precharge,
            8 => Self::SetStateWord { index, value },
            9 => Self::SetSpeed(value),
            10 => Self::Stop(match value {
                0 => Stop::Coast,
                1 => Stop::Brake,
                2 => Stop::Resume,
                _ => return None,
            }),
            _ => return None,
        })
    }
}

/// Digest of a block's answers: two lanes of 32 bits.
///
/// Each lane is a bijection of the lane for a given word, and of the word for a given lane: a
/// single differing word always changes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest([u32; 2]);

impl Default for Digest {
    fn default() -> Self {
        Self([0x811c_9dc5, 0x9e37_79b9])
    }
}

impl Digest {
    /// Adds a word.
    pub fn word(&mut self, word: u32) {
        let [first, second] = self.0;
        self.0 = [
            (first ^ word).wrapping_mul(0x0100_0193).rotate_left(13),
            second
                .wrapping_add(word)
                .rotate_left(7)
                .wrapping_mul(0x9e37_79b1),
        ];
    }

    /// Adds the bits of a step's command.
    pub fn command(&mut self, bits: u64) {
        self.word(bits as u32);
        self.word((bits >> 32) as u32);
    }

    /// Adds the outputs of a step, its command in bits.
    pub fn answer(&mut self, command: u64, fault: Option<Fault>) {
        self.command(command);
        self.word(u32::from(number(fault)));
    }

    /// As bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; 8] {
        let [first, second] = self.0.map(u32::to_le_bytes);
        let [f0, f1, f2, f3] = first;
        let [s0, s1, s2, s3] = second;
        [f0, f1, f2, f3, s0, s1, s2, s3]
    }
}

/// The number of a fault; 0 for none.
fn number(fault: Option<Fault>) -> u8 {
    fault.map_or(0, |fault| fault as u8)
}

/// A step's outputs as bytes: the bits of its command, and its fault; its state words follow.
#[must_use]
pub fn encode_outputs(command: u64, fault: Option<Fault>) -> [u8; ANSWER] {
    let [c0, c1, c2, c3, c4, c5, c6, c7] = command.to_le_bytes();
    [c0, c1, c2, c3, c4, c5, c6, c7, number(fault)]
}
