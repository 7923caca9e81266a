//! The normalised specification that a generated drive carries (`Drive::SPEC`), read from its TOML
//! text.
//!
//! All quantities are in SI units and per phase of the star; every default is filled in. Parsing
//! rejects unknown fields and values outside their physical range, nothing more: the generator
//! has already judged the motor.

use crate::Error;
use serde::Deserialize;

/// A whole normalised specification.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    /// Name of the generated type.
    pub name: String,
    /// The motor.
    pub motor: Motor,
    /// Inverter, sampling and supervision.
    pub inverter: Inverter,
    /// The controller and its options.
    pub controller: Controller,
}

/// The motor, as an equivalent star.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// Pole pairs.
    pub pole_pairs: u32,
    /// Phase resistance, ohm.
    pub resistance: f64,
    /// Phase inductance, henry.
    pub inductance: f64,
    /// Peak phase EMF over mechanical speed, V s/rad.
    pub emf_constant: f64,
    /// Shape of the EMF.
    pub emf_shape: EmfShapeKind,
    /// Width of the trapezoid's flat top, electrical degrees. Trapezoidal only.
    pub flat_top_deg: Option<f64>,
    /// Torque per ampere of set-point, Nm/A.
    pub torque_constant: f64,
    /// Hall codes of sectors 1 to 6, Ha in bit 2.
    pub hall_codes: [u8; 6],
}

/// Shape of the EMF over the electrical angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EmfShapeKind {
    /// Linear ramps and a flat top.
    Trapezoidal,
    /// A sine.
    Sinusoidal,
}

/// Inverter, sampling and supervision.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inverter {
    /// Nominal bus voltage, volt.
    pub v_bus: f64,
    /// Whether the bus voltage is measured.
    pub bus: Bus,
    /// Volt per count of the bus ADC. Measured bus only.
    pub bus_gain: Option<f64>,
    /// Bits of the bus ADC. Measured bus only.
    pub bus_adc_bits: Option<u32>,
    /// Least bus voltage, volt. Measured bus only.
    pub bus_min: Option<f64>,
    /// Greatest bus voltage, volt. Measured bus only.
    pub bus_max: Option<f64>,
    /// Control period, seconds.
    pub t_s: f64,
    /// Timer counts of a duty of one.
    pub timer_period: u32,
    /// Bits of the current ADC.
    pub adc_bits: u32,
    /// Ampere per count of the current ADC, signed.
    pub adc_gain: f64,
    /// Count at zero current.
    pub adc_offset: u32,
    /// Trip level of the phase currents, ampere.
    pub trip_current: f64,
    /// Largest current set-point, ampere.
    pub max_current: f64,
    /// How Hall edges are timed.
    pub hall_capture: HallCapture,
    /// Timer ticks per control period (2 when the edges are sampled).
    pub ticks: u32,
    /// Ticks of 60 electrical degrees at the least speed with a valid angle.
    pub age_max: u32,
    /// Ticks of an electrical turn at the greatest speed.
    pub rev_min: u32,
    /// Greatest mechanical speed, rad/s.
    pub omega_max: f64,
    /// Periods without a Hall edge that count as a stall; 0: not watched.
    pub stall_periods: u32,
    /// Binary logarithm of the number of calibration samples.
    pub calibration_log2: u32,
    /// Periods of bootstrap pre-charge; 0: none.
    pub precharge_periods: u32,
}

/// Where the bus voltage comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bus {
    /// The nominal value.
    Fixed,
    /// An ADC count, handed over with `set_bus`.
    Measured,
}

/// The bus voltage's measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BusSense {
    /// Volt per count.
    pub gain: f64,
    /// Bits of the ADC.
    pub adc_bits: u32,
    /// Least voltage, volt.
    pub min: f64,
    /// Greatest voltage, volt.
    pub max: f64,
}

/// How Hall edges are timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HallCapture {
    /// Edges are seen at sampling instants.
    Sampled,
    /// A timer counts from the last edge.
    Timer,
}

/// A controller and its options.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Controller {
    /// Predictive deadbeat current control.
    Pdcc(Pdcc),
}

/// Options of predictive deadbeat current control (DESIGN section 4).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pdcc {
    /// How a voltage becomes leg commands.
    pub modulation: Modulation,
    /// What gives way outside the hexagon.
    pub saturation: Saturation,
    /// Where the EMF comes from.
    pub emf: EmfSource,
    /// Weight of a new EMF estimate, above 0 to 1 (1: no filter).
    pub emf_filter: f64,
    /// What the currents follow.
    pub reference: Reference,
    /// Phase advance, periods of electrical angle.
    pub advance: f64,
    /// Periods between sampling and the command's effect, 0 or 1.
    pub delay: u32,
    /// Discretisation of the plant.
    pub discretisation: Discretisation,
    /// Word length, 16 or 32 bits.
    pub word: u32,
    /// Outgoing current that ends a commutation, ampere.
    pub commutation_threshold: f64,
    /// Periods after which a commutation is taken as ended.
    pub commutation_timeout: u32,
}

/// How a voltage becomes leg commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Modulation {
    /// Three duties in every period.
    ThreePhase,
    /// Three duties in commutation, else one pulsed leg of the conducting pair.
    Pair,
}

