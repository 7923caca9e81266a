//! The checked specification: plain SI numbers, every default filled in, every basis resolved.
//!
//! Later stages read only these types; how a value was written, in which unit and where, ends at
//! the checks. Resistances, inductances and EMF constants are per phase of the equivalent star.

use crate::spec::{
    AngleSensor, ControllerSpec, CurrentSensing, CurrentSensor, CurrentSum, EmfSource, Harmonics,
    RATIO_BITS, SensedPhases,
};
use std::f64::consts::{FRAC_PI_3, TAU};

/// One drive: name, motor, inverter and controller.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// Name of the emitted type, `UpperCamelCase`.
    pub name: String,
    /// The motor.
    pub motor: MotorSpec,
    /// The inverter, its timer and its sensors.
    pub inverter: InverterSpec,
    /// The controller and its options.
    pub controller: ControllerSpec,
}

impl Spec {
    /// k_t: torque in Nm per ampere of set-point, from the EMF's and the current reference's
    /// shapes ([`EmfShape::quasi_square_factor`], [`EmfShape::proportional_factor`]).
    pub fn torque_constant(&self) -> f64 {
        let reference = self.controller.common().reference;
        self.motor.emf_constant * self.motor.emf_shape.torque_factor(reference)
    }

    /// Greatest age of a valid Hall edge, ticks: the widest sector at the minimum speed, at least 8.
    pub fn age_max(&self) -> u32 {
        let omega_e = self.inverter.minimum_speed * f64::from(self.motor.pole_pairs);
        (self.ticks_per_second() * FRAC_PI_3 * self.motor.widest_sector() / omega_e)
            .floor()
            .max(8.0) as u32
    }

    /// Ticks of an electrical turn at the greatest speed, at least 12.
    pub fn rev_min(&self) -> u32 {
        let omega_e = self.inverter.maximum_speed * f64::from(self.motor.pole_pairs);
        (self.ticks_per_second() * TAU / omega_e).floor().max(12.0) as u32
    }

    /// Ticks of an electrical turn at the speed above which the drive trips: a turn of fewer is too short.
    pub fn over_speed_turn(&self) -> Option<u32> {
        let omega_e = self.inverter.over_speed? * f64::from(self.motor.pole_pairs);
        // Decimal units may round a whole number.
        Some((self.ticks_per_second() * TAU / omega_e - 1e-6).ceil() as u32)
    }

    /// Control periods of a sector at the speed up to which the short-circuited motor takes no more
    /// than the largest current. 0 if it never takes more.
    pub fn brake_periods(&self) -> u32 {
        self.shorted_sector(self.inverter.max_current)
            .map_or(0, |sector| {
                let sector = sector * self.motor.widest_sector();
                (sector / self.inverter.t_s).ceil() as u32
            })
    }

    /// Control periods that a start waits at most for the rotor's angle: two sectors at
    /// [`waiting_speed`](Self::waiting_speed); 0 for none.
    pub fn start_periods(&self) -> u16 {
        self.waiting_speed().map_or(0, |speed| {
            let sector = FRAC_PI_3 / (speed * f64::from(self.motor.pole_pairs));
            let sector = sector * self.motor.widest_sector();
            // A hair less, for the rounding of the way to the speed and back.
            let periods = 2.0 * (sector / self.inverter.t_s - 1e-9).ceil();
            periods.min(f64::from(u16::MAX)) as u16
        })
    }

    /// Speed above which control waits for the rotor's angle, mechanical rad/s: that at which the
    /// short-circuited motor takes half the largest current. Control without an angle, and so
    /// without the EMF, adds no more than that to its set-point. `None` where the law does not model
    /// the EMF, which then the angle does not give, or where no speed of the drive takes as much.
    pub fn waiting_speed(&self) -> Option<f64> {
        let is_modelled = matches!(
            self.controller.common().emf,
            EmfSource::Model | EmfSource::Observer
        );
        let sector = self.shorted_sector(self.inverter.max_current / 2.0)?;
        let speed = FRAC_PI_3 / sector / f64::from(self.motor.pole_pairs);
        (is_modelled && speed < self.inverter.maximum_speed).then_some(speed)
    }

