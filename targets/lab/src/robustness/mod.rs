//! The robustness sheet as data: controllers in closed loop on plants that differ from the motor
//! file in one parameter, and the ratings of these runs.

mod csv;
mod disturbance;
mod sheet;

pub use csv::csv;
pub use sheet::{measured, robustness};

use crate::closed_loop::{FiguresOfMerit, Trip};
use crate::engine::EngineKind;
use serde::Serialize;

/// Swing of the voltage, in percent of the bus, above which a controller with a modulator counts as
/// oscillating. Beside the edges of the stable range stable loops stay below 8, unstable ones above 45.
const SWINGING: f64 = 20.0;

/// Ratio to the undisturbed ripple above which a controller of whole vectors counts as oscillating:
/// it swings by a vector in every period on any plant.
const SWINGING_RIPPLE: f64 = 2.5;

/// Thresholds of the colours in points.
const STEPS: [f64; 3] = [1.0, 3.0, 10.0];

/// The criterion of oscillation, for reports.
pub const SWING_RULE: &str = "A run oscillates if the median, over its control periods, of the second difference of the mean \
    voltage exceeds 20 % of the bus: a loop with poles outside the unit circle grows until the legs bound its voltage, while \
    commutations are too rare to affect a median. FCS-MPC and PHCC swing by a whole vector each period by design; they \
    oscillate if their RMS ripple exceeds 2.5 times that of the undisturbed plant at this speed.";

/// Controllers over disturbances.
#[derive(Clone, Debug, Serialize)]
pub struct Robustness {
    /// Mechanical speeds in rpm, ascending.
    pub speeds_rpm: Vec<f64>,
    /// Names of the disturbances; the first one is the undisturbed plant.
    pub disturbances: Vec<String>,
    /// One column of the sheet per controller.
    pub controllers: Vec<Column>,
}

/// One controller over all disturbances and speeds.
#[derive(Clone, Debug, Serialize)]
pub struct Column {
    /// Controller variant.
    pub controller: String,
    /// Why it cannot be generated; then it has no cells.
    pub refused: Option<String>,
    /// One cell per disturbance and speed, in the order of the disturbances.
    pub cells: Vec<Cell>,
}

/// One controller under one disturbance at one speed.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// Name of the disturbance.
    pub disturbance: String,
    /// Mechanical speed in rpm.
    pub rpm: f64,
    /// Why this plant or its drive is impossible: a refused specification, a value out of range.
    pub refused: Option<String>,
    /// The result, if possible.
    #[serde(flatten)]
    pub figures: Option<DisturbedFigures>,
}

/// Result of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DisturbedFigures {
    /// Engine of the fixed-point program.
    pub engine: EngineKind,
    /// Torque in newton metres of the demanded current on this plant's EMF constant.
    pub expected_torque_nm: f64,
    /// Mean torque in newton metres. This and the following figures are `None` for a drive that
    /// tripped.
    pub mean_torque_nm: Option<f64>,
    /// Peak-to-peak ripple in percent of the mean; `None` for a zero mean.
    pub ripple_pp_pct: Option<f64>,
    /// RMS ripple in percent of the mean, likewise.
    pub ripple_rms_pct: Option<f64>,
    /// Swing of the mean voltage in percent of the bus voltage.
    pub swing_voltage_pct: Option<f64>,
    /// Outcome of the run.
    pub outcome: Outcome,
    /// Trip of the drive.
    pub tripped: Option<Trip>,
    /// Deviation from the undisturbed run.
    pub heat: Heat,
}

/// Outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// In control.
    Runs,
    /// Oscillating: see [`SWING_RULE`].
    Oscillates,
    /// Tripped.
    Trips,
}

impl Outcome {
    /// Its name in files and cells.
    pub fn name(self) -> &'static str {
        match self {
            Self::Runs => "runs",
            Self::Oscillates => "oscillates",
            Self::Trips => "trips",
        }
    }
}

/// Deviation of a cell from the undisturbed run of the same controller at the same speed: the
/// larger of the change of mean torque in percent of the plant's torque at this current, and of the
/// added RMS ripple in points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Heat {
    /// Below 1 point.
    None,
    /// Below 3.
    Slight,
    /// Below 10.
    Marked,
    /// 10 and more.
    Strong,
    /// It oscillates or trips.
    Broken,
}

impl Heat {
    /// All of them, from the least.
    pub const ALL: [Self; 5] = [
        Self::None,
        Self::Slight,
        Self::Marked,
        Self::Strong,
        Self::Broken,
    ];

    /// Its name in files and style sheets.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Slight => "slight",
            Self::Marked => "marked",
            Self::Strong => "strong",
            Self::Broken => "broken",
        }
    }

    /// Its text in legends.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::None => "within 1 point of the undisturbed run",
            Self::Slight => "1 to 3 points",
            Self::Marked => "3 to 10 points",
            Self::Strong => "10 points or more",
            Self::Broken => "oscillates or trips",
        }
    }
}

/// A run before its comparison with the undisturbed one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Engine of the fixed-point program.
    pub engine: EngineKind,
    /// Whether the controller has a modulator; else it chooses whole vectors.
    pub modulates: bool,
    /// Torque in newton metres of the demanded current on this plant's EMF constant.
    pub expected_torque: f64,
    /// Figures of merit.
    pub figures: FiguresOfMerit,
    /// The largest swing of the mean voltage of the starts, in percent of the bus voltage.
    pub swing: f64,
    /// What tripped the drive.
    pub tripped: Option<Trip>,
}

