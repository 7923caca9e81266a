//! Proofs can fail: a fault in what a script says of the code, beside the ideal computation and the bounds of the
//! faultless one, is refused.

use crate::generated;
use hexagen_codegen::emit::gappa::emit_gappa;
use hexagen_host::checker::is_proved;
use hexagen_lab::engine::library;
use std::env;

/// Stages whose scripts get faults.
const STAGES: [&str; 5] = [
    "step.estimate_emf.normal",
    "step.move_emf.normal",
    "step.deadbeat_voltage.normal",
    "step.find_saturation.normal",
    "step.modulate.normal",
];

/// A fault: what it is, and a definition with it, where it can have it.
type Fault = (&'static str, fn(&str) -> Option<String>);

const FAULTS: [Fault; 8] = [
    ("- for +", |text| replaced(text, " + ", " - ")),
    ("+ for -", |text| replaced(text, " - ", " + ")),
    ("rounded down", |text| replaced(text, "nearest(", "floor(")),
    ("shift one less", |text| {
        replaced(text, " * 1b-32)", " * 1b-31)")
    }),
    ("shift one more", |text| {
        replaced(text, " * 1b-32)", " * 1b-33)")
    }),
    ("wrong bit in a coefficient", wrong_coefficient),
    ("missing term", |text| {
        let (kept, _) = text.split_once(" + ")?;
        Some(kept.to_owned())
    }),
    ("negated", |text| {
        let (name, value) = text.split_once(" = ")?;
        Some(format!("{name} = -({value})"))
    }),
];

fn replaced(text: &str, old: &str, new: &str) -> Option<String> {
    text.contains(old).then(|| text.replacen(old, new, 1))
}

fn wrong_coefficient(text: &str) -> Option<String> {
    let (before, after) = text.split_once("nearest(")?;
    let (number, rest) = after.split_once(' ')?;
    let number: i64 = number.parse().ok()?;
    Some(format!("{before}nearest({} {rest}", number ^ 1 << 12))
}

/// The script with a fault in the first definition that can have it and stands beside an ideal one.
fn planted(script: &str, fault: fn(&str) -> Option<String>) -> Option<String> {
    let mut lines: Vec<String> = script.lines().map(str::to_owned).collect();
    let place = lines.iter().position(|line| {
        let name = line.split(" = ").next().unwrap_or_default();
        let ideal = format!("M{name} = ");
        let is_definition = line.ends_with(';') && !line.starts_with('@') && !line.contains("->");
        is_definition
            && lines.iter().any(|line| line.starts_with(&ideal))
            && fault(line.trim_end_matches(';')).is_some()
    })?;
    let faulty = fault(lines[place].trim_end_matches(';'))?;
    lines[place] = format!("{faulty};");
    Some(lines.join("\n"))
}

/// Every third fault in a push; all of them where `HEXAGEN_ALL_FAULTS` is set, as in the nightly run.
#[test]
fn planted_faults_are_refused() {
    let library = library();
    let motor = library
        .iter()
        .find(|motor| motor.name == "trivedi-keshri-660w");
    let motor = motor.expect("the paper's motor");
    let generated = generated(motor.text, "pdcc:reference=quasi_square").expect("generates");
    let scripts = emit_gappa(&generated.graph);
    let all = env::var_os("HEXAGEN_ALL_FAULTS").is_some();
    let (mut found, mut count, mut wrong) = (0, 0, vec![]);
    for script in &scripts {
        if !STAGES.iter().any(|stage| script.name.starts_with(stage)) {
            continue;
        }
        let text = script.to_string();
        assert!(is_proved(&text).expect("gappa runs"), "{}", script.name);
        for (what, fault) in FAULTS {
            if let Some(faulty) = planted(&text, fault) {
                found += 1;
                if !all && found % 3 != 0 {
                    continue;
                }
                count += 1;
                if is_proved(&faulty).expect("gappa runs") {
                    wrong.push(format!("{}: {what}: proved\n{faulty}", script.name));
                }
            }
        }
    }
    println!("{count} faults planted");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(
        found >= 30 && count * 3 >= 30,
        "{count} faults planted of {found}"
    );
}
