//! Options of predictive deadbeat current control.

use crate::design::Discretisation;

/// How the deadbeat voltage becomes leg commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Modulation {
    /// Three duties in every period.
    ThreePhase,
    /// Three duties in commutation, else only the conducting pair is pulsed.
    Pair,
}

/// What gives way when the voltage lies outside the hexagon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Saturation {
    /// Scale to the edge.
    KeepAngle,
    /// Nearest point of the hexagon.
    Nearest,
    /// Keep the component along the EMF, clip the rest.
    TorquePriority,
}

/// Where the EMF comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmfSource {
    /// From the last period's voltage and currents.
    Estimated,
    /// From the motor's EMF shape at the Hall angle and speed.
    Model,
}

/// What the currents shall follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// The sector's corner.
    QuasiSquare,
    /// Parallel to the EMF: constant torque at least copper loss.
    Proportional,
}

/// Options of predictive deadbeat current control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PdccSpec {
    /// Modulation.
    pub modulation: Modulation,
    /// Saturation rule.
    pub saturation: Saturation,
    /// EMF source.
    pub emf: EmfSource,
    /// Weight of the new estimate in the EMF filter, above 0 to 1 (1: no filter).
    pub emf_filter: f64,
    /// Current reference.
    pub reference: Reference,
    /// Phase advance, periods of electrical angle, 0 to 2.
    pub advance: f64,
    /// Periods between sampling and the command's effect: 0 or 1.
    pub delay: u32,
    /// Discretisation of the plant.
    pub discretisation: Discretisation,
    /// Word length of the control arithmetic, 16 or 32 bits.
    pub word: u32,
    /// Outgoing current below which a commutation ends, ampere.
    pub commutation_threshold: f64,
    /// Periods after which a commutation is taken as ended, 1 to 255.
    pub commutation_timeout: u32,
}
