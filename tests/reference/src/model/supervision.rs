//! Modes, faults and the start-up sequence (section 3 of the semantics), and the age of the bus
//! voltage (its section "Set-point words"). Nothing here is rounded: currents and trip level are
//! compared in the model's unit.

use crate::AnyCommand;
use crate::Error;
use crate::exact::{Word, greater, lesser, pow2, within, word};
use crate::model::sector::hall_sectors;
use crate::spec::{Bus, CurrentSensing, Inverter, SensedPhases, Spec};
use hexagen::{Command, Fault};

/// Being off on purpose, or its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// All legs off.
    Coast,
    /// Slowing the rotor down.
    Brake,
    /// The end of both.
    Resume,
}

/// Operating mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Controlling the currents.
    #[default]
    Run = 0,
    /// Averaging the ADC offsets, all legs off.
    Calibrate = 1,
    /// Charging the bootstrap capacitors, all legs low.
    Precharge = 2,
    /// Latched after a fault, all legs off.
    Tripped = 3,
    /// All legs off on purpose.
    Coast = 4,
    /// Slowing the rotor down.
    Brake = 5,
    /// Waiting for the rotor's angle, all legs off.
    Start = 6,
}

impl Mode {
    /// The mode of a state word.
    pub fn from_word(word: i32) -> Self {
        match word {
            0 => Self::Run,
            1 => Self::Calibrate,
            2 => Self::Precharge,
            4 => Self::Coast,
            5 => Self::Brake,
            6 => Self::Start,
            _ => Self::Tripped,
        }
    }
}

/// The fault of a state word; 0 is none.
pub fn fault_from_word(word: i32) -> Option<Fault> {
    Some(match word {
        1 => Fault::AdcRange,
        2 => Fault::OverCurrent,
        3 => Fault::Hall,
        4 => Fault::Stall,
        5 => Fault::Offset,
        6 => Fault::OverVoltage,
        7 => Fault::UnderVoltage,
        8 => Fault::Residual,
        9 => Fault::CurrentSum,
        10 => Fault::OverSpeed,
        _ => return None,
    })
}

/// The state word of a fault.
#[inline]
pub fn fault_to_word(fault: Option<Fault>) -> i32 {
    match fault {
        None => 0,
        Some(Fault::AdcRange) => 1,
        Some(Fault::OverCurrent) => 2,
        Some(Fault::Hall) => 3,
        Some(Fault::Stall) => 4,
        Some(Fault::Offset) => 5,
        Some(Fault::OverVoltage) => 6,
        Some(Fault::UnderVoltage) => 7,
        Some(Fault::Residual) => 8,
        Some(Fault::CurrentSum) => 9,
        Some(Fault::OverSpeed) => 10,
        Some(other) => unreachable!("unknown fault: {other:?}"),
    }
}

/// Limits of the supervision, currents in the model's unit.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub adc_max: f64,
    /// The phases with a sensor.
    pub sensed: SensedPhases,
    /// 1, or -1 where the counts of a sensor fall with the current.
    pub polarity: [f64; 3],
    /// Gain of each sensor over that of the first.
    pub ratio: [f64; 3],
    /// Count of each sensor at zero current, and its tolerance in calibration; 0 of a third that is not there.
    pub adc_offset: [f64; 3],
    /// With three sensors.
    pub third: Option<Third>,
    pub offset_tolerance: f64,
    /// Least and greatest current of any sensor at any of its offsets, in the model's unit.
    pub currents: [f64; 2],
    pub i_trip: f64,
    pub calibration_samples: f64,
    pub precharge_periods: f64,
    pub stall_periods: f64,
    /// Samples in a row with a disturbed Hall code that are bridged.
    pub hall_glitches: f64,
    /// Hall sensors that are turned round, as bits of the code.
    pub hall_inverted: u8,
    /// Periods of a sector up to whose speed a short circuit brakes.
    pub brake_periods: f64,
    /// Periods that a start waits at most for the rotor's angle.
    pub start_periods: f64,
    /// Sector by Hall code.
    pub sectors: [usize; 8],
}

