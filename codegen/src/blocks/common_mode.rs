//! The common mode of three pulsed legs: free for the motor, and bound by how long a leg must be low (semantics, step 11).

use super::modulate::half_period;
use super::{Bus, Lowering};
use crate::ir::{Phases, named};
use crate::spec::{BusSource, CommonMode};

/// Legs of which each is low for a while in every period.
#[derive(Clone, Copy, Debug)]
pub struct CommonModeRule {
    /// Where the pulses lie.
    pub policy: CommonMode,
    /// Compare value of 100 % duty.
    period: u32,
    /// Largest compare value.
    top: u32,
}

impl CommonModeRule {
    /// The rule of a policy on this inverter.
    pub fn new(l: &Lowering<'_>, policy: CommonMode) -> Self {
        let inverter = &l.spec.inverter;
        Self {
            policy,
            period: inverter.timer_period,
            top: inverter.readable_top(),
        }
    }

    /// Whether the legs' extremes lie as far from the ends of the period.
    pub fn is_centred(self) -> bool {
        self.policy == CommonMode::Centred
    }

    /// Whether the voltage limit lifts by half the period what it centres.
    pub fn lifts(self, bus: Bus<'_>) -> bool {
        self.is_centred() && bus.ratio.is_none()
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

    /// The largest spread of three phase voltages that fits the legs, as a bus: centred legs leave as much below as above.
    pub fn reach<'b>(self, l: &Lowering<'b>, bus: Bus<'b>) -> Bus<'b> {
        if self.top == self.period {
            return bus;
        }
        let counts = match self.policy {
            CommonMode::Centred => 2 * self.top - self.period,
            CommonMode::Readable | CommonMode::ClampedLow => self.top,
        };
        let share = f64::from(counts) / f64::from(self.period);
        let doc = "Share of the bus that legs reach which must be low for a while.";
        let volts = if let BusSource::Fixed = l.spec.inverter.bus {
            let doc = format!(
                "Voltage that legs reach which must be low for a while: {counts} timer counts, words of voltage."
            );
            l.number("v_reach", i64::from(counts) << l.scale.voltage_bits, &doc)
        } else {
            let k_reach =
                l.coefficient("k_reach", share, l.scale.word, doc, &format!("{share:.6}"));
            named! {
                let v_reach = k_reach * bus.volts;
            }
            v_reach
        };
        Bus { volts, ..bus }
    }

    /// Lifts voltages of zero middle, words of the nominal bus, to where their pulses lie.
    pub fn lifted<'b>(self, l: &Lowering<'b>, volts: Phases<'b, 3>) -> Phases<'b, 3> {
        let half_count = 1_i32 << (l.scale.voltage_bits - 1);
        let half = || half_period(l);
        let [high, low] = volts.extremes(["pulse_max", "pulse_min"]);
        named! {
            let pulse_lift = match self.policy {
                CommonMode::Centred => half(),
                CommonMode::Readable => {
                    let top = (i64::from(self.top) << l.scale.voltage_bits) + i64::from(half_count);
                    let doc = format!("Largest compare value, and half a count to round: {} timer counts, words of voltage.", f64::from(self.top) + 0.5);
                    half().min(l.number("pulse_top", top, &doc) - high)
                }
                CommonMode::ClampedLow => -low + half_count,
            };
        }
        volts.map(|volts| volts + pulse_lift)
    }
}
