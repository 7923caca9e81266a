//! The EMF observed in a period, extrapolated by the motor's shape (section 8).

use super::Ideal;
use super::vector::{clarke, from_ab, phases, to_ab};
use crate::DiscretePhase;
use crate::emf_motion::EmfMotion;
use crate::model::sector;
use nalgebra::{Vector2, Vector3};

/// Gain of the observer: fraction of the residual per period.
const OBSERVER_GAIN: f64 = 3.0 / 32.0;

impl Ideal {
    /// The estimate `seen` with the known EMF of a floating leg (section 8), as only the EMF
    /// between the two others is observed. In its own sector the phase's EMF crosses zero; when
    /// another phase goes off, the two have met.
    pub(super) fn with_floated(&self, seen: &Vector2<f64>, sector_eff: usize) -> Vector2<f64> {
        let Some(off) = self.state.off_prev else {
            return *seen;
        };
        let [e_a, e_b] = to_ab(seen);
        let [i_a, i_b] = self.state.i_prev;
        let i_prev = [i_a, i_b, -(i_a + i_b)];
        let e = [e_a, e_b, self.believed(-(e_a + e_b))];
        let outgoing = sector::OUT_PHASE[sector_eff];
        let change = if outgoing == off {
            -e[off]
        } else if i_prev[off].abs() > self.end.threshold {
            return *seen;
        } else {
            2.0 / 3.0 * (e[outgoing] - e[off])
        };
        // Along the phase's own axis the difference of the two others is kept.
        let mut axis = Vector3::zeros();
        axis[off] = change;
        seen + clarke(&axis) * 1.5
    }

    /// Voltage less that across inductance and resistance in the period that ends with the currents `i` of phases a,
    /// b: v - (i - a i_prev)/b; of the applied voltage that is the EMF.
    pub(super) fn behind(&self, [v_a, v_b]: [f64; 2], i: [f64; 2]) -> Vector2<f64> {
        let [pa, pb] = self.state.i_prev;
        let change = |now: f64, before: f64| (now - before).clamp(-self.di_limit, self.di_limit);
        let d = from_ab(change(i[0], pa), change(i[1], pb));
        let i_prev = from_ab(pa, pb);
        let DiscretePhase { a, b } = self.phase;
        // i - a i_prev = d + (1 - a) i_prev.
        from_ab(v_a, v_b) - (d + i_prev * (1.0 - a)) / b
    }

    /// An EMF clamped to the largest bus.
    pub(super) fn believed(&self, e: f64) -> f64 {
        e.clamp(-self.v_largest, self.v_largest)
    }

    /// An estimated EMF one and two periods later (section 8): on its circle, to second order, or
    /// along the side of its hexagon in the sector. The pair's EMF gives the speed.
    pub(super) fn moved_on(&self, e: &Vector2<f64>, sector: usize) -> [Vector2<f64>; 2] {
        let EmfMotion {
            turns,
            per_product,
            line_limit,
        } = self.motion;
        let limit = line_limit.min(self.v_largest);
        let pair = Vector3::new(
            sector::CORNER_A[sector],
            sector::CORNER_B[sector],
            -sector::CORNER_A[sector] - sector::CORNER_B[sector],
        );
        let line = pair.dot(&phases(e)).clamp(-limit, limit);
        if turns {
            let angle = 3_f64.sqrt() * per_product * line;
            let across = Vector2::new(-e.y, e.x);
            [1.0, 2.0]
                .map(|periods| periods * angle)
                .map(|angle| e * (1.0 - angle * angle / 2.0) + across * angle)
        } else {
            // Both of the pair against the off phase, whose sign is that of the corner across.
            let [p, q, r]: [f64; 3] = pair.into();
            let motion = from_ab(r - q, p - r) * (per_product * line * line);
            [e + motion, e + 2.0 * motion]
        }
    }

    /// Error of the modelled EMF, q and d, corrected by the residual of the period that has ended.
    pub(super) fn corrected_error(&self, [x, y]: [f64; 2], shape: &Vector2<f64>) -> [f64; 2] {
        if self.state.timing.edges < 2 {
            return self.state.emf_error;
        }
        let believed = |volts: f64| volts.clamp(-self.emf_error_limit, self.emf_error_limit);
        let residual = from_ab(x, y) * OBSERVER_GAIN;
        [
            believed(self.state.emf_error[0] + residual.dot(shape)),
            believed(self.state.emf_error[1] + shape.perp(&residual) / 3_f64.sqrt()),
        ]
    }

    /// Observed EMF of phases a, b less the expected one, in the period that ends with the currents
    /// `i`.
    pub(super) fn residual(&self, i: [f64; 2]) -> [f64; 2] {
        let most = self.emf_error_limit;
        to_ab(&self.behind(self.state.net_prev, i)).map(|volts| volts.clamp(-most, most))
    }

    /// Count of the residual watch after a period with this residual of phases a, b; the EMF's error
    /// is that after it.
    pub(super) fn counted_residual(
        &self,
        residual: [f64; 2],
        [q, d]: [f64; 2],
        [current, step_angle]: [f64; 2],
    ) -> f64 {
        let [a, b] = residual.map(f64::abs);
        let [least, per_ampere, per_speed, unseen] = self.allowed_residual;
        let learnt = q.abs().max(2.0 * d.abs());
        let (seen, by_speed) = if self.state.timing.edges >= 2 {
            (learnt, per_speed * step_angle.abs() / self.t_s)
        } else {
            (a.max(b) - learnt, unseen)
        };
        let allowed = least + per_ampere * current.abs() + by_speed;
        let step = if seen > allowed { 1.0 } else { -1.0 };
        let most = f64::from(self.variant.options.residual_periods);
        (self.state.residual_count + step).clamp(0.0, most)
    }

    /// The modelled EMF plus its error, by the shape at the angle `theta`.
    pub(super) fn corrected_emf(
        &self,
        e: &Vector2<f64>,
        [q, d]: [f64; 2],
        (theta, shape): (f64, &Vector2<f64>),
    ) -> Vector2<f64> {
        let stretch = |mean| self.shape.stretch(mean, theta);
        let along = q + q * self.stretch_mean.map_or(0.0, stretch);
        let across = Vector2::new(-shape.y, shape.x) * 3_f64.sqrt();
        let most = 2.0 * self.emf_error_limit;
        let [e_a, e_b] = to_ab(&(e + shape * along + across * d));
        from_ab(e_a.clamp(-most, most), e_b.clamp(-most, most))
    }
}
