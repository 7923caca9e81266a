//! A crude motor that closes the loop for plausible inputs: one Euler step per period, average
//! voltages, a coarse EMF. It only has to reach realistic operating points.

use crate::exact::floor;
use crate::{AnyCommand, DiscretePhase, EmfShape, Error, Spec};
use hexagen::Command;
use std::f64::consts::TAU;

/// Entries of the EMF table, per turn.
const ENTRIES: usize = 256;

/// Motor, inverter and load.
#[derive(Clone, Debug)]
pub struct ToyMotor {
    phase: DiscretePhase,
    /// Zero-sum phase EMF in volt at one turn per period.
    emf: Vec<f64>,
    timer_period: f64,
    /// Greatest speed, turns per period.
    speed_max: f64,
    /// Bus voltage, volt.
    pub v_bus: f64,
    /// Currents of phases a, b, ampere.
    pub i: [f64; 2],
    /// Electrical angle, turns, 0 to 1.
    pub turn: f64,
    speed: f64,
    speed_target: f64,
}

impl ToyMotor {
    pub fn new(spec: &Spec) -> Result<Self, Error> {
        let (motor, inverter) = (&spec.motor, &spec.inverter);
        let shape = EmfShape::new(motor)?;
        let per_turn = motor.emf_constant * TAU / (f64::from(motor.pole_pairs) * inverter.t_s);
        let emf = (0..ENTRIES)
            .map(|entry| per_turn * shape.zero_sum(entry as f64 / ENTRIES as f64 * TAU));
        Ok(Self {
            phase: DiscretePhase::new(spec),
            emf: emf.collect(),
            timer_period: f64::from(inverter.timer_period),
            speed_max: inverter.omega_max * f64::from(motor.pole_pairs) * inverter.t_s / TAU,
            v_bus: inverter.v_bus,
            i: [0.0; 2],
            turn: 0.0,
            speed: 0.0,
            speed_target: 0.0,
        })
    }

    /// A new target speed, relative to the maximum, signed.
    pub fn set_speed(&mut self, share: f64) {
        self.speed_target = share * self.speed_max;
    }

    /// Sector (0 to 5) at `ahead` turns before the rotor.
    #[inline]
    pub fn sector(&self, ahead: f64) -> usize {
        let sextants = (self.turn + ahead) * 6.0 + 0.5;
        (floor(sextants) + 6.0) as usize % 6
    }

    /// One period under a command.
    #[inline]
    pub fn advance(&mut self, command: AnyCommand) {
        self.speed += (self.speed_target - self.speed) / 64.0;
        self.turn += self.speed;
        self.turn -= floor(self.turn);
        let at = |turn: f64| self.emf[(turn * ENTRIES as f64) as usize % ENTRIES] * self.speed;
        let (e_a, e_b) = (at(self.turn), at(self.turn + 2.0 / 3.0));
        let e = [e_a, e_b, -(e_a + e_b)];
        let i = [self.i[0], self.i[1], -(self.i[0] + self.i[1])];
        let on = command.on();
        let off = match command {
            AnyCommand::Legs(_) => [0; 3],
            AnyCommand::Intervals(_) => command.off(self.timer_period as u16),
        };
        let mut v = [0.0; 3];
        for phase in 0..3 {
            v[phase] = match on[phase] {
                // While it is off a leg counts as midway.
                Some(on) => {
                    (f64::from(on) + f64::from(off[phase]) / 2.0) / self.timer_period * self.v_bus
                }
                // A diode against the current; without current about the voltage that makes none.
                None if i[phase].abs() > self.phase.b * self.v_bus / 4.0 => {
                    if i[phase] > 0.0 {
                        0.0
                    } else {
                        self.v_bus
                    }
                }
                None => {
                    (self.v_bus / 2.0 + e[phase] - i[phase] / self.phase.b).clamp(0.0, self.v_bus)
                }
            };
        }
        let mean = (v[0] + v[1] + v[2]) / 3.0;
        for phase in 0..2 {
            self.i[phase] = self.phase.a * i[phase] + self.phase.b * (v[phase] - mean - e[phase]);
        }
    }
}
