//! Parameters of the plant in SI units, and their check.

use super::adc::full_scale;
use hexagen_codegen::diagnostics::engineering;
use serde::{Deserialize, Serialize};

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
}

/// One current channel: `count = round(i / amperes_per_count) + offset`, limited to the range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdcChannel {
    /// Resolution in bits, 1 to 16.
    pub bits: u32,
    /// Current per count in amperes; negative for an inverting amplifier.
    pub amperes_per_count: f64,
    /// Count at zero current; need not be whole.
    pub offset: f64,
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
        }
    }
}

/// Current sensors in the low legs: each shows its phase's current while the lower switch or its diode conducts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LowSide {
    /// Time in seconds for which the lower switch must have been on before a sample.
    pub settling: f64,
    /// Time in seconds for which it must stay on after a sample.
    pub hold: f64,
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
}

impl Default for Wiring {
    fn default() -> Self {
        Self {
            windings: [0, 1, 2],
            open: [false; 3],
            upper_dead: [false; 3],
            lower_dead: [false; 3],
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
    /// Current channels.
    pub adc: [AdcChannel; 2],
    /// Their phases, 0 to 2 for a to c.
    #[serde(default = "a_and_b")]
    pub sensed: [usize; 2],
    /// Whether the sensors are in the low legs; else they are in the phases.
    #[serde(default)]
    pub low_side: Option<LowSide>,
    /// Timer ticks per control period of the Hall capture timer.
    pub hall_ticks_per_period: f64,
    /// Hall code shown in sectors S1 to S6.
    pub hall_codes: [u8; 6],
    /// Placement error of the sensors Ha, Hb, Hc in electrical degrees; positive edges come late
    /// in forward rotation.
    pub hall_error_deg: [f64; 3],
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
}

/// PWM periods in a control period that no file tells.
fn one() -> u16 {
    1
}

/// The phases of current channels that no file names.
fn a_and_b() -> [usize; 2] {
    [0, 1]
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
            adc: [AdcChannel::bipolar(12, 40.0); 2],
            sensed: a_and_b(),
            low_side: None,
            hall_ticks_per_period: 1800.0,
            hall_codes: STANDARD_HALL_CODES,
            hall_error_deg: [0.0; 3],
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

    /// Checks every field against the range its documentation states.
    ///
    /// # Errors
    /// The first field outside its range.
    pub fn check(&self) -> Result<(), PlantError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let not_negative = |x: f64| x.is_finite() && x >= 0.0;
        let require = |ok: bool, name, (value, unit), limit: &str| {
            if ok {
                Ok(())
            } else {
                Err(PlantError::Range {
                    name,
                    value,
                    unit,
                    limit: limit.to_owned(),
                })
            }
        };
        let pole_pairs = f64::from(self.pole_pairs);
        require(
            self.pole_pairs > 0,
            "pole_pairs",
            (pole_pairs, ""),
            "at least 1",
        )?;
        for phase in 0..3 {
            let (r, l, k) = (
                self.resistance[phase],
                self.inductance[phase],
                self.k_phase[phase],
            );
            require(
                not_negative(r),
                "resistance",
                (r, "ohm"),
                "finite and not negative",
            )?;
            require(positive(l), "inductance", (l, "H"), "finite and positive")?;
            require(
                not_negative(k),
                "k_phase",
                (k, "V s/rad"),
                "finite and not negative",
            )?;
            let error = self.hall_error_deg[phase];
            require(
                error.abs() < 30.0,
                "hall_error_deg",
                (error, "deg"),
                "within -30 to 30 degrees",
            )?;
        }
        if let EmfShape::Trapezoidal { flat_top_deg } = self.shape {
            let in_range = (0.0..=179.0).contains(&flat_top_deg);
            require(
                in_range,
                "flat_top_deg",
                (flat_top_deg, "deg"),
                "0 to 179 degrees",
            )?;
        }
        require(
            positive(self.v_bus),
            "v_bus",
            (self.v_bus, "V"),
            "finite and positive",
        )?;
        require(
            positive(self.t_s),
            "t_s",
            (self.t_s, "s"),
            "finite and positive",
        )?;
        let period = f64::from(self.timer_period);
        require(
            self.timer_period > 0,
            "timer_period",
            (period, ""),
            "at least 1",
        )?;
        require(
            self.pwm_per_control > 0,
            "pwm_per_control",
            (0.0, ""),
            "at least 1",
        )?;
        let pwm_period = self.pwm_period();
        let dead_ok = (0.0..pwm_period / 2.0).contains(&self.dead_time);
        require(
            dead_ok,
            "dead_time",
            (self.dead_time, "s"),
            &format!(
                "from 0 to below half the period of {}",
                engineering(pwm_period, "s")
            ),
        )?;
        let drop = self.diode_drop;
        require(
            not_negative(drop),
            "diode_drop",
            (drop, "V"),
            "finite and not negative",
        )?;
        for channel in self.adc {
            let bits = f64::from(channel.bits);
            require(
                (1..=16).contains(&channel.bits),
                "adc bits",
                (bits, ""),
                "1 to 16",
            )?;
            let gain = channel.amperes_per_count;
            require(
                positive(gain.abs()),
                "adc amperes_per_count",
                (gain, "A"),
                "finite and not zero",
            )?;
            let in_range = (0.0..=full_scale(channel.bits)).contains(&channel.offset);
            require(
                in_range,
                "adc offset",
                (channel.offset, ""),
                &format!("from 0 to {} counts", full_scale(channel.bits)),
            )?;
        }
        let [first, second] = self.sensed;
        require(
            first < 3 && second < 3 && first != second,
            "sensed",
            (second as f64, ""),
            "two different phases, 0 to 2",
        )?;
        let mut windings = self.wiring.windings;
        windings.sort_unstable();
        let stray = windings.iter().zip(0..).find(|&(&at, place)| at != place);
        require(
            stray.is_none(),
            "windings",
            (stray.map_or(0.0, |(&at, _)| at as f64), ""),
            "0, 1 and 2 in any order",
        )?;
        let ticks = self.hall_ticks_per_period;
        require(
            positive(ticks),
            "hall_ticks_per_period",
            (ticks, ""),
            "finite and positive",
        )?;
        for code in self.hall_codes {
            require(
                (0..=7).contains(&code),
                "hall code",
                (f64::from(code), ""),
                "0 to 7",
            )?;
        }
        if let Some(m) = self.mechanics {
            require(
                positive(m.inertia),
                "inertia",
                (m.inertia, "kg m2"),
                "finite and positive",
            )?;
            let opposing = m.opposing_torque;
            require(
                not_negative(opposing),
                "opposing_torque",
                (opposing, "Nm"),
                "not negative",
            )?;
            let external = m.external_torque;
            require(
                external.is_finite(),
                "external_torque",
                (external, "Nm"),
                "finite",
            )?;
            require(
                not_negative(m.viscous),
                "viscous",
                (m.viscous, "Nm s/rad"),
                "not negative",
            )?;
        }
        Ok(())
    }
}
