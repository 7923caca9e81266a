//! The paper's claims (a) to (h), each as statements over the measured figures of both readings.
//!
//! Words of the paper as limits: "about" a share of rated speed is within [`ABOUT`] points, "equal"
//! and "keeps the spectrum" within the tolerances below.

use super::data::Method::{self, FcsMpc, Pdcc, Phcc, PiPwm};
use super::data::{Reading, Reproduction};
use super::experiment::{AtSpeed, Experiment, Extreme, Of, lost, number, short};
use super::judge::{Claim, Finding, Statement};
use crate::closed_loop::harmonic_of_quasi_square;

/// Tolerance of a claimed speed limit, in points of rated speed.
const ABOUT: f64 = 5.0;

/// Tolerance of equal torque harmonics, relative to the larger one, or [`EQUAL_POINTS`].
const EQUAL_SHARE: f64 = 0.15;
const EQUAL_POINTS: f64 = 0.5;

/// Tolerance of an ideal current harmonic, in points of the fundamental.
const SPECTRUM: f64 = 1.5;

/// Reduction of a harmonic that counts as lowered, in points of the fundamental.
const LOWERED: f64 = 0.5;

/// Maximum distance from the ideal hexagon for precise tracking, relative to the current.
const FINE: f64 = 0.05;

/// Maximum ratio of switching frequencies that are about the same.
const SAME_SWITCHING: f64 = 1.25;

/// Indices of the two speeds.
const LOW: usize = 0;
const HIGH: usize = 1;

/// Torque harmonics: name and figure.
const TORQUE: [(&str, Of); 2] = [("6th", h6), ("12th", h12)];

fn h6(at: &AtSpeed) -> Option<f64> {
    at.h6_pct
}

fn h12(at: &AtSpeed) -> Option<f64> {
    at.h12_pct
}

fn hexagon(at: &AtSpeed) -> Option<f64> {
    at.hexagon_rms_a
}

fn switching(at: &AtSpeed) -> Option<f64> {
    at.switching_hz
}

impl Reproduction {
    /// The paper's claims, judged.
    pub fn claims(&self) -> Vec<Claim> {
        claims(Reading::ALL.map(|reading| self.experiment(reading)))
    }
}

/// All claims, judged by the figures of the literal and of the corrected reading.
pub fn claims(readings: [Experiment; 2]) -> Vec<Claim> {
    let both = Both { readings };
    vec![
        both.speed_limits(),
        both.harmonics_at_low_speed(),
        both.harmonics_at_high_speed(),
        both.current_spectra(),
        both.tracking(),
        both.computation(),
        both.switching_alike(),
        both.switching_of_pdcc(),
    ]
}

/// All methods except one.
fn others(method: Method) -> Vec<Method> {
    let all = Method::ALL.into_iter();
    all.filter(|&other| other != method).collect()
}

/// Both readings.
struct Both {
    readings: [Experiment; 2],
}

impl Both {
    fn figures(&self, figures: impl Fn(&Experiment) -> String) -> [String; 2] {
        [0, 1].map(|reading| figures(&self.readings[reading]))
    }

    fn statement(
        &self,
        text: impl Into<String>,
        judge: impl Fn(&Experiment) -> Finding,
    ) -> Statement {
        Statement {
            text: text.into(),
            findings: [0, 1].map(|reading| judge(&self.readings[reading])),
        }
    }

    /// Speeds are the same in both readings.
    fn rpm(&self, speed: usize) -> f64 {
        self.readings[0].setting.speeds_rpm[speed]
    }

    fn torque(&self) -> f64 {
        self.readings[0].setting.torque
    }

    /// Statement that one method's harmonic is above or below those of others.
    fn extreme(
        &self,
        text: &str,
        which: Extreme,
        method: Method,
        others: &[Method],
        (speed, of): (usize, Of),
    ) -> Statement {
        self.statement(text, |x| {
            x.is_extreme(which, method, others, |m| x.at(m, speed, of), "%")
        })
    }

    fn misses(&self, method: Method, speed: usize) -> Statement {
        let text = format!("{} misses {} Nm", method.name(), short(self.torque()));
        self.statement(text, |x| x.misses(method, speed))
    }