    /// Seconds of a sector at the speed at which the short-circuited motor takes this current, e/|Z|
    /// with the fundamental of the EMF; `None` if it never does.
    fn shorted_sector(&self, current: f64) -> Option<f64> {
        let MotorSpec {
            resistance,
            inductance,
            emf_constant,
            emf_shape,
            pole_pairs,
            ..
        } = self.motor;
        let pairs = f64::from(pole_pairs);
        let constant = emf_constant * emf_shape.fundamental();
        let beyond = constant.powi(2) - (current * pairs * inductance).powi(2);
        (beyond > 0.0).then(|| {
            let omega_e = pairs * current * resistance / beyond.sqrt();
            FRAC_PI_3 / omega_e
        })
    }

    /// Sector 1 to 6 by Hall code of which no sensor is inverted; 0 for invalid codes.
    pub fn hall_sectors(&self) -> [u8; 8] {
        let mut sectors = [0; 8];
        for (sector, code) in (1..).zip(self.motor.upright_codes()) {
            sectors[usize::from(code & 7)] = sector;
        }
        sectors
    }

    fn ticks_per_second(&self) -> f64 {
        self.inverter.rotor_sensing.ticks_per_period() / self.inverter.t_s
    }
}

/// Shape of the phase EMF over the electrical angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EmfShape {
    /// Linear ramps and a flat top of the given width in electrical degrees (above 0, below 180).
    Trapezoidal {
        /// Width of the flat top, electrical degrees.
        flat_top_deg: f64,
    },
    /// A sine wave.
    Sinusoidal,
    /// A Fourier series. An estimate of such an EMF is turned as a sine.
    Harmonics(Harmonics),
}

/// Motor data, star equivalent, SI.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorSpec {
    /// Free text for documentation, one line.
    pub description: String,
    /// Pole pairs, 1 to 64.
    pub pole_pairs: u32,
    /// Phase resistance, ohm.
    pub resistance: f64,
    /// Phase inductance (inclusive of mutual coupling), henry.
    pub inductance: f64,
    /// Peak phase EMF over mechanical speed, V s/rad.
    pub emf_constant: f64,
    /// Shape of the EMF.
    pub emf_shape: EmfShape,
    /// Rated current, ampere: peak of a quasi-square wave with a trapezoidal EMF, else of a sine.
    pub rated_current: f64,
    /// Rated torque as given, Nm.
    pub rated_torque: Option<f64>,
    /// Rated speed, mechanical rad/s.
    pub rated_speed: f64,
    /// Rotor inertia, kg m2, where known.
    pub inertia: Option<f64>,
    /// Relative tolerance of the inductance, e.g. 0.1.
    pub inductance_tolerance: f64,
    /// Relative tolerance of the resistance, e.g. 0.3.
    pub resistance_tolerance: f64,
    /// Hall codes of sectors S1 to S6 (Ha in bit 2).
    pub hall_codes: [u8; 6],
    /// Electrical angles at which sectors S1 to S6 begin in forward rotation, degrees: those of
    /// [`HALL_ANGLES`], each at most 20 degrees off.
    pub hall_angles: [f64; 6],
}

/// Width of the narrowest and of the widest sector between Hall edges at these angles, over 60 degrees.
pub(crate) fn extreme_sectors(hall_angles: &[f64; 6]) -> [f64; 2] {
    let widths = (0..6).map(|k| {
        let next = hall_angles[(k + 1) % 6];
        (next - hall_angles[k]).rem_euclid(360.0) / 60.0
    });
    widths.fold([1.0, 1.0], |[narrowest, widest], width| {
        [f64::min(narrowest, width), f64::max(widest, width)]
    })
}

/// `hall_angles` of sensors in their places.
pub const HALL_ANGLES: [f64; 6] = [-30.0, 30.0, 90.0, 150.0, 210.0, 270.0];

