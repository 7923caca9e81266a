//! The names that units are made of.

use super::quantities::Axis;

/// A name of a unit, with its factor to the SI and where that stands.
#[derive(Clone, Copy, Debug)]
pub struct Name {
    /// Its spellings.
    pub spellings: &'static [&'static str],
    /// Prefixes that it takes.
    pub prefixes: &'static str,
    /// Where the factor stands.
    pub source: &'static str,
    /// Powers of what it measures.
    pub(super) powers: &'static [(Axis, i8)],
    /// Factor to the SI, a quotient of two numbers.
    pub(super) factor: [f64; 2],
    /// A weight: the name means a mass where that makes sense.
    pub(super) weighs: bool,
}

const fn name(
    spellings: &'static [&'static str],
    prefixes: &'static str,
    powers: &'static [(Axis, i8)],
    factor: [f64; 2],
    source: &'static str,
) -> Name {
    Name {
        spellings,
        prefixes,
        source,
        powers,
        factor,
        weighs: false,
    }
}

impl Name {
    const fn as_weight(self) -> Self {
        Self {
            weighs: true,
            ..self
        }
    }
}

use Axis as X;
use std::f64::consts::PI;

const SI: &str = "SI Brochure, 9th edition, tables 2 and 4";
const BESIDE_SI: &str = "SI Brochure, 9th edition, table 8";
const NIST: &str = "NIST SP 811 (2008), appendix B.8";
const COUNT: &str = "a plain count";

/// Newton in a pound-force.
const POUND_FORCE: f64 = 4.448_221_615_260_5;
/// Newton in a kilogram-force.
const KILOGRAM_FORCE: f64 = 9.806_65;
/// Kilogram in a pound.
const POUND: f64 = 0.453_592_37;

/// Every name. An ounce is a sixteenth of a pound.
pub const NAMES: &[Name] = &[
    name(
        &["ohm", "Ohm", "ohms", "Ohms"],
        "umkM",
        &[(X::Ohm, 1)],
        [1.0, 1.0],
        SI,
    ),
    name(&["H"], "num", &[(X::Henry, 1)], [1.0, 1.0], SI),
    name(&["A"], "numk", &[(X::Ampere, 1)], [1.0, 1.0], SI),
    name(&["V"], "umk", &[(X::Volt, 1)], [1.0, 1.0], SI),
    name(&["Wb"], "um", &[(X::Weber, 1)], [1.0, 1.0], SI),
    name(&["N"], "mck", &[(X::Newton, 1)], [1.0, 1.0], SI),
    name(&["Hz"], "kMG", &[(X::Hertz, 1)], [1.0, 1.0], SI),
    name(&["rad"], "", &[(X::Radian, 1)], [1.0, 1.0], SI),
    name(&["s", "sec"], "num", &[(X::Second, 1)], [1.0, 1.0], SI),
    name(&["m"], "cm", &[(X::Metre, 1)], [1.0, 1.0], SI),
    name(&["kg"], "", &[(X::Kilogram, 1)], [1.0, 1.0], SI),
    name(&["g"], "", &[(X::Kilogram, 1)], [1.0, 1e3], SI),
    name(&["min"], "", &[(X::Minute, 1)], [1.0, 1.0], BESIDE_SI),
    name(&["deg"], "", &[(X::Degree, 1)], [1.0, 1.0], BESIDE_SI),
    name(
        &["rpm", "RPM", "Rpm"],
        "k",
        &[(X::Radian, 1), (X::Second, -1)],
        [PI, 30.0],
        NIST,
    ),
    name(
        &["rps"],
        "",
        &[(X::Radian, 1), (X::Second, -1)],
        [2.0 * PI, 1.0],
        NIST,
    ),
    name(&["rev", "r"], "", &[(X::Turn, 1)], [1.0, 1.0], NIST),
    name(
        &["kgf", "kp"],
        "",
        &[(X::Newton, 1)],
        [KILOGRAM_FORCE, 1.0],
        NIST,
    ),
    name(&["gf"], "", &[(X::Newton, 1)], [KILOGRAM_FORCE, 1e3], NIST),
    name(&["lbf"], "", &[(X::Newton, 1)], [POUND_FORCE, 1.0], NIST),
    name(&["ozf"], "", &[(X::Newton, 1)], [POUND_FORCE, 16.0], NIST),
    name(&["lb", "lbs"], "", &[(X::Kilogram, 1)], [POUND, 1.0], NIST),
    name(&["oz"], "", &[(X::Kilogram, 1)], [POUND, 16.0], NIST),
    name(&["kg"], "", &[(X::Newton, 1)], [KILOGRAM_FORCE, 1.0], NIST).as_weight(),
    name(&["g"], "", &[(X::Newton, 1)], [KILOGRAM_FORCE, 1e3], NIST).as_weight(),
    name(
        &["lb", "lbs"],
        "",
        &[(X::Newton, 1)],
        [POUND_FORCE, 1.0],
        NIST,
    )
    .as_weight(),
    name(&["oz"], "", &[(X::Newton, 1)], [POUND_FORCE, 16.0], NIST).as_weight(),
    name(&["ft"], "", &[(X::Metre, 1)], [0.3048, 1.0], NIST),
    name(&["in", "inch"], "", &[(X::Metre, 1)], [0.0254, 1.0], NIST),
    name(&["%"], "", &[(X::Percent, 1)], [1.0, 1.0], BESIDE_SI),
    name(
        &["count", "counts", "LSB", "lsb"],
        "",
        &[(X::Count, 1)],
        [1.0, 1.0],
        COUNT,
    ),
    name(
        &["periods", "period"],
        "",
        &[(X::Period, 1)],
        [1.0, 1.0],
        COUNT,
    ),
];

/// Factor of a prefix, a quotient of two numbers.
pub(super) fn prefix(letter: char) -> Option<[f64; 2]> {
    Some(match letter {
        'G' => [1e9, 1.0],
        'M' => [1e6, 1.0],
        'k' => [1e3, 1.0],
        'c' => [1.0, 1e2],
        'm' => [1.0, 1e3],
        'u' => [1.0, 1e6],
        'n' => [1.0, 1e9],
        _ => return None,
    })
}
