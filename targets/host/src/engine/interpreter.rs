//! The generator's interpreter as a drive.

use hexagen::arith::Word;
use hexagen::{Fault, LegState, Legs, Sample};
use hexagen_codegen::InterpretedDrive;
use hexagen_codegen::ir::Escape;
use hexagen_codegen::pipeline::Generated;
use hexagen_reference::verify::Subject;

/// An interpreted drive. A value outside its proven interval, which would be a bug of the
/// generator, trips nothing: it is kept for [`Interpreted::escape`], and all legs go off.
#[derive(Clone, Debug)]
pub struct Interpreted<'g> {
    drive: InterpretedDrive<'g>,
    escape: Option<Escape>,
}

impl<'g> Interpreted<'g> {
    /// The program at rest.
    pub fn new(generated: &'g Generated) -> Self {
        Self {
            drive: InterpretedDrive::new(generated.graph.program(), &generated.interface),
            escape: None,
        }
    }

    /// The first value that left its proven interval, if any did.
    pub fn escape(&self) -> Option<&Escape> {
        self.escape.as_ref()
    }

    fn set(&mut self, setter: &str, word: i32) {
        if let Err(escape) = self.drive.set(setter, word) {
            self.escape.get_or_insert(escape);
        }
    }
}

impl Subject for Interpreted<'_> {
    fn step(&mut self, sample: &Sample) -> Legs {
        let Sample {
            adc_a,
            adc_b,
            hall,
            hall_ticks,
        } = *sample;
        let words = [adc_a, adc_b, u16::from(hall), hall_ticks].map(i32::from);
        match self.drive.step(words) {
            Ok([compare, legs]) => Legs::new(
                compare.map(|word| word as u16),
                legs.map(|word| LegState::from_word(Word(word))),
            ),
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

    fn set_speed(&mut self, bits: i32) {
        self.set("set_speed", bits);
    }

    fn set_bus(&mut self, counts: u16) {
        self.set("set_bus", i32::from(counts));
    }

    fn reset(&mut self) {
        self.drive.reset();
    }

    fn calibrate(&mut self) {
        self.drive.calibrate();
    }

    fn precharge(&mut self) {
        self.drive.precharge();
    }

    fn fault(&self) -> Fault {
        Fault::from_word(Word(self.drive.fault()))
    }

    fn bus_is_stale(&self) -> bool {
        self.drive.bus_is_stale()
    }

    fn state_words(&self, words: &mut [i32]) {
        words.copy_from_slice(self.drive.state());
    }

    fn set_state_words(&mut self, words: &[i32]) {
        self.drive.state_mut().copy_from_slice(words);
    }
}
