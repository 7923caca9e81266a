//! `hexagen verify` and `compare`: engines, results, and a planted fault that must be found.

use crate::support::{PAPER, Said, hexagen, keys, number, run};
use serde_json::Value;
use std::ffi::OsStr;
use std::sync::OnceLock;

/// Runs the program with a variable of its environment set.
fn run_with(arguments: &[&str], variable: &str, value: &OsStr) -> Said {
    let output = hexagen().args(arguments).env(variable, value).output();
    Said::from(output.expect("the program starts"))
}

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

    let said = run_with(&arguments, "RUSTC", "no-such-compiler".as_ref());
    let interpreted = first(&said);
    assert_eq!(interpreted["engine"], "interpreter");
    assert!(said.stderr.contains("interpreted"), "{}", said.stderr);
    // The same inputs, whatever runs.
    assert_eq!(interpreted["coverage"], compiled["coverage"]);
}

/// Arguments that verify the paper motor's drive as C, over so many steps.
fn in_c99(steps: &str) -> [&str; 7] {
    [
        "verify",
        PAPER,
        "--language",
        "c99",
        "--steps",
        steps,
        "--json",
    ]
}

#[test]
fn emitted_c_is_compiled_and_compared() {
    let arguments = in_c99("5000");
    let compared = first(&run(arguments));
    assert_eq!(
        (&compared["engine"], &compared["passed"]),
        (&"compiled".into(), &true.into())
    );
    // The same inputs, whatever runs.
    let rust = first(&run(["verify", PAPER, "--steps", "5000", "--json"]));
    assert_eq!(rust["coverage"], compared["coverage"]);

    let said = run_with(&arguments, "CC", "no-such-compiler".as_ref());
    assert_eq!(said.code, 2);
    assert!(
        said.stderr.contains("the C compiler cannot run"),
        "{said:?}"
    );
}

/// A compiler that plants a fault into emitted C on its way: the last bit of one constant.
#[cfg(unix)]
#[test]
fn a_fault_planted_in_emitted_c_is_found() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a folder");
    let compiler = folder.path().join("faulty-cc");
    let script = "#!/bin/sh\n\
        source=trivedi_keshri_660w.c\n\
        awk '/^#define K_HOLD INT32_C/ { n = $3; gsub(/[^0-9]/, \"\", n); sub(/^32/, \"\", n);\n\
        print $1, $2, \"INT32_C(\" n + 1 \")\"; next } { print }' $source > faulty\n\
        cmp -s $source faulty && exit 3\n\
        mv faulty $source\n\
        exec cc \"$@\"\n";
    std::fs::write(&compiler, script).expect("can be written");
    std::fs::set_permissions(&compiler, std::fs::Permissions::from_mode(0o755)).expect("is ours");
    let arguments = in_c99("20000");
    let said = run_with(&arguments, "CC", compiler.as_os_str());
    assert_eq!(said.code, 1, "{said:?}");
    assert_eq!(said.json_whatever_the_code()["passed"], false);
    for text in ["differs", "adc_a =", "net_a_next", "<--"] {
        assert!(
            said.stderr.contains(text),
            "no `{text}` in\n{}",
            said.stderr
        );
    }
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
    assert_eq!(controllers, ["fcs-mpc", "p-pwm", "pdcc", "phcc", "pi-pwm"]);
}

#[test]
fn the_table_says_engine_and_result() {
    let said = run(["verify", PAPER, "--steps", "1000"]);
    // Without a terminal a line a part in place of a bar.
    let told = "comparing bit for bit …\n";
    assert_eq!((said.code, said.stderr.as_str()), (0, told));
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
    let arguments = [
        "verify",
        PAPER,
        "--controller",
        "pdcc:advance=0.5",
        "--steps",
        "20000",
        "--json",
    ];
    let said = run_with(&arguments, "RUSTC", compiler.as_os_str());
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

/// Controllers that modulate, in rows of `compare`.
fn modulates(row: &Value) -> bool {
    let controller = row["controller"].as_str().expect("a name");
    ["p-pwm", "pdcc", "pi-pwm"]
        .iter()
        .any(|kind| controller.starts_with(kind))
}

/// What `compare` says of the paper's motor: one run serves several tests.
fn compared() -> &'static Value {
    static COMPARED: OnceLock<Value> = OnceLock::new();
    COMPARED.get_or_init(|| run(["compare", PAPER, "--json"]).json())
}

#[test]
fn compare_tells_accuracy_per_controller_and_word_length() {
    let result = compared();
    let rows = result["rows"].as_array().expect("a list");
    let named = |row: &Value| row["controller"].as_str().map(str::to_owned);
    let names: Vec<String> = rows.iter().filter_map(named).collect();
    let kinds = ["fcs-mpc", "p-pwm", "pdcc", "phcc", "pi-pwm"];
    let all = kinds.map(|kind| [32, 16].map(|word| format!("{kind}:word={word}")));
    assert_eq!(names, all.as_flattened());
    for row in rows {
        let one_step = &row["one_step"];
        let (largest, bound) = (number(one_step, "largest_v"), number(one_step, "bound_v"));
        let seen = number(one_step, "seen_to_bound");
        assert!((seen * bound / largest - 1.0).abs() < 1e-12, "{row}");
        // A bound that nothing comes near would say nothing.
        assert!(seen <= 1.0 && seen > 0.02, "{row}");
        let decisions = number(one_step, "decisions_equal_pct");
        assert!(
            decisions > if modulates(row) { 99.9 } else { 96.0 },
            "{row}"
        );
        let counts = row["histogram"].as_array().expect("a list");
        let counted: f64 = counts.iter().filter_map(Value::as_f64).sum();
        assert_eq!(counted, 2.0 * number(one_step, "steps"));
        // Where the current follows the EMF, a table's misfit is more than the rounding of wide words.
        let least_snr = match number(row, "word") {
            32.0 if modulates(row) => 75.0,
            32.0 => 110.0,
            _ => 60.0,
        };
        assert!(number(one_step, "snr_db") > least_snr, "{row}");
    }
}

