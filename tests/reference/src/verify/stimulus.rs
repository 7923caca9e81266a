//! Input streams of the bit-for-bit test, deterministic by seed.
//!
//! A drive first starts up: its current offsets are calibrated at rest, then it pre-charges. After
//! that, streams alternate in blocks, with interspersed calls (set-points, reset, start-up, jumps
//! to an earlier state). A tripped drive is reset soon, so that most steps are in control.

use super::toy_motor::ToyMotor;
use crate::{AnyCommand, Bus, BusSense, Error, SensedPhases, Spec, Stop};
use fastrand::Rng;
use hexagen::Sample;
use std::f64::consts::TAU;

/// Steps of a block.
const BLOCK: u32 = 512;

/// An electrical turn, words of angle.
const TURN: f64 = 4_294_967_296.0;

/// Maximum steps of start-up; longer ones are abandoned.
const START_UP: u32 = 1 << 14;

/// Kind of input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// Calibration at rest, then pre-charge.
    StartUp,
    /// Words of any value, mostly within the trip level.
    Arbitrary,
    /// A motor in closed loop.
    Motor,
    /// Ends of ranges and their neighbours.
    Corners,
}

/// A call between two steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Current set-point, bits of an `I16F16` in ampere.
    SetCurrent(i32),
    /// Torque set-point, bits of an `I16F16` in newton metres.
    SetTorque(i32),
    /// Speed, bits of an `I16F16` in rpm.
    SetSpeed(i32),
    /// Bus voltage, ADC counts.
    SetBus(u16),
    /// Reset.
    Reset,
    /// Offset calibration.
    Calibrate,
    /// Bootstrap pre-charge.
    Precharge,
    /// Coasting, braking, or their end.
    Stop(Stop),
    /// Keep a copy of the state words.
    Remember,
    /// Set the state words to the copy.
    Recall,
}

/// The stimulus's knowledge of the drive before the next step.
#[derive(Clone, Copy, Debug)]
pub struct Context {
    /// Current offsets, ADC counts.
    pub offset: [f64; 3],
    /// The drive is tripped.
    pub tripped: bool,
}

/// Generator of samples and calls.
#[derive(Clone, Debug)]
pub struct Stimulus {
    random: Rng,
    stream: Stream,
    left: u32,
    motor: ToyMotor,
    delay: u32,
    pending: AnyCommand,
    sector: usize,
    /// Steps until coasting or braking ends; 0: it does neither.
    stopped: u32,
    /// The last call was a reset or an end of coasting or braking, which leaves the set-point at 0.
    is_reset: bool,
    /// Ticks since the last Hall edge.
    age: f64,
    codes: [u8; 6],
    /// Electrical turns in a turn of the angle sensor, and the electrical angle at its angle 0; none with Hall sensors.
    angle: Option<(i32, u32)>,
    ticks: f64,
    age_max: u32,
    adc_max: i32,
    sensed: SensedPhases,
    /// Ampere per count of each sensor.
    gain: [f64; 3],
    trip_counts: i32,
    i_max_bits: f64,
    t_max_bits: f64,
    startup_steps: u32,
    /// Remaining steps of start-up, and the true offsets during it, ADC counts.
    start_up: u32,
    true_offset: [i32; 3],
    nominal_offset: [i32; 3],
    offset_tolerance: i32,
    bus: Option<BusSense>,
    /// Least and greatest count of the bus without a fault.
    bus_counts: [u16; 2],
    /// Samples in a row that may be disturbed, and those left of a gap.
    hall_glitches: u32,
    disturbed: u32,
    /// Bits of the greatest speed, with a speed loop.
    speed_bits: Option<f64>,
}

