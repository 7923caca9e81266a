//! Arbitrary states: every state word is set to some value of its proven interval, so that one step
//! covers what streams of plausible inputs would in years.
//!
//! Values come from the whole interval, from its ends, from small numbers, and from the program's
//! own constants and their neighbours, so that comparisons meet equality. Half of the states are
//! moved to an edge: to one side of a jump of the step's result.

use crate::edges::{self, Watched};
use crate::equality::{Comparisons, seek_zero};
use crate::set::Set;
use fastrand::Rng;
use hexagen::{AngleSensor, Limits, Sample, Sensors, Supervisor};
use hexagen_codegen::pipeline::Generated;
use hexagen_lab::{angle, limits, sensors};
use hexagen_reference::{BitTrue, HallCapture, SensedPhases, Spec};

/// The words of the rotor's speed, zero while it is unknown.
const SPEEDS: [&str; 2] = ["omega", "step_angle"];

/// Generator of states and of samples for them.
#[derive(Debug)]
pub struct States<'a> {
    random: Rng,
    names: &'a [&'static str],
    limits: Limits,
    sensors: Sensors,
    sensed: SensedPhases,
    /// Intervals of the state words: the supervisor's, and the law's proven ones.
    ranges: Vec<(i32, i32)>,
    /// Constants of the program, trip level and stall time-out.
    constants: Vec<i32>,
    comparisons: Comparisons,
    /// Least and greatest valid sum of calibration samples of each sensor.
    calibration: Vec<[i64; 2]>,
    count_bits: u32,
    adc_max: i64,
    /// Of each sensor.
    inverted: Vec<bool>,
    /// Of each sensor, its gain over that of the first.
    ratio: Vec<f64>,
    /// Trip level, counts.
    trip: i64,
    codes: [u8; 6],
    age_max: u32,
    /// Ticks of the Hall timer per period.
    ticks: i32,
    timer: bool,
    over_speed_turn: Option<i32>,
    angle: Option<AngleSensor>,
    /// Bus voltage, volt.
    v_bus: f64,
}

