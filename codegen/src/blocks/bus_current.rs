//! Limits of the bus current (shared semantics page, "Bus current").

use super::fade::Allowed;
use super::number::round_half_up;
use super::set_point::{SetPointWords, largest_set_point};
use super::{Command, Lowering, OFF, PULSED};
use crate::diagnostics::engineering;
use crate::interface::Rounding;
use crate::ir::{Coefficient, Exact, Expr, Interval, Memory, Phases, Real, named};
use crate::spec::BusCurrents;

/// Control periods in which a bus current that is too high by 1 A takes back 1 A of the set-point. With full
/// duty the bus current is that of the phases, and the loop's gain is largest; twice the time constant of the
/// mean damps it then, too.
const PERIODS: u32 = 32;

/// Base-2 logarithm of the periods of the mean, which takes the switching between vectors out.
const MEAN_LOG2: u32 = 4;

/// Bits of the set-point withheld: with short words a step of the set-point's word would be too much for a
/// period.
const BITS: u32 = 29;

/// The set-point's limits by the bus current, which duties and phase currents tell.
#[derive(Clone, Copy, Debug)]
pub struct BusCurrentLimit<'b> {
    limits: BusCurrents,
    /// By how much the set-point is limited below the largest.
    withheld: Memory<'b>,
    /// Its fraction bits beyond those of voltages.
    extra: u32,
    /// Greatest set-point word that a setter makes.
    top: i64,
    /// Compare values of phases a and b less that of phase c: of the command that applies from now on,
    /// if that of the last step does, and of the period that has ended.
    commanded: Option<[Memory<'b>; 2]>,
    ended: [Memory<'b>; 2],
    /// Mean of twice the bus current.
    mean: Memory<'b>,
    /// Bits by which currents are shifted down, so that their products with compare values fit a word.
    shift: u32,
    /// The set-point's gain, V/A.
    gain: f64,
}

impl<'b> BusCurrentLimit<'b> {
    /// Declares the words; none without a limit.
    pub fn new(l: &Lowering<'b>, delay: u32, set_point: &SetPointWords<'b>) -> Option<Self> {
        let limits = l.spec.inverter.bus_currents;
        if !limits.are_limited() {
            return None;
        }
        let doc =
            "By how much the bus current limits the set-point below the largest, words of voltage.";
        let range = Interval::new(0, set_point.top);
        let extra = l.extra_bits("j_withheld", range, BITS, "set-point withheld");
        let range = Interval::new(0, set_point.top << extra);
        let withheld = l.b.memory("j_withheld", 0, range, doc);
        let range = Interval::symmetric(i64::from(l.spec.inverter.timer_period));
        let commanded = (delay == 1).then(|| {
            let doc = "Compare value less that of phase c, of the last step's command.";
            l.memories(["line_a_cmd", "line_b_cmd"], range, doc)
        });
        let doc = "Compare value less that of phase c, in the period that has ended.";
        let ended = l.memories(["line_a_ended", "line_b_ended"], range, doc);
        // Two products of twice a compare value at most, and a difference on top.
        let most = (1 << 27) / range.high;
        let span = 1_i64 << (l.spec.inverter.adc_bits + l.scale.current_bits);
        let shift = (0..31).find(|shift| span >> shift < most);
        let shift = shift.unwrap_or(31);
        let frac_bits = l.scale.current_bits as i32 - shift as i32;
        let meaning = "twice the bus current, base one ADC count times one timer count";
        l.format("i_bus", 32, frac_bits, Rounding::Floor, meaning);
        let most = 4 * range.high * ((span >> shift) + 1);
        let doc = "Mean of twice the bus current.";
        let mean = l.b.memory("i_bus_mean", 0, Interval::symmetric(most), doc);
        Some(Self {
            limits,
            withheld,
            extra,
            top: set_point.top,
            commanded,
            ended,
            mean,
            shift,
            gain: set_point.gain.value,
        })
    }

    /// The limits of the set-point, within those by the bus voltage.
    pub fn allowed(&self, l: &Lowering<'b>, others: Option<Allowed<'b>>) -> Allowed<'b> {
        let doc = "Limits of the set-point by the bus current, alike in both directions.";
        l.b.stage("limit_bus_current", &[doc]);
        let largest = largest_set_point(l, self.top);
        let withheld = match self.extra {
            0 => self.withheld.read(),
            extra => self.withheld.read() >> extra,
        };
        Allowed::of_either_way(largest - withheld, others)
    }

    /// Words of twice the bus current per ampere.
    fn per_ampere(&self, l: &Lowering<'_>) -> f64 {
        let counts = l.scale.current() / f64::from(self.shift).exp2();
        2.0 * f64::from(l.spec.inverter.timer_period) * counts
    }

    fn limit(&self, l: &Lowering<'b>, name: &str, what: &str, ampere: f64) -> Expr<'b> {
        let exact = ampere * self.per_ampere(l);
        let doc = format!("{what}, {}, in units of `i_bus`.", engineering(ampere, "A"));
        let raw = (exact + 0.5).floor() as i64;
        l.rounded_number(name, raw, Exact::Number(Real::of(exact)), &doc)
    }

    /// The share of a distance to a limit by which the set-point moves in a period.
    fn share(&self, l: &Lowering<'_>) -> Coefficient {
        let words = self.gain * l.scale.voltage() * f64::from(self.extra).exp2();
        let words = words / f64::from(PERIODS);
        l.scaled_coefficient(
            "k_bus_current",
            words / self.per_ampere(l),
            32,
            [
                "Set-point taken back or given back in a period, by the distance of the bus current to its limit.",
                &format!("1/{PERIODS} of a set-point's ampere per ampere"),
            ],
            ["K/32/w 2^f_v per word of `i_bus`", "words of the set-point withheld"],
        )
    }

    /// The words and their new values, from the currents and this step's command. The period that has
    /// ended and the one that begins count half each: with the currents between them.
    pub fn follow(
        &self,
        l: &Lowering<'b>,
        currents: Phases<'b, 3>,
        command: &Command<'b>,
    ) -> Vec<(Memory<'b>, Expr<'b>)> {
        let k_bus_current = self.share(l);
        l.b.stage(
            "follow_bus_current",
            &[
                "Twice the bus current, the sum of duties times phase currents, over the period that has ended and the one that",
                "begins; and the set-point withheld, which grows with what its mean exceeds a limit by and falls with what is left.",
            ],
        );
        let [a, b, c] = duties(l, currents, command).0;
        named! {
            let line_new = Phases([a - c, b - c]);
        }
        let ended = Phases(self.ended.map(Memory::read));
        let begins = match self.commanded {
            Some(words) => Phases(words.map(Memory::read)),
            None => line_new,
        };
        let [line_a, line_b] = (ended + begins).0;
        named! {
            let i_counted = currents.map(|current| current >> self.shift);
        }
        let paid = line_a * i_counted.a() + line_b * i_counted.b();
        let i_bus = match dead_counts(l) {
            Some(dead) => paid - dead * switched(l, i_counted, command),
            None => paid,
        };
        let (mean, most_mean) = (self.mean.read(), self.mean.read().interval().high as i32);
        let most = self.withheld.read().interval().high as i32;
        named! {
            let i_bus = i_bus;
            let i_bus_mean_new = (mean + ((i_bus - mean) >> MEAN_LOG2)).clamp(-most_mean, most_mean);
        }
        let drawn = (self.limits.drawn).map(|most| {
            self.limit(l, "bus_drawn_max", "Greatest bus current", most) - i_bus_mean_new
        });
        let returned = (self.limits.returned).map(|most| {
            let what = "Greatest current into the supply";
            i_bus_mean_new + self.limit(l, "bus_returned_max", what, most)
        });
        let left = drawn.into_iter().chain(returned);
        named! {
            let i_bus_left = left.reduce(Expr::min).unwrap_or(i_bus_mean_new);
            let j_withheld_new = (self.withheld.read() - k_bus_current * i_bus_left).clamp(0, most);
        }
        let ends = |words: [Memory<'b>; 2], values: Phases<'b>| words.into_iter().zip(values.0);
        [(self.withheld, j_withheld_new), (self.mean, i_bus_mean_new)]
            .into_iter()
            .chain(
                self.commanded
                    .into_iter()
                    .flat_map(|words| ends(words, line_new)),
            )
            .chain(ends(self.ended, begins))
            .collect()
    }
}

/// Compare values by which the legs conduct to the upper rail: that of an off leg whose upper diode
/// conducts is the whole period.
fn duties<'b>(l: &Lowering<'b>, currents: Phases<'b, 3>, command: &Command<'b>) -> Phases<'b, 3> {
    if !turns_off(l) {
        return command.compares;
    }
    let top = i64::from(l.spec.inverter.timer_period);
    let doc = "The whole period, timer counts.";
    let top = l.number("whole_period", top, doc);
    named! {
        let conducting = Phases::<3>::each(|x| {
            let diode = currents.0[x].is_below(0).choose(top, 0);
            command.legs.0[x].is(OFF).choose(diode, command.compares.0[x])
        });
    }
    conducting
}