impl Stimulus {
    /// Streams for a drive of the given specification.
    ///
    /// # Errors
    /// If the specification is inconsistent.
    pub fn new(spec: &Spec, seed: u64) -> Result<Self, Error> {
        let inverter = &spec.inverter;
        let sensors = inverter.sensed_phases.phases().len();
        Ok(Self {
            random: Rng::with_seed(seed),
            stream: Stream::Motor,
            left: 1,
            motor: ToyMotor::new(spec)?,
            delay: spec.loop_options().delay,
            pending: AnyCommand::default(),
            sector: 0,
            stopped: 0,
            is_reset: false,
            age: 0.0,
            codes: spec.motor.hall_codes,
            angle: (inverter.angle_turns).map(|turns| (turns, inverter.angle_offset)),
            ticks: inverter.ticks,
            age_max: inverter.age_max,
            adc_max: (1 << inverter.adc_bits) - 1,
            sensed: inverter.sensed_phases,
            gain: [0, 1, 2].map(|sensor| inverter.adc_gain.of(sensor.min(sensors - 1))),
            trip_counts: (inverter.trip_current / inverter.adc_gain.first().abs()) as i32,
            i_max_bits: inverter.max_current * 65_536.0,
            t_max_bits: inverter.max_current * spec.motor.torque_constant * 65_536.0,
            startup_steps: (1 << inverter.calibration_log2) + inverter.precharge_periods,
            start_up: 0,
            true_offset: [0; 3],
            nominal_offset: [0, 1, 2]
                .map(|sensor| inverter.adc_offset.of(sensor.min(sensors - 1)) as i32),
            offset_tolerance: inverter.offset_tolerance as i32,
            bus_counts: inverter.bus_counts,
            hall_glitches: inverter.hall_glitches,
            disturbed: 0,
            speed_bits: spec
                .loop_options()
                .has_speed_loop()
                .then(|| inverter.omega_max * 60.0 / TAU * 65_536.0),
            bus: if inverter.bus == Bus::Measured {
                inverter.bus_sense()?
            } else {
                None
            },
        })
    }

    /// The kind of the last sample.
    pub fn stream(&self) -> Stream {
        self.stream
    }

    /// Stops the motor without current and starts up, as for a new drive. One calibration in a few
    /// has an offset at the edge of the tolerance or beyond.
    pub fn restart(&mut self) {
        self.motor.i = [0.0; 2];
        self.pending = AnyCommand::default();
        self.start_up = (self.startup_steps + 2).min(START_UP);
        let tolerance = self.offset_tolerance;
        let sensors = self.sensed.phases().len();
        for (offset, nominal) in self
            .true_offset
            .iter_mut()
            .zip(self.nominal_offset)
            .take(sensors)
        {
            let distance = match self.random.u8(..4) {
                0 => tolerance + self.random.i32(-2..=2),
                1 => tolerance - self.random.i32(0..=tolerance / 8),
                _ => self.random.i32(0..=tolerance),
            };
            let sign = if self.random.bool() { 1 } else { -1 };
            *offset = nominal + sign * distance;
        }
    }

    /// The next call, if any, and the next sample.
    #[inline]
    pub fn next(&mut self, context: &Context) -> (Option<Action>, Sample) {
        if self.start_up > 0 && !context.tripped {
            let is_first = self.stream != Stream::StartUp;
            self.stream = Stream::StartUp;
            self.start_up -= 1;
            self.left = 1;
            return (is_first.then_some(Action::Calibrate), self.at_rest());
        }
        self.start_up = 0;
        self.left -= 1;
        if self.left == 0 {
            self.left = BLOCK;
            self.stream = match self.random.u8(..8) {
                0 | 1 => Stream::Arbitrary,
                2 => Stream::Corners,
                _ => Stream::Motor,
            };
            self.motor.i = [0.0; 2];
        }
        let dice = self.random.u32(..);
        self.stopped = self.stopped.saturating_sub(1);
        let action = if self.stopped == 1 {
            Some(Action::Stop(Stop::Resume))
        } else if context.tripped && dice.is_multiple_of(2) {
            Some(Action::Reset)
        } else if self.is_reset && !(dice >> 1).is_multiple_of(8) {
            Some(self.demand())
        } else if dice >> 25 == 0 {
            self.action()
        } else {
            None
        };
        self.is_reset = matches!(action, Some(Action::Reset | Action::Stop(Stop::Resume)));
        let sample = match self.stream {
            Stream::StartUp => self.at_rest(),
            Stream::Arbitrary => self.arbitrary(context),
            Stream::Motor => self.motor(context),
            Stream::Corners => self.corners(context),
        };
        (action, sample)
    }

