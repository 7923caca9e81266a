//! The drives of the snapshots, and the texts of a drive.

use hexagen_codegen::emit::c99::{Sources, emit_c99};
use hexagen_codegen::emit::datasheet::emit_datasheet;
use hexagen_codegen::emit::rust::{Surface, emit_rust, readable_rust};
use hexagen_codegen::pipeline::{Generated, generate};
use hexagen_codegen::spec::{apply_variant, check, parse_toml};
use hexagen_tests::covering::SPECIFICATIONS;
use hexagen_tests::library::{PAPER_MOTOR, motor, motors};
use hexagen_tests::options::{generate_toml, kinds};
use rayon::prelude::*;
use toml_edit::DocumentMut;

/// Kinds of texts.
pub const TEXTS: [&str; 4] = ["rust", "c99", "ir", "datasheet"];

/// Name of the type in every text, so that only the drives' differences show.
const NAME: &str = "Hub";

/// Further fields of a variant's specification: section, field, value.
type Fields = &'static [(&'static str, &'static str, &'static str)];

/// Variants of the paper's motor besides the defaults of each controller: name, options, fields.
const VARIANTS: [(&str, &str, Fields); 18] = [
    ("pdcc.table2", "pdcc:modulation=table2,zero=pair_low", &[]),
    ("pi-pwm.table2", "pi-pwm:modulation=table2", &[]),
    (
        "pdcc.pair-model-and-advance",
        "pdcc:modulation=pair,emf=model,advance=2,hall_capture=timer",
        &[],
    ),
    (
        "pdcc.delay-0-and-word-16",
        "pdcc:reference=quasi_square,delay=0,discretisation=euler,saturation=keep_angle,word=16",
        &[],
    ),
    (
        "pdcc.observer-quasi-square",
        "pdcc:reference=quasi_square,emf=observer,saturation=nearest",
        &[],
    ),
    (
        "pdcc.speed-ramp-and-bus-current",
        "pdcc:reference=quasi_square,speed_loop=on,acceleration_limit=5000 rpm/s",
        &[
            ("motor", "inertia", "3 kg cm2"),
            ("inverter", "bus_current_limit", "10 A"),
            ("inverter", "return_current_limit", "5 A"),
        ],
    ),
    (
        "pdcc.dead-time-slew-rate-and-over-speed",
        "pdcc:reference=quasi_square,emf=held,dead_time_compensation=on,rounding_prediction=on,slew_rate=200 A/s",
        &[
            ("inverter", "dead_time", "900 ns"),
            ("inverter", "hall_glitches", "3"),
            ("inverter", "over_speed", "2600 rpm"),
        ],
    ),
    (
        "pdcc.watched-and-hall-learning",
        "pdcc:residual_timeout=5ms,hall_learning=on",
        &[(
            "motor",
            "hall_angles",
            "[-26 deg, 30 deg, 90 deg, 154 deg, 210 deg, 270 deg]",
        )],
    ),
    (
        "pdcc.torque-learning-and-fades",
        "pdcc:torque_learning=on",
        &[
            ("inverter", "v_bus", "measured"),
            ("inverter", "bus_adc_bits", "12"),
            ("inverter", "bus_adc_range", "65 V"),
            ("inverter", "stall_timeout", "200 ms"),
            ("inverter", "braking_fade", "4 V"),
            ("inverter", "motoring_fade", "4 V"),
        ],
    ),
    (
        "pdcc.angle-and-field-weakening",
        "pdcc:field_weakening=on",
        &[
            ("inverter", "bus_clamp", "56 V"),
            ("motor", "rotor", "angle"),
            ("motor", "angle_pole_pairs", "4"),
            ("motor", "angle_offset", "37 deg"),
            ("motor", "angle_direction", "backward"),
            ("motor", "angle_bits", "14"),
            ("inverter", "over_speed", "2600 rpm"),
        ],
    ),
    (
        "fcs-mpc.all",
        "fcs-mpc:candidates=all,emf=model,reference=proportional",
        &[],
    ),
    (
        "fcs-mpc.nominal",
        "fcs-mpc:off_leg=nominal,advance=1.5,delay=0,word=16",
        &[],
    ),
    ("fcs-mpc.modulated", "fcs-mpc:modulated=on,emf=model", &[]),
    (
        "fcs-mpc.weighted",
        "fcs-mpc:emf=model,switching_weight=0.3A,torque_weight=2",
        &[],
    ),
    ("fcs-mpc.two-steps", "fcs-mpc:horizon=2,emf=model", &[]),
    ("phcc.held", "phcc:off_leg=nominal,emf=held", &[]),
    ("pi-pwm.six-step", "pi-pwm:six_step=on", &[]),
    (
        "pi-pwm.plain",
        "pi-pwm:reference=quasi_square,feed_forward=off,bandwidth=700Hz",
        &[],
    ),
];