/// What is made of three current sensors; the current in the model's unit.
#[derive(Clone, Copy, Debug)]
pub struct Third {
    /// In the low legs: largest compare value of a leg that is read at the end of its period.
    pub readable: Option<u32>,
    /// Whether a command takes effect one period after its sample.
    pub is_delayed: bool,
    /// Largest sum of the currents without a fault.
    pub sum_tolerance: f64,
    /// Samples in a row with a larger one that are a fault; 0: none are.
    pub sum_samples: f64,
}

/// Units of the supervision's currents.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    /// The trip level.
    pub i_trip: f64,
    /// Current of a count of the first sensor.
    pub count: f64,
    /// Current of an ampere.
    pub ampere: f64,
    /// Fraction bits of the ratio of two gains; currents are whole numbers then.
    pub ratio_bits: Option<i32>,
}

impl Units {
    /// A ratio as the model has it.
    fn ratio(&self, ratio: f64) -> f64 {
        self.ratio_bits
            .map_or(ratio, |bits| (ratio * pow2(bits)).round() / pow2(bits))
    }

    fn rounded(&self, current: f64) -> f64 {
        self.ratio_bits.map_or(current, |_| (current + 0.5).floor())
    }
}

impl Limits {
    /// The limits of a specification.
    pub fn new(spec: &Spec, units: Units) -> Result<Self, Error> {
        let inverter = &spec.inverter;
        let sensors = inverter.sensed_phases.phases().len();
        let adc_max = f64::from((1u32 << inverter.adc_bits) - 1);
        let each = |of: &dyn Fn(usize) -> f64, none: f64| {
            [0, 1, 2].map(|sensor| if sensor < sensors { of(sensor) } else { none })
        };
        let first_gain = inverter.adc_gain.first().abs();
        let polarity = each(&|sensor| inverter.adc_gain.of(sensor).signum(), 1.0);
        let ratio = each(
            &|sensor| units.ratio(inverter.adc_gain.of(sensor).abs() / first_gain),
            1.0,
        );
        let adc_offset = each(&|sensor| f64::from(inverter.adc_offset.of(sensor)), 0.0);
        let tolerance = f64::from(inverter.offset_tolerance);
        let mut currents = [0.0_f64; 2];
        for sensor in 0..sensors {
            let far = (adc_offset[sensor] + tolerance).min(adc_max);
            let near = (adc_offset[sensor] - tolerance).max(0.0);
            for end in [-far, adc_max - near] {
                let current = end * units.count * polarity[sensor] * ratio[sensor];
                let current = units.rounded(current);
                currents = [currents[0].min(current), currents[1].max(current)];
            }
        }
        let is_low_side = inverter.current_sensing == CurrentSensing::LowSide;
        let readable = inverter.read_compare()?;
        let third = (sensors == 3).then(|| Third {
            readable: is_low_side.then_some(readable),
            is_delayed: spec.loop_options().delay == 1,
            sum_tolerance: units
                .rounded(inverter.current_sum_tolerance.unwrap_or_default() * units.ampere),
            sum_samples: f64::from(inverter.current_sum_samples),
        });
        let samples = 1u32
            .checked_shl(inverter.calibration_log2)
            .ok_or(Error::Field {
                field: "inverter.calibration_log2",
                value: inverter.calibration_log2.to_string(),
                expected: "expected less than 32",
            })?;
        Ok(Self {
            adc_max,
            sensed: inverter.sensed_phases,
            polarity,
            ratio,
            adc_offset,
            third,
            offset_tolerance: tolerance,
            currents,
            i_trip: units.i_trip,
            calibration_samples: f64::from(samples),
            precharge_periods: f64::from(inverter.precharge_periods),
            stall_periods: f64::from(inverter.stall_periods),
            hall_glitches: f64::from(inverter.hall_glitches),
            hall_inverted: spec.motor.hall_inverted(),
            brake_periods: f64::from(inverter.brake_periods),
            start_periods: f64::from(inverter.start_periods),
            sectors: hall_sectors(&spec.motor),
        })
    }
}

/// Time after which a measured bus voltage is stale, second.
const BUS_FRESH: f64 = 0.1;

/// The age of a measured bus voltage, and its limits.
#[derive(Clone, Copy, Debug)]
pub struct BusWatch {
    /// Periods after which it is stale.
    limit: u32,
    /// Periods since the last call, up to the limit, which is also the initial value.
    age: u32,
    /// A call took effect since the last period.
    told: bool,
    /// Counts without a fault.
    counts: [u16; 2],
    /// What is wrong with the voltage of that call.
    fault: Option<Fault>,
}

