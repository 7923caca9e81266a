//! The recorded run of a drive: commands in closed loop on the simulated plant.

use crate::BenchError;
use crate::vectors::{Called, OnHost, Stretch, Stretches};
use hexagen::{Command as _, LegState, Sample};
use hexagen_firmware::wire::{Digest, Record};
use hexagen_lab::engine::Prepared;
use hexagen_reference::AnyCommand;
use std::fmt::Write as _;

/// Commands of a drive.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Commands {
    /// Steps of all stretches, start-up included.
    pub steps: usize,
    /// Steps that drive the motor: not all legs are off.
    pub driving: usize,
    /// Digest of all commands.
    pub digest: u64,
    /// For each stretch, half of the digest of its own commands.
    pub stretches: Vec<u32>,
}

/// A drive whose commands are passed to `note`.
struct Noting<'g, N> {
    host: OnHost<'g>,
    note: N,
}

impl<N: FnMut(Sample, AnyCommand)> Called for Noting<'_, N> {
    fn call(&mut self, record: Record) {
        self.host.call(record);
    }

    fn step(&mut self, sample: Sample) -> AnyCommand {
        let command = self.host.step(sample);
        (self.note)(sample, command);
        command
    }
}

/// Runs a drive through a stretch, from its initial state.
fn each_step(
    drive: &Prepared,
    stretch: &Stretch,
    note: impl FnMut(Sample, AnyCommand),
) -> Result<(), BenchError> {
    let host = OnHost::new(drive);
    stretch.close(drive, &mut Noting { host, note })
}

impl Commands {
    /// Runs whole stretches of at least `steps` steps in total.
    ///
    /// # Errors
    /// If the plant is invalid.
    pub fn of(drive: &Prepared, steps: usize) -> Result<Self, BenchError> {
        Self::through(steps, |stretch, note| each_step(drive, stretch, note))
    }

    /// Adds the stretches that `run` runs.
    fn through(
        steps: usize,
        mut run: impl FnMut(&Stretch, &mut dyn FnMut(Sample, AnyCommand)) -> Result<(), BenchError>,
    ) -> Result<Self, BenchError> {
        let mut commands = Self::default();
        let mut whole = Digest::default();
        let mut stretches = Stretches::default();
        while commands.steps < steps {
            let mut own = Digest::default();
            run(&stretches.draw(), &mut |_, command| {
                whole.command(command.to_bits());
                own.command(command.to_bits());
                commands.steps += 1;
                commands.driving += usize::from(command.state() != [LegState::Off; 3]);
            })?;
            commands.stretches.push(number(own) as u32);
        }
        commands.digest = number(whole);
        Ok(commands)
    }
}

/// A digest as a number, its first lane in the lower half.
fn number(digest: Digest) -> u64 {
    u64::from_le_bytes(digest.encode())
}

/// The samples and commands of a stretch, a line each.
///
/// # Errors
/// If the plant is invalid.
pub fn in_full(drive: &Prepared, place: usize) -> Result<String, BenchError> {
    let mut stretches = Stretches::default();
    let stretch = (0..place).fold(stretches.draw(), |_, _| stretches.draw());
    let mut text = String::from("step: adc_a adc_b hall ticks | command\n");
    let mut step = 0;
    each_step(drive, &stretch, |sample, command| {
        let [adc_a, adc_b, _] = sample.adc();
        let (hall, hall_ticks) = (sample.hall(), sample.ticks());
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{step}: {adc_a} {adc_b} {hall:03b} {hall_ticks} | {command:?}"
        );
        step += 1;
    })?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vectors::prepared;

    const STEPS: usize = 10_000;

    fn drive() -> Prepared {
        prepared("step_of_the_test", "trivedi-keshri-660w", "pdcc").expect("a drive")
    }

    #[test]
    fn the_same_drive_has_the_same_digest() {
        let drive = drive();
        let commands = Commands::of(&drive, STEPS).expect("a plant");
        assert!(commands.steps >= STEPS);
        assert!(commands.driving > STEPS / 2);
        assert_eq!(commands, Commands::of(&drive, STEPS).expect("a plant"));
    }

    /// The digests depend on every command.
    #[test]
    fn one_compare_count_changes_its_stretchs_digest_only() {
        const WRONG: usize = 7000;
        let drive = drive();
        let honest = Commands::of(&drive, STEPS).expect("a plant");
        let mut step = 0;
        let mut ends = vec![];
        let planted = Commands::through(STEPS, |stretch, note| {
            let outcome = each_step(&drive, stretch, |sample, command| {
                let bit = u64::from(step == WRONG) << 32;
                note(
                    sample,
                    AnyCommand::from_bits(command.to_bits() ^ bit, false),
                );
                step += 1;
            });
            ends.push(step);
            outcome
        })
        .expect("a plant");
        assert_ne!(planted.digest, honest.digest);
        let differing: Vec<usize> = (0..honest.stretches.len())
            .filter(|&place| planted.stretches[place] != honest.stretches[place])
            .collect();
        let wrong = ends.iter().position(|&end| WRONG < end).expect("in one");
        assert_eq!(differing, [wrong]);
    }
}
