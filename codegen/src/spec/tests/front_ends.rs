//! Macro tokens, TOML and variants give the same tree; the tree gives the same specification.

use crate::spec::ast::Section;
use crate::spec::{MacroInput, SpecAst, apply_variant, check, parse_macro, parse_toml};

pub(super) const MACRO: &str = r"
    /// Rear hub drive.
    pub HubDrive {
        motor: { pole_pairs: 4, resistance: 135 mohm per_phase, inductance: 0.22mH per_phase,
                 winding: star, back_emf: 0.1648 V/(rad/s) line_to_line peak,
                 emf_shape: trapezoidal, rated_current: 20A peak, rated_torque: 3.3 Nm,
                 rated_speed: 2000 rpm, inertia: 24 g cm2, inductance_tolerance: 15 %,
                 hall_codes: [1, 5, 4, 6, 2, 3] },
        inverter: { bus_voltage: 48V, f_pwm: 20 kHz, timer_clock: 72 MHz, adc_bits: 12,
                    adc_range: 40 A, current_sensing: in_phase },
        controller: pdcc { modulation: pair, emf: model, advance: 2, word: 32,
                           commutation_timeout: 10 periods },
    }";

const TOML: &str = r#"
[motor]
name = "HubDrive"
pole_pairs = 4
resistance = "135 mohm per_phase"
inductance = "0.22 mH per_phase"
winding = "star"
back_emf = "0.1648 V/(rad/s) line_to_line peak"
emf_shape = "trapezoidal"
rated_torque = "3.3 Nm"
rated_speed = "2000rpm"
inertia = "24 g*cm^2"
inductance_tolerance = "15%"
hall_codes = [1, 5, 4, 6, 2, 3]
[inverter]
bus_voltage = "48 V"
f_pwm = "20 kHz"
timer_clock = "72 MHz"
adc_bits = 12
adc_range = "40 A"
current_sensing = "in_phase"
[assumed.motor]
rated_current = { value = "20 A peak", reason = "from the torque" }
[controller]
kind = "pdcc"
modulation = "pair"
emf = "model"
advance = 2
word = 32
commutation_timeout = "10 periods"
"#;

pub(super) fn macro_input(text: &str) -> MacroInput {
    parse_macro(text.parse().expect("lexes")).unwrap_or_else(|errors| panic!("{errors}"))
}

fn toml(text: &str) -> SpecAst {
    parse_toml(text, "motors/hub.toml").unwrap_or_else(|errors| panic!("{errors}"))
}

fn fields(section: &Section) -> Vec<(String, String)> {
    let mut fields: Vec<(String, String)> = section
        .fields
        .iter()
        .map(|field| (field.name.clone(), field.value.to_string()))
        .collect();
    fields.sort();
    fields
}

#[test]
fn macro_and_toml_give_equal_trees() {
    let (from_macro, from_toml) = (macro_input(MACRO).ast, toml(TOML));
    assert_eq!(from_macro.name.text, from_toml.name.text);
    for (left, right) in [
        (&from_macro.motor, &from_toml.motor),
        (&from_macro.inverter, &from_toml.inverter),
        (&from_macro.controller, &from_toml.controller),
    ] {
        assert_eq!(fields(left), fields(right));
        for field in &left.fields {
            assert_eq!(
                Some(&field.value),
                right.field(&field.name).map(|other| &other.value)
            );
        }
    }
    assert_eq!(
        check(&from_macro).expect("passes").0,
        check(&from_toml).expect("passes").0
    );
}

#[test]
fn the_macro_keeps_attributes_visibility_and_name() {
    let input = macro_input(MACRO);
    assert_eq!(input.attributes.len(), 1);
    assert!(matches!(input.visibility, syn::Visibility::Public(_)));
    assert_eq!(input.name, "HubDrive");
    assert!(input.motor_file.is_none());
    assert_eq!(input.anchors().other.to_string(), "HubDrive");
}

#[test]
fn fragments_of_macro_rules_are_read_through_their_invisible_groups() {
    use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
    let value: TokenStream = "135".parse().expect("lexes");
    let group = TokenTree::Group(Group::new(Delimiter::None, value));
    let mut fields: TokenStream = "resistance:".parse().expect("lexes");
    fields.extend([group]);
    fields.extend("mohm per_phase".parse::<TokenStream>().expect("lexes"));
    let mut body: TokenStream = "motor:".parse().expect("lexes");
    body.extend([TokenTree::Group(Group::new(Delimiter::Brace, fields))]);
    let mut tokens: TokenStream = "Hub".parse().expect("lexes");
    tokens.extend([TokenTree::Group(Group::new(Delimiter::Brace, body))]);
    let input = parse_macro(tokens).expect("parses");
    let field = input.ast.motor.field("resistance").expect("is there");
    assert_eq!(field.value.to_string(), "135 mohm per_phase");
}