    fn speed_limits(&self) -> Claim {
        let holds = |text: &str, method, claimed: f64| {
            let text = format!("{} {text}{claimed:.0} %", Method::name(method));
            self.statement(text, |x| match x.limit(method) {
                None => lost(method),
                Some(limit) => Finding {
                    outcome: Some((limit - claimed).abs() <= ABOUT),
                    why: match limit {
                        x if x <= 0.0 => "never held".to_owned(),
                        _ => format!("{limit:.1} %"),
                    },
                },
            })
        };
        let order = |text: &str, which, method| {
            self.statement(text, |x| {
                x.is_extreme(which, method, &others(method), |m| x.limit(m), "%")
            })
        };
        Claim {
            letter: 'a',
            text: "rated torque is held to 67 % of rated speed by PI-PWM, about 85 % by predictive control, 87 % by PDCC".to_owned(),
            figures: self.figures(|x| format!("{} %", x.limits())),
            statements: vec![
                holds("to ", PiPwm, 67.0),
                holds("to about ", FcsMpc, 85.0),
                holds("to about ", Phcc, 85.0),
                holds("to ", Pdcc, 87.0),
                order("PI-PWM gives up first", Extreme::Least, PiPwm),
                order("PDCC gives up last", Extreme::Most, Pdcc),
            ],
        }
    }

    /// Mean torque and both harmonics of all methods at a speed.
    fn torque_figures(&self, speed: usize) -> [String; 2] {
        self.figures(|x| {
            let row = |of: Of, decimals| x.row(|m| x.at(m, speed, of), decimals);
            let mean = row(|at| at.mean_torque_nm, 2);
            format!(
                "mean {mean} Nm; 6th {} %; 12th {} %",
                row(h6, 2),
                row(h12, 2)
            )
        })
    }

    fn harmonics_at_low_speed(&self) -> Claim {
        let mut statements = vec![self.misses(FcsMpc, LOW)];
        // An order of the three methods that the claim names; it is silent about PHCC.
        for (name, of) in TORQUE {
            for (method, next) in [(FcsMpc, PiPwm), (PiPwm, Pdcc)] {
                let text = format!("{} more {name} than {}", method.name(), next.name());
                statements.push(self.extreme(&text, Extreme::Most, method, &[next], (LOW, of)));
            }
        }
        Claim {
            letter: 'b',
            text: format!(
                "{:.0} rpm: FCS-MPC misses {} Nm and has the most 6th and 12th torque harmonic; then PI-PWM; PDCC least (of these three)",
                self.rpm(LOW),
                short(self.torque())
            ),
            figures: self.torque_figures(LOW),
            statements,
        }
    }

    fn harmonics_at_high_speed(&self) -> Claim {
        let mut statements = vec![self.misses(FcsMpc, HIGH)];
        for (name, of) in TORQUE {
            statements.extend([
                self.extreme(
                    &format!("FCS-MPC least {name}"),
                    Extreme::Least,
                    FcsMpc,
                    &others(FcsMpc),
                    (HIGH, of),
                ),
                self.statement(format!("PDCC and PHCC equal {name}"), |x| equal(x, of)),
                self.extreme(
                    &format!("PI-PWM most {name}"),
                    Extreme::Most,
                    PiPwm,
                    &others(PiPwm),
                    (HIGH, of),
                ),
            ]);
        }
        statements.push(self.misses(PiPwm, HIGH));
        Claim {
            letter: 'c',
            text: format!(
                "{:.0} rpm: FCS-MPC has the least harmonics but misses {} Nm; PDCC and PHCC are equal in 6th and 12th; PI-PWM fails with high 6th and 12th",
                self.rpm(HIGH),
                short(self.torque())
            ),
            figures: self.torque_figures(HIGH),
            statements,
        }
    }

