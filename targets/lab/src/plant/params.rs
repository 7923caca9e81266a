//! Parameters of the plant in SI units, and their check.

use super::Short;
use super::floor;
use super::hall::EVEN_EDGES_DEG;
use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::spec::ORDERS;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Hall codes `HaHbHc` of sectors S1 to S6 in the wiring of [`hexagen::conventions`].
pub const STANDARD_HALL_CODES: [u8; 6] = [0b001, 0b101, 0b100, 0b110, 0b010, 0b011];

/// Shape of the phase EMF over the electrical angle, amplitude 1, zero and rising at angle 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum EmfShape {
    /// Linear ramps between flat tops of `flat_top_deg` electrical degrees, 0 to below 180.
    Trapezoidal {
        /// Width of the flat top in electrical degrees (120 for the ideal BLDC motor).
        flat_top_deg: f64,
    },
    /// A sine.
    Sinusoidal,
    /// A Fourier series of orders 1, 3, ... 23.
    Harmonics {
        /// Coefficients of sin(n theta).
        sines: [f64; ORDERS],
        /// Coefficients of cos(n theta).
        cosines: [f64; ORDERS],
    },
}

impl EmfShape {
    /// The highest order of its series; 0 of a trapezoid, which is linear between its corners.
    pub fn highest_order(&self) -> usize {
        match self {
            Self::Trapezoidal { .. } => 0,
            Self::Sinusoidal => 1,
            Self::Harmonics { sines, cosines } => {
                let is_there = |place: &usize| sines[*place] != 0.0 || cosines[*place] != 0.0;
                (0..ORDERS)
                    .rev()
                    .find(is_there)
                    .map_or(1, |place| 2 * place + 1)
            }
        }
    }
}

/// One current channel: `count = round(i / amperes_per_count + offset + noise)`, limited to the
/// range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdcChannel {
    /// Resolution in bits, 1 to 16.
    pub bits: u32,
    /// Current per count in amperes; negative for an inverting amplifier.
    pub amperes_per_count: f64,
    /// Count at zero current; need not be whole.
    pub offset: f64,
    /// Greatest current of either sign that the amplifier shows, in amperes; none where the converter's range is less.
    #[serde(default)]
    pub most: Option<f64>,
    /// Standard deviation of Gaussian noise in counts, independent from sample to sample.
    #[serde(default)]
    pub noise: f64,
    /// Time in seconds from the start of a control period to the instant at which the channel is
    /// sampled for it; negative is before it. An ADC that converts one channel after the other
    /// samples the second one later.
    #[serde(default)]
    pub instant: f64,
}

impl AdcChannel {
    /// A channel that maps `-range ..= +range` amperes to the full scale of `bits` bits, with zero
    /// current at mid-scale.
    pub fn bipolar(bits: u32, range: f64) -> Self {
        let half = f64::from(1_u32 << (bits - 1));
        Self {
            bits,
            amperes_per_count: range / half,
            offset: half,
            most: None,
            noise: 0.0,
            instant: 0.0,
        }
    }
}

/// Current sensors in the low legs: each shows its phase's current while the lower switch or its diode conducts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LowSide {
    /// Time in seconds for which the lower switch must have been on before a sample.
    pub settling: f64,
    /// Time in seconds for which it must stay on after a sample.
    pub aperture: f64,
}

/// Wires and switches between inverter and motor, with what is broken of them. Arrays are per leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wiring {
    /// The winding at each leg, 0 to 2 for a to c: two of them exchanged are two exchanged wires.
    pub windings: [usize; 3],
    /// Whether the wire from the leg to its winding is open: no current flows.
    pub open: [bool; 3],
    /// Whether the upper switch never turns on; its diode conducts.
    pub upper_dead: [bool; 3],
    /// Whether the lower switch never turns on; its diode conducts.
    pub lower_dead: [bool; 3],
    /// A short circuit at the motor; no wire that it ties may be open.
    #[serde(default)]
    pub short: Option<Short>,
}

impl Default for Wiring {
    fn default() -> Self {
        Self {
            windings: [0, 1, 2],
            open: [false; 3],
            upper_dead: [false; 3],
            lower_dead: [false; 3],
            short: None,
        }
    }
}

/// The mechanical side of a plant whose speed is free.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mechanics {
    /// Moment of inertia of rotor and load in kg m^2, positive.
    pub inertia: f64,
    /// Load torque in N m that opposes the motion, whatever its direction, and holds the rotor at
    /// rest until it is exceeded (dry friction); not negative.
    pub opposing_torque: f64,
    /// External torque in N m that drives the shaft in the positive direction (a hoist's weight:
    /// negative), at any speed.
    pub external_torque: f64,
    /// Viscous friction in N m s/rad; not negative.
    pub viscous: f64,
}

/// A sensor of the shaft's angle, or of the electrical angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AngleSensor {
    /// Electrical turns in a turn of the sensor, not 0; negative where its angle falls in forward rotation.
    pub turns: i32,
    /// Electrical angle at its angle 0, degrees.
    pub offset_deg: f64,
    /// Bits of a turn that it resolves, 1 to 32.
    pub bits: u32,
}

impl AngleSensor {
    /// The word of a sample at an electrical angle in radians, 2^32 a turn, at the nearest of its steps; whole turns
    /// count, as they are parts of the sensor's.
    pub(super) fn word(self, theta_e: f64) -> u32 {
        let turn = (theta_e - self.offset_deg.to_radians()) / (TAU * f64::from(self.turns));
        let steps = f64::from(self.bits).exp2();
        let step = floor((turn - floor(turn)) * steps + 0.5) % steps;
        (step * (32.0 - f64::from(self.bits)).exp2()) as u32
    }
}

