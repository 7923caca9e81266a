//! Faults, start-up sequence and the safe command (semantics, steps 3 and 12).

use super::Lowering;
use super::measure::{Currents, Hall, Sample};
use super::modulate::Command;
use crate::diagnostics::engineering;
use crate::ir::{Comparison, Interval, StateId, Value};

/// Operating modes as the state word `mode` holds them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Mode {
    /// The current loop runs.
    Run = 0,
    /// Offset calibration: legs off.
    Calibrate = 1,
    /// Bootstrap pre-charge: legs low.
    Precharge = 2,
    /// Tripped: legs off until reset.
    Tripped = 3,
}

/// State words of the supervisor, present in every controller.
#[derive(Clone, Copy, Debug)]
pub struct SupervisorWords {
    mode: StateId,
    fault: StateId,
    countdown: StateId,
    sums: [StateId; 2],
    /// Offsets of the current converters.
    pub offsets: [StateId; 2],
    /// Sector of the last sample, where anything follows the edges.
    pub sector_prev: Option<StateId>,
    stall_count: Option<StateId>,
}

/// Whether the drive rests in this period, and what decides its command then.
#[derive(Clone, Copy, Debug)]
pub struct Rest {
    /// Flag: no current is controlled.
    pub flag: Value,
    /// Mode at the start of the period.
    mode: Value,
    /// Flag: something forbids to drive the motor.
    faulty: Value,
}

