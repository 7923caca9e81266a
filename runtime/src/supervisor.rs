//! Supervision of a drive: faults, calibration, start-up. The same code for all drives; [`Limits`]
//! and [`Sensors`] have the differences.
#![expect(
    clippy::inline_always,
    reason = "what three sensors need vanishes for two only where their constants are seen"
)]

#[cfg(test)]
mod tests;

use crate::arith::Word;
use crate::limits::is_hall_code;
use crate::sensors::{Unread, third_of};
use crate::status::{Fault, Mode, Status, number};
use crate::{Checked, LegState, Limits, Sample, Sensor, Sensors, ThirdSensor};

/// The supervisor of a drive: mode, first fault, offsets of the current ADCs.
///
/// Each control period is [`check`](Self::check)ed and controlled, or [`examine`](Self::examine)d; that
/// period is controlled after all, or handled by [`rest`](Self::rest).
///
/// # Start-up
///
/// A new drive begins with the third of these steps, at set-point 0, with nominal current offsets and
/// bootstrap capacitors not charged. If the inverter needs either, call calibration first; the steps
/// follow each other:
///
/// 1. Calibration: periods with all legs off, whose ADC counts are averaged. The motor must be at
///    rest. An offset too far from its nominal value trips the drive. No current is judged meanwhile:
///    without offsets a count tells none, and a trip would turn off what is off already.
/// 2. Pre-charge, if specified: periods with all lower switches on, which charge the bootstrap
///    capacitors, and short-circuit a turning motor.
/// 3. Start, where the law knows the EMF from the rotor's angle: periods with all legs off, until two
///    Hall edges in one direction give that angle. A rotor that is too slow for them within
///    [`start_periods`](Limits::start_periods) needs none. So control may begin at any speed. The
///    bootstrap capacitors must hold their charge meanwhile, or get it from the first pulses.
/// 4. Control with the present set-point.
///
/// A fault ends start-up and discards its results; a reset leads to the third step.
///
/// # Coasting and braking
///
/// [`coast`](Self::coast) turns all legs off on purpose, without a fault.
/// [`brake`](Self::brake) slows the rotor down: below the speed at which the short-circuited motor
/// takes the largest current (`max_current`), all lower switches are on; above it the drive controls
/// that current against the rotation, which feeds the bus; until two Hall edges in one direction
/// tell it, no current. A rotor that stands stays shorted whatever one sensor does: a disturbed sample
/// of the sector beside, or a sensor that chatters on its edge, goes there and back. Both go on until [`resume`](Self::resume), a reset or a trip; the
/// set-point is 0 then. The sensors are watched as in control, but for a stall. A start that they
/// interrupt goes on meanwhile: braking begins when it is over; if `resume` comes earlier, the rest of
/// the start follows.
///
/// # Safe states
///
/// Each [`Fault`] turns all legs off until a reset; the period of the trip is kept until then
/// ([`SetPoint::trip`](crate::SetPoint::trip)).
///
/// A Hall code is disturbed if no sensors give it, and with `hall_glitches` also if it is not that of
/// the last sector or of one beside it. So many samples in a row with such a code are bridged: the
/// drive goes on as if the last code had stayed, at the speed that it knows, and counts them
/// ([`Status::hall_glitches`]); one more is a fault. Without `hall_glitches` a code that no sensors
/// give is a fault at once, and one that skips sectors is none. A disturbed code of a sector beside the
/// last is taken for an edge, and what it commutates may end in [`Fault::OverCurrent`].
///
/// # What the supervisor cannot see
///
/// It trips on what samples show: a current above the trip level (but in calibration), a current ADC
/// at an end of its range, an invalid Hall code, and where told to, a rotor that stands or turns too
/// fast; and on a bus voltage that [`set_bus`](crate::SetPoint::set_bus) tells. It cannot see the
/// following; where an option helps, it is named:
///
/// - a current ADC or amplifier that is stuck or wrong within its range: one that is frozen at
///   mid-scale can let the true current rise to several times the trip level. The option
///   `residual_timeout` notices many of these, after its time ([`Fault::Residual`]);
/// - the current of the phase that is not read: it is taken as the negative sum of the other two. With
///   three sensors (`sensed_phases: abc`) the sum of all three is watched where all are read
///   ([`Fault::CurrentSum`]);
/// - a control interrupt that does not come: the last command stands;
/// - heat, shoot-through, and what is shorter than a control period;
/// - a bus voltage that nobody measures, or that rises between two calls of `set_bus`.
///
/// So the board must have (a) a comparator of the current on the timer's break input, (b) a
/// watchdog on the control interrupt and (c) a thermal limit; where the motor can brake, a limit of
/// the bus voltage, too: with all legs off the diodes still pass an EMF above the bus on to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Supervisor {
    mode: Mode,
    fault: Option<Fault>,
    /// Periods left in calibration, pre-charge or start.
    countdown: u16,
    /// Last Hall code that was not disturbed, if stalls are detected or codes bridged; 0 before the
    /// first.
    hall_prev: u8,
    /// Samples since then, bridged.
    hall_gap: u16,
    /// All samples that were bridged, at most [`MOST_GLITCHES`].
    hall_glitches: u16,
    /// Periods under demand since the last Hall edge.
    stall_count: Word,
    /// Sums of calibration samples of the sensors, counts; 0 of a third that is not there.
    sums: [Word; 3],
    /// Their offsets, words of current.
    offsets: [Word; 3],
    /// Samples in a row whose three currents do not add up.
    sum_count: u16,
    /// With three sensors in the low legs: in two bits each, the leg that the command of the period
    /// that ends leaves unread, and with a delay that of the next period's; 0 to 2, or 3 for none.
    unread: u8,
    /// What start and braking know of the rotor.
    turn: Turn,
}

