//! Units of the specification: a closed list of spellings with quantity and SI factor. The symbols
//! Ω, µ, ° and ² are accepted for `ohm`, `u`, `deg` and `2`.
//!
//! Mechanical speed is in rad/s, so `V/krpm` and `V/(rad/s)` are one quantity; `V/Hz` and `Wb` are
//! flux linkages per electrical angle, another one.

use std::f64::consts::{PI, TAU};

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// SI: ohm.
    Resistance,
    /// SI: henry.
    Inductance,
    /// SI: ampere.
    Current,
    /// SI: volt.
    Voltage,
    /// SI: second.
    Time,
    /// SI: hertz.
    Frequency,
    /// SI: rad/s, mechanical.
    Speed,
    /// SI: V s/rad, mechanical.
    EmfConstant,
    /// Speed over voltage, (rad/s)/V: the reciprocal of an EMF constant.
    SpeedConstant,
    /// SI: weber = V s per electrical radian.
    FluxLinkage,
    /// SI: Nm.
    Torque,
    /// SI: Nm/A.
    TorqueConstant,
    /// SI: kg m2.
    Inertia,
    /// Degrees (not radian: electrical angles are stated and computed in degrees here).
    Angle,
    /// A ratio; percent are converted to it.
    Ratio,
    /// Ampere per ADC count.
    CurrentPerCount,
    /// Control periods.
    Periods,
}

impl Dimension {
    /// With article, for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Resistance => "a resistance",
            Self::Inductance => "an inductance",
            Self::Current => "a current",
            Self::Voltage => "a voltage",
            Self::Time => "a time",
            Self::Frequency => "a frequency",
            Self::Speed => "a speed",
            Self::EmfConstant => "an EMF constant",
            Self::SpeedConstant => "a speed constant",
            Self::FluxLinkage => "a flux linkage",
            Self::Torque => "a torque",
            Self::TorqueConstant => "a torque constant",
            Self::Inertia => "an inertia",
            Self::Angle => "an angle",
            Self::Ratio => "a ratio",
            Self::CurrentPerCount => "a current per ADC count",
            Self::Periods => "a number of control periods",
        }
    }
}

/// A unit as spelled by the user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Canonical spelling, e.g. `V/(rad/s)`.
    pub symbol: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Units per SI unit or SI units per unit, whichever is exact (see `to_si`).
    factor: Factor,
}

/// 0.22e-3 is not 0.22/1000 in binary: dividing by an exact power of ten rounds only once.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Factor {
    Times(f64),
    Over(f64),
}

impl Unit {
    /// A value in this unit as SI value.
    pub fn to_si(self, value: f64) -> f64 {
        match self.factor {
            Factor::Times(factor) => value * factor,
            Factor::Over(factor) => value / factor,
        }
    }

    /// The unit of the given spelling. Products are spelled with single spaces (`kg m2`,
    /// `V s/rad`), quotients without spaces.
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        let letters = in_letters(symbol);
        UNITS.iter().copied().find(|unit| unit.symbol == letters)
    }

    /// The closest known spelling among units of the given quantities, within one letter in three
    /// or a difference of case.
    pub fn nearest(symbol: &str, dimensions: &[Dimension]) -> Option<&'static str> {
        let letters = in_letters(symbol);
        let folded = letters.to_lowercase();
        UNITS
            .iter()
            .filter(|unit| dimensions.contains(&unit.dimension))
            .map(|unit| {
                // A wrong case alone (`KHz`, `Ohm`) is the closest mistake.
                let cased = usize::from(unit.symbol != letters);
                (
                    2 * strsim::levenshtein(&unit.symbol.to_lowercase(), &folded) + cased,
                    unit.symbol,
                )
            })
            .min()
            .filter(|(distance, _)| *distance <= letters.chars().count().min(3))
            .map(|(_, symbol)| symbol)
    }
}

/// The spelling with letters in place of symbols; ohm and micro have two code points each.
fn in_letters(symbol: &str) -> String {
    let mut letters = String::new();
    for sign in symbol.chars() {
        match sign {
            '\u{3a9}' | '\u{2126}' => letters.push_str("ohm"),
            '\u{b5}' | '\u{3bc}' => letters.push('u'),
            '\u{b0}' => letters.push_str("deg"),
            '\u{b2}' => letters.push('2'),
            letter => letters.push(letter),
        }
    }
    letters
}

const fn times(symbol: &'static str, dimension: Dimension, factor: f64) -> Unit {
    Unit {
        symbol,
        dimension,
        factor: Factor::Times(factor),
    }
}

const fn over(symbol: &'static str, dimension: Dimension, factor: f64) -> Unit {
    Unit {
        symbol,
        dimension,
        factor: Factor::Over(factor),
    }
}

use Dimension as D;

