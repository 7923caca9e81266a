//! The normalised specification of a generated drive (`Drive::SPEC`), read from its TOML text.
//!
//! All quantities are in SI units and per phase of the star; every default is filled in. Parsing
//! rejects unknown fields and values outside their physical range only: the generator has checked
//! the motor.

mod controller;

use crate::Error;
use hexagen::Sample;
use serde::Deserialize;

pub use controller::{
    Candidates, CommonMode, CommutationEnd, Controller, Discretisation, EmfSource, FcsMpc,
    LoopOptions, Modulation, OffLeg, PPwm, Pdcc, Phcc, PiPwm, Reference, Saturation, Switch,
    SwitchingTable, Zero,
};

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
    /// Coefficients of sin(n theta), n = 1, 3, ... 23, of a Fourier series.
    pub emf_sines: Option<[f64; 12]>,
    /// Coefficients of cos(n theta).
    pub emf_cosines: Option<[f64; 12]>,
    /// Torque per ampere of set-point, Nm/A.
    pub torque_constant: f64,
    /// c2 and c4 of the torque that a current turned by a turns keeps, 1 - a^2 (c2 - c4 a^2); with field
    /// weakening only.
    #[serde(default)]
    pub weakening_share: Option<[f64; 2]>,
    /// Hall codes of sectors 1 to 6, Ha in bit 2; with an angle sensor those of sensors in the usual order.
    #[serde(default = "usual_codes")]
    pub hall_codes: [u8; 6],
    /// Electrical angles at which these sectors begin, degrees; none where all sensors are in place.
    #[serde(default)]
    pub hall_angles: Option<[f64; 6]>,
}

const fn usual_codes() -> [u8; 6] {
    [1, 5, 4, 6, 2, 3]
}

const fn one_tick() -> f64 {
    1.0
}

/// Electrical angles at which sectors 1 to 6 begin where all sensors are in place, degrees.
pub const EVEN_EDGES: [f64; 6] = [-30.0, 30.0, 90.0, 150.0, 210.0, 270.0];

impl Motor {
    /// Of each sector, where it begins beyond its place, and its width, radian.
    pub fn sectors_beyond_places(&self) -> [[f64; 2]; 6] {
        let begins = self.hall_angles.unwrap_or(EVEN_EDGES);
        std::array::from_fn(|k| {
            let width = (begins[(k + 1) % 6] - begins[k]).rem_euclid(360.0);
            [begins[k] - EVEN_EDGES[k], width].map(f64::to_radians)
        })
    }

    /// Whether each edge lies half a turn from the third one after it, as those of one sensor do.
    pub fn edges_are_opposite(&self) -> bool {
        let begins = self.hall_angles.unwrap_or(EVEN_EDGES);
        (0..3).all(|k| (begins[k + 3] - begins[k] - 180.0).abs() < 1e-6)
    }

    /// Width of the widest sector, radian.
    pub fn widest_sector(&self) -> f64 {
        let widths = self.sectors_beyond_places().map(|[_, width]| width);
        widths
            .into_iter()
            .fold(std::f64::consts::FRAC_PI_3, f64::max)
    }

    /// The sensors that are turned round where all three stand 60 degrees apart, as bits of the code:
    /// the two codes that do not occur are then those of equal sensors. Else 0.
    pub fn hall_inverted(&self) -> u8 {
        let missing = (0..8_u8).filter(|code| !self.hall_codes.contains(code));
        missing.min_by_key(|code| code.count_ones()).unwrap_or(0)
    }
}

