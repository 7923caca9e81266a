//! One step of the bit-true and of the ideal model from the same state: how far their voltages and compare values
//! are apart, and how far the proof says that they may be.

use crate::engine::Prepared;
use hexagen::Legs;
use hexagen_codegen::ir::stated_errors;
use hexagen_reference::{BitTrue, Duties, Ideal, PhysicalState, Reach, Trace};
use serde::Serialize;

/// Equal parts of the range between both ends of a proven bound, in which errors are counted. An odd number: zero
/// lies in the middle of one.
pub const BINS: usize = 61;

/// The signal of a step that is compared.
#[derive(Clone, Debug)]
pub struct Compared {
    /// What it is: the voltage that the law asks for, or (PHCC) the predicted error as a voltage.
    pub quantity: String,
    /// Its proven bound for phases a and b, volt; infinite where nothing is proven.
    pub bound: f64,
    /// How far a compare value may be from the exact duty, timer counts: while no limit acts, and where one does. Infinite
    /// where nothing is proven.
    duty: [f64; 2],
    /// One current word, and the current at which an off leg's diode is taken to conduct, ampere; of drives that may
    /// turn a leg off.
    threshold: Option<[f64; 2]>,
}

impl Compared {
    /// The signal of a drive's step.
    pub fn of(drive: &Prepared) -> Self {
        let stated = stated_errors(drive.generated.graph.program());
        let named = |name: &str| stated.iter().find(|stated| stated.name == name);
        let (quantity, bound) = match named("voltage").or_else(|| named("deviation")) {
            Some(stated) => {
                let rare = stated.rare_bound().unwrap_or(0.0);
                (stated.doc.clone(), stated.normal_bound().max(rare))
            }
            None => ("nothing that is bounded".to_owned(), f64::INFINITY),
        };
        let duty = named("duty").map_or([f64::INFINITY; 2], |duty| {
            let limited = duty.rare_bound().unwrap_or(duty.normal_bound());
            // The duty's own rounding makes half a count.
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

    /// Whether the current of a leg that is off, or was, lies at the diode's threshold to the last word, so that the
    /// models may take it to conduct or not.
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

/// Distance of the bit-true from the ideal model after one step from the same state, sample and set-point word.
#[derive(Clone, Debug, Default, Serialize)]
pub struct OneStep {
    /// What `snr_db` and the voltages below are of.
    pub quantity: String,
    /// Steps that were compared: in control, and with the same decisions in both.
    pub steps: u64,
    /// Steps on which the two decided differently (sector, commutation, reach, leg states, vector, an off leg's
    /// diode): a tie that rounding broke.
    pub other_decisions: u64,
    /// Share of all steps in control on which they decided alike, percent.
    pub decisions_equal_pct: f64,
    /// Signal over its error, all three phases, decibel.
    pub snr_db: f64,
    /// Largest distance in phases a and b, volt.
    pub largest_v: f64,
    /// The proven bound of the same, volt.
    pub bound_v: f64,
    /// `largest_v` over `bound_v`.
    pub seen_to_bound: f64,
    /// Root mean square of the distance, all three phases, volt.
    pub rms_v: f64,
    /// Largest distance of a compare value from the exact duty while no limit acts, timer counts; its own rounding
    /// makes up to half a count.
    pub duty_largest_counts: f64,
    /// The proven bound of the same, timer counts; infinite where no duty is computed.
    pub duty_bound_counts: f64,
    /// Largest distance where a limit acts, timer counts.
    pub duty_limited_counts: f64,
    /// The proven bound of the same, timer counts.
    pub duty_limited_bound_counts: f64,
    /// Root mean square of the same, timer counts.
    pub duty_rms_counts: f64,
    /// Share of compare values equal to the ideal ones after rounding, percent.
    pub equal_compares_pct: f64,
    /// Share of all steps in control whose leg states and compare values are those of the ideal model after rounding,
    /// percent.
    pub equal_steps_pct: f64,
    /// Largest distance of a compare value from the ideal one after rounding, timer counts; over all steps in control
    /// with the same leg states and vector.
    pub compares_apart_counts: u16,
}

impl OneStep {
    /// Whether no error was larger than what is proven of it.
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
    pub legs: Legs,
    pub exact: Trace,
    pub duties: Duties,
}

impl<'a> Step<'a> {
    /// What both models did in their last step.
    pub fn of(
        before: &'a PhysicalState,
        (bit_true, legs): (&BitTrue, Legs),
        (ideal, duties): (&Ideal, Duties),
    ) -> Self {
        Self {
            before,
            found: bit_true.trace(),
            legs,
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
    /// While no limit acts, and where one does.
    duty_largest: [f64; 2],
    duty_error: f64,
    equal_compares: u64,
    equal_steps: u64,
    compares_apart: u16,
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
            histogram: vec![0; BINS],
        }
    }

    /// Takes in a step of both models.
    pub fn add(&mut self, step: &Step, period: u16) {
        let Step {
            before,
            found,
            legs,
            exact,
            duties,
        } = step;
        if !found.run {
            return;
        }
        let rounded = duties.to_legs(period);
        self.equal_steps += u64::from(*legs == rounded);
        let same_vector = legs.state() == rounded.state() && found.vector == exact.vector;
        if same_vector {
            for (compare, exact) in legs.compare().iter().zip(rounded.compare()) {
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
        for phase in 0..3 {
            let exact = duties.duty[phase] * f64::from(period);
            let error = (f64::from(legs.compare()[phase]) - exact).abs();
            let largest = &mut self.duty_largest[limited];
            *largest = largest.max(error);
            self.duty_error += error * error;
            self.equal_compares += u64::from(legs.compare()[phase] == rounded.compare()[phase]);
        }
    }

    /// Takes in the sums of other steps of the same drive.
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
        self.equal_steps += other.equal_steps;
        self.compares_apart = self.compares_apart.max(other.compares_apart);
        for (count, more) in self.histogram.iter_mut().zip(&other.histogram) {
            *count += more;
        }
        self
    }

    /// Errors of phases a and b, in [`BINS`] equal parts from the negative to the positive bound.
    pub fn histogram(&self) -> Vec<u64> {
        self.histogram.clone()
    }

    /// Figures of all steps.
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
            duty_rms_counts: (self.duty_error / values).sqrt(),
            equal_compares_pct: 100.0 * self.equal_compares as f64 / values,
            equal_steps_pct: 100.0 * self.equal_steps as f64 / run,
            compares_apart_counts: self.compares_apart,
        }
    }
}

/// The part of the range from -1 to 1 that a share of the bound lies in; the outer ones hold what lies beyond.
fn bin(share: f64) -> usize {
    let place = (share + 1.0) * (BINS as f64 / 2.0);
    place.clamp(0.0, BINS as f64 - 1.0) as usize
}

#[cfg(test)]
mod tests {
    use super::{BINS, bin};

    #[test]
    fn errors_fall_into_the_part_that_they_lie_in() {
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
