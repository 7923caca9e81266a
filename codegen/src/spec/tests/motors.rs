//! The motor library passes the checks, and says where its data come from.

use crate::diagnostics::{Code, Diagnostic};
use crate::spec::{SpecAst, check, parse_toml};
use std::path::PathBuf;

fn library() -> Vec<(String, SpecAst)> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../targets/motors"));
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("the motor library is there")
        .map(|entry| entry.expect("readable entry").path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .collect();
    files.sort();
    files
        .iter()
        .map(|path| {
            let name = path
                .file_name()
                .expect("is a file")
                .to_string_lossy()
                .into_owned();
            let text = std::fs::read_to_string(path).expect("readable file");
            let ast = parse_toml(&text, &name).unwrap_or_else(|errors| panic!("{errors}"));
            (name, ast)
        })
        .collect()
}

#[test]
fn every_library_motor_passes_the_checks() {
    let library = library();
    assert!(library.len() >= 16, "{} motors", library.len());
    let failures: Vec<String> = library
        .iter()
        .filter_map(|(_, ast)| check(ast).err().map(|errors| errors.to_string()))
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn every_library_motor_passes_with_captured_edges_and_every_option() {
    for (name, ast) in library() {
        let capture = match ast.motor.field("rotor") {
            None => "hall_capture=timer,",
            Some(_) => "",
        };
        let ahead = format!("pdcc:{capture}emf=model,advance=2");
        for variant in [
            &ahead,
            "pdcc:modulation=pair,saturation=nearest,word=16,delay=0",
            "pdcc:reference=proportional,discretisation=euler,emf_filter=0.5",
        ] {
            let mut ast = ast.clone();
            crate::spec::apply_variant(&mut ast, variant).expect("variant parses");
            let Err(errors) = check(&ast) else {
                continue;
            };
            // A motor may be on a board that cannot read legs that are off.
            let is_unreadable = |error: Diagnostic| error.code == Code::UnreadableLeg;
            let text = errors.to_string();
            assert!(
                variant.contains("pair") && errors.into_iter().all(is_unreadable),
                "{name} {variant}: {text}"
            );
        }
    }
}

#[test]
fn every_library_motor_names_source_basis_and_shape() {
    for (name, ast) in library() {
        for key in ["text", "basis", "shape"] {
            let text = ast.source.iter().find(|(source, _)| source == key);
            assert!(
                text.is_some_and(|(_, text)| text.len() > 10),
                "{name} lacks source.{key}"
            );
        }
    }
}

#[test]
fn the_paper_motor_is_the_paper_motor() {
    let (_, ast) = library()
        .into_iter()
        .find(|(name, _)| name == "trivedi-keshri-660w.toml")
        .expect("is in the library");
    let (spec, _) = check(&ast).expect("passes");
    assert_eq!(spec.name, "TrivediKeshri660w");
    assert_eq!(
        (spec.motor.emf_constant, spec.torque_constant()),
        (0.0824, 0.1648)
    );
    assert_eq!(
        (spec.inverter.t_s, spec.inverter.timer_period),
        (5e-5, 1800)
    );
    assert_eq!(
        (spec.inverter.trip_current, spec.inverter.max_current),
        (37.968_75, 22.0)
    );
    assert_eq!(spec.inverter.adc_gain, 0.019_531_25);
    let options = spec.controller.common();
    assert_eq!(
        (options.commutation_threshold, options.commutation_timeout),
        (0.5, 8)
    );
}
