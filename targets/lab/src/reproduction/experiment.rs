//! The figures of one reading, and the comparisons of which claims consist.
//!
//! A drive with a mean torque below half of the demand at a speed has lost its current; its other
//! figures there are meaningless, and comparisons with them have no outcome.

use super::data::{Method, Point, Reading, Reproduction, Run};
use super::judge::Finding;
use super::timing::CLOCK_HZ;
use crate::closed_loop::{Held, LimitOutcome, Side};

/// Fraction of the demand below which a drive has lost its current.
const LOST: f64 = 0.5;

/// Settings of all runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Demanded torque in newton metres.
    pub torque: f64,
    /// Amplitude of the quasi-square reference in amperes.
    pub current: f64,
    /// The two speeds in rpm.
    pub speeds_rpm: [f64; 2],
    /// Processor cycles in a control period.
    pub period_cycles: f64,
}

/// Figures of a drive at one speed; empty for a drive that tripped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtSpeed {
    /// Mean torque in newton metres.
    pub mean_torque_nm: Option<f64>,
    /// 6th harmonic of the torque in percent of its mean.
    pub h6_pct: Option<f64>,
    /// 12th harmonic, likewise.
    pub h12_pct: Option<f64>,
    /// 5th harmonic of the phase current in percent of the fundamental.
    pub i5_pct: Option<f64>,
    /// 7th harmonic, likewise.
    pub i7_pct: Option<f64>,
    /// RMS distance of the current from the ideal hexagon's outline in amperes.
    pub hexagon_rms_a: Option<f64>,
    /// Turn-ons per device and second.
    pub switching_hz: Option<f64>,
}

/// Figures of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Constant-torque speed limit in percent of rated speed; 0 if the torque is never held.
    pub limit_pct: f64,
    /// At the two speeds.
    pub speeds: [AtSpeed; 2],
    /// Cycles of the worst step.
    pub cycles: u32,
    /// Cycles of a usual step; `None` for a drive that trips.
    pub usual_cycles: Option<u32>,
}

/// The figures of one reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Experiment {
    /// Settings of all runs.
    pub setting: Setting,
    /// The drives, methods in the paper's order.
    pub methods: [Figures; 4],
}

impl Reproduction {
    /// Settings of the claims.
    pub fn setting(&self) -> Setting {
        Setting {
            torque: self.torque,
            current: self.current,
            speeds_rpm: self.speeds_rpm,
            period_cycles: CLOCK_HZ * self.inverter.t_s,
        }
    }

    /// Figures of a reading for the claims.
    pub fn experiment(&self, reading: Reading) -> Experiment {
        Experiment {
            setting: self.setting(),
            methods: [0, 1, 2, 3].map(|method| figures(self.methods[method].of(reading))),
        }
    }
}

fn figures(run: &Run) -> Figures {
    let [low, high] = [0, 1].map(|speed| {
        let Point {
            figures,
            hexagon_rms_a,
            trip,
            ..
        } = &run.points[speed];
        AtSpeed {
            mean_torque_nm: figures.mean_torque_nm,
            h6_pct: figures.h6_pct,
            h12_pct: figures.h12_pct,
            i5_pct: figures.i5_pct,
            i7_pct: figures.i7_pct,
            hexagon_rms_a: trip.is_none().then_some(*hexagon_rms_a),
            switching_hz: figures.switching_hz,
        }
    });
    Figures {
        limit_pct: match run.limit.outcome {
            LimitOutcome::NeverHeld => 0.0,
            // If the scan ended without a limit, its end is a lower bound.
            LimitOutcome::Found | LimitOutcome::NotReached => run.limit.limit_pct.unwrap_or(0.0),
        },
        speeds: [low, high],
        cycles: run.cost.worst_cycles(),
        usual_cycles: run.usual_cycles(),
    }
}

/// A figure of a drive at a speed.
pub type Of = fn(&AtSpeed) -> Option<f64>;

impl Experiment {
    fn drive(&self, method: Method) -> &Figures {
        &self.methods[method.index()]
    }

    fn is_lost(&self, method: Method, speed: usize) -> bool {
        let torque = self.drive(method).speeds[speed].mean_torque_nm;
        !torque.is_some_and(|torque| torque / self.setting.torque >= LOST)
    }

