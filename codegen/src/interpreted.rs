//! A drive in the interpreter: what the emitted type does around its step and setters.
//!
//! Samples and commands are words, in the order of the emitted type's own fields.

use crate::interface::Interface;
use crate::ir::{Escape, Machine, Program};
use crate::lower::Mode;

/// The inputs that a step may have, in the order of [`InterpretedDrive::step`].
const INPUTS: [&str; 4] = ["adc_a", "adc_b", "hall", "hall_ticks"];

/// A drive that runs in the interpreter.
#[derive(Clone, Debug)]
pub struct InterpretedDrive<'g> {
    machine: Machine<'g>,
    program: &'g Program,
    calibration_samples: i32,
    precharge_periods: i32,
    bus: Option<BusWatch>,
    places: Places,
}

/// The watch over a bus voltage that is told.
#[derive(Clone, Copy, Debug)]
struct BusWatch {
    /// Since the last period.
    told: bool,
    /// Periods until it is stale.
    left: i32,
    /// Periods for which it is fresh.
    periods: i32,
}

impl BusWatch {
    fn pass_period(&mut self) {
        self.left = if self.told {
            self.periods
        } else {
            (self.left - 1).max(0)
        };
        self.told = false;
    }
}

/// Places of the words that calls touch.
#[derive(Clone, Debug)]
struct Places {
    mode: usize,
    fault: usize,
    countdown: usize,
    sums: [usize; 2],
    offsets: [usize; 2],
    /// Per input of the step its place in [`INPUTS`].
    inputs: Vec<usize>,
    compare: [usize; 3],
    legs: [usize; 3],
}

impl<'g> InterpretedDrive<'g> {
    /// The program at rest. It need not pass verification (planted faults are run as well).
    ///
    /// # Panics
    /// When the program is none of a drive: words, inputs or outputs are missing.
    pub fn new(program: &'g Program, interface: &Interface) -> Self {
        let state = |name: &str| {
            let found = program.states.iter().position(|word| word.name == name);
            found.expect("a state word of every drive")
        };
        let output = |name: &str| {
            let mut outputs = program.step.outputs.iter();
            let found = outputs.position(|(known, _)| known == name);
            found.expect("an output of every drive")
        };
        let inputs = program.step.inputs.iter().map(|input| {
            let found = INPUTS.iter().position(|known| *known == input.name);
            found.expect("an input of every drive")
        });
        Self {
            machine: Machine::of_program(program),
            program,
            calibration_samples: interface.calibration_samples,
            precharge_periods: interface.precharge_periods,
            bus: interface.bus_periods.map(|periods| BusWatch {
                told: false,
                left: 0,
                periods,
            }),
            places: Places {
                mode: state("mode"),
                fault: state("fault"),
                countdown: state("countdown"),
                sums: ["sum_a", "sum_b"].map(state),
                offsets: ["offset_a", "offset_b"].map(state),
                inputs: inputs.collect(),
                compare: ["compare_a", "compare_b", "compare_c"].map(output),
                legs: ["leg_a", "leg_b", "leg_c"].map(output),
            },
        }
    }

    /// One control period: from ADC counts of phases a and b, Hall code and ticks since the last Hall edge
    /// to compare values and leg words of phases a, b, c.
    ///
    /// # Errors
    /// [`Escape`] when a value leaves its proven interval.
    pub fn step(&mut self, sample: [i32; 4]) -> Result<[[i32; 3]; 2], Escape> {
        if let Some(bus) = &mut self.bus {
            bus.pass_period();
        }
        let mut inputs = [0; 4];
        let taken = &mut inputs[..self.places.inputs.len()];
        for (word, place) in taken.iter_mut().zip(&self.places.inputs) {
            *word = sample[*place];
        }
        let results = self.machine.step(taken)?;
        let Places { compare, legs, .. } = &self.places;
        Ok([compare, legs].map(|places| places.map(|place| results[place])))
    }

    /// Calls a setter; one that the drive does not have does nothing.
    ///
    /// # Errors
    /// [`Escape`] when a value leaves its proven interval.
    pub fn set(&mut self, setter: &str, word: i32) -> Result<(), Escape> {
        self.machine.set(setter, &[word])?;
        if let Some(bus) = self.bus.as_mut().filter(|_| setter == "set_bus") {
            bus.told = true;
        }
        Ok(())
    }

    /// As the emitted type's `reset`: everything but the calibrated offsets starts again, unless start-up
    /// is under way.
    pub fn reset(&mut self) {
        if self.is_in(Mode::Calibrate) || self.is_in(Mode::Precharge) {
            return;
        }
        for (index, word) in self.program.states.iter().enumerate() {
            if !self.places.offsets.contains(&index) {
                self.machine.state[index] = word.initial;
            }
        }
    }

    /// As the emitted type's `calibrate`: nothing while tripped.
    pub fn calibrate(&mut self) {
        if !self.is_in(Mode::Tripped) {
            self.begin(Mode::Calibrate, self.calibration_samples);
            for sum in self.places.sums {
                self.machine.state[sum] = 0;
            }
        }
    }

    /// As the emitted type's `precharge`: nothing while tripped or calibrating, or without such periods.
    pub fn precharge(&mut self) {
        let may_start = self.is_in(Mode::Run) || self.is_in(Mode::Precharge);
        if may_start && self.precharge_periods > 0 {
            self.begin(Mode::Precharge, self.precharge_periods);
        }
    }

    /// The word that tells what tripped the drive.
    pub fn fault(&self) -> i32 {
        self.machine.state[self.places.fault]
    }

    /// Whether a bus voltage that is told is stale.
    pub fn bus_is_stale(&self) -> bool {
        self.bus.is_some_and(|bus| bus.left == 0)
    }

    /// State words, in the program's order.
    pub fn state(&self) -> &[i32] {
        &self.machine.state
    }

    /// State words, to be set.
    pub fn state_mut(&mut self) -> &mut [i32] {
        &mut self.machine.state
    }

    fn is_in(&self, mode: Mode) -> bool {
        self.machine.state[self.places.mode] == mode as i32
    }

    fn begin(&mut self, mode: Mode, periods: i32) {
        self.machine.state[self.places.mode] = mode as i32;
        self.machine.state[self.places.countdown] = periods;
    }
}
