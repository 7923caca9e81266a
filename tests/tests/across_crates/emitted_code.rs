//! What emitted code never contains, and its `rustfmt` layout.

use hexagen_codegen::diagnostics::Diagnostics;
use hexagen_codegen::emit::c99::emit_c99;
use hexagen_codegen::emit::datasheet::emit_datasheet;
use hexagen_codegen::emit::rust::{Surface, emit_rust, format_rust, readable_rust, rustfmt};
use hexagen_codegen::pipeline::{Generated, generate};
use hexagen_codegen::spec::{apply_variant, check, parse_toml};
use hexagen_tests::library::{PAPER_MOTOR, motor, motors, with_inertia};
use hexagen_tests::options::{generate_toml, kind, kinds};
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::ops::RangeInclusive;

/// In addition to every kind of controller with all options at their defaults.
const VARIANTS: [&str; 7] = [
    "pdcc:modulation=pair,advance=1",
    "pdcc:emf=model,reference=proportional,saturation=nearest",
    "pdcc:reference=quasi_square,saturation=keep_angle,delay=0",
    "fcs-mpc:candidates=all,emf=model",
    "fcs-mpc:off_leg=nominal,delay=0,word=16",
    "pi-pwm:reference=quasi_square,feed_forward=off,saturation=keep_angle",
    "pdcc:reference=quasi_square,speed_loop=on",
];

/// Every motor in every variant that its specification allows: name, tokens; variant by variant.
fn all_code() -> Vec<Vec<(String, TokenStream)>> {
    let kinds = kinds().into_iter().map(|kind| kind.name);
    kinds.chain(VARIANTS).map(code_of).collect()
}

/// Why a drive of the library may be rejected: its vectors move the current too far, or its board does not see a leg that
/// is off, so that options of such legs have no effect.
const REASONS: [&str; 3] = ["HX0404", "HX0406", "HX0409"];

fn code_of(variant: &str) -> Vec<(String, TokenStream)> {
    let (mut all, mut refused) = (vec![], 0);
    for motor in motors() {
        match generate_variant(&motor.text, &motor.name, variant) {
            Ok(generated) => {
                let surface = Surface::public(&generated.interface.type_name);
                let tokens = emit_rust(&generated.graph, &generated.interface, &surface);
                all.push((format!("{} {variant}", motor.name), tokens));
            }
            Err(errors) => {
                refused += 1;
                for error in errors {
                    let code = error.code.to_string();
                    assert!(REASONS.contains(&&*code), "{}: {error}", motor.name);
                }
            }
        }
    }
    println!("{variant}: {} drives, {refused} refused", all.len());
    assert!(all.len() > 3, "{variant}: {} drives", all.len());
    all
}

fn generate_variant(motor: &str, name: &str, variant: &str) -> Result<Generated, Diagnostics> {
    let mut ast = parse_toml(&with_inertia(motor), name)?;
    apply_variant(&mut ast, variant).expect("the variant parses");
    let (spec, origins) = check(&ast)?;
    generate(&spec, &origins)
}

/// All words, signs and numbers of the code, without documentation.
fn code_words(tokens: TokenStream, words: &mut Vec<String>) {
    let mut tokens = tokens.into_iter().peekable();
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Punct(sign) if sign.as_char() == '#' => {
                words.push("#".to_owned());
                // Attributes: `#[doc = "…"]`, `#![doc = "…"]`.
                tokens.next_if(|token| token.to_string() == "!");
                if let Some(TokenTree::Group(group)) = tokens.next() {
                    let attribute = group.stream().to_string();
                    if !attribute.starts_with("doc") {
                        words.push(attribute);
                    }
                }
            }
            TokenTree::Group(group) => code_words(group.stream(), words),
            TokenTree::Literal(literal) if literal.to_string().contains('"') => {}
            other => words.push(other.to_string()),
        }
    }
}

#[test]
fn no_float_no_unsafe_no_panic_no_loop_no_division() {
    let never = [
        "unsafe", "f32", "f64", "panic", "assert", "unwrap", "expect", "for_", "while", "loop",
        "alloc", "Box", "Vec", "allow", "/", "%",
    ];
    for (name, tokens) in all_code().into_iter().flatten() {
        let mut words = vec![];
        code_words(tokens, &mut words);
        assert!(words.len() > 1000, "{name}: {} words", words.len());
        for word in &words {
            assert!(!never.contains(&word.as_str()), "{name} contains `{word}`");
            let float =
                word.contains('.') && word.starts_with(|first: char| first.is_ascii_digit());
            assert!(!float, "{name} contains the number {word}");
            assert!(
                !word.contains("allow") && !word.contains("unsafe"),
                "{name}: #[{word}]"
            );
        }
        // `for` appears only in `impl Trait for Type`.
        let loops = words.windows(2).filter(|pair| pair[0] == "for").count();
        let impls = words.iter().filter(|word| *word == "impl").count();
        assert!(loops < impls, "{name} contains a loop");
    }
}

/// Functions of `hexagen::arith` that divide.
const DIVISIONS: [&str; 3] = ["divide", "divide_narrow", "turn_over"];

