//! The plant against an independent integrator: small fixed Euler steps, derived from the circuit
//! only, sharing no code with the plant. Covers PWM, dead time, legs that are off, commutation
//! through diodes, unequal phases, both EMF shapes, and rectification above the bus voltage.

use hexagen::{LegState, Legs};
use hexagen_lab::plant::{EmfShape, Observer, Plant, PlantParams, Segment, Wiring};
use std::f64::consts::{PI, TAU};

/// Euler step in seconds.
const DT: f64 = 2e-9;

struct Naive<'a> {
    p: &'a PlantParams,
    omega_m: f64,
    theta_e: f64,
    i: [f64; 3],
    /// Per leg: the driver's request (1 upper, -1 lower, 0 off), and its time.
    wanted: [i8; 3],
    since: [f64; 3],
    t: f64,
    /// Sum of |i| over phases and steps.
    magnitude: f64,
}

impl<'a> Naive<'a> {
    fn new(p: &'a PlantParams, theta_e: f64, omega_m: f64, i: [f64; 3]) -> Self {
        Self {
            p,
            omega_m,
            theta_e,
            i,
            wanted: [0; 3],
            since: [-1.0; 3],
            t: 0.0,
            magnitude: 0.0,
        }
    }

    fn emf(&self, x: usize) -> f64 {
        let lag = self.p.wiring.windings[x] as f64 * TAU / 3.0;
        let angle = (self.theta_e - lag).rem_euclid(TAU);
        let shape = match self.p.shape {
            EmfShape::Sinusoidal => angle.sin(),
            EmfShape::Harmonics { sines, cosines } => (0..12)
                .map(|k| {
                    let (sin, cos) = ((2 * k + 1) as f64 * angle).sin_cos();
                    sines[k] * sin + cosines[k] * cos
                })
                .sum(),
            EmfShape::Trapezoidal { flat_top_deg } => {
                let ramp = (PI - flat_top_deg.to_radians()) / 2.0;
                let quarter = if angle < PI {
                    angle.min(PI - angle)
                } else {
                    (angle - PI).min(TAU - angle)
                };
                (quarter / ramp).min(1.0) * if angle < PI { 1.0 } else { -1.0 }
            }
        };
        self.p.k_phase[x] * self.omega_m * shape
    }

    fn step(&mut self, legs: Legs, in_period: f64) {
        let p = self.p;
        let (bottom, top) = (-p.diode_drop, p.v_bus + p.diode_drop);
        let mut v: [Option<f64>; 3] = [None; 3];
        let mut open = [false; 3];
        for x in 0..3 {
            let half = 0.5 * p.t_s * f64::from(legs.compare()[x]) / f64::from(p.timer_period);
            let want = match legs.state()[x] {
                LegState::Off => 0,
                LegState::Pulsed if (in_period - 0.5 * p.t_s).abs() < half => 1,
                LegState::Pulsed | LegState::Low => -1,
            };
            if want != self.wanted[x] {
                self.since[x] = if self.wanted[x] == 0 { -1.0 } else { self.t };
                self.wanted[x] = want;
            }
            let gap = self.t - self.since[x] < p.dead_time;
            let wiring = p.wiring;
            v[x] = match want {
                _ if wiring.open[x] => None,
                1 if !gap && !wiring.upper_dead[x] => Some(p.v_bus),
                -1 if !gap && !wiring.lower_dead[x] => Some(0.0),
                _ => {
                    open[x] = true;
                    if self.i[x] > 0.0 {
                        Some(bottom)
                    } else if self.i[x] < 0.0 {
                        Some(top)
                    } else {
                        None
                    }
                }
            };
        }
        let e: [f64; 3] = std::array::from_fn(|x| self.emf(x));
        let closed = || (0..3).filter(|&x| !p.wiring.open[x]);
        // Floating legs that would leave the rails conduct; the worst one first.
        for _ in 0..3 {
            let Some(star) = self.star(&v, &e) else {
                let high = closed().max_by(|&x, &y| e[x].total_cmp(&e[y])).unwrap();
                let low = closed().min_by(|&x, &y| e[x].total_cmp(&e[y])).unwrap();
                if e[high] - e[low] > top - bottom {
                    v[high] = Some(top);
                    v[low] = Some(bottom);
                }
                continue;
            };
            let excess = |x: usize| (e[x] + star - top).max(bottom - e[x] - star);
            let worst = closed()
                .filter(|&x| v[x].is_none())
                .max_by(|&x, &y| excess(x).total_cmp(&excess(y)));
            if let Some(x) = worst.filter(|&x| excess(x) > 0.0) {
                v[x] = Some(if e[x] + star > top { top } else { bottom });
            }
        }
        if let Some(star) = self.star(&v, &e) {
            let before = self.i;
            for x in 0..3 {
                if let Some(volts) = v[x] {
                    self.i[x] +=
                        DT * (volts - e[x] - star - p.resistance[x] * self.i[x]) / p.inductance[x];
                }
            }
            for x in 0..3 {
                if open[x] && before[x] * self.i[x] < 0.0 {
                    self.i[x] = 0.0;
                }
            }
            // Current blocked by a diode is missing from the switched legs, too.
            let sum: f64 = self.i.iter().sum();
            let takers: Vec<usize> = (0..3).filter(|&x| self.i[x] != 0.0).collect();
            for &x in &takers {
                self.i[x] -= sum / takers.len() as f64;
            }
        }
        self.magnitude += self.i.iter().map(|i| i.abs()).sum::<f64>();
        self.theta_e += DT * self.omega_m * f64::from(p.pole_pairs);
        self.t += DT;
    }

