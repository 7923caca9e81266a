//! One step of the bit-true and of the ideal model from the same state: measured errors of voltages
//! and compare values, and their proven bounds.

use crate::engine::Prepared;
use hexagen_codegen::ir::stated_errors;
use hexagen_reference::{AnyCommand, BitTrue, Duties, Ideal, PhysicalState, Reach, Trace};
use serde::Serialize;

/// Number of histogram bins over the proven range; odd, so that zero is in the middle of one.
pub const BINS: usize = 61;

/// The compared signal.
#[derive(Clone, Debug)]
pub struct Compared {
    /// Name: the voltage before the limit, or (PHCC) the predicted current error as a voltage.
    pub quantity: String,
    /// Proven bound for phases a and b, volt; infinite without a proof.
    pub bound: f64,
    /// Proven bounds of a compare value's error, timer counts: without and with an active limit.
    /// Infinite without a proof.
    duty: [f64; 2],
    /// Current resolution, and diode threshold of an off leg, ampere; only for drives that switch
    /// legs off.
    threshold: Option<[f64; 2]>,
}

impl Compared {
    /// The compared signal of a drive.
    pub fn of(drive: &Prepared) -> Self {
        let stated = stated_errors(drive.generated.graph.program());
        let named = |name: &str| stated.iter().find(|stated| stated.name == name);
        let (quantity, bound) = match named("voltage").or_else(|| named("deviation")) {
            Some(stated) => {
                let rare = stated.rare_bound().unwrap_or(0.0);
                (stated.doc.clone(), stated.normal_bound().max(rare))
            }
            None => ("no bounded signal".to_owned(), f64::INFINITY),
        };
        let duty = named("duty").map_or([f64::INFINITY; 2], |duty| {
            let limited = duty.rare_bound().unwrap_or(duty.normal_bound());
            // Rounding of the duty adds half a count.
            [duty.normal_bound(), limited].map(|bound| bound + 0.5)
        });
        let formats = drive.generated.interface.formats.iter();
        let current = formats.clone().find(|format| format.name == "current");
        let word = current.map_or(0.0, |format| {
            drive.spec.inverter.adc_gain.abs() * f64::from(-format.frac_bits).exp2()
        });
        let end = drive.reference.commutation_end();
        Self {
            quantity,
            bound,
            duty,
            threshold: end.map(|end| [word, end.threshold]),
        }
    }

    /// Whether the current of an off leg lies within one word of the diode threshold, so that the
    /// models may disagree on conduction.
    fn is_at_threshold(&self, before: &PhysicalState, i: [f64; 2]) -> bool {
        let Some([word, threshold]) = self.threshold else {
            return false;
        };
        let near = |leg: Option<usize>, [a, b]: [f64; 2]| {
            leg.is_some_and(|leg| ([a, b, -(a + b)][leg].abs() - threshold).abs() <= word)
        };
        near(before.off_prev, before.i_prev) || near(before.off_cmd, i)
    }
}

/// Difference between the bit-true and the ideal model after one step from the same state, sample
/// and set-point word.
#[derive(Clone, Debug, Default, Serialize)]
pub struct OneStep {
    /// The signal of `snr_db` and of the voltages below.
    pub quantity: String,
    /// Compared steps: in control, with the same decisions in both models.
    pub steps: u64,
    /// Steps with different decisions (sector, commutation, reach, leg states, vector, an off leg's
    /// diode): ties decided by rounding.
    pub other_decisions: u64,
    /// Share of steps in control with the same decisions, percent.
    pub decisions_equal_pct: f64,
    /// Signal-to-noise ratio over all three phases, decibel.
    pub snr_db: f64,
    /// Largest error in phases a and b, volt.
    pub largest_v: f64,
    /// Its proven bound, volt.
    pub bound_v: f64,
    /// `largest_v` over `bound_v`.
    pub seen_to_bound: f64,
    /// RMS error over all three phases, volt.
    pub rms_v: f64,
    /// Largest error of a compare value against the exact duty without an active limit, timer
    /// counts; rounding contributes up to half a count.
    pub duty_largest_counts: f64,
    /// Its proven bound, timer counts; infinite if no duty is computed.
    pub duty_bound_counts: f64,
    /// Largest error with an active limit, timer counts.
    pub duty_limited_counts: f64,
    /// Its proven bound, timer counts.
    pub duty_limited_bound_counts: f64,
    /// RMS error of compare values, timer counts.
    pub duty_rms_counts: f64,
    /// Share of compare values equal to the rounded ideal ones, percent.
    pub equal_compares_pct: f64,
    /// Share of steps in control with the leg states and rounded compare values of the ideal model,
    /// percent.
    pub equal_steps_pct: f64,
    /// Largest difference of rounded compare values, timer counts; over all steps in control with
    /// the same leg states and vector.
    pub compares_apart_counts: u16,
}

impl OneStep {
    /// Whether all errors are within their proven bounds.
    pub fn is_within_bounds(&self) -> bool {
        self.seen_to_bound <= 1.0
            && self.duty_largest_counts <= self.duty_bound_counts
            && self.duty_limited_counts <= self.duty_limited_bound_counts
    }
}

/// A step of both models from the same state.
pub(super) struct Step<'a> {
    pub before: &'a PhysicalState,
    pub found: Trace,
    pub command: AnyCommand,
    pub exact: Trace,
    pub duties: Duties,
}

impl<'a> Step<'a> {
    /// Decisions of both models in their last step.
    pub fn of(
        before: &'a PhysicalState,
        (bit_true, command): (&BitTrue, AnyCommand),
        (ideal, duties): (&Ideal, Duties),
    ) -> Self {
        Self {
            before,
            found: bit_true.trace(),
            command,
            exact: *ideal.trace(),
            duties,
        }
    }
}

