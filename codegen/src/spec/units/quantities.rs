//! What products of units measure.

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
    /// SI: V/A, of a current sensor.
    Sensitivity,
    /// SI: A/s.
    CurrentRate,
    /// Speed per time.
    SpeedRate,
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
            Self::Sensitivity => "a voltage per current",
            Self::CurrentRate => "a current per time",
            Self::SpeedRate => "a speed per time",
            Self::Periods => "a number of control periods",
        }
    }
}

/// What names of units are products of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    Volt,
    Ampere,
    Ohm,
    Henry,
    Weber,
    Newton,
    Kilogram,
    Metre,
    Second,
    Minute,
    Radian,
    Degree,
    Turn,
    Hertz,
    Percent,
    Count,
    Period,
}

/// Powers of all axes.
pub(super) type Powers = [i8; Axis::Period as usize + 1];

const fn powers(list: &[(Axis, i8)]) -> Powers {
    let mut powers = [0; Axis::Period as usize + 1];
    let mut index = 0;
    while index < list.len() {
        powers[list[index].0 as usize] = list[index].1;
        index += 1;
    }
    powers
}

use Axis as X;
use Dimension as D;

/// Products that are a quantity, with their factor to its SI unit, a quotient of two numbers. A turn
/// in a minute may stand without its turn: `1/min` is a speed, as data sheets write it.
const QUANTITIES: &[(Powers, D, [f64; 2])] = &[
    (powers(&[(X::Ohm, 1)]), D::Resistance, [1.0, 1.0]),
    (powers(&[(X::Henry, 1)]), D::Inductance, [1.0, 1.0]),
    (powers(&[(X::Ampere, 1)]), D::Current, [1.0, 1.0]),
    (powers(&[(X::Volt, 1)]), D::Voltage, [1.0, 1.0]),
    (powers(&[(X::Second, 1)]), D::Time, [1.0, 1.0]),
    (powers(&[(X::Hertz, 1)]), D::Frequency, [1.0, 1.0]),
    (
        powers(&[(X::Radian, 1), (X::Second, -1)]),
        D::Speed,
        [1.0, 1.0],
    ),
    (powers(&[(X::Minute, -1)]), D::Speed, [PI, 30.0]),
    (
        powers(&[(X::Turn, 1), (X::Minute, -1)]),
        D::Speed,
        [PI, 30.0],
    ),
    (
        powers(&[(X::Volt, 1), (X::Second, 1), (X::Radian, -1)]),
        D::EmfConstant,
        [1.0, 1.0],
    ),
    (
        powers(&[(X::Volt, 1), (X::Minute, 1)]),
        D::EmfConstant,
        [30.0, PI],
    ),
    (
        powers(&[(X::Volt, 1), (X::Minute, 1), (X::Turn, -1)]),
        D::EmfConstant,
        [30.0, PI],
    ),
    (
        powers(&[(X::Volt, -1), (X::Second, -1), (X::Radian, 1)]),
        D::SpeedConstant,
        [1.0, 1.0],
    ),
    (
        powers(&[(X::Volt, -1), (X::Minute, -1)]),
        D::SpeedConstant,
        [PI, 30.0],
    ),
    (
        powers(&[(X::Volt, -1), (X::Minute, -1), (X::Turn, 1)]),
        D::SpeedConstant,
        [PI, 30.0],
    ),
    (powers(&[(X::Weber, 1)]), D::FluxLinkage, [1.0, 1.0]),
    (
        powers(&[(X::Volt, 1), (X::Hertz, -1)]),
        D::FluxLinkage,
        [1.0, TAU],
    ),
    (
        powers(&[(X::Newton, 1), (X::Metre, 1)]),
        D::Torque,
        [1.0, 1.0],
    ),
    (
        powers(&[(X::Newton, 1), (X::Metre, 1), (X::Ampere, -1)]),
        D::TorqueConstant,
        [1.0, 1.0],
    ),
    (
        powers(&[(X::Kilogram, 1), (X::Metre, 2)]),
        D::Inertia,
        [1.0, 1.0],
    ),
    (
        powers(&[(X::Newton, 1), (X::Metre, 1), (X::Second, 2)]),
        D::Inertia,
        [1.0, 1.0],
    ),
    (powers(&[(X::Degree, 1)]), D::Angle, [1.0, 1.0]),
    (powers(&[(X::Radian, 1)]), D::Angle, [180.0, PI]),
    (powers(&[(X::Percent, 1)]), D::Ratio, [1.0, 1e2]),
    (
        powers(&[(X::Ampere, 1), (X::Count, -1)]),
        D::CurrentPerCount,
        [1.0, 1.0],
    ),
    (
        powers(&[(X::Volt, 1), (X::Ampere, -1)]),
        D::Sensitivity,
        [1.0, 1.0],
    ),
    (
        powers(&[(X::Ampere, 1), (X::Second, -1)]),
        D::CurrentRate,
        [1.0, 1.0],
    ),
    (
        powers(&[(X::Turn, 1), (X::Minute, -1), (X::Second, -1)]),
        D::SpeedRate,
        [PI, 30.0],
    ),
    (
        powers(&[(X::Radian, 1), (X::Second, -2)]),
        D::SpeedRate,
        [1.0, 1.0],
    ),
    (powers(&[(X::Period, 1)]), D::Periods, [1.0, 1.0]),
];

