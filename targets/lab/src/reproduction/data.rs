//! The experiment as data: four methods, each in two readings of the paper.

use super::timing::Times;
use crate::closed_loop::{FiguresOfMerit, SpeedLimit, Trace, Trip};
use crate::counted::Figures as StepCost;
use hexagen_codegen::spec::{InverterSpec, MotorSpec};

/// The paper's methods, (a) to (d) of its figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Finite-control-set model predictive control.
    FcsMpc,
    /// Predictive deadbeat current control.
    Pdcc,
    /// Predictive hysteresis current control.
    Phcc,
    /// PI control with pulse-width modulation.
    PiPwm,
}

impl Method {
    /// All of them, in the paper's order.
    pub const ALL: [Self; 4] = [Self::FcsMpc, Self::Pdcc, Self::Phcc, Self::PiPwm];

    /// Its name in the paper.
    pub fn name(self) -> &'static str {
        match self {
            Self::FcsMpc => "FCS-MPC",
            Self::Pdcc => "PDCC",
            Self::Phcc => "PHCC",
            Self::PiPwm => "PI-PWM",
        }
    }

    /// Its letter in the paper's figures.
    pub fn letter(self) -> char {
        match self {
            Self::FcsMpc => 'a',
            Self::Pdcc => 'b',
            Self::Phcc => 'c',
            Self::PiPwm => 'd',
        }
    }

    /// Its index in [`Self::ALL`].
    pub fn index(self) -> usize {
        self as usize
    }
}

/// Reading of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// Equations and tables as printed, as far as a drive can implement them.
    Literal,
    /// With the errata corrected.
    Corrected,
}

impl Reading {
    /// Both readings.
    pub const ALL: [Self; 2] = [Self::Literal, Self::Corrected];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Literal => "literal",
            Self::Corrected => "corrected",
        }
    }
}

/// Contents of the page.
#[derive(Clone, Debug)]
pub struct Reproduction {
    /// Program and version: "hexagen 0.1.0".
    pub generator: String,
    /// The motor.
    pub motor: MotorSpec,
    /// Inverter, timer and sensors.
    pub inverter: InverterSpec,
    /// Demanded torque in newton metres.
    pub torque: f64,
    /// Amplitude in amperes of the quasi-square reference that gives this torque.
    pub current: f64,
    /// The two speeds in rpm, ascending.
    pub speeds_rpm: [f64; 2],
    /// The runs, methods in the paper's order.
    pub methods: [BothReadings; 4],
    /// The drives that go beyond the paper.
    pub improvements: Vec<Improved>,
    /// Switching tables of PHCC.
    pub tables: SwitchingTables,
}

/// The two drives of a method.
#[derive(Clone, Debug)]
pub struct BothReadings {
    /// Literal reading.
    pub literal: Run,
    /// Corrected reading.
    pub corrected: Run,
}

impl BothReadings {
    /// The drive of a reading.
    pub fn of(&self, reading: Reading) -> &Run {
        match reading {
            Reading::Literal => &self.literal,
            Reading::Corrected => &self.corrected,
        }
    }
}

/// A drive that goes beyond the paper.
#[derive(Clone, Debug)]
pub struct Improved {
    /// What it does otherwise, in a sentence.
    pub about: &'static str,
    /// Its results.
    pub run: Run,
}

/// One drive with its results.
#[derive(Clone, Debug)]
pub struct Run {
    /// The variant text that selects it.
    pub variant: String,
    /// Its engine: "compiled" or "interpreter".
    pub engine: &'static str,
    /// At each of [`Reproduction::speeds_rpm`].
    pub points: [Point; 2],
    /// Mean torque over speed: rpm and newton metres, ascending.
    pub curve: Vec<(f64, f64)>,
    /// Constant-torque speed limit.
    pub limit: SpeedLimit,
    /// Cost of a step on a Cortex-M4.
    pub cost: StepCost,
}

impl Run {
    /// Cost of a usual step; `None` for a drive that trips, as most of its counted steps are
    /// without control.
    fn usual(&self) -> Option<StepCost> {
        let has_tripped = self.points.iter().any(|point| point.trip.is_some());
        (!has_tripped).then_some(self.cost)
    }

    /// Instructions of a usual step.
    pub fn usual_instructions(&self) -> Option<u32> {
        self.usual().map(|cost| cost.normal)
    }

    /// Cycles of a usual step.
    pub fn usual_cycles(&self) -> Option<u32> {
        self.usual().map(|cost| cost.cycles)
    }

    /// Times of a step in a control period `t_s`, seconds.
    pub fn times(&self, t_s: f64) -> Times {
        Times::of(&self.cost, self.usual_cycles(), t_s)
    }
}

/// Results of a drive at one speed.
#[derive(Clone, Debug)]
pub struct Point {
    /// Speed in rpm.
    pub rpm: f64,
    /// Figures of merit over all starts.
    pub figures: FiguresOfMerit,
    /// RMS distance of the current from the ideal hexagon's outline in amperes, mean of the starts.
    pub hexagon_rms_a: f64,
    /// Record of the first start.
    pub trace: Trace,
    /// The trip of the first start that tripped.
    pub trip: Option<Trip>,
}

/// Forward motoring rows of PHCC's switching table, per sector: vector numbers by
/// 4 commutating + 2 H_a + H_b. 0 is V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 the zero
/// vector of the sector's pair with its third leg off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SwitchingTables {
    /// Derived from the vectors' geometry.
    pub derived: [[u8; 8]; 6],
    /// The printed row of sector 1, turned through the sectors.
    pub printed: [[u8; 8]; 6],
}
