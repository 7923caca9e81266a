//! Report of a failed comparison.

use super::stimulus::{Action, Stream};
use crate::Error;
use hexagen::Sample;
use std::fmt;

/// Failure of a bit-for-bit test.
#[derive(Clone, Debug, thiserror::Error)]
pub enum VerifyError {
    /// No model can be built from the drive's specification and formats.
    #[error("no reference model: {0}")]
    Model(#[from] Error),
    /// The drive's state words are not those of its specification.
    #[error("state words differ\n  drive: {found}\n  model: {expected}")]
    StateNames {
        /// The model's names.
        expected: String,
        /// The drive's names.
        found: String,
    },
    /// The results of a step differ.
    #[error("{0}")]
    Mismatch(Box<Mismatch>),
}

/// The first step after which drive and model differ.
#[derive(Clone, Debug)]
pub struct Mismatch {
    /// Number of the step, from 0.
    pub step: u64,
    /// Seed of the run.
    pub seed: u64,
    /// Kind of input.
    pub stream: Stream,
    /// Calls before the step.
    pub action: Option<Action>,
    /// The step's input.
    pub sample: Sample,
    /// All outputs and state words, equal or not.
    pub differences: Vec<Difference>,
}

/// One output or state word after the step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Name of the output or state word.
    pub name: String,
    /// Its value before the step, in both; `None` for outputs.
    pub before: Option<i32>,
    /// The drive's value.
    pub found: i32,
    /// The model's value.
    pub expected: i32,
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [adc_a, adc_b, adc_c] = self.sample.adc();
        let (hall, hall_ticks) = (self.sample.hall(), self.sample.ticks());
        writeln!(
            f,
            "step {} of seed {} ({:?} inputs) differs",
            self.step, self.seed, self.stream
        )?;
        if let Some(action) = self.action {
            writeln!(f, "  after {action:?}")?;
        }
        writeln!(
            f,
            "  adc_a = {adc_a}, adc_b = {adc_b}, adc_c = {adc_c}, hall = {hall:03b}, hall_ticks = {hall_ticks}"
        )?;
        writeln!(
            f,
            "  {:<16} {:>12} {:>12} {:>12}",
            "word", "before", "drive", "model"
        )?;
        for Difference {
            name,
            before,
            found,
            expected,
        } in &self.differences
        {
            let before = before.map(|word| word.to_string()).unwrap_or_default();
            let mark = if found == expected { "" } else { "  <--" };
            writeln!(
                f,
                "  {name:<16} {before:>12} {found:>12} {expected:>12}{mark}"
            )?;
        }
        Ok(())
    }
}