    fn current_spectra(&self) -> Claim {
        let figures = self.figures(|x| {
            let row = |speed, of: Of| x.row(|m| x.at(m, speed, of), 1);
            let speeds = [LOW, HIGH].map(|speed| {
                let rpm = x.setting.speeds_rpm[speed];
                let (i5, i7) = (row(speed, |at| at.i5_pct), row(speed, |at| at.i7_pct));
                format!("{rpm:.0} rpm 5th {i5} %; {rpm:.0} rpm 7th {i7} %")
            });
            speeds.join("; ")
        });
        let rpm = |speed| format!("{:.0} rpm", self.rpm(speed));
        let lowers = |speed| {
            let text = format!("FCS-MPC lowers 5th and 7th at {}", rpm(speed));
            self.statement(text, |x| lowers(x, FcsMpc, speed))
        };
        let keep = |who: &str, methods: &'static [Method], speed| {
            let text = format!("{who} keep the ideal spectrum at {}", rpm(speed));
            self.statement(text, |x| keep_spectrum(x, methods, speed))
        };
        Claim {
            letter: 'd',
            text: format!(
                "FCS-MPC lowers the 5th and 7th current harmonic; at {} the others keep the ideal spectrum; at {} PDCC and PHCC do, PHCC slightly worse",
                rpm(LOW),
                rpm(HIGH)
            ),
            figures,
            statements: vec![
                lowers(LOW),
                lowers(HIGH),
                keep("the others", &[Pdcc, Phcc, PiPwm], LOW),
                keep("PDCC and PHCC", &[Pdcc, Phcc], HIGH),
                self.statement(
                    format!("PHCC is farther off than PDCC at {}", rpm(HIGH)),
                    |x| {
                        x.is_extreme(
                            Extreme::Most,
                            Phcc,
                            &[Pdcc],
                            |m| spectrum_distance(x, m, HIGH),
                            "points off",
                        )
                    },
                ),
            ],
        }
    }

    fn tracking(&self) -> Claim {
        let rpm = |speed| format!("{:.0} rpm", self.rpm(speed));
        let best = |speed| {
            self.statement(format!("PDCC most precise at {}", rpm(speed)), |x| {
                let figure = |m| x.at(m, speed, hexagon);
                x.is_extreme(Extreme::Least, Pdcc, &others(Pdcc), figure, "A")
            })
        };
        let pi = |text: &str, speed, is_fine: bool| {
            self.statement(format!("PI-PWM {text} at {}", rpm(speed)), |x| {
                let Some(distance) = x.at(PiPwm, speed, hexagon) else {
                    return lost(PiPwm);
                };
                let most = FINE * x.setting.current;
                Finding {
                    outcome: Some((distance <= most) == is_fine),
                    why: format!("{} A, fine up to {} A", short(distance), short(most)),
                }
            })
        };
        Claim {
            letter: 'e',
            text: "PDCC tracks the ideal hexagon most precisely at both speeds; PI-PWM is fine at low speed only".to_owned(),
            figures: self.figures(|x| {
                let speeds = [LOW, HIGH].map(|speed| {
                    let row = x.row(|m| x.at(m, speed, hexagon), 2);
                    format!("{:.0} rpm {row} A off", x.setting.speeds_rpm[speed])
                });
                speeds.join("; ")
            }),
            statements: vec![
                best(LOW),
                best(HIGH),
                pi("fine", LOW, true),
                pi("not fine", HIGH, false),
            ],
        }
    }

    fn computation(&self) -> Claim {
        let cycles = |x: &Experiment, m: Method| f64::from(x.methods[m.index()].cycles);
        let usual = |x: &Experiment, m: Method| x.methods[m.index()].usual_cycles.map(f64::from);
        Claim {
            letter: 'f',
            text: "PDCC has the longest computation time; in all methods free time remains, room for richer cost functions".to_owned(),
            figures: self.figures(|x| {
                let share = |cycles: f64| 100.0 * cycles / x.setting.period_cycles;
                let worst = x.row(|m| Some(share(cycles(x, m))), 1);
                let usual = x.row(|m| usual(x, m).map(share), 1);
                format!("at worst {worst} % of the period; usually {usual} %")
            }),
            statements: vec![
                self.statement("PDCC takes longest in a usual step", |x| {
                    let figure = |m| usual(x, m);
                    x.is_extreme(Extreme::Most, Pdcc, &others(Pdcc), figure, "cycles")
                }),
                self.statement("PDCC takes longest at worst", |x| {
                    let figure = |m| Some(cycles(x, m));
                    x.is_extreme(Extreme::Most, Pdcc, &others(Pdcc), figure, "cycles")
                }),
                self.statement("free time remains in all", |x| {
                    let most = Method::ALL.map(|m| cycles(x, m)).into_iter();
                    let most = most.fold(0.0, f64::max);
                    Finding {
                        outcome: Some(most < x.setting.period_cycles),
                        why: format!("at most {most:.0} of {:.0} cycles", x.setting.period_cycles),
                    }
                }),
            ],
        }
    }

    fn switching_figures(&self) -> [String; 2] {
        self.figures(|x| {
            let speeds = [LOW, HIGH].map(|speed| {
                let row = x.row(|m| x.at(m, speed, switching).map(|f| f / 1e3), 1);
                format!("{:.0} rpm {row} kHz", x.setting.speeds_rpm[speed])
            });
            speeds.join("; ")
        })
    }

    fn switching_alike(&self) -> Claim {
        let alike = |speed| {
            let text = format!("alike at {:.0} rpm", self.rpm(speed));
            self.statement(text, |x| same_switching(x, speed))
        };
        Claim {
            letter: 'g',
            text: "all methods have about the same switching frequency".to_owned(),
            figures: self.switching_figures(),
            statements: vec![alike(LOW), alike(HIGH)],
        }
    }

    fn switching_of_pdcc(&self) -> Claim {
        let lower = |speed| {
            let text = format!("PDCC below FCS-MPC and PHCC at {:.0} rpm", self.rpm(speed));
            self.statement(text, |x| {
                let figure = |m| x.at(m, speed, switching);
                x.is_extreme(Extreme::Least, Pdcc, &[FcsMpc, Phcc], figure, "Hz")
            })
        };
        Claim {
            letter: 'h',
            text: "the modulator lowers PDCC's switching frequency below that of the methods without one".to_owned(),
            figures: self.switching_figures(),
            statements: vec![lower(LOW), lower(HIGH)],
        }
    }
}