impl Measured {
    /// Compares with the undisturbed run at the same speed.
    pub fn judged(&self, undisturbed: &Self) -> DisturbedFigures {
        let figures = &self.figures;
        let swing = Some(self.swing).filter(|_| self.tripped.is_none());
        let outcome = if self.tripped.is_some() {
            Outcome::Trips
        } else if self.oscillates(undisturbed) {
            Outcome::Oscillates
        } else {
            Outcome::Runs
        };
        DisturbedFigures {
            engine: self.engine,
            expected_torque_nm: self.expected_torque,
            mean_torque_nm: figures.mean_torque_nm,
            ripple_pp_pct: figures.ripple_pp_pct,
            ripple_rms_pct: figures.ripple_rms_pct,
            swing_voltage_pct: swing,
            outcome,
            tripped: self.tripped,
            heat: match outcome {
                Outcome::Runs => self.heat(undisturbed),
                Outcome::Oscillates | Outcome::Trips => Heat::Broken,
            },
        }
    }

    fn oscillates(&self, undisturbed: &Self) -> bool {
        if self.modulates {
            self.swing > SWINGING
        } else {
            let ripples = self
                .figures
                .ripple_rms_pct
                .zip(undisturbed.figures.ripple_rms_pct);
            ripples.is_some_and(|(own, calm)| own > SWINGING_RIPPLE * calm)
        }
    }

    fn heat(&self, undisturbed: &Self) -> Heat {
        let figures = |run: &Self| {
            let torque = 100.0 * run.figures.mean_torque_nm? / run.expected_torque;
            Some((torque, run.figures.ripple_rms_pct?))
        };
        // A run without torque has no ripple in percent of it: the deviation is large.
        let Some((own, calm)) = figures(self).zip(figures(undisturbed)) else {
            return Heat::Strong;
        };
        let (torque, ripple) = ((own.0 - calm.0).abs(), own.1 - calm.1);
        let is_within = |points: &f64| torque < *points && ripple < *points;
        match STEPS.iter().position(is_within) {
            Some(0) => Heat::None,
            Some(1) => Heat::Slight,
            Some(_) => Heat::Marked,
            None => Heat::Strong,
        }
    }
}

impl Robustness {
    /// The cell of a controller, by the indices of its disturbance and speed.
    pub fn cell<'c>(
        &self,
        column: &'c Column,
        disturbance: usize,
        speed: usize,
    ) -> Option<&'c Cell> {
        column
            .cells
            .get(disturbance * self.speeds_rpm.len() + speed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::Cause;

    fn run(mean_torque: f64, ripple_rms_pct: impl Into<Option<f64>>) -> Measured {
        Measured {
            engine: EngineKind::Compiled,
            modulates: true,
            expected_torque: 2.0,
            figures: FiguresOfMerit {
                mean_torque_nm: Some(mean_torque),
                ripple_rms_pct: ripple_rms_pct.into(),
                ..FiguresOfMerit::default()
            },
            swing: 0.0,
            tripped: None,
        }
    }

    #[test]
    fn heat_is_the_larger_distance_of_torque_and_added_ripple() {
        let undisturbed = run(1.98, 1.0);
        let heat = |measured: Measured| measured.judged(&undisturbed).heat;
        for (torque, ripple, expected) in [
            (1.98, 1.0, Heat::None),
            (1.97, 1.9, Heat::None),
            (2.01, 1.0, Heat::Slight),
            (1.98, 3.5, Heat::Slight),
            (1.80, 1.0, Heat::Marked),
            (1.98, 12.0, Heat::Strong),
            (1.70, 1.0, Heat::Strong),
            // Less ripple is no deviation.
            (1.98, 0.0, Heat::None),
        ] {
            assert_eq!(heat(run(torque, ripple)), expected, "{torque} {ripple}");
        }
        assert_eq!(heat(run(0.0, None)), Heat::Strong);
        // Another EMF constant gives another torque from the same current.
        let stronger = Measured {
            expected_torque: 2.6,
            ..run(2.6 * 0.99, 1.0)
        };
        assert_eq!(heat(stronger), Heat::None);
    }

    #[test]
    fn outcomes_follow_the_documented_rule() {
        let undisturbed = run(2.0, 4.0);
        let swing = |swing| Measured {
            swing,
            ..undisturbed
        };
        let outcome = |measured: Measured| measured.judged(&undisturbed).outcome;
        assert_eq!(outcome(swing(19.9)), Outcome::Runs);
        assert_eq!(outcome(swing(20.1)), Outcome::Oscillates);
        for part in ["20 % of the bus", "2.5 times"] {
            assert!(SWING_RULE.contains(part), "{part}");
        }
        // Whole vectors swing by design: only ripple counts.
        let chooses = |ripple| Measured {
            modulates: false,
            swing: 90.0,
            ..run(2.0, ripple)
        };
        assert_eq!(outcome(chooses(9.9)), Outcome::Runs);
        assert_eq!(outcome(chooses(10.1)), Outcome::Oscillates);
        let tripped = Measured {
            tripped: Some(Trip {
                fault: Cause::OverCurrent,
                time_s: 0.01,
                rpm: 100.0,
            }),
            figures: FiguresOfMerit::default(),
            ..chooses(10.1)
        };
        let figures = tripped.judged(&undisturbed);
        assert_eq!(
            (figures.outcome, figures.heat),
            (Outcome::Trips, Heat::Broken)
        );
        // A tripped drive has no figures of merit, and no swing.
        assert_eq!(figures.swing_voltage_pct, None);
        assert_eq!(
            chooses(1.0).judged(&undisturbed).swing_voltage_pct,
            Some(90.0)
        );
    }
}
