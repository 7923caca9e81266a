//! Modulation: voltages to leg commands, and the voltage really applied (semantics, steps 7, 11).

use super::{Bus, CommonModeRule, Intervals, Limited, Lowering};
use crate::design::vectors::SECTOR_CURRENT;
use crate::ir::{
    Coefficient, Expr, Flag, Interval, Memory, Named, Output, Phase, Phases, named, pick,
};
use crate::spec::InverterSpec;

/// Leg state: pulsed.
pub const PULSED: i32 = 0;
/// Leg state: lower switch on.
pub const LOW: i32 = 1;
/// Leg state: both switches off.
pub const OFF: i32 = 2;

/// Three pulsed legs.
#[derive(Clone, Copy, Debug)]
pub struct Pulsed<'b> {
    /// The command.
    pub command: Command<'b>,
    /// Its mean phase voltages, for the prediction.
    pub u: Phases<'b>,
}

/// Compare values and leg states of phases a, b, c.
#[derive(Clone, Copy, Debug)]
pub struct Command<'b> {
    /// Compare values.
    pub compares: Phases<'b, 3>,
    /// Leg states: [`PULSED`], [`LOW`], [`OFF`].
    pub legs: Phases<'b, 3>,
}

/// The command of a step.
#[derive(Clone, Copy, Debug)]
pub enum StepCommand<'b> {
    /// Pulses in the middle of the period.
    Pulses(Command<'b>),
    /// Intervals with legs of their own.
    Intervals(Intervals<'b>),
}

impl<'b> From<Command<'b>> for StepCommand<'b> {
    fn from(command: Command<'b>) -> Self {
        Self::Pulses(command)
    }
}

impl<'b> From<Intervals<'b>> for StepCommand<'b> {
    fn from(intervals: Intervals<'b>) -> Self {
        Self::Intervals(intervals)
    }
}

impl<'b> StepCommand<'b> {
    /// Ends the step: outputs the command and sets the state words.
    pub fn close_step(&self, l: &Lowering<'b>, remembered: &[(Memory<'b>, Expr<'b>)]) {
        match self {
            Self::Pulses(command) => command.output(l),
            Self::Intervals(intervals) => intervals.output(l),
        }
        for &(memory, value) in remembered {
            memory.set(value);
        }
    }
}

/// Terminal voltages of the three legs and the off leg.
#[derive(Clone, Copy, Debug)]
pub struct Applied<'b> {
    /// Mean terminal voltages; 0 of an off leg.
    pub terminals: Phases<'b, 3>,
    /// The off leg: 0 none, 1 a, 2 b, 3 c.
    pub off: Expr<'b>,
}

/// Model of an off leg's terminal voltage.
#[derive(Clone, Copy, Debug)]
pub struct OffLeg<'b> {
    /// The bus.
    pub bus: Bus<'b>,
    /// 1/3, for the mean of three legs.
    pub third: Coefficient,
    /// Current above which the leg's diode conducts, ampere.
    pub threshold: f64,
}

impl<'b> Command<'b> {
    fn output(&self, l: &Lowering<'b>) {
        for (phase, compare) in Phase::ALL.into_iter().zip(self.compares.0) {
            l.b.output(Output::Compare(phase), compare);
        }
        for (phase, leg) in Phase::ALL.into_iter().zip(self.legs.0) {
            l.b.output(Output::Leg(phase), leg);
        }
    }
}

/// Modulator of pulses.
#[derive(Clone, Copy, Debug)]
pub struct Modulator<'b> {
    /// The bus.
    pub bus: Bus<'b>,
    /// Dead-time compensation per leg, words of the nominal bus.
    pub shifts: Option<Phases<'b, 3>>,
    /// 1/3, if the prediction knows what rounding to compare values changes.
    pub rounding: Option<Coefficient>,
}