/// Rotation of the rotor, from the Hall edges since control ended or the drive was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Turn {
    /// Hall code of the last period; 0 before the first.
    hall: u8,
    /// Control periods since the last edge that is not one back over the edge before it: a sensor
    /// that chatters moves no rotor.
    age: Word,
    /// Control periods between two edges, the last one of them the second in a row in its direction;
    /// 0 if the last edge is not.
    interval: Word,
    /// Of the last edge, 1 forward, -1 backward; 0 before the first and behind one that skips sectors.
    direction: Word,
}

impl Turn {
    const UNKNOWN: Self = Self {
        hall: 0,
        age: Word(0),
        interval: Word(0),
        direction: Word(0),
    };

    /// Follows the rotor for a control period; whether it ends in an edge that is the second in a row
    /// in one direction.
    fn follow(&mut self, limits: &Limits, hall: u8) -> bool {
        let (before, now) = (limits.sector(self.hall), limits.sector(hall));
        let is_edge = before != 0 && now != before;
        let direction = if !is_edge {
            self.direction
        } else if follows(before, now) {
            Word(1)
        } else if follows(now, before) {
            Word(-1)
        } else {
            Word(0)
        };
        let is_second = is_edge && direction != 0 && direction == self.direction;
        if is_second {
            self.interval = self.age;
            self.age = Word(0);
        } else if is_edge && !self.is_slow(limits) {
            self.interval = Word(0);
            if self.direction == 0 && direction != 0 {
                self.age = Word(0);
            }
        }
        self.hall = hall;
        self.direction = direction;
        self.age = (self.age + 1).min(limits.brake_periods);
        is_second
    }

    /// Whether a sector lasts long enough for a short-circuited motor to take no more than the
    /// largest current. A slow rotor stays so until two edges in one direction show another speed:
    /// one disturbed sample gives two edges, too, but there and back.
    fn is_slow(&self, limits: &Limits) -> bool {
        self.age.max(self.interval) == limits.brake_periods
    }

    /// The direction of the last two edges, if it is the same one; else 0.
    fn known_direction(&self) -> Word {
        if self.interval == 0 {
            Word(0)
        } else {
            self.direction
        }
    }
}

/// Whether a sector is the next one of the other, forward.
const fn follows(sector: u32, next: u32) -> bool {
    next == if sector == 6 { 1 } else { sector + 1 }
}

/// The mode of a drive that is to control with so many periods of a start before.
const fn before_control(periods: u16) -> Mode {
    match periods {
        0 => Mode::Run,
        _ => Mode::Start,
    }
}