/// Twice the timer counts that a leg's pulse loses to the dead time; with pulses and a dead time only.
fn dead_counts<'b>(l: &Lowering<'b>) -> Option<Expr<'b>> {
    let inverter = &l.spec.inverter;
    let lost = inverter.dead_time / inverter.pwm_period() * f64::from(inverter.timer_period);
    (l.spec.controller.modulates() && lost > 0.0).then(|| {
        let dead_time = engineering(inverter.dead_time, "s");
        let doc = format!("Twice the timer counts lost to {dead_time} of dead time.");
        l.number("dead_counts", round_half_up(2.0 * lost) as i64, &doc)
    })
}

/// Whether the law turns legs off.
fn turns_off(l: &Lowering<'_>) -> bool {
    l.spec.controller.turns_off().is_some()
}

/// Sum of the magnitudes of the currents whose legs are pulsed.
fn switched<'b>(l: &Lowering<'b>, currents: Phases<'b, 3>, command: &Command<'b>) -> Expr<'b> {
    // Without a common mode a leg may be low or off.
    let all_pulsed = l.spec.controller.common_mode().is_some();
    let each = Phases::<3>::each(|x| {
        let magnitude = currents.0[x].abs();
        if all_pulsed {
            magnitude
        } else {
            command.legs.0[x].is(PULSED).choose(magnitude, 0)
        }
    });
    each.sum()
}