#[test]
fn compare_finds_fixed_and_floating_point_as_close_as_asked() {
    let rows = ["p-pwm", "pdcc", "pi-pwm"].map(|kind| {
        let variant = format!("{kind}:reference=quasi_square,word=32");
        let result = run(["compare", PAPER, "--controller", &variant, "--json"]).json();
        result["rows"][0].clone()
    });
    let mut compared = 0;
    for row in &rows {
        let one_step = &row["one_step"];
        assert!(number(one_step, "bound_v") <= 1e-5, "{row}");
        assert!(number(one_step, "equal_steps_pct") >= 99.9, "{row}");
        assert!(number(one_step, "compares_apart_counts") <= 1.0, "{row}");
        for at in row["closed_loop"].as_array().expect("a list") {
            let figures = at["figures"].as_array().expect("a list");
            assert_eq!(figures.len(), 16);
            for figure in figures {
                assert_eq!(figure["close"], true, "{figure}");
                assert!(number(figure, "of_allowance") <= 1.0, "{figure}");
                compared += 1;
            }
        }
    }
    // Three controllers that modulate, at two speeds.
    assert_eq!(compared, 3 * 2 * 16);
}

#[test]
fn compare_prints_a_row_per_controller_and_the_figures_of_merit_of_one() {
    let all = run(["compare", PAPER, "--start-angle", "0.1rad"]);
    assert_eq!(all.code, 0, "{all:?}");
    for text in [
        "SNR",
        "bound V",
        "ratio",
        "decisions",
        "closed loop",
        "phcc:word=16",
    ] {
        assert!(all.stdout.contains(text), "no `{text}` in\n{}", all.stdout);
    }
    assert!(
        !all.stdout
            .contains("| distance from quasi-square currents, rms"),
        "{}",
        all.stdout
    );
    // A sentence for each word length.
    let (_, closing) = all.stdout.split_once("or --json.\n").expect("is told");
    let closing = closing.split_whitespace().collect::<Vec<_>>().join(" ");
    let sentences: Vec<&str> = closing.split(". ").collect();
    let [wide, narrow] = sentences[..] else {
        panic!("{closing}");
    };
    assert!(wide.starts_with("Words of 32 bits suffice"), "{wide}");
    assert!(narrow.starts_with("Words of 16 bits "), "{narrow}");
    // A distance from blocks says nothing of a current that follows the EMF.
    for (reference, has_blocks) in [("quasi_square", true), ("proportional", false)] {
        let variant = format!("pi-pwm:reference={reference}");
        let controller = ["--controller", variant.as_str(), "--start-angle", "0.1rad"];
        let one = run(["compare", PAPER].iter().chain(&controller));
        let figure = "| distance from quasi-square currents, rms";
        assert_eq!(one.stdout.contains(figure), has_blocks, "{}", one.stdout);
        assert!(!one.stdout.contains("phcc:word"), "{}", one.stdout);
    }
}

#[test]
fn compare_says_below_its_table_why_controllers_are_refused() {
    let said = run(["compare", "odrive-d6374-150kv", "--start-angle", "0.1rad"]);
    assert_eq!(said.code, 0, "{said:?}");
    let rows = said.stdout.lines().filter(|line| line.starts_with('|'));
    for row in rows.clone() {
        assert!(row.chars().count() < 160, "{row}");
    }
    let refused = rows.filter(|row| row.contains(" refused "));
    // Two controllers at two word lengths, in both tables.
    assert_eq!(refused.count(), 8, "{}", said.stdout);
    assert_eq!(
        said.stdout.matches("error[HX0406]").count(),
        4,
        "{}",
        said.stdout
    );
}

#[test]
fn formats_of_a_motor_are_better_than_one_for_the_whole_library() {
    let result = run(["compare", "--json"]).json();
    assert!(number(&result, "better_by_db") >= 20.0, "{result}");
    let rows = result["rows"].as_array().expect("a list");
    assert_eq!(rows.len(), 16);
    for row in rows {
        assert_eq!(row["refused"], Value::Null);
        assert!(number(row, "better_by_db") >= 20.0, "{row}");
        assert!(number(&row["one_step"], "seen_to_bound") <= 1.0, "{row}");
    }
    run(["compare", "--controller", "pdcc"]).assert_bad_input(&["<MOTOR>"]);
}

#[test]
fn compare_says_why_a_word_length_is_refused() {
    let result = run([
        "compare",
        PAPER,
        "--controller",
        "pdcc",
        "--adc-bits",
        "16",
        "--start-angle",
        "0.1rad",
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