/// Count of bridged samples at which counting ends.
pub(crate) const MOST_GLITCHES: u16 = 0x7fff;

/// What a drive does in a period that is not fit for control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Unfit {
    /// It rests, all legs in one state; for this fault of the period, the first of several, or without one.
    Rest(Option<Fault>),
    /// It controls after all: the sample's disturbed Hall code is bridged.
    Control,
    /// It brakes a fast rotor: control with the largest torque against this direction, 1 forward or
    /// -1 backward; at set-point 0 while the direction is unknown, 0.
    Against(Word),
}

impl Supervisor {
    /// Names of the state words, in the order of [`Self::words`]; `_a` is the first sensed phase,
    /// `_b` the second, `_c` the third.
    pub const NAMES: [&'static str; 19] = [
        "mode",
        "fault",
        "countdown",
        "sum_a",
        "sum_b",
        "offset_a",
        "offset_b",
        "stall_count",
        "hall_prev",
        "hall_gap",
        "hall_glitches",
        "turn_hall",
        "turn_age",
        "turn_interval",
        "turn_direction",
        "sum_c",
        "offset_c",
        "sum_count",
        "unread",
    ];

    /// A supervisor that starts, with nominal offsets.
    #[must_use]
    pub const fn new(limits: &Limits, sensors: &Sensors) -> Self {
        let [first, second, third] = limits.each_of(sensors);
        let bits = limits.current_bits;
        let third = match sensors.third {
            None => Word(0),
            Some(_) => Word((third.offset as i32).wrapping_shl(bits)),
        };
        Self {
            mode: before_control(limits.start_periods),
            fault: None,
            countdown: limits.start_periods,
            hall_prev: 0,
            hall_gap: 0,
            hall_glitches: 0,
            stall_count: Word(0),
            sums: [Word(0); 3],
            offsets: [
                Word((first.offset as i32).wrapping_shl(bits)),
                Word((second.offset as i32).wrapping_shl(bits)),
                third,
            ],
            sum_count: 0,
            unread: 0,
            turn: Turn::UNKNOWN,
        }
    }

    /// The sample for a controlled period; `None` if the drive is starting up, off on purpose or
    /// tripped, or the sample has a fault. Then call [`examine`](Self::examine) with the same sample.
    /// `is_demanded` tells whether the set-point is not 0.
    #[inline]
    #[must_use]
    pub fn check(
        &mut self,
        limits: &Limits,
        sensors: &Sensors,
        sample: &Sample,
        is_demanded: impl FnOnce() -> bool,
    ) -> Option<Checked> {
        let adc = sensors.phases.of(sample.adc);
        let [first, second, third] = adc;
        let i = self.sensed(limits, sensors, [first.into(), second.into(), third.into()]);
        let hall = limits.hall_of(sample);
        let is_sound = self.is_sound(limits, hall);
        let is_edge = self.watch_hall(limits, hall, is_sound);
        let stalled = self.watch_stall(limits, is_edge, is_demanded);
        let is_off = self.watch_sum(limits, sensors, adc);
        let is_fit = self.mode == Mode::Run
            && !self.is_at_end(limits, sensors, Unread::First, first)
            && !self.is_at_end(limits, sensors, Unread::Second, second)
            && !self.is_at_end(limits, sensors, Unread::Third, third)
            && is_sound
            && !limits.is_over(i)
            && !is_off
            && !stalled;
        is_fit.then(|| Checked {
            i: sensors.phases.a_and_b(i, third_of(i)),
            hall: hall.into(),
            timing: sample.hall_ticks.into(),
        })
    }

    /// The leg that the sample does not show.
    #[inline(always)]
    const fn unread(&self, sensors: &Sensors) -> Unread {
        match sensors.third {
            None => Unread::Third,
            Some(ThirdSensor { readable: None, .. }) => Unread::None,
            Some(_) => Unread::from_number(self.unread),
        }
    }

    /// Currents of the first and the second phase: measured, or the rest of the other two.
    #[inline(always)]
    fn sensed(&self, limits: &Limits, sensors: &Sensors, counts: [Word; 3]) -> [Word; 2] {
        let [first, second, third] = limits.measured(sensors, counts, self.offsets);
        match self.unread(sensors) {
            Unread::First => [third_of([second, third]), second],
            Unread::Second => [first, third_of([first, third])],
            Unread::Third | Unread::None => [first, second],
        }
    }