impl BusWatch {
    /// `None` if the bus is fixed.
    pub fn new(inverter: &Inverter) -> Option<Self> {
        (inverter.bus == Bus::Measured).then(|| {
            let limit = (BUS_FRESH / inverter.t_s - 1e-6).ceil() as u32;
            Self {
                limit,
                age: limit,
                told: false,
                counts: inverter.bus_counts,
                fault: None,
            }
        })
    }

    /// `set_bus` took effect.
    pub fn tell(&mut self, counts: u16) {
        let [least, most] = self.counts;
        self.told = true;
        self.fault = if counts < least {
            Some(Fault::UnderVoltage)
        } else {
            (counts > most).then_some(Fault::OverVoltage)
        };
    }

    /// A period begins: the fault of a call since the last one.
    #[inline]
    pub fn age(&mut self) -> Option<Fault> {
        self.age = if self.told {
            0
        } else {
            (self.age + 1).min(self.limit)
        };
        self.told = false;
        self.fault.take()
    }

    /// Whether the voltage is stale, as of the last period.
    pub fn is_stale(&self) -> bool {
        self.age == self.limit
    }
}

impl Limits {
    /// Currents of all phases, of what the sensors show; that of the leg that is not read is the rest of the other
    /// two.
    pub fn phases<W: Word>(&self, shown: [W; 3], unread: Option<usize>) -> [W; 3] {
        let [first, second, third] = shown;
        let [first, second] = match unread {
            Some(0) => [-(second + third), second],
            Some(1) => [first, -(first + third)],
            _ => [first, second],
        };
        self.sensed.of_phases([first, second], -(first + second))
    }

    /// The currents of phases a and b for the law: limited to what a sensor shows, which the rest of two others may
    /// exceed at rest.
    pub fn for_law<W: Word>(&self, [i_a, i_b, _]: [W; 3]) -> [W; 2] {
        let [least, most] = self.currents;
        [i_a, i_b].map(|i| within(i, least, most))
    }
}

/// The supervisor's inputs of one period.
#[derive(Clone, Copy, Debug)]
pub struct Observation<W> {
    /// What no sample shows: of the bus, or found by the law in an earlier period.
    pub known: Option<Fault>,
    /// ADC counts of the first two sensors and the third phase, as read.
    pub adc: [W; 3],
    /// Phase currents.
    pub i: [W; 3],
    /// Sum of what three sensors show.
    pub sum: W,
    /// Hall code of the sample.
    pub hall: HallSample,
    /// The set-point is not zero.
    pub demand: bool,
}

/// Kind of a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Period {
    /// The currents are controlled.
    Control,
    /// All legs low.
    Low,
    /// All legs off.
    Off,
}

/// The supervisor's result for a sample.
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    pub period: Period,
    /// Control with the largest torque against this direction, or none: the drive brakes a fast rotor.
    pub against: Option<f64>,
    /// The calibration is complete: the offsets are the sums' means from the next period on.
    pub calibrated: bool,
}

/// State of the supervision.
#[derive(Clone, Copy, Debug, Default)]
pub struct Supervisor<W = f64> {
    pub mode: Mode,
    pub fault: Option<Fault>,
    pub countdown: W,
    pub sum: [W; 3],
    /// Samples in a row whose currents do not add up.
    pub sum_count: W,
    pub unread: Unread,
    /// Periods without an edge under demand; 0 without stall detection.
    pub stall_count: W,
    /// The last sound Hall code, with stall detection or bridging; 0 before the first.
    pub hall_prev: HallCode,
    /// Samples since then, bridged, and all that were.
    pub hall_gap: W,
    pub hall_glitches: W,
    /// Rotation since control ended or the drive was made.
    pub turn: Turn<W>,
}

/// The legs that the sensors in three low legs do not show at the end of a period: of the period that ends at the next
/// sample, and with a delay of the one after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unread(pub [Option<usize>; 2]);

impl Default for Unread {
    /// All legs are off.
    fn default() -> Self {
        Self([Some(0); 2])
    }
}

