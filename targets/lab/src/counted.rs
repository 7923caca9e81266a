//! What steps cost on a Cortex-M4: `cargo xtask cost` counts it, a file beside the target keeps it.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The figures of a target, as its `cost.toml` keeps them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counted {
    /// What compiled the steps.
    pub compiler: String,
    /// Figures by symbol of the step function.
    pub steps: BTreeMap<String, Figures>,
}

/// Figures of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Figures {
    /// Instructions on the normal path.
    pub normal: u32,
    /// Those of them that are supervision: the same of a drive with an empty law. Of drives in Rust alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supervision: Option<u32>,
    /// Instructions of the worst step in closed loop; start-up and trips are none.
    pub worst: u32,
    /// Estimated cycles of the normal path.
    pub cycles: u32,
    /// Bytes of the function's own code.
    pub code: u32,
    /// Bytes of stack.
    pub stack: u32,
}

impl Figures {
    /// Estimated cycles of the worst step: its instructions, with the cycles per instruction of the normal path.
    pub fn worst_cycles(&self) -> u32 {
        (self.worst * self.cycles).div_ceil(self.normal.max(1))
    }
}

/// Figures that are not there.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CountedError {
    /// The file is not one of figures.
    #[error("targets/cortex-m4/cost.toml: {0}")]
    File(#[from] toml::de::Error),
    /// The file does not know the step.
    #[error(
        "targets/cortex-m4/cost.toml has no figures of {0}: count it with `cargo xtask cost --target cortex-m4 --accept`"
    )]
    Step(String),
}

impl Counted {
    /// Reads the text of a `cost.toml`.
    ///
    /// # Errors
    /// What is wrong in it, and where.
    pub fn parse(text: &str) -> Result<Self, toml::de::Error> {
        toml::from_str(text)
    }

    /// The figures of the firmware for a Cortex-M4.
    ///
    /// # Errors
    /// When the file beside the target is not one of figures.
    pub fn on_cortex_m4() -> Result<Self, CountedError> {
        Ok(Self::parse(include_str!("../cortex-m4-cost.toml"))?)
    }

    /// The figures of a step function.
    ///
    /// # Errors
    /// When there are none.
    pub fn of_step(&self, symbol: &str) -> Result<Figures, CountedError> {
        let figures = self.steps.get(symbol).copied();
        figures.ok_or_else(|| CountedError::Step(symbol.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_steps_are_named() {
        let counted = Counted::on_cortex_m4().expect("figures");
        assert!(counted.of_step("step_trivedi_keshri_660w_pdcc").is_ok());
        let error = counted.of_step("step_x").expect_err("there is none");
        assert!(
            error.to_string().contains("no figures of step_x"),
            "{error}"
        );
    }

    #[test]
    fn cycles_of_the_worst_step_are_rounded_up() {
        let figures = Figures {
            normal: 100,
            supervision: None,
            worst: 301,
            cycles: 130,
            code: 400,
            stack: 8,
        };
        assert_eq!(figures.worst_cycles(), 392);
    }
}
