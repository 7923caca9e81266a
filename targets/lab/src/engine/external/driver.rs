//! Runs an emitted drive on calls from stdin; the other end is `link.rs` of the `hexagen` program.

mod emitted {
    include!("emitted.rs");
}
use drive::TheDrive;
mod drive {
    include!("name.rs");
}

use hexagen::fixed::types::I16F16;
use hexagen::{Command, Drive, Sample};
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
    let mut state = vec![0; Drive::<TheDrive>::state_names().count()];
    let mut drive = Drive::<TheDrive>::new();
    let (mut batch, mut answers) = (Vec::new(), Vec::new());
    let mut length = [0; 4];
    while input.read_exact(&mut length).is_ok() {
        batch.resize(u32::from_le_bytes(length) as usize, 0);
        input.read_exact(&mut batch).expect("a whole batch");
        answers.clear();
        let mut calls = Calls(&batch);
        while !calls.0.is_empty() {
            match calls.bytes::<1>()[0] {
                0 => drive = Drive::new(),
                1 => {
                    let adc = [calls.half(), calls.half()];
                    let adc_c = calls.half();
                    let [hall] = calls.bytes();
                    let (ticks, angle) = (calls.half(), calls.word() as u32);
                    // A sample has either; the other is 0.
                    let sample = if angle == 0 {
                        Sample::with_hall(adc, hall).hall_ticks(ticks)
                    } else {
                        Sample::with_angle(adc, angle)
                    };
                    let command = drive.step(&sample.third_current(adc_c));
                    answers.extend(command.to_bits().to_le_bytes());
                    let status = drive.status();
                    answers.push(status.fault.map_or(0, |fault| fault as u8));
                    answers.push(u8::from(status.bus_is_stale));
                    drive.state_words(&mut state);
                    answers.extend(state.iter().flat_map(|word| word.to_le_bytes()));
                }
                2 => drive.set_current(I16F16::from_bits(calls.word())),
                3 => drive.set_torque(I16F16::from_bits(calls.word())),
                4 => drive.set_bus_counts(calls.half()),
                5 => drive.reset(),
                6 => drive.calibrate(),
                7 => drive.precharge(),
                9 => drive.set_speed_bits(calls.word()),
                10 => drive.coast(),
                11 => drive.brake(),
                12 => drive.resume(),
                _ => {
                    state.fill_with(|| calls.word());
                    drive.set_state_words(&state);
                }
            }
        }
        output.write_all(&answers).expect("the reader is running");
        output.flush().expect("the reader is running");
    }
}