impl<'b> Modulator<'b> {
    /// Three pulses of a limited voltage. Legs that the limit has not lifted are lifted here.
    pub fn three(
        &self,
        l: &Lowering<'b>,
        limited: &Limited<'b>,
        common_mode: CommonModeRule,
    ) -> Pulsed<'b> {
        let doc = if limited.is_lifted && !common_mode.is_centred() {
            "Compare values of a centre-aligned timer, whole counts."
        } else {
            common_mode.doc()
        };
        l.b.stage("modulate", &[doc]);
        let duty = if limited.is_lifted {
            match self.shifts {
                None => limited.legs,
                Some(shifts) => (limited.legs + shifts).named("duty"),
            }
        } else if common_mode.is_centred() {
            Phases::each(|x| self.lifted_centred(l, limited.legs.0[x], x)).named("duty")
        } else {
            named! {
                let pulse = Phases::each(|x| {
                    self.shifted(nominal_share(limited.legs.0[x], self.bus), x)
                });
            }
            common_mode.lifted(l, pulse).named("duty")
        };
        named! {
            let compare_pulsed = duty.map(|duty| counts(l, duty, common_mode.top));
        }
        let command = Command {
            compares: compare_pulsed,
            legs: Phases::each(|_| l.b.number(PULSED)),
        };
        let written = self
            .rounding
            .map(|third| written(l, third, limited.u, duty));
        Pulsed {
            command,
            u: written.unwrap_or(limited.u),
        }
    }

    /// The duty of a centred voltage before rounding, with half a count, words of the nominal bus.
    fn lifted_centred(&self, l: &Lowering<'b>, centred: Expr<'b>, x: usize) -> Expr<'b> {
        self.shifted(nominal_share(centred, self.bus), x) + half_period(l)
    }

    fn shifted(&self, volts: Expr<'b>, x: usize) -> Expr<'b> {
        match self.shifts {
            None => volts,
            Some(shifts) => volts + shifts.0[x],
        }
    }

    /// Pulses of the limited line voltage of a pair: one leg pulsed, its partner low, the third
    /// off.
    pub fn pulse_pair(&self, l: &Lowering<'b>, sign: Phases<'b, 3>, line: Expr<'b>) -> Pulses<'b> {
        named! {
            let line_forward = line.is_at_least(0);
            let line_volts = line.abs();
            let pulsed_sign = line_forward.choose(1, -1);
        }
        let names = ["pulsed_a", "pulsed_b", "pulsed_c"];
        let is_pulsed = [0, 1, 2].map(|x| sign.0[x].is(pulsed_sign).named(names[x]));
        let [a, b, _] = is_pulsed;
        let shift = self.shifts.map(|shifts| pick([a, b], shifts.0));
        named! {
            let compare_line = compare_of(l, line_volts, self.bus, shift);
            let compare_pair = Phases::each(|x| is_pulsed[x].choose(compare_line, 0));
            let terminal_pair = Phases::each(|x| is_pulsed[x].choose(line_volts, 0));
            let leg_pair = Phases::each(|x| {
                let driven = is_pulsed[x].choose(PULSED, LOW);
                sign.0[x].is(0).choose(OFF, driven)
            });
        }
        Pulses {
            command: Command {
                compares: compare_pair,
                legs: leg_pair,
            },
            terminals: terminal_pair,
        }
    }

    /// Three pulses in commutation, else the pulses of the conducting pair.
    pub fn pair(
        &self,
        l: &Lowering<'b>,
        sector: Expr<'b>,
        commutating: Flag<'b>,
        unlimited: Phases<'b>,
        limited: &Limited<'b>,
    ) -> (Command<'b>, Applied<'b>) {
        let bus = self.bus.volts;
        let doc = "Three centred pulses, for commutation.";
        l.b.stage("modulate_three", &[doc]);
        named! {
            let half_bus = bus >> 1;
            let compare_three = Phases::each(|x| {
                let duty = self.lifted_centred(l, limited.legs.0[x], x);
                counts(l, duty, l.spec.inverter.readable_top())
            });
            let terminal_three = limited.legs.map(|centred| (centred + half_bus).clamp(0, bus));
            let pairing = !commutating;
        }
        let doc = "Line voltage of the conducting pair, outside commutation: one leg pulsed, its partner low, the third off.";
        let (none, pulsed) = (l.b.number(0), Phases([l.b.number(PULSED); 3]));
        l.b.guarded_stage("modulate_pair", pairing, false, &[doc]);
        let sign = pair_signs(l, sector);
        let line = across_pair(sign, unlimited.with_c("u_pair"));
        let reach = CommonModeRule::reach_of_pair(l, self.bus);
        let pulses = self.pulse_pair(l, sign, limit_line(line, reach));
        let one = pick(
            [sign.a().is(0), sign.b().is(0)],
            [1, 2, 3].map(|number| l.b.number(number)),
        );
        named! {
            // Without a sector all legs are off, and no terminal voltage is reconstructed.
            let off_pair = sector.is_not(0).choose(one, 0);
        }
        let joined = |kind: &str, inside: Phases<'b, 3>, outside: Phases<'b, 3>| {
            Phases::each(|x| {
                let name = format!("{kind}_{}_run", ["a", "b", "c"][x]);
                l.b.join([(&*name, inside.0[x], outside.0[x])])[0]
            })
        };
        let command = Command {
            compares: joined("compare", pulses.command.compares, compare_three),
            legs: joined("leg", pulses.command.legs, pulsed),
        };
        let terminals = joined("terminal", pulses.terminals, terminal_three);
        let [off] = l.b.join([("off_run", off_pair, none)]);
        (command, Applied { terminals, off })
    }
}

/// Pulses of a conducting pair.
#[derive(Clone, Copy, Debug)]
pub struct Pulses<'b> {
    /// The command.
    pub command: Command<'b>,
    /// Terminal voltages; 0 of an off leg.
    pub terminals: Phases<'b, 3>,
}

