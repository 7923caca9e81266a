//! Torque ripple that no control removes: that of pulses as wide as the timer counts, with every sample of the current
//! right.
//!
//! Within a period the pulses move the current to both sides of its mean, and the EMF turns; their product has a mean. It
//! grows with the current's rise in a period and with the turn. A pulse of half a count too much moves the current
//! until the next command but one corrects it.

use hexagen::{LegState, Legs, Sample};
use hexagen_codegen::spec::EmfShape;
use hexagen_lab::closed_loop::{CurrentLoop, RunOptions, STARTS, measure};
use hexagen_lab::engine::{Prepared, plant_of, run_of};
use hexagen_lab::plant::{PlantParams, Truth};
use hexagen_reference::AnyCommand;
use std::array::from_fn;
use std::f64::consts::TAU;

/// Parts of a period in which the EMF's integral is summed.
const PARTS: u32 = 32;

/// Knows the plant: at the end of the next period the currents are in proportion to the EMFs.
struct Exact {
    plant: PlantParams,
    shape: EmfShape,
    /// Torque over the EMF constant of a phase, ampere.
    strength: f64,
    /// Voltages of the period that begins.
    applied: [f64; 3],
}

impl Exact {
    /// EMFs of the phases without what all have in common, over the amplitude.
    fn emfs(&self, angle: f64) -> [f64; 3] {
        let all = [0.0, -TAU / 3.0, TAU / 3.0].map(|lag| self.shape.at(angle + lag));
        let mean = all.iter().sum::<f64>() / 3.0;
        all.map(|emf| emf - mean)
    }

    /// The least currents that make the torque.
    fn wanted(&self, angle: f64) -> [f64; 3] {
        let emfs = self.emfs(angle);
        let square: f64 = emfs.iter().map(|emf| emf * emf).sum();
        emfs.map(|emf| self.strength * emf / square)
    }

    /// What the EMFs take from the currents in a period that begins at this angle, ampere.
    fn taken(&self, angle: f64, truth: &Truth) -> [f64; 3] {
        let (r, l) = (self.plant.resistance[0], self.plant.inductance[0]);
        let part = self.plant.t_s / f64::from(PARTS);
        let mut taken = [0.0; 3];
        for place in 0..PARTS {
            let since = (f64::from(place) + 0.5) * part;
            let left = (-r * (self.plant.t_s - since) / l).exp();
            let emfs = self.emfs(angle + truth.omega_e * since);
            for (taken, emf) in taken.iter_mut().zip(emfs) {
                *taken += left * self.plant.k_phase[0] * truth.omega_m * emf * part / l;
            }
        }
        taken
    }
}

impl CurrentLoop for Exact {
    fn step(&mut self, _: &Sample, truth: &Truth) -> AnyCommand {
        let r = self.plant.resistance[0];
        let decay = (-r * self.plant.t_s / self.plant.inductance[0]).exp();
        let gain = (1.0 - decay) / r;
        let (angle, turn) = (truth.theta_e, truth.omega_e * self.plant.t_s);
        let [first, second] = [angle, angle + turn].map(|angle| self.taken(angle, truth));
        let wanted = self.wanted(angle + 2.0 * turn);
        let v: [f64; 3] = from_fn(|phase| {
            let begin = decay * truth.currents[phase] + gain * self.applied[phase] - first[phase];
            (wanted[phase] - decay * begin + second[phase]) / gain
        });
        let most = v.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let least = v.into_iter().fold(f64::INFINITY, f64::min);
        let (v_bus, top) = (self.plant.v_bus, f64::from(self.plant.timer_period));
        let middle = f64::midpoint(most, least);
        let counts = v.map(|v| (top * ((v - middle) / v_bus + 0.5).clamp(0.0, 1.0)).round());
        let mean = counts.iter().sum::<f64>() / 3.0;
        self.applied = counts.map(|count| v_bus * (count - mean) / top);
        Legs::new(counts.map(|count| count as u16), [LegState::Pulsed; 3]).into()
    }
}

/// The ripple of exact control, peak to peak in percent of the mean, at a speed in percent of the rated one.
pub fn least_ripple(drive: &Prepared, speed_pct: u32) -> Option<f64> {
    let plant = plant_of(&drive.spec);
    let omega = f64::from(speed_pct) / 100.0 * drive.spec.motor.rated_speed;
    let run = RunOptions {
        starts: vec![STARTS[0]],
        ..run_of(&drive.spec, omega, drive.demand())
    };
    let exact = |_: &Truth| Exact {
        plant: plant.clone(),
        shape: drive.spec.motor.emf_shape,
        strength: drive.demand() / plant.k_phase[0],
        applied: [0.0; 3],
    };
    let measured = measure(&plant, &run, exact).expect("runs");
    measured.figures.ripple_pp_pct
}
