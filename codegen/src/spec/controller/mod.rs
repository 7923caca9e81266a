//! The choice of controller and its options; a file per kind says what it takes and reads it.
//!
//! Adding a controller adds a file here, a variant to [`ControllerSpec`] and a row to [`KINDS`].

pub(crate) mod common;
pub(crate) mod fcs_mpc;
mod off_leg;
pub(crate) mod pdcc;
pub(crate) mod phcc;
pub(crate) mod pi_pwm;

pub use common::{Discretisation, EmfSource, LimitRule, LoopOptions, Reference, SpeedLoop};
pub use fcs_mpc::{Candidates, FcsMpcSpec};
pub use off_leg::OffLegModel;
pub use pdcc::{Modulation, PdccSpec};
pub use phcc::{PhccCandidates, PhccSpec, SwitchingTable};
pub use pi_pwm::PiPwmSpec;

/// The kinds of controllers, with the options that not all of them take.
pub const KINDS: [(&str, &[&str]); 4] = [
    (
        "fcs-mpc",
        &[
            "candidates",
            "horizon",
            "modulated",
            "off_leg",
            "switching_weight",
            "torque_weight",
        ],
    ),
    (
        "pdcc",
        &[
            "dead_time_compensation",
            "integral",
            "modulation",
            "saturation",
        ],
    ),
    ("phcc", &["band", "candidates", "off_leg", "table"]),
    (
        "pi-pwm",
        &[
            "bandwidth",
            "dead_time_compensation",
            "feed_forward",
            "integral_time",
            "modulation",
            "saturation",
            "six_step",
        ],
    ),
];

/// A controller and its options.
#[derive(Clone, Debug, PartialEq)]
pub enum ControllerSpec {
    /// Finite-control-set model predictive control.
    FcsMpc(FcsMpcSpec),
    /// Predictive deadbeat current control.
    Pdcc(PdccSpec),
    /// Predictive hysteresis current control.
    Phcc(PhccSpec),
    /// PI control with pulse-width modulation.
    PiPwm(PiPwmSpec),
}

impl ControllerSpec {
    /// The options that all controllers share.
    pub fn common(&self) -> &LoopOptions {
        match self {
            Self::FcsMpc(options) => &options.common,
            Self::Pdcc(options) => &options.common,
            Self::Phcc(options) => &options.common,
            Self::PiPwm(options) => &options.common,
        }
    }

    /// The same with words of so many bits.
    #[must_use]
    pub fn with_word(mut self, word: u32) -> Self {
        let common = match &mut self {
            Self::FcsMpc(options) => &mut options.common,
            Self::Pdcc(options) => &mut options.common,
            Self::Phcc(options) => &mut options.common,
            Self::PiPwm(options) => &mut options.common,
        };
        common.word = word;
        self
    }

    /// Whether it divides the period by pulse-width modulation, instead of applying one vector.
    pub fn modulates(&self) -> bool {
        match self {
            Self::FcsMpc(options) => options.modulated,
            Self::Pdcc(_) | Self::PiPwm(_) => true,
            Self::Phcc(_) => false,
        }
    }

    /// The name that the specification calls it by.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::FcsMpc(_) => "fcs-mpc",
            Self::Pdcc(_) => "pdcc",
            Self::Phcc(_) => "phcc",
            Self::PiPwm(_) => "pi-pwm",
        }
    }
}
