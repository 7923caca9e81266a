//! Supervision of a drive: which samples are fit to control by, faults, start-up. One code for all
//! drives; what differs between them is in [`Limits`].

#[cfg(test)]
mod tests;

use crate::arith::Word;
use crate::status::{Fault, Mode, Status, number};
use crate::{Checked, LegState, Sample};

/// What a drive's samples are judged by, and how it starts up.
///
/// Words of current are ADC counts with [`current_bits`](Self::current_bits) fraction bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest count of the current ADC.
    pub adc_max: u16,
    /// Whether counts fall with the current into the motor.
    pub adc_inverted: bool,
    /// Fraction bits of currents.
    pub current_bits: u32,
    /// ADC count at zero current, where calibration has not told another.
    pub offset: u16,
    /// Least and greatest offset that calibration accepts, counts.
    pub offsets: [u16; 2],
    /// Largest phase current, words of current: one above it trips.
    pub trip: i32,
    /// Least and greatest current of any count at any accepted offset, words of current.
    pub currents: [i32; 2],
    /// Base-2 logarithm of the samples of a calibration.
    pub calibration_log2: u32,
    /// Control periods of bootstrap pre-charge; 0 where there is none.
    pub precharge_periods: u16,
    /// Control periods without a Hall edge under demand that count as a stall; 0 where none are
    /// counted.
    pub stall_periods: i32,
}

impl Limits {
    /// Whether sums and words of these limits fit 32 bits and [`currents`](Self::currents) holds
    /// every current, so that nothing the supervisor computes can overflow.
    #[must_use]
    pub const fn hold(&self) -> bool {
        let [least, most] = self.offsets;
        let one = 1_i64 << (self.current_bits & 31);
        let (top, zero) = (self.adc_max as i64 * one, 0);
        let (low, high) = (least as i64 * one, most as i64 * one);
        let range = if self.adc_inverted {
            [low - top, high - zero]
        } else {
            [zero - high, top - low]
        };
        let sum = (self.adc_max as i64) << (self.calibration_log2 & 15);
        // Phase c is the negative sum of two currents.
        let word = 0x7fff_ffff;
        self.current_bits < 31
            && self.calibration_log2 < 16
            && self.adc_max > 1
            && least <= self.offset
            && self.offset <= most
            && most <= self.adc_max
            && self.trip > 0
            && self.stall_periods >= 0
            && self.stall_periods < word as i32
            && range[0] == self.currents[0] as i64
            && range[1] == self.currents[1] as i64
            && -2 * range[0] <= word
            && 2 * range[1] <= word
            && sum <= word
    }

    /// A phase current in words of current: `count` less `offset`, a word of current.
    #[inline]
    fn current(&self, count: Word, offset: Word) -> Word {
        let count = count << self.current_bits;
        if self.adc_inverted {
            offset - count
        } else {
            count - offset
        }
    }

    /// Whether an ADC is at an end of its range: count 0, the largest, or more.
    #[inline]
    fn is_at_end(&self, count: u16) -> bool {
        count == 0 || count >= self.adc_max
    }

    /// Whether a phase current is above the trip level.
    #[inline]
    fn is_over(&self, [i_a, i_b]: [Word; 2]) -> bool {
        let i_c = -(i_a + i_b);
        let range = self.trip.wrapping_neg()..=self.trip;
        let is_within = |i: Word| range.contains(&i.0);
        !(is_within(i_a) && is_within(i_b) && is_within(i_c))
    }
}

/// Whether three Hall sensors can give the code: 001 to 110.
#[inline]
const fn is_hall_code(hall: u8) -> bool {
    matches!(hall, 1..=6)
}