    /// A figure at a speed; `None` for a drive that has lost its current.
    pub fn at(&self, method: Method, speed: usize, of: Of) -> Option<f64> {
        let figure = of(&self.drive(method).speeds[speed]);
        figure.filter(|_| !self.is_lost(method, speed))
    }

    /// The speed limit in percent; `None` for a drive that has lost its current at both speeds.
    pub fn limit(&self, method: Method) -> Option<f64> {
        let is_lost = self.is_lost(method, 0) && self.is_lost(method, 1);
        (!is_lost).then(|| self.drive(method).limit_pct)
    }

    /// The speed limits of all methods in percent, in the paper's order.
    pub fn limits(&self) -> String {
        let texts = Method::ALL.map(|method| match self.limit(method) {
            Some(limit) if limit <= 0.0 => "never".to_owned(),
            limit => self.text(method, limit, 0),
        });
        texts.join(" / ")
    }

    /// A figure of all methods, in the paper's order: "1.2 / 0.4 / tripped / 3".
    pub fn row(&self, figure: impl Fn(Method) -> Option<f64>, decimals: usize) -> String {
        let texts = Method::ALL.map(|method| self.text(method, figure(method), decimals));
        texts.join(" / ")
    }

    /// A method's figure; "tripped", or a dash if it has lost its current without a trip.
    fn text(&self, method: Method, figure: Option<f64>, decimals: usize) -> String {
        // Only a drive that trips has no usual step.
        if figure.is_none() && self.drive(method).usual_cycles.is_none() {
            return "tripped".to_owned();
        }
        number(figure, decimals)
    }

    /// Whether the mean torque falls short of the demand.
    pub fn misses(&self, method: Method, speed: usize) -> Finding {
        let Some(torque) = self.at(method, speed, |at| at.mean_torque_nm) else {
            return lost(method);
        };
        Finding {
            outcome: Some(Held::AtLeast.lost(torque, self.setting.torque) == Some(Side::Below)),
            why: format!("{torque:.2} Nm of {:.2} Nm", self.setting.torque),
        }
    }

    /// Whether a method's figure is above, or below, those of all others.
    pub fn is_extreme(
        &self,
        which: Extreme,
        method: Method,
        others: &[Method],
        figure: impl Fn(Method) -> Option<f64>,
        unit: &str,
    ) -> Finding {
        let Some(own) = figure(method) else {
            return lost(method);
        };
        let beyond = |other: f64| match which {
            Extreme::Most => other >= own,
            Extreme::Least => other <= own,
        };
        let mut farthest: Option<(Method, f64)> = None;
        let mut unknown = None;
        for &other in others {
            match figure(other) {
                None => unknown = Some(other),
                Some(value) => {
                    let is_farther = farthest.is_none_or(|(_, most)| match which {
                        Extreme::Most => value > most,
                        Extreme::Least => value < most,
                    });
                    if is_farther {
                        farthest = Some((other, value));
                    }
                }
            }
        }
        // One contrary drive refutes the statement, whatever the lost ones would have done.
        let is_refuted = farthest.is_some_and(|(_, value)| beyond(value));
        if let (false, Some(unknown)) = (is_refuted, unknown) {
            return lost(unknown);
        }
        let against = farthest.map_or_else(String::new, |(other, value)| {
            format!("; {} {}", other.name(), short(value))
        });
        Finding {
            outcome: Some(!is_refuted),
            why: format!("{} {}{against} {unit}", method.name(), short(own)),
        }
    }
}

/// Direction of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// Above all others.
    Most,
    /// Below all others.
    Least,
}

/// No outcome, since a drive has lost its current.
pub fn lost(method: Method) -> Finding {
    Finding {
        outcome: None,
        why: format!("{} has lost its current", method.name()),
    }
}

/// A number with fixed decimals; a dash for `None`.
pub fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(
        || "\u{2013}".to_owned(),
        |value| format!("{value:.decimals$}"),
    )
}

/// Three digits, none after the point from 100 on; zero as it is.
pub fn short(value: f64) -> String {
    let decimals = match value.abs() {
        0.0 => 0,
        x if x < 9.995 => 2,
        x if x < 99.95 => 1,
        _ => 0,
    };
    format!("{value:.decimals$}")
}
