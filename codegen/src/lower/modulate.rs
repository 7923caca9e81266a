//! Voltages to leg commands, commutation, and what a pair command really applies (semantics, steps 5, 7, 11).

use super::measure::Currents;
use super::{Bus, Coefficient, Limited, Lowering};
use crate::design::vectors::{OFF_PHASE, OUTGOING_SIGN, SECTOR_CURRENT};
use crate::ir::{Comparison, Interval, StateId, Value};

/// Pulses of a conducting pair, per leg.
#[derive(Clone, Copy, Debug)]
pub struct PairPulses {
    /// Compare values.
    pub compares: [Value; 3],
    /// Leg words: 0 pulsed, 1 low, 2 off.
    pub legs: [Value; 3],
    /// Terminal voltages; of an off leg 0.
    pub terminals: [Value; 3],
}

/// Compare values and leg states of phases a, b, c.
#[derive(Clone, Copy, Debug)]
pub struct Command {
    /// Compare values.
    pub compares: [Value; 3],
    /// Leg states: 0 pulsed, 1 low, 2 off.
    pub legs: [Value; 3],
}

/// Terminal voltages of the three legs and which leg is off (0 none, 1 to 3: a to c).
#[derive(Clone, Copy, Debug)]
pub struct Applied {
    /// Mean terminal voltages; of an off leg 0.
    pub terminals: [Value; 3],
    /// Number of the off leg.
    pub off: Value,
}

/// What decides where an off leg's terminal sits.
#[derive(Clone, Copy, Debug)]
pub struct OffLeg {
    /// The rails.
    pub bus: Bus,
    /// 1/3, for the mean of three legs.
    pub third: Coefficient,
    /// Current above which the leg's diode conducts, ampere.
    pub threshold: f64,
}

/// State words and flags of pair modulation.
#[derive(Clone, Copy, Debug)]
pub struct PairModulation {
    /// Sector in force at the last sample, where that is not the sample's own.
    pub sector_prev: Option<StateId>,
    /// Samples for which a commutation may last behind the last one.
    pub left: StateId,
}

/// The commutation in the period of a sample.
#[derive(Clone, Copy, Debug)]
pub struct Commutation {
    /// Flag: it goes on.
    pub flag: Value,
    /// 1 where it goes on, else 0.
    pub word: Value,
    /// Samples for which it may last behind this one.
    pub left: Value,
    /// Direction of rotation, 1 or -1; 0 before the first edge.
    pub direction: Value,
}