impl MotorSpec {
    /// Turn of the rotor at rated speed in `t_s` seconds, electrical degrees.
    pub fn rated_turn(&self, t_s: f64) -> f64 {
        (self.rated_speed * f64::from(self.pole_pairs) * t_s).to_degrees()
    }

    /// Electrical turns in a second at rated speed, hertz.
    pub fn rated_frequency(&self) -> f64 {
        self.rated_speed * f64::from(self.pole_pairs) / TAU
    }

    /// Torque per ampere of the rated current, Nm/A.
    pub fn rated_torque_constant(&self) -> f64 {
        self.emf_constant * self.emf_shape.rated_factor()
    }

    /// Rated torque, Nm: as given, else that of the rated current.
    pub fn torque_rating(&self) -> f64 {
        self.rated_torque
            .unwrap_or(self.rated_current * self.rated_torque_constant())
    }

    /// Speed without load on a bus of `volts`, in block commutation, mechanical rad/s.
    pub fn no_load_speed(&self, volts: f64) -> f64 {
        volts / (self.emf_constant * self.emf_shape.quasi_square_factor())
    }

    /// Whether all Hall sensors are in their places.
    pub fn has_even_halls(&self) -> bool {
        self.hall_angles == HALL_ANGLES
    }

    /// Width of the widest sector over 60 degrees.
    pub fn widest_sector(&self) -> f64 {
        let [_, widest] = extreme_sectors(&self.hall_angles);
        widest
    }

    /// Hall sensors that the drive inverts first, as bits of the code: one of sensors that stand 60
    /// degrees apart, so that their codes become those of sensors 120 degrees apart, 001 to 110.
    pub fn hall_inverted(&self) -> u8 {
        // The two codes that are missing differ in all three sensors.
        let missing = (0..8).filter(|code| !self.hall_codes.contains(code));
        missing
            .min_by_key(|code: &u8| code.count_ones())
            .unwrap_or(0)
    }

    /// The Hall codes of sectors S1 to S6 with these sensors inverted.
    pub fn upright_codes(&self) -> [u8; 6] {
        let inverted = self.hall_inverted();
        self.hall_codes.map(|code| code ^ inverted)
    }
}

/// Where the bus voltage comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BusSource {
    /// The nominal value holds.
    Fixed,
    /// Measured, passed by `set_bus(counts)`.
    Measured {
        /// Volt per ADC count.
        gain: f64,
        /// ADC bits.
        adc_bits: u32,
        /// Lower limit, volt.
        min: f64,
        /// Upper limit, volt.
        max: f64,
        /// Voltage below which the drive trips, volt; 0 for none.
        under: f64,
        /// Voltage above which the drive trips, volt; 0 for none.
        over: f64,
        /// Fade of braking torque towards the greatest voltage.
        braking: Option<Fade>,
        /// Fade of motoring torque towards the least voltage.
        motoring: Option<Fade>,
    },
}

impl BusSource {
    /// Whether the bus may have a nominal voltage of so many volt.
    pub fn takes(self, nominal: f64) -> bool {
        match self {
            Self::Fixed => true,
            Self::Measured { max, .. } => nominal < max,
        }
    }
}

/// Limits of the bus current, ampere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BusCurrents {
    /// Greatest current drawn from the supply.
    pub drawn: Option<f64>,
    /// Greatest current returned to it.
    pub returned: Option<f64>,
}

impl BusCurrents {
    /// Whether one of the currents has a limit.
    pub fn are_limited(self) -> bool {
        self != Self::default()
    }
}

/// Bus voltages between which the largest set-point falls in proportion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fade {
    /// At which, and on its other side, it is whole, volt.
    pub full: f64,
    /// At which, and beyond, it is 0, volt.
    pub none: f64,
}

impl Fade {
    /// The share of a fade's width, next to the voltage that trips, in which there is no torque: what
    /// ripple and a slow measurement still put into the bus must not end in a trip.
    const SPARE: f64 = 0.25;

