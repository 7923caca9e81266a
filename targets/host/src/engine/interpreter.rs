//! The generator's interpreter as a drive.
//!
//! The step and the setters run in the interpreter. What the emitted type does around them (reset,
//! start-up calls, access to the state) follows the description of the step.

use hexagen::{Fault, LegState, Legs, Sample};
use hexagen_codegen::ir::{Escape, Machine, Program};
use hexagen_codegen::pipeline::Generated;
use hexagen_reference::Mode;
use hexagen_reference::verify::Subject;

/// An interpreted drive. A value outside its proven interval, which would be a bug of the
/// generator, trips nothing: it is kept for [`Interpreted::escape`], and all legs go off.
#[derive(Clone, Debug)]
pub struct Interpreted<'g> {
    machine: Machine<'g>,
    program: &'g Program,
    calibration_samples: i32,
    precharge_periods: i32,
    words: Words,
    outputs: [usize; 6],
    inputs: Vec<Reading>,
    escape: Option<Escape>,
}

/// Places of the state words that calls touch; out of range where there is none.
#[derive(Clone, Copy, Debug)]
struct Words {
    mode: usize,
    fault: usize,
    countdown: usize,
    sums: [usize; 2],
    offsets: [usize; 2],
}

/// Where an input of the step comes from.
#[derive(Clone, Copy, Debug)]
enum Reading {
    AdcA,
    AdcB,
    Hall,
    HallTicks,
}

impl<'g> Interpreted<'g> {
    /// The program at rest.
    pub fn new(generated: &'g Generated) -> Self {
        let program = generated.graph.program();
        let state = |name: &str| place(program.states.iter().map(|word| word.name.as_str()), name);
        let output = |name: &str| {
            place(
                program.step.outputs.iter().map(|(known, _)| known.as_str()),
                name,
            )
        };
        let reading = |name: &str| match name {
            "adc_a" => Reading::AdcA,
            "adc_b" => Reading::AdcB,
            "hall" => Reading::Hall,
            _ => Reading::HallTicks,
        };
        Self {
            machine: Machine::of_program(program),
            program,
            calibration_samples: generated.interface.calibration_samples,
            precharge_periods: generated.interface.precharge_periods,
            words: Words {
                mode: state("mode"),
                fault: state("fault"),
                countdown: state("countdown"),
                sums: [state("sum_a"), state("sum_b")],
                offsets: [state("offset_a"), state("offset_b")],
            },
            outputs: [
                "compare_a",
                "compare_b",
                "compare_c",
                "leg_a",
                "leg_b",
                "leg_c",
            ]
            .map(output),
            inputs: program
                .step
                .inputs
                .iter()
                .map(|input| reading(&input.name))
                .collect(),
            escape: None,
        }
    }

    /// The first value that left its proven interval, if any did.
    pub fn escape(&self) -> Option<&Escape> {
        self.escape.as_ref()
    }

    fn word(&self, index: usize) -> i32 {
        self.machine.state.get(index).copied().unwrap_or(0)
    }

    fn set_word(&mut self, index: usize, value: i32) {
        if let Some(word) = self.machine.state.get_mut(index) {
            *word = value;
        }
    }

    fn set(&mut self, setter: &str, word: i32) {
        if let Err(escape) = self.machine.set(setter, &[word]) {
            self.escape.get_or_insert(escape);
        }
    }

    fn is_tripped(&self) -> bool {
        self.word(self.words.mode) == Mode::Tripped as i32
    }
}

/// Position of a name; out of range if it is not there.
fn place<'n>(mut names: impl Iterator<Item = &'n str>, name: &str) -> usize {
    names.position(|known| known == name).unwrap_or(usize::MAX)
}

impl Subject for Interpreted<'_> {
    fn step(&mut self, sample: &Sample) -> Legs {
        let mut words = [0; 4];
        for (word, reading) in words.iter_mut().zip(&self.inputs) {
            *word = i32::from(match reading {
                Reading::AdcA => sample.adc_a,
                Reading::AdcB => sample.adc_b,
                Reading::Hall => u16::from(sample.hall),
                Reading::HallTicks => sample.hall_ticks,
            });
        }
        match self.machine.step(&words) {
            Ok(results) => {
                let word = |output: usize| {
                    let place = self.outputs[output];
                    results.get(place).copied().unwrap_or(0)
                };
                Legs {
                    compare: [0, 1, 2].map(|phase| word(phase) as u16),
                    state: [3, 4, 5]
                        .map(|leg| LegState::from_word(hexagen::arith::Word(word(leg)))),
                }
            }
            Err(escape) => {
                self.escape.get_or_insert(escape);
                Legs::OFF
            }
        }
    }

    fn set_current(&mut self, bits: i32) {
        self.set("set_current", bits);
    }

    fn set_torque(&mut self, bits: i32) {
        self.set("set_torque", bits);
    }

    fn set_bus(&mut self, counts: u16) {
        self.set("set_bus", i32::from(counts));
    }

    fn reset(&mut self) {
        let mode = self.word(self.words.mode);
        if mode == Mode::Calibrate as i32 || mode == Mode::Precharge as i32 {
            return;
        }
        let offsets = self.words.offsets;
        for (index, word) in self.program.states.iter().enumerate() {
            if !offsets.contains(&index) {
                self.machine.state[index] = word.initial;
            }
        }
    }

    fn calibrate(&mut self) {
        if !self.is_tripped() {
            self.set_word(self.words.mode, Mode::Calibrate as i32);
            self.set_word(self.words.countdown, self.calibration_samples);
            for sum in self.words.sums {
                self.set_word(sum, 0);
            }
        }
    }

    fn precharge(&mut self) {
        let mode = self.word(self.words.mode);
        let may_start = mode == Mode::Run as i32 || mode == Mode::Precharge as i32;
        if may_start && self.precharge_periods > 0 {
            self.set_word(self.words.mode, Mode::Precharge as i32);
            self.set_word(self.words.countdown, self.precharge_periods);
        }
    }

    fn fault(&self) -> Fault {
        Fault::from_word(hexagen::arith::Word(self.word(self.words.fault)))
    }

    fn state_words(&self, words: &mut [i32]) {
        words.copy_from_slice(&self.machine.state);
    }

    fn set_state_words(&mut self, words: &[i32]) {
        self.machine.state.copy_from_slice(words);
    }
}