/// What gives way when the voltage lies outside the hexagon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Saturation {
    /// Scale to the edge.
    KeepAngle,
    /// Nearest point of the hexagon.
    Nearest,
    /// Keep the component along the EMF.
    TorquePriority,
}

/// Where the EMF comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EmfSource {
    /// From the last period's voltage and currents.
    Estimated,
    /// From the motor's EMF shape at the interpolated Hall angle.
    Model,
}

/// What the currents follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reference {
    /// The sector's corner.
    QuasiSquare,
    /// Parallel to the EMF.
    Proportional,
}

/// Discretisation of the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Discretisation {
    /// a = exp(-R Ts/L), b = (1 - a)/R.
    Exact,
    /// a = 1 - R Ts/L, b = Ts/L.
    Euler,
}

impl Spec {
    /// Reads a normalised specification from its TOML text.
    ///
    /// # Errors
    /// When the text is not a normalised specification or a value is out of its physical range.
    pub fn from_toml(text: &str) -> Result<Self, Error> {
        let spec: Self = toml::from_str(text).map_err(|error| Error::Syntax(error.to_string()))?;
        spec.check()?;
        Ok(spec)
    }

    /// The PDCC options.
    pub fn pdcc(&self) -> &Pdcc {
        let Controller::Pdcc(pdcc) = &self.controller;
        pdcc
    }

    fn check(&self) -> Result<(), Error> {
        let (motor, inverter, pdcc) = (&self.motor, &self.inverter, self.pdcc());
        for (field, value) in [
            ("motor.resistance", motor.resistance),
            ("motor.inductance", motor.inductance),
            ("motor.emf_constant", motor.emf_constant),
            ("motor.torque_constant", motor.torque_constant),
            ("inverter.v_bus", inverter.v_bus),
            ("inverter.t_s", inverter.t_s),
            ("inverter.adc_gain", inverter.adc_gain.abs()),
            ("inverter.trip_current", inverter.trip_current),
            ("inverter.max_current", inverter.max_current),
            ("inverter.omega_max", inverter.omega_max),
            ("controller.emf_filter", pdcc.emf_filter),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::field(
                    field,
                    value,
                    "expected a finite number above 0",
                ));
            }
        }
        for (field, value, least, greatest) in [
            ("motor.pole_pairs", motor.pole_pairs, 1, 1000),
            ("inverter.timer_period", inverter.timer_period, 1, 65_535),
            ("inverter.adc_bits", inverter.adc_bits, 1, 16),
            ("inverter.ticks", inverter.ticks, 1, 65_535),
            ("inverter.age_max", inverter.age_max, 1, 65_534),
            ("inverter.rev_min", inverter.rev_min, 1, u32::MAX),
            (
                "inverter.calibration_log2",
                inverter.calibration_log2,
                0,
                15,
            ),
            ("controller.delay", pdcc.delay, 0, 1),
        ] {
            if !(least..=greatest).contains(&value) {
                return Err(Error::field(
                    field,
                    value,
                    "outside the range of the hardware or of the method",
                ));
            }
        }
        if !(0.0..=2.0).contains(&pdcc.advance) {
            return Err(Error::field(
                "controller.advance",
                pdcc.advance,
                "expected 0 to 2 periods",
            ));
        }
        if pdcc.emf_filter > 1.0 {
            return Err(Error::field(
                "controller.emf_filter",
                pdcc.emf_filter,
                "expected at most 1",
            ));
        }
        if !(pdcc.commutation_threshold.is_finite() && pdcc.commutation_threshold >= 0.0) {
            return Err(Error::field(
                "controller.commutation_threshold",
                pdcc.commutation_threshold,
                "expected 0 or more",
            ));
        }
        let mut codes = motor.hall_codes;
        codes.sort_unstable();
        if codes != [1, 2, 3, 4, 5, 6] {
            return Err(Error::field(
                "motor.hall_codes",
                format!("{:?}", motor.hall_codes),
                "expected each of 1 to 6 once",
            ));
        }
        inverter.bus_sense()?;
        Ok(())
    }
}

impl Inverter {
    /// The bus voltage's measurement, if there is one.
    ///
    /// # Errors
    /// When the bus is measured but a field of the measurement is missing.
    pub fn bus_sense(&self) -> Result<Option<BusSense>, Error> {
        let needed = |field, value: Option<f64>| {
            value.ok_or(Error::Missing {
                field,
                reason: "the bus voltage is measured",
            })
        };
        match self.bus {
            Bus::Fixed => Ok(None),
            Bus::Measured => Ok(Some(BusSense {
                gain: needed("inverter.bus_gain", self.bus_gain)?,
                adc_bits: self.bus_adc_bits.ok_or(Error::Missing {
                    field: "inverter.bus_adc_bits",
                    reason: "the bus voltage is measured",
                })?,
                min: needed("inverter.bus_min", self.bus_min)?,
                max: needed("inverter.bus_max", self.bus_max)?,
            })),
        }
    }

    /// The largest bus voltage, volt.
    ///
    /// # Errors
    /// As [`Self::bus_sense`].
    pub fn v_bus_max(&self) -> Result<f64, Error> {
        Ok(self.bus_sense()?.map_or(self.v_bus, |bus| bus.max))
    }
}

impl Error {
    fn field(field: &'static str, value: impl std::fmt::Display, expected: &'static str) -> Self {
        Self::Field {
            field,
            value: format!("{value}"),
            expected,
        }
    }
}