/// Shape of the EMF over the electrical angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EmfShapeKind {
    /// Linear ramps and a flat top.
    Trapezoidal,
    /// A sine.
    Sinusoidal,
    /// A Fourier series.
    Harmonics,
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
    /// Least and greatest ADC count of the bus voltage without a fault. Measured bus only.
    #[serde(default = "any_count")]
    pub bus_counts: [u16; 2],
    /// Bus voltages of the whole set-point and of none, volt, for braking torque.
    pub braking_fade: Option<[f64; 2]>,
    /// The same for motoring torque.
    pub motoring_fade: Option<[f64; 2]>,
    /// Control period, seconds.
    pub t_s: f64,
    /// Timer counts of a duty of one.
    pub timer_period: u32,
    /// Bits of the current ADC.
    pub adc_bits: u32,
    /// PWM periods in a control period.
    #[serde(default = "one")]
    pub pwm_per_control: u32,
    /// Ampere per count of the current ADCs, signed.
    pub adc_gain: OfSensors<f64>,
    /// Counts at zero current.
    pub adc_offset: OfSensors<u32>,
    /// The phases with a sensor.
    #[serde(default)]
    pub sensed_phases: SensedPhases,
    /// Where the sensors are.
    #[serde(default)]
    pub current_sensing: CurrentSensing,
    /// Time that a lower switch is on before its current can be sampled, second. Low side only.
    pub settling_time: Option<f64>,
    /// Time that a converter's input must stay, second. Low side only.
    pub aperture_time: Option<f64>,
    /// Time from a conversion to the next of the same ADC, second. Low side only.
    pub conversion_time: Option<f64>,
    /// Converters that sample at once.
    #[serde(default = "one")]
    pub current_adcs: u32,
    /// Time from the sampling instant to the turning point, second. Low side only.
    pub sampling_lead: Option<f64>,
    /// Largest sum of three measured currents without a fault, ampere; none: the sum is not watched.
    pub current_sum_tolerance: Option<f64>,
    /// Samples in a row with a larger sum that are a fault.
    #[serde(default)]
    pub current_sum_samples: u32,
    /// Time for which each leg that switches is low in every PWM period, second.
    #[serde(default)]
    pub minimum_low_time: f64,
    /// Greatest distance of a calibrated offset from `adc_offset`, counts.
    pub offset_tolerance: u32,
    /// Trip level of the phase currents, ampere.
    pub trip_current: f64,
    /// Largest current set-point, ampere.
    pub max_current: f64,
    /// Greatest bus current drawn from the supply, ampere.
    pub bus_current_limit: Option<f64>,
    /// Greatest bus current returned to it, ampere.
    pub return_current_limit: Option<f64>,
    /// Dead time, second; only if above 0.
    #[serde(default)]
    pub dead_time: f64,
    /// How Hall edges are timed.
    #[serde(default)]
    pub hall_capture: HallCapture,
    /// Timer ticks per control period, whole or not (2 when the edges are sampled, 1 with an angle sensor).
    #[serde(default = "one_tick")]
    pub ticks: f64,
    /// Ticks of 60 electrical degrees at the least speed with a valid angle.
    #[serde(default = "one")]
    pub age_max: u32,
    /// Ticks of an electrical turn at the greatest speed.
    #[serde(default = "one")]
    pub rev_min: u32,
    /// Electrical turns in a turn of the angle sensor, signed; none with Hall sensors.
    pub angle_turns: Option<i32>,
    /// Electrical angle at the sensor's angle 0, 2^32 a turn.
    #[serde(default)]
    pub angle_offset: u32,
    /// Binary logarithm of the time constant of the speed's filter, periods.
    #[serde(default)]
    pub angle_filter: u32,
    /// Greatest difference of two angles, 2^32 a turn.
    #[serde(default)]
    pub turn_max: u32,
    /// Electrical angle per period at the over-speed, with an angle sensor, 2^32 a turn.
    pub over_speed_step: Option<u32>,
    /// Greatest mechanical speed, rad/s.
    pub omega_max: f64,
    /// Ticks of an electrical turn at the over-speed; none: the speed is not watched.
    pub over_speed_turn: Option<u32>,
    /// Periods without a Hall edge that count as a stall; 0 without stall detection.
    pub stall_periods: u32,
    /// Samples in a row with a disturbed Hall code that are bridged.
    #[serde(default)]
    pub hall_glitches: u32,
    /// Periods of a sector at the speed up to which a short circuit brakes; 0: at every speed.
    #[serde(default)]
    pub brake_periods: u32,
    /// Periods that a start waits at most for the rotor's angle; 0: none.
    #[serde(default)]
    pub start_periods: u32,
    /// Binary logarithm of the number of calibration samples.
    pub calibration_log2: u32,
    /// Periods of bootstrap pre-charge; 0: none.
    pub precharge_periods: u32,
}

