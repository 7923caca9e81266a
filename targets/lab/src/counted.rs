//! Cost of steps on a Cortex-M4: counted by `cargo xtask cost`, kept in a file beside the target.

use hexagen_codegen::timing::Times;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The figures of a target, the content of its `cost.toml`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counted {
    /// The compiler.
    pub compiler: String,
    /// Figures by symbol of the step function.
    pub steps: BTreeMap<String, Figures>,
}

/// Figures of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Figures {
    /// Instructions on the normal path.
    pub normal: u32,
    /// Those of the supervisor: the same as of a drive with an empty law. Only for drives in Rust.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supervision: Option<u32>,
    /// Instructions of the worst step in closed loop, except start-up and trips.
    pub worst: u32,
    /// Estimated cycles of the normal path.
    pub cycles: u32,
    /// Bytes of the function's own code.
    pub code: u32,
    /// Bytes of stack.
    pub stack: u32,
    /// Longest paths. Only for drives.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest: Option<Longest>,
}

/// Longest paths through the control-flow graph of a step and its callees, which no input exceeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Longest {
    /// Instructions of any step, start-up, calibration and trips included.
    pub instructions: u32,
    /// Instructions of a step that controls.
    pub instructions_in_control: u32,
    /// Cycles of any step at most, on the chip that `cargo xtask cost` names, at its highest clock.
    pub cycles: u32,
    /// Cycles of a step that controls.
    pub cycles_in_control: u32,
    /// Cycles of any step at most, without wait states.
    pub core_cycles: u32,
    /// Cycles of a step that controls, without wait states.
    pub core_cycles_in_control: u32,
}

impl Figures {
    /// Those that the generator tells of a step, if its longest paths are known.
    pub fn times(&self) -> Option<Times<u32>> {
        let longest = self.longest?;
        Some(Times {
            normal: self.normal,
            control: longest.instructions_in_control,
            control_core_cycles: longest.core_cycles_in_control,
            control_cycles: longest.cycles_in_control,
            any: longest.instructions,
            any_core_cycles: longest.core_cycles,
            any_cycles: longest.cycles,
        })
    }

    /// Estimated cycles of the worst step: its instructions times the cycles per instruction of the
    /// normal path.
    pub fn worst_cycles(&self) -> u32 {
        (self.worst * self.cycles).div_ceil(self.normal.max(1))
    }
}

/// Error of reading figures.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CountedError {
    /// The file is invalid.
    #[error("targets/cortex-m4/cost.toml: {0}")]
    File(#[from] toml::de::Error),
    /// The file has no such step.
    #[error(
        "targets/cortex-m4/cost.toml has no figures of {0}: count it with `cargo xtask cost --target cortex-m4 --accept`"
    )]
    Step(String),
}

impl Counted {
    /// Reads the text of a `cost.toml`.
    ///
    /// # Errors
    /// Errors of syntax, with their place.
    pub fn parse(text: &str) -> Result<Self, toml::de::Error> {
        toml::from_str(text)
    }

    /// The figures of the firmware for a Cortex-M4.
    ///
    /// # Errors
    /// If the file beside the target is invalid.
    pub fn on_cortex_m4() -> Result<Self, CountedError> {
        Ok(Self::parse(include_str!("../cortex-m4-cost.toml"))?)
    }

    /// The figures of a step function.
    ///
    /// # Errors
    /// If there are none.
    pub fn of_step(&self, symbol: &str) -> Result<Figures, CountedError> {
        let figures = self.steps.get(symbol).copied();
        figures.ok_or_else(|| CountedError::Step(symbol.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_names_the_unknown_step() {
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
            longest: None,
        };
        assert_eq!(figures.worst_cycles(), 392);
    }
}