impl Lowering<'_> {
    /// Ends the step with a command, and with the words that the next step needs.
    pub fn close_step(&mut self, command: &Command, remembered: &[(StateId, Value)]) {
        let compares = ["compare_a", "compare_b", "compare_c"].into_iter();
        let legs = ["leg_a", "leg_b", "leg_c"].into_iter();
        for (name, value) in compares.zip(command.compares).chain(legs.zip(command.legs)) {
            self.b.output(name, value);
        }
        for &(state, value) in remembered {
            self.b.set_state(state, value);
        }
    }

    /// Three centred pulses from a limited voltage, lifted where the bus is fixed; `shifts` are against the dead time.
    pub fn modulate(&mut self, limited: Limited, bus: Bus, shifts: Option<[Value; 3]>) -> Command {
        self.b.stage(
            "modulate",
            &["Compare values of a centre-aligned timer; (max + min)/2 as offset centres the pulses as space-vector modulation does."],
        );
        let compares = [0, 1, 2].map(|x| {
            let name = ["compare_a_pulsed", "compare_b_pulsed", "compare_c_pulsed"][x];
            let centred = limited.centred[x];
            match bus.ratio {
                None => {
                    let lifted = self.shifted(centred, shifts.map(|shifts| shifts[x]));
                    self.counts(name, lifted)
                }
                Some(_) => self.compare_centred(name, centred, bus, shifts.map(|shifts| shifts[x])),
            }
        });
        let legs = [0; 3].map(|pulsed| self.b.literal(pulsed));
        Command { compares, legs }
    }

    fn compare_centred(
        &mut self,
        name: &str,
        centred: Value,
        bus: Bus,
        shift: Option<Value>,
    ) -> Value {
        let scaled = self.nominal_share(centred, bus);
        let scaled = self.shifted(scaled, shift);
        let offset = self.half_period();
        let lifted = self.b.add(scaled, offset);
        self.counts(name, lifted)
    }

    /// What a centred voltage of the nominal bus is lifted by.
    pub(super) fn half_period(&mut self) -> Value {
        let bits = self.scale.voltage_bits;
        let half = i64::from(self.spec.inverter.timer_period) << (bits - 1);
        self.number(
            "half_period",
            half + (1 << (bits - 1)),
            &format!(
                "Half the timer period, and half a count to round: {} timer counts, words of voltage.",
                f64::midpoint(f64::from(self.spec.inverter.timer_period), 1.0)
            ),
        )
    }

    /// Compare value of a leg that is high for the share of the period that `volts` is of the bus; `shift` is against
    /// the dead time.
    pub fn compare_of(
        &mut self,
        name: &str,
        volts: Value,
        bus: Bus,
        shift: Option<Value>,
    ) -> Value {
        let nominal = self.nominal_share(volts, bus);
        let nominal = self.shifted(nominal, shift);
        let round = self.b.literal(1 << (self.scale.voltage_bits - 1));
        let lifted = self.b.add(nominal, round);
        self.counts(name, lifted)
    }

    fn shifted(&mut self, volts: Value, shift: Option<Value>) -> Value {
        match shift {
            None => volts,
            Some(shift) => self.b.add(volts, shift),
        }
    }

    /// A voltage of the measured bus as a share of the nominal one, which the timer period stands for.
    fn nominal_share(&mut self, volts: Value, bus: Bus) -> Value {
        match bus.ratio {
            None => volts,
            Some((ratio, shift)) => self.b.mul(ratio, volts, shift),
        }
    }

    fn counts(&mut self, name: &str, lifted: Value) -> Value {
        let count = (-f64::from(self.scale.voltage_bits)).exp2();
        let doc = "Duty before it is rounded to a compare value";
        self.b
            .state_error("duty", lifted, [doc, "timer counts"], count);
        let counts = self.b.shift_right(lifted, self.scale.voltage_bits);
        let period = i64::from(self.spec.inverter.timer_period);
        if Interval::new(0, period).contains(self.b.interval(counts)) {
            return self.b.name(name, counts);
        }
        let zero = self.zero();
        let top = self.number("timer_period", period, "Compare value of 100 % duty.");
        let compare = self.b.clamp(counts, zero, top);
        self.b.name(name, compare)
    }

    /// Declares the words of pair modulation.
    pub fn pair_words(&mut self, timeout: u32, advances: bool) -> PairModulation {
        PairModulation {
            sector_prev: advances.then(|| {
                self.state(
                    "sector_eff_prev",
                    0,
                    Interval::new(0, 6),
                    "Sector in force at the last sample; 0 before the first.",
                )
            }),
            left: self.state(
                "commutation_left",
                0,
                Interval::new(0, i64::from(timeout)),
                "Samples for which the commutation may last behind the last one; 0 while the outgoing phase carries no current.",
            ),
        }
    }

    /// Samples for which a commutation may last, this one included: those of `left`, or where `began` holds all of them.
    pub fn commutation_kept(&mut self, began: Value, left: Value, timeout: u32) -> Value {
        let whole = self.whole_commutation(timeout);
        let kept = self.b.select(began, whole, left);
        self.b.name("commutation_restarted", kept)
    }

    /// What a commutation that begins is given, of which each sample takes one.
    fn whole_commutation(&mut self, timeout: u32) -> Value {
        self.number(
            "commutation_begun",
            i64::from(timeout) + 1,
            "What a commutation that begins is given: one for its first sample, and one for each that it may last behind it.",
        )
    }

    /// Flag: the sector in force is another than at the last sample, for a reference that runs ahead of the sample.
    pub fn sector_in_force_changed(&mut self, sector_prev: StateId, sector: Value) -> Value {
        self.b.stage(
            "compare_sectors",
            &["Whether the sector in force is another than at the last sample."],
        );
        let sector_prev = self.b.state(sector_prev);
        let [_, changed] = self.compare_sectors(sector, sector_prev);
        self.b.name("changed", changed)
    }

    /// The commutation, and the phase that goes off in the sector. `kept` is of [`Self::commutation_kept`], from the state
    /// word `left`.
    pub fn commutation(
        &mut self,
        [sector, kept, direction, set_point]: [Value; 4],
        left: StateId,
        currents: &Currents,
        threshold: f64,
        timeout: u32,
    ) -> (Commutation, Value) {
        let phases = self.b.program.column(
            "sector",
            "off_phase",
            std::iter::once(0).chain(OFF_PHASE).collect(),
            &["Phase that is off in sectors 1 to 6: 0 a, 1 b, 2 c.".to_owned()],
        );
        // The outgoing current as a sum of those of phases a and b, c being their sum's negative.
        let shares = [("outgoing_a", 0), ("outgoing_b", 1)].map(|(name, x)| {
            let column = OFF_PHASE.iter().zip(OUTGOING_SIGN).map(|(&phase, sign)| match phase {
                2 => -sign,
                phase if phase == x => sign,
                _ => 0,
            });
            let doc = format!(
                "What the current of phase {} adds to the outgoing one on entry of sectors 1 to 6, positive torque, forward.",
                ["a", "b"][x as usize]
            );
            let column = std::iter::once(0).chain(column).collect();
            self.b.program.column("sector", name, column, &[doc])
        });
        self.b.stage(
            "detect_commutation",
            &["Whether a commutation begins, or may last on."],
        );
        let phase = self.b.lookup(phases, sector);
        self.b.name("outgoing_phase", phase);
        let zero = self.zero();
        let lasts = self.b.compare(Comparison::NotEqual, kept, zero);
        self.b.name("commutation_lasts", lasts);
        // Where none lasts, none is left.
        let none_left = self.b.state(left);
        let none = self.zero();
        self.b.guarded_stage(
            "follow_commutation",
            lasts,
            false,
            &[
                "A commutation begins at the first sample in a new sector and ends at a later one, when the outgoing",
                "current has fallen to the threshold or the time-out has passed.",
            ],
        );
        let [of_a, of_b] = [0, 1].map(|x| {
            let share = self.b.lookup(shares[x], sector);
            self.b.mul(share, currents.phases[x], 0)
        });
        let outgoing = self.b.add(of_a, of_b);
        let turned = self.b.mul(direction, outgoing, 0);
        self.b.name("outgoing_turned", turned);
        let zero = self.zero();
        let braking = self.b.compare(Comparison::Less, set_point, zero);
        let back = self.b.neg(turned);
        let outgoing = self.b.select(braking, back, turned);
        let doc = "Outgoing current at which a commutation ends";
        let threshold = self.ampere_word(threshold);
        let limit = self.current("i_comm", threshold, doc);
        let flows = self.b.compare(Comparison::Less, limit, outgoing);
        let whole = self.whole_commutation(timeout);
        let begins = self.b.compare(Comparison::Equal, kept, whole);
        let goes_on = self.b.or(begins, flows);
        self.b.name("commutation_goes_on", goes_on);
        let one = self.b.literal(1);
        let less = self.b.sub(kept, one);
        // The guard leaves no 0; intervals do not know of it.
        let zero = self.zero();
        let less = self.b.max(less, zero);
        let zero = self.zero();
        let followed = self.b.select(goes_on, less, zero);
        self.b.name("left_while_flowing", followed);
        let (one, zero) = (self.b.literal(1), self.zero());
        let going_on = self.b.select(goes_on, one, zero);
        self.b.name("commutating_now", going_on);
        let [left, word] = self.b.join([
            ("commutation_left_now", followed, none_left),
            ("commutating", going_on, none),
        ]);
        self.b
            .stage("find_commutation", &["Whether a commutation goes on."]);
        let zero = self.zero();
        let flag = self.b.compare(Comparison::NotEqual, word, zero);
        self.b.name("in_commutation", flag);
        let commutation = Commutation {
            flag,
            word,
            left,
            direction,
        };
        (commutation, phase)
    }

    /// The value of the phase numbered 0 to 2 by `phase`.
    pub fn of_phase(&mut self, phase: Value, values: [Value; 3]) -> Value {
        let zero = self.zero();
        let is_a = self.b.compare(Comparison::Equal, phase, zero);
        let one = self.b.literal(1);
        let is_b = self.b.compare(Comparison::Equal, phase, one);
        self.pick(is_a, is_b, values)
    }

    /// Per leg its sign in the conducting pair of a sector, added to the open stage.
    pub fn pair_signs(&mut self, sector: Value) -> [Value; 3] {
        [0, 1, 2].map(|phase| {
            let column = std::iter::once(0)
                .chain(SECTOR_CURRENT.iter().map(|legs| legs[phase]))
                .collect();
            let name = ["pair_sign_a", "pair_sign_b", "pair_sign_c"][phase];
            let doc = format!(
                "Leg {} in sectors 1 to 6: 1 plus, -1 minus, 0 off.",
                ["a", "b", "c"][phase]
            );
            let table = self.b.program.column("sector", name, column, &[doc]);
            let sign = self.b.lookup(table, sector);
            self.b.name(["sign_a", "sign_b", "sign_c"][phase], sign)
        })
    }

    /// What the pair with these signs has of zero-sum values: that of the plus leg less that of the minus leg.
    pub fn across_pair(&mut self, sign: [Value; 3], values: [Value; 3]) -> Value {
        let terms = [0, 1, 2].map(|x| self.b.mul(sign[x], values[x], 0));
        let sum = self.b.add(terms[0], terms[1]);
        self.b.add(sum, terms[2])
    }

    /// A line voltage within the bus.
    pub fn limit_line(&mut self, line: Value, bus: Bus) -> Value {
        let low = self.b.neg(bus.volts);
        let line = self.b.max(line, low);
        let line = self.b.min(line, bus.volts);
        self.b.name("line", line)
    }

    /// The limited line voltage of the pair with these signs: one leg pulsed, its partner low, the third off.
    pub fn pulse_pair(
        &mut self,
        sign: [Value; 3],
        line: Value,
        bus: Bus,
        shifts: Option<[Value; 3]>,
    ) -> PairPulses {
        let zero = self.zero();
        let forward = self.b.compare(Comparison::LessEqual, zero, line);
        self.b.name("line_forward", forward);
        let volts = self.b.abs(line);
        self.b.name("line_volts", volts);
        let (plus, minus) = (self.b.literal(1), self.b.literal(-1));
        let pulsed_sign = self.b.select(forward, plus, minus);
        self.b.name("pulsed_sign", pulsed_sign);
        let is_pulsed = [0, 1, 2].map(|x| {
            let is_pulsed = self.b.compare(Comparison::Equal, sign[x], pulsed_sign);
            self.b
                .name(["pulsed_a", "pulsed_b", "pulsed_c"][x], is_pulsed)
        });
        let shift = shifts.map(|shifts| self.pick(is_pulsed[0], is_pulsed[1], shifts));
        let compare = self.compare_of("compare_line", volts, bus, shift);
        let legs = [0, 1, 2].map(|x| {
            let is_pulsed = is_pulsed[x];
            let zero = self.zero();
            let own_compare = self.b.select(is_pulsed, compare, zero);
            let zero = self.zero();
            let own_terminal = self.b.select(is_pulsed, volts, zero);
            let zero = self.zero();
            let is_off = self.b.compare(Comparison::Equal, sign[x], zero);
            let (pulsed, low, off) = (self.b.literal(0), self.b.literal(1), self.b.literal(2));
            let driven = self.b.select(is_pulsed, pulsed, low);
            let leg = self.b.select(is_off, off, driven);
            self.b.name(
                ["compare_a_pair", "compare_b_pair", "compare_c_pair"][x],
                own_compare,
            );
            self.b
                .name(["leg_a_pair", "leg_b_pair", "leg_c_pair"][x], leg);
            self.b.name(
                ["terminal_a_pair", "terminal_b_pair", "terminal_c_pair"][x],
                own_terminal,
            );
            [own_compare, leg, own_terminal]
        });
        PairPulses {
            compares: legs.map(|[compare, ..]| compare),
            legs: legs.map(|[_, leg, _]| leg),
            terminals: legs.map(|[.., terminal]| terminal),
        }
    }

    /// Three pulses while commutating, else the conducting pair alone: one leg pulsed, its partner low, the third off.
    pub fn modulate_pair(
        &mut self,
        [sector, commutating]: [Value; 2],
        unlimited: [Value; 2],
        limited: Limited,
        bus: Bus,
        shifts: Option<[Value; 3]>,
    ) -> (Command, Applied) {
        self.b.stage(
            "modulate_three",
            &["Three centred pulses, for commutation."],
        );
        let half_bus = self.b.shift_right(bus.volts, 1);
        self.b.name("half_bus", half_bus);
        let mut three = vec![];
        for x in 0..3 {
            let centred = limited.centred[x];
            let compare = self.compare_centred(
                ["compare_a_three", "compare_b_three", "compare_c_three"][x],
                centred,
                bus,
                shifts.map(|shifts| shifts[x]),
            );
            let lifted = self.b.add(centred, half_bus);
            let zero = self.zero();
            let terminal = self.b.clamp(lifted, zero, bus.volts);
            three.push((
                compare,
                self.b.name(
                    ["terminal_a_three", "terminal_b_three", "terminal_c_three"][x],
                    terminal,
                ),
            ));
        }
        let pairing = self.b.not(commutating);
        self.b.name("pairing", pairing);
        let none = self.b.literal(0);
        let outside = self.b.literal(0);

        self.b.guarded_stage(
            "modulate_pair",
            pairing,
            false,
            &["Outside commutation only the line voltage of the conducting pair counts: one leg pulsed, its partner low, the third off."],
        );
        let u_c = self.third_phase("u_c_pair", unlimited[0], unlimited[1]);
        let voltages = [unlimited[0], unlimited[1], u_c];
        let sign = self.pair_signs(sector);
        let line = self.across_pair(sign, voltages);
        let line = self.limit_line(line, bus);
        let pulses = self.pulse_pair(sign, line, bus, shifts);
        let mut results: Vec<(&str, Value, Value)> = vec![];
        for x in 0..3 {
            results.push((
                ["compare_a_run", "compare_b_run", "compare_c_run"][x],
                pulses.compares[x],
                three[x].0,
            ));
            results.push((
                ["leg_a_run", "leg_b_run", "leg_c_run"][x],
                pulses.legs[x],
                outside,
            ));
            results.push((
                ["terminal_a_run", "terminal_b_run", "terminal_c_run"][x],
                pulses.terminals[x],
                three[x].1,
            ));
        }
        let off = {
            let zero = self.zero();
            let (one, two, three_word) = (self.b.literal(1), self.b.literal(2), self.b.literal(3));
            let is_a = self.b.compare(Comparison::Equal, sign[0], zero);
            let zero = self.zero();
            let is_b = self.b.compare(Comparison::Equal, sign[1], zero);
            let number = self.pick(is_a, is_b, [one, two, three_word]);
            // Without a sector all three are off and none is to be rebuilt.
            let zero = self.zero();
            let known = self.b.compare(Comparison::NotEqual, sector, zero);
            let zero = self.zero();
            self.b.select(known, number, zero)
        };
        self.b.name("off_pair", off);
        results.push(("off_run", off, none));
        let joined = self.b.join_all(&results);
        let command = Command {
            compares: [joined[0], joined[3], joined[6]],
            legs: [joined[1], joined[4], joined[7]],
        };
        (
            command,
            Applied {
                terminals: [joined[2], joined[5], joined[8]],
                off: joined[9],
            },
        )
    }

    /// Mean phase voltages a, b (zero-sum) that a command really applies, given the currents at its start
    /// and the EMF: an off leg with current is clamped to a rail by its diode, without it floats.
    pub fn applied_voltage(
        &mut self,
        names: [&str; 2],
        applied: Applied,
        currents: &Currents,
        e: [Value; 2],
        &OffLeg {
            bus,
            third,
            threshold,
        }: &OffLeg,
    ) -> [Value; 2] {
        self.b.stage(
            "applied_voltage",
            &[
                "Phase voltages that the inverter really applies during this period.",
                "",
                "A leg that is off is clamped to a rail by its diode while it carries current, else it sits at its EMF",
                "above the star point of the driven pair.",
            ],
        );
        let threshold = self.ampere_word(threshold);
        let e_c = self.third_phase("e_c_now", e[0], e[1]);
        let one = self.b.literal(1);
        let off_a = self.b.compare(Comparison::Equal, applied.off, one);
        self.b.name("off_a", off_a);
        let two = self.b.literal(2);
        let off_b = self.b.compare(Comparison::Equal, applied.off, two);
        self.b.name("off_b", off_b);
        let three = self.b.literal(3);
        let off_c = self.b.compare(Comparison::Equal, applied.off, three);
        self.b.name("off_c", off_c);
        let e_off = self.pick(off_a, off_b, [e[0], e[1], e_c]);
        self.b.name("e_off", e_off);
        let i_off = self.pick(off_a, off_b, currents.phases);
        self.b.name("i_off", i_off);
        // The off leg's own terminal word is 0, so the sum of all three is that of the driven pair.
        let pair = self.b.add(applied.terminals[0], applied.terminals[1]);
        let pair = self.b.add(pair, applied.terminals[2]);
        let star = self.b.shift_right(pair, 1);
        let half_e = self.b.shift_right(e_off, 1);
        let floating = self.b.add(star, e_off);
        let floating = self.b.add(floating, half_e);
        let zero = self.zero();
        let floating = self.b.clamp(floating, zero, bus.volts);
        let doc = "Current above which an off leg's diode conducts";
        let limit = self.current("i_comm", threshold, doc);
        let inward = self.b.compare(Comparison::Less, limit, i_off);
        let limit = self.current("i_comm", threshold, doc);
        let negative = self.b.neg(limit);
        let outward = self.b.compare(Comparison::Less, i_off, negative);
        let clamped = self.b.select(outward, bus.volts, floating);
        let zero = self.zero();
        let off_terminal = self.b.select(inward, zero, clamped);
        self.b.name("terminal_off", off_terminal);
        let flags = [off_a, off_b, off_c];
        let terminals = [0, 1, 2].map(|x| {
            let terminal = self.b.select(flags[x], off_terminal, applied.terminals[x]);
            self.b.name(
                ["terminal_a_now", "terminal_b_now", "terminal_c_now"][x],
                terminal,
            )
        });
        let sum = self.b.add(terminals[0], terminals[1]);
        let sum = self.b.add(sum, terminals[2]);
        let mean = self.times(third, sum);
        self.b.name("terminal_mean_now", mean);
        [0, 1].map(|x| {
            let volts = self.b.sub(terminals[x], mean);
            self.b.name(names[x], volts)
        })
    }
}
