//! Scaling of physical values to words, and rounding of coefficients to their formats (section "Words").

use crate::exact::{Coefficient, Shift, Word, pow2, round_half_up};
use crate::model::variant::Variant;
use crate::{DiscretePhase, Error, FormatTable, Spec};

/// Largest magnitude of a coefficient's word.
const WORD_MAX: f64 = 2_147_483_647.0;

/// Scaling of physical values to words, and the plant of the coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Scale<'a> {
    pub formats: &'a FormatTable,
    pub variant: Variant,
    pub phase: DiscretePhase,
    /// Phase resistance, ohm.
    pub resistance: f64,
    /// Ampere per ADC count.
    pub g: f64,
    /// Volt per timer count.
    pub w: f64,
    /// Nominal bus, volt.
    pub v_bus: f64,
    /// 2^f_i.
    pub two_i: f64,
    /// 2^f_v.
    pub two_v: f64,
    /// Voltage words per current word, times ohm.
    pub ohm: f64,
}

impl<'a> Scale<'a> {
    pub fn new(spec: &Spec, formats: &'a FormatTable) -> Result<Self, Error> {
        let f_i = formats.frac_bits("current")?;
        let f_v = formats.frac_bits("voltage")?;
        if f_v == 0 {
            return Err(Error::Format {
                name: "voltage",
                frac_bits: 0,
                expected: "expected 1 or more",
            });
        }
        let g = spec.inverter.adc_gain.first().abs();
        let w = spec.inverter.v_bus / f64::from(spec.inverter.timer_period);
        Ok(Self {
            formats,
            variant: Variant::new(spec),
            phase: DiscretePhase::new(spec),
            resistance: spec.motor.resistance,
            g,
            w,
            v_bus: spec.inverter.v_bus,
            two_i: pow2(f_i as i32),
            two_v: pow2(f_v as i32),
            ohm: g / w * pow2(f_v as i32 - f_i as i32),
        })
    }

    /// The coefficient of this name, rounded to its format.
    pub fn coefficient<W: Word>(
        &self,
        name: &'static str,
        value: f64,
    ) -> Result<Coefficient<W>, Error> {
        let bits = self.formats.frac_bits(name)?;
        let raw = round_half_up(value * pow2(bits as i32));
        if raw.abs() <= WORD_MAX {
            Ok(Coefficient::new(raw, bits))
        } else {
            Err(Error::Range { name, raw })
        }
    }

    /// Like [`Self::coefficient`]; zero, without a format, if the variant does not use it.
    pub fn only_if<W: Word>(
        &self,
        used: bool,
        name: &'static str,
        value: f64,
    ) -> Result<Coefficient<W>, Error> {
        if used {
            self.coefficient(name, value)
        } else {
            Ok(Coefficient::default())
        }
    }

    /// The shift of a product of two voltages; 0 if the variant does not use it.
    pub fn product_if(&self, used: bool, name: &'static str) -> Result<Shift, Error> {
        if used {
            Ok(Shift::new(self.formats.product_shift(name)?))
        } else {
            Ok(Shift::default())
        }
    }

    /// Fraction bits of a format in excess of those of voltages.
    pub fn extra_bits(&self, name: &'static str) -> Result<i32, Error> {
        let bits = self.formats.frac_bits(name)? as i32;
        Ok(bits - self.formats.frac_bits("voltage")? as i32)
    }

    /// Fraction bits of a format, below 0 where its base is a fraction of a word.
    pub fn signed_bits(&self, name: &'static str) -> Result<i32, Error> {
        Ok(i32::from(self.formats.get(name)?.frac_bits))
    }

    /// Fraction bits of a format; 0 if the variant does not use it.
    pub fn bits_if(&self, used: bool, name: &'static str) -> Result<u32, Error> {
        if used {
            self.formats.frac_bits(name)
        } else {
            Ok(0)
        }
    }
}
