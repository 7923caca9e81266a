//! Options of predictive deadbeat current control.

use crate::controllers::LoopOptions;
use crate::lower::LimitRule;

/// How the deadbeat voltage becomes leg commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Modulation {
    /// Three duties in every period.
    ThreePhase,
    /// Three duties in commutation, else only the conducting pair is pulsed.
    Pair,
}

/// Options of predictive deadbeat current control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PdccSpec {
    /// Modulation.
    pub modulation: Modulation,
    /// Saturation rule.
    pub saturation: LimitRule,
    /// Options that all controllers share.
    pub common: LoopOptions,
}
