//! What the generator writes, versioned: emitted Rust, IR text and data sheets.
//!
//! Data sheets of every motor, found by directory; code and IR of four very different ones, and of
//! the paper's motor in several variants. `INSTA_UPDATE=always cargo test -p hexagen-tests --test
//! snapshots` writes all of them anew; a person reads the difference.

use hexagen_codegen::emit::datasheet::emit_datasheet;
use hexagen_codegen::emit::rust::{Surface, emit_rust, format_rust};
use hexagen_codegen::pipeline::{Generated, generate};
use hexagen_codegen::spec::{apply_variant, check, parse_toml};
use hexagen_tests::library::{Motor, PAPER_MOTOR, motor, motors};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Motors whose code is kept besides the paper's: the stiffest and the softest plant of the
/// library, and a low-speed one with sinusoidal EMF.
const MOTORS: [&str; 3] = ["estun-emj-04apb22", "velineon-3500", "ipower-gbm2804h"];

/// Variants of the paper's motor: the name in the snapshot's file, and the options.
const VARIANTS: [(&str, &str); 5] = [
    ("pair", "pdcc:modulation=pair"),
    (
        "model-advance",
        "pdcc:emf=model,advance=2,hall_capture=timer",
    ),
    (
        "proportional",
        "pdcc:emf=model,reference=proportional,saturation=nearest",
    ),
    (
        "delay-0",
        "pdcc:delay=0,discretisation=euler,saturation=keep_angle",
    ),
    ("word-16", "pdcc:word=16,saturation=keep_angle"),
];

/// One snapshot: its file name without ending, and its text.
struct Snapshot {
    name: String,
    text: String,
}

fn generated(motor: &Motor, variant: Option<&str>) -> Generated {
    let mut ast =
        parse_toml(&motor.text, &format!("{}.toml", motor.name)).expect("the motor parses");
    if let Some(variant) = variant {
        apply_variant(&mut ast, variant).expect("the variant parses");
    }
    let (spec, origins) = check(&ast).unwrap_or_else(|errors| panic!("{errors}"));
    generate(&spec, &origins).unwrap_or_else(|errors| panic!("{errors}"))
}

fn code_of(name: &str, generated: &Generated) -> [Snapshot; 2] {
    let Generated { graph, interface } = generated;
    let rust = format_rust(&emit_rust(
        graph,
        interface,
        &Surface::public(&interface.type_name),
    ));
    [
        Snapshot {
            name: format!("{name}.rust"),
            text: rust,
        },
        Snapshot {
            name: format!("{name}.ir"),
            text: graph.program().to_string(),
        },
    ]
}

fn snapshots() -> Vec<Snapshot> {
    let mut snapshots = vec![];
    for motor in motors() {
        let generated = generated(&motor, None);
        let text = emit_datasheet(&generated.graph, &generated.interface);
        snapshots.push(Snapshot {
            name: format!("{}.datasheet", motor.name),
            text,
        });
        if motor.name == PAPER_MOTOR || MOTORS.contains(&motor.name.as_str()) {
            snapshots.extend(code_of(&motor.name, &generated));
        }
    }
    let paper = motor(PAPER_MOTOR);
    for (name, variant) in VARIANTS {
        let generated = generated(&paper, Some(variant));
        snapshots.extend(code_of(&format!("{PAPER_MOTOR}.{name}"), &generated));
    }
    snapshots
}

#[test]
fn what_is_generated_is_what_was_reviewed() {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| {
        for Snapshot { name, text } in snapshots() {
            insta::assert_snapshot!(name, text);
        }
    });
}

#[test]
fn no_snapshot_is_left_over() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots");
    let kept: BTreeSet<String> = fs::read_dir(folder)
        .expect("the snapshots are there")
        .filter_map(|entry| {
            entry
                .expect("a directory entry")
                .file_name()
                .into_string()
                .ok()
        })
        .filter_map(|name| name.strip_suffix(".snap").map(str::to_owned))
        .collect();
    let made: BTreeSet<String> = snapshots()
        .into_iter()
        .map(|snapshot| snapshot.name)
        .collect();
    assert_eq!(
        kept.difference(&made).collect::<Vec<_>>(),
        Vec::<&String>::new(),
        "orphans"
    );
}
