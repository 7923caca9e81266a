//! The goals: what an expert reaches by hand, function entry to return, for the 660 W motor.

use crate::targets::Target;

/// Instructions that the supervision inside a step (ADC range, trip level, leg states) may cost besides.
pub const SUPERVISION: u32 = 6;

/// A goal of one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Goal {
    /// Instructions on the normal path, without supervision.
    pub normal: u32,
    /// Instructions on the saturating path.
    pub worst: Option<u32>,
    /// Bytes of code.
    pub code: Option<u32>,
    /// Bytes of stack.
    pub stack: Option<u32>,
}

/// The goal of a step function; of some there is none.
pub fn goal(target: Target, symbol: &str) -> Option<Goal> {
    let variant = symbol.strip_prefix("step_trivedi_keshri_660w_");
    if symbol == "interrupt_trivedi_keshri_660w_pdcc" && target == Target::CortexM4 {
        return Some(Goal {
            normal: 80,
            worst: None,
            code: None,
            stack: None,
        });
    }
    let (m4, worst, m0, rv32) = match variant? {
        "pdcc_keep_angle" => (54, Some(79), Some(90), Some(63)),
        "fcs_mpc_three_phase" => (43, None, Some(67), Some(60)),
        "fcs_mpc_table2" => (72, None, None, None),
        "phcc_three_phase" => (49, None, Some(55), Some(50)),
        "pi_pwm_keep_angle" => (51, Some(80), Some(86), Some(62)),
        _ => return None,
    };
    let (normal, worst, code, stack) = match target {
        Target::CortexM4 => (m4, worst, Some(250), Some(32)),
        Target::CortexM0 => (m0?, None, None, Some(56)),
        Target::Riscv32 => (rv32?, None, None, None),
    };
    Some(Goal {
        normal,
        worst,
        code,
        stack,
    })
}

impl Goal {
    /// Whether the instructions are within the goal, supervision allowed for.
    pub fn is_met(&self, normal: u32, worst: u32) -> bool {
        normal <= self.normal + SUPERVISION
            && self.worst.is_none_or(|limit| worst <= limit + SUPERVISION)
    }
}