    /// Whether the ADC of a leg is at an end of its range, if it is read.
    #[inline(always)]
    fn is_at_end(&self, limits: &Limits, sensors: &Sensors, leg: Unread, count: u16) -> bool {
        self.unread(sensors) != leg && limits.is_at_end(count)
    }

    /// Counts samples whose three currents do not add up to nothing; true for as many as trip.
    #[inline(always)]
    fn watch_sum(&mut self, limits: &Limits, sensors: &Sensors, adc: [u16; 3]) -> bool {
        let Some(third) = sensors.third else {
            return false;
        };
        if self.mode != Mode::Run || third.sum_samples == 0 {
            self.sum_count = 0;
        } else if self.unread(sensors) == Unread::None {
            let counts = limits.within_range(adc);
            let [first, second, third_current] = limits.measured(sensors, counts, self.offsets);
            let sum = first + second + third_current;
            self.sum_count = if sum.exceeds(third.sum_tolerance) {
                self.sum_count.saturating_add(1).min(third.sum_samples)
            } else {
                0
            };
        }
        self.is_sum_off(sensors)
    }

    #[inline(always)]
    const fn is_sum_off(&self, sensors: &Sensors) -> bool {
        match sensors.third {
            Some(third) => third.sum_samples != 0 && self.sum_count == third.sum_samples,
            None => false,
        }
    }

    /// Remembers which leg the command of a controlled period leaves unread at its end, with three
    /// sensors in the low legs. `on` has the timer counts for which each leg's upper switch is on, or
    /// none for a leg that is off. [`rest`](Self::rest) does this for the periods that it handles.
    #[inline]
    pub fn follow_command(&mut self, sensors: &Sensors, on: [Option<u16>; 3]) {
        let Some(ThirdSensor {
            readable: Some(readable),
            is_delayed,
            ..
        }) = sensors.third
        else {
            return;
        };
        let next = Unread::of(on, readable) as u8;
        self.unread = if is_delayed {
            self.unread >> 2 | next << 2
        } else {
            next
        };
    }

    /// Whether a Hall code is not disturbed.
    #[inline]
    fn is_sound(&self, limits: &Limits, hall: u8) -> bool {
        // Codes of sectors side by side differ in one sensor.
        let changed = hall ^ self.hall_prev;
        let is_beside = changed & changed.wrapping_sub(1) == 0;
        is_hall_code(hall) && (limits.hall_glitches == 0 || self.hall_prev == 0 || is_beside)
    }

    /// Follows the Hall code of a sample, which is disturbed or not; whether it is another one than the
    /// last, which without stall detection and bridging is not known.
    #[inline]
    fn watch_hall(&mut self, limits: &Limits, hall: u8, is_sound: bool) -> bool {
        let is_edge = is_sound && hall != self.hall_prev && self.hall_prev != 0;
        if is_sound && (limits.stall_periods != 0 || limits.hall_glitches != 0) {
            self.hall_prev = hall;
            self.hall_gap = 0;
        }
        is_edge
    }

    /// Counts periods without a Hall edge under demand; true on a stall.
    #[inline]
    fn watch_stall(
        &mut self,
        limits: &Limits,
        is_edge: bool,
        is_demanded: impl FnOnce() -> bool,
    ) -> bool {
        if limits.stall_periods == 0 {
            return false;
        }
        self.stall_count = if is_edge || !is_demanded() || self.mode != Mode::Run {
            Word(0)
        } else {
            (self.stall_count + 1).min(limits.stall_periods)
        };
        self.is_stalled(limits)
    }

    #[inline]
    fn is_stalled(&self, limits: &Limits) -> bool {
        limits.stall_periods != 0 && self.stall_count == limits.stall_periods
    }

