//! The piecewise-linear network: which legs conduct, the exact currents, and the next event.
//!
//! L_x i_x' = v_x - e_x - v_n - R_x i_x over the conducting legs, v_n such that the currents of
//! these legs keep their sum of zero (equal phases are a special case, not assumed).
//! A leg that is off and carries no current floats, unless its terminal would leave the rails;
//! the choice is the one consistent combination of floating legs and conducting diodes.

use super::gates::Gate;
use super::roots::first_crossing;
use super::segment::{Segment, Series, TERMS, Terminal};
use super::{PlantParams, emf};

/// Current of a leg that is off which counts as zero, as a fraction of V Ts / L: above rounding,
/// below anything that matters.
const NO_CURRENT: f64 = 1e-12;

/// Largest R h / L or omega h of one Taylor step: its last term is then below 1e-16.
const MAX_EXPONENT: f64 = 0.25;

#[derive(Clone, Debug)]
pub(super) struct Network {
    resistance: [f64; 3],
    conductance: [f64; 3],
    /// Wires that are open.
    open: [bool; 3],
    v_bus: f64,
    drop: f64,
    /// Tolerance of terminal voltages against the rails; events use twice of it, so that a leg
    /// that reached a rail does conduct.
    tolerance: f64,
    no_current: f64,
    rate: f64,
    /// R/L, where all phases have the same R and the same L.
    common_rate: Option<f64>,
    /// Largest exponent x with x^(k+1)/(k+1)! at most 1e-16, by k: where a series may end.
    reach: [f64; TERMS - 4],
    /// 1/k, as the series' recursion needs it.
    reciprocal: Series,
}

impl Network {
    pub(super) fn new(params: &PlantParams) -> Self {
        let rates = (0..3).map(|x| params.resistance[x] / params.inductance[x]);
        let inductance = params.inductance.into_iter().fold(0.0, f64::max);
        Self {
            resistance: params.resistance,
            conductance: params.inductance.map(f64::recip),
            open: params.wiring.open,
            v_bus: params.v_bus,
            drop: params.diode_drop,
            tolerance: 1e-11 * params.v_bus,
            no_current: NO_CURRENT * params.v_bus * params.t_s / inductance,
            rate: rates.fold(0.0, f64::max),
            common_rate: (params.resistance == [params.resistance[0]; 3]
                && params.inductance == [params.inductance[0]; 3])
                .then(|| params.resistance[0] / params.inductance[0]),
            reach: std::array::from_fn(|k| {
                let factorial: f64 = (1..=k + 1).map(|n| n as f64).product();
                (1e-16 * factorial).powf(1.0 / (k + 1) as f64)
            }),
            reciprocal: std::array::from_fn(|k| if k == 0 { 0.0 } else { 1.0 / k as f64 }),
        }
    }

    /// Longest step whose Taylor series is exact to rounding; `omega` is the sine's speed, 0 for
    /// a trapezoid.
    pub(super) fn longest_step(&self, omega: f64) -> f64 {
        MAX_EXPONENT / self.rate.max(omega.abs())
    }

    /// Number of coefficients that a step of `h` needs: three more than those above 1e-16. A current follows its
    /// voltage by one order, and the slope of a trapezoid adds one to the order of the EMF and one to that of the torque.
    pub(super) fn terms(&self, omega: f64, h: f64) -> usize {
        let x = self.rate.max(omega.abs()) * h;
        let enough = self.reach.iter().position(|&reach| x <= reach);
        enough.unwrap_or(TERMS - 4) + 4
    }

    /// What the gates connect to the windings: nothing where the wire is open.
    pub(super) fn reached(&self, gates: [Gate; 3]) -> [Gate; 3] {
        std::array::from_fn(|x| if self.open[x] { Gate::Off } else { gates[x] })
    }

    /// Currents just after the open wires' are zero. The arc takes the energy of those; two
    /// windings that are left in series keep the flux of their loop.
    pub(super) fn without_open(&self, currents: [f64; 3]) -> [f64; 3] {
        let closed: Vec<usize> = (0..3).filter(|&x| !self.open[x]).collect();
        match closed[..] {
            [x, y] => {
                let [l_x, l_y] = [x, y].map(|x| self.conductance[x].recip());
                let loop_current = (l_x * currents[x] - l_y * currents[y]) / (l_x + l_y);
                let mut kept = [0.0; 3];
                (kept[x], kept[y]) = (loop_current, -loop_current);
                kept
            }
            [_, _, _] => currents,
            _ => [0.0; 3],
        }
    }

    /// Solves the network from `currents` over `segment.duration`, or up to the first event before
    /// its end: then shortens the duration. Expects times, speed and shape in `segment`; returns
    /// the leg whose current reached zero.
    pub(super) fn solve(
        &self,
        gates: [Gate; 3],
        currents: &mut [f64; 3],
        segment: &mut Segment,
    ) -> Option<usize> {
        for (current, gate) in currents.iter_mut().zip(gates) {
            if gate == Gate::Off && current.abs() < self.no_current {
                *current = 0.0;
            }
        }
        balance(currents, gates);
        self.connect(gates, currents, segment);
        self.expand(currents, segment);
        self.cut_at_event(segment)
    }

