//! The four controllers, written directly from the equations, over any number type.

use super::Peer;
use super::paper::{A, B, BUS, GAIN, K, LEGS, SQRT_3, TIMER};
use super::real::Real;
use core::ops::Div;
use hexagen::{LegState, Legs, Sample};

/// Currents alpha, beta in ampere.
#[inline]
fn currents<R: Real>(sample: Sample) -> [R; 2] {
    let gain = R::num(GAIN);
    let [adc_a, adc_b, _] = sample.adc();
    let i_a = (R::count(adc_a) - R::num(2048.0)) * gain;
    let i_b = (R::count(adc_b) - R::num(2048.0)) * gain;
    [i_a, (i_a + i_b + i_b) * R::num(1.0 / SQRT_3)]
}

/// Reference in ampere.
#[inline]
fn reference<R: Real>(sample: Sample) -> [R; 2] {
    R::CORNERS[usize::from(sample.hall() & 7)]
}

/// Space-vector modulation by min/max injection; scales voltages outside the hexagon.
#[inline(always)]
#[expect(
    clippy::inline_always,
    reason = "as each controller would have it in place"
)]
fn modulate<R: Real + Div<Output = R>>([v_alpha, v_beta]: [R; 2]) -> ([R; 2], Legs) {
    // Phase voltages in counts of the timer. `37.5 * x` is computed once: rustc 1.96 (LLVM 22)
    // miscompiles two 64-bit products by the same odd multiple of 2^31, such as 37.5 in `I16F16`,
    // to undefined values on RV32.
    let alpha = v_alpha * R::num(TIMER / BUS);
    let half = alpha * R::num(0.5);
    let side = v_beta * R::num(SQRT_3 / 2.0 * TIMER / BUS);
    let mut v = [alpha, side - half, -half - side];
    let mut applied = [v_alpha, v_beta];
    let mut highest = v[0].greatest(v[1]).greatest(v[2]);
    let mut lowest = v[0].least(v[1]).least(v[2]);
    let spread = highest - lowest;
    if spread > R::num(TIMER) {
        let scale = R::num(TIMER) / spread;
        v = v.map(|x| x * scale);
        applied = applied.map(|x| x * scale);
        highest = highest * scale;
        lowest = lowest * scale;
    }
    let zero = R::num(TIMER / 2.0) - (highest + lowest) * R::num(0.5);
    let compare = v.map(|x| (x + zero).compare(TIMER as u16));
    let state = [LegState::Pulsed; 3];
    (applied, Legs::new(compare, state))
}

/// The legs of a vector for the whole period.
#[inline]
fn whole(vector: usize) -> Legs {
    Legs::new(
        LEGS[vector].map(|leg| leg * TIMER as u16),
        [LegState::Pulsed; 3],
    )
}

/// EMF of the last period and the current at the next sample, by the voltages applied.
#[derive(Clone, Copy, Debug)]
struct Prediction<R> {
    /// Decay factor of the current over a period.
    i_left: [R; 2],
    v_last: [R; 2],
    v_now: [R; 2],
}

impl<R: Real> Prediction<R> {
    fn new() -> Self {
        let zero = [R::num(0.0); 2];
        Self {
            i_left: zero,
            v_last: zero,
            v_now: zero,
        }
    }

    /// EMF and predicted current.
    #[inline]
    fn next(&mut self, i: [R; 2]) -> ([R; 2], [R; 2]) {
        let mut e = [R::num(0.0); 2];
        let mut i_next = e;
        for x in 0..2 {
            e[x] = self.v_last[x] - (i[x] - self.i_left[x]) * R::num(K);
            self.i_left[x] = R::num(A) * i[x];
            i_next[x] = self.i_left[x] + R::num(B) * (self.v_now[x] - e[x]);
        }
        self.v_last = self.v_now;
        (e, i_next)
    }
}

/// Deadbeat.
#[derive(Clone, Copy, Debug)]
pub struct Pdcc<R>(Prediction<R>);

