//! Expected figures of a run, and their comparison with measured ones.
//!
//! Tolerances: mean torque within 1 %, ripple within 15 % of its value or 0.5 points, speed limit
//! within 2 points of rated speed.

use crate::closed_loop::{FiguresOfMerit, LimitOutcome, SpeedLimit};
use hexagen_codegen::spec::{CurrentSensing, InverterSpec};

/// An expected range; a single value has zero width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Band {
    /// Distance of a measured figure from the band, 0 inside.
    fn distance(self, measured: f64) -> f64 {
        (self.low - measured).max(measured - self.high).max(0.0)
    }

    /// Whether a figure is within a distance of the band; NaN never is.
    fn holds(self, measured: f64, tolerance: f64) -> bool {
        // The margin covers rounding at the limit.
        self.distance(measured) <= tolerance + 1e-9 && !measured.is_nan()
    }
}

impl From<f64> for Band {
    fn from(value: f64) -> Self {
        Self {
            low: value,
            high: value,
        }
    }
}

impl From<(f64, f64)> for Band {
    fn from((low, high): (f64, f64)) -> Self {
        Self { low, high }
    }
}

/// Expectation of a figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expectation {
    /// A range.
    In(Band),
    /// No value: a speed limit of a drive that never holds the torque.
    Never,
}

impl Expectation {
    /// A range as one value or from-to, each value formatted by `show`.
    pub fn text(self, separator: &str, show: impl Fn(f64) -> String) -> String {
        let Self::In(band) = self else {
            return "never".to_owned();
        };
        let (low, high) = (show(band.low), show(band.high));
        if low == high {
            low
        } else {
            format!("{low}{separator}{high}")
        }
    }
}

/// Figures expected at one speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExpectedPoint {
    /// Speed in rpm.
    pub rpm: f64,
    /// Mean torque in newton metres.
    pub mean_torque_nm: Option<Band>,
    /// Peak-to-peak ripple in percent of the mean.
    pub ripple_pp_pct: Option<Band>,
    /// RMS ripple in percent of the mean.
    pub ripple_rms_pct: Option<Band>,
}

/// Figures expected of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expected {
    /// At each speed that has any.
    pub points: Vec<ExpectedPoint>,
    /// Constant-torque speed limit.
    pub limit: Option<Expectation>,
}

/// A measured figure beside the expected one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Measured value; `None` if undefined.
    pub measured: Option<f64>,
    /// Expected value, if any.
    pub expected: Option<Expectation>,
    /// Whether the two agree within the tolerance; true without an expectation.
    pub met: bool,
}

impl Judged {
    fn new(measured: Option<f64>, expected: Option<Band>, tolerance: impl Fn(Band) -> f64) -> Self {
        let met =
            expected.is_none_or(|band| measured.is_some_and(|x| band.holds(x, tolerance(band))));
        Self {
            measured,
            expected: expected.map(Expectation::In),
            met,
        }
    }
}

/// Mean torque against what is expected.
pub fn judge_mean(figures: &FiguresOfMerit, expected: Option<&ExpectedPoint>) -> Judged {
    let band = expected.and_then(|point| point.mean_torque_nm);
    Judged::new(figures.mean_torque_nm, band, |band| 0.01 * band.high.abs())
}

/// Peak-to-peak ripple against what is expected.
pub fn judge_pp(figures: &FiguresOfMerit, expected: Option<&ExpectedPoint>) -> Judged {
    let band = expected.and_then(|point| point.ripple_pp_pct);
    Judged::new(figures.ripple_pp_pct, band, ripple_tolerance)
}

/// RMS ripple against what is expected.
pub fn judge_rms(figures: &FiguresOfMerit, expected: Option<&ExpectedPoint>) -> Judged {
    let band = expected.and_then(|point| point.ripple_rms_pct);
    Judged::new(figures.ripple_rms_pct, band, ripple_tolerance)
}

