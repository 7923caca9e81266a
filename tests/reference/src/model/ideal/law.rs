//! Sections 9 to 11, which differ between controllers: from reference, current and EMF to the legs.

mod common_mode;
mod dead_time;
mod deadbeat;
mod divided;
mod fcs_mpc;
mod held;
mod intervals;
mod off_leg;
mod p_pwm;
mod pdcc;
mod phcc;
mod pi_pwm;
mod pulses;
mod whole;

use super::Duties;
use crate::model::Reach;
use crate::model::trace::Past;
use crate::{Controller, DiscretePhase, Error, Spec};
use nalgebra::{Vector2, Vector3};

/// Results of the common sections; vectors are alpha-beta.
#[derive(Clone, Copy, Debug)]
pub struct Inputs {
    pub phase: DiscretePhase,
    pub delayed: bool,
    pub v_bus: f64,
    pub i_ref: Vector2<f64>,
    pub i: Vector2<f64>,
    /// Net voltage of the period that starts now, with delay 1: the applied one less the EMF.
    pub net: Vector2<f64>,
    /// EMF in the target period.
    pub e: Vector2<f64>,
    pub sector_eff: usize,
    pub commutating: bool,
    pub integral: Vector2<f64>,
    /// Reference at the begin of the target period.
    pub i_begin: Vector2<f64>,
    /// Reference at the sample.
    pub i_due: Vector2<f64>,
    /// The current set-point itself, ampere.
    pub set_point: f64,
    /// Sense of rotation, 1 or -1.
    pub direction: f64,
    /// Whether the components are to rise (PHCC); `None` before the first sample in control.
    pub rises: [Option<bool>; 2],
    /// Number of the last step's vector (FCS-MPC).
    pub vector_prev: usize,
    /// Whether deadbeat control holds the EMF of the last period.
    pub emf_is_held: bool,
    /// Contribution of past periods to the voltage (deadbeat with a held EMF).
    pub past: Past,
}

/// Decision of a controller; voltages of the zero-sum phases.
#[derive(Clone, Copy, Debug)]
pub struct Decision {
    pub u_unsat: Vector2<f64>,
    /// Limited to the inverter's range.
    pub u: Vector2<f64>,
    pub reach: Reach,
    /// Number of the chosen vector (controllers of whole vectors).
    pub vector: usize,
    pub command: Command,
    /// Integral part of the voltage (PI), phases a, b.
    pub integral: [f64; 2],
    /// Whether the components are to rise (PHCC); `None` before the first sample in control.
    pub rises: [Option<bool>; 2],
    /// Contribution of past periods to the voltage (deadbeat with a held EMF).
    pub past: Past,
}

/// State of the inverter in one period.
#[derive(Clone, Copy, Debug)]
pub struct Command {
    pub duties: Duties,
    /// Terminal voltages, volt.
    pub terminal: Vector3<f64>,
    pub off: Option<usize>,
}

impl Command {
    /// All legs in the same state, without any voltage.
    pub fn idle(duties: Duties) -> Self {
        Self {
            duties,
            terminal: Vector3::zeros(),
            off: None,
        }
    }
}

/// The controller's own part of the step.
#[derive(Clone, Debug)]
pub enum Law {
    Pdcc(pdcc::Pdcc),
    FcsMpc(fcs_mpc::FcsMpc),
    Phcc(Box<phcc::Phcc>),
    PiPwm(pi_pwm::PiPwm),
    PPwm(p_pwm::PPwm),
}

impl Law {
    pub fn new(spec: &Spec) -> Result<Self, Error> {
        Ok(match &spec.controller {
            Controller::Pdcc(options) => Self::Pdcc(pdcc::Pdcc::new(spec, options)?),
            Controller::FcsMpc(options) => Self::FcsMpc(fcs_mpc::FcsMpc::new(spec, options)?),
            Controller::Phcc(options) => Self::Phcc(Box::new(phcc::Phcc::new(spec, options)?)),
            Controller::PiPwm(options) => Self::PiPwm(pi_pwm::PiPwm::new(spec, options)?),
            Controller::PPwm(options) => Self::PPwm(p_pwm::PPwm::new(spec, options)?),
        })
    }

    pub fn decide(&self, now: &Inputs) -> Decision {
        match self {
            Self::Pdcc(law) => law.decide(now),
            Self::FcsMpc(law) => law.decide(now),
            Self::Phcc(law) => law.decide(now),
            Self::PiPwm(law) => law.decide(now),
            Self::PPwm(law) => law.decide(now),
        }
    }
}