impl Lowering<'_> {
    /// Declares the supervisor's state words; `follows_edges` is whether the rest of the step does.
    pub fn supervisor_words(&mut self, follows_edges: bool) -> SupervisorWords {
        let inverter = self.spec.inverter.clone();
        let top = i64::from((1_u32 << inverter.adc_bits) - 1);
        let offset = (i64::from(inverter.adc_offset) << self.scale.current_bits) as i32;
        let offset_range = self.offset_range();
        let sum_range = Interval::new(0, top << inverter.calibration_log2);
        let watches_stall = inverter.stall_periods > 0;
        SupervisorWords {
            mode: self.state("mode", 0, Interval::new(0, 3), "0 run, 1 calibrate, 2 pre-charge, 3 tripped."),
            fault: self.state("fault", 0, Interval::new(0, 5), "What tripped the drive: 0 nothing, 1 ADC range, 2 over-current, 3 Hall code, 4 stall, 5 current offset."),
            countdown: self.state("countdown", 0, Interval::new(0, i64::from(u16::MAX)), "Periods left in calibration or pre-charge."),
            sums: ["sum_a", "sum_b"].map(|name| self.state(name, 0, sum_range, "Sum of calibration samples, ADC counts.")),
            offsets: ["offset_a", "offset_b"].map(|name| self.state(name, offset, offset_range, "Offset at zero current, words of current.")),
            sector_prev: (follows_edges || watches_stall).then(|| {
                self.state("sector_prev", 0, Interval::new(0, 6), "Sector of the last sample; 0 before the first.")
            }),
            stall_count: watches_stall.then(|| {
                self.state("stall_count", 0, Interval::new(0, i64::from(inverter.stall_periods)), "Periods without a Hall edge under current demand.")
            }),
        }
    }

    /// Detects faults and advances the start-up sequence; says whether the drive rests in this period.
    pub fn supervise(
        &mut self,
        words: SupervisorWords,
        sample: &Sample,
        currents: &Currents,
        hall: Option<&Hall>,
        set_point: Value,
    ) -> Rest {
        self.b.stage("detect_faults", &[
            "Whether anything forbids to drive the motor, and whether the start-up sequence is running. Under an invalid Hall code",
            "any current is above the trip level.",
        ]);
        let mode = self.b.state(words.mode);
        let level = self.trip_level(sample);
        // Phase c is told by its negative.
        let [i_a, i_b, _] = currents.phases;
        let sum = self.b.add(i_a, i_b);
        self.b.name("i_sum", sum);
        let [a, b, c] = [i_a, i_b, sum].map(|current| {
            let above = self.b.compare(Comparison::Less, level, current);
            let low = self.b.neg(level);
            let below = self.b.compare(Comparison::Less, current, low);
            self.b.or(above, below)
        });
        let pair = self.b.or(a, b);
        let exceeds = self.b.or(pair, c);
        let over_current = self.b.or(exceeds, sample.no_hall);
        self.b.name("over_current", over_current);
        let zero = self.zero();
        let sequencing = self.b.compare(Comparison::NotEqual, mode, zero);
        self.b.name("sequencing", sequencing);
        let mut motor_fault = over_current;
        if let Some((count, hall)) = words.stall_count.zip(hall) {
            let stalled = self.stalled(count, hall, [mode, set_point]);
            motor_fault = self.b.or(over_current, stalled);
            self.b.name("motor_fault", motor_fault);
        }
        // A stage of its own: behind the ones that find the flags, a period that is not left for rest needs none of it.
        self.b.stage(
            "find_rest",
            &["Whether the drive rests: something is wrong, or it is starting up or tripped."],
        );
        let any = match sample.out_of_range {
            Some(out_of_range) => {
                let any = self.b.or(out_of_range, motor_fault);
                self.b.name("faulty", any)
            }
            None => motor_fault,
        };
        let rests = self.b.or(any, sequencing);
        self.b.name("resting", rests);
        let fault = self.b.state(words.fault);
        let sequenced = self.sequence(words, currents, [mode, fault], sequencing);
        self.latch(words, sample, over_current, any, sequenced);
        Rest {
            flag: rests,
            mode,
            faulty: any,
        }
    }

    /// The trip level, by Hall code: an invalid one allows no current.
    fn trip_level(&mut self, sample: &Sample) -> Value {
        let trip = self.ampere_word(self.spec.inverter.trip_current) as i32;
        let sectors = self.hall_sectors();
        let levels = sectors.map(|sector| if sector == 0 { -1 } else { trip });
        let level = engineering(self.spec.inverter.trip_current, "A");
        let levels = self.b.program.column("hall", "trip", levels.to_vec(), &[format!(
            "Trip level of the phase currents: {level}, words of current; -1, which every current is above, for the codes that cannot be."
        )]);
        let level = self.b.lookup(levels, sample.hall);
        self.b.name("i_trip", level)
    }

    fn stalled(
        &mut self,
        stall_count: StateId,
        hall: &Hall,
        [mode, set_point]: [Value; 2],
    ) -> Value {
        let periods = i64::from(self.spec.inverter.stall_periods);
        let doc = "Periods without a Hall edge that count as a stall.";
        let count = self.b.state(stall_count);
        let one = self.b.literal(1);
        let more = self.b.add(count, one);
        let limit = self.number("stall_periods", periods, doc);
        let counted = self.b.min(more, limit);
        let zero = self.zero();
        let idle = self.b.compare(Comparison::Equal, set_point, zero);
        let zero = self.zero();
        let resting = self.b.compare(Comparison::NotEqual, mode, zero);
        let idle = self.b.or(idle, resting);
        let restart = self.b.or(hall.edge, idle);
        let zero = self.zero();
        let count = self.b.select(restart, zero, counted);
        self.b.name("stall_count_now", count);
        self.b.set_state(stall_count, count);
        let limit = self.number("stall_periods", periods, doc);
        let stalled = self.b.compare(Comparison::Equal, count, limit);
        self.b.name("stalled", stalled)
    }

    /// Calibration and pre-charge; returns mode and fault behind them.
    fn sequence(
        &mut self,
        words: SupervisorWords,
        currents: &Currents,
        [mode, fault]: [Value; 2],
        running: Value,
    ) -> [Value; 2] {
        let inverter = self.spec.inverter.clone();
        let countdown = self.b.state(words.countdown);
        let sums = words.sums.map(|sum| self.b.state(sum));
        let offsets = words.offsets.map(|offset| self.b.state(offset));
        self.b.guarded_stage(
            "advance_sequence",
            running,
            true,
            &[
                "Start-up: offset calibration averages the ADC counts with all legs off, pre-charge then holds all",
                "lower switches on; a tripped drive stays tripped. An offset too far from its nominal value trips the drive.",
            ],
        );
        let one = self.b.literal(1);
        let left = self.b.sub(countdown, one);
        let zero = self.zero();
        let left = self.b.max(left, zero);
        self.b.name("countdown_left", left);
        let zero = self.zero();
        let done = self.b.compare(Comparison::Equal, left, zero);
        self.b.name("countdown_done", done);
        let calibrate = self.b.literal(Mode::Calibrate as i32);
        let calibrating = self.b.compare(Comparison::Equal, mode, calibrate);
        self.b.name("calibrating", calibrating);
        let calibrated = self.b.and(calibrating, done);
        self.b.name("calibration_ends", calibrated);
        let top = i64::from((1_u32 << inverter.adc_bits) - 1) << inverter.calibration_log2;
        let new_sums = [0, 1].map(|x| {
            let sum = self.b.add(sums[x], currents.counts[x]);
            // The countdown ends the sum before this limit; it is here for the proof.
            let limit = self.number(
                "calibration_sum_max",
                top,
                "Sum of calibration samples that are all at the ADC's largest count.",
            );
            let sum = self.b.min(sum, limit);
            let sum = self.b.select(calibrating, sum, sums[x]);
            self.b.name(["sum_a_now", "sum_b_now"][x], sum)
        });
        let (bad_offset, good_sums) = self.within_tolerance(new_sums);
        let failed = self.b.and(calibrated, bad_offset);
        self.b.name("calibration_failed", failed);
        let good_offset = self.b.not(bad_offset);
        let calibrated = self.b.and(calibrated, good_offset);
        self.b.name("calibrated", calibrated);
        let new_offsets = [0, 1].map(|x| {
            let sum = good_sums[x];
            let (bits, log2) = (self.scale.current_bits, inverter.calibration_log2);
            let mean = if bits >= log2 {
                self.b.shift_left(sum, bits - log2)
            } else {
                self.b.shift_right(sum, log2 - bits)
            };
            let offset = self.b.select(calibrated, mean, offsets[x]);
            self.b.name(["offset_a_now", "offset_b_now"][x], offset)
        });
        let precharge = self.b.literal(Mode::Precharge as i32);
        let precharging = self.b.compare(Comparison::Equal, mode, precharge);
        self.b.name("precharging", precharging);
        let charged = self.b.and(precharging, done);
        let run = self.b.literal(Mode::Run as i32);
        let next_mode = if inverter.precharge_periods > 0 {
            let uncalibrated = self.b.select(charged, run, mode);
            let after = self.b.literal(Mode::Precharge as i32);
            self.b.select(calibrated, after, uncalibrated)
        } else {
            let ready = self.b.or(calibrated, charged);
            self.b.select(ready, run, mode)
        };
        let tripped = self.b.literal(Mode::Tripped as i32);
        let next_mode = self.b.select(failed, tripped, next_mode);
        self.b.name("mode_advanced", next_mode);
        let bad_offset = self.b.literal(5);
        let next_fault = self.b.select(failed, bad_offset, fault);
        self.b.name("fault_advanced", next_fault);
        let periods = self.number(
            "precharge_periods",
            i64::from(inverter.precharge_periods),
            "Periods of bootstrap pre-charge.",
        );
        let timed = self.b.or(calibrating, precharging);
        let running_down = self.b.select(timed, left, countdown);
        let next_countdown = self.b.select(calibrated, periods, running_down);
        self.b.name("countdown_advanced", next_countdown);
        let joined = self.b.join([
            ("mode_sequenced", next_mode, mode),
            ("fault_sequenced", next_fault, fault),
            ("countdown_next", next_countdown, countdown),
            ("sum_a_next", new_sums[0], sums[0]),
            ("sum_b_next", new_sums[1], sums[1]),
            ("offset_a_next", new_offsets[0], offsets[0]),
            ("offset_b_next", new_offsets[1], offsets[1]),
        ]);
        self.b.set_state(words.countdown, joined[2]);
        self.b.set_state(words.sums[0], joined[3]);
        self.b.set_state(words.sums[1], joined[4]);
        self.b.set_state(words.offsets[0], joined[5]);
        self.b.set_state(words.offsets[1], joined[6]);
        [joined[0], joined[1]]
    }

    /// Flag: the mean of calibration samples is too far from the nominal offset; and the sums, held within the tolerance.
    fn within_tolerance(&mut self, sums: [Value; 2]) -> (Value, [Value; 2]) {
        let inverter = &self.spec.inverter;
        let log2 = inverter.calibration_log2;
        let range = self.offset_range();
        let [low, high] =
            [range.low, range.high].map(|offset| (offset >> self.scale.current_bits) << log2);
        let tolerance = engineering(
            f64::from(inverter.offset_tolerance) * inverter.adc_gain.abs(),
            "A",
        );
        let doc = format!(
            "sum of calibration samples: {} counts ({tolerance}) each from the nominal offset.",
            inverter.offset_tolerance
        );
        let held = [0, 1].map(|x| {
            let least = self.number("calibration_sum_least", low, &format!("Least good {doc}"));
            let most = self.number(
                "calibration_sum_most",
                high,
                &format!("Greatest good {doc}"),
            );
            let held = self.b.clamp(sums[x], least, most);
            self.b.name(["sum_a_good", "sum_b_good"][x], held)
        });
        let far = [0, 1].map(|x| self.b.compare(Comparison::NotEqual, held[x], sums[x]));
        let either = self.b.or(far[0], far[1]);
        (self.b.name("offset_is_bad", either), held)
    }

    fn latch(
        &mut self,
        words: SupervisorWords,
        sample: &Sample,
        over_current: Value,
        faulty: Value,
        [mode, fault]: [Value; 2],
    ) {
        self.b.guarded_stage(
            "latch_fault",
            faulty,
            true,
            &["Trips the drive and keeps the first cause until reset."],
        );
        let (hall, stall) = (self.b.literal(3), self.b.literal(4));
        let code = self.b.literal(2);
        let mut cause = self.b.select(over_current, code, stall);
        cause = self.b.select(sample.no_hall, hall, cause);
        let at_end = self.at_end(sample.adc);
        let code = self.b.literal(1);
        cause = self.b.select(at_end, code, cause);
        let tripped = self.b.literal(Mode::Tripped as i32);
        let already = self.b.compare(Comparison::Equal, mode, tripped);
        let latched = self.b.select(already, fault, cause);
        self.b.name("fault_latched", latched);
        let tripped = self.b.literal(Mode::Tripped as i32);
        let [mode, fault] = self
            .b
            .join([("mode_next", tripped, mode), ("fault_next", latched, fault)]);
        self.b.set_state(words.mode, mode);
        self.b.set_state(words.fault, fault);
    }

    /// The command and the words that are remembered, replaced by the safe ones where the drive rests.
    pub fn hold_at_rest(
        &mut self,
        rest: Rest,
        command: &Command,
        remembered: &[(StateId, &str, Value)],
    ) {
        self.b.exit_stage(
            "command_rest",
            rest.flag,
            &["Safe command: all legs low in pre-charge, off in calibration and with a fault; the memory of voltages is cleared."],
        );
        let precharge = self.b.literal(Mode::Precharge as i32);
        let precharging = self.b.compare(Comparison::Equal, rest.mode, precharge);
        let healthy = self.b.not(rest.faulty);
        let precharging = self.b.and(precharging, healthy);
        let (low, off) = (self.b.literal(1), self.b.literal(2));
        let leg = self.b.select(precharging, low, off);
        self.b.name("leg_resting", leg);
        let mut results: Vec<(&str, Value, Value)> = vec![];
        for (name, value) in ["compare_a", "compare_b", "compare_c"]
            .into_iter()
            .zip(command.compares)
        {
            let zero = self.zero();
            results.push((name, zero, value));
        }
        for (name, value) in ["leg_a", "leg_b", "leg_c"].into_iter().zip(command.legs) {
            results.push((name, leg, value));
        }
        for &(_, name, value) in remembered {
            let zero = self.zero();
            results.push((name, zero, value));
        }
        let joined = self.b.join_all(&results);
        for (result, value) in results.iter().take(6).zip(&joined) {
            self.b.output(result.0, *value);
        }
        for (&(state, ..), value) in remembered.iter().zip(&joined[6..]) {
            self.b.set_state(state, *value);
        }
    }
}
