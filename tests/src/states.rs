//! The bit-for-bit test from arbitrary states: every state word is set to some value of its proven
//! interval, so that one step reaches what streams of plausible inputs reach in years.
//!
//! Values come from the whole interval, from its ends, from small numbers, and from the program's
//! own constants and their neighbours, so that comparisons are met at equality.

use fastrand::Rng;
use hexagen::{Format, Sample};
use hexagen_codegen::ir::Program;
use hexagen_reference::verify::Subject;
use hexagen_reference::{BitTrue, Bus, FormatTable, HallCapture, Spec};
use std::fmt::Write as _;

/// Steps from one arbitrary state, the first of which is the one that matters.
const STEPS_PER_STATE: u64 = 2;

/// What a state can be, as data that also a compiled test can hold.
#[derive(Clone, Copy, Debug)]
pub struct Space<'a> {
    /// Proven intervals of the state words, in order.
    pub ranges: &'a [(i32, i32)],
    /// Constants of the program.
    pub constants: &'a [i32],
}

/// The proven intervals of the state words.
pub fn ranges(program: &Program) -> Vec<(i32, i32)> {
    let words = program.states.iter();
    words
        .map(|word| (word.interval.low as i32, word.interval.high as i32))
        .collect()
}

/// The values of the constants.
pub fn constants(program: &Program) -> Vec<i32> {
    program
        .constants
        .iter()
        .map(|constant| constant.raw)
        .collect()
}

/// Compares subject and model over `steps` steps from arbitrary states.
///
/// # Errors
/// What differs.
pub fn verify_states<S: Subject>(
    spec: &str,
    formats: &[Format],
    space: Space<'_>,
    mut subject: S,
    steps: u64,
    seed: u64,
) -> Result<(), String> {
    let spec = Spec::from_toml(spec).map_err(|error| error.to_string())?;
    let formats = FormatTable::new(formats);
    let mut model = BitTrue::new(&spec, &formats).map_err(|error| error.to_string())?;
    let names = model.state_names();
    let count_bits = formats
        .frac_bits("current")
        .map_err(|error| error.to_string())?;
    let mut states = States {
        random: Rng::with_seed(seed),
        names: &names,
        space,
        count_bits,
        adc_max: (1 << spec.inverter.adc_bits) - 1,
        inverted: spec.inverter.adc_gain < 0.0,
        trip: (spec.inverter.trip_current / spec.inverter.adc_gain.abs()) as i64,
        codes: spec.motor.hall_codes,
        age_max: spec.inverter.age_max,
        timer: spec.inverter.hall_capture == HallCapture::Timer,
    };
    let mut words = vec![0; names.len()];
    let (mut found, mut expected) = (words.clone(), words.clone());
    for step in 0..steps.div_ceil(STEPS_PER_STATE) {
        if step % 4 == 0 {
            let bits = states.set_point(spec.inverter.max_current * 65_536.0);
            model.set_current(bits);
            subject.set_current(bits);
        } else if step % 4 == 2 {
            let most = spec.inverter.max_current * spec.motor.torque_constant * 65_536.0;
            let bits = states.set_point(most);
            model.set_torque(bits);
            subject.set_torque(bits);
        }
        if spec.inverter.bus == Bus::Measured {
            let counts = states.bus_counts();
            model.set_bus(counts);
            subject.set_bus(counts);
        }
        let mut sample = states.fill(&mut words);
        model.set_state_words(&words);
        subject.set_state_words(&words);
        for _ in 0..STEPS_PER_STATE {
            let (legs, wanted) = (subject.step(&sample), model.step(&sample));
            subject.state_words(&mut found);
            model.state_words(&mut expected);
            if legs != wanted || found != expected || subject.fault() != model.fault() {
                let mut text = format!(
                    "state {step} of seed {seed}, {sample:?}\n  {legs:?}\n  {wanted:?} (model)\n"
                );
                for (index, name) in names.iter().enumerate() {
                    let mark = if found[index] == expected[index] {
                        ""
                    } else {
                        "  <--"
                    };
                    let (from, is, should) = (words[index], found[index], expected[index]);
                    writeln!(text, "  {name:<16} {from:>12} {is:>12} {should:>12}{mark}")
                        .expect("a string takes all");
                }
                return Err(text);
            }
            words.copy_from_slice(&expected);
            sample.hall_ticks = sample.hall_ticks.saturating_add(1);
        }
    }
    Ok(())
}

/// Generator of states and of the samples that go with them.
struct States<'a> {
    random: Rng,
    names: &'a [&'static str],
    space: Space<'a>,
    count_bits: u32,
    adc_max: i64,
    inverted: bool,
    /// Trip level, counts.
    trip: i64,
    codes: [u8; 6],
    age_max: u32,
    timer: bool,
}