    /// A motor without current, its ADCs at their true offsets.
    fn at_rest(&mut self) -> Sample {
        let mut counts = [0; 3];
        let sensors = self.sensed.phases().len();
        for (count, offset) in counts.iter_mut().zip(self.true_offset).take(sensors) {
            let noise = self.random.i32(-1..=1);
            *count = self.adc(offset + noise);
        }
        let hall = self.codes[self.sector];
        let turn = self.turn_in_sector();
        self.sample(counts, (hall, u16::MAX), turn)
    }

    /// A sample with a Hall code and ticks, or with an angle.
    fn sample(&self, counts: [u16; 3], (hall, ticks): (u8, u16), turn: f64) -> Sample {
        let Some((turns, offset)) = self.angle else {
            return self.sensed.sample(counts, hall).hall_ticks(ticks);
        };
        // Now and then a Hall code, which an angle drive cannot take.
        if hall > 7 {
            return self.sensed.sample(counts, hall);
        }
        let electrical = (turn * TURN) as i64 as u32;
        let word = f64::from(electrical.wrapping_sub(offset)) / f64::from(turns);
        self.sensed.sample_with_angle(counts, word as i64 as u32)
    }

    /// Electrical angle inside the sector, turns; for angle sensors alone, which leaves other streams as they are.
    fn turn_in_sector(&mut self) -> f64 {
        if self.angle.is_none() {
            return 0.0;
        }
        (self.sector as f64 + self.random.f64() - 0.5) / 6.0
    }

    /// Takes the drive's answer to the last sample.
    #[inline]
    pub fn respond(&mut self, command: AnyCommand) {
        if self.stream == Stream::Motor {
            let applied = if self.delay == 1 {
                self.pending
            } else {
                command
            };
            self.motor.advance(applied);
        }
        self.pending = command;
    }

    /// The calls of firmware after a reset.
    fn demand(&mut self) -> Action {
        match self.speed_bits {
            Some(most) => Action::SetSpeed(self.set_point(most)),
            None => Action::SetCurrent(self.set_point(self.i_max_bits)),
        }
    }

    fn action(&mut self) -> Option<Action> {
        if let Some(most) = self.speed_bits
            && self.random.u8(..4) == 0
        {
            return Some(Action::SetSpeed(self.set_point(most)));
        }
        match self.random.u8(..32) {
            0..=11 => Some(Action::SetCurrent(self.set_point(self.i_max_bits))),
            12..=19 => Some(Action::SetTorque(self.set_point(self.t_max_bits))),
            20 => Some(Action::Reset),
            21 => Some(Action::Remember),
            22 => Some(Action::Recall),
            23 => {
                // Rare enough that start-up is a small fraction of the steps.
                let rare = self.random.u32(..self.startup_steps.max(1)) == 0;
                match (rare, self.random.bool()) {
                    (true, true) => Some(Action::Calibrate),
                    (true, false) => Some(Action::Precharge),
                    (false, true) if self.stopped == 0 => Some(self.stop()),
                    (false, _) => None,
                }
            }
            24..=27 => self.bus_action(),
            _ => {
                let share = self.random.f64() * 2.0 - 1.0;
                self.motor.set_speed(if self.random.u8(..4) == 0 {
                    0.0
                } else {
                    1.3 * share
                });
                None
            }
        }
    }

