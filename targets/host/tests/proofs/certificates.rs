//! Certificates for Coq: what Gappa proves they say, and where there is a Coq it takes them, but none that was
//! tampered with.

use crate::generated;
use hexagen_codegen::emit::gappa::{Script, emit_gappa};
use hexagen_host::checker::{certificate, check_certificate, coq_version};
use hexagen_lab::engine::library;
use std::env;

fn scripts() -> Vec<Script> {
    let library = library();
    let motor = library
        .iter()
        .find(|motor| motor.name == "trivedi-keshri-660w");
    let motor = motor.expect("the paper's motor");
    let generated = generated(motor.text, "pdcc").expect("the default drive");
    emit_gappa(&generated.graph)
}

/// A certificate of one short script with rounding half up.
fn of_set_current() -> String {
    let scripts = scripts();
    let script = scripts.iter().find(|script| {
        script.name.starts_with("set_current") && script.to_string().contains("j_new")
    });
    certificate(script.expect("a set-point is rounded")).expect("proved")
}

#[test]
fn certificates_say_what_they_prove() {
    let text = of_set_current();
    for part in [
        "Lemma roundNU_eq",
        "(* BND(j_new_",
        "Lemma l1 : s1 -> False.",
        "Print Assumptions l1.",
    ] {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
    for word in ["Admitted", "Axiom", "admit."] {
        assert!(!text.contains(word), "`{word}` in\n{text}");
    }
}

#[test]
fn a_false_bound_has_no_certificate() {
    let mut script = scripts()
        .into_iter()
        .find(|script| script.name.starts_with("set_current"))
        .expect("a set-point is rounded");
    script.goals[0].high.mantissa -= 1;
    let refused = certificate(&script).expect_err("a bound that does not hold");
    assert!(refused.starts_with("no certificate: "), "{refused}");
}

/// Where `HEXAGEN_COQ` is set, as in the nightly run: a push needs no Coq.
#[test]
fn coq_refuses_what_was_tampered_with() {
    if env::var_os("HEXAGEN_COQ").is_none() {
        return;
    }
    coq_version().expect("a Coq with the library of Gappa");
    let text = of_set_current();
    check_certificate(&text).expect("as Gappa wrote it");
    // A hypothesis, a theorem that is only claimed, and one that is taken for granted.
    let bound = "Definition f2 := Float2 (";
    for (old, new) in [
        (bound, "Definition f2 := Float2 (9"),
        (
            "Lemma l1 : s1 -> False.\nProof.",
            "Lemma l1 : s1 -> False.\nAdmitted.\nLemma l0 : s1 -> False.\nProof.",
        ),
        (
            "Lemma l1 : s1 -> False.",
            "Axiom a : s1 -> False.\nLemma l1 : s1 -> False.\nProof. exact a. Qed.\nLemma l0 : s1 -> False.",
        ),
    ] {
        assert!(text.contains(old), "`{old}` in\n{text}");
        let tampered = text.replacen(old, new, 1);
        let refused = check_certificate(&tampered).expect_err("it was tampered with");
        println!("{refused}");
        assert!(refused.starts_with("certificate refused: "), "{refused}");
    }
}