/// The supervisor of a drive: its mode, its first fault, the offsets of its current ADCs.
///
/// Each control period is either [`check`](Self::check)ed, and then controlled, or goes by
/// [`rest`](Self::rest).
///
/// # Start-up
///
/// A new drive runs: its first period controls currents, at set-point 0, with nominal current
/// offsets and nothing charged. Where offsets or the bootstrap capacitors of the inverter need it,
/// calibration comes first. Then follow by themselves:
///
/// 1. Calibration: periods with all legs off, whose ADC counts are averaged. The motor rests
///    meanwhile. An offset too far from its nominal value trips the drive.
/// 2. Pre-charge, where the specification has one: periods with all lower switches on, which
///    charge the bootstrap capacitors, and short-circuit a motor that turns.
/// 3. Control, at the set-point that stands.
///
/// A fault ends start-up, and what it had gathered counts for nothing; a reset leads to control, not
/// back into start-up.
///
/// # Safe states
///
/// Each [`Fault`] turns all legs off until a reset. A Hall code that skips sectors is no fault: it is
/// taken as it reads. Nor is any bus voltage.
///
/// # What the supervisor cannot see
///
/// It trips on what samples show: a current above the trip level, a current ADC at an end of its
/// range, an invalid Hall code, and where told to, a rotor that stands. It cannot see, and nothing
/// else here does:
///
/// - a current ADC or amplifier that is stuck or wrong within its range: one that is frozen at
///   mid-scale can let the true current rise to several times the trip level;
/// - the current of phase c, which has no sensor: it is taken as -(a + b);
/// - a control interrupt that does not come: the last command stands;
/// - heat, shoot-through, and what is shorter than a control period;
/// - a bus voltage, be it too high for the switches.
///
/// So the board must have (a) a comparator of the current on the timer's break input, (b) a watchdog
/// on the control interrupt and (c) a thermal limit; where the motor can brake, a limit of the bus
/// voltage, too.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Supervisor {
    mode: Mode,
    fault: Option<Fault>,
    /// Periods left in calibration or pre-charge.
    countdown: u16,
    /// Hall code of the last sample that had one, where a stall is watched for; 0 before the first.
    hall_prev: u8,
    /// Periods without a Hall edge under demand.
    stall_count: Word,
    /// Sums of calibration samples, counts.
    sums: [Word; 2],
    /// Offsets of phases a and b, words of current.
    offsets: [Word; 2],
}

impl Supervisor {
    /// Names of its words, in the order of [`Self::words`].
    pub const NAMES: [&'static str; 9] = [
        "mode",
        "fault",
        "countdown",
        "sum_a",
        "sum_b",
        "offset_a",
        "offset_b",
        "stall_count",
        "hall_prev",
    ];

    /// The supervisor of a drive that controls currents from its first period on, with nominal
    /// offsets.
    #[must_use]
    pub const fn new(limits: &Limits) -> Self {
        let offset = Word((limits.offset as i32).wrapping_shl(limits.current_bits));
        Self {
            mode: Mode::Run,
            fault: None,
            countdown: 0,
            hall_prev: 0,
            stall_count: Word(0),
            sums: [Word(0); 2],
            offsets: [offset; 2],
        }
    }

    /// The sample for a controlled period; none where the drive rests in this period: it is
    /// starting up or tripped, or the sample has a fault. Then [`rest`](Self::rest) is to be called
    /// with the same sample. `is_demanded` says whether the set-point is not 0.
    #[inline]
    #[must_use]
    pub fn check(
        &mut self,
        limits: &Limits,
        sample: &Sample,
        is_demanded: impl FnOnce() -> bool,
    ) -> Option<Checked> {
        let [adc_a, adc_b, _] = sample.adc;
        let [offset_a, offset_b] = self.offsets;
        let i = [
            limits.current(adc_a.into(), offset_a),
            limits.current(adc_b.into(), offset_b),
        ];
        let stalled = self.watch_stall(limits, sample.hall, is_demanded);
        let is_fit = self.mode == Mode::Run
            && !limits.is_at_end(adc_a)
            && !limits.is_at_end(adc_b)
            && is_hall_code(sample.hall)
            && !limits.is_over(i)
            && !stalled;
        is_fit.then(|| Checked {
            i,
            hall: sample.hall.into(),
            hall_ticks: sample.hall_ticks.into(),
        })
    }