/// One value for all current sensors, or one of each in the order of the sensed phases.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum OfSensors<T> {
    /// For all.
    All(T),
    /// Of each.
    Each(Vec<T>),
}

impl<T: Copy> OfSensors<T> {
    /// That of the first sensor, the base of words of current.
    ///
    /// # Panics
    /// With an empty list, which [`Spec::from_toml`] refuses.
    pub fn first(&self) -> T {
        self.of(0)
    }

    /// That of a sensor.
    ///
    /// # Panics
    /// With a shorter list, which [`Spec::from_toml`] refuses.
    pub fn of(&self, sensor: usize) -> T {
        match self {
            Self::All(value) => *value,
            Self::Each(values) => values[sensor],
        }
    }

    fn has(&self, sensors: usize) -> bool {
        match self {
            Self::All(_) => true,
            Self::Each(values) => values.len() == sensors,
        }
    }
}

/// Which phases have a current sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SensedPhases {
    /// Phases a and b.
    #[default]
    Ab,
    /// Phases b and c.
    Bc,
    /// Phases c and a.
    Ca,
    /// All three.
    Abc,
}

impl SensedPhases {
    /// The phases, 0 to 2 for a to c, in the order of the sensors.
    pub fn phases(self) -> &'static [usize] {
        match self {
            Self::Ab => &[0, 1],
            Self::Bc => &[1, 2],
            Self::Ca => &[2, 0],
            Self::Abc => &[0, 1, 2],
        }
    }

    /// What belongs to the first two sensors and the third phase, of what belongs to phases a, b, c.
    pub fn of_sensors<T: Copy>(self, of_phases: [T; 3]) -> [T; 3] {
        let [first, second] = [0, 1].map(|sensor| self.phases()[sensor]);
        [first, second, 3 - first - second].map(|phase| of_phases[phase])
    }

    /// What belongs to phases a, b, c, of what belongs to the first two sensors and the third phase.
    pub fn of_phases<T: Copy>(self, [first, second]: [T; 2], third: T) -> [T; 3] {
        let mut all = [third; 3];
        all[self.phases()[0]] = first;
        all[self.phases()[1]] = second;
        all
    }

    /// A sample with these counts of the first two sensors and the third phase, which says nothing where that
    /// has no sensor.
    pub fn sample(self, counts: [u16; 3], hall: u8) -> Sample {
        let [adc_a, adc_b, adc_c] = self.counts(counts);
        Sample::with_hall([adc_a, adc_b], hall).third_current(adc_c)
    }

    /// The same with the angle of a sensor.
    pub fn sample_with_angle(self, counts: [u16; 3], angle: u32) -> Sample {
        let [adc_a, adc_b, adc_c] = self.counts(counts);
        Sample::with_angle([adc_a, adc_b], angle).third_current(adc_c)
    }

    /// Counts of phases a, b, c.
    fn counts(self, [first, second, third]: [u16; 3]) -> [u16; 3] {
        let third = match self {
            Self::Abc => third,
            Self::Ab => 0,
            Self::Bc | Self::Ca => !first,
        };
        self.of_phases([first, second], third)
    }
}

/// Where the current sensors are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CurrentSensing {
    /// In the phases.
    #[default]
    InPhase,
    /// In the low legs.
    LowSide,
}

fn one() -> u32 {
    1
}

fn any_count() -> [u16; 2] {
    [0, u16::MAX]
}

/// Source of the bus voltage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bus {
    /// The nominal value.
    Fixed,
    /// An ADC count, set by `set_bus`.
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HallCapture {
    /// Edges are seen at sampling instants.
    #[default]
    Sampled,
    /// A timer counts from the last edge.
    Timer,
}

