//! Generated code against the bit-true reference, on every output and state bit.

use crate::Progress;
use crate::engine::{EngineKind, Prepared, Verifier};
use hexagen_reference::verify::Report;
use rayon::prelude::*;
use serde::Serialize;
use std::time::Instant;

/// Steps of one run from the initial state; a longer check is many runs with seeds of their own.
const RUN: u64 = 1 << 19;

/// Bit-for-bit check of one drive.
#[derive(Clone, Debug, Serialize)]
pub struct Checked {
    /// Motor.
    pub motor: String,
    /// Controller variant.
    pub controller: String,
    /// Engine.
    pub engine: EngineKind,
    /// Why it was not compiled code, if so.
    #[serde(skip)]
    pub why_interpreted: Option<String>,
    /// Compared steps.
    pub steps: u64,
    /// Whether every output and state word was equal after every step.
    pub passed: bool,
    /// Steps per second and core.
    pub steps_per_second: f64,
    /// Coverage of the steps.
    pub coverage: Coverage,
    /// The difference, if any.
    pub mismatch: Option<String>,
}

/// The differences, a line for each drive; `None` if there are none.
pub fn mismatches(checked: &[Checked]) -> Option<String> {
    let differing = checked.iter().filter_map(|drive| {
        let mismatch = drive.mismatch.as_ref()?;
        Some(format!("{}, {}: {mismatch}", drive.motor, drive.controller))
    });
    let lines: Vec<String> = differing.collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

/// Number of steps by kind.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Coverage {
    /// In control.
    pub running: u64,
    /// Offset calibration under way.
    pub calibrating: u64,
    /// Bootstrap pre-charge under way.
    pub precharging: u64,
    /// A start under way, which waits for the rotor's angle.
    pub starting: u64,
    /// Tripped.
    pub tripped: u64,
    /// In control and limited to the hexagon.
    pub limited: u64,
    /// Of these, beyond the limit along the EMF (torque priority).
    pub past_reach: u64,
    /// In control with a commutation under way (modulation pair or table2, or whole vectors).
    pub commutating: u64,
    /// In control with an interpolated rotor angle.
    pub timed: u64,
    /// Of these, turning backward.
    pub backward: u64,
    /// Calls between steps.
    pub actions: u64,
}

impl From<&Report> for Coverage {
    fn from(report: &Report) -> Self {
        Self {
            running: report.running,
            calibrating: report.calibrating,
            precharging: report.precharging,
            starting: report.starting,
            tripped: report.tripped,
            limited: report.limited,
            past_reach: report.past_reach,
            commutating: report.commutating,
            timed: report.timed,
            backward: report.backward,
            actions: report.actions,
        }
    }
}

/// Compares each drive over `steps` steps; runs of all drives share the cores.
pub fn verify_drives(
    drives: &[Prepared],
    steps: u64,
    seed: u64,
    progress: &dyn Progress,
) -> Vec<Checked> {
    let verifiers: Vec<Verifier> = drives.par_iter().map(Prepared::verifier).collect();
    verify_with(drives, &verifiers, steps, seed, progress)
}

/// Like [`verify_drives`], with given engines.
pub fn verify_with(
    drives: &[Prepared],
    verifiers: &[Verifier<'_>],
    steps: u64,
    seed: u64,
    progress: &dyn Progress,
) -> Vec<Checked> {
    progress.begin("comparing bit for bit", steps * drives.len() as u64);
    let runs: Vec<(usize, u64, u64)> = (0..drives.len())
        .flat_map(|drive| {
            (0..steps.div_ceil(RUN)).map(move |run| (drive, run, RUN.min(steps - run * RUN)))
        })
        .collect();
    let outcomes: Vec<_> = runs
        .par_iter()
        .map(|&(drive, run, steps)| {
            let begin = Instant::now();
            let outcome = verifiers[drive].verify(steps, seed.wrapping_add(run));
            progress.advance(steps);
            (drive, outcome, begin.elapsed().as_secs_f64())
        })
        .collect();
    drives
        .iter()
        .enumerate()
        .map(|(index, drive)| {
            let mut report = Report::default();
            let (mut seconds, mut mismatch) = (0.0, None);
            for (_, outcome, took) in outcomes.iter().filter(|(drive, _, _)| *drive == index) {
                match outcome {
                    Ok(part) => {
                        report.add(part);
                        seconds += took;
                    }
                    Err(error) => {
                        mismatch.get_or_insert_with(|| error.clone());
                    }
                }
            }
            Checked {
                motor: drive.motor.clone(),
                controller: drive.variant.clone(),
                engine: verifiers[index].kind(),
                why_interpreted: verifiers[index].why_interpreted().map(ToString::to_string),
                steps: report.steps,
                passed: mismatch.is_none(),
                steps_per_second: if seconds > 0.0 {
                    report.steps as f64 / seconds
                } else {
                    0.0
                },
                coverage: Coverage::from(&report),
                mismatch,
            }
        })
        .collect()
}
