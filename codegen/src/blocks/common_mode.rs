//! The common mode of three pulsed legs: free for the motor, and bound by how long a leg must be low (semantics, step 11).

use super::limit::within_bus;
use super::modulate::half_period;
use super::{Bus, Limited, Lowering};
use crate::ir::{Coefficient, Expr, Flag, Named, Phases, named};
use crate::spec::{BusSource, CommonMode};

/// Legs of which each is low for a while in every period.
#[derive(Clone, Copy, Debug)]
pub struct CommonModeRule {
    /// Where the pulses lie.
    pub policy: CommonMode,
    /// Compare value of 100 % duty.
    period: u32,
    /// Largest compare value.
    pub top: u32,
    /// Largest difference of two compare values.
    reach: u32,
    /// Largest compare value of the second highest leg, which is less where the highest is not read.
    second: u32,
}

impl CommonModeRule {
    /// The rule of a policy on this inverter.
    pub fn new(l: &Lowering<'_>, policy: CommonMode) -> Self {
        let inverter = &l.spec.inverter;
        let readable = inverter.readable_top();
        Self {
            policy,
            period: inverter.timer_period,
            // Centred pulses leave all three legs alike.
            top: match policy {
                CommonMode::Centred => readable,
                CommonMode::Readable | CommonMode::ClampedLow => inverter.highest_top(),
            },
            reach: inverter.reach(policy),
            second: readable,
        }
    }

    /// Whole vectors: their high legs are pulsed, all alike, and one leg is low throughout.
    pub fn of_vectors(l: &Lowering<'_>) -> Self {
        let top = l.spec.inverter.readable_top();
        Self {
            top,
            reach: top,
            ..Self::new(l, CommonMode::ClampedLow)
        }
    }

    /// Whether the legs' extremes lie as far from the ends of the period.
    pub fn is_centred(self) -> bool {
        self.policy == CommonMode::Centred
    }

    /// The rule, if the voltage limit itself lifts the legs to where their pulses lie; else that is left to the modulator.
    /// It needs a fixed bus; and unless pulses are centred, no dead-time shift and no second leg that is lowered.
    pub fn in_limit(self, bus: Bus<'_>, shifted: bool) -> Option<Self> {
        let is_last = self.is_centred() || !shifted && self.second >= self.top;
        (bus.ratio.is_none() && is_last).then_some(self)
    }

