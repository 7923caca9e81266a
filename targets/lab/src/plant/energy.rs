//! The energy balance of a run, integrated exactly on each segment.

use super::machine::Observer;
use super::segment::{Segment, TERMS, Terminal, integral};
use super::{Plant, PlantParams};
use serde::Serialize;

/// Energy balance of a run, in joules.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EnergyBalance {
    /// Taken from the bus (negative: returned).
    pub bus: f64,
    /// Copper loss.
    pub copper: f64,
    /// Loss in the diodes' forward drop.
    pub diodes: f64,
    /// Given to the shaft (EMF times current).
    pub shaft: f64,
    /// Increase of the magnetic energy.
    pub magnetic: f64,
}

impl EnergyBalance {
    /// The balance's error, in joules.
    pub fn error(&self) -> f64 {
        self.bus - self.copper - self.diodes - self.shaft - self.magnetic
    }

    /// The error over the largest item; 0 when nothing flowed.
    pub fn relative_error(&self) -> f64 {
        let items = [
            self.bus,
            self.copper,
            self.diodes,
            self.shaft,
            self.magnetic,
        ];
        let largest = items.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if largest > 0.0 {
            self.error().abs() / largest
        } else {
            0.0
        }
    }
}

/// An observer that computes the energy balance.
#[derive(Clone, Debug)]
pub struct EnergyMeter {
    resistance: [f64; 3],
    inductance: [f64; 3],
    v_bus: f64,
    drop: f64,
    balance: EnergyBalance,
    initial: f64,
}

impl EnergyMeter {
    /// A meter that starts at the plant's present state.
    pub fn new(plant: &Plant) -> Self {
        let PlantParams {
            resistance,
            inductance,
            v_bus,
            diode_drop,
            ..
        } = *plant.params();
        let mut meter = Self {
            resistance,
            inductance,
            v_bus,
            drop: diode_drop,
            balance: EnergyBalance::default(),
            initial: 0.0,
        };
        meter.initial = meter.magnetic(plant);
        meter
    }

    fn magnetic(&self, plant: &Plant) -> f64 {
        let currents = plant.truth().currents;
        (0..3)
            .map(|x| 0.5 * self.inductance[x] * currents[x] * currents[x])
            .sum()
    }

    /// The balance up to the plant's present state.
    pub fn balance(&self, plant: &Plant) -> EnergyBalance {
        EnergyBalance {
            magnetic: self.magnetic(plant) - self.initial,
            ..self.balance
        }
    }
}

impl Observer for EnergyMeter {
    fn segment(&mut self, segment: &Segment) {
        let h = segment.duration;
        let terms = segment.terms;
        for x in 0..3 {
            let charge = integral(&segment.current[x][..terms], h);
            if let Terminal::Rail { upper, diode, .. } = segment.terminal[x] {
                if upper {
                    self.balance.bus += self.v_bus * charge;
                }
                if diode {
                    self.balance.diodes += self.drop * charge.abs();
                }
            }
            let mut powers = [0.0; TERMS];
            let mut scale = 1.0;
            for (power, c) in powers[..terms].iter_mut().zip(&segment.current[x]) {
                *power = c * scale;
                scale *= h;
            }
            for (j, a) in powers[..terms].iter().enumerate() {
                for (k, b) in powers[..terms].iter().enumerate() {
                    self.balance.copper += self.resistance[x] * h * a * b / (j + k + 1) as f64;
                }
            }
        }
        self.balance.shaft += segment.omega_m * integral(&segment.torque[..terms], h);
    }
}