impl Spec {
    /// Reads a normalised specification from its TOML text.
    ///
    /// # Errors
    /// If the text is not a normalised specification or a value is out of its physical range.
    pub fn from_toml(text: &str) -> Result<Self, Error> {
        let spec: Self = toml::from_str(text).map_err(|error| Error::Syntax(error.to_string()))?;
        spec.check()?;
        Ok(spec)
    }

    /// Whether the highest of three pulsed legs is left unread where it is too high.
    ///
    /// # Errors
    /// As [`Inverter::largest_compare`].
    pub fn spares_highest(&self) -> Result<bool, Error> {
        let mode = match &self.controller {
            Controller::Pdcc(pdcc) => pdcc.common_mode,
            Controller::PiPwm(pi_pwm) => pi_pwm.common_mode,
            Controller::PPwm(p_pwm) => p_pwm.common_mode,
            Controller::FcsMpc(_) | Controller::Phcc(_) => CommonMode::Centred,
        };
        let inverter = &self.inverter;
        let is_higher = inverter.highest_compare()? > inverter.largest_compare()?;
        Ok(mode != CommonMode::Centred && is_higher)
    }

    /// The options of all controllers.
    pub fn loop_options(&self) -> LoopOptions {
        match &self.controller {
            Controller::Pdcc(pdcc) => pdcc.loop_options(),
            Controller::FcsMpc(fcs_mpc) => fcs_mpc.loop_options(),
            Controller::Phcc(phcc) => phcc.loop_options(),
            Controller::PiPwm(pi_pwm) => pi_pwm.loop_options(),
            Controller::PPwm(p_pwm) => p_pwm.loop_options(),
        }
    }

    /// Part of the PWM period that a pulse loses to the dead time; 0 for whole vectors.
    pub fn dead_share(&self) -> f64 {
        let pulses = match &self.controller {
            Controller::FcsMpc(fcs_mpc) => fcs_mpc.modulated == Switch::On,
            Controller::Phcc(_) => false,
            Controller::Pdcc(_) | Controller::PiPwm(_) | Controller::PPwm(_) => true,
        };
        let pwm_period = self.inverter.t_s / f64::from(self.inverter.pwm_per_control);
        if pulses {
            self.inverter.dead_time / pwm_period
        } else {
            0.0
        }
    }

    /// The end of a commutation; `None` for a controller that tracks none.
    pub fn commutation_end(&self) -> Option<CommutationEnd> {
        let (threshold, timeout) = match &self.controller {
            Controller::Pdcc(Pdcc {
                commutation_threshold,
                commutation_timeout,
                ..
            })
            | Controller::FcsMpc(FcsMpc {
                commutation_threshold,
                commutation_timeout,
                ..
            })
            | Controller::Phcc(Phcc {
                commutation_threshold,
                commutation_timeout,
                ..
            })
            | Controller::PiPwm(PiPwm {
                modulation: Modulation::Table2,
                commutation_threshold,
                commutation_timeout,
                ..
            }) => (*commutation_threshold, *commutation_timeout),
            Controller::PiPwm(_) | Controller::PPwm(_) => return None,
        };
        Some(CommutationEnd { threshold, timeout })
    }

    /// c2 and c4 of the torque that a turned current keeps; with field weakening only.
    pub fn weakening_share(&self) -> Option<[f64; 2]> {
        let is_on = self.loop_options().field_weakening == Switch::On;
        self.motor.weakening_share.filter(|_| is_on)
    }