    /// Coasting or braking for up to two hundred steps: most steps shall be in control.
    fn stop(&mut self) -> Action {
        self.stopped = self.random.u32(2..200);
        let coasts = self.random.u8(..4) == 0;
        Action::Stop(if coasts { Stop::Coast } else { Stop::Brake })
    }

    fn set_point(&mut self, max: f64) -> i32 {
        let share = self.random.f64() * 2.0 - 1.0;
        match self.random.u8(..16) {
            0 => self.random.i32(..),
            1 => [0, 1, -1, i32::MAX, i32::MIN, max as i32, -max as i32][self.random.usize(..7)],
            2..=5 => (share * max / 16.0) as i32,
            6..=9 => (max.copysign(share)) as i32,
            _ => (share * max) as i32,
        }
    }

    fn bus_action(&mut self) -> Option<Action> {
        let bus = self.bus?;
        match self.random.u8(..16) {
            0 => return Some(Action::SetBus(self.random.u16(..))),
            1 => {
                let [least, most] = self.bus_counts;
                let end = if self.random.bool() { least } else { most };
                let near = self.random.i16(-1..=1);
                return Some(Action::SetBus(end.saturating_add_signed(near)));
            }
            _ => {}
        }
        let volts = bus.min + self.random.f64() * (bus.max - bus.min);
        self.motor.v_bus = volts;
        Some(Action::SetBus((volts / bus.gain) as u16))
    }

    /// Hall code and ticks of a random rotor.
    fn wandering_hall(&mut self) -> (u8, u16) {
        let dice = self.random.u32(..);
        self.age = (self.age + self.ticks).min(65_535.0);
        let before = self.sector;
        match dice & 0xff {
            0..=47 => self.sector = (self.sector + 1) % 6,
            48..=95 => self.sector = (self.sector + 5) % 6,
            96..=99 => self.sector = (dice >> 16) as usize % 6,
            _ => {}
        }
        if self.sector != before {
            self.age = f64::from((dice >> 8) % (self.ticks as u32 + 1));
        }
        let ticks = match dice >> 24 {
            0..=3 => self.random.u16(..),
            4 => self.age_max as u16,
            5 => self.age_max as u16 + 1,
            6 => 0,
            7 => u16::MAX,
            _ => self.age as u16,
        };
        // Codes of more than three bits are invalid.
        let code = match (dice >> 8) & 0x1ff {
            0 => 0,
            1 => 7,
            2 => self.random.u8(..),
            _ => self.codes[self.sector],
        };
        (self.disturb(code), ticks)
    }

    /// Angle of a random rotor, turns: mostly one that turns, at times one that jumps.
    fn wandering_turn(&mut self) -> f64 {
        if self.angle.is_some() && self.random.u8(..8) == 0 {
            self.random.f64()
        } else {
            self.turn_in_sector()
        }
    }

    /// A Hall code, now and then disturbed for about as many samples as are bridged.
    fn disturb(&mut self, code: u8) -> u8 {
        if self.hall_glitches == 0 {
            return code;
        }
        if self.disturbed == 0 && self.random.u16(..512) == 0 {
            self.disturbed = self.random.u32(..=self.hall_glitches + 1);
        }
        if self.disturbed == 0 {
            return code;
        }
        self.disturbed -= 1;
        self.random.u8(..8)
    }

    fn adc(&self, count: i32) -> u16 {
        count.clamp(0, self.adc_max) as u16
    }

    fn arbitrary(&mut self, context: &Context) -> Sample {
        let (hall, hall_ticks) = self.wandering_hall();
        let dice = self.random.u32(..);
        let counts = match dice & 0x7f {
            0 => self.any_counts(|random| random.u16(..)),
            1 => {
                let most = self.adc_max;
                self.any_counts(|random| random.i32(0..=most) as u16)
            }
            _ => {
                // All three currents within the trip level.
                let trip = self.trip_counts;
                let a = self.random.i32(-trip..=trip);
                let b = self.random.i32((-trip).max(-trip - a)..=trip.min(trip - a));
                self.counts_of([a, b, -(a + b)], context)
            }
        };
        let turn = self.wandering_turn();
        self.sample(counts, (hall, hall_ticks), turn)
    }

