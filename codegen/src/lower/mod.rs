//! Lowering: from design numbers and a scale to IR, in building blocks that controllers share.
//!
//! Each file here builds one or two stages of a step (semantics pages under `controllers`); a
//! controller's own folder strings them together. Real numbers end here: what leaves is integers
//! with their meaning as documentation.

mod emf;
mod limit;
mod measure;
mod modulate;
mod number;
mod rotor;
pub mod set_point;
mod speed;

pub use emf::{Corner, FluxModel, ModelledEmf};
pub use limit::{Limited, Priority};
pub use measure::{Currents, Hall, Sample};
pub use modulate::{Applied, Command, Commutation, OffLeg, PairModulation, PairPulses};
use number::round_half_up;
pub use number::{Coefficient, product_bound, round_down};
pub use rotor::{Rotor, RotorWords};
pub use speed::{Regulated, SpeedState};

use crate::diagnostics::engineering;
use crate::interface::{FormatEntry, Rounding};
use crate::ir::{FunctionBuilder, Interval, Program, StateId, Value};
use crate::spec::{BusSource, Spec};

/// The scale of a program: how physical quantities become integers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Word length of the control arithmetic: 16 or 32 bits.
    pub word: u32,
    /// Fraction bits of currents; their base is one ADC count.
    pub current_bits: u32,
    /// Fraction bits of voltages; their base is one timer count.
    pub voltage_bits: u32,
    /// Ampere per ADC count, positive.
    pub ampere_per_count: f64,
    /// Volt per timer count at the nominal bus.
    pub volt_per_count: f64,
}

impl Scale {
    /// Words per ampere.
    pub fn current(&self) -> f64 {
        f64::from(self.current_bits).exp2() / self.ampere_per_count
    }

    /// Words per volt.
    pub fn voltage(&self) -> f64 {
        f64::from(self.voltage_bits).exp2() / self.volt_per_count
    }
}

/// The bus voltage as the step sees it.
#[derive(Clone, Copy, Debug)]
pub struct Bus {
    /// V_BUS in words of voltage.
    pub volts: Value,
    /// Nominal over measured, and its shift, where the bus is measured.
    pub ratio: Option<(Value, u32)>,
}

/// A step under construction.
#[derive(Debug)]
pub struct Lowering<'p> {
    /// The function builder.
    pub b: FunctionBuilder<'p>,
    /// The specification.
    pub spec: &'p Spec,
    /// The scale.
    pub scale: Scale,
    /// Formats used so far.
    pub formats: Vec<FormatEntry>,
    /// Names of coefficients too large for their word.
    pub misfits: Vec<String>,
    /// Names of impedances of 32 bits whose products need more than their upper word.
    pub long_products: Vec<&'static str>,
}

impl<'p> Lowering<'p> {
    /// Starts the step of `program`.
    pub fn new(program: &'p mut Program, spec: &'p Spec, scale: Scale) -> Self {
        let b = FunctionBuilder::new(program, "step", &["One control period."]);
        let mut lowering = Self {
            b,
            spec,
            scale,
            formats: vec![],
            misfits: vec![],
            long_products: vec![],
        };
        let ampere = engineering(scale.ampere_per_count, "A");
        let volt = engineering(scale.volt_per_count, "V");
        let word = scale.word;
        lowering.format(
            "current",
            word,
            scale.current_bits as i32,
            Rounding::Floor,
            &format!("currents, base one ADC count of {ampere}"),
        );
        lowering.format(
            "voltage",
            // Whatever the word of the arithmetic: what is multiplied by 16-bit coefficients is wider.
            32,
            scale.voltage_bits as i32,
            Rounding::RoundHalfUp,
            &format!("voltages, base one timer count of {volt} (nominal bus)"),
        );
        lowering
    }

    /// Notes a format, once.
    pub fn format(
        &mut self,
        name: &str,
        storage_bits: u32,
        frac_bits: i32,
        rounding: Rounding,
        meaning: &str,
    ) {
        if self.formats.iter().all(|known| known.name != name) {
            self.formats.push(FormatEntry {
                name: name.to_owned(),
                storage_bits,
                frac_bits,
                rounding,
                segments: None,
                meaning: meaning.to_owned(),
            });
        }
    }

    /// Notes the format of products of two voltages that are shifted right by so many bits.
    pub fn product_format(&mut self, name: &str, shift: u32, meaning: &str) {
        let frac_bits = 2 * self.scale.voltage_bits as i32 - shift as i32;
        let meaning = format!("{meaning}, base one squared timer count of voltage");
        self.format(name, 32, frac_bits, Rounding::Floor, &meaning);
    }

    /// Adds a state word.
    pub fn state(&mut self, name: &str, initial: i32, interval: Interval, doc: &str) -> StateId {
        self.b.program.state(name, initial, interval, doc)
    }

    /// Currents of all counts at all offsets that calibration accepts, words of current.
    pub fn current_range(&self) -> Interval {
        let [low, high] = self.spec.inverter.current_counts();
        let bits = self.scale.current_bits;
        Interval::new(i64::from(low) << bits, i64::from(high) << bits)
    }

    /// Greatest magnitude of a phase current in words of current.
    pub fn current_span(&self) -> i64 {
        self.current_range().magnitude()
    }

    /// Full timer period in words of voltage: the nominal bus.
    pub fn nominal_bus(&self) -> i64 {
        i64::from(self.spec.inverter.timer_period) << self.scale.voltage_bits
    }

    /// The interval of V_BUS in words of voltage.
    pub fn bus_interval(&self) -> Interval {
        match self.spec.inverter.bus {
            BusSource::Fixed => Interval::point(self.nominal_bus()),
            BusSource::Measured { min, max, .. } => {
                Interval::new(self.volts_word(min), self.volts_word(max))
            }
        }
    }

    /// A voltage in words, rounded half up.
    pub fn volts_word(&self, volts: f64) -> i64 {
        round_half_up(volts * self.scale.voltage()) as i64
    }

    /// A current in words, rounded half up.
    pub fn ampere_word(&self, ampere: f64) -> i64 {
        round_half_up(ampere * self.scale.current()) as i64
    }

    /// The commonest select: the value of one of three phases, by two flags: `a` if `is_a`, else `b` if `is_b`, else `c`.
    pub fn pick(&mut self, is_a: Value, is_b: Value, [a, b, c]: [Value; 3]) -> Value {
        let rest = self.b.select(is_b, b, c);
        self.b.select(is_a, a, rest)
    }

    /// A zero that may be used anywhere behind this point.
    pub fn zero(&mut self) -> Value {
        self.b.literal(0)
    }

    /// Named largest and smallest of three phase values, in the form that the spread rule knows.
    pub fn extremes(&mut self, names: [&str; 2], [a, b, c]: [Value; 3]) -> [Value; 2] {
        let pair = self.b.max(a, b);
        let high = self.b.max(pair, c);
        self.b.name(names[0], high);
        let pair = self.b.min(a, b);
        let low = self.b.min(pair, c);
        self.b.name(names[1], low);
        [high, low]
    }

    /// `-(a + b)`, the third of three values that sum to zero.
    pub fn third_phase(&mut self, name: &str, a: Value, b: Value) -> Value {
        let sum = self.b.add(a, b);
        let c = self.b.neg(sum);
        self.b.name(name, c)
    }
}
