//! The format table of a drive: the only numbers taken from the generator.

use crate::Error;
use hexagen::Format;

/// Formats of a drive's signals and coefficients, by name.
#[derive(Clone, Debug)]
pub struct FormatTable {
    formats: Vec<Format>,
}

impl FormatTable {
    /// A table of the given formats (`Drive::FORMATS`).
    pub fn new(formats: &[Format]) -> Self {
        Self {
            formats: formats.to_vec(),
        }
    }

    /// The format of this name.
    ///
    /// # Errors
    /// If there is none.
    pub fn get(&self, name: &'static str) -> Result<&Format, Error> {
        self.formats
            .iter()
            .find(|format| format.name == name)
            .ok_or(Error::NoFormat(name))
    }

    /// Fraction bits of a signal, or the shift of a coefficient; not negative.
    ///
    /// # Errors
    /// If there is no such format or its fraction bits are negative.
    pub fn frac_bits(&self, name: &'static str) -> Result<u32, Error> {
        let frac_bits = i32::from(self.get(name)?.frac_bits);
        u32::try_from(frac_bits).map_err(|_| Error::Format {
            name,
            frac_bits,
            expected: "expected 0 or more",
        })
    }

    /// The shift of a product of two voltages: the excess of the factors' fraction bits over the
    /// product's.
    ///
    /// # Errors
    /// If there is no such format, or the product has more fraction bits than its factors.
    pub fn product_shift(&self, name: &'static str) -> Result<u32, Error> {
        let factors = 2 * i32::from(self.get("voltage")?.frac_bits);
        let frac_bits = i32::from(self.get(name)?.frac_bits);
        u32::try_from(factors - frac_bits).map_err(|_| Error::Format {
            name,
            frac_bits,
            expected: "expected at most twice the voltage's",
        })
    }

    /// Number of segments of a table.
    ///
    /// # Errors
    /// If there is no such entry or the number is none of 12, 24, 48, 96.
    pub fn segments(&self, name: &'static str) -> Result<u32, Error> {
        let segments = self.get(name)?.segments;
        match segments {
            12 | 24 | 48 | 96 => Ok(u32::from(segments)),
            _ => Err(Error::Segments { name, segments }),
        }
    }
}
