//! A time interval between two events, with the exact solution on it.

use super::roots::evaluate;
use super::short::Detour;

/// Coefficients kept of each Taylor series.
pub const TERMS: usize = 16;

/// Taylor coefficients in time from the segment's start, lowest first.
pub type Series = [f64; TERMS];

/// Connection of a leg's terminal during a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Terminal {
    /// A switch or a diode connects the leg to a rail.
    Rail {
        /// Terminal voltage against the negative rail, diode drop included.
        volts: f64,
        /// Whether it is the positive rail.
        upper: bool,
        /// Whether a diode conducts, not a switch.
        diode: bool,
    },
    /// Nothing conducts: the leg floats at e + v_n.
    Floating,
}

/// The plant's solution on `[0, duration]` seconds after `start`.
///
/// Series are valid in their first `terms` coefficients; the rest is undefined.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Absolute start time in seconds.
    pub start: f64,
    /// Start time from the beginning of the control period in seconds.
    pub offset: f64,
    /// Length in seconds.
    pub duration: f64,
    /// Number of valid coefficients.
    pub terms: usize,
    /// Phase currents in amperes, positive into the motor.
    pub current: [Series; 3],
    /// Phase EMF per mechanical speed in V s/rad, which is also the torque per ampere.
    pub shape: [Series; 3],
    /// Number of coefficients of `shape` that may differ from zero, at most `terms`.
    pub shape_terms: usize,
    /// Torque (sum of e_x i_x / omega_m) in newton metres.
    pub torque: Series,
    /// Voltage of the star point against the negative rail in volts.
    pub neutral: Series,
    /// Connections of the three terminals.
    pub terminal: [Terminal; 3],
    /// How a short changes the legs' currents.
    pub(super) detour: Detour,
    /// Electrical angle at the start in radians.
    pub theta_e: f64,
    /// Electrical speed in rad/s, constant over the segment.
    pub omega_e: f64,
    /// Mechanical speed in rad/s, constant over the segment.
    pub omega_m: f64,
}

impl Default for Segment {
    fn default() -> Self {
        Self {
            start: 0.0,
            offset: 0.0,
            duration: 0.0,
            terms: 1,
            current: [[0.0; TERMS]; 3],
            shape: [[0.0; TERMS]; 3],
            shape_terms: 1,
            torque: [0.0; TERMS],
            neutral: [0.0; TERMS],
            terminal: [Terminal::Floating; 3],
            detour: Detour::None,
            theta_e: 0.0,
            omega_e: 0.0,
            omega_m: 0.0,
        }
    }
}

impl Segment {
    /// Phase currents in amperes at `t` seconds after the start.
    pub fn currents_at(&self, t: f64) -> [f64; 3] {
        // Three Horner schemes in parallel: none waits for another.
        let [a, b, c] = self.current.each_ref().map(|series| &series[..self.terms]);
        let mut sums = [0.0; 3];
        for ((a, b), c) in a.iter().zip(b).zip(c).rev() {
            sums = [sums[0] * t + a, sums[1] * t + b, sums[2] * t + c];
        }
        sums
    }

    /// Currents in amperes of the inverter's legs at `t` seconds after the start: the phases', and
    /// that of a short.
    pub fn leg_currents_at(&self, t: f64) -> [f64; 3] {
        self.detour.legs(self.currents_at(t))
    }

    /// Terminal voltages in volts against the negative rail at `t` seconds after the start.
    pub fn voltages_at(&self, t: f64) -> [f64; 3] {
        let neutral = evaluate(&self.neutral[..self.terms], t);
        std::array::from_fn(|x| match self.terminal[x] {
            Terminal::Rail { volts, .. } => volts,
            Terminal::Floating => {
                neutral + self.omega_m * evaluate(&self.shape[x][..self.shape_terms], t)
            }
        })
    }

    /// Integrals of the terminal voltages over the segment in volt-seconds.
    pub fn volt_seconds(&self) -> [f64; 3] {
        let h = self.duration;
        std::array::from_fn(|x| match self.terminal[x] {
            Terminal::Rail { volts, .. } => volts * h,
            Terminal::Floating => {
                integral(&self.neutral[..self.terms], h)
                    + self.omega_m * integral(&self.shape[x][..self.shape_terms], h)
            }
        })
    }

    /// Fills the torque's series. Formed from the shape, so that nothing divides by the speed; the currents' sum is
    /// zero, so two of them tell all.
    pub(super) fn fill_torque(&mut self) {
        let terms = self.terms;
        let [f_a, f_b, f_c] = &self.shape;
        let [a, b, _] = self.current.each_ref().map(|series| &series[..terms]);
        let torque = &mut self.torque[..terms];
        let (of_a, of_b) = (f_a[0] - f_c[0], f_b[0] - f_c[0]);
        for ((sum, a), b) in torque.iter_mut().zip(a).zip(b) {
            *sum = of_a * a + of_b * b;
        }
        for j in 1..self.shape_terms {
            let (of_a, of_b) = (f_a[j] - f_c[j], f_b[j] - f_c[j]);
            for ((sum, a), b) in torque[j..].iter_mut().zip(a).zip(b) {
                *sum += of_a * a + of_b * b;
            }
        }
    }
}

/// Integral of a series from 0 to `t`.
pub(crate) fn integral(series: &[f64], t: f64) -> f64 {
    t * series
        .iter()
        .zip(&PER_ORDER)
        .rev()
        .fold(0.0, |sum, (c, per_order)| sum * t + c * per_order)
}

/// 1/(k + 1).
pub(super) const PER_ORDER: Series = {
    let mut table = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        table[k] = 1.0 / (k + 1) as f64;
        k += 1;
    }
    table
};