    /// A count of each sensor.
    fn any_counts(&mut self, count: impl Fn(&mut Rng) -> u16) -> [u16; 3] {
        let mut counts = [0; 3];
        for place in counts.iter_mut().take(self.sensed.phases().len()) {
            *place = count(&mut self.random);
        }
        counts
    }

    /// Counts of currents in counts of the first sensor; of unlike sensors they move to different sides, or as far.
    fn counts_of(&self, currents: [i32; 3], context: &Context) -> [u16; 3] {
        [0, 1, 2].map(|x| {
            let current = f64::from(currents[x]) * self.gain[0] / self.gain[x];
            self.adc(context.offset[x] as i32 + current.round() as i32)
        })
    }

    fn motor(&mut self, context: &Context) -> Sample {
        let dice = self.random.u32(..);
        // Placement jitter of about a degree makes edges come and go at low speed.
        let jitter = f64::from(dice >> 20) * (1.0 / 4096.0) - 0.5;
        let sector = self.motor.sector(jitter * (1.0 / 180.0));
        self.age = (self.age + self.ticks).min(65_535.0);
        if sector != self.sector {
            self.age = f64::from((dice >> 4) & 0xff) * self.ticks / 256.0;
        }
        self.sector = sector;
        let noise = [0, 2, 8].map(|shift| ((dice >> shift) & 3) as i32 - 1);
        let [i_a, i_b] = self.motor.i;
        let currents = self.sensed.of_sensors([i_a, i_b, -(i_a + i_b)]);
        let count = |sensor: usize| {
            let counts = context.offset[sensor] + currents[sensor] / self.gain[sensor];
            self.adc(counts as i32 + noise[sensor])
        };
        let hall = if (dice >> 12).is_multiple_of(1 << 14) {
            0
        } else {
            self.codes[sector]
        };
        let counts = [count(0), count(1), count(2)];
        let hall = self.disturb(hall);
        let turn = self.motor.turn + jitter / 180.0;
        self.sample(counts, (hall, self.age as u16), turn)
    }

    fn corners(&mut self, context: &Context) -> Sample {
        let (hall, hall_ticks) = self.wandering_hall();
        let mut corner = |offset: f64| {
            let offset = offset as i32;
            let near = self.random.i32(-1..=1);
            match self.random.u8(..16) {
                0 => near,
                1 => self.adc_max + near,
                2..=4 => offset + self.trip_counts + near,
                5..=7 => offset - self.trip_counts + near,
                8..=9 => offset + self.trip_counts / 2 + near,
                10..=11 => offset - self.trip_counts / 2 + near,
                _ => offset + near,
            }
        };
        let (first, second) = (corner(context.offset[0]), corner(context.offset[1]));
        let mut third = 0;
        if self.sensed == SensedPhases::Abc {
            third = corner(context.offset[2]);
        }
        if self.sensed == SensedPhases::Abc && self.random.u8(..4) != 0 {
            // Mostly the three currents add up.
            let current = |count: i32, x: usize| {
                f64::from(count - context.offset[x] as i32) * self.gain[x] / self.gain[2]
            };
            let rest = -(current(first, 0) + current(second, 1));
            third = context.offset[2] as i32 + rest.round() as i32;
        }
        let counts = [first, second, third];
        // One above the ADC's range is a corner case, too.
        let counts = counts.map(|count| count.clamp(0, (self.adc_max + 1).min(65_535)) as u16);
        let turn = self.wandering_turn();
        self.sample(counts, (hall, hall_ticks), turn)
    }
}