/// Rotation of the rotor by the Hall edges since control ended or the drive was made.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turn<W> {
    /// Hall code of the last period; 0 before the first.
    pub hall: HallCode,
    /// Periods since the last edge that is not one back over the edge before it.
    pub age: W,
    /// Periods between two edges, the last the second in a row in its direction; 0 if the last edge is not.
    pub interval: W,
    /// Of the last edge, 1 forward, -1 backward; 0 before the first and behind one that skips sectors.
    pub direction: W,
}

impl<W: Word> Turn<W> {
    fn unknown() -> Self {
        Self {
            hall: HallCode::default(),
            age: word(0.0),
            interval: word(0.0),
            direction: word(0.0),
        }
    }

    /// Whether a sector lasts so long that a short circuit may brake.
    fn is_slow(&self, limits: &Limits) -> bool {
        greater(self.age, self.interval) >= limits.brake_periods
    }
}

/// The Hall code of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HallSample {
    /// The code of a sector that the rotor may be in.
    Sound(HallCode),
    /// Disturbed: the last code stands in for it.
    Bridged(HallCode),
    /// Disturbed, and a fault: a code of another sector, or none.
    Wrong(Option<HallCode>),
}

impl HallSample {
    /// The code that the law takes; 0 for none.
    pub fn code(self) -> u8 {
        match self {
            Self::Sound(code) | Self::Bridged(code) | Self::Wrong(Some(code)) => code.0,
            Self::Wrong(None) => 0,
        }
    }
}

/// Count of bridged samples at which counting ends.
const MOST_GLITCHES: f64 = 32_767.0;

/// A Hall code, or 0 for none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HallCode(pub u8);

impl HallCode {
    /// That of a sample: valid codes are 1 to 6.
    fn of(hall: u8) -> Option<Self> {
        (1..=6).contains(&hall).then_some(Self(hall))
    }
}

impl<W: Word> Supervisor<W> {
    /// Starts the calibration of the current offsets; ignored when tripped.
    pub fn calibrate(&mut self, limits: &Limits) {
        if self.mode != Mode::Tripped {
            self.mode = Mode::Calibrate;
            self.countdown = word(limits.calibration_samples);
            self.sum = [word(0.0); 3];
        }
    }

    /// Whether a reset takes effect: start-up is not interrupted.
    pub fn may_reset(&self) -> bool {
        !matches!(self.mode, Mode::Calibrate | Mode::Precharge)
    }

    /// The drive is made, reset, calibrated or charged: control follows, with the rotor's angle where it
    /// is waited for.
    pub fn start(&mut self, limits: &Limits) {
        self.countdown = word(limits.start_periods);
        self.turn = Turn::unknown();
        self.go_on();
    }

    /// What is left of a start, or control.
    fn go_on(&mut self) {
        self.mode = if self.countdown > 0.0 {
            Mode::Start
        } else {
            Mode::Run
        };
    }

    /// Starts coasting; ignored when tripped, calibrating and pre-charging.
    pub fn coast(&mut self) {
        self.stop(Mode::Coast);
    }

    /// Starts braking; ignored when tripped, calibrating and pre-charging.
    pub fn brake(&mut self) {
        self.stop(Mode::Brake);
    }

    fn stop(&mut self, mode: Mode) {
        match self.mode {
            Mode::Run => self.turn = Turn::unknown(),
            Mode::Start | Mode::Coast | Mode::Brake => {}
            Mode::Calibrate | Mode::Precharge | Mode::Tripped => return,
        }
        self.mode = mode;
    }

    /// Ends both; whether there was anything to end.
    pub fn resume(&mut self) -> bool {
        let is_off = matches!(self.mode, Mode::Coast | Mode::Brake);
        if is_off {
            self.go_on();
        }
        is_off
    }

    /// Starts the bootstrap pre-charge; ignored but in control, start and pre-charge.
    pub fn precharge(&mut self, limits: &Limits) {
        let may_start = matches!(self.mode, Mode::Run | Mode::Start | Mode::Precharge);
        if may_start && limits.precharge_periods > 0.0 {
            self.mode = Mode::Precharge;
            self.countdown = word(limits.precharge_periods);
        }
    }