    fn check(&self) -> Result<(), Error> {
        let (motor, inverter, options) = (&self.motor, &self.inverter, self.loop_options());
        for (field, value) in [
            ("motor.resistance", motor.resistance),
            ("motor.inductance", motor.inductance),
            ("motor.emf_constant", motor.emf_constant),
            ("motor.torque_constant", motor.torque_constant),
            ("inverter.v_bus", inverter.v_bus),
            ("inverter.t_s", inverter.t_s),
            ("inverter.adc_gain", inverter.adc_gain.first().abs()),
            ("inverter.trip_current", inverter.trip_current),
            ("inverter.max_current", inverter.max_current),
            ("inverter.omega_max", inverter.omega_max),
            ("controller.emf_filter", options.emf_filter),
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
            ("inverter.age_max", inverter.age_max, 1, 65_534),
            ("inverter.rev_min", inverter.rev_min, 1, u32::MAX),
            (
                "inverter.calibration_log2",
                inverter.calibration_log2,
                0,
                15,
            ),
            ("controller.delay", options.delay, 0, 1),
        ] {
            if !(least..=greatest).contains(&value) {
                return Err(Error::field(
                    field,
                    value,
                    "outside the range of the hardware or of the method",
                ));
            }
        }
        if !(1.0..=65_535.0).contains(&inverter.ticks) {
            return Err(Error::field(
                "inverter.ticks",
                inverter.ticks,
                "expected 1 to 65535",
            ));
        }
        if !(0.0..=2.0).contains(&options.advance) {
            return Err(Error::field(
                "controller.advance",
                options.advance,
                "expected 0 to 2 periods",
            ));
        }
        if options.emf_filter > 1.0 {
            return Err(Error::field(
                "controller.emf_filter",
                options.emf_filter,
                "expected at most 1",
            ));
        }
        if !(inverter.angle_filter <= 6 && i32::try_from(inverter.turn_max).is_ok()) {
            return Err(Error::field(
                "inverter.turn_max",
                inverter.turn_max,
                "expected less than half a turn, and a filter of at most 6 bits",
            ));
        }
        self.check_controller()?;
        inverter.check_sensors()?;
        let mut codes = motor.hall_codes.map(|code| code ^ motor.hall_inverted());
        codes.sort_unstable();
        if codes != [1, 2, 3, 4, 5, 6] {
            return Err(Error::field(
                "motor.hall_codes",
                format!("{:?}", motor.hall_codes),
                "expected six different codes without two opposite ones",
            ));
        }
        inverter.bus_sense()?;
        Ok(())
    }

    fn check_controller(&self) -> Result<(), Error> {
        if let Some(CommutationEnd { threshold, .. }) = self.commutation_end()
            && !(threshold.is_finite() && threshold >= 0.0)
        {
            return Err(Error::field(
                "controller.commutation_threshold",
                threshold,
                "expected 0 or more",
            ));
        }
        if let Controller::Phcc(phcc) = &self.controller {
            if !(phcc.band.is_finite() && phcc.band >= 0.0) {
                return Err(Error::field(
                    "controller.band",
                    phcc.band,
                    "expected 0 or more",
                ));
            }
            let is_known = match phcc.table {
                SwitchingTable::Derived => phcc.candidates != Candidates::All,
                SwitchingTable::Printed | SwitchingTable::Given(_) => {
                    phcc.candidates == Candidates::Table2
                }
            };
            if !is_known {
                return Err(Error::field(
                    "controller.candidates",
                    format!("{:?}", phcc.candidates),
                    "expected table2, or three_phase with table = derived",
                ));
            }
        }
        if let Controller::PPwm(p_pwm) = &self.controller
            && !(p_pwm.bandwidth.is_finite() && p_pwm.bandwidth > 0.0)
        {
            return Err(Error::field(
                "controller.bandwidth",
                p_pwm.bandwidth,
                "expected a finite number above 0",
            ));
        }
        if let Controller::PiPwm(pi_pwm) = &self.controller {
            for (field, value) in [
                ("controller.bandwidth", pi_pwm.bandwidth),
                ("controller.integral_time", pi_pwm.integral_time),
            ] {
                if !(value.is_finite() && value > 0.0) {
                    return Err(Error::field(
                        field,
                        value,
                        "expected a finite number above 0",
                    ));
                }
            }
            if pi_pwm.six_step == Switch::On
                && (pi_pwm.feed_forward == Switch::On || pi_pwm.reference != Reference::QuasiSquare)
            {
                return Err(Error::field(
                    "controller.six_step",
                    "on",
                    "expected feed_forward = off and reference = quasi_square beside it",
                ));
            }
            if pi_pwm.saturation == Saturation::TorquePriority && pi_pwm.feed_forward == Switch::Off
            {
                return Err(Error::field(
                    "controller.saturation",
                    "torque_priority",
                    "torque priority needs feed_forward = on",
                ));
            }
        }
        Ok(())
    }
}