    /// The fade of a width towards a level, both volt.
    pub fn towards(level: f64, width: f64, is_upper: bool) -> Self {
        let way = if is_upper { -1.0 } else { 1.0 };
        Self {
            full: level + way * width,
            none: level + way * Self::SPARE * width,
        }
    }
}

/// How the rotor's position reaches the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RotorSensing {
    /// Hall edges are detected at the sampling instants.
    SampledHalls,
    /// A timer counts ticks since the last Hall edge.
    TimedHalls {
        /// Timer ticks per control period, 2 to 65535, whole or not.
        ticks: f64,
    },
    /// Every sample has an angle.
    Angle(AngleSensor),
}

impl RotorSensing {
    /// Ticks of the clock of the speed per control period: of the time since a Hall edge, half periods where edges
    /// are sampled; periods with an angle.
    pub fn ticks_per_period(self) -> f64 {
        match self {
            Self::SampledHalls => 2.0,
            Self::TimedHalls { ticks } => ticks,
            Self::Angle(_) => 1.0,
        }
    }
}

/// Inverter, timer and sensors, SI.
#[derive(Clone, Debug, PartialEq)]
pub struct InverterSpec {
    /// Nominal bus voltage, volt.
    pub v_bus: f64,
    /// Fixed or measured.
    pub bus: BusSource,
    /// Control period, second; of whole timer counts where the timer's clock is given.
    pub t_s: f64,
    /// PWM periods in a control period, 1 to 16.
    pub pwm_per_control: u32,
    /// Counts of the centre-aligned timer from 0 to its top: a compare value of this many counts
    /// is 100 % duty.
    pub timer_period: u32,
    /// Dead time per edge, second.
    pub dead_time: f64,
    /// Bits of the phase-current ADC, 8 to 16.
    pub adc_bits: u32,
    /// Ampere per count of the first sensor, the base of words of current; negative for inverting
    /// amplifiers.
    pub adc_gain: f64,
    /// Count of the first sensor at zero current.
    pub adc_offset: u32,
    /// The second sensor, and with three the third.
    pub other_sensors: Vec<CurrentSensor>,
    /// Greatest current of either sign that the amplifiers show, ampere; none where the converter's range is less.
    pub amplifier_reach: Option<f64>,
    /// The phases with a sensor.
    pub sensed_phases: SensedPhases,
    /// Where the sensors are.
    pub current_sensing: CurrentSensing,
    /// Three currents that do not add up are a fault; with three sensors only.
    pub current_sum: Option<CurrentSum>,
    /// Time for which each leg that switches is low in every PWM period, second.
    pub minimum_low_time: f64,
    /// Greatest deviation of a calibrated offset from `adc_offset`, counts.
    pub offset_tolerance: u32,
    /// Current that trips the drive, ampere: a whole number of ADC counts.
    pub trip_current: f64,
    /// Largest set-point, ampere.
    pub max_current: f64,
    /// Voltage at which the board holds its bus while the motor drives current into it, volt.
    pub bus_clamp: Option<f64>,
    /// Limits of the bus current.
    pub bus_currents: BusCurrents,
    /// What tells the rotor's position.
    pub rotor_sensing: RotorSensing,
    /// Mechanical speed below which the angle is the sector's centre, rad/s.
    pub minimum_speed: f64,
    /// Greatest mechanical speed, rad/s.
    pub maximum_speed: f64,
    /// Mechanical speed above which the drive trips, rad/s; none: it is not watched.
    pub over_speed: Option<f64>,
    /// Periods without a Hall edge, under current demand, that count as a stall; 0 switches it off.
    pub stall_periods: u32,
    /// Samples in a row with a disturbed Hall code that are bridged; 0 for none.
    pub hall_glitches: u32,
    /// Base-2 logarithm of the samples averaged by offset calibration (0 to 12).
    pub calibration_log2: u32,
    /// Periods of bootstrap pre-charge, 0 to 65535.
    pub precharge_periods: u32,
}

/// Time after which a measured bus voltage is stale, second: many cycles of a main program of some
/// hundred hertz, and short enough to notice a sagging supply.
pub const BUS_FRESH: f64 = 0.1;

