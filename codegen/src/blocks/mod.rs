//! Building blocks that laws share, as expressions of design numbers at a scale.
//!
//! Each file builds one or two stages of a step (semantics pages under `laws`); a controller's own
//! folder combines them. Real numbers end here: the results are integers with documentation.

mod angle;
mod bus_current;
mod common_mode;
mod commutation;
mod emf;
mod fade;
mod hall_learning;
mod limit;
mod measure;
mod modulate;
mod number;
mod over_speed;
mod rotor;
pub mod set_point;
mod slew;
mod speed;
mod speed_ramp;
mod speed_rise;
mod table2;
mod torque_learning;
mod weakening;

pub use angle::AngleWords;
pub use bus_current::BusCurrentLimit;
pub use common_mode::CommonModeRule;
pub use commutation::{Commutation, CommutationRule};
pub use emf::{
    Corner, ModelledEmf, ProportionalShape, SHAPE_BITS, lifted, model_emf, model_target_emf,
    proportional_reference, quasi_square_reference,
};
pub use fade::{Allowed, BusFade};
pub use hall_learning::HALL_SHIFTS;
pub use limit::{Hexagon, Limited, Priority};
pub use measure::{Hall, Sample, find_sector, sample, sector_of, sector_word, third_current};
pub use modulate::{
    Applied, Command, LOW, Modulator, OFF, OffLeg, PULSED, StepCommand, across_pair, compare_of,
    limit_line, pair_signs,
};
use number::round_half_up;
pub use number::{product_bound, round_down};
pub use over_speed::{OVER_SPEED_COUNT, OVER_SPEED_EDGES};
pub use rotor::{Rotor, RotorWords, advanced_sector, direction_word, sense_direction};
pub use slew::SlewLimit;
pub use speed::{Regulated, SpeedRegulator};
pub use table2::{Intervals, Table2};
pub use torque_learning::{TORQUE_RATIO, TorqueLearning};
pub use weakening::{FieldWeakening, Weakened};

use crate::diagnostics::engineering;
use crate::interface::{FormatEntry, Rounding};
use crate::ir::{Expr, Interval, Memory, Phases, ProgramBuilder};
use crate::spec::{BusSource, Spec};
use std::cell::RefCell;

/// Scale of a program: word length and fraction bits of currents and voltages.
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
pub struct Bus<'b> {
    /// V_BUS in words of voltage.
    pub volts: Expr<'b>,
    /// Nominal over measured bus voltage and its fraction bits; with a measured bus only.
    pub ratio: Option<(Expr<'b>, u32)>,
}

/// Builder, specification and scale of a program.
#[derive(Debug)]
pub struct Lowering<'b> {
    /// The builder.
    pub b: &'b ProgramBuilder,
    /// The specification.
    pub spec: &'b Spec,
    /// The scale.
    pub scale: Scale,
    notes: RefCell<Notes>,
}

/// Formats and misfits, collected while a program is lowered.
#[derive(Debug, Default)]
pub struct Notes {
    /// Formats used so far.
    pub formats: Vec<FormatEntry>,
    /// Names of coefficients too large for their word.
    pub misfits: Vec<String>,
    /// Names of 32-bit coefficients whose products need more than the upper word.
    pub long_products: Vec<&'static str>,
}

impl<'b> Lowering<'b> {
    /// Starts to lower a program.
    pub fn new(b: &'b ProgramBuilder, spec: &'b Spec, scale: Scale) -> Self {
        let lowering = Self {
            b,
            spec,
            scale,
            notes: RefCell::default(),
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
            // 32 bits at any word length: signals times 16-bit coefficients may be wider than 16
            // bits.
            32,
            scale.voltage_bits as i32,
            Rounding::RoundHalfUp,
            &format!("voltages, base one timer count of {volt} (nominal bus)"),
        );
        lowering
    }

    /// The collected notes.
    pub fn into_notes(self) -> Notes {
        self.notes.into_inner()
    }

    /// Fraction bits, at most 12 beyond those of voltages, with which a state word whose voltages have this
    /// range takes up to `bits` bits. Notes its format.
    fn extra_bits(&self, name: &str, range: Interval, bits: u32, meaning: &str) -> u32 {
        let extra = bits.saturating_sub(range.bits()).min(12);
        let frac_bits = (self.scale.voltage_bits + extra) as i32;
        let meaning = format!("{meaning}, base one timer count of voltage");
        self.format(name, 32, frac_bits, Rounding::RoundHalfUp, &meaning);
        extra
    }

    /// Notes a format, once.
    pub fn format(
        &self,
        name: &str,
        storage_bits: u32,
        frac_bits: i32,
        rounding: Rounding,
        meaning: &str,
    ) {
        self.note_format(FormatEntry {
            name: name.to_owned(),
            storage_bits,
            frac_bits,
            rounding,
            segments: None,
            meaning: meaning.to_owned(),
        });
    }

    fn note_format(&self, format: FormatEntry) {
        let formats = &mut self.notes.borrow_mut().formats;
        if formats.iter().all(|known| known.name != format.name) {
            formats.push(format);
        }
    }

    /// Notes a value that does not fit its word at this scale, once.
    pub fn misfit(&self, name: &str) {
        let misfits = &mut self.notes.borrow_mut().misfits;
        if misfits.iter().all(|known| known != name) {
            misfits.push(name.to_owned());
        }
    }

    /// Notes the format of products of two voltages shifted right by `shift`; more than 31 is a
    /// misfit.
    pub fn product_format(&self, name: &str, shift: u32, meaning: &str) {
        if shift > 31 {
            self.misfit(name);
        }
        let frac_bits = 2 * self.scale.voltage_bits as i32 - shift as i32;
        let meaning = format!("{meaning}, base one squared timer count of voltage");
        self.format(name, 32, frac_bits, Rounding::Floor, &meaning);
    }

    /// States the error bound of a voltage.
    pub fn state_volts(&self, name: &str, volts: Expr<'b>, doc: &str) {
        let word = 1.0 / self.scale.voltage();
        self.b.state_error(name, volts, [doc, "V"], word);
    }

    /// States the error bound of a voltage of phases a and b.
    pub fn state_phase_volts(&self, name: &str, volts: Phases<'b>, doc: &str) {
        for volts in volts.0 {
            self.state_volts(name, volts, doc);
        }
    }

    /// Adds state words of phases a and b with initial value 0.
    pub fn memories(&self, names: [&str; 2], interval: Interval, doc: &str) -> [Memory<'b>; 2] {
        names.map(|name| self.b.memory(name, 0, interval, doc))
    }

    /// Range of currents over all counts and accepted offsets, words of current.
    pub fn current_range(&self) -> Interval {
        let [low, high] = self.spec.inverter.current_range(self.scale.current_bits);
        Interval::new(low, high)
    }

    /// Greatest magnitude of a phase current in words of current.
    pub fn current_span(&self) -> i64 {
        self.current_range().magnitude()
    }

    /// Nominal bus voltage in words of voltage: the timer period.
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
}
