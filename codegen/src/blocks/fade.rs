//! Fade of the set-point with the bus voltage (shared semantics page, "Fades").

use super::Lowering;
use super::set_point::SetPointWords;
use crate::diagnostics::{engineering, significant};
use crate::ir::{Expr, Interval, named};
use crate::spec::{BusSource, Fade};

/// The set-point's limits with a measured bus: braking torque ends towards the greatest voltage,
/// motoring torque towards the least.
#[derive(Clone, Copy, Debug)]
pub struct BusFade {
    braking: Option<Fade>,
    motoring: Option<Fade>,
    /// The set-point's gain, V/A.
    gain: f64,
    /// Range of the set-point word.
    range: Interval,
}

/// Least and greatest set-point word.
#[derive(Clone, Copy, Debug)]
pub struct Allowed<'b> {
    least: Expr<'b>,
    most: Expr<'b>,
}

impl<'b> Allowed<'b> {
    /// Limits of either sign, within others.
    pub fn of_either_way(most: Expr<'b>, others: Option<Self>) -> Self {
        let (least, most) = match others {
            None => (-most, most),
            Some(others) => {
                named! {
                    let j_left = most;
                }
                (others.least.max(-j_left), others.most.min(j_left))
            }
        };
        named! {
            let j_bus_least = least;
            let j_bus_most = most;
        }
        Self {
            least: j_bus_least,
            most: j_bus_most,
        }
    }

    /// A set-point within the limits.
    pub fn limit(self, j: Expr<'b>) -> Expr<'b> {
        j.max(self.least).min(self.most)
    }
}

impl BusFade {
    /// None without a fade.
    pub fn new(l: &Lowering<'_>, set_point: &SetPointWords<'_>) -> Option<Self> {
        let BusSource::Measured {
            braking, motoring, ..
        } = l.spec.inverter.bus
        else {
            return None;
        };
        (braking.is_some() || motoring.is_some()).then(|| Self {
            braking,
            motoring,
            gain: set_point.gain.value,
            range: set_point.j.interval(),
        })
    }

    /// The limits at a bus voltage and a direction of rotation, 1, -1, or 0 before the first edge: then
    /// both ways are motoring.
    pub fn allowed<'b>(
        &self,
        l: &Lowering<'b>,
        v_bus: Expr<'b>,
        direction: Expr<'b>,
    ) -> Allowed<'b> {
        l.b.stage(
            "fade_set_point",
            &[
                "Limits of the set-point by the bus voltage: of what brakes and of what drives the rotor. Before the first",
                "Hall edge both ways count as driving.",
            ],
        );
        let none = l.number("fade_free", self.range.high, "No limit of the set-point.");
        let braking = self.braking.map_or(none, |fade| {
            let names = ["braking_none", "braking_width", "k_braking"];
            self.greatest(l, fade, names, |none| none - v_bus)
        });
        let motoring = self.motoring.map_or(none, |fade| {
            let names = ["motoring_none", "motoring_width", "k_motoring"];
            self.greatest(l, fade, names, |none| v_bus - none)
        });
        named! {
            let j_braking = braking;
            let j_motoring = motoring;
            let fade_most = direction.is(-1).choose(j_braking, j_motoring);
            let fade_least = -direction.is(1).choose(j_braking, j_motoring);
        }
        Allowed {
            least: fade_least,
            most: fade_most,
        }
    }

    /// The greatest set-point, from the distance of the bus voltage to that at which there is none.
    fn greatest<'b>(
        &self,
        l: &Lowering<'b>,
        fade: Fade,
        [none_name, width_name, factor_name]: [&'static str; 3],
        distance: impl FnOnce(Expr<'b>) -> Expr<'b>,
    ) -> Expr<'b> {
        let width = (fade.full - fade.none).abs();
        let most = l.spec.inverter.max_current * self.gain;
        let doc = format!(
            "Bus voltage at which the set-point is 0, {}, words of voltage.",
            engineering(fade.none, "V")
        );
        let none = l.number(none_name, l.volts_word(fade.none), &doc);
        let doc = format!(
            "Distance at which it is the largest, {}, words of voltage.",
            engineering(width, "V")
        );
        let full = l.number(width_name, l.volts_word(width), &doc);
        let factor = l.coefficient(
            factor_name,
            most / width,
            32,
            "Set-point as a voltage over the distance.",
            &format!("K max_current/width = {}", significant(most / width)),
        );
        factor * distance(none).clamp(0, full)
    }
}
