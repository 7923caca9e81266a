//! What emitted text says of a drive holds for its program.

use crate::interface::{FormatEntry, Interface};
use crate::ir::{Interval, Program};
use crate::pipeline::{Generated, generate};
use crate::spec::{apply_variant, check, parse_toml};

/// Every kind of controller, word length, table and limit.
const VARIANTS: [&str; 9] = [
    "pdcc:word=32",
    "pdcc:word=16,saturation=keep_angle",
    "pdcc:word=16,modulation=pair,emf_filter=0.5,saturation=keep_angle",
    "pdcc:emf=model,advance=2",
    "pdcc:reference=proportional,emf=model",
    "fcs-mpc",
    "phcc",
    "pi-pwm",
    "pi-pwm:word=16,saturation=keep_angle",
];

fn drive(variant: &str) -> Generated {
    let mut ast = parse_toml(include_str!("../example.toml"), "example.toml").expect("TOML");
    apply_variant(&mut ast, variant).unwrap_or_else(|errors| panic!("{variant}: {errors}"));
    let (spec, origins) = check(&ast).unwrap_or_else(|errors| panic!("{variant}: {errors}"));
    generate(&spec, &origins).unwrap_or_else(|errors| panic!("{variant}: {errors}"))
}

fn format<'a>(interface: &'a Interface, name: &str) -> &'a FormatEntry {
    let mut formats = interface.formats.iter();
    let found = formats.find(|format| format.name == name);
    found.unwrap_or_else(|| panic!("no format `{name}`"))
}

/// The kind of signals that a word which outlives a call is of: a current, a voltage or neither.
fn kind(name: &str) -> Option<&'static str> {
    let starts = |prefixes: &[&str]| prefixes.iter().any(|prefix| name.starts_with(prefix));
    if starts(&["i_", "offset_"]) {
        Some("current")
    } else if name == "j" || starts(&["v_", "e_", "t_", "integral_"]) {
        Some("voltage")
    } else {
        None
    }
}

/// Coefficients, tables and the kinds of signals, each with the range of its words.
fn ranges(program: &Program) -> Vec<(&str, Interval)> {
    let words = program.states.iter().chain(&program.params);
    let kinds = words.filter_map(|word| Some((kind(&word.name)?, word.interval)));
    let raw = |raw: i32| Interval::point(i64::from(raw));
    let constants = program.constants.iter();
    let constants = constants.map(|constant| (constant.name.as_str(), raw(constant.raw)));
    let tables = program.tables.iter().map(|table| {
        let name = table.name.split("_c").next().unwrap_or_default();
        (name, table.interval())
    });
    kinds.chain(constants).chain(tables).collect()
}

#[test]
fn formats_hold_what_they_describe() {
    for variant in VARIANTS {
        let Generated {
            graph, interface, ..
        } = drive(variant);
        let mut checked = 0;
        for (name, range) in ranges(graph.program()) {
            let Some(format) = interface.formats.iter().find(|format| format.name == name) else {
                continue;
            };
            checked += 1;
            assert!(
                range.bits() <= format.storage_bits,
                "{variant}: `{name}` in {range} does not fit {} bits",
                format.storage_bits
            );
        }
        assert!(checked > 5, "{variant}: {checked} words were checked");
        for format in &interface.formats {
            let tabled = ["flux", "shape"].contains(&format.name.as_str());
            assert_eq!(format.segments.is_some(), tabled, "{variant}: {format:?}");
            assert!(
                (-32..=62).contains(&format.frac_bits),
                "{variant}: {format:?}"
            );
        }
    }
}

#[test]
fn sixteen_bit_words_are_of_currents_and_coefficients() {
    let interface = drive("pdcc:word=16,saturation=keep_angle").interface;
    let bits = ["current", "k_di", "voltage", "k_set"];
    let bits = bits.map(|name| format(&interface, name).storage_bits);
    assert_eq!(bits, [16, 16, 32, 32]);
}
