//! What the generator writes, versioned: emitted Rust, IR text and data sheets.
//!
//! Data sheets of every motor, found by directory; code and IR of four very different ones, of two
//! for each kind of controller, and of the paper's motor in several variants and with a measured bus. `INSTA_UPDATE=always cargo test -p hexagen-tests --test
//! snapshots` writes all of them anew; a person reads the difference.

use hexagen_codegen::diagnostics::Diagnostics;
use hexagen_codegen::emit::c99::{Sources, emit_c99};
use hexagen_codegen::emit::datasheet::emit_datasheet;
use hexagen_codegen::emit::rust::{Surface, emit_rust, readable_rust};
use hexagen_codegen::pipeline::{Generated, generate};
use hexagen_codegen::spec::{apply_variant, check, parse_toml};
use hexagen_tests::library::{Motor, PAPER_MOTOR, motor, motors};
use hexagen_tests::options::kinds;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Motors whose code is kept besides the paper's: the stiffest and the softest plant of the
/// library, and a low-speed one with sinusoidal EMF.
const MOTORS: [&str; 3] = ["estun-emj-04apb22", "velineon-3500", "ipower-gbm2804h"];

/// The kind of controller of the motor files.
const OWN_KIND: &str = "pdcc";

/// Motors for the kinds besides: the first that takes the kind is kept besides the paper's.
const MOTORS_OF_KINDS: [&str; 2] = ["velineon-3500", "estun-emj-04apb22"];

/// A motor whose data sheet says its inertia, for a speed loop.
const MOTOR_WITH_INERTIA: &str = "hurst-long";

/// Variants of the paper's motor: the name in the snapshot's file, and the options.
const VARIANTS: [(&str, &str); 15] = [
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
    (
        "fcs-mpc.all",
        "fcs-mpc:candidates=all,emf=model,reference=proportional",
    ),
    ("fcs-mpc.nominal", "fcs-mpc:off_leg=nominal,delay=0,word=16"),
    ("fcs-mpc.modulated", "fcs-mpc:modulated=on,emf=model"),
    (
        "fcs-mpc.fewer-changes",
        "fcs-mpc:candidates=three_phase,switching_weight=0.5A",
    ),
    (
        "fcs-mpc.weighted",
        "fcs-mpc:emf=model,switching_weight=0.3A,torque_weight=2",
    ),
    ("fcs-mpc.two-steps", "fcs-mpc:horizon=2,emf=model"),
    ("phcc.held", "phcc:off_leg=nominal,emf=held"),
    ("integral", "pdcc:emf=model,integral=on"),
    ("pi-pwm.six-step", "pi-pwm:six_step=on"),
    ("pi-pwm.plain", "pi-pwm:feed_forward=off,bandwidth=700Hz"),
];

/// Those of which C is kept, too, besides the paper's motor with each kind of controller and with a measured bus.
const VARIANTS_IN_C: [&str; 2] = ["model-advance", "word-16"];

/// The paper's motor with a measured bus and a watch for stalls: fields of its inverter besides.
const SUPERVISION: &str = r#"[inverter]
v_bus = "measured"
bus_adc_bits = 12
bus_adc_range = "80 V"
stall_timeout = "200 ms"
"#;

/// One snapshot: its file name without ending, and its text.
struct Snapshot {
    name: String,
    text: String,
}

fn try_generate(motor: &Motor, variant: &str) -> Result<Generated, Diagnostics> {
    let mut ast = parse_toml(&motor.text, &format!("{}.toml", motor.name))?;
    apply_variant(&mut ast, variant)?;
    let (spec, origins) = check(&ast)?;
    generate(&spec, &origins)
}

fn generated(motor: &Motor, variant: &str) -> Generated {
    try_generate(motor, variant).unwrap_or_else(|errors| panic!("{errors}"))
}

fn datasheet_of(name: &str, generated: &Generated) -> Snapshot {
    Snapshot {
        name: format!("{name}.datasheet"),
        text: emit_datasheet(&generated.graph, &generated.interface),
    }
}

fn code_of(name: &str, generated: &Generated) -> [Snapshot; 2] {
    let Generated { graph, interface } = generated;
    let rust = readable_rust(&emit_rust(
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

/// Header and source in C.
fn c99_of(name: &str, generated: &Generated) -> Snapshot {
    let Generated { graph, interface } = generated;
    let Sources { header, source, .. } = emit_c99(graph, interface, &interface.type_name);
    Snapshot {
        name: format!("{name}.c99"),
        text: header + "\n" + &source,
    }
}

fn snapshots() -> Vec<Snapshot> {
    let mut snapshots = vec![];
    for motor in motors() {
        let generated = generated(&motor, OWN_KIND);
        snapshots.push(datasheet_of(&motor.name, &generated));
        if motor.name == PAPER_MOTOR || MOTORS.contains(&motor.name.as_str()) {
            snapshots.extend(code_of(&motor.name, &generated));
        }
        if motor.name == PAPER_MOTOR {
            snapshots.push(c99_of(&motor.name, &generated));
        }
    }
    let paper = motor(PAPER_MOTOR);
    for kind in kinds().iter().filter(|kind| kind.name != OWN_KIND) {
        let others = MOTORS_OF_KINDS.map(motor);
        let other = others
            .into_iter()
            .find(|motor| try_generate(motor, kind.name).is_ok());
        for motor in [&paper, &other.expect("a motor that takes the kind")] {
            let generated = generated(motor, kind.name);
            let name = format!("{}.{}", motor.name, kind.name);
            snapshots.push(datasheet_of(&name, &generated));
            snapshots.extend(code_of(&name, &generated));
        }
        let name = format!("{PAPER_MOTOR}.{}", kind.name);
        snapshots.push(c99_of(&name, &generated(&paper, kind.name)));
    }
    let code = code_of(
        &format!("{MOTOR_WITH_INERTIA}.speed-loop"),
        &generated(&motor(MOTOR_WITH_INERTIA), "pdcc:speed_loop=on"),
    );
    snapshots.extend(code);
    for (name, variant) in VARIANTS {
        let generated = generated(&paper, variant);
        snapshots.extend(code_of(&format!("{PAPER_MOTOR}.{name}"), &generated));
        if VARIANTS_IN_C.contains(&name) {
            snapshots.push(c99_of(&format!("{PAPER_MOTOR}.{name}"), &generated));
        }
    }
    let supervised = Motor {
        text: paper.text.replacen("[inverter]\n", SUPERVISION, 1),
        ..paper
    };
    let generated = generated(&supervised, OWN_KIND);
    let name = format!("{PAPER_MOTOR}.measured-bus");
    snapshots.push(datasheet_of(&name, &generated));
    snapshots.extend(code_of(&name, &generated));
    snapshots.push(c99_of(&name, &generated));
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