    fn lower_diode(&self) -> Terminal {
        Terminal::Rail {
            volts: -self.drop,
            upper: false,
            diode: true,
        }
    }

    fn upper_diode(&self) -> Terminal {
        Terminal::Rail {
            volts: self.v_bus + self.drop,
            upper: true,
            diode: true,
        }
    }

    /// Determines the terminals' state from the present gates and currents.
    fn connect(&self, gates: [Gate; 3], currents: &[f64; 3], segment: &mut Segment) {
        let mut undecided = [0_usize; 3];
        let mut count = 0;
        for x in 0..3 {
            segment.terminal[x] = match gates[x] {
                Gate::Upper => Terminal::Rail {
                    volts: self.v_bus,
                    upper: true,
                    diode: false,
                },
                Gate::Lower => Terminal::Rail {
                    volts: 0.0,
                    upper: false,
                    diode: false,
                },
                Gate::Off if self.open[x] => Terminal::Floating,
                Gate::Off if currents[x] > 0.0 => self.lower_diode(),
                Gate::Off if currents[x] < 0.0 => self.upper_diode(),
                Gate::Off => {
                    undecided[count] = x;
                    count += 1;
                    Terminal::Floating
                }
            };
        }
        if count == 0 {
            return;
        }
        let undecided = &undecided[..count];
        let choices = [Terminal::Floating, self.lower_diode(), self.upper_diode()];
        let mut best = (f64::INFINITY, segment.terminal);
        for mut combination in 0..3_usize.pow(count as u32) {
            let mut terminal = segment.terminal;
            for &x in undecided {
                terminal[x] = choices[combination % 3];
                combination /= 3;
            }
            let violation = self.violation(&terminal, currents, segment, undecided);
            if violation <= 0.0 {
                best = (violation, terminal);
                break;
            }
            if violation < best.0 {
                best = (violation, terminal);
            }
        }
        segment.terminal = best.1;
    }

    /// Largest contradiction of a choice for the `undecided` legs, volt; at most 0 for a consistent
    /// one.
    fn violation(
        &self,
        terminal: &[Terminal; 3],
        currents: &[f64; 3],
        segment: &Segment,
        undecided: &[usize],
    ) -> f64 {
        let e = |x: usize| segment.omega_m * segment.shape[x][0];
        let (low, high) = (
            -self.drop - self.tolerance,
            self.v_bus + self.drop + self.tolerance,
        );
        let mut weight = 0.0;
        let mut neutral = 0.0;
        for x in 0..3 {
            if let Terminal::Rail { volts, .. } = terminal[x] {
                weight += self.conductance[x];
                neutral += self.conductance[x] * (volts - e(x) - self.resistance[x] * currents[x]);
            }
        }
        if weight == 0.0 {
            let closed = || (0..3).filter(|&x| !self.open[x]).map(e);
            let least = closed().fold(f64::INFINITY, f64::min);
            let most = closed().fold(f64::NEG_INFINITY, f64::max);
            return (most - least) - (high - low);
        }
        neutral /= weight;
        let mut worst = f64::NEG_INFINITY;
        for &x in undecided {
            let violation = match terminal[x] {
                Terminal::Floating => (e(x) + neutral - high).max(low - e(x) - neutral),
                Terminal::Rail { volts, upper, .. } => {
                    // The inductance's voltage must drive current in the diode's direction. The
                    // current is zero, so R has no effect; a single conducting leg has no driving
                    // voltage.
                    let drive = volts - e(x) - neutral;
                    let wanted = if upper { -drive } else { drive };
                    if wanted > 0.0 {
                        -wanted
                    } else {
                        self.tolerance - wanted
                    }
                }
            };
            worst = worst.max(violation);
        }
        worst
    }

    /// Taylor series of the currents and of the star point.
    fn expand(&self, currents: &[f64; 3], segment: &mut Segment) {
        let mut weight = 0.0;
        let mut conductance = [0.0; 3];
        let mut source = [0.0; 3];
        for x in 0..3 {
            segment.current[x][0] = currents[x];
            if let Terminal::Rail { volts, .. } = segment.terminal[x] {
                conductance[x] = self.conductance[x];
                weight += conductance[x];
                source[x] = volts;
            }
        }
        if weight == 0.0 {
            // Nothing conducts: by symmetry the star point is where the terminals' mean is midway
            // between the rails. Only differences matter.
            for k in 0..segment.terms {
                let sum: f64 = segment.shape.iter().map(|shape| shape[k]).sum();
                segment.neutral[k] = -segment.omega_m * sum / 3.0;
                for current in &mut segment.current {
                    current[k] = 0.0;
                }
            }
            segment.neutral[0] += 0.5 * self.v_bus;
            return;
        }
        let scale = 1.0 / weight;
        if let Some(rate) = self.common_rate {
            self.expand_equal([rate, scale], conductance, source, segment);
            return;
        }
        for k in 0..segment.terms {
            let mut drive = [0.0; 3];
            let mut neutral = 0.0;
            for x in 0..3 {
                drive[x] = source[x]
                    - segment.omega_m * segment.shape[x][k]
                    - self.resistance[x] * segment.current[x][k];
                neutral += conductance[x] * drive[x];
            }
            neutral *= scale;
            segment.neutral[k] = neutral;
            source = [0.0; 3];
            if k + 1 < segment.terms {
                for x in 0..3 {
                    segment.current[x][k + 1] =
                        conductance[x] * (drive[x] - neutral) * self.reciprocal[k + 1];
                }
            }
        }
    }