#[test]
fn a_motor_file_is_overridden_field_by_field() {
    let folder = std::env::temp_dir().join(format!("hexagen-motor-file-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("motors")).expect("creates a folder");
    std::fs::write(folder.join("motors/hub.toml"), TOML).expect("writes a file");
    let input = macro_input(
        r#"Rear {
            motor: "motors/hub.toml",
            inverter: { sampling_time: 100 us, adc_gain: 10 mA/count, trip_current: 20.4 A },
            controller: pdcc { advance: 1 },
        }"#,
    );
    assert_eq!(input.anchors().other.to_string(), "\"motors/hub.toml\"");
    let ast = input
        .load(&folder, &mut vec![])
        .unwrap_or_else(|errors| panic!("{errors}"));
    std::fs::remove_dir_all(&folder).expect("removes the folder");
    let (spec, origins) = check(&ast).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(spec.name, "Rear");
    assert_eq!(
        (spec.inverter.t_s, spec.inverter.timer_period),
        (1e-4, 3600)
    );
    assert_eq!(spec.inverter.adc_gain, 0.01);
    let options = spec.controller.common();
    assert_eq!((options.advance, options.word), (1.0, 32));
    assert_eq!(options.emf, crate::spec::EmfSource::Model);
    assert_eq!(
        origins.at("motor.resistance").to_string(),
        "motors/hub.toml:5:14"
    );
    assert!(
        origins
            .at("inverter.adc_gain")
            .to_string()
            .starts_with("macro:")
    );
    assert_eq!(
        origins.given("motor.resistance_tolerance", "30 %"),
        "30 % (default)"
    );
    assert_eq!(
        origins.at("motor.resistance_tolerance").to_string(),
        "macro:2:13"
    );
}

#[test]
fn a_variant_overrides_options_of_the_same_controller() {
    let mut ast = toml(TOML);
    apply_variant(
        &mut ast,
        "pdcc:advance=1.5,commutation_threshold=0.4A,modulation=pair",
    )
    .expect("parses");
    let (spec, _) = check(&ast).expect("passes");
    let crate::spec::ControllerSpec::Pdcc(pdcc) = spec.controller else {
        panic!("a deadbeat controller");
    };
    let options = pdcc.common;
    assert_eq!((options.advance, options.commutation_threshold), (1.5, 0.4));
    assert_eq!(pdcc.modulation, crate::spec::Modulation::Pair);
    assert_eq!(options.emf, crate::spec::EmfSource::Model);
}

#[test]
fn errors_of_a_variant_point_into_it() {
    let mut ast = toml(TOML);
    let errors = apply_variant(&mut ast, "pdcc:advance=1,word").expect_err("is malformed");
    assert_eq!(
        errors.to_string(),
        "argument `pdcc:advance=1,word`, character 16: error[HX0405]: cannot read `word` of the controller variant; write `name:key=value,key=value`, for example `pdcc:modulation=pair,advance=1.5`"
    );
    apply_variant(&mut ast, "pdcc:advance=1,word=24").expect("parses");
    let errors = check(&ast).expect_err("has no 24-bit words");
    assert_eq!(
        errors.to_string(),
        "argument `pdcc:advance=1,word=24`, character 21: error[HX0210]: `word`: 24 is not possible; give `16` or `32`"
    );
}

/// Every combination of how a motor can be stated leads to the same star.
#[test]
fn bases_and_windings_lead_to_the_same_star() {
    let reference = check(&toml(TOML)).expect("passes").0.motor;
    let same = [
        [
            ("135 mohm per_phase", "0.27 ohm line_to_line"),
            ("x", "x"),
            ("x", "x"),
        ],
        [
            ("135 mohm per_phase", "405 mohm per_phase"),
            ("0.22 mH per_phase", "0.66 mH per_phase"),
            ("winding = \"star\"", "winding = \"delta\""),
        ],
        [
            (
                "0.1648 V/(rad/s) line_to_line peak",
                "0.0824 V s/rad phase peak",
            ),
            ("x", "x"),
            ("x", "x"),
        ],
        [
            ("0.1648 V/(rad/s) line_to_line peak", "20.6 mWb"),
            ("x", "x"),
            ("x", "x"),
        ],
        [
            (
                "0.1648 V/(rad/s) line_to_line peak",
                "17.257815643 V/krpm line_to_line peak",
            ),
            ("x", "x"),
            ("x", "x"),
        ],
        [
            ("0.1648 V/(rad/s) line_to_line peak", "57.944763 rpm/V peak"),
            ("x", "x"),
            ("x", "x"),
        ],
        [
            ("0.1648 V/(rad/s) line_to_line peak", "0.12943361 V/Hz"),
            ("x", "x"),
            ("x", "x"),
        ],
    ];
    for changes in same {
        let text = changes
            .iter()
            .fold(TOML.to_owned(), |text, (old, new)| text.replace(old, new));
        let motor = check(&toml(&text))
            .unwrap_or_else(|errors| panic!("{errors}"))
            .0
            .motor;
        for (left, right) in [
            (motor.resistance, reference.resistance),
            (motor.inductance, reference.inductance),
            (motor.emf_constant, reference.emf_constant),
        ] {
            assert!(
                (left / right - 1.0).abs() < 1e-6,
                "{changes:?}: {left} {right}"
            );
        }
    }
}

/// A sinusoidal machine's line-to-line peak is sqrt(3) times its phase peak.
#[test]
fn a_sinusoidal_line_to_line_constant_is_divided_by_the_root_of_three() {
    let text = TOML
        .replace("trapezoidal", "sinusoidal")
        .replace("rated_torque", "# rated_torque");
    let motor = check(&toml(&text))
        .unwrap_or_else(|errors| panic!("{errors}"))
        .0
        .motor;
    assert!((motor.emf_constant * 3f64.sqrt() / 0.1648 - 1.0).abs() < 1e-12);
}
