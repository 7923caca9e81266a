//! Residual watch: counts the periods in which the currents did not follow the voltages (shared
//! semantics page, "Residual watch").

use crate::blocks::set_point::SetPointWords;
use crate::blocks::{Lowering, Rotor};
use crate::diagnostics::{engineering, significant};
use crate::ir::{Coefficient, Expr, Interval, Memory, Phases, named};
use crate::spec::Spec;
use std::f64::consts::TAU;

/// The state word.
pub const RESIDUAL_COUNT: &str = "residual_count";

/// Part of R I allowed: a resistance of twice the stated one behind a bus 15 % low is 1.35; a phase
/// current is up to 2/sqrt(3) times the set-point.
const RESISTANCE: f64 = 1.6;

/// Part of the EMF allowed: its constant 20 % high behind a bus 15 % low is 0.41, and Hall sensors 5
/// degrees off 0.09.
const EMF: f64 = 0.5;

/// Part of w L I allowed: an inductance 30 % high behind a bus 15 % low is 0.53, of which the watch
/// sees up to 2/sqrt(3) more, and a phase current is up to 2/sqrt(3) times the set-point.
const REACTANCE: f64 = 0.7;

/// Part of the EMF allowed while the angle is unknown, up to the speed at which a start no longer waits
/// for it: the whole, 20 % high behind a bus 15 % low, and a rotor that runs up meanwhile.
const UNSEEN_EMF: f64 = 1.5;

/// Dead time that is not stated, second: 1 us, with a margin.
const DEAD_TIME: f64 = 1.5e-6;

/// The residual that wrong motor data, bus, dead time and Hall sensors may cause.
#[derive(Clone, Copy, Debug)]
pub struct Allowance {
    /// Whatever the current and the speed, volt.
    always: f64,
    /// Volt per ampere of the set-point.
    per_ampere: f64,
    /// Volt per electrical rad/s.
    per_speed: f64,
    /// In place of the part by speed while the angle is unknown, volt.
    unseen: f64,
}

impl Allowance {
    /// Of a drive.
    pub fn of(spec: &Spec) -> Self {
        let (motor, inverter) = (&spec.motor, &spec.inverter);
        let pole_pairs = f64::from(motor.pole_pairs);
        let unseen_speed = match spec.start_periods() {
            0 => inverter.maximum_speed,
            periods => {
                let sectors = TAU / 3.0 * motor.widest_sector();
                sectors / (f64::from(periods) * inverter.t_s * pole_pairs)
            }
        };
        let flux = motor.emf_constant / pole_pairs;
        Self {
            // The mean zero-sum voltage that a dead time takes at most.
            always: 4.0 / 3.0 * inverter.v_bus * DEAD_TIME / inverter.pwm_period(),
            per_ampere: RESISTANCE * motor.resistance,
            per_speed: EMF * flux + REACTANCE * motor.inductance * inverter.max_current,
            unseen: UNSEEN_EMF * motor.emf_constant * unseen_speed,
        }
    }

    /// At a set-point, ampere, and a speed, electrical rad/s, volt.
    pub fn at(self, current: f64, omega_e: f64) -> f64 {
        self.always + self.per_ampere * current + self.per_speed * omega_e
    }
}

/// Periods in which the currents did not follow the voltages.
#[derive(Clone, Copy, Debug)]
pub struct ResidualWatch<'b> {
    count: Memory<'b>,
    /// The set-point's gain, V/A.
    gain: f64,
}

impl<'b> ResidualWatch<'b> {
    /// Declares the count, up to that of `periods`.
    pub fn new(l: &Lowering<'b>, periods: u32, set_point: &SetPointWords<'b>) -> Self {
        let doc = "Periods in which the currents did not follow the voltages, less those in which they did.";
        let range = Interval::new(0, i64::from(periods));
        Self {
            count: l.b.memory(RESIDUAL_COUNT, 0, range, doc),
            gain: set_point.gain.value,
        }
    }

    /// The residual allowed at a set-point and a speed; added to the open stage.
    fn allowed(
        l: &Lowering<'b>,
        allowance: &Allowance,
        [k_current, k_speed]: [Coefficient; 2],
        rotor: &Rotor<'b>,
        j: Expr<'b>,
    ) -> Expr<'b> {
        let Allowance { always, unseen, .. } = *allowance;
        let doc = format!("Residual allowed always, {}.", engineering(always, "V"));
        let always = l.number("residual_least", l.volts_word(always), &doc);
        let by_speed = k_speed * rotor.step_angle.abs();
        let doc = format!(
            "Residual allowed while the angle is unknown, {}.",
            engineering(unseen, "V")
        );
        let unseen = l.number("residual_unseen", l.volts_word(unseen), &doc);
        named! {
            let residual_by_speed = rotor.tracking.choose(by_speed, unseen);
        }
        k_current * j.abs() + residual_by_speed + always
    }

    /// Coefficients of the allowed residual: by set-point, and by the angle of a period.
    fn coefficients(&self, l: &Lowering<'b>, allowance: &Allowance) -> [Coefficient; 2] {
        let Allowance {
            per_ampere,
            per_speed,
            ..
        } = *allowance;
        let by_current = l.coefficient(
            "k_residual_j",
            per_ampere / self.gain,
            32,
            "Residual allowed per set-point.",
            &format!("1.6 R/K = {}", significant(per_ampere / self.gain)),
        );
        let doc = "Residual allowed per angle of a period.";
        let by_speed = l.voltage_by_turn("k_residual_w", per_speed, doc);
        [by_current, by_speed]
    }

    /// The count and its new value, from the residual of this period, the observed error, q and d, and
    /// the set-point.
    pub fn watch(
        &self,
        l: &Lowering<'b>,
        residual: Phases<'b>,
        [q, d]: [Expr<'b>; 2],
        rotor: &Rotor<'b>,
        j: Expr<'b>,
    ) -> (Memory<'b>, Expr<'b>) {
        let allowance = Allowance::of(l.spec);
        let coefficients = self.coefficients(l, &allowance);
        l.b.stage(
            "watch_residual",
            &[
                "Counts up in a period in which the EMF error is beyond what wrong motor data, bus, dead time and Hall sensors explain,",
                "else down. The d component is stored over sqrt(3): twice it is an upper bound. Without an angle nothing is learnt: the",
                "residual counts, less the error last learnt, which may stand the wrong way round.",
            ],
        );
        let count = self.count.read();
        let most = count.interval().high as i32;
        named! {
            let residual_allowed = Self::allowed(l, &allowance, coefficients, rotor, j);
            let residual_learnt = q.abs().max(d.abs() << 1);
            let residual_now = residual.a().abs().max(residual.b().abs());
            let residual_seen = rotor.tracking.choose(residual_learnt, residual_now - residual_learnt);
            let beyond = residual_seen.is_above(residual_allowed);
            let residual_count_next = (count + beyond.choose(1, -1)).clamp(0, most);
        }
        (self.count, residual_count_next)
    }
}