/// Speed limit in percent of rated speed against what is expected.
pub fn judge_limit(limit: Option<&SpeedLimit>, expected: Option<&Expected>) -> Judged {
    let measured = limit.and_then(|limit| limit.limit_pct);
    match expected.and_then(|expected| expected.limit) {
        Some(Expectation::Never) => Judged {
            measured,
            expected: Some(Expectation::Never),
            met: limit.is_some_and(|limit| limit.outcome == LimitOutcome::NeverHeld),
        },
        Some(Expectation::In(band)) => Judged::new(measured, Some(band), |_| 2.0),
        None => Judged::new(measured, None, |_| 0.0),
    }
}

fn ripple_tolerance(band: Band) -> f64 {
    (0.15 * band.high).max(0.5)
}

impl Expected {
    /// The expectation at a speed in rpm, with a tolerance of half an rpm: speeds that come from
    /// rad/s are not integers.
    pub fn at(&self, rpm: f64) -> Option<&ExpectedPoint> {
        self.points
            .iter()
            .find(|point| (point.rpm - rpm).abs() < 0.5)
    }
}

/// One row of the design document's table.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignRow {
    /// Short name.
    pub label: &'static str,
    /// Its variant; Hall capture by timer.
    pub variant: &'static str,
    /// Figures with Hall edges captured by a timer.
    pub timer: Expected,
    /// Figures with Hall edges seen at sampling instants, where the document gives any.
    pub sampled: Option<Expected>,
    /// Whether the page draws its currents, trajectory, torque and spectrum.
    pub is_plotted: bool,
}

/// The row of a motor file's own controller, of which nothing is expected.
pub fn own_row() -> DesignRow {
    DesignRow {
        label: "The motor file's controller",
        variant: "",
        timer: Expected::default(),
        sampled: None,
        is_plotted: true,
    }
}

/// The rows of a drive: those of the design document, the default PI controller, and where sensors in the low legs cannot see a leg
/// that is off, whole vectors of three legs in place of those that turn legs off.
pub fn rows_of(inverter: &InverterSpec) -> Vec<DesignRow> {
    let mut rows = design_table();
    rows.push(DesignRow {
        label: "PI-PWM, default options",
        variant: "pi-pwm:hall_capture=timer",
        timer: Expected::default(),
        sampled: None,
        is_plotted: false,
    });
    if !matches!(inverter.current_sensing, CurrentSensing::LowSide(_)) {
        return rows;
    }
    let is_whole =
        |row: &DesignRow| row.variant.starts_with("fcs-mpc") || row.variant.starts_with("phcc");
    rows.retain(|row| !is_whole(row));
    rows.extend([
        DesignRow {
            label: "FCS-MPC three_phase, model EMF",
            variant: "fcs-mpc:discretisation=euler,candidates=three_phase,emf=model,hall_capture=timer",
            timer: Expected::default(),
            sampled: None,
            is_plotted: true,
        },
        DesignRow {
            label: "PHCC derived table, three_phase, model EMF",
            variant: "phcc:discretisation=euler,table=derived,candidates=three_phase,emf=model,hall_capture=timer",
            timer: Expected::default(),
            sampled: None,
            is_plotted: true,
        },
    ]);
    rows
}