    /// The sensor that does not show its phase's current in this sample.
    pub fn unread(&self, limits: &Limits) -> Option<usize> {
        match limits.third {
            None => Some(2),
            Some(Third { readable: None, .. }) => None,
            Some(_) => self.unread.0[0],
        }
    }

    /// Follows the legs of a period: one that is off, or high for too long, is not read at its end.
    pub fn follow_legs(&mut self, limits: &Limits, command: AnyCommand) {
        let Some(third) = limits.third else {
            return;
        };
        let Some(readable) = third.readable else {
            return;
        };
        let is_read = |on: Option<u16>| on.is_some_and(|on| u32::from(on) <= readable);
        let unread = command.on().into_iter().position(|on| !is_read(on));
        self.unread = Unread(if third.is_delayed {
            [self.unread.0[1], unread]
        } else {
            [unread, Some(0)]
        });
    }

    /// Counts samples in a row whose three currents do not add up; whether there are too many.
    fn count_sum(&mut self, limits: &Limits, sum: W) -> bool {
        let Some(third) = limits.third.filter(|third| third.sum_samples > 0.0) else {
            self.sum_count = word(0.0);
            return false;
        };
        if self.mode != Mode::Run {
            self.sum_count = word(0.0);
        } else if self.unread(limits).is_none() {
            self.sum_count = if sum.abs() > third.sum_tolerance {
                lesser(self.sum_count + 1.0, third.sum_samples)
            } else {
                word(0.0)
            };
        }
        self.sum_count == third.sum_samples
    }

    /// Takes the Hall code of a sample; once per period, before [`step`](Self::step).
    pub fn take_hall(&mut self, limits: &Limits, sampled: u8) -> HallSample {
        let code = HallCode::of(sampled ^ limits.hall_inverted);
        if limits.hall_glitches == 0.0 {
            return code.map_or(HallSample::Wrong(None), HallSample::Sound);
        }
        let is_first = self.hall_prev == HallCode::default();
        let sector = |code: HallCode| limits.sectors[usize::from(code.0)];
        let last = sector(self.hall_prev);
        // The same sector, or the one before or behind it, of six.
        let is_near = |code: &HallCode| matches!((sector(*code) + 6 - last) % 6, 0 | 1 | 5);
        if let Some(code) = code.filter(|code| is_first || is_near(code)) {
            self.hall_gap = word(0.0);
            if limits.stall_periods == 0.0 {
                self.hall_prev = code;
            }
            return HallSample::Sound(code);
        }
        if is_first || self.hall_gap >= limits.hall_glitches {
            return HallSample::Wrong(code);
        }
        self.hall_gap = self.hall_gap + 1.0;
        self.hall_glitches = lesser(self.hall_glitches + 1.0, MOST_GLITCHES);
        HallSample::Bridged(self.hall_prev)
    }

