//! Torque ripple that no control removes: that of pulses of any width, with every sample of the
//! current right.
//!
//! Within a period the pulses move the current to both sides of its mean, and the EMF turns; their
//! product has a mean. It grows with the current's rise in a period and with the turn.

use hexagen::{LegState, Legs, Sample};
use hexagen_lab::closed_loop::{CurrentLoop, RunOptions, STARTS, measure};
use hexagen_lab::engine::{Prepared, plant_of, run_of};
use hexagen_lab::plant::{EmfShape, PlantParams, Truth};
use std::f64::consts::TAU;

/// Counts of a timer whose rounding is negligible.
const FINE: u16 = u16::MAX;

/// Knows the plant: at the end of the next period the currents are on their sines.
struct Exact {
    plant: PlantParams,
    /// Amplitude of the currents, with the sign of the torque, ampere.
    current: f64,
    /// Voltages of the period that begins.
    applied: [f64; 3],
}

impl Exact {
    /// Share of a current that is left after a period.
    fn decay(&self) -> f64 {
        (-self.plant.resistance[0] * self.plant.t_s / self.plant.inductance[0]).exp()
    }

    /// Steady current in ampere that the EMF alone draws from a phase whose EMF is at this angle.
    fn drawn(&self, angle: f64, truth: &Truth) -> f64 {
        let (r, x) = (
            self.plant.resistance[0],
            truth.omega_e * self.plant.inductance[0],
        );
        let emf = self.plant.k_phase[0] * truth.omega_m;
        emf * (r * angle.sin() - x * angle.cos()) / (r * r + x * x)
    }
}

impl CurrentLoop for Exact {
    fn step(&mut self, _: &Sample, truth: &Truth) -> Legs {
        let (decay, r) = (self.decay(), self.plant.resistance[0]);
        let turn = truth.omega_e * self.plant.t_s;
        let lags = [0.0, -TAU / 3.0, TAU / 3.0];
        let v: [f64; 3] = std::array::from_fn(|phase| {
            let angle = truth.theta_e + lags[phase];
            let [now, next, last] = [0.0, turn, 2.0 * turn].map(|by| self.drawn(angle + by, truth));
            let from = truth.currents[phase];
            let begin = decay * (from + now) - next + (1.0 - decay) / r * self.applied[phase];
            let end = self.current * (angle + 2.0 * turn).sin();
            (end + last - decay * (begin + next)) * r / (1.0 - decay)
        });
        let most = v.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let least = v.into_iter().fold(f64::INFINITY, f64::min);
        let v_bus = self.plant.v_bus;
        let high = v.map(|v| ((v - f64::midpoint(most, least)) / v_bus + 0.5).clamp(0.0, 1.0));
        let mean = high.iter().sum::<f64>() / 3.0;
        self.applied = high.map(|high| v_bus * (high - mean));
        let counts = high.map(|high| (high * f64::from(FINE)).round() as u16);
        Legs::new(counts, [LegState::Pulsed; 3])
    }
}

/// This ripple, percent of the mean, at a speed in percent of the rated one; `None` for an EMF that is
/// no sine.
pub fn least_ripple(drive: &Prepared, speed_pct: u32) -> Option<f64> {
    let mut plant = plant_of(&drive.spec);
    if plant.shape != EmfShape::Sinusoidal {
        return None;
    }
    plant.timer_period = FINE;
    let omega = f64::from(speed_pct) / 100.0 * drive.spec.motor.rated_speed;
    let run = RunOptions {
        starts: vec![STARTS[0]],
        ..run_of(&drive.spec, omega, drive.demand())
    };
    let exact = |_: &Truth| Exact {
        plant: plant.clone(),
        current: drive.demand() / (1.5 * plant.k_phase[0]),
        applied: [0.0; 3],
    };
    let measured = measure(&plant, &run, exact).expect("runs");
    measured.figures.ripple_pp_pct
}