impl Inverter {
    /// Period of the PWM, second.
    pub fn pwm_period(&self) -> f64 {
        self.t_s / f64::from(self.pwm_per_control)
    }

    /// Largest compare value with which a leg is low for long enough on either side of the turning point.
    ///
    /// # Errors
    /// When the sensors are in the low legs but a time is missing.
    pub fn largest_compare(&self) -> Result<u32, Error> {
        let [before, behind] = self.low_times()?;
        Ok(self.counts_less(before.max(behind)))
    }

    /// Largest compare value of the highest leg, which of three sensors in the low legs need not be read at the
    /// end of the period.
    ///
    /// # Errors
    /// As [`Self::largest_compare`].
    pub fn highest_compare(&self) -> Result<u32, Error> {
        let [before, behind] = self.low_times()?;
        let is_spared = self.sensed_phases == SensedPhases::Abc;
        Ok(self.counts_less(if is_spared {
            behind
        } else {
            before.max(behind)
        }))
    }

    /// Largest compare value of a leg that is read at the end of its period.
    ///
    /// # Errors
    /// As [`Self::largest_compare`].
    pub fn read_compare(&self) -> Result<u32, Error> {
        Ok(self.counts_less(self.low_times()?[0]))
    }

    /// How long a leg is low before the turning point and behind it, for its sensor.
    fn low_times(&self) -> Result<[f64; 2], Error> {
        if self.current_sensing != CurrentSensing::LowSide {
            return Ok([0.0; 2]);
        }
        self.check_sensors()?;
        let time = |time: Option<f64>| time.unwrap_or_default();
        let lead = time(self.sampling_lead);
        let phases = self.sensed_phases.phases().len() as u32;
        let further = f64::from(phases.div_ceil(self.current_adcs) - 1);
        let behind = time(self.aperture_time) + further * time(self.conversion_time) - lead;
        Ok([self.dead_time + time(self.settling_time) + lead, behind])
    }

    fn counts_less(&self, low: f64) -> u32 {
        let low = low.max(self.minimum_low_time / 2.0);
        let half = self.pwm_period() / 2.0;
        let counts = (low / half * f64::from(self.timer_period) - 1e-6).ceil();
        self.timer_period.saturating_sub(counts.max(0.0) as u32)
    }

    fn check_sensors(&self) -> Result<(), Error> {
        let sensors = self.sensed_phases.phases().len();
        if !(self.adc_gain.has(sensors) && self.adc_offset.has(sensors)) {
            return Err(Error::field(
                "inverter.adc_gain",
                format!("{:?}, {:?}", self.adc_gain, self.adc_offset),
                "expected one value for all sensors or one of each",
            ));
        }
        if self.current_adcs == 0 {
            return Err(Error::field(
                "inverter.current_adcs",
                0,
                "expected 1 or more",
            ));
        }
        if self.pwm_per_control == 0 {
            return Err(Error::field(
                "inverter.pwm_per_control",
                0,
                "expected 1 or more",
            ));
        }
        if self.current_sensing == CurrentSensing::LowSide {
            for (field, time) in [
                ("inverter.settling_time", self.settling_time),
                ("inverter.aperture_time", self.aperture_time),
                ("inverter.conversion_time", self.conversion_time),
                ("inverter.sampling_lead", self.sampling_lead),
            ] {
                if time.is_none() {
                    return Err(Error::Missing {
                        field,
                        reason: "the current sensors are in the low legs",
                    });
                }
            }
        }
        Ok(())
    }

    /// The bus voltage's measurement, if there is one.
    ///
    /// # Errors
    /// If the bus is measured but a field of the measurement is missing.
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