    /// One period.
    #[inline]
    pub fn step(&mut self, limits: &Limits, seen: &Observation<W>) -> Verdict {
        let is_wrong = matches!(seen.hall, HallSample::Wrong(_));
        if limits.stall_periods > 0.0 {
            let code = match seen.hall {
                HallSample::Sound(code) => code,
                HallSample::Bridged(_) | HallSample::Wrong(_) => self.hall_prev,
            };
            self.count_stall(limits, code, seen.demand);
        }
        let is_sum_off = self.count_sum(limits, seen.sum);
        let unread = self.unread(limits);
        let mut read = seen
            .adc
            .iter()
            .enumerate()
            .filter(|(x, _)| Some(*x) != unread);
        let i_max = greater(greater(seen.i[0].abs(), seen.i[1].abs()), seen.i[2].abs());
        let found = if let Some(known) = seen.known {
            Some(known)
        } else if read.any(|(_, adc)| *adc == 0.0 || *adc >= limits.adc_max) {
            Some(Fault::AdcRange)
        } else if is_wrong {
            Some(Fault::Hall)
        } else if i_max > limits.i_trip && self.mode != Mode::Calibrate {
            Some(Fault::OverCurrent)
        } else if is_sum_off {
            Some(Fault::CurrentSum)
        } else if limits.stall_periods > 0.0 && self.stall_count == limits.stall_periods {
            Some(Fault::Stall)
        } else {
            None
        };
        if self.mode == Mode::Run && found.is_none() {
            return Verdict {
                period: Period::Control,
                against: None,
                calibrated: false,
            };
        }
        let (mut period, mut against) = (Period::Off, None);
        let is_followed = matches!(self.mode, Mode::Start | Mode::Coast | Mode::Brake);
        if is_followed && found.is_none() {
            let is_known = self.follow(limits, HallCode(seen.hall.code()));
            self.countdown = if is_known {
                word(0.0)
            } else {
                greater(self.countdown - 1.0, 0.0)
            };
        }
        if self.mode == Mode::Precharge && found.is_none() {
            period = Period::Low;
        } else if self.mode == Mode::Brake && found.is_none() && self.countdown == 0.0 {
            if self.turn.is_slow(limits) {
                period = Period::Low;
            } else {
                period = Period::Control;
                let is_known = self.turn.interval > 0.0 && self.turn.direction != 0.0;
                against = Some(if !is_known {
                    0.0
                } else if self.turn.direction > 0.0 {
                    1.0
                } else {
                    -1.0
                });
            }
        }
        if found.is_some() && self.mode != Mode::Tripped {
            // A fault ends start-up.
            self.mode = Mode::Tripped;
            self.fault = found;
        }
        let mut calibrated = false;
        match self.mode {
            Mode::Run | Mode::Tripped | Mode::Coast | Mode::Brake => {}
            Mode::Start => self.go_on(),
            Mode::Calibrate => {
                let sensors = limits.sensed.phases().len();
                for (sum, adc) in self.sum.iter_mut().zip(seen.adc).take(sensors) {
                    *sum += lesser(adc, limits.adc_max);
                }
                self.countdown = greater(self.countdown - 1.0, 0.0);
                let samples = limits.calibration_samples;
                let is_far = |(sum, offset): (&W, f64)| {
                    (*sum - offset * samples).abs() > limits.offset_tolerance * samples
                };
                let mut sums = self.sum.iter().zip(limits.adc_offset).take(sensors);
                if self.countdown == 0.0 && sums.any(is_far) {
                    self.mode = Mode::Tripped;
                    self.fault = Some(Fault::Offset);
                } else if self.countdown == 0.0 {
                    calibrated = true;
                    if limits.precharge_periods > 0.0 {
                        self.countdown = word(limits.precharge_periods);
                        self.mode = Mode::Precharge;
                    } else {
                        self.start(limits);
                    }
                }
            }
            Mode::Precharge => {
                self.countdown = greater(self.countdown - 1.0, 0.0);
                if self.countdown == 0.0 {
                    self.start(limits);
                }
            }
        }
        Verdict {
            period,
            against,
            calibrated,
        }
    }

    /// Follows the rotor; whether this is the second edge in a row in its direction.
    fn follow(&mut self, limits: &Limits, code: HallCode) -> bool {
        let [before, now] = [self.turn.hall, code].map(|code| limits.sectors[usize::from(code.0)]);
        let mut is_second = false;
        if before != 0 && before != now {
            // Sectors ahead, of six.
            let direction = match (now + 6 - before) % 6 {
                1 => 1.0,
                5 => -1.0,
                _ => 0.0,
            };
            let last = self.turn.direction;
            is_second = direction != 0.0 && last == direction;
            let is_first = direction != 0.0 && last == 0.0;
            let was_slow = self.turn.is_slow(limits);
            // A slow rotor needs two edges in one direction to be another; one back is no motion.
            if is_second {
                self.turn.interval = self.turn.age;
            } else if !was_slow {
                self.turn.interval = word(0.0);
            }
            if is_second || (is_first && !was_slow) {
                self.turn.age = word(0.0);
            }
            self.turn.direction = word(direction);
        }
        self.turn.hall = code;
        self.turn.age = lesser(self.turn.age + 1.0, limits.brake_periods);
        is_second
    }

    /// Counts periods under demand since the last change of the Hall code.
    fn count_stall(&mut self, limits: &Limits, code: HallCode, demand: bool) {
        let is_first = self.hall_prev == HallCode::default();
        let is_edge = code != self.hall_prev && !is_first;
        self.hall_prev = code;
        self.stall_count = if is_edge || !demand || self.mode != Mode::Run {
            word(0.0)
        } else {
            lesser(self.stall_count + 1.0, limits.stall_periods)
        };
    }
}