/// The quantity of a product, with the factor to its SI unit.
pub(super) fn quantity(powers: &Powers) -> Option<(D, [f64; 2])> {
    let row = QUANTITIES.iter().find(|(known, ..)| known == powers)?;
    Some((row.1, row.2))
}

type Readings = [(&'static str, &'static str); 2];

/// Products that say one of two things.
const AMBIGUOUS: &[(Powers, Readings)] = &[
    (
        powers(&[(X::Volt, 1), (X::Second, 1)]),
        [
            ("V s/rad", "EMF over mechanical speed"),
            (
                "Wb",
                "flux linkage per electrical angle: EMF over electrical speed",
            ),
        ],
    ),
    (
        powers(&[(X::Second, -1)]),
        [("Hz", "periods in a second"), ("rad/s", "an angular speed")],
    ),
];

pub(super) fn readings(powers: &Powers) -> Option<Readings> {
    let row = AMBIGUOUS.iter().find(|(known, _)| known == powers)?;
    Some(row.1)
}

/// The usual spellings of each quantity, for suggestions and the reference page.
pub(super) const KNOWN: &[(D, &[&str])] = &[
    (D::Resistance, &["ohm", "mohm", "uohm", "kohm"]),
    (D::Inductance, &["H", "mH", "uH", "nH"]),
    (D::Current, &["A", "mA", "kA"]),
    (D::Voltage, &["V", "mV", "kV"]),
    (D::Time, &["s", "ms", "us", "ns"]),
    (D::Frequency, &["Hz", "kHz", "MHz", "GHz"]),
    (
        D::Speed,
        &["rpm", "rad/s", "krpm", "min-1", "1/min", "r/min", "rps"],
    ),
    (
        D::EmfConstant,
        &[
            "V/(rad/s)",
            "V s/rad",
            "mV s/rad",
            "V/krpm",
            "V/1000rpm",
            "V/rpm",
            "mV/rpm",
            "V/min-1",
        ],
    ),
    (D::SpeedConstant, &["rpm/V", "min-1/V", "(rad/s)/V"]),
    (D::FluxLinkage, &["Wb", "mWb", "uWb", "V/Hz", "mV/Hz"]),
    (
        D::Torque,
        &[
            "Nm", "N m", "mNm", "Ncm", "oz-in", "lb-in", "lb-ft", "kgf cm", "gf cm",
        ],
    ),
    (
        D::TorqueConstant,
        &[
            "Nm/A", "N m/A", "mNm/A", "Ncm/A", "oz-in/A", "lb-in/A", "lb-ft/A", "kgf cm/A",
        ],
    ),
    (
        D::Inertia,
        &[
            "kg m2", "kg cm2", "g cm2", "oz-in2", "lb-in2", "oz-in-s2", "lb-in-s2", "lb-ft-s2",
        ],
    ),
    (D::Angle, &["deg", "rad"]),
    (D::Ratio, &["%"]),
    (
        D::CurrentPerCount,
        &["A/count", "mA/count", "uA/count", "mA/LSB"],
    ),
    (D::Sensitivity, &["mV/A", "V/A"]),
    (D::CurrentRate, &["A/s", "A/ms", "mA/s", "kA/s"]),
    (D::SpeedRate, &["rpm/s", "krpm/s", "rad/s2"]),
    (D::Periods, &["periods", "period"]),
];