    fn star(&self, v: &[Option<f64>; 3], e: &[f64; 3]) -> Option<f64> {
        let (mut weight, mut sum) = (0.0, 0.0);
        for x in 0..3 {
            if let Some(volts) = v[x] {
                let g = 1.0 / self.p.inductance[x];
                weight += g;
                sum += g * (volts - e[x] - self.p.resistance[x] * self.i[x]);
            }
        }
        (weight > 0.0).then(|| sum / weight)
    }

    fn run_period(&mut self, legs: Legs) {
        let steps = (self.p.t_s / DT).round() as u32;
        for step in 0..steps {
            self.step(legs, (f64::from(step) + 0.5) * DT);
        }
    }
}

fn motor() -> PlantParams {
    PlantParams::ideal(4, 0.135, 0.22e-3, 0.0824, 48.0, 50e-6)
}

fn crooked() -> PlantParams {
    let mut p = motor();
    p.inductance = [0.2e-3, 0.26e-3, 0.22e-3];
    p.resistance = [0.1, 0.135, 0.2];
    p.k_phase[2] *= 1.1;
    p.diode_drop = 0.7;
    p
}

/// Runs both over the commands and compares the currents after every period.
fn compare(
    p: &PlantParams,
    theta_e: f64,
    omega_m: f64,
    i: [f64; 2],
    commands: &[Legs],
    tolerance: f64,
) {
    let mut plant = Plant::new(p.clone(), theta_e, omega_m).unwrap();
    plant.set_currents(i);
    let mut naive = Naive::new(p, theta_e, omega_m, [i[0], i[1], -i[0] - i[1]]);
    for (period, command) in commands.iter().enumerate() {
        plant.run_period(*command, &mut ());
        naive.run_period(*command);
        for (got, want) in plant.truth().currents.iter().zip(naive.i) {
            assert!(
                (got - want).abs() < tolerance,
                "period {period}: {:?} against {:?}",
                plant.truth().currents,
                naive.i
            );
        }
    }
}

/// Random commands that favour pairs with the third leg off.
fn random_commands(count: usize, mut word: u32) -> Vec<Legs> {
    let mut next = move || {
        word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        word >> 16
    };
    (0..count)
        .map(|_| {
            let (mut compare, mut state) = ([0; 3], [LegState::Off; 3]);
            for x in 0..3 {
                state[x] = match next() % 8 {
                    0 => LegState::Low,
                    1 | 2 => LegState::Off,
                    _ => LegState::Pulsed,
                };
                if state[x] == LegState::Pulsed {
                    compare[x] = (next() % 1801) as u16;
                }
            }
            Legs::new(compare, state)
        })
        .collect()
}

#[test]
fn pwm_with_legs_off_agrees() {
    for seed in 0..6 {
        compare(
            &motor(),
            0.3 + f64::from(seed),
            150.0,
            [8.0, -3.0],
            &random_commands(24, seed),
            0.02,
        );
    }
}