/// Whole periods that cover a time; decimal units may round a whole number.
pub(super) fn periods(time: f64, t_s: f64) -> u32 {
    (time / t_s - 1e-6).ceil().max(0.0) as u32
}

impl InverterSpec {
    /// Lowest bus voltage of the controller, volt.
    pub fn lowest_bus(&self) -> f64 {
        match self.bus {
            BusSource::Fixed => self.v_bus,
            BusSource::Measured { min, .. } => min,
        }
    }

    /// Lowest bus voltage at which the drive neither trips nor fades its torque, volt.
    pub fn lowest_driving_bus(&self) -> f64 {
        match self.bus {
            BusSource::Fixed => self.v_bus,
            BusSource::Measured {
                gain,
                min,
                motoring,
                ..
            } => {
                let [least, _] = self.bus_counts();
                let fades = motoring.map_or(0.0, |fade| fade.full);
                min.max(gain * f64::from(least)).max(fades)
            }
        }
    }

    /// The longest period of whole timer counts within `limit`, second.
    pub fn period_within(&self, limit: f64) -> f64 {
        period_within(limit, self.t_s, self.timer_period)
    }

    /// Greatest bus voltage of the controller, volt.
    pub fn greatest_bus(&self) -> f64 {
        match self.bus {
            BusSource::Fixed => self.v_bus,
            BusSource::Measured { max, .. } => max,
        }
    }

    /// Least and greatest count of the bus ADC without a fault: those nearest to the levels, so that a bus at a level
    /// does not trip by the rounding of an ADC. The greatest count of all is a fault, as the voltage may be any above it.
    pub fn bus_counts(&self) -> [u16; 2] {
        let BusSource::Measured {
            gain,
            adc_bits,
            under,
            over,
            ..
        } = self.bus
        else {
            return [0, u16::MAX];
        };
        let full = f64::from((1_u32 << adc_bits) - 1);
        let least = (under / gain).round();
        let most = (over / gain).round().min(full - 1.0);
        [
            least as u16,
            if over > 0.0 { most as u16 } else { u16::MAX },
        ]
    }

    /// Largest count of the phase-current ADC.
    pub fn adc_max(&self) -> u32 {
        (1 << self.adc_bits) - 1
    }

    /// Least and greatest offset of a sensor that calibration accepts, counts.
    pub fn offsets(&self, sensor: CurrentSensor) -> [u32; 2] {
        let tolerance = self.offset_tolerance;
        [
            sensor.offset.saturating_sub(tolerance),
            (sensor.offset + tolerance).min(self.adc_max()),
        ]
    }

    /// Least and greatest current of any count at any accepted offset of any sensor, counts of the first
    /// with so many fraction bits.
    pub fn current_range(&self, fraction_bits: u32) -> [i64; 2] {
        let top = i64::from(self.adc_max());
        let ranges = self.sensors().into_iter().map(|sensor| {
            let [least, most] = self.offsets(sensor).map(i64::from);
            let range = if sensor.gain < 0.0 {
                [least - top, most]
            } else {
                [-most, top - least]
            };
            let ratio = i64::from(self.ratio(sensor));
            let half = 1 << (RATIO_BITS - 1);
            range.map(|current| ((current << fraction_bits) * ratio + half) >> RATIO_BITS)
        });
        ranges.fold([0; 2], |[low, high], [least, most]| {
            [low.min(least), high.max(most)]
        })
    }

    /// [`BUS_FRESH`] in periods, where the bus is measured.
    pub fn bus_periods(&self) -> Option<u32> {
        let is_measured = matches!(self.bus, BusSource::Measured { .. });
        is_measured.then(|| periods(BUS_FRESH, self.t_s))
    }
}

/// The longest period of whole counts within `limit`, of a timer that counts to `timer_period` in
/// `t_s`.
pub(super) fn period_within(limit: f64, t_s: f64, timer_period: u32) -> f64 {
    let count = t_s / f64::from(timer_period);
    (limit / count * (1.0 + 1e-9)).floor() * count
}