impl<'a> States<'a> {
    /// States of a drive: its specification, the generated program, and the names of its state
    /// words.
    pub fn new(spec: &Spec, generated: &Generated, names: &'a [&'static str], seed: u64) -> Self {
        let inverter = &spec.inverter;
        let program = generated.graph.program();
        let (limits, sensors) = (
            limits(&generated.interface.limits),
            sensors(&generated.interface.limits),
        );
        let second = sensors
            .second
            .map_or(limits.offsets, |second| second.offsets);
        let third = sensors.third.map(|third| third.sensor.offsets);
        let offsets: Vec<[u16; 2]> = [limits.offsets, second].into_iter().chain(third).collect();
        let gains = (0..offsets.len()).map(|sensor| inverter.adc_gain.of(sensor));
        let gains: Vec<f64> = gains.collect();
        let words = program.states.iter();
        let words = words.map(|word| (word.interval.low as i32, word.interval.high as i32));
        let constants = program.constants.iter().map(|constant| constant.raw);
        let of_limits = [limits.trip, limits.stall_periods, limits.brake_periods];
        let samples = |count: u16| i64::from(count) << limits.calibration_log2;
        Self {
            random: Rng::with_seed(seed),
            names,
            ranges: supervisor_ranges(&limits, &sensors, &offsets)
                .into_iter()
                .chain(words)
                .collect(),
            constants: constants.chain(of_limits).collect(),
            comparisons: Comparisons::of(program),
            calibration: offsets.iter().map(|ends| ends.map(samples)).collect(),
            count_bits: limits.current_bits,
            adc_max: (1 << inverter.adc_bits) - 1,
            inverted: gains.iter().map(|gain| *gain < 0.0).collect(),
            ratio: gains.iter().map(|gain| (gain / gains[0]).abs()).collect(),
            trip: i64::from(limits.trip) >> limits.current_bits,
            limits,
            sensors,
            sensed: inverter.sensed_phases,
            codes: spec.motor.hall_codes,
            age_max: inverter.age_max,
            ticks: inverter.ticks as i32,
            timer: inverter.hall_capture == HallCapture::Timer,
            over_speed_turn: inverter.over_speed_turn.map(|ticks| ticks as i32),
            angle: angle(&generated.interface.limits),
            v_bus: inverter.v_bus,
        }
    }

    /// Least and greatest value of every state word.
    pub fn ranges(&self) -> &[(i32, i32)] {
        &self.ranges
    }

    /// A set-point, bits of an `I16F16`; `most` is the drive's limit.
    pub fn set_point(&mut self, most: f64) -> i32 {
        match self.random.u8(..8) {
            0 => 0,
            1 => {
                let most = 1 << self.random.u32(..8);
                self.random.i32(-most..=most)
            }
            2 => self.random.i32(..),
            3 => (most as i32).saturating_sub(self.random.i32(-2..=2)),
            _ => ((self.random.f64() * 2.0 - 1.0) * most) as i32,
        }
    }

    /// A bus voltage, ADC counts; mostly one that trips nothing.
    pub fn bus_counts(&mut self) -> u16 {
        let [least, most] = self.limits.bus_counts;
        match self.random.u8(..16) {
            0 => self.random.u16(..),
            1 => {
                let end = if self.random.bool() { least } else { most };
                end.saturating_add_signed(self.random.i16(-1..=1))
            }
            2..=4 => self.random.u16(4090..4100).clamp(least, most),
            // The lowest possible one.
            5..=7 => least,
            _ => self.random.u16(least..=most.min(4095)),
        }
    }

    /// A value from `low` to `high`.
    fn word(&mut self, low: i64, high: i64) -> i64 {
        let value = match self.random.u8(..8) {
            0 => {
                let bits = self.random.u32(..31);
                let small = self.random.i64(0..1 << bits);
                if self.random.bool() { small } else { -small }
            }
            1 => {
                let end = if self.random.bool() { low } else { high };
                end + self.random.i64(-1..=1)
            }
            2 => self.constant(),
            _ => return self.random.i64(low..=high),
        };
        value.clamp(low, high)
    }

    /// A constant of the program (times or over a power of two) or a neighbour of it, of either
    /// sign.
    fn constant(&mut self) -> i64 {
        let index = self.random.usize(..self.constants.len());
        let shift = [0, 0, 1, 8][self.random.usize(..4)];
        let near = (i64::from(self.constants[index]) >> shift) + self.random.i64(-1..=1);
        if self.random.bool() { near } else { -near }
    }

    /// Writes a state; returns a sample for it.
    pub fn fill(&mut self, words: &mut [i32]) -> Sample {
        let mut hall = match self.random.u8(..64) {
            0 => self.limits.hall_inverted,
            1 => self.limits.hall_inverted ^ 7,
            2 => self.codes[self.random.usize(..6)] | 8,
            _ => self.codes[self.random.usize(..6)],
        };
        let hall_ticks = self.age() as u16;
        for (index, word) in words.iter_mut().enumerate() {
            let (low, high) = self.ranges[index];
            let (low, high) = (i64::from(low), i64::from(high));
            *word = match self.names[index] {
                "age_prev" => self.age().clamp(low, high),
                _ => self.word(low, high),
            } as i32;
        }
        // Without an edge the angle goes on.
        if self.random.bool()
            && let Some(place) = self.place("sector_prev")
            && let Some(code) = (words[place] as usize)
                .checked_sub(1)
                .and_then(|sector| self.codes.get(sector))
        {
            hall = *code;
        }
        if self.random.bool()
            && let Some(place) = self.place("hall_prev")
        {
            let (low, high) = self.ranges[place];
            let upright = hall ^ self.limits.hall_inverted;
            words[place] = i32::from(upright).clamp(low, high);
        }
        // Equal or opposite phases put maxima and differences on their ties.
        for index in 0..words.len() {
            if let Some(a) = self.names[index]
                .strip_suffix("_b_prev")
                .or(self.names[index].strip_suffix("_b_cmd"))
                && self.random.u8(..8) == 0
            {
                let suffix = &self.names[index][a.len() + 2..];
                if let Some(other) = self.place(&format!("{a}_a{suffix}")) {
                    let (low, high) = self.ranges[index];
                    let sign = if self.random.bool() { 1 } else { -1 };
                    words[index] = (sign * words[other]).clamp(low, high);
                }
            }
        }
        let is_slow = self.random.u8(..16) == 0;
        let counts = self.fill_currents(words, is_slow);
        let sample = match self.angle {
            None => self.sensed.sample(counts, hall).hall_ticks(hall_ticks),
            Some(_) => self.turned(words, counts),
        };
        if is_slow {
            self.slow_down(words);
        }
        match self.random.u8(..16) {
            0 | 1 => self.take_half_a_turn(words, sample),
            2 => self.end_sector(words),
            3 => self.end_turn(words, sample),
            _ => {}
        }
        self.respect_invariants(words);
        self.end_calibration(words, sample);
        sample
    }

    /// A sample with an angle, mostly about as far from the last one as the rotor turned before.
    fn turned(&mut self, words: &[i32], counts: [u16; 3]) -> Sample {
        let any = self.random.u32(..);
        let places = ["theta_prev", "step_angle"].map(|name| self.place(name));
        let (Some(sensor), [Some(before), Some(step)]) = (self.angle, places) else {
            return self.sensed.sample_with_angle(counts, any);
        };
        let near = match self.random.u8(..4) {
            0 => any as i32,
            1 => self.random.i32(-64..=64),
            _ => words[step].saturating_add((any as i32) >> 8),
        };
        let theta = words[before].wrapping_add(near) as u32;
        let word = f64::from(theta.wrapping_sub(sensor.offset) as i32) / f64::from(sensor.turns);
        self.sensed.sample_with_angle(counts, word as i64 as u32)
    }

    /// A rotor that has been in its sector for about half of its last turn: then it is lost.
    fn take_half_a_turn(&mut self, words: &mut [i32], sample: Sample) {
        let Some(place) = self.place("age_prev") else {
            return;
        };
        let age = if self.timer {
            i32::from(sample.ticks())
        } else {
            words[place].saturating_add(self.ticks)
        };
        // Six equal intervals, the last of which takes the remainder.
        let last = age.saturating_mul(3) - 5 * (age / 2) + self.random.i32(-1..=1);
        self.set_intervals(words, age / 2, last);
    }

    /// A rotor at about the over-speed at the sample's edge, if it has one.
    fn end_turn(&mut self, words: &mut [i32], sample: Sample) {
        let (Some(turn), Some(place)) = (self.over_speed_turn, self.place("age_prev")) else {
            return;
        };
        let each = turn / 6;
        self.set_intervals(words, each, each);
        let age = match i32::from(sample.ticks()) {
            _ if !self.timer => 1,
            ticks if ticks > 2 * self.ticks => 0,
            ticks => ticks,
        };
        let (low, high) = self.ranges[place];
        let interval = turn - 5 * each + self.random.i32(-1..=1);
        words[place] = (interval + age - self.ticks).clamp(low, high);
    }

    /// Five equal intervals, and the oldest one.
    fn set_intervals(&self, words: &mut [i32], each: i32, last: i32) {
        for name in ["t1", "t2", "t3", "t4", "t5", "t6"] {
            if let Some(place) = self.place(name) {
                let (low, high) = self.ranges[place];
                let interval = if name == "t6" { last } else { each };
                words[place] = interval.clamp(low, high);
            }
        }
    }

    /// A rotor whose angle, some ticks later, is at the end of its sector to the last bit.
    fn end_sector(&mut self, words: &mut [i32]) {
        let places = ["age_prev", "omega", "edges"].map(|name| self.place(name));
        let [Some(age_prev), Some(omega), Some(edges)] = places else {
            return;
        };
        let sector = ((1_i64 << 32) / 6) as i32 + self.random.i32(0..=1);
        let ahead = self.random.i32(0..8);
        let most = self.age_max as i32;
        let speed_max = self.ranges[omega].1;
        let age = (0..256)
            .map(|_| self.random.i32(1..=most))
            .find(|age| sector % (age + ahead) == 0 && sector / (age + ahead) <= speed_max);
        if let Some(age) = age {
            words[omega] = sector / (age + ahead);
            words[edges] = 2;
            words[age_prev] = (age - self.ticks).max(0);
            // The last turn was slow enough for the rotor not to be lost.
            for name in ["t1", "t2", "t3", "t4", "t5", "t6"] {
                if let Some(place) = self.place(name) {
                    words[place] = age;
                }
            }
        }
    }

    /// A slow rotor without current: the voltages are those of a small EMF.
    fn slow_down(&mut self, words: &mut [i32]) {
        let bits = self.random.u32(1..24);
        for name in [
            "i_a_prev",
            "i_b_prev",
            "v_a_prev",
            "v_b_prev",
            "net_a_prev",
            "net_b_prev",
        ] {
            if let Some(place) = self.place(name) {
                let small = self.random.i32(-(1 << bits)..=1 << bits);
                let (low, high) = self.ranges[place];
                words[place] = if name.starts_with('i') {
                    0
                } else {
                    small.clamp(low, high)
                };
            }
        }
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| *known == name)
    }

    fn age(&mut self) -> i64 {
        let most = i64::from(self.age_max);
        let age = match self.random.u8(..4) {
            0 => most + self.random.i64(-2..=3),
            1 => {
                let most = 1 << self.random.u32(..8);
                self.random.i64(0..=most)
            }
            2 if self.timer => self.random.i64(0..65_536),
            _ => self.random.i64(0..=most),
        };
        age.clamp(0, 65_535)
    }

    /// Counts for currents of any value, by the offsets; mostly below the trip level. `is_slow`
    /// leaves no current.
    fn fill_currents(&mut self, words: &mut [i32], is_slow: bool) -> [u16; 3] {
        let span = self.adc_max << self.count_bits;
        let trip = (self.trip << self.count_bits) + 1;
        let mut currents = [0; 2];
        for attempt in 0..8 {
            currents = [0; 2].map(|_| match self.random.u8(..4) {
                0 => self.constant().clamp(-span, span),
                1 => 0,
                _ => self.random.i64(-trip..=trip),
            });
            if self.random.u8(..8) == 0 {
                // The third phase gets the selected value.
                currents[1] = (-currents[0] - currents[1]).clamp(-span, span);
            }
            let third = currents[0] + currents[1];
            if third.abs() <= trip || attempt == 0 && self.random.u8(..16) == 0 {
                break;
            }
        }
        if is_slow {
            currents = [0; 2];
        }
        let mut counts = [0; 3];
        let third = -(currents[0] + currents[1]);
        let of_phases = self.sensed.of_phases(currents, third);
        let strayed = if self.random.u8(..8) == 0 {
            self.random.i64(-trip..=trip)
        } else {
            0
        };
        let currents = [currents[0], currents[1], third + strayed];
        let sensors = self.inverted.len();
        for (sensor, name) in ["a", "b", "c"].into_iter().enumerate().take(sensors) {
            let current = (currents[sensor] as f64 / self.ratio[sensor]).round() as i64;
            let current = if self.inverted[sensor] {
                -current
            } else {
                current
            };
            // offset = count 2^bits - current has to lie within its range.
            let place = self.place(&format!("offset_{name}"));
            let (low, high) = place.map_or((0, span), |place| {
                let (low, high) = self.ranges[place];
                (i64::from(low), i64::from(high))
            });
            let unit = 1 << self.count_bits;
            let least = (low + current + unit - 1).div_euclid(unit);
            let least = least.clamp(0, self.adc_max);
            let most = (high + current).div_euclid(unit);
            let count = self.random.i64(least..=most.clamp(least, self.adc_max));
            let offset = ((count << self.count_bits) - current).clamp(low, high);
            if let Some(place) = place {
                words[place] = offset as i32;
            }
            let count = match self.random.u8(..64) {
                0 => self.random.i64(0..65_536),
                1 => self.adc_max + 1,
                2 => self.adc_max,
                _ => count,
            };
            counts[sensor] = count.clamp(0, 65_535) as u16;
            if let Some(place) = self.place(&format!("i_{name}_prev"))
                && self.random.u8(..4) != 0
            {
                let change = match self.random.u8(..4) {
                    0 => self.constant(),
                    1 => self.random.i64(-3..=3),
                    _ => self.random.i64(-trip..=trip) / 8,
                };
                let (low, high) = self.ranges[place];
                let before = (of_phases[sensor] - change).clamp(i64::from(low), i64::from(high));
                words[place] = before as i32;
            }
        }
        counts
    }

    /// Invariants between state words in every reachable state.
    fn respect_invariants(&mut self, words: &mut [i32]) {
        let mut set = |name: &str, value: &dyn Fn(i32) -> i32| {
            if let Some(place) = self.names.iter().position(|known| *known == name) {
                words[place] = value(words[place]);
                return words[place];
            }
            0
        };
        let (mode, countdown) = (self.random.u8(..20), self.random.i32(0..5));
        set("mode", &|_| match mode {
            0..=10 => 0,
            11 | 12 => 1,
            13 => 2,
            14 | 15 => 3,
            16 => 4,
            17 | 18 => 5,
            _ => 6,
        });
        set("countdown", &|word| match countdown {
            0..3 => countdown,
            3 => word,
            _ => 0,
        });
        let forward = self.random.bool();
        set("direction", &|_| if forward { 1 } else { -1 });
        // A sum of calibration has room for the samples to come.
        let samples = i64::from(set("countdown", &|word| word).max(1));
        let room = samples.saturating_mul(self.adc_max);
        for name in ["sum_a", "sum_b", "sum_c"] {
            let place = self.names.iter().position(|known| *known == name);
            let most = place.map_or(0, |place| i64::from(self.ranges[place].1) - room);
            set(name, &|word| word.min(most.max(0) as i32));
        }
        // The speed is zero while it is unknown; the turn is the sum of its intervals.
        let seen = if self.angle.is_some() {
            "angles"
        } else {
            "edges"
        };
        let seen = set(seen, &|word| word);
        for name in SPEEDS {
            set(name, &|word| if seen >= 2 { word } else { 0 });
        }
        let intervals = ["t1", "t2", "t3", "t4", "t5", "t6"].map(|name| set(name, &|word| word));
        set("rev", &|_| intervals.iter().sum());
        // The off leg has no terminal voltage of its own.
        let off = set("off_cmd", &|word| word);
        for (number, name) in ["t_a_cmd", "t_b_cmd", "t_c_cmd"].into_iter().enumerate() {
            set(name, &|word| {
                if off == number as i32 + 1 { 0 } else { word }
            });
        }
    }

    /// The last samples of most calibrations make sums just inside, or just outside, the tolerance.
    fn end_calibration(&mut self, words: &mut [i32], sample: Sample) {
        let places = ["mode", "countdown"].map(|name| self.place(name));
        let [Some(mode), Some(countdown)] = places else {
            return;
        };
        let sums = ["sum_a", "sum_b", "sum_c"].map(|name| self.place(name));
        if words[mode] != 1 || self.random.u8(..4) == 0 {
            return;
        }
        words[countdown] = self.random.i32(0..3);
        let counts = self.sensed.of_sensors(sample.adc());
        for (sensor, place) in sums.into_iter().enumerate().take(self.calibration.len()) {
            let ([least, most], count) = (self.calibration[sensor], counts[sensor]);
            let sum = match self.random.u8(..8) {
                0 => least + self.random.i64(-1..=1),
                1 => most + self.random.i64(-1..=1),
                _ => self.random.i64(least..=most),
            };
            if let Some(place) = place {
                let (low, high) = self.ranges[place];
                let before = sum - i64::from(count);
                words[place] = before.clamp(low.into(), high.into()) as i32;
            }
        }
    }

    /// Whether a word has many values that the invariants leave free.
    fn is_free(&self, index: usize, word: i32) -> bool {
        let (least, most) = self.ranges[index];
        let name = self.names[index];
        let bound = [
            "sum_a",
            "sum_c",
            "sum_b",
            "countdown",
            "t1",
            "t2",
            "t3",
            "t4",
            "t5",
            "t6",
            "rev",
        ];
        // These are zero without information.
        let is_zero = word == 0 && (SPEEDS.contains(&name) || name.starts_with("t_"));
        i64::from(most) - i64::from(least) >= 1 << 10 && !bound.contains(&name) && !is_zero
    }

    fn free(&self, words: &[i32]) -> Vec<usize> {
        let is_free = |&index: &usize| self.is_free(index, words[index]);
        (0..words.len()).filter(is_free).collect()
    }

    /// Moves up to three words to where a comparison of the program meets equality, or next to it.
    /// The set-point counts as a word.
    fn seek_equality(&mut self, words: &mut [i32], sample: Sample, (set, most): (&mut Set, i32)) {
        if self.comparisons.is_empty() {
            return;
        }
        let comparison = self.random.usize(..self.comparisons.len());
        let mut free = self.free(words);
        free.push(words.len());
        let mut probe = self
            .comparisons
            .probe((self.limits, self.sensors), sample, *set);
        let mut all = [&[set.bits], &*words].concat();
        for _ in 0..3 {
            // The set-point is before the words of the state.
            let state = free[self.random.usize(..free.len())];
            let (place, (least, greatest)) = match self.ranges.get(state) {
                Some(range) => (state + 1, *range),
                None => (0, (-most, most)),
            };
            let mut moved = all.clone();
            let found = seek_zero(all[place], (least, greatest), |word| {
                moved[place] = word;
                probe.difference(comparison, &moved)
            });
            all[place] = found.unwrap_or(all[place]);
            if probe.difference(comparison, &all) == Some(0) {
                if self.random.u8(..4) == 0 {
                    all[place] = (all[place] + self.random.i32(-1..=1)).clamp(least, greatest);
                }
                break;
            }
        }
        set.bits = all[0];
        words.copy_from_slice(&all[1..]);
    }

    /// Moves half of the states to an edge: a quarter to where a comparison meets equality, and one
    /// word of another quarter to either side of a jump of the observed result.
    pub fn seek_edge(
        &mut self,
        model: &mut BitTrue,
        words: &mut [i32],
        sample: Sample,
        set_point: (&mut Set, i32),
    ) {
        match self.random.u8(..4) {
            0 | 1 => return,
            2 => return self.seek_equality(words, sample, set_point),
            _ => {}
        }
        let free = self.free(words);
        let mut index = free[self.random.usize(..free.len())];
        let watched = match self.random.u8(..10) {
            0..=2 => Watched::Compare(self.random.usize(..3)),
            3 => Watched::Reach,
            4 => Watched::Torque,
            5 | 6 => {
                // Only a known speed moves the sector away from that of the Hall code.
                let speed = SPEEDS[self.random.usize(..2)];
                let place = free.iter().find(|&&index| self.names[index] == speed);
                index = *place.unwrap_or(&index);
                Watched::Sector
            }
            7 => Watched::Corner { v_bus: self.v_bus },
            8 => Watched::Word(self.random.usize(..words.len())),
            _ => Watched::All,
        };
        let (least, most) = self.ranges[index];
        let ends = [words[index], self.word(least.into(), most.into()) as i32];
        let upper_side = self.random.bool();
        words[index] = edges::seek(ends, upper_side, |word| {
            words[index] = word;
            watched.measure(model, words, &sample)
        });
        if self.random.u8(..4) == 0 {
            let bits = self.random.u32(..20);
            let way = self.random.i32(-(1 << bits)..=1 << bits);
            words[index] = words[index].saturating_add(way).clamp(least, most);
        }
    }
}