/// The functions of the code that divide, with the attributes before them.
fn dividing_functions(tokens: TokenStream, found: &mut Vec<(String, Vec<String>)>) {
    let mut attributes = vec![];
    let mut name = None;
    let mut before = String::new();
    for token in tokens {
        if let TokenTree::Group(group) = &token {
            let mut words = vec![];
            code_words(group.stream(), &mut words);
            let is_body = group.delimiter() == Delimiter::Brace;
            if before == "#" {
                attributes.push(group.stream().to_string());
            } else if let Some(function) = name.take_if(|_| is_body) {
                if words.iter().any(|word| DIVISIONS.contains(&word.as_str())) {
                    found.push((function, std::mem::take(&mut attributes)));
                }
                attributes.clear();
            } else if is_body {
                // A module or an implementation.
                attributes.clear();
                dividing_functions(group.stream(), found);
            }
        } else if before == "fn" {
            name = Some(token.to_string());
        }
        before = token.to_string();
    }
}

/// In the step only functions off the normal path divide; a setter may, as it runs outside the
/// step.
#[test]
fn divisions_are_off_the_normal_path() {
    let mut cold = 0;
    for (name, tokens) in all_code().into_iter().flatten() {
        let mut found = vec![];
        dividing_functions(tokens, &mut found);
        for (function, attributes) in found {
            if attributes.iter().any(|attribute| attribute == "cold") {
                cold += 1;
            } else {
                assert!(function.starts_with("set_"), "{name}: `{function}` divides");
            }
        }
    }
    assert!(cold > 50, "{cold} functions");
}

/// The words of a text without comment marks.
fn words_of(text: &str) -> String {
    let words = text.split_whitespace();
    let words = words.filter(|word| !["///", "//!", "*", "/**", "*/"].contains(word));
    words.collect::<Vec<_>>().join(" ")
}

/// Faults that do not trip, and the board's requirements that follow, are documented for firmware
/// engineers: with the supervisor in both languages, to which every type refers, and in the README.
#[test]
fn every_type_leads_to_what_its_supervisor_cannot_see() {
    let said = [
        "frozen at mid-scale",
        "several times the trip level",
        "the phase that is not read",
        "control interrupt that does not come",
        "shoot-through, and what is shorter than a control period",
        "(a) a comparator of the current on the timer's break input",
        "(b) a watchdog on the control interrupt",
        "(c) a thermal limit",
        "a limit of the bus voltage",
    ];
    let readme = include_str!("../../../README.md");
    let (_, section) = readme
        .split_once("### What the supervisor cannot see\n")
        .expect("a section");
    let section = section.split("\n#").next().expect("its end");
    let supervisor = include_str!("../../../runtime/src/supervisor.rs");
    let header = include_str!("../../../runtime/c/hexagen.h");
    for text in [section, supervisor, header].map(words_of) {
        for words in said {
            assert!(text.contains(words), "{words}\n{text}");
        }
    }
    let paper = motor(PAPER_MOTOR);
    for kind in kinds() {
        let generated =
            generate_variant(&paper.text, &paper.name, kind.name).expect("it generates");
        let (graph, interface) = (&generated.graph, &generated.interface);
        let rust = format_rust(&emit_rust(graph, interface, &Surface::public("Hub")));
        let header = emit_c99(graph, interface, "Hub").header;
        for text in [rust, header].map(|text| words_of(&text)) {
            assert!(
                text.contains("What the supervisor cannot see:"),
                "{}",
                kind.name
            );
        }
    }
}

/// The README's code is emitted, item by item.
#[test]
fn readme_shows_emitted_code() {
    let readme = include_str!("../../../README.md");
    let excerpt = readme.split("```rs\n").nth(1).expect("an excerpt");
    let excerpt = excerpt.split("```").next().expect("its end");
    let paper = motor(PAPER_MOTOR);
    let generated = generate_variant(&paper.text, &paper.name, "pdcc").expect("it generates");
    let surface = Surface::public(&generated.interface.type_name);
    let tokens = emit_rust(&generated.graph, &generated.interface, &surface);
    let code = readable_rust(&tokens);
    // The code stands in an anonymous constant.
    let code = code.replace("\n    ", "\n");
    let items: Vec<&str> = excerpt.split("\n\n").map(str::trim).collect();
    assert!(items.len() > 1);
    for item in items {
        assert!(code.contains(item), "no longer emitted:\n{item}");
    }
}

/// What a reader looks for first stands on the README's first screens, in that order.
#[test]
fn readme_begins_with_what_a_reader_needs_first() {
    let readme = include_str!("../../../README.md");
    let line_of = |text: &str| {
        let found = readme.lines().position(|line| line.starts_with(text));
        found.unwrap_or_else(|| panic!("no line begins with {text}")) + 1
    };
    let places = [
        "hexagen generates",
        "**What the hardware must have.**",
        "**How far it is tested.**",
        "[dependencies]",
        "hexagen::controller! {",
        "### The interrupt",
        "### Which controller",
        "### How to check it",
        "## Two commands of the repository",
        "## In use",
    ]
    .map(line_of);
    assert!(places.is_sorted(), "{places:?}");
    let table = line_of("| controller | what it does");
    assert!(
        table < 110,
        "the table of controllers begins at line {table}"
    );
}