    /// Taylor series where all phases are equal: the voltages across R sum to zero, so the star point is the
    /// mean of the conducting legs' voltages less their EMFs, and each current follows its own voltage. `rate` is R/L,
    /// `conductance` 1/L of each leg that conducts, else 0, and `scale` one over their sum.
    fn expand_equal(
        &self,
        [rate, scale]: [f64; 2],
        conductance: [f64; 3],
        mut source: [f64; 3],
        segment: &mut Segment,
    ) {
        let (terms, shape_terms) = (segment.terms, segment.shape_terms);
        let shares = conductance.map(|part| part * scale);
        let (neutral, currents) = (&mut segment.neutral, &mut segment.current);
        for k in 0..shape_terms {
            let volts: [f64; 3] =
                std::array::from_fn(|x| source[x] - segment.omega_m * segment.shape[x][k]);
            neutral[k] = shares[0] * volts[0] + shares[1] * volts[1] + shares[2] * volts[2];
            source = [0.0; 3];
            if k + 1 < terms {
                for x in 0..3 {
                    let driven = conductance[x] * (volts[x] - neutral[k]);
                    currents[x][k + 1] = (driven - rate * currents[x][k]) * self.reciprocal[k + 1];
                }
            }
        }
        neutral[shape_terms..terms].fill(0.0);
        for k in shape_terms..terms - 1 {
            let factor = -rate * self.reciprocal[k + 1];
            for current in currents.iter_mut() {
                current[k + 1] = factor * current[k];
            }
        }
    }

    fn cut_at_event(&self, segment: &mut Segment) -> Option<usize> {
        let terms = segment.terms;
        let mut event = None;
        let mut margin = [0.0; TERMS];
        let floating_all = segment.terminal == [Terminal::Floating; 3];
        for x in 0..3 {
            match segment.terminal[x] {
                Terminal::Rail {
                    diode: true, upper, ..
                } => {
                    let sign = if upper { -1.0 } else { 1.0 };
                    for (m, c) in margin.iter_mut().zip(&segment.current[x]) {
                        *m = sign * c;
                    }
                    if let Some(t) = first_crossing(&margin[..terms], segment.duration) {
                        segment.duration = t;
                        event = Some(x);
                    }
                }
                // No diode is at the end of an open wire.
                Terminal::Floating if self.open[x] => {}
                Terminal::Floating => {
                    // Line-to-line against the next phase: a bridge of two diodes.
                    let y = (x + 1) % 3;
                    if floating_all && self.open[y] {
                        continue;
                    }
                    for sign in [1.0, -1.0] {
                        let limit = if floating_all {
                            let phases = segment.shape[x].iter().zip(&segment.shape[y]);
                            for (m, (f_x, f_y)) in margin[..terms].iter_mut().zip(phases) {
                                *m = sign * segment.omega_m * (f_x - f_y);
                            }
                            self.v_bus + 2.0 * self.drop + 3.0 * self.tolerance
                        } else {
                            let potentials = segment.neutral.iter().zip(&segment.shape[x]);
                            for (m, (v_n, f)) in margin[..terms].iter_mut().zip(potentials) {
                                *m = sign * (v_n + segment.omega_m * f);
                            }
                            let rail = if sign > 0.0 { 0.0 } else { self.v_bus };
                            rail + self.drop + 2.0 * self.tolerance
                        };
                        margin[0] += limit;
                        if let Some(t) = first_crossing(&margin[..terms], segment.duration) {
                            segment.duration = t;
                            event = None;
                        }
                    }
                }
                Terminal::Rail { .. } => {}
            }
        }
        event
    }
}

/// Removes the rounding error of the currents' sum from the largest one, and all current if only
/// one leg is left to carry it.
pub(super) fn balance(currents: &mut [f64; 3], gates: [Gate; 3]) {
    let carrying = (0..3)
        .filter(|&x| gates[x] != Gate::Off || currents[x] != 0.0)
        .count();
    if carrying < 2 {
        *currents = [0.0; 3];
        return;
    }
    let sum: f64 = currents.iter().sum();
    let largest = (0..3).fold(0, |l, x| {
        if currents[x].abs() > currents[l].abs() {
            x
        } else {
            l
        }
    });
    currents[largest] -= sum;
}

/// Fills the EMF part of a segment: shape series of the three phases.
pub(super) fn set_shape(params: &PlantParams, segment: &mut Segment) {
    segment.shape_terms = emf::series(
        params.shape,
        params.k_phase,
        params.wiring.windings,
        [segment.theta_e, segment.omega_e],
        segment.terms,
        &mut segment.shape,
    );
}
