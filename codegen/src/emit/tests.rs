//! Emitted documentation against the program.

use super::datasheet::emit_datasheet;
use crate::diagnostics::engineering;
use crate::interface::{FormatEntry, Interface};
use crate::ir::{Interval, Program};
use crate::pipeline::{Generated, generate};
use crate::spec::{apply_variant, check, parse_toml};

/// Every kind of controller, word length, table and limit.
const VARIANTS: [&str; 10] = [
    "pdcc:word=32",
    "pdcc:word=16,saturation=keep_angle",
    "pdcc:word=16,modulation=pair,emf_filter=0.5,saturation=keep_angle",
    "pdcc:emf=model,advance=2",
    "pdcc:reference=proportional,emf=model",
    "fcs-mpc",
    "fcs-mpc:modulated=on,off_leg=nominal",
    "phcc",
    "pi-pwm",
    "pi-pwm:word=16,saturation=keep_angle",
];

fn drive(variant: &str) -> Generated {
    drive_with("", variant)
}

/// With further fields of the inverter, which replace those of the same name; a name alone removes one.
fn drive_with(fields: &str, variant: &str) -> Generated {
    let named = |line: &str, field: &str| line.split(" = ").next() == field.split(" = ").next();
    let example = include_str!("../example.toml").lines();
    let kept = example.filter(|line| !fields.lines().any(|field| named(line, field)));
    let stated = fields.lines().filter(|field| field.contains(" = "));
    let stated: Vec<&str> = ["[inverter]"].into_iter().chain(stated).collect();
    let text = kept.collect::<Vec<_>>().join("\n");
    let text = text.replace("[inverter]", &stated.join("\n"));
    let mut ast = parse_toml(&text, "example.toml").expect("TOML");
    apply_variant(&mut ast, variant).unwrap_or_else(|errors| panic!("{variant}: {errors}"));
    let (spec, origins) = check(&ast).unwrap_or_else(|errors| panic!("{variant}: {errors}"));
    generate(&spec, &origins).unwrap_or_else(|errors| panic!("{variant}: {errors}"))
}

fn format<'a>(interface: &'a Interface, name: &str) -> &'a FormatEntry {
    let mut formats = interface.formats.iter();
    let found = formats.find(|format| format.name == name);
    found.unwrap_or_else(|| panic!("no format `{name}`"))
}

/// The kind of a state word: a current, a voltage or neither.
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

