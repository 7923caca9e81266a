use super::quantities::KNOWN;
use super::{Dimension, NAMES, Unit};
use crate::spec::ast::Basis;
use std::fmt::Write;
use std::path::Path;

fn si(value: f64, symbol: &str) -> f64 {
    let unit = Unit::from_symbol(symbol);
    unit.unwrap_or_else(|| panic!("{symbol}")).to_si(value)
}

#[test]
fn factors_of_the_si_round_once() {
    assert_eq!(si(0.22, "mH"), 0.00022);
    assert_eq!(si(135.0, "mohm"), 0.135);
    assert_eq!(si(50.0, "us"), 5e-5);
    assert_eq!(si(2.4, "g cm2"), 2.4e-7);
    assert_eq!(si(10.0, "%"), 0.1);
    assert_eq!(si(24.0, "kg cm2"), 0.0024);
}

/// The numbers that NIST SP 811 prints, and those of the electrical units by hand.
#[test]
fn factors_agree_with_their_sources() {
    for (value, symbol, expected) in [
        (1.0, "oz-in", 7.061_552e-3),
        (1.0, "ozf in", 7.061_552e-3),
        (1.0, "lb-ft", 1.355_818),
        (1.0, "lbf-in", 1.129_848e-1),
        (1.0, "kgf cm", 9.806_65e-2),
        (1.0, "kg cm", 9.806_65e-2),
        (1.0, "oz-in/A", 7.061_552e-3),
        (1.0, "lb-ft2", 4.214_011e-2),
        (1.0, "lb-in2", 2.926_397e-4),
        (16.0, "oz-in2", 2.926_397e-4),
        (1.0, "oz-in-s2", 7.061_552e-3),
        (1.0, "lb in s2", 1.129_848e-1),
        (1.0, "RPM", 1.047_198e-1),
        (1.0, "min-1", 1.047_198e-1),
        (1.0, "1/min", 1.047_198e-1),
        (1.0, "/min", 1.047_198e-1),
        (1.0, "r/min", 1.047_198e-1),
        (2000.0, "rpm", 209.439_510_239),
        (4.64, "V/krpm", 0.044_308_736_15),
        (4.64, "V/1000rpm", 0.044_308_736_15),
        (4.64, "V/1000 rpm", 0.044_308_736_15),
        (4.64, "V/kRPM", 0.044_308_736_15),
        (4.64, "V/(1000 min-1)", 0.044_308_736_15),
        (4.64, "mV/rpm", 0.044_308_736_15),
        (4.64, "mV min", 0.044_308_736_15),
        (4.64, "mV/min^-1", 0.044_308_736_15),
        (0.0979, "V/Hz", 0.015_581_268_93),
        (4600.0, "rpm/V", 481.710_873_550),
        (4600.0, "min-1/V", 481.710_873_550),
        (20.0, "mA/LSB", 0.02),
        (1.0, "Ohms", 1.0),
        (0.5, "mN·m/A", 0.0005),
        (0.5, "mN.m/A", 0.0005),
    ] {
        let got = si(value, symbol);
        assert!(
            (got / expected - 1.0).abs() < 5e-7,
            "{value} {symbol}: {got}"
        );
    }
}

#[test]
fn known_spellings_measure_what_they_are_listed_for() {
    for (dimension, spellings) in KNOWN {
        for spelling in *spellings {
            let unit = Unit::from_symbol(spelling).unwrap_or_else(|| panic!("{spelling}"));
            assert_eq!(unit.dimension, *dimension, "{spelling}");
            assert_eq!(unit.symbol, *spelling);
        }
    }
}

#[test]
fn a_name_has_one_meaning_of_each_kind() {
    let all = NAMES.iter().flat_map(|name| {
        let spellings = name.spellings.iter();
        spellings.map(|spelling| (*spelling, name.weighs))
    });
    let all: Vec<(&str, bool)> = all.collect();
    for (index, name) in all.iter().enumerate() {
        assert!(!all[..index].contains(name), "{name:?}");
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
        ("min\u{207b}\u{b9}", "min-1"),
        ("N\u{22c5}m", "N m"),
        ("V / ( rad / s )", "V/(rad/s)"),
        ("kg*m^2", "kg m2"),
    ] {
        let unit = Unit::from_symbol(symbol);
        assert_eq!(unit.map(|unit| unit.symbol).as_deref(), Some(letters));
    }
}