/// The mean phase voltages of the compare values as written: `u`, the commanded ones, less what rounding of the duties,
/// which have half a count, takes; in words of the nominal bus.
fn written<'b>(
    l: &Lowering<'b>,
    third: Coefficient,
    u: Phases<'b>,
    duty: Phases<'b, 3>,
) -> Phases<'b> {
    l.b.stage(
        "predict_rounding",
        &[
            "Voltage of the compare values as written: the prediction knows what rounding to whole timer counts changes.",
        ],
    );
    named! {
        let rest = duty.map(|duty| duty.remainder(l.scale.voltage_bits));
        let rest_mean = third * rest.sum();
        let u_written = Phases::each(|x| u.0[x] - rest.0[x] + rest_mean);
    }
    u_written
}

/// Half the timer period and half a count, by which centred voltages are lifted.
pub(super) fn half_period<'b>(l: &Lowering<'b>) -> Expr<'b> {
    let (bits, period) = (l.scale.voltage_bits, l.spec.inverter.timer_period);
    let half = i64::from(period) << (bits - 1);
    let counts = f64::midpoint(f64::from(period), 1.0);
    let doc = format!(
        "Half the timer period, plus half a count for rounding: {counts} timer counts, words of voltage."
    );
    l.number("half_period", half + (1 << (bits - 1)), &doc)
}

/// Compare value of a leg's mean voltage `volts`; `shift` is its dead-time compensation.
pub fn compare_of<'b>(
    l: &Lowering<'b>,
    volts: Expr<'b>,
    bus: Bus<'b>,
    shift: Option<Expr<'b>>,
) -> Expr<'b> {
    let nominal = nominal_share(volts, bus);
    let shifted = shift.map_or(nominal, |shift| nominal + shift);
    let half_count = 1 << (l.scale.voltage_bits - 1);
    counts(l, shifted + half_count, l.spec.inverter.readable_top())
}

/// A voltage scaled from the measured to the nominal bus, which is the timer period.
fn nominal_share<'b>(volts: Expr<'b>, bus: Bus<'b>) -> Expr<'b> {
    match bus.ratio {
        None => volts,
        Some((ratio, shift)) => volts.mul_round(ratio, shift),
    }
}

/// The compare value of a lifted voltage, which includes half a count for rounding; at most `top`.
fn counts<'b>(l: &Lowering<'b>, lifted: Expr<'b>, top: u32) -> Expr<'b> {
    let count = (-f64::from(l.scale.voltage_bits)).exp2();
    let doc = "Duty before rounding to a compare value";
    l.b.state_error("duty", lifted, [doc, "timer counts"], count);
    let counts = lifted >> l.scale.voltage_bits;
    let largest = i64::from(top);
    if Interval::new(0, largest).contains(counts.interval()) {
        return counts;
    }
    let top = if top == l.spec.inverter.timer_period {
        l.number("timer_period", largest, "Compare value of 100 % duty.")
    } else {
        l.number("compare_max", largest, about_largest(&l.spec.inverter, top))
    };
    counts.clamp(0, top)
}