/// Ranges of coefficients, tables and kinds of signals.
fn ranges(program: &Program) -> Vec<(&str, Interval)> {
    let words = program.words();
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
            let tabled = ["flux", "shape", "stretch"].contains(&format.name.as_str());
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

/// The value in a coefficient's documentation: `K = 4.468 V/A, 0.2045 in words; …`, or `1/3; …`.
fn said(line: &str) -> Option<f64> {
    let formula = line.split(';').next()?;
    let value = match formula.strip_suffix(" in words") {
        Some(scaled) => scaled.rsplit(' ').next()?,
        None => formula.rsplit(" = ").next()?.split(' ').next()?,
    };
    match value.split_once('/') {
        Some((over, under)) => Some(over.parse::<f64>().ok()? / under.parse::<f64>().ok()?),
        None => value.parse().ok(),
    }
}

#[test]
fn coefficients_say_the_value_that_their_word_holds() {
    for variant in VARIANTS {
        let Generated {
            graph, interface, ..
        } = drive(variant);
        let mut checked = 0;
        for constant in &graph.program().constants {
            let own = constant.doc.last();
            let Some(line) = own.filter(|line| line.contains(" fraction bits, ")) else {
                continue;
            };
            checked += 1;
            let format = format(&interface, &constant.name);
            let held = f64::from(constant.raw) / f64::from(format.frac_bits).exp2();
            let agrees = said(line).is_some_and(|said| (said / held - 1.0).abs() < 1e-3);
            assert!(agrees, "{variant}: `{}` is {held}: {line}", constant.name);
        }
        assert!(checked > 2, "{variant}: {checked} coefficients");
    }
}

#[test]
fn limits_say_their_value_in_units() {
    let mut checked = 0;
    for variant in VARIANTS {
        let drive = drive(variant);
        let frac_bits = |name| f64::from(format(&drive.interface, name).frac_bits).exp2();
        // The example's 40 A over 2048 counts, and 48 V over 1800.
        let words = [
            (
                "words of current",
                frac_bits("current") * 2048.0 / 40.0,
                "A",
            ),
            (
                "words of voltage",
                frac_bits("voltage") * 1800.0 / 48.0,
                "V",
            ),
        ];
        for constant in &drive.graph.program().constants {
            let doc = constant.doc.join(" ");
            if doc.contains("relative error") || doc.contains("exact.") {
                continue;
            }
            for (kind, per_unit, unit) in words {
                if !doc.contains(kind) {
                    continue;
                }
                checked += 1;
                let value = engineering(f64::from(constant.raw) / per_unit, unit);
                let counts = doc.contains("timer counts, words of voltage");
                assert!(counts || doc.contains(&value), "{value}: {doc}");
            }
        }
    }
    assert!(checked > 30, "{checked} limits");
}

#[test]
fn errors_of_tables_have_units() {
    for (variant, table, unit) in [
        (
            "pdcc:emf=model,advance=2",
            "flux_c0",
            " timer counts of voltage (",
        ),
        (
            "pdcc:reference=proportional,emf=model",
            "shape_c0",
            " A per ampere of set-point off.",
        ),
    ] {
        let graph = drive(variant).graph;
        let mut tables = graph.program().tables.iter();
        let table = tables.find(|known| known.name == table).expect("a table");
        let error = table.doc.last().expect("an error");
        assert!(error.contains(unit), "{error}");
    }
}

/// Fields of the inverter, the controller, and what the data sheet says of them.
const TOLD: [(&str, &str, &str); 17] = [
    ("over_speed = \"2345 rpm\"", "pdcc", "faster than 2345 rpm."),
    (
        "over_speed = \"2345 rpm\"\nhall_timer_clock",
        "pdcc",
        "faster than 2345 rpm, where a turn is measured",
    ),
    (
        "stall_timeout = \"123 ms\"",
        "pdcc",
        "after 2460 periods without a Hall edge",
    ),
    ("precharge = \"0.45 ms\"", "pdcc", "9 steps of pre-charge"),
    ("calibration_samples = 512", "pdcc", "512"),
    ("trip_current = \"38.5 A\"", "pdcc", "38.5 A"),
    ("adc_offset = 2011", "pdcc", "2011"),
    ("adc_inverted = \"on\"", "pdcc", "fall with the current"),
    ("sensed_phases = \"bc\"", "pdcc", "phases b and c rise"),
    (
        "sensed_phases = \"abc\"\ncurrent_sum_tolerance = \"3.21 A\"\ncurrent_sum_samples = 5",
        "pdcc",
        "a sum above 3.21 A in 5 samples in a row",
    ),
    ("adc_offset = [2011, 2099]", "pdcc", "from 2099 at zero"),
    ("max_current = \"21 A\"", "pdcc", "21 A"),
    ("maximum_speed = \"2777 rpm\"", "pdcc", "2777 rpm"),
    (
        "dead_time = \"730 ns\"",
        "pdcc",
        "365 ns (half the dead time)",
    ),
    (
        "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"80 V\"\nover_voltage = \"57 V\"\nunder_voltage = \"31 V\"",
        "pdcc",
        "57 V",
    ),
    (
        "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"80 V\"\nbus_current_limit = \"5.67 A\"",
        "pdcc",
        "5.67 A",
    ),
    (
        "",
        "pdcc:emf=observer,residual_timeout=22 ms",
        "outnumber the others by 440",
    ),
];

#[test]
fn what_a_specification_states_is_told() {
    let mut untold = vec![];
    for (fields, variant, told) in TOLD {
        let Generated {
            graph, interface, ..
        } = drive_with(fields, variant);
        let sheet = emit_datasheet(&graph, &interface);
        // Below it the specification itself.
        let (prose, _) = sheet.split_once("```").expect("a specification");
        let words: Vec<&str> = prose.split_whitespace().collect();
        if !words.join(" ").contains(told) {
            untold.push(format!("{fields}: no `{told}` in {}", words.join(" ")));
        }
    }
    assert!(untold.is_empty(), "{}", untold.join("\n"));
}

#[test]
fn the_programs_text_names_the_operands_of_every_value() {
    for variant in VARIANTS {
        let graph = drive(variant).graph;
        let program = graph.program();
        let text = program.to_string();
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        let mut checked = 0;
        for value in program.step.values() {
            let node = program.step.node(value);
            let operands = node.op.operands();
            let names = operands
                .iter()
                .map(|operand| &*program.step.node(*operand).name);
            let names: Vec<&str> = names.filter(|name| !name.is_empty()).collect();
            if node.name.is_empty() || names.is_empty() {
                continue;
            }
            checked += 1;
            let start = format!("{} = ", node.name);
            let line = lines.iter().find_map(|line| line.strip_prefix(&*start));
            let line = line.unwrap_or_else(|| panic!("{variant}: no `{start}`"));
            for name in names {
                assert!(line.contains(name), "{variant}: no {name} in {start}{line}");
            }
        }
        assert!(checked > 20, "{variant}: {checked} values");
    }
}