/// Least and greatest value of each of the supervisor's words.
fn supervisor_ranges(
    limits: &Limits,
    sensors: &Sensors,
    offsets: &[[u16; 2]],
) -> [(i32, i32); Supervisor::NAMES.len()] {
    let samples = 1 << limits.calibration_log2;
    let full = i32::from(limits.adc_max) << limits.calibration_log2;
    let longest = limits.precharge_periods.max(limits.start_periods).into();
    let word = |offset: u16| i32::from(offset) << limits.current_bits;
    let ends = |sensor: usize| {
        let [least, most] = offsets[sensor];
        (word(least), word(most))
    };
    let third = sensors.third;
    Supervisor::NAMES.map(|name| match name {
        "mode" | "turn_hall" => (0, 6),
        "fault" => (0, 10),
        "countdown" => (0, samples.max(longest)),
        "sum_a" | "sum_b" => (0, full),
        "offset_a" => ends(0),
        "offset_b" => ends(1),
        "sum_c" if third.is_some() => (0, full),
        "offset_c" if third.is_some() => ends(2),
        "sum_count" => (0, third.map_or(0, |third| third.sum_samples.into())),
        "unread" => match third.filter(|third| third.readable.is_some()) {
            Some(third) => (0, if third.is_delayed { 15 } else { 3 }),
            None => (0, 0),
        },
        "stall_count" => (0, limits.stall_periods),
        "hall_prev" if limits.stall_periods > 0 || limits.hall_glitches > 0 => (0, 6),
        "hall_gap" => (0, limits.hall_glitches.into()),
        "hall_glitches" if limits.hall_glitches > 0 => (0, 0x7fff),
        "hall_prev" | "hall_glitches" | "sum_c" | "offset_c" => (0, 0),
        "turn_age" | "turn_interval" => (0, limits.brake_periods),
        "turn_direction" => (-1, 1),
        other => unreachable!("a word that no supervisor has: {other}"),
    })
}