/// Motor, inverter and sensors of a simulated plant. Arrays are per phase a, b, c, named after the
/// inverter's legs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlantParams {
    /// Pole pairs.
    pub pole_pairs: u32,
    /// Resistance per star phase in ohm.
    pub resistance: [f64; 3],
    /// Inductance per star phase (self minus mutual) in henry.
    pub inductance: [f64; 3],
    /// Peak phase EMF per mechanical speed in V s/rad; half of the line-to-line constant for a
    /// trapezoidal EMF.
    pub k_phase: [f64; 3],
    /// Shape of the EMF.
    pub shape: EmfShape,
    /// Bus voltage in volts. A sag is a plant with a lower value than the controller's.
    pub v_bus: f64,
    /// Control period in seconds.
    pub t_s: f64,
    /// PWM periods in a control period, in each of which the inverter plays the same command.
    #[serde(default = "one")]
    pub pwm_per_control: u16,
    /// Timer counts per PWM period: the compare value of full duty.
    pub timer_period: u16,
    /// Time in seconds for which both switches of a leg stay off at each change between them.
    pub dead_time: f64,
    /// Forward drop of the freewheel diodes in volts; 0 for ideal diodes. Switches are ideal.
    pub diode_drop: f64,
    /// Current channels, two or three.
    pub adc: Vec<AdcChannel>,
    /// Their phases, 0 to 2 for a to c.
    #[serde(default = "a_and_b")]
    pub sensed: Vec<usize>,
    /// Whether the sensors are in the low legs; else they are in the phases.
    #[serde(default)]
    pub low_side: Option<LowSide>,
    /// Timer ticks per control period of the Hall capture timer.
    pub hall_ticks_per_period: f64,
    /// Hall code shown in sectors S1 to S6.
    pub hall_codes: [u8; 6],
    /// Electrical angles of the edges at which sectors S1 to S6 begin, forward, in degrees.
    #[serde(default = "even_edges")]
    pub hall_edges_deg: [f64; 6],
    /// Placement error of the sensors Ha, Hb, Hc in electrical degrees; positive edges come late
    /// in forward rotation.
    pub hall_error_deg: [f64; 3],
    /// An angle sensor, whose angle takes the place of Hall code and ticks in the samples.
    #[serde(default)]
    pub angle: Option<AngleSensor>,
    /// Inertia and load, or `None` for a shaft held at its initial speed.
    pub mechanics: Option<Mechanics>,
    /// Wires and switches; sound by default.
    #[serde(default)]
    pub wiring: Wiring,
}

/// Error of plant parameters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlantError {
    /// A quantity is not a finite number in its range.
    #[error("plant: {name} is {}, but must be {limit}", engineering(*value, unit))]
    Range {
        /// Name of the field.
        name: &'static str,
        /// The value given.
        value: f64,
        /// Its unit; empty for a plain number.
        unit: &'static str,
        /// The range that is allowed.
        limit: String,
    },
    /// A quantity of the current sensors has not one value of each.
    #[error(
        "plant: {given} values of the {name}, but there are {sensors} current sensors; give one for all, or one of each"
    )]
    Sensors {
        /// Name of the quantity.
        name: &'static str,
        /// How many values were given.
        given: usize,
        /// How many sensors there are.
        sensors: usize,
    },
}

/// PWM periods in a control period that no file tells.
fn one() -> u16 {
    1
}

/// Hall edges that no file tells.
fn even_edges() -> [f64; 6] {
    EVEN_EDGES_DEG
}

/// The phases of current channels that no file names.
fn a_and_b() -> Vec<usize> {
    vec![0, 1]
}

impl PlantParams {
    /// Period of the PWM in seconds.
    pub fn pwm_period(&self) -> f64 {
        self.t_s / f64::from(self.pwm_per_control)
    }

    /// An ideal plant with equal phases: trapezoidal EMF with a 120 degree flat top, no dead time,
    /// ideal diodes, 12-bit channels of +-40 A, standard Hall wiring, fixed speed, 1800 timer
    /// counts and 1800 capture ticks per period. Arguments in SI units, `k_phase` in V s/rad.
    pub fn ideal(pole_pairs: u32, r: f64, l: f64, k_phase: f64, v_bus: f64, t_s: f64) -> Self {
        Self {
            pole_pairs,
            resistance: [r; 3],
            inductance: [l; 3],
            k_phase: [k_phase; 3],
            shape: EmfShape::Trapezoidal {
                flat_top_deg: 120.0,
            },
            v_bus,
            t_s,
            pwm_per_control: one(),
            timer_period: 1800,
            dead_time: 0.0,
            diode_drop: 0.0,
            adc: vec![AdcChannel::bipolar(12, 40.0); 2],
            sensed: a_and_b(),
            low_side: None,
            hall_ticks_per_period: 1800.0,
            hall_codes: STANDARD_HALL_CODES,
            hall_edges_deg: EVEN_EDGES_DEG,
            hall_error_deg: [0.0; 3],
            angle: None,
            mechanics: None,
            wiring: Wiring::default(),
        }
    }

    /// The same plant with all phases' R, L and EMF constant multiplied by the given factors.
    #[must_use]
    pub fn scaled(mut self, r: f64, l: f64, k_b: f64) -> Self {
        self.resistance = self.resistance.map(|x| x * r);
        self.inductance = self.inductance.map(|x| x * l);
        self.k_phase = self.k_phase.map(|x| x * k_b);
        self
    }

    /// Scales the true current per ADC count of all channels, unknown to the controller.
    pub fn scale_adc(&mut self, scales: &[f64]) {
        for (channel, scale) in self.adc.iter_mut().zip(scales) {
            channel.amperes_per_count *= scale;
        }
    }
}