    /// What the stage does that makes the pulses.
    pub fn doc(self) -> &'static str {
        match self.policy {
            CommonMode::Centred => {
                "Compare values of a centre-aligned timer; the offset (max + min)/2 is that of space-vector modulation."
            }
            CommonMode::Readable => {
                "Compare values of a centre-aligned timer; pulses are centred, or lowered as far as the highest leg must be low."
            }
            CommonMode::ClampedLow => {
                "Compare values of a centre-aligned timer; the lowest leg stays low."
            }
        }
    }

    /// What the limit does that lifts the legs to where their pulses lie, unless that is the middle.
    pub fn doc_of_lift(self) -> Option<&'static str> {
        match self.policy {
            CommonMode::Centred => None,
            CommonMode::Readable => Some(
                "Legs are lifted to the middle of the period, or as far as the highest must be low.",
            ),
            CommonMode::ClampedLow => Some("Legs are lifted as far as the lowest stays low."),
        }
    }

    /// The largest spread of three phase voltages that fits the legs, as a bus: centred legs leave as much below as above.
    pub fn reach<'b>(self, l: &Lowering<'b>, bus: Bus<'b>) -> Bus<'b> {
        let whose = "legs reach which must be low for a while";
        self.reach_as(l, bus, ["k_reach", "v_reach", whose])
    }

    /// The largest line voltage of a pair, as a bus: one leg is pulsed, its partner low throughout.
    pub fn reach_of_pair<'b>(l: &Lowering<'b>, bus: Bus<'b>) -> Bus<'b> {
        let whose = "the pulsed leg of a pair reaches which must be low for a while";
        Self::of_vectors(l).reach_as(l, bus, ["k_line", "v_line", whose])
    }

    /// The reach under these names; the bus itself where it is that.
    fn reach_as<'b>(self, l: &Lowering<'b>, bus: Bus<'b>, names: [&'static str; 3]) -> Bus<'b> {
        if self.reach == self.period {
            return bus;
        }
        let volts = self.share(l, bus, self.reach, names);
        Bus { volts, ..bus }
    }

    /// The voltage of so many counts.
    fn share<'b>(
        self,
        l: &Lowering<'b>,
        bus: Bus<'b>,
        counts: u32,
        [k_name, v_name, whose]: [&'static str; 3],
    ) -> Expr<'b> {
        if let BusSource::Fixed = l.spec.inverter.bus {
            let doc = format!("Voltage that {whose}: {counts} timer counts, words of voltage.");
            let value = i64::from(counts) << l.scale.voltage_bits;
            return l.number(v_name, value, &doc);
        }
        let share = f64::from(counts) / f64::from(self.period);
        let (doc, formula) = (
            format!("Share of the bus that {whose}."),
            format!("{share:.6}"),
        );
        let k_share = l.coefficient(k_name, share, l.scale.word, &doc, &formula);
        (k_share * bus.volts).named(v_name)
    }

    /// Of sensors in all low legs two are read, those of the two lower legs: lowers the second highest leg to where it
    /// can be.
    pub fn second_readable<'b>(
        self,
        l: &Lowering<'b>,
        third: Coefficient,
        bus: Bus<'b>,
        limited: Limited<'b>,
    ) -> Limited<'b> {
        if self.second >= self.top {
            return limited;
        }
        let doc = "Second highest leg; of three sensors in the low legs those of the two lower legs are read.";
        l.b.stage("find_second_leg", &[doc]);
        let v_second = self.share(
            l,
            bus,
            self.second,
            ["k_second", "v_second", "the second highest leg reaches"],
        );
        let legs = limited.legs;
        let [high, low] = legs.extremes(["leg_high", "leg_low"]);
        named! {
            let second = legs.sum() - high - low;
            let second_most = low + v_second;
            let unreadable = second.is_above(second_most);
        }
        let doc = "The second highest leg lowered to where its sensor can be read.";
        l.b.guarded_stage("lower_second_leg", unreadable, true, &[doc]);
        let is_high = highest(legs, high);
        named! {
            let leg_lowered = Phases::each(|x| {
                is_high[x].choose(legs.0[x], legs.0[x].min(second_most))
            });
            let lowered_mean = third * (second - second_most);
            let u_lowered = Phases::<2>::each(|x| {
                within_bus(limited.u.0[x] - (legs.0[x] - leg_lowered.0[x]) + lowered_mean, bus.volts)
            });
        }
        let [u_a, u_b, leg_a, leg_b, leg_c] = l.b.join([
            ("u_a_read", u_lowered.a(), limited.u.a()),
            ("u_b_read", u_lowered.b(), limited.u.b()),
            ("leg_a_now", leg_lowered.a(), legs.a()),
            ("leg_b_now", leg_lowered.b(), legs.b()),
            ("leg_c_now", leg_lowered.c(), legs.c()),
        ]);
        Limited {
            u: Phases([u_a, u_b]),
            legs: Phases([leg_a, leg_b, leg_c]),
            is_lifted: limited.is_lifted,
            cut: limited.cut,
            spread: limited.spread,
        }
    }

    /// The largest voltage of a leg that may be high for so many counts, with half a count to round.
    fn pulse<'b>(l: &Lowering<'b>, counts: u32, [name, whose]: [&str; 2]) -> Expr<'b> {
        let half_count = 1_i64 << (l.scale.voltage_bits - 1);
        let value = (i64::from(counts) << l.scale.voltage_bits) + half_count;
        let doc = format!(
            "Largest compare value{whose}, and half a count to round: {} timer counts, words of voltage.",
            f64::from(counts) + 0.5
        );
        l.number(name, value, &doc)
    }

    /// Largest duty, with half a count to round.
    pub fn pulse_top<'b>(self, l: &Lowering<'b>) -> Expr<'b> {
        Self::pulse(l, self.top, ["pulse_top", ""])
    }

    /// What lifts voltages of these extremes, words of the nominal bus, to where their pulses lie; `middle` is half the
    /// sum of the extremes, none of legs that are centred already.
    pub fn lift<'b>(
        self,
        l: &Lowering<'b>,
        middle: Option<Expr<'b>>,
        [high, low]: [Expr<'b>; 2],
    ) -> Expr<'b> {
        let half_count = || l.b.number(1 << (l.scale.voltage_bits - 1));
        let half = || {
            let half = half_period(l);
            middle.map_or(half, |middle| half - middle)
        };
        match self.policy {
            CommonMode::Centred => half(),
            CommonMode::Readable => half().min(self.pulse_top(l) - high),
            CommonMode::ClampedLow => half_count() - low,
        }
    }

    /// Lifts voltages of zero middle, words of the nominal bus, to where their pulses lie.
    pub fn lifted<'b>(self, l: &Lowering<'b>, volts: Phases<'b, 3>) -> Phases<'b, 3> {
        let [high, low] = volts.extremes(["pulse_max", "pulse_min"]);
        let lift = self.lift(l, None, [high, low]);
        let lift = if self.second < self.top {
            named! {
                let pulse_second = volts.sum() - high - low;
            }
            let names = ["pulse_second_top", " of the second highest leg"];
            lift.min(Self::pulse(l, self.second, names) - pulse_second)
        } else {
            lift
        };
        named! {
            let pulse_lift = lift;
        }
        volts.map(|volts| volts + pulse_lift)
    }
}

/// Which leg is the highest; of two that are, the first.
fn highest<'b>(legs: Phases<'b, 3>, high: Expr<'b>) -> [Flag<'b>; 3] {
    named! {
        let a_is_high = legs.a().is(high);
        let b_is_high = legs.b().is(high) & !a_is_high;
        let c_is_high = !(a_is_high | b_is_high);
    }
    [a_is_high, b_is_high, c_is_high]
}
