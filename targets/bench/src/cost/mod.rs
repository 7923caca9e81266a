//! What a step costs: instructions, code, tables, state and stack.

use crate::BenchError;
use crate::firmware::Firmware;
use crate::listing::Listed;
use crate::targets::Target;
use crate::vectors::{Recorder, Stretch, drive_of};
use hexagen_firmware::wire::{Mode, Task};
use rayon::prelude::*;

/// What to count.
#[derive(Debug, clap::Args)]
pub struct Options {
    /// Only drives whose symbol contains this
    #[arg(long)]
    pub only: Option<String>,
}

/// Counts every drive of every target.
///
/// # Errors
/// When a tool is missing, or a figure rose.
pub fn run(targets: &[Target], options: &Options) -> Result<(), BenchError> {
    for &target in targets {
        let firmware = Firmware::build(target)?;
        let mut drives = firmware.drives()?;
        if let Some(part) = &options.only {
            drives.retain(|drive| drive.symbol.contains(part));
        }
        let counted: Vec<_> = drives
            .par_iter()
            .map(|listed| count(&firmware, listed))
            .collect::<Result<_, BenchError>>()?;
        for (listed, counts) in drives.iter().zip(counted) {
            println!(
                "{:60} normal {} worst {} stack {}",
                listed.symbol, counts.normal, counts.worst, counts.stack
            );
        }
    }
    Ok(())
}

struct Counts {
    normal: u16,
    worst: u16,
    stack: u32,
}

fn count(firmware: &Firmware, listed: &Listed) -> Result<Counts, BenchError> {
    let drive = drive_of(listed)?;
    let mut recorder = Recorder::new(&drive, None);
    let share = drive.spec.motor.rated_current / drive.spec.inverter.max_current;
    let normal = Stretch {
        starts_up: false,
        speed: 0.5,
        currents: [share, share],
        steps: 2000,
    };
    recorder.closed_loop(&drive, &normal)?;
    let settled = 1000..2000;
    recorder.closed_loop(
        &drive,
        &Stretch {
            speed: 1.2,
            ..normal
        },
    )?;
    recorder.closed_loop(
        &drive,
        &Stretch {
            speed: -0.5,
            ..normal
        },
    )?;
    let vectors = recorder.finish();
    let task = Task {
        mode: Mode::Count,
        drive: listed.place,
        block: 0,
    };
    let answers = firmware.run(&task, &vectors.records)?;
    let counts: Vec<u16> = answers
        .chunks_exact(2)
        .map(|b| u16::from_le_bytes([b[0], b[1]]))
        .collect();
    let mut sorted = counts[settled].to_vec();
    sorted.sort_unstable();
    let stack = firmware.run(
        &Task {
            mode: Mode::Stack,
            ..task
        },
        &vectors.records,
    )?;
    let stack = u32::from_le_bytes([stack[0], stack[1], stack[2], stack[3]]);
    Ok(Counts {
        normal: sorted[sorted.len() / 2],
        worst: counts.iter().copied().max().unwrap_or(0),
        stack,
    })
}
