//! `hexagen verify` and `compare`: engines, results, and a planted fault that must be found.

use crate::support::{PAPER, Said, hexagen, keys, number, run};
use serde_json::Value;

fn first(said: &Said) -> Value {
    said.json()["results"][0].clone()
}

#[test]
fn built_in_drives_are_checked_compiled() {
    let said = run(["verify", "--steps", "20000", "--json"]);
    let result = said.json();
    assert_eq!(keys(&result), ["passed", "refused", "results", "steps"]);
    assert_eq!(result["passed"], true);
    let results = result["results"].as_array().expect("a list");
    assert!(results.len() >= 12);
    for checked in results {
        assert_eq!(checked["engine"], "compiled", "{checked}");
        assert_eq!(number(checked, "steps"), 20_000.0);
        assert_eq!(checked["passed"], true);
        assert!(
            number(&checked["coverage"], "running") > 10_000.0,
            "{checked}"
        );
    }
    assert_eq!(number(&result, "steps"), 20_000.0 * results.len() as f64);
}

#[test]
fn other_drives_are_compiled_or_interpreted() {
    let arguments = [
        "verify",
        PAPER,
        "--controller",
        "pdcc:modulation=pair,emf=model",
        "--steps",
        "5000",
        "--json",
    ];
    let compiled = first(&run(arguments));
    assert_eq!(
        (&compiled["engine"], &compiled["passed"]),
        (&"compiled".into(), &true.into())
    );
    assert!(
        number(&compiled["coverage"], "commutating") > 0.0,
        "{compiled}"
    );

    let output = hexagen()
        .args(arguments)
        .env("RUSTC", "no-such-compiler")
        .output();
    let said = Said::from(output.expect("the program starts"));
    let interpreted = first(&said);
    assert_eq!(interpreted["engine"], "interpreter");
    assert!(said.stderr.contains("interpreted"), "{}", said.stderr);
    // The same inputs, whatever runs.
    assert_eq!(interpreted["coverage"], compiled["coverage"]);
}

#[test]
fn all_controllers_are_those_that_there_are() {
    let result = run([
        "verify",
        PAPER,
        "--controller",
        "all",
        "--steps",
        "1000",
        "--json",
    ])
    .json();
    let results = result["results"].as_array().expect("a list");
    let controllers: Vec<&Value> = results
        .iter()
        .map(|checked| &checked["controller"])
        .collect();
    assert_eq!(controllers, ["fcs-mpc", "pdcc", "phcc", "pi-pwm"]);
}

#[test]
fn the_table_says_engine_and_result() {
    let said = run(["verify", PAPER, "--steps", "1000"]);
    assert_eq!((said.code, said.stderr.as_str()), (0, ""));
    assert!(
        said.stdout.contains("compiled") && said.stdout.contains("equal"),
        "{}",
        said.stdout
    );
}

/// A compiler that plants a fault into the emitted text on its way.
#[cfg(unix)]
#[test]
fn a_fault_planted_in_the_emitted_text_is_found() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a folder");
    let compiler = folder.path().join("faulty-rustc");
    // The limit of the plausible change of current, one less: the last bit of one constant.
    let script = "#!/bin/sh\n\
        if [ -f emitted.rs ]; then\n\
        awk '/const K_HOLD: Word = Word\\(/ { n = $0; gsub(/[^0-9]/, \"\", n); v = n + 1;\n\
        print \"    const K_HOLD: Word = Word(\" v \");\"; next } { print }' emitted.rs > faulty.rs\n\
        cmp -s emitted.rs faulty.rs && exit 3\n\
        mv faulty.rs emitted.rs\n\
        fi\n\
        exec rustc \"$@\"\n";
    std::fs::write(&compiler, script).expect("can be written");
    std::fs::set_permissions(&compiler, std::fs::Permissions::from_mode(0o755)).expect("is ours");
    let output = hexagen()
        .args([
            "verify",
            PAPER,
            "--controller",
            "pdcc:advance=0.5",
            "--steps",
            "20000",
            "--json",
        ])
        .env("RUSTC", &compiler)
        .output();
    let said = Said::from(output.expect("the program starts"));
    assert_eq!(said.code, 1, "{said:?}");
    let result = said.json_whatever_the_code();
    assert_eq!(result["passed"], false);
    let checked = &result["results"][0];
    assert_eq!(
        (&checked["engine"], &checked["passed"]),
        (&"compiled".into(), &false.into())
    );
    for text in ["differs", "adc_a =", "v_a_cmd", "<--"] {
        assert!(
            said.stderr.contains(text),
            "no `{text}` in\n{}",
            said.stderr
        );
    }
}

#[test]
fn compare_tells_accuracy_per_word_length() {
    let result = run(["compare", PAPER, "--json"]).json();
    let rows = result["rows"].as_array().expect("a list");
    let words: Vec<f64> = rows.iter().map(|row| number(row, "word")).collect();
    assert_eq!(words, [32.0, 16.0]);
    let snr = |row: &Value| number(&row["one_step"], "snr_db");
    // The line EMF that an estimate is moved on with has 15 bits, whatever the word.
    assert!(snr(&rows[0]) > 100.0 && snr(&rows[0]) > snr(&rows[1]) + 30.0);
    assert!(number(&rows[0]["one_step"], "u_largest_v") < 1e-3);
    assert!(number(&rows[0]["one_step"], "equal_compares_pct") > 99.0);
    for at in rows[0]["closed_loop"].as_array().expect("a list") {
        let merits = at["merits"].as_array().expect("a list");
        assert_eq!(merits.len(), 14);
        for merit in merits {
            assert_eq!(merit["close"], true, "{merit}");
        }
    }
}

#[test]
fn compare_says_why_a_word_length_is_refused() {
    let result = run([
        "compare",
        PAPER,
        "--adc-bits",
        "16",
        "--start-angle",
        "0.1",
        "--json",
    ])
    .json();
    let rows = result["rows"].as_array().expect("a list");
    assert_eq!(rows[0]["refused"], Value::Null);
    let refused = rows[1]["refused"].as_str().expect("a reason");
    assert!(
        refused.contains("error[HX") && rows[1].get("one_step").is_none(),
        "{refused}"
    );
}