/// The texts of a drive.
pub struct Drive {
    /// Controller and variant, or controller and motor, or its row in the covering array.
    pub name: String,
    texts: [String; 4],
}

impl Drive {
    fn new(name: &str, generated: &Generated) -> Self {
        let Generated { graph, interface } = generated;
        let rust = emit_rust(graph, interface, &Surface::public(NAME));
        let Sources { header, source, .. } = emit_c99(graph, interface, NAME);
        Self {
            name: name.to_owned(),
            texts: [
                readable_rust(&rust),
                header + "\n" + &source,
                graph.program().to_string(),
                emit_datasheet(graph, interface),
            ],
        }
    }

    /// Its text of a kind.
    ///
    /// # Panics
    /// If there is no such kind.
    pub fn text(&self, kind: &str) -> &str {
        let place = TEXTS.iter().position(|text| *text == kind);
        &self.texts[place.expect("a kind of text")]
    }
}

/// The paper's motor with each controller's defaults.
pub fn defaults() -> Vec<Drive> {
    let kinds = kinds();
    kinds
        .iter()
        .map(|kind| variant(kind.name, kind.name, &[]))
        .collect()
}

/// The paper's motor with options.
pub fn variants() -> Vec<Drive> {
    let variants = VARIANTS.par_iter();
    variants
        .map(|(name, options, fields)| variant(name, options, fields))
        .collect()
}

fn variant(name: &str, options: &str, fields: Fields) -> Drive {
    let mut ast = parse_toml(&specification(&motor(PAPER_MOTOR).text, fields), name);
    let generated = ast.as_mut().map_err(|errors| errors.clone());
    let generated = generated.and_then(|ast| {
        apply_variant(ast, options)?;
        let (spec, origins) = check(ast)?;
        generate(&spec, &origins)
    });
    let generated = generated.unwrap_or_else(|errors| panic!("{name}: {errors}"));
    Drive::new(name, &generated)
}

/// Every motor with every suitable controller, and all drives of the covering arrays.
pub fn others() -> Vec<Drive> {
    let kinds = kinds();
    let motors = motors();
    let mut drives: Vec<(String, String)> = vec![];
    for kind in &kinds {
        drives.extend(motors.iter().map(|motor| {
            let toml = kind.drive_toml(motor, &kind.choice_of(&[]), None);
            (format!("{} {}", kind.name, motor.name), toml)
        }));
    }
    // A motor without the controller has none of its texts.
    drives.retain(|(_, toml)| generate_toml(toml).is_ok());
    drives.extend(SPECIFICATIONS.iter().map(|row| {
        let name: Vec<&str> = row.what.split(' ').take(2).collect();
        (name.join(" "), row.toml.to_owned())
    }));
    let drives = drives.par_iter().map(|(name, toml)| {
        let generated = generate_toml(&specification(toml, &[]));
        let (_, generated) = generated.unwrap_or_else(|errors| panic!("{name}: {errors}"));
        Drive::new(name, &generated)
    });
    drives.collect()
}

/// A specification with the common name and further fields.
fn specification(toml: &str, fields: Fields) -> String {
    let mut document: DocumentMut = toml.parse().expect("a TOML file");
    let names = [
        ("motor", "name", NAME),
        ("motor", "description", "Hub drive"),
    ];
    for (section, field, value) in names.iter().chain(fields) {
        let number = value.parse::<i64>().map(toml_edit::value);
        document[section][field] = number.unwrap_or_else(|_| toml_edit::value(*value));
    }
    document.to_string()
}