/// Every accepted spelling.
const UNITS: &[Unit] = &[
    times("ohm", D::Resistance, 1.0),
    over("mohm", D::Resistance, 1e3),
    over("uohm", D::Resistance, 1e6),
    times("kohm", D::Resistance, 1e3),
    times("H", D::Inductance, 1.0),
    over("mH", D::Inductance, 1e3),
    over("uH", D::Inductance, 1e6),
    over("nH", D::Inductance, 1e9),
    times("A", D::Current, 1.0),
    over("mA", D::Current, 1e3),
    times("kA", D::Current, 1e3),
    times("V", D::Voltage, 1.0),
    over("mV", D::Voltage, 1e3),
    times("kV", D::Voltage, 1e3),
    times("s", D::Time, 1.0),
    over("ms", D::Time, 1e3),
    over("us", D::Time, 1e6),
    over("ns", D::Time, 1e9),
    times("Hz", D::Frequency, 1.0),
    times("kHz", D::Frequency, 1e3),
    times("MHz", D::Frequency, 1e6),
    times("GHz", D::Frequency, 1e9),
    times("rad/s", D::Speed, 1.0),
    times("rpm", D::Speed, PI / 30.0),
    times("krpm", D::Speed, 1e3 * PI / 30.0),
    times("V/(rad/s)", D::EmfConstant, 1.0),
    times("V s/rad", D::EmfConstant, 1.0),
    over("mV/(rad/s)", D::EmfConstant, 1e3),
    over("mV s/rad", D::EmfConstant, 1e3),
    times("V/krpm", D::EmfConstant, 30.0 / (1e3 * PI)),
    times("V/rpm", D::EmfConstant, 30.0 / PI),
    times("mV/rpm", D::EmfConstant, 30.0 / (1e3 * PI)),
    times("rpm/V", D::SpeedConstant, PI / 30.0),
    times("(rad/s)/V", D::SpeedConstant, 1.0),
    times("Wb", D::FluxLinkage, 1.0),
    over("mWb", D::FluxLinkage, 1e3),
    over("uWb", D::FluxLinkage, 1e6),
    over("V/Hz", D::FluxLinkage, TAU),
    over("mV/Hz", D::FluxLinkage, 1e3 * TAU),
    times("Nm", D::Torque, 1.0),
    times("N m", D::Torque, 1.0),
    over("mNm", D::Torque, 1e3),
    over("mN m", D::Torque, 1e3),
    over("Ncm", D::Torque, 1e2),
    times("Nm/A", D::TorqueConstant, 1.0),
    times("N m/A", D::TorqueConstant, 1.0),
    over("mNm/A", D::TorqueConstant, 1e3),
    over("mN m/A", D::TorqueConstant, 1e3),
    times("kg m2", D::Inertia, 1.0),
    times("kgm2", D::Inertia, 1.0),
    over("kg cm2", D::Inertia, 1e4),
    over("kgcm2", D::Inertia, 1e4),
    over("g cm2", D::Inertia, 1e7),
    over("gcm2", D::Inertia, 1e7),
    times("deg", D::Angle, 1.0),
    times("rad", D::Angle, 180.0 / PI),
    over("%", D::Ratio, 1e2),
    times("A/count", D::CurrentPerCount, 1.0),
    over("mA/count", D::CurrentPerCount, 1e3),
    over("uA/count", D::CurrentPerCount, 1e6),
    times("periods", D::Periods, 1.0),
    times("period", D::Periods, 1.0),
];

#[cfg(test)]
mod tests {
    use super::{Dimension, UNITS, Unit};

    fn si(value: f64, symbol: &str) -> f64 {
        Unit::from_symbol(symbol).expect("known unit").to_si(value)
    }

    #[test]
    fn factors() {
        assert_eq!(si(0.22, "mH"), 0.00022);
        assert_eq!(si(135.0, "mohm"), 0.135);
        assert_eq!(si(50.0, "us"), 5e-5);
        assert_eq!(si(2.4, "g cm2"), 2.4e-7);
        assert_eq!(si(10.0, "%"), 0.1);
        for (value, symbol, expected) in [
            (2000.0, "rpm", 209.439_510_239_319_55),
            (4.64, "V/krpm", 0.044_308_736_15),
            (0.0979, "V/Hz", 0.015_581_268_93),
            (4600.0, "rpm/V", 481.710_873_550),
        ] {
            assert!(
                (si(value, symbol) / expected - 1.0).abs() < 1e-9,
                "{value} {symbol}"
            );
        }
    }

    #[test]
    fn signs_of_print_are_letters() {
        for (symbol, letters) in [
            ("\u{3a9}", "ohm"),
            ("m\u{2126}", "mohm"),
            ("\u{b5}H", "uH"),
            ("\u{3bc}s", "us"),
            ("\u{b0}", "deg"),
            ("kg m\u{b2}", "kg m2"),
        ] {
            let unit = Unit::from_symbol(symbol);
            assert_eq!(unit.map(|unit| unit.symbol), Some(letters));
        }
    }

    #[test]
    fn symbols_are_unique() {
        for (index, unit) in UNITS.iter().enumerate() {
            assert!(
                UNITS[..index]
                    .iter()
                    .all(|other| other.symbol != unit.symbol),
                "{unit:?}"
            );
        }
    }

    #[test]
    fn nearest_spelling() {
        use Dimension::{Current, Frequency, Inductance, Ratio, Resistance, Time};
        for (symbol, dimension, nearest) in [
            ("KHz", Frequency, Some("kHz")),
            ("Ohm", Resistance, Some("ohm")),
            ("ohms", Resistance, Some("ohm")),
            ("m\u{3a9}s", Resistance, Some("mohm")),
            ("v", Current, None),
            ("a", Current, Some("A")),
            // One letter is no likeness, nor is another quantity's unit.
            ("W", Current, None),
            ("W", Ratio, None),
            ("pH", Inductance, None),
            ("mm", Time, None),
            ("KHz", Time, None),
            ("furlong", Resistance, None),
        ] {
            assert_eq!(Unit::nearest(symbol, &[dimension]), nearest, "{symbol}");
        }
        assert_eq!(
            Unit::from_symbol("mWb").map(|unit| unit.dimension),
            Some(Dimension::FluxLinkage)
        );
    }
}