#[test]
fn amplitudes_are_no_part_of_the_unit() {
    for (symbol, kept, basis) in [
        ("Arms", "A", Basis::Rms),
        ("A_rms", "A", Basis::Rms),
        ("Apk", "A", Basis::Peak),
        ("Vrms/krpm", "V/krpm", Basis::Rms),
        ("mVrms/rpm", "mV/rpm", Basis::Rms),
        ("Vpeak/1000rpm", "V/1000rpm", Basis::Peak),
        ("mNm/Arms", "mNm/A", Basis::Rms),
        ("Vpp/200rpm", "V/200rpm", Basis::PeakToPeak),
        ("Vpkpk", "V", Basis::PeakToPeak),
    ] {
        let (unit, found) = Unit::parse(symbol).unwrap_or_else(|| panic!("{symbol}"));
        assert_eq!((unit.symbol.as_str(), found), (kept, Some(basis)));
        assert!(Unit::from_symbol(symbol).is_none());
    }
}

#[test]
fn what_is_no_quantity_is_no_unit() {
    for symbol in [
        "",
        "W",
        "pH",
        "mm",
        "furlong",
        "V/rad/s",
        "V/2000",
        "2/min",
        "500 rpm",
        "12 500 Hz",
        "8V",
        "A/A",
        "rms",
        "ohm rms",
        "Hrms",
        "V/",
        "(V",
        "V)",
        "oz",
        "kg",
        "nm",
        "V--s",
        "m2/m",
        "V/01rpm",
        "Vrms/Apk",
        "g cm3",
    ] {
        assert!(Unit::parse(symbol).is_none(), "{symbol}");
    }
}

#[test]
fn two_meanings_are_told() {
    for (symbol, first, second) in [
        ("V s", "V s/rad", "Wb"),
        ("Vs", "V s/rad", "Wb"),
        ("s-1", "Hz", "rad/s"),
    ] {
        assert!(Unit::parse(symbol).is_none());
        let [one, other] = Unit::readings(symbol).unwrap_or_else(|| panic!("{symbol}"));
        assert_eq!((one.0, other.0), (first, second));
    }
    assert!(Unit::readings("V").is_none());
}

#[test]
fn nearest_spelling() {
    use Dimension::{Current, Frequency, Inductance, Ratio, Resistance, Time, Torque};
    for (symbol, dimension, nearest) in [
        ("KHz", Frequency, Some("kHz")),
        ("OHM", Resistance, Some("ohm")),
        ("v", Current, None),
        ("a", Current, Some("A")),
        ("NM", Torque, Some("Nm")),
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
}

/// The table of the reference page, `units.md`.
fn page() -> String {
    let mut page = String::from(
        "# Units\n\n| name | with prefixes | in SI units | source |\n|---|---|---|---|\n",
    );
    for name in NAMES {
        let spellings: Vec<String> = name
            .spellings
            .iter()
            .map(|spelling| format!("`{spelling}`"))
            .collect();
        let prefixes: Vec<String> = name
            .prefixes
            .chars()
            .map(|prefix| format!("`{prefix}`"))
            .collect();
        let [times, over] = name.factor;
        let weight = if name.weighs { ", as a weight" } else { "" };
        writeln!(
            page,
            "| {}{weight} | {} | {} {} | {} |",
            spellings.join(", "),
            prefixes.join(" "),
            times / over,
            measured(name.powers),
            name.source
        )
        .expect("a string takes all");
    }
    page
}

/// SI unit of a name's powers.
fn measured(powers: &[(super::quantities::Axis, i8)]) -> String {
    let all: Vec<String> = powers
        .iter()
        .map(|(axis, power)| {
            let axis = format!("{axis:?}").to_lowercase();
            if *power == 1 {
                axis
            } else {
                format!("{axis}^{power}")
            }
        })
        .collect();
    all.join(" ")
}

#[test]
fn the_reference_page_has_the_table() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/spec/units.md");
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(&path, page()).expect("the page can be written");
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(written, page(), "INSTA_UPDATE=always writes it");
}
