//! Sections 9 to 11, which differ between controllers: from reference, current and EMF to the legs.

mod common_mode;
mod dead_time;
mod deadbeat;
mod divided;
mod fcs_mpc;
mod held;
mod intervals;
mod p_pwm;
mod pdcc;
pub mod phcc;
mod pi_pwm;
mod pulses;
mod scores;
mod two_steps;
mod weighted;
mod whole;

use super::constants::Constants;
use super::scale::Scale;
use crate::exact::{Coefficient, Word, word};
use crate::model::Reach;
use crate::model::trace::Past;
use crate::{AnyCommand, Controller, Error, Spec};

/// Results of the common sections. Pairs are phases a, b.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a, W> {
    pub k: &'a Constants<W>,
    pub v_bus: W,
    /// From volts of the measured bus to those of the nominal one.
    pub to_duty: &'a Coefficient<W>,
    pub j: [W; 2],
    pub i: [W; 2],
    /// Net voltage of the period that starts now, with delay 1: the applied one less the EMF.
    pub net: [W; 2],
    /// EMF in the target period.
    pub e: [W; 2],
    pub sector_eff: usize,
    pub commutating: bool,
    pub integral: [W; 2],
    /// Reference at the begin of the target period.
    pub j_begin: [W; 2],
    /// Reference at the sample.
    pub j_due: [W; 2],
    /// The set-point word itself.
    pub set_point: W,
    /// Sense of rotation, 1 or -1.
    pub direction: W,
    /// `h_a`, `h_b` (PHCC).
    pub hysteresis: [W; 2],
    /// `vector_prev` (FCS-MPC).
    pub vector_prev: usize,
    /// Contribution of past periods to the voltage (deadbeat with a held EMF).
    pub past: Past<W>,
}

/// Decision of a controller.
#[derive(Clone, Copy, Debug)]
pub struct Decision<W> {
    pub u_unsat: [W; 2],
    /// Limited to the inverter's range, or what the compare values make of that; becomes `v_x_cmd`.
    pub u: [W; 2],
    pub reach: Reach,
    /// Number of the chosen vector (controllers of whole vectors).
    pub vector: usize,
    pub command: Command<W>,
    /// `integral_x` (PI).
    pub integral: [W; 2],
    /// `h_a`, `h_b` (PHCC).
    pub hysteresis: [W; 2],
    /// Contribution of past periods to the voltage (deadbeat with a held EMF).
    pub past: Past<W>,
}

/// A command to the inverter and its terminal voltages.
#[derive(Clone, Copy, Debug)]
pub struct Command<W> {
    pub legs: AnyCommand,
    /// `t_a_cmd` to `t_c_cmd`, if a leg may be off.
    pub terminal: [W; 3],
    /// `off_cmd`: 0 none, 1 to 3 leg a, b, c.
    pub off: usize,
}

impl<W: Word> Command<W> {
    /// All legs in the same state, without any voltage.
    pub fn idle(legs: impl Into<AnyCommand>) -> Self {
        Self {
            legs: legs.into(),
            terminal: [word(0.0); 3],
            off: 0,
        }
    }
}

/// The controller's own part of the step.
#[derive(Clone, Debug)]
pub enum Law<W> {
    Pdcc(pdcc::Pdcc<W>),
    FcsMpc(fcs_mpc::FcsMpc<W>),
    Phcc(Box<phcc::Phcc<W>>),
    PiPwm(pi_pwm::PiPwm<W>),
    PPwm(p_pwm::PPwm<W>),
}

impl<W: Word> Law<W> {
    pub fn new(spec: &Spec, scale: &Scale) -> Result<Self, Error> {
        Ok(match &spec.controller {
            Controller::Pdcc(options) => Self::Pdcc(pdcc::Pdcc::new(spec, options, scale)?),
            Controller::FcsMpc(options) => {
                Self::FcsMpc(fcs_mpc::FcsMpc::new(spec, options, scale)?)
            }
            Controller::Phcc(options) => {
                Self::Phcc(Box::new(phcc::Phcc::new(spec, options, scale)?))
            }
            Controller::PiPwm(options) => Self::PiPwm(pi_pwm::PiPwm::new(spec, options, scale)?),
            Controller::PPwm(options) => Self::PPwm(p_pwm::PPwm::new(spec, options, scale)?),
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs<W>) -> Decision<W> {
        match self {
            Self::Pdcc(law) => law.decide(now),
            Self::FcsMpc(law) => law.decide(now),
            Self::Phcc(law) => law.decide(now),
            Self::PiPwm(law) => law.decide(now),
            Self::PPwm(law) => law.decide(now),
        }
    }
}