    /// Counts periods without a Hall edge under demand; true where they are a stall.
    #[inline]
    fn watch_stall(
        &mut self,
        limits: &Limits,
        hall: u8,
        is_demanded: impl FnOnce() -> bool,
    ) -> bool {
        if limits.stall_periods == 0 {
            return false;
        }
        let hall = if is_hall_code(hall) {
            hall
        } else {
            self.hall_prev
        };
        let is_edge = hall != self.hall_prev && self.hall_prev != 0;
        self.hall_prev = hall;
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

    /// A period without control, behind a [`check`](Self::check) that gave no sample: goes on with
    /// start-up, trips where there is a fault, and says what all legs do. The sample has its counts
    /// held within the ADC's range, and no Hall code where there was none.
    pub fn rest(&mut self, limits: &Limits, sample: &Sample) -> (Checked, LegState) {
        let [adc_a, adc_b, _] = sample.adc;
        let counts = [adc_a, adc_b].map(|count| Word::from(count).min(limits.adc_max));
        let [count_a, count_b] = counts;
        let [offset_a, offset_b] = self.offsets;
        let has_code = is_hall_code(sample.hall);
        let checked = Checked {
            i: [
                limits.current(count_a, offset_a),
                limits.current(count_b, offset_b),
            ],
            hall: if has_code {
                sample.hall.into()
            } else {
                Word(0)
            },
            hall_ticks: sample.hall_ticks.into(),
        };
        let found = if limits.is_at_end(adc_a) || limits.is_at_end(adc_b) {
            Some(Fault::AdcRange)
        } else if !has_code {
            Some(Fault::Hall)
        } else if limits.is_over(checked.i) {
            Some(Fault::OverCurrent)
        } else if self.is_stalled(limits) {
            Some(Fault::Stall)
        } else {
            None
        };
        let leg = if self.mode == Mode::Precharge && found.is_none() {
            LegState::Low
        } else {
            LegState::Off
        };
        match found {
            Some(fault) => self.trip(fault),
            None => self.start_up(limits, counts),
        }
        (checked, leg)
    }

    /// Calibration averages the counts of all its samples, then pre-charge counts its periods down.
    fn start_up(&mut self, limits: &Limits, [count_a, count_b]: [Word; 2]) {
        match self.mode {
            Mode::Run | Mode::Tripped => {}
            Mode::Calibrate => {
                let most = Word::from(limits.adc_max) << limits.calibration_log2;
                let [sum_a, sum_b] = self.sums;
                // The countdown ends the sums before this limit, whatever state they began in.
                self.sums = [(sum_a + count_a).min(most), (sum_b + count_b).min(most)];
                self.countdown = self.countdown.saturating_sub(1);
                if self.countdown == 0 {
                    self.end_calibration(limits);
                }
            }
            Mode::Precharge => {
                self.countdown = self.countdown.saturating_sub(1);
                if self.countdown == 0 {
                    self.mode = Mode::Run;
                }
            }
        }
    }

    fn end_calibration(&mut self, limits: &Limits) {
        let [least, most] = limits
            .offsets
            .map(|offset| Word::from(offset) << limits.calibration_log2);
        let is_bad = |sum: Word| sum < least || sum > most;
        let [sum_a, sum_b] = self.sums;
        if is_bad(sum_a) || is_bad(sum_b) {
            self.trip(Fault::Offset);
            return;
        }
        // The mean in words of current, rounded down.
        let (bits, log2) = (limits.current_bits, limits.calibration_log2);
        self.offsets = self.sums.map(|sum| {
            if bits >= log2 {
                sum << (bits - log2)
            } else {
                sum >> (log2 - bits)
            }
        });
        self.countdown = limits.precharge_periods;
        self.mode = match limits.precharge_periods {
            0 => Mode::Run,
            _ => Mode::Precharge,
        };
    }

    /// Turns all legs off until a reset. The first cause stays.
    fn trip(&mut self, fault: Fault) {
        if self.mode != Mode::Tripped {
            self.fault = Some(fault);
        }
        self.mode = Mode::Tripped;
    }

    /// Clears a trip; keeps calibrated offsets. What follows is control, not start-up. False, and nothing done, while calibrating and
    /// pre-charging.
    pub fn reset(&mut self, limits: &Limits) -> bool {
        let may_reset = matches!(self.mode, Mode::Run | Mode::Tripped);
        if may_reset {
            *self = Self {
                offsets: self.offsets,
                ..Self::new(limits)
            };
        }
        may_reset
    }

    /// Starts calibration; ignored when tripped.
    pub fn calibrate(&mut self, limits: &Limits) {
        if self.mode != Mode::Tripped {
            self.mode = Mode::Calibrate;
            self.countdown = 1_u16.wrapping_shl(limits.calibration_log2);
            self.sums = [Word(0); 2];
        }
    }

    /// Starts pre-charge; ignored when tripped, while calibrating, and where there is none.
    pub fn precharge(&mut self, limits: &Limits) {
        if matches!(self.mode, Mode::Run | Mode::Precharge) && limits.precharge_periods != 0 {
            self.mode = Mode::Precharge;
            self.countdown = limits.precharge_periods;
        }
    }

    /// What the drive is doing, and what tripped it.
    #[inline]
    #[must_use]
    pub const fn status(&self) -> Status {
        Status::from_bits(self.status_bits(), false)
    }

    #[inline]
    pub(crate) const fn status_bits(&self) -> i32 {
        Status::to_bits(self.mode, self.fault)
    }

    /// Its words, in the order of [`Self::NAMES`]. For verification.
    #[must_use]
    pub fn words(&self) -> [i32; Self::NAMES.len()] {
        let [sum_a, sum_b] = self.sums;
        let [offset_a, offset_b] = self.offsets;
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
        ]
    }

    /// Overwrites all words with those of [`Self::words`]. For verification.
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
        ] = words;
        *self = Self {
            mode: Mode::from_number(mode),
            fault: Fault::from_number(fault),
            countdown: countdown as u16,
            hall_prev: hall_prev as u8,
            stall_count: Word(stall_count),
            sums: [Word(sum_a), Word(sum_b)],
            offsets: [Word(offset_a), Word(offset_b)],
        };
    }
}