    /// What the drive does in a period that is not fit for control: one whose [`check`](Self::check)
    /// gave no sample, or with the fault `known` already, which no sample shows. The check is called in
    /// any case, since it follows the sensors; with a known fault, what it returns is not used.
    ///
    /// Bridges a disturbed Hall code, brakes, or says that the drive rests; then call
    /// [`rest`](Self::rest) with the fault. In the returned sample counts are clamped to the ADC's range,
    /// and the current of a phase that is not read to that of one that is; a Hall code that is bridged is
    /// the last one, and another that no sensors give is 0.
    ///
    /// It is apart from [`rest`](Self::rest), so that no way leads from a trip or a start-up to control,
    /// and the longest computation time is that of one of them.
    #[inline(always)]
    pub fn examine(
        &mut self,
        limits: &Limits,
        sensors: &Sensors,
        sample: &Sample,
        known: Option<Fault>,
    ) -> (Checked, Unfit) {
        let adc = sensors.phases.of(sample.adc);
        let counts = limits.within_range(adc);
        let i = self.sensed(limits, sensors, counts);
        let [least, most] = limits.currents;
        let within = |i: Word| i.min(most).max(least);
        let [i_a, i_b] = sensors.phases.a_and_b(i, third_of(i));
        let sampled = limits.hall_of(sample);
        let is_sound = self.is_sound(limits, sampled);
        let is_bridged = !is_sound && self.bridge(limits);
        let hall = if is_bridged {
            self.hall_prev
        } else if is_hall_code(sampled) {
            sampled
        } else {
            0
        };
        let checked = Checked {
            i: [within(i_a), within(i_b)],
            hall: hall.into(),
            timing: sample.hall_ticks.into(),
        };
        let [first, second, third] = adc;
        let found = if known.is_some() {
            known
        } else if self.is_at_end(limits, sensors, Unread::First, first)
            || self.is_at_end(limits, sensors, Unread::Second, second)
            || self.is_at_end(limits, sensors, Unread::Third, third)
        {
            Some(Fault::AdcRange)
        } else if !is_sound && !is_bridged {
            Some(Fault::Hall)
        } else if self.mode != Mode::Calibrate && limits.is_over(i) {
            Some(Fault::OverCurrent)
        } else if self.is_sum_off(sensors) {
            Some(Fault::CurrentSum)
        } else if self.is_stalled(limits) {
            Some(Fault::Stall)
        } else {
            None
        };
        if found.is_some() {
            return (checked, Unfit::Rest(found));
        }
        if matches!(self.mode, Mode::Start | Mode::Coast | Mode::Brake) {
            self.follow(limits, hall);
        }
        let unfit = match self.mode {
            Mode::Run if is_bridged => Unfit::Control,
            Mode::Brake if self.is_against(limits) => Unfit::Against(self.turn.known_direction()),
            _ => Unfit::Rest(None),
        };
        (checked, unfit)
    }

    /// A period without control, which [`examine`](Self::examine) found to be one: trips on the fault, or
    /// continues start-up. Returns the state of all legs, and what trips the drive in this period.
    #[inline(always)]
    #[must_use]
    pub fn rest(
        &mut self,
        limits: &Limits,
        sensors: &Sensors,
        sample: &Sample,
        fault: Option<Fault>,
    ) -> (LegState, Option<Fault>) {
        let (state, tripped) = if let Some(fault) = fault {
            (LegState::Off, self.trip(fault))
        } else {
            let is_braking = self.mode == Mode::Brake && self.countdown == 0;
            let is_low = self.mode == Mode::Precharge || is_braking;
            let tripped = self.start_up(limits, sensors, sensors.phases.of(sample.adc));
            let state = if is_low { LegState::Low } else { LegState::Off };
            (state, tripped)
        };
        let on = match state {
            LegState::Off => None,
            _ => Some(0),
        };
        self.follow_command(sensors, [on; 3]);
        (state, tripped)
    }

    /// Takes a sample with a disturbed Hall code as one more of a gap; false if the gap is too long, or
    /// no code is known yet.
    fn bridge(&mut self, limits: &Limits) -> bool {
        let may = self.hall_prev != 0 && self.hall_gap < limits.hall_glitches;
        if may {
            self.hall_gap = self.hall_gap.saturating_add(1);
            self.hall_glitches = self.hall_glitches.saturating_add(1).min(MOST_GLITCHES);
        }
        may
    }