/// The rows of the design document's table, with the nearest variant for each that does not exist:
/// the 660 W motor at 48 V, 50 us, delay 1, 3.3 Nm.
pub fn design_table() -> Vec<DesignRow> {
    vec![
        DesignRow {
            label: "FCS-MPC table2, nominal, estimated EMF",
            variant: "fcs-mpc:discretisation=euler,candidates=table2,off_leg=nominal,emf=estimated,emf_filter=1,hall_capture=timer",
            timer: Expected {
                points: two([point(2.93, 60.0, 13.0), point(2.76, 106.0, 22.0)]),
                limit: Some(Expectation::Never),
            },
            sampled: None,
            is_plotted: false,
        },
        DesignRow {
            label: "FCS-MPC table2, physical, model EMF",
            variant: "fcs-mpc:discretisation=euler,candidates=table2,off_leg=physical,emf=model,hall_capture=timer",
            timer: expected([point(3.24, 35.0, 6.2), point(3.28, 39.0, 7.9)], 82.0),
            sampled: None,
            is_plotted: true,
        },
        DesignRow {
            label: "PDCC three_phase, nearest, model EMF",
            variant: "pdcc:reference=quasi_square,discretisation=euler,modulation=three_phase,saturation=nearest,emf=model,hall_capture=timer",
            timer: expected([point(3.30, 2.3, 0.2), point(3.25, 12.7, 3.4)], 87.0),
            sampled: None,
            is_plotted: true,
        },
        DesignRow {
            label: "PDCC pair, keep_angle, model EMF",
            variant: "pdcc:discretisation=euler,modulation=pair,saturation=keep_angle,emf=model,hall_capture=timer",
            timer: expected([point(3.29, 10.0, 1.2), point(3.19, 28.0, 7.5)], 73.0),
            sampled: None,
            is_plotted: false,
        },
        DesignRow {
            label: "PDCC three_phase, torque_priority, advance 2, model EMF",
            variant: "pdcc:discretisation=euler,modulation=three_phase,saturation=torque_priority,advance=2,emf=model,hall_capture=timer",
            timer: expected(
                [point(3.30, 1.8, 0.07), point(3.30, 1.8, 0.29)],
                (106.0, 109.0),
            ),
            sampled: Some(Expected {
                points: vec![ExpectedPoint {
                    rpm: 1500.0,
                    ripple_pp_pct: Some((2.8, 3.7).into()),
                    ..ExpectedPoint::default()
                }],
                limit: None,
            }),
            is_plotted: true,
        },
        DesignRow {
            label: "PDCC three_phase, torque_priority, advance 2, estimated EMF",
            variant: "pdcc:discretisation=euler,modulation=three_phase,saturation=torque_priority,advance=2,emf=estimated,hall_capture=timer",
            timer: Expected {
                points: vec![ExpectedPoint {
                    rpm: 1500.0,
                    mean_torque_nm: Some(3.30.into()),
                    ripple_pp_pct: Some(6.9.into()),
                    ..ExpectedPoint::default()
                }],
                limit: Some(percent(105.0)),
            },
            sampled: None,
            is_plotted: false,
        },
        DesignRow {
            label: "PDCC pair, torque_priority, advance 1.5, model EMF",
            variant: "pdcc:discretisation=euler,modulation=pair,saturation=torque_priority,advance=1.5,emf=model,hall_capture=timer",
            timer: expected([point(3.30, 9.3, 0.4), point(3.30, 4.9, 0.5)], 108.0),
            sampled: None,
            is_plotted: false,
        },
        DesignRow {
            label: "PDCC three_phase, nearest, proportional, model EMF",
            variant: "pdcc:discretisation=euler,modulation=three_phase,saturation=nearest,reference=proportional,emf=model,hall_capture=timer",
            timer: expected([point(3.30, 0.13, 0.01), point(3.30, 0.5, 0.06)], 117.0),
            sampled: Some(Expected {
                points: vec![ExpectedPoint {
                    rpm: 1500.0,
                    ripple_pp_pct: Some((1.2, 2.1).into()),
                    ..ExpectedPoint::default()
                }],
                limit: None,
            }),
            is_plotted: true,
        },
        DesignRow {
            label: "PHCC derived table, physical, model EMF",
            variant: "phcc:discretisation=euler,table=derived,off_leg=physical,emf=model,hall_capture=timer",
            timer: expected([point(3.47, 53.0, 7.2), point(3.24, 39.0, 6.5)], 78.0),
            sampled: None,
            is_plotted: true,
        },
        DesignRow {
            label: "PI-PWM three_phase, 800 Hz, Ti 0.5 ms, no feed-forward",
            variant: "pi-pwm:reference=quasi_square,discretisation=euler,feed_forward=off,bandwidth=800Hz,integral_time=0.5ms,saturation=nearest,hall_capture=timer",
            timer: expected([point(3.32, 11.0, 1.8), point(3.09, 21.0, 6.0)], 53.0),
            sampled: None,
            is_plotted: false,
        },
        DesignRow {
            label: "PI-PWM three_phase, 1 kHz, feed-forward, model EMF",
            variant: "pi-pwm:reference=quasi_square,discretisation=euler,feed_forward=on,bandwidth=1kHz,emf=model,saturation=nearest,hall_capture=timer",
            timer: expected([point(3.29, 3.1, 0.4), point(3.12, 11.0, 2.8)], 60.0),
            sampled: None,
            is_plotted: true,
        },
        DesignRow {
            label: "PI-PWM six_step, 600 Hz",
            variant: "pi-pwm:discretisation=euler,six_step=on,bandwidth=600Hz,hall_capture=timer",
            timer: expected([point(3.29, 46.0, 6.0), point(3.27, 47.0, 12.6)], 89.0),
            sampled: None,
            is_plotted: false,
        },
    ]
}