/// Whether a torque harmonic of PDCC and PHCC is equal at high speed.
fn equal(x: &Experiment, of: Of) -> Finding {
    let (Some(pdcc), Some(phcc)) = (x.at(Pdcc, HIGH, of), x.at(Phcc, HIGH, of)) else {
        let is_pdcc_lost = x.at(Pdcc, HIGH, of).is_none();
        return lost(if is_pdcc_lost { Pdcc } else { Phcc });
    };
    let tolerance = (EQUAL_SHARE * pdcc.max(phcc)).max(EQUAL_POINTS);
    Finding {
        outcome: Some((pdcc - phcc).abs() <= tolerance),
        why: format!("PDCC {}; PHCC {} %", short(pdcc), short(phcc)),
    }
}

/// Distances of the 5th and 7th current harmonic from those of the ideal wave, in points.
fn off_spectrum(x: &Experiment, method: Method, speed: usize) -> Option<[f64; 2]> {
    let i5 = x.at(method, speed, |at| at.i5_pct)?;
    let i7 = x.at(method, speed, |at| at.i7_pct)?;
    Some([
        i5 - harmonic_of_quasi_square(5),
        i7 - harmonic_of_quasi_square(7),
    ])
}

fn spectrum_distance(x: &Experiment, method: Method, speed: usize) -> Option<f64> {
    let off = off_spectrum(x, method, speed)?;
    Some(off.into_iter().map(f64::abs).fold(0.0, f64::max))
}

fn lowers(x: &Experiment, method: Method, speed: usize) -> Finding {
    let Some([i5, i7]) = off_spectrum(x, method, speed) else {
        return lost(method);
    };
    Finding {
        outcome: Some(i5 < -LOWERED && i7 < -LOWERED),
        why: format!("5th {i5:+.1}, 7th {i7:+.1} points"),
    }
}

fn keep_spectrum(x: &Experiment, methods: &[Method], speed: usize) -> Finding {
    let mut unknown = None;
    let mut worst: Option<(Method, f64)> = None;
    for &method in methods {
        match spectrum_distance(x, method, speed) {
            None => unknown = Some(method),
            Some(off) if worst.is_none_or(|(_, most)| off > most) => worst = Some((method, off)),
            Some(_) => {}
        }
    }
    let is_off = worst.is_some_and(|(_, off)| off > SPECTRUM);
    match (worst, unknown) {
        (Some((method, off)), None) => Finding {
            outcome: Some(!is_off),
            why: format!("{} up to {off:.1} points off", method.name()),
        },
        // One deviating drive refutes it, whatever the lost one would have done.
        (Some((method, off)), Some(_)) if is_off => Finding {
            outcome: Some(false),
            why: format!("{} {off:.1} points off", method.name()),
        },
        (_, unknown) => lost(unknown.unwrap_or(Pdcc)),
    }
}

fn same_switching(x: &Experiment, speed: usize) -> Finding {
    let known: Vec<f64> = Method::ALL
        .into_iter()
        .filter_map(|method| x.at(method, speed, switching))
        .collect();
    let least = known.iter().copied().fold(f64::INFINITY, f64::min);
    let most = known.iter().copied().fold(0.0, f64::max);
    let is_apart = most > SAME_SWITCHING * least;
    let lost_one = Method::ALL
        .into_iter()
        .find(|&method| x.at(method, speed, switching).is_none());
    match lost_one {
        Some(method) if !is_apart => lost(method),
        _ => Finding {
            outcome: Some(!is_apart),
            why: format!(
                "{} to {} kHz",
                number(Some(least / 1e3), 1),
                number(Some(most / 1e3), 1)
            ),
        },
    }
}

#[cfg(test)]
mod tests;