/// The README's interrupt is that of a program, function by function.
#[test]
fn readme_shows_the_interrupt_of_a_board() {
    let readme = include_str!("../../../README.md");
    let shown = readme.split("```rust,ignore\n").nth(1);
    let shown = shown.and_then(|rest| rest.split("```").next());
    let program = [
        include_str!("../../../targets/frameworks/b-g431b-esc1/src/main.rs"),
        include_str!("../../../targets/frameworks/b-g431b-esc1/src/board.rs"),
    ]
    .concat();
    let functions: Vec<&str> = shown.expect("is there").split("\n\n").collect();
    assert_eq!(functions.len(), 2);
    for function in functions {
        assert!(
            program.contains(function.trim_end()),
            "not in the program:\n{function}"
        );
    }
}

/// The default drive, and the one without an observer, are short enough to read: their lines without
/// those of tables.
#[test]
fn a_drive_is_read_in_one_sitting() {
    assert_lines("pdcc", 700..=905);
    assert_lines(
        "pdcc:reference=quasi_square,hall_capture=sampled",
        400..=560,
    );
}

fn assert_lines(variant: &str, expected: RangeInclusive<usize>) {
    let paper = motor(PAPER_MOTOR);
    let generated = generate_variant(&paper.text, &paper.name, variant).expect("it generates");
    let surface = Surface::public("Hub");
    let text = readable_rust(&emit_rust(&generated.graph, &generated.interface, &surface));
    let mut lines = 0;
    let mut is_table = false;
    for line in text.lines() {
        assert!(line.chars().count() <= 100, "{line}");
        is_table |= line.trim_start().starts_with("static ")
            || line.contains(": [[")
            || line.trim_start().starts_with("struct ");
        lines += usize::from(!is_table);
        is_table &= !["];", "]);", "}"].contains(&line.trim());
    }
    assert!(expected.contains(&lines), "{variant}: {lines}");
}

#[test]
fn rustfmt_leaves_formatted_code_alone() {
    for (name, tokens) in all_code().into_iter().map(|mut code| code.remove(0)) {
        check_layout(&name, &tokens);
    }
}

fn check_layout(name: &str, tokens: &TokenStream) {
    let text = format_rust(tokens);
    let Some(formatted) = rustfmt(&text) else {
        panic!("rustfmt is not installed (rustup component add rustfmt)");
    };
    assert_eq!(rustfmt(&formatted).as_ref(), Some(&formatted), "{name}");
    // Only the layout changes: the tokens are the emitted ones.
    let same = |text: &str| format_rust(&text.parse().expect("Rust")) == format_rust(tokens);
    assert!(same(&text) && same(&formatted), "{name}");
    // No line of code is longer than rustfmt's width: rustfmt could format everything.
    let long = |line: &&str| line.len() > 100 && !line.contains("//") && line.starts_with("    ");
    assert_eq!(
        formatted.lines().filter(long).collect::<Vec<_>>(),
        Vec::<&str>::new(),
        "{name}"
    );
}

/// No leg is turned off, no EMF is filtered, and no reference has sectors to be moved: those options have no effect.
#[test]
fn data_sheets_leave_out_options_without_effect() {
    const IDLE: [&str; 4] = [
        "emf_filter",
        "advance",
        "commutation_threshold",
        "commutation_timeout",
    ];
    let three_phase = [("reference", "proportional"), ("emf", "observer")];
    let pair = [("modulation", "pair")];
    for (choice, listed) in [(&three_phase[..], [false; 4]), (&pair[..], [true; 4])] {
        let pdcc = kind("pdcc");
        let toml = pdcc.drive_toml(&motor(PAPER_MOTOR), &pdcc.choice_of(choice), None);
        let (_, generated) = generate_toml(&toml).expect("the paper's motor generates");
        let sheet = emit_datasheet(&generated.graph, &generated.interface);
        assert_eq!(
            IDLE.map(|option| sheet.contains(&format!("| `{option}` | "))),
            listed
        );
    }
}

/// Tables of vectors, of switching and of modulation are constants of every type, and so every data
/// sheet has them.
#[test]
fn data_sheets_show_all_constants_of_the_type() {
    for kind in kinds() {
        let toml = kind.drive_toml(&motor(PAPER_MOTOR), &kind.choice_of(&[]), None);
        let (_, generated) = generate_toml(&toml).expect("the paper's motor generates");
        let sheet = emit_datasheet(&generated.graph, &generated.interface);
        let constants = &generated.interface.constants;
        for constant in constants {
            let row = format!("| `{}` | ", constant.name);
            let rows = sheet.lines().filter(|line| line.starts_with(&row)).count();
            assert_eq!(rows, 1, "{}: {}", kind.name, constant.name);
        }
        for table in [
            "THREE_PHASE_VECTORS",
            "TWO_PHASE_VECTORS",
            "SVM_COEFFICIENTS",
        ] {
            let has_it = constants.iter().any(|constant| constant.name == table);
            assert!(has_it, "{}: {table}", kind.name);
        }
    }
}