    /// Follows a rotor without control, and counts a start down, which the rotor's angle ends.
    fn follow(&mut self, limits: &Limits, hall: u8) {
        let is_known = self.turn.follow(limits, hall);
        self.countdown = if is_known {
            0
        } else {
            self.countdown.saturating_sub(1)
        };
    }

    /// Calibration averages the counts of all its samples; then pre-charge counts its periods down,
    /// and the start follows. Returns what trips the drive.
    #[inline(always)]
    fn start_up(&mut self, limits: &Limits, sensors: &Sensors, adc: [u16; 3]) -> Option<Fault> {
        match self.mode {
            Mode::Start => self.mode = before_control(self.countdown),
            Mode::Calibrate => {
                let most = Word::from(limits.adc_max) << limits.calibration_log2;
                let ([sum_a, sum_b, sum_c], [a, b, c]) = (self.sums, limits.within_range(adc));
                // The countdown ends the sums before this limit, whatever the initial state.
                let third = match sensors.third {
                    None => Word(0),
                    Some(_) => (sum_c + c).min(most),
                };
                self.sums = [(sum_a + a).min(most), (sum_b + b).min(most), third];
                self.countdown = self.countdown.saturating_sub(1);
                if self.countdown == 0 {
                    return self.end_calibration(limits, sensors);
                }
            }
            Mode::Precharge => {
                self.countdown = self.countdown.saturating_sub(1);
                if self.countdown == 0 {
                    self.start(limits);
                }
            }
            _ => {}
        }
        None
    }

    /// Control follows, once the rotor's angle is known.
    const fn start(&mut self, limits: &Limits) {
        self.countdown = limits.start_periods;
        self.mode = before_control(limits.start_periods);
        self.turn = Turn::UNKNOWN;
    }

    /// Whether braking asks for torque against a rotor, a fast one; a slow one is shorted through the
    /// lower switches, and an interrupted start goes on first.
    fn is_against(&self, limits: &Limits) -> bool {
        self.countdown == 0 && !self.turn.is_slow(limits)
    }

    fn end_calibration(&mut self, limits: &Limits, sensors: &Sensors) -> Option<Fault> {
        let is_bad = |sensor: Sensor, sum: Word| {
            let [least, most] = sensor
                .offsets
                .map(|offset| Word::from(offset) << limits.calibration_log2);
            sum < least || sum > most
        };
        let ([first, second, third], [sum_a, sum_b, sum_c]) = (limits.each_of(sensors), self.sums);
        let is_third_bad = sensors.third.is_some() && is_bad(third, sum_c);
        if is_bad(first, sum_a) || is_bad(second, sum_b) || is_third_bad {
            return self.trip(Fault::Offset);
        }
        // The mean in words of current, rounded down.
        let (bits, log2) = (limits.current_bits, limits.calibration_log2);
        let mean = |sum: Word| {
            if bits >= log2 {
                sum << (bits - log2)
            } else {
                sum >> (log2 - bits)
            }
        };
        self.offsets = [mean(sum_a), mean(sum_b), mean(sum_c)];
        self.countdown = limits.precharge_periods;
        self.mode = Mode::Precharge;
        if limits.precharge_periods == 0 {
            self.start(limits);
        }
        None
    }

    /// Turns all legs off until a reset. Returns the fault, if it is the first, which is kept.
    fn trip(&mut self, fault: Fault) -> Option<Fault> {
        if self.mode == Mode::Tripped {
            return None;
        }
        self.mode = Mode::Tripped;
        self.fault = Some(fault);
        self.fault
    }

    /// Whether control is on, to begin next, or off on purpose: neither calibrating nor pre-charging,
    /// and not tripped.
    const fn is_ready(&self) -> bool {
        matches!(
            self.mode,
            Mode::Run | Mode::Start | Mode::Coast | Mode::Brake
        )
    }

    /// Turns all legs off until [`resume`](Self::resume). Ignored when tripped, calibrating and
    /// pre-charging.
    pub fn coast(&mut self) {
        self.stop(Mode::Coast);
    }

    /// Brakes until [`resume`](Self::resume). Ignored when tripped, calibrating and pre-charging.
    pub fn brake(&mut self) {
        self.stop(Mode::Brake);
    }

