//! The controllers: one folder each, with its options and lowering, around the step that all share.
//!
//! Adding a controller adds a folder here, a variant to [`ControllerSpec`] and a row to `KINDS`.

pub mod current_loop;
pub mod fcs_mpc;
mod interface;
pub mod pdcc;
pub mod phcc;
pub mod pi_pwm;
mod whole_vectors;

pub use current_loop::{EmfSource, LoopOptions, Reference, StableRange};
pub use interface::{Law, interface};
pub use whole_vectors::OffLegModel;

use crate::spec::Spec;
use current_loop::{LinearLoop, LoopDesign};

/// The ranges of true over stated R and L within which a linear loop is stable, with exact coefficients;
/// none for a controller that is no linear loop.
pub fn stable_range(spec: &Spec) -> Option<StableRange> {
    let design = &LoopDesign::new(spec, spec.controller.common());
    match &spec.controller {
        ControllerSpec::FcsMpc(_) | ControllerSpec::Phcc(_) => None,
        ControllerSpec::Pdcc(pdcc) => {
            let options = &pdcc.common;
            Some(pdcc::DeadbeatLoop { options, design }.stable_range(spec))
        }
        ControllerSpec::PiPwm(options) => Some(
            pi_pwm::PiLoop {
                options,
                design,
                spec,
            }
            .stable_range(spec),
        ),
    }
}

/// The kinds of controllers, with the options that not all of them take.
pub const KINDS: [(&str, &[&str]); 4] = [
    ("fcs-mpc", &["candidates", "off_leg"]),
    ("pdcc", &["modulation", "saturation"]),
    ("phcc", &["band", "candidates", "off_leg", "table"]),
    (
        "pi-pwm",
        &[
            "bandwidth",
            "feed_forward",
            "integral_time",
            "modulation",
            "saturation",
        ],
    ),
];

/// A controller and its options.
#[derive(Clone, Debug, PartialEq)]
pub enum ControllerSpec {
    /// Finite-control-set model predictive control.
    FcsMpc(fcs_mpc::FcsMpcSpec),
    /// Predictive deadbeat current control.
    Pdcc(pdcc::PdccSpec),
    /// Predictive hysteresis current control.
    Phcc(phcc::PhccSpec),
    /// PI control with pulse-width modulation.
    PiPwm(pi_pwm::PiPwmSpec),
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

    /// Whether it divides the period by pulse-width modulation, instead of applying one vector.
    pub fn modulates(&self) -> bool {
        matches!(self, Self::Pdcc(_) | Self::PiPwm(_))
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
