//! The plant under random commands, motors and speeds: every period ends after few events, and the
//! network's invariants hold in every segment.

use hexagen::{LegState, Legs};
use hexagen_lab::plant::{
    EmfShape, EnergyMeter, Mechanics, Observer, Plant, PlantParams, Segment, Terminal, Wiring,
};

/// A small generator of reproducible numbers in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn pick(&mut self, count: usize) -> usize {
        ((self.next() * count as f64) as usize).min(count - 1)
    }
}

/// Counts segments and checks each against the circuit's laws.
struct Auditor {
    count: usize,
    rails: (f64, f64),
    open: [bool; 3],
    energy: EnergyMeter,
}

impl Observer for Auditor {
    fn segment(&mut self, segment: &Segment) {
        self.count += 1;
        assert!(segment.duration > 0.0);
        let (low, high) = self.rails;
        for t in [0.0, 0.5 * segment.duration, segment.duration] {
            let currents = segment.currents_at(t);
            let scale = currents.iter().fold(1.0_f64, |m, i| m.max(i.abs()));
            assert!(
                currents.iter().sum::<f64>().abs() < 1e-9 * scale,
                "{currents:?}"
            );
            let volts = segment.voltages_at(t);
            for x in 0..3 {
                match segment.terminal[x] {
                    Terminal::Rail {
                        diode: true, upper, ..
                    } => {
                        let forward = if upper { -currents[x] } else { currents[x] };
                        assert!(
                            forward > -1e-9 * scale,
                            "diode carries {forward} A backwards"
                        );
                    }
                    Terminal::Floating => {
                        assert_eq!(currents[x], 0.0);
                        if self.open[x] {
                            continue;
                        }
                        let bound = if segment.terminal == [Terminal::Floating; 3] {
                            high
                        } else {
                            1e-6
                        };
                        assert!(
                            (low - bound..=high + bound).contains(&volts[x]),
                            "floats at {volts:?}"
                        );
                    }
                    Terminal::Rail { .. } => {}
                }
            }
        }
        self.energy.segment(segment);
    }
}

#[test]
fn random_motors_under_random_commands_obey_the_circuit() {
    obey_the_circuit(|_| {});
}

#[test]
fn so_they_do_with_broken_wires_and_switches() {
    let mut random = Random(5);
    obey_the_circuit(|wiring| {
        let mut broken = |chance: f64| [(); 3].map(|()| random.next() < chance);
        wiring.open = broken(0.2);
        wiring.upper_dead = broken(0.1);
        wiring.lower_dead = broken(0.1);
        wiring.windings.swap(0, random.pick(3));
    });
}

fn obey_the_circuit(mut change: impl FnMut(&mut Wiring)) {
    for seed in 0..400 {
        let mut random = Random(seed * 7919 + 1);
        let v_bus = random.between(5.0, 400.0);
        let t_s = random.between(20e-6, 125e-6);
        // Ts V / L from 0.1 to 100 A, R Ts / L from 0.001 to 0.5.
        let l = t_s * v_bus / 10.0_f64.powf(random.between(-1.0, 2.0));
        let r = l / t_s * 10.0_f64.powf(random.between(-3.0, -0.3));
        let mut params = PlantParams::ideal(1 + random.pick(8) as u32, r, l, 0.1, v_bus, t_s);
        let unequal = if random.next() < 0.5 { 0.3 } else { 0.0 };
        for x in 0..3 {
            params.resistance[x] *= 1.0 + random.between(-unequal, unequal);
            params.inductance[x] *= 1.0 + random.between(-unequal, unequal);
            params.k_phase[x] *= 1.0 + random.between(-unequal, unequal);
        }
        params.shape = match random.pick(4) {
            0 => EmfShape::Sinusoidal,
            1 => EmfShape::Trapezoidal {
                flat_top_deg: random.between(0.0, 179.0),
            },
            _ => params.shape,
        };
        params.dead_time = [0.0, 0.01, 0.05][random.pick(3)] * t_s;
        params.diode_drop = [0.0, 0.7][random.pick(2)];
        // Speeds up to 1.6 times the one whose line EMF equals the bus, standstill included.
        let speeds = [0.0, random.between(-1.6, 1.6), random.between(-0.9, 0.9)];
        let omega_m = speeds[random.pick(3)] * v_bus / 0.2;
        if random.next() < 0.3 {
            params.mechanics = Some(Mechanics {
                inertia: random.between(1e-5, 1e-2),
                opposing_torque: random.between(0.0, 1.0),
                external_torque: random.between(-1.0, 1.0),
                viscous: random.between(0.0, 1e-3),
            });
        }
        let rails = (-params.diode_drop, v_bus + params.diode_drop);
        change(&mut params.wiring);
        let open = params.wiring.open;
        let free = params.mechanics.is_some();
        let mut plant = Plant::new(params, random.between(0.0, 6.3), omega_m).unwrap();
        let mut auditor = Auditor {
            count: 0,
            rails,
            open,
            energy: EnergyMeter::new(&plant),
        };
        let periods = 200;
        for _ in 0..periods {
            let (mut compare, mut state) = ([0; 3], [LegState::Off; 3]);
            for x in 0..3 {
                state[x] = [LegState::Pulsed, LegState::Off, LegState::Low][random.pick(3)];
                if state[x] == LegState::Pulsed {
                    compare[x] = [0, 1, 900, 1799, 1800, random.pick(1801) as u16][random.pick(6)];
                }
            }
            let legs = Legs::new(compare, state);
            let before = auditor.count;
            plant.run_period(legs, &mut auditor);
            let events = auditor.count - before;
            assert!(events < 100, "seed {seed}: {events} segments in one period");
        }
        let account = auditor.energy.balance(&plant);
        let limit = if free { 1e-6 } else { 1e-9 };
        // Where next to nothing flows, rounding is all that is left.
        let rounding = 1e-12 * v_bus * v_bus * t_s * t_s / l;
        assert!(
            account.relative_error() < limit || account.error().abs() < rounding,
            "seed {seed}: {account:?}"
        );
    }
}