impl<R: Real + Div<Output = R>> Peer for Pdcc<R> {
    fn new() -> Self {
        Self(Prediction::new())
    }

    #[inline]
    fn step(&mut self, sample: &Sample) -> Legs {
        let (e, i_next) = self.0.next(currents(*sample));
        let i_ref: [R; 2] = reference(*sample);
        let v = [0, 1].map(|x| (i_ref[x] - R::num(A) * i_next[x]) * R::num(K) + e[x]);
        let (applied, legs) = modulate(v);
        self.0.v_now = applied;
        legs
    }
}

/// Finite control set, three-phase vectors, enumerated.
#[derive(Clone, Copy, Debug)]
pub struct FcsMpc<R>(Prediction<R>);

impl<R: Real> Peer for FcsMpc<R> {
    fn new() -> Self {
        Self(Prediction::new())
    }

    #[inline]
    fn step(&mut self, sample: &Sample) -> Legs {
        let (e, i_next) = self.0.next(currents(*sample));
        let i_ref: [R; 2] = reference(*sample);
        let mut best = (0, R::num(32_000.0));
        for (place, vector) in R::VECTORS.iter().enumerate() {
            // In tens of amperes, so that the square fits 16 bits.
            let error = [0, 1].map(|x| {
                (i_ref[x] - R::num(A) * i_next[x] - R::num(B) * (vector[x] - e[x])) * R::num(0.1)
            });
            let cost = error[0] * error[0] + error[1] * error[1];
            if cost < best.1 {
                best = (place, cost);
            }
        }
        self.0.v_now = R::VECTORS[best.0];
        whole(best.0)
    }
}

/// Predictive hysteresis: two bands with memory and a table.
#[derive(Clone, Copy, Debug)]
pub struct Phcc<R> {
    prediction: Prediction<R>,
    wish: [bool; 2],
}

impl<R: Real> Peer for Phcc<R> {
    fn new() -> Self {
        Self {
            prediction: Prediction::new(),
            wish: [false; 2],
        }
    }

    #[inline]
    fn step(&mut self, sample: &Sample) -> Legs {
        /// The vector nearest to the wanted direction in alpha and beta.
        const NEAREST: [usize; 4] = [1, 5, 2, 4];
        let (_, i_next) = self.prediction.next(currents(*sample));
        let i_ref: [R; 2] = reference(*sample);
        for x in 0..2 {
            let error = i_ref[x] - i_next[x];
            if error > R::num(0.5) {
                self.wish[x] = true;
            } else if error < R::num(-0.5) {
                self.wish[x] = false;
            }
        }
        let [alpha, beta] = self.wish.map(usize::from);
        let vector = NEAREST[2 * alpha + beta];
        self.prediction.v_now = R::VECTORS[vector];
        whole(vector)
    }
}

/// PI per axis with tracking anti-windup, 1 kHz, Ti = L/R.
#[derive(Clone, Copy, Debug)]
pub struct PiPwm<R> {
    integral: [R; 2],
}

impl<R: Real + Div<Output = R>> Peer for PiPwm<R> {
    fn new() -> Self {
        Self {
            integral: [R::num(0.0); 2],
        }
    }

    #[inline]
    fn step(&mut self, sample: &Sample) -> Legs {
        /// 2 pi 1 kHz L, in V/A, and Ts/Ti.
        const GAIN: f64 = 1.382_3;
        const SHARE: f64 = 0.030_68;
        let i: [R; 2] = currents(*sample);
        let i_ref: [R; 2] = reference(*sample);
        let error = [0, 1].map(|x| i_ref[x] - i[x]);
        let v = [0, 1].map(|x| R::num(GAIN) * error[x] + self.integral[x]);
        let (applied, legs) = modulate(v);
        // The gains of the error and of the difference between applied and demanded voltage:
        // `GAIN * error + applied - v`.
        self.integral = [0, 1].map(|x| {
            let tracked = applied[x] - self.integral[x];
            self.integral[x] + R::num(SHARE) * tracked
        });
        legs
    }
}

#[cfg(test)]
mod tests;
