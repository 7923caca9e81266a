//! Signals of a model's last step, and the state that one model copies from another, in physical
//! units.

use super::hall::HallTiming;
use super::ideal::hall_learning::PlacedEdges;
use super::ideal::torque_learning::LearntTorque;
use super::supervision::Supervisor;

/// Signals of the last step. Pairs are phases a, b; phase c is minus their sum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trace {
    /// Measured currents, ampere.
    pub i: [f64; 2],
    /// EMF in the target period, volt.
    pub e: [f64; 2],
    /// Net voltage of the period that starts now, the applied one less the EMF, volt (0 if the variant does not use it).
    pub net: [f64; 2],
    /// Demanded voltage before limiting, volt (PHCC: 1/b times the predicted error).
    pub u_unsat: [f64; 2],
    /// The same after limiting, or that of the chosen vector, volt; the bit-true one as rounded to compare values, where
    /// the prediction knows that.
    pub u: [f64; 2],
    /// Electrical angle at the sample, radians (0 where the variant has no angle).
    pub theta: f64,
    /// Electrical angle per period, radians, signed.
    pub step_angle: f64,
    /// Sector of reference and commutation.
    pub sector_eff: usize,
    /// A commutation is in progress (if tracked).
    pub commutating: bool,
    /// Position of the demanded voltage (controllers of whole vectors: inside).
    pub reach: Reach,
    /// Number of the chosen vector (0 out of control and for controllers that pulse).
    pub vector: usize,
    /// The drive is in control (neither tripped nor starting).
    pub run: bool,
}

/// Position of a voltage relative to the inverter's hexagon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reach {
    /// Inside: nothing was limited.
    #[default]
    Inside,
    /// Outside: the saturation rule decided.
    Outside,
    /// So far outside that not even its component along the EMF fits (torque priority only).
    PastReach,
}

/// Contributions of past samples and commands to the voltages of the next two steps, phases a, b
/// (deadbeat with a held EMF).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Past<W = f64> {
    /// To this step's.
    pub due: [W; 2],
    /// To the next one's.
    pub later: [W; 2],
}

/// A controller's whole state in physical units.
///
/// Fields that the variant at hand does not use are at their initial values.
#[derive(Clone, Copy, Debug, Default)]
pub struct PhysicalState {
    pub(super) supervisor: Supervisor,
    pub(super) timing: HallTiming,
    pub(super) sector_prev: usize,
    pub(super) sector_eff_prev: usize,
    /// Remaining samples of a commutation, the last one included.
    pub(super) commutation_left: f64,
    /// ADC offsets, counts.
    pub offset: [f64; 3],
    /// Currents of phases a, b at the last sample, ampere.
    pub i_prev: [f64; 2],
    /// Voltage that the last step commanded (no leg ever off), phases a, b, volt.
    pub v_cmd: [f64; 2],
    /// Terminal voltages that the last step commanded (a leg may be off), phases a, b, c, volt.
    pub t_cmd: [f64; 3],
    /// The leg that the last step turned off.
    pub off_cmd: Option<usize>,
    /// Voltage applied in the period that ends with the next sample, phases a, b, volt.
    pub v_prev: [f64; 2],
    /// The leg that was off in the period that ends with the next sample.
    pub off_prev: Option<usize>,
    /// EMF expected of the period that ends with the next sample, phases a, b, volt.
    pub e_prev: [f64; 2],
    /// EMF expected of the period that begins with the next sample, phases a, b, volt.
    pub e_next: [f64; 2],
    /// Net voltage of the last period, volt.
    pub net_prev: [f64; 2],
    /// Net voltage that the last step expected for the period that begins now, volt.
    pub net_next: [f64; 2],
    /// Error of the modelled EMF: q along the proportional current, d across it over sqrt(3), volt.
    pub emf_error: [f64; 2],
    /// Angle per period at the last sample, radians, signed.
    pub(super) step_angle: f64,
    /// Where the Hall edges stand, as learnt.
    pub(super) learnt: PlacedEdges,
    /// Angle of the reference against the field, electrical turns.
    pub weakening: f64,
    /// Periods in which the currents did not follow the voltages, less those in which they did.
    pub residual_count: f64,
    /// The torque constant, as learnt.
    pub(super) torque: LearntTorque,
    /// Integral part of the voltage (PI), phases a, b, volt.
    pub integral: [f64; 2],
    /// Reference at the end of the period that begins with the next sample as a voltage (PI that turns it),
    /// phases a, b, volt.
    pub j_next: [f64; 2],
    /// The same at the next sample.
    pub j_due: [f64; 2],
    /// Whether the components along a and across it are to rise (PHCC); `None` before the first
    /// sample in control.
    pub rises: [Option<bool>; 2],
    /// Number of the vector that the last step chose (FCS-MPC with a switching weight).
    pub vector_prev: usize,
    /// Contribution of past periods to the voltage, volt.
    pub past: Past,
    /// Integral of the speed controller, ampere.
    pub speed_integral: f64,
    /// Speed set-point in force with an acceleration limit, mechanical rad/s.
    pub speed_in_force: f64,
    /// 1 once controlled, 2 once the speed is known.
    pub ramp_begun: f64,
    /// Set-point in force with a slew rate, ampere.
    pub current_in_force: f64,
    /// By how much the bus current limits the set-point below the largest, ampere.
    pub current_withheld: f64,
    /// Duties of phases a and b less that of phase c, of the last step's command.
    pub line_cmd: [f64; 2],
    /// The same in the period that ends with the next sample.
    pub line_ended: [f64; 2],
    /// Mean bus current, ampere.
    pub bus_current: f64,
}

impl PhysicalState {
    /// Stated over learnt torque constant; 1 where nothing is learnt.
    pub fn torque_ratio(&self) -> f64 {
        self.torque.ratio
    }
}
