//! The torque constant, learnt while hardly any current flows ("Learning of the torque constant" on the
//! shared semantics page).
//!
//! Under load the error of the modelled EMF along the shape mixes the EMF constant with resistance and dead
//! time. With no current, and the bus measured, it is the constant's alone.

use super::set_point::SetPointWords;
use super::{Lowering, Rotor};
use crate::diagnostics::{engineering, significant};
use crate::ir::{Coefficient, Demand, Expr, Interval, Memory, Param, named};

/// The state word: stated over learnt torque constant.
pub const TORQUE_RATIO: &str = "torque_ratio";

/// Fraction bits of the ratio.
const RATIO_BITS: u32 = 28;

/// A ratio of 1.
const ONE: i32 = 1 << RATIO_BITS;

/// Least and greatest ratio: a torque constant of 1.5 times and of two thirds of the stated one.
const LIMITS: [f64; 2] = [2.0 / 3.0, 1.5];

/// EMF over the drop across the resistance above which the current is little: a resistance of twice the stated one reads
/// as half a percent of the constant.
const LITTLE: f64 = 200.0;

/// Least EMF that tells the constant, over the nominal bus.
const LEAST_EMF: f64 = 1.0 / 16.0;

/// EMF along the shape over the bus, up to which it tells the constant: 85 % of the line-to-line peak of a sine.
const FREE: f64 = 0.85 * 0.577_350_269_189_625_8;

/// Periods of little current behind which the observed error has settled: nine tenths of it fall in 24.
const SETTLED: i32 = 64;

/// How much of its error the ratio loses in a period at an EMF as large as the nominal bus; less in proportion to a smaller EMF.
const GAIN: f64 = 1.0 / 64.0;

/// The words.
#[derive(Clone, Copy, Debug)]
pub struct TorqueLearning<'b> {
    ratio: Memory<'b>,
    /// Periods of little current in a row.
    light: Memory<'b>,
    /// 1 while the bus voltage is fresh.
    bus_is_fresh: Param<'b>,
    /// The set-point's gain, V/A.
    gain: f64,
    /// Voltage along the shape per angle of a period.
    k_along: Coefficient,
}

impl<'b> TorqueLearning<'b> {
    /// Declares the words.
    pub fn new(l: &Lowering<'b>, set_point: &SetPointWords<'b>) -> Self {
        let [least, most] = limits();
        let doc = "Stated over learnt torque constant, 28 fraction bits.";
        let ratio =
            l.b.memory(TORQUE_RATIO, ONE, Interval::new(least, most), doc);
        let doc = "Control periods in a row whose current is little beside the EMF, at most 64.";
        let light =
            l.b.memory("light_periods", 0, Interval::new(0, SETTLED.into()), doc);
        let doc = "1 while the bus voltage is fresh, else 0.";
        let bus_is_fresh = l.b.param(
            Demand::BusIsFresh,
            "bus_is_fresh",
            0,
            Interval::new(0, 1),
            doc,
        );
        // What the observer makes of an EMF k_phase omega f: its projection on the shape, 2/3 k_t/k_phase f/|f|^2.
        let motor = &l.spec.motor;
        let flux = motor.emf_constant / f64::from(motor.pole_pairs);
        let along = 1.5 * motor.emf_constant
            / (l.spec.torque_constant() * motor.emf_shape.mean_inverse_square());
        let doc = "Modelled EMF along the shape per angle of a period.";
        Self {
            ratio,
            light,
            bus_is_fresh,
            gain: set_point.gain.value,
            k_along: l.voltage_by_turn("k_along", along * flux, doc),
        }
    }

    /// Moves the ratio, from the EMF's error along the shape in the last step. Added to the tracking.
    pub fn learn(self, l: &Lowering<'b>, rotor: &Rotor<'b>, error: Expr<'b>) {
        let old = self.ratio.read();
        named! {
            let is_told = rotor.tracking & self.light.read().is_at_least(SETTLED);
        }
        l.b.guarded_stage(
            "learn_torque",
            is_told,
            true,
            &[
                "Torque constant: without current the error of the modelled EMF along the shape is that of its constant. The ratio",
                "moves until it takes the EMF that is seen to the modelled one.",
            ],
        );
        let bus = l.spec.inverter.v_bus * l.scale.voltage();
        let gain = GAIN * f64::from(ONE) / bus;
        let doc = "Rise of the ratio per voltage.";
        let k_learn = l.coefficient("k_learn", gain, 32, doc, &significant(gain));
        let [least, most] = limits();
        let doc = "Least ratio: a torque constant of 1.5 times the stated one.";
        let least = l.number("torque_ratio_min", least, doc);
        let doc = "Greatest ratio: a torque constant of two thirds of the stated one.";
        let most = l.number("torque_ratio_max", most, doc);
        named! {
            let emf_along = self.k_along * rotor.step_angle;
            let emf_seen = emf_along + error;
            let emf_beyond = emf_along - emf_seen.mul_floor(old, RATIO_BITS);
            let ratio_rise = k_learn * rotor.step_angle.is_at_least(0).sign(emf_beyond);
            let ratio_told = (old + ratio_rise).clamp(least, most);
        }
        let [ratio] = l.b.join([("torque_ratio_new", ratio_told, old)]);
        self.ratio.set(ratio);
    }

    /// Counts the periods in which the EMF tells the constant; `j`: the set-point in force, `error`: that of the EMF along
    /// the shape.
    pub fn follow(
        self,
        l: &Lowering<'b>,
        rotor: &Rotor<'b>,
        [j, error, v_bus]: [Expr<'b>; 3],
    ) -> (Memory<'b>, Expr<'b>) {
        l.b.stage(
            "watch_torque",
            &[
                "Counts the periods in a row in which the EMF is large beside the drop across the resistance at the set-point, and",
                "well below the bus, beyond which it drives a current whatever is asked; none with an old bus voltage."
            ],
        );
        let drop = LITTLE * l.spec.motor.resistance / self.gain;
        let k_drop = l.coefficient(
            "k_little",
            drop,
            32,
            "200 times the drop across the resistance per set-point.",
            &format!("200 R/K = {}", significant(drop)),
        );
        let doc = "EMF along the shape over the bus, up to which it tells the constant.";
        let k_free = l.coefficient("k_free", FREE, 32, doc, "0.85/sqrt(3)");
        let least = LEAST_EMF * l.spec.inverter.v_bus;
        let doc = format!(
            "Least EMF that tells the torque constant, {}.",
            engineering(least, "V")
        );
        let least = l.number("light_least", l.volts_word(least), &doc);
        named! {
            let emf_now = self.k_along * rotor.step_angle;
            let is_unloaded = emf_now.abs().is_above(k_drop * j.abs() + least);
            let is_free = (k_free * v_bus).is_above((emf_now + error).abs());
            let is_known = self.bus_is_fresh.read().is_at_least(1);
            let light_new = (is_unloaded & is_free & is_known).choose((self.light.read() + 1).min(SETTLED), 0);
        }
        (self.light, light_new)
    }
}

/// Limits of the ratio, words.
fn limits() -> [i64; 2] {
    LIMITS.map(|ratio| (ratio * f64::from(ONE)).round() as i64)
}
