//! Runs an emitted drive on calls from stdin; `link.rs` of the `hexagen` program is the other end.

mod emitted {
    include!("emitted.rs");
}
use drive::TheDrive;
mod drive {
    include!("name.rs");
}

use hexagen::fixed::types::I16F16;
use hexagen::{Drive, Sample};
use std::io::{Read, Write};

struct Calls<'a>(&'a [u8]);

impl Calls<'_> {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let (taken, rest) = self.0.split_first_chunk::<N>().expect("a whole record");
        self.0 = rest;
        *taken
    }

    fn word(&mut self) -> i32 {
        i32::from_le_bytes(self.bytes())
    }

    fn half(&mut self) -> u16 {
        u16::from_le_bytes(self.bytes())
    }
}

fn main() {
    let (mut input, mut output) = (std::io::stdin().lock(), std::io::stdout().lock());
    let mut state = vec![0; TheDrive::STATE_NAMES.len()];
    let mut drive = <TheDrive as Drive>::new();
    let (mut batch, mut answers) = (Vec::new(), Vec::new());
    let mut length = [0; 4];
    while input.read_exact(&mut length).is_ok() {
        batch.resize(u32::from_le_bytes(length) as usize, 0);
        input.read_exact(&mut batch).expect("a whole batch");
        answers.clear();
        let mut calls = Calls(&batch);
        while !calls.0.is_empty() {
            match calls.bytes::<1>()[0] {
                0 => drive = <TheDrive as Drive>::new(),
                1 => {
                    let sample = Sample {
                        adc_a: calls.half(),
                        adc_b: calls.half(),
                        hall: calls.bytes::<1>()[0],
                        hall_ticks: calls.half(),
                    };
                    let legs = Drive::step(&mut drive, &sample);
                    for compare in legs.compare() {
                        answers.extend(compare.to_le_bytes());
                    }
                    answers.extend(legs.state().map(|state| state as u8));
                    answers.push(Drive::fault(&drive) as u8);
                    answers.push(u8::from(Drive::status(&drive).bus_is_stale));
                    Drive::state_words(&drive, &mut state);
                    answers.extend(state.iter().flat_map(|word| word.to_le_bytes()));
                }
                2 => Drive::set_current(&drive, I16F16::from_bits(calls.word())),
                3 => Drive::set_torque(&drive, I16F16::from_bits(calls.word())),
                4 => Drive::set_bus(&drive, calls.half()),
                5 => Drive::reset(&mut drive),
                6 => Drive::calibrate(&mut drive),
                7 => Drive::precharge(&mut drive),
                9 => Drive::set_speed(&drive, I16F16::from_bits(calls.word())),
                _ => {
                    for index in 0..state.len() {
                        let word = calls.word();
                        Drive::set_state_word(&mut drive, index, word);
                    }
                }
            }
        }
        output.write_all(&answers).expect("the reader is there");
        output.flush().expect("the reader is there");
    }
}