fn point(mean: f64, pp: f64, rms: f64) -> ExpectedPoint {
    at(0.0, Some(mean), Some(pp), Some(rms))
}

fn at(rpm: f64, mean: Option<f64>, pp: Option<f64>, rms: Option<f64>) -> ExpectedPoint {
    ExpectedPoint {
        rpm,
        mean_torque_nm: mean.map(Band::from),
        ripple_pp_pct: pp.map(Band::from),
        ripple_rms_pct: rms.map(Band::from),
    }
}

/// Figures at 400 and 1500 rpm and the limit.
fn expected(points: [ExpectedPoint; 2], limit: impl Into<Band>) -> Expected {
    Expected {
        points: two(points),
        limit: Some(percent(limit)),
    }
}

fn percent(limit: impl Into<Band>) -> Expectation {
    Expectation::In(limit.into())
}

/// Figures at 400 and 1500 rpm.
fn two(points: [ExpectedPoint; 2]) -> Vec<ExpectedPoint> {
    points
        .into_iter()
        .zip([400.0, 1500.0])
        .map(|(point, rpm)| ExpectedPoint { rpm, ..point })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_contain_values_within_the_tolerance() {
        let band = Band::from((106.0, 109.0));
        for (measured, holds) in [
            (104.0, true),
            (103.9, false),
            (107.0, true),
            (111.0, true),
            (111.1, false),
            (f64::NAN, false),
        ] {
            assert_eq!(band.holds(measured, 2.0), holds, "{measured}");
        }
        assert_eq!(ripple_tolerance(1.8.into()), 0.5);
        assert_eq!(ripple_tolerance(28.0.into()), 0.15 * 28.0);
    }

    #[test]
    fn only_a_torque_that_is_never_held_meets_never() {
        let expected = Expected {
            limit: Some(Expectation::Never),
            ..Expected::default()
        };
        let limit = |outcome, percent: Option<f64>| SpeedLimit {
            outcome,
            limit_rpm: percent,
            limit_pct: percent,
            lost: None,
            tripped: None,
            curve: Vec::new(),
        };
        let met = |limit: Option<&SpeedLimit>| judge_limit(limit, Some(&expected)).met;
        assert!(met(Some(&limit(LimitOutcome::NeverHeld, None))));
        assert!(!met(Some(&limit(LimitOutcome::Found, Some(30.5)))));
        assert!(!met(Some(&limit(LimitOutcome::NotReached, Some(150.0)))));
        assert!(!met(None));
    }

    #[test]
    fn speeds_converted_from_angular_ones_find_their_expectation() {
        let row = &design_table()[1].timer;
        let rated = 209.439_510_239_319_5 * 30.0 / std::f64::consts::PI;
        for rpm in [0.75 * rated, 1500.0, 1_499.999_999] {
            assert!(row.at(rpm).is_some(), "{rpm}");
        }
        assert!(row.at(1000.0).is_none());
    }
}