#[test]
fn dead_time_and_unequal_phases_agree() {
    for (seed, omega_m) in [(10, 150.0), (11, -100.0), (12, 20.0), (13, 0.0)] {
        let mut p = crooked();
        p.dead_time = 1.5e-6;
        compare(
            &p,
            2.0,
            omega_m,
            [2.0, 1.0],
            &random_commands(24, seed),
            0.03,
        );
        for (shape, seed) in [(EmfShape::Sinusoidal, seed + 100), (skewed(), seed + 300)] {
            p.shape = shape;
            compare(
                &p,
                2.0,
                omega_m,
                [2.0, 1.0],
                &random_commands(24, seed),
                0.03,
            );
        }
    }
}

/// Harmonics up to the highest order, with halves of a wave that differ.
fn skewed() -> EmfShape {
    let (mut sines, mut cosines) = ([0.0; 12], [0.0; 12]);
    for (order, sine, cosine) in [
        (1, 1.0, 0.0),
        (3, 0.1, 0.0),
        (5, 0.05, 0.04),
        (23, 0.0, 0.01),
    ] {
        sines[order / 2] = sine;
        cosines[order / 2] = cosine;
    }
    EmfShape::Harmonics { sines, cosines }
}

#[test]
fn broken_wires_and_switches_agree() {
    let broken: [fn(&mut Wiring); 6] = [
        |wiring| wiring.open[2] = true,
        |wiring| wiring.open[0] = true,
        |wiring| wiring.upper_dead[0] = true,
        |wiring| wiring.lower_dead[1] = true,
        |wiring| wiring.windings = [1, 0, 2],
        |wiring| (wiring.open[1], wiring.lower_dead[2]) = (true, true),
    ];
    for (seed, change) in broken.into_iter().enumerate() {
        for mut p in [motor(), crooked()] {
            change(&mut p.wiring);
            let i = if p.wiring.open == [false; 3] {
                [8.0, -3.0]
            } else {
                [0.0; 2]
            };
            let commands = random_commands(24, seed as u32 + 200);
            compare(&p, 0.3 + seed as f64, 150.0, i, &commands, 0.03);
            // A rectifier of two phases.
            let omega_m = 1.2 * p.v_bus / (2.0 * p.k_phase[0]);
            compare(&p, 0.1, omega_m, [0.0; 2], &[Legs::OFF; 40], 0.03);
        }
    }
}

/// Integral of |i| over the three phases; with all legs off no current changes sign within a
/// segment.
#[derive(Default)]
struct Charge(f64);

impl Observer for Charge {
    fn segment(&mut self, segment: &Segment) {
        let h = segment.duration;
        let magnitude = |t: f64| segment.currents_at(t).iter().map(|i| i.abs()).sum::<f64>();
        self.0 += h / 6.0 * (magnitude(0.0) + 4.0 * magnitude(0.5 * h) + magnitude(h));
    }
}

#[test]
fn rectification_above_the_bus_voltage_agrees() {
    let of_shape = |shape| PlantParams { shape, ..motor() };
    for (p, factor) in [
        (motor(), 1.1),
        (crooked(), 1.2),
        (of_shape(EmfShape::Sinusoidal), 1.3),
        (of_shape(skewed()), 1.3),
    ] {
        let omega_m = factor * p.v_bus / (2.0 * p.k_phase[0]);
        let off = vec![Legs::OFF; 80];
        compare(&p, 0.1, omega_m, [0.0, 0.0], &off, 0.02);
        let mut plant = Plant::new(p.clone(), 0.1, omega_m).unwrap();
        let mut naive = Naive::new(&p, 0.1, omega_m, [0.0; 3]);
        let mut charge = Charge::default();
        for command in &off {
            plant.run_period(*command, &mut charge);
            naive.run_period(*command);
        }
        let duration = naive.t;
        let (got, want) = (charge.0 / duration, naive.magnitude * DT / duration);
        assert!(want > 1.0, "the motor should feed the bus: {want} A");
        assert!(
            (got / want - 1.0).abs() < 1e-3,
            "mean current {got} against {want}"
        );
        assert!(plant.truth().mean_torque < 0.0, "a rectified motor brakes");
    }
}