    fn stop(&mut self, mode: Mode) {
        if !self.is_ready() {
            return;
        }
        // In control the rotor is not followed here.
        if self.mode == Mode::Run {
            self.turn = Turn::UNKNOWN;
        }
        self.mode = mode;
    }

    /// Ends coasting and braking: what is left of a start follows, or control. False, without effect,
    /// if the drive does neither.
    pub fn resume(&mut self) -> bool {
        let is_off = matches!(self.mode, Mode::Coast | Mode::Brake);
        if is_off {
            self.mode = before_control(self.countdown);
        }
        is_off
    }

    /// Clears a trip; keeps calibrated offsets. A start follows, without calibration and pre-charge.
    /// False, without effect, during these.
    pub fn reset(&mut self, limits: &Limits, sensors: &Sensors) -> bool {
        let may_reset = self.is_ready() || self.mode == Mode::Tripped;
        if may_reset {
            *self = Self {
                offsets: self.offsets,
                unread: self.unread,
                ..Self::new(limits, sensors)
            };
        }
        may_reset
    }

    /// Starts calibration; ignored when tripped.
    pub fn calibrate(&mut self, limits: &Limits) {
        if self.mode != Mode::Tripped {
            self.mode = Mode::Calibrate;
            self.countdown = 1_u16.wrapping_shl(limits.calibration_log2);
            self.sums = [Word(0); 3];
        }
    }

    /// Starts pre-charge; ignored when tripped, calibrating, coasting and braking, and if the
    /// specification has none.
    pub fn precharge(&mut self, limits: &Limits) {
        let may_begin = matches!(self.mode, Mode::Run | Mode::Start | Mode::Precharge);
        if may_begin && limits.precharge_periods != 0 {
            self.mode = Mode::Precharge;
            self.countdown = limits.precharge_periods;
        }
    }

    /// Mode and fault of the drive.
    #[inline]
    #[must_use]
    pub const fn status(&self) -> Status {
        Status::from_bits(self.status_bits(), false)
    }

    #[inline]
    pub(crate) const fn status_bits(&self) -> i32 {
        Status::to_bits(self.mode, self.fault, self.hall_glitches)
    }

    /// The state words, in the order of [`Self::NAMES`]. For verification.
    #[must_use]
    pub fn words(&self) -> [i32; Self::NAMES.len()] {
        let [sum_a, sum_b, sum_c] = self.sums;
        let [offset_a, offset_b, offset_c] = self.offsets;
        let turn = &self.turn;
        [
            self.mode as i32,
            number(self.fault),
            self.countdown.into(),
            sum_a.0,
            sum_b.0,
            offset_a.0,
            offset_b.0,
            self.stall_count.0,
            self.hall_prev.into(),
            self.hall_gap.into(),
            self.hall_glitches.into(),
            turn.hall.into(),
            turn.age.0,
            turn.interval.0,
            turn.direction.0,
            sum_c.0,
            offset_c.0,
            self.sum_count.into(),
            self.unread.into(),
        ]
    }

    /// Overwrites all state words with those of [`Self::words`]. For verification.
    pub fn set_words(&mut self, words: [i32; Self::NAMES.len()]) {
        let [
            mode,
            fault,
            countdown,
            sum_a,
            sum_b,
            offset_a,
            offset_b,
            stall_count,
            hall_prev,
            hall_gap,
            hall_glitches,
            turn_hall,
            age,
            interval,
            direction,
            sum_c,
            offset_c,
            sum_count,
            unread,
        ] = words;
        *self = Self {
            mode: Mode::from_number(mode),
            fault: Fault::from_number(fault),
            countdown: countdown as u16,
            hall_prev: hall_prev as u8,
            hall_gap: hall_gap as u16,
            hall_glitches: hall_glitches as u16,
            stall_count: Word(stall_count),
            sums: [Word(sum_a), Word(sum_b), Word(sum_c)],
            offsets: [Word(offset_a), Word(offset_b), Word(offset_c)],
            sum_count: sum_count as u16,
            unread: unread as u8,
            turn: Turn {
                hall: turn_hall as u8,
                age: Word(age),
                interval: Word(interval),
                direction: Word(direction),
            },
        };
    }
}