/// Sums over steps.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    compared: Compared,
    steps: u64,
    other_decisions: u64,
    largest: f64,
    error: f64,
    signal: f64,
    /// Without and with an active limit.
    duty_largest: [f64; 2],
    duty_error: f64,
    equal_compares: u64,
    equal_steps: u64,
    compares_apart: u16,
    /// Compare values, or ends of intervals.
    instants: u64,
    histogram: Vec<u64>,
}

impl Sums {
    pub fn new(compared: Compared) -> Self {
        Self {
            compared,
            steps: 0,
            other_decisions: 0,
            largest: 0.0,
            error: 0.0,
            signal: 0.0,
            duty_largest: [0.0; 2],
            duty_error: 0.0,
            equal_compares: 0,
            equal_steps: 0,
            compares_apart: 0,
            instants: 0,
            histogram: vec![0; BINS],
        }
    }

    /// Adds a step of both models.
    pub fn add(&mut self, step: &Step, period: u16) {
        let Step {
            before,
            found,
            command,
            exact,
            duties,
        } = step;
        if !found.run {
            return;
        }
        let rounded = duties.to_command(period);
        self.equal_steps += u64::from(*command == rounded);
        let same_vector = command.states() == rounded.states() && found.vector == exact.vector;
        if same_vector {
            for (compare, exact) in command.instants().iter().zip(rounded.instants()) {
                self.compares_apart = self.compares_apart.max(compare.abs_diff(exact));
            }
        }
        let same = same_vector
            && found.sector_eff == exact.sector_eff
            && found.commutating == exact.commutating
            && found.reach == exact.reach
            && !self.compared.is_at_threshold(before, exact.i);
        if !same {
            self.other_decisions += 1;
            return;
        }
        self.steps += 1;
        let limited = usize::from(exact.reach != Reach::Inside);
        let phases = |u: [f64; 2]| [u[0], u[1], -u[0] - u[1]];
        let (found, exact) = (phases(found.u_unsat), phases(exact.u_unsat));
        for phase in 0..3 {
            let error = found[phase] - exact[phase];
            self.error += error * error;
            self.signal += exact[phase] * exact[phase];
            if phase < 2 {
                self.largest = self.largest.max(error.abs());
                self.histogram[bin(error / self.compared.bound)] += 1;
            }
        }
        self.instants += command.instant_count() as u64;
        for phase in 0..command.instant_count() {
            let exact = duties.duty[phase] * f64::from(period);
            let error = (f64::from(command.instants()[phase]) - exact).abs();
            let largest = &mut self.duty_largest[limited];
            *largest = largest.max(error);
            self.duty_error += error * error;
            self.equal_compares +=
                u64::from(command.instants()[phase] == rounded.instants()[phase]);
        }
    }

    /// Adds the sums of other steps of the same drive.
    pub fn and(mut self, other: &Self) -> Self {
        self.steps += other.steps;
        self.other_decisions += other.other_decisions;
        self.largest = self.largest.max(other.largest);
        self.error += other.error;
        self.signal += other.signal;
        for (largest, more) in self.duty_largest.iter_mut().zip(other.duty_largest) {
            *largest = largest.max(more);
        }
        self.duty_error += other.duty_error;
        self.equal_compares += other.equal_compares;
        self.instants += other.instants;
        self.equal_steps += other.equal_steps;
        self.compares_apart = self.compares_apart.max(other.compares_apart);
        for (count, more) in self.histogram.iter_mut().zip(&other.histogram) {
            *count += more;
        }
        self
    }

    /// Histogram of the errors of phases a and b: [`BINS`] bins from the negative to the positive
    /// bound.
    pub fn histogram(&self) -> Vec<u64> {
        self.histogram.clone()
    }

    /// Figures over all steps.
    pub fn one_step(&self) -> OneStep {
        let run = (self.steps + self.other_decisions) as f64;
        let values = 3.0 * self.steps as f64;
        OneStep {
            quantity: self.compared.quantity.clone(),
            steps: self.steps,
            other_decisions: self.other_decisions,
            decisions_equal_pct: 100.0 * self.steps as f64 / run,
            snr_db: 10.0 * (self.signal / self.error).log10(),
            largest_v: self.largest,
            bound_v: self.compared.bound,
            seen_to_bound: self.largest / self.compared.bound,
            rms_v: (self.error / values).sqrt(),
            duty_largest_counts: self.duty_largest[0],
            duty_bound_counts: self.compared.duty[0],
            duty_limited_counts: self.duty_largest[1],
            duty_limited_bound_counts: self.compared.duty[1],
            duty_rms_counts: (self.duty_error / self.instants as f64).sqrt(),
            equal_compares_pct: 100.0 * self.equal_compares as f64 / self.instants as f64,
            equal_steps_pct: 100.0 * self.equal_steps as f64 / run,
            compares_apart_counts: self.compares_apart,
        }
    }
}

/// The bin of a share of the bound; the outer bins hold everything beyond -1 and 1.
fn bin(share: f64) -> usize {
    let place = (share + 1.0) * (BINS as f64 / 2.0);
    place.clamp(0.0, BINS as f64 - 1.0) as usize
}

#[cfg(test)]
mod tests {
    use super::{BINS, bin};

    #[test]
    fn errors_fall_into_their_bins() {
        for (share, place) in [
            (-1.0, 0),
            (-3.0, 0),
            (0.0, BINS / 2),
            (-0.01, BINS / 2),
            (0.99, BINS - 1),
            (1.0, BINS - 1),
            (7.0, BINS - 1),
        ] {
            assert_eq!(bin(share), place, "{share}");
        }
    }
}