/// What a largest compare value below the timer's period leaves time for. Dead time is part of the low time that is
/// commanded: the lower switch is on for less.
fn about_largest(inverter: &InverterSpec, top: u32) -> &'static str {
    if top == inverter.largest_compare() {
        "Largest compare value: by the command each leg is low for `minimum_low_time` in every PWM period, which includes the dead time."
    } else if top == inverter.readable_top() {
        "Largest compare value: by the command each leg is low for long enough to be read at both ends of the period."
    } else {
        "Largest compare value of the highest of three legs: by the command it is low until its sensor is read at the beginning of the period. At the end two sensors are read, and its current is the rest of theirs; the dead time may leave its lower switch off."
    }
}

/// Sign of each leg in the conducting pair of a sector; added to the open stage.
pub fn pair_signs<'b>(l: &Lowering<'b>, sector: Expr<'b>) -> Phases<'b, 3> {
    named! {
        let sign = Phases::each(|phase| {
            let letter = ["a", "b", "c"][phase];
            let signs = SECTOR_CURRENT.iter().map(|legs| legs[phase]);
            let column = std::iter::once(0).chain(signs).collect();
            let doc = format!("Leg {letter} in sectors 1 to 6: 1 plus, -1 minus, 0 off.");
            let table = l.b.column("sector", &format!("pair_sign_{letter}"), column, &doc);
            table.at(sector)
        });
    }
    sign
}

/// Line value of the pair: that of the plus leg less that of the minus leg.
pub fn across_pair<'b>(sign: Phases<'b, 3>, values: Phases<'b, 3>) -> Expr<'b> {
    sign.zip(values, |sign, value| sign * value).sum()
}

/// A line voltage limited to the bus.
pub fn limit_line<'b>(line: Expr<'b>, bus: Bus<'b>) -> Expr<'b> {
    named! {
        let line = line.max(-bus.volts).min(bus.volts);
    }
    line
}

impl<'b> OffLeg<'b> {
    /// Mean phase voltages a, b (zero-sum) that a command really applies, from the currents at its
    /// start and the EMF.
    pub fn applied_voltage(
        &self,
        l: &Lowering<'b>,
        applied: &Applied<'b>,
        currents: Phases<'b, 3>,
        e: Phases<'b>,
    ) -> Phases<'b> {
        l.b.stage(
            "applied_voltage",
            &[
                "Phase voltages applied in this period.",
                "",
                "An off leg is clamped to a rail by its diode while it carries current; else it floats at its EMF above",
                "the star point of the driven pair.",
            ],
        );
        let bus = self.bus.volts;
        let e = e.with_c("e_now");
        named! {
            let off_a = applied.off.is(1);
            let off_b = applied.off.is(2);
            let off_c = applied.off.is(3);
            let e_off = pick([off_a, off_b], e.0);
            let i_off = pick([off_a, off_b], currents.0);
        }
        // The off leg's terminal word is 0, so the sum of all three is that of the driven pair.
        let star = applied.terminals.sum() >> 1;
        let floating = (star + e_off + (e_off >> 1)).clamp(0, bus);
        let limit = || {
            let threshold = l.ampere_word(self.threshold);
            let doc = "Current threshold of an off leg's diode";
            l.current("i_comm", threshold, doc)
        };
        let inward = i_off.is_above(limit());
        let outward = i_off.is_below(-limit());
        named! {
            let terminal_off = inward.choose(0, outward.choose(bus, floating));
        }
        let flags = [off_a, off_b, off_c];
        named! {
            let terminal_now = Phases::<3>::each(|x| {
                flags[x].choose(terminal_off, applied.terminals.0[x])
            });
            let terminal_mean_now = self.third * terminal_now.sum();
        }
        terminal_now
            .pair()
            .map(|terminal| terminal - terminal_mean_now)
    }
}