impl States<'_> {
    fn set_point(&mut self, most: f64) -> i32 {
        match self.random.u8(..8) {
            0 => 0,
            1 => self.random.i32(-3..=3),
            2 => self.random.i32(..),
            3 => most as i32 - self.random.i32(-2..=2),
            _ => ((self.random.f64() * 2.0 - 1.0) * most) as i32,
        }
    }

    fn bus_counts(&mut self) -> u16 {
        match self.random.u8(..4) {
            0 => self.random.u16(..),
            1 => self.random.u16(4090..4100),
            _ => self.random.u16(..4096),
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

    /// A constant of the program or a neighbour of it, of either sign.
    fn constant(&mut self) -> i64 {
        let index = self.random.usize(..self.space.constants.len());
        let near = i64::from(self.space.constants[index]) + self.random.i64(-1..=1);
        if self.random.bool() { near } else { -near }
    }

    /// Fills in a state; returns a sample for it.
    fn fill(&mut self, words: &mut [i32]) -> Sample {
        let mut sample = Sample {
            hall: match self.random.u8(..64) {
                0 => 0,
                1 => 7,
                _ => self.codes[self.random.usize(..6)] | (self.random.u8(..2) << 3),
            },
            hall_ticks: self.age() as u16,
            ..Sample::default()
        };
        for (index, word) in words.iter_mut().enumerate() {
            let (low, high) = self.space.ranges[index];
            *word = self.word(i64::from(low), i64::from(high)) as i32;
        }
        // Phases that are equal or opposite put maxima and differences on their ties.
        for index in 0..words.len() {
            if let Some(a) = self.names[index]
                .strip_suffix("_b_prev")
                .or(self.names[index].strip_suffix("_b_cmd"))
                && self.random.u8(..8) == 0
            {
                let suffix = &self.names[index][a.len() + 2..];
                if let Some(other) = self.place(&format!("{a}_a{suffix}")) {
                    let (low, high) = self.space.ranges[index];
                    let sign = if self.random.bool() { 1 } else { -1 };
                    words[index] = (sign * words[other]).clamp(low, high);
                }
            }
        }
        self.fill_currents(words, &mut sample);
        self.respect_invariants(words);
        sample
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| *known == name)
    }

    fn age(&mut self) -> i64 {
        let most = i64::from(self.age_max);
        let age = match self.random.u8(..4) {
            0 => most + self.random.i64(-2..=3),
            1 => self.random.i64(0..4),
            2 if self.timer => self.random.i64(0..65_536),
            _ => self.random.i64(0..=most),
        };
        age.clamp(0, 65_535)
    }

    /// Currents of any value, by the offsets; most of them below the trip level.
    fn fill_currents(&mut self, words: &mut [i32], sample: &mut Sample) {
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
                // The third phase gets the interesting value.
                currents[1] = (-currents[0] - currents[1]).clamp(-span, span);
            }
            let third = currents[0] + currents[1];
            if third.abs() <= trip || attempt == 0 && self.random.u8(..16) == 0 {
                break;
            }
        }
        for (phase, name) in ["a", "b"].into_iter().enumerate() {
            let current = if self.inverted {
                -currents[phase]
            } else {
                currents[phase]
            };
            // offset = count 2^bits - current has to lie within the span.
            let unit = 1 << self.count_bits;
            let least = (current.max(0) + unit - 1).div_euclid(unit);
            let most = (span + current.min(0)).div_euclid(unit).max(least);
            let count = self.random.i64(least..=most).min(self.adc_max);
            let offset = ((count << self.count_bits) - current).clamp(0, span);
            if let Some(place) = self.place(&format!("offset_{name}")) {
                words[place] = offset as i32;
            }
            let count = match self.random.u8(..64) {
                0 => self.random.i64(0..65_536),
                1 => self.adc_max + 1,
                _ => count,
            };
            let count = count.clamp(0, 65_535) as u16;
            *(if phase == 0 {
                &mut sample.adc_a
            } else {
                &mut sample.adc_b
            }) = count;
            if let Some(place) = self.place(&format!("i_{name}_prev"))
                && self.random.u8(..4) != 0
            {
                let change = match self.random.u8(..4) {
                    0 => self.constant(),
                    1 => self.random.i64(-3..=3),
                    _ => self.random.i64(-trip..=trip) / 8,
                };
                let (low, high) = self.space.ranges[place];
                let before = (currents[phase] - change).clamp(i64::from(low), i64::from(high));
                words[place] = before as i32;
            }
        }
    }

    /// What holds between state words in every state that a drive can be in.
    fn respect_invariants(&mut self, words: &mut [i32]) {
        let mut set = |name: &str, value: &dyn Fn(i32) -> i32| {
            if let Some(place) = self.names.iter().position(|known| *known == name) {
                words[place] = value(words[place]);
                return words[place];
            }
            0
        };
        let (mode, countdown) = (self.random.u8(..16), self.random.i32(0..4));
        set("mode", &|_| match mode {
            0..=11 => 0,
            12 | 13 => 1,
            14 => 2,
            _ => 3,
        });
        set("countdown", &|word| {
            if countdown < 3 { countdown } else { word }
        });
        let forward = self.random.bool();
        set("direction", &|_| if forward { 1 } else { -1 });
        // A sum of calibration has room for the samples to come.
        for name in ["sum_a", "sum_b"] {
            let most = self.names.iter().position(|known| *known == name);
            let most = most.map_or(0, |place| {
                i64::from(self.space.ranges[place].1) - STEPS_PER_STATE as i64 * self.adc_max
            });
            set(name, &|word| word.min(most.max(0) as i32));
        }
        // The speed is zero while it is unknown; the turn is the sum of its intervals.
        let edges = set("edges", &|word| word);
        set("omega", &|word| if edges == 2 { word } else { 0 });
        let intervals = ["t1", "t2", "t3", "t4", "t5", "t6"].map(|name| set(name, &|word| word));
        set("rev", &|_| intervals.iter().sum());
        // The leg that is off has no terminal voltage of its own.
        let off = set("off_cmd", &|word| word);
        for (number, name) in ["t_a_cmd", "t_b_cmd", "t_c_cmd"].into_iter().enumerate() {
            set(name, &|word| {
                if off == number as i32 + 1 { 0 } else { word }
            });
        }
    }
}
