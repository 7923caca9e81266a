//! Certificates: Gappa's proofs, checked again by Coq with its small kernel.
//!
//! A certificate is one self-contained file that ends with `Print Assumptions`: only the axioms of
//! Coq's real numbers are accepted, no admitted lemma and no other axiom.

use super::program::{Ended, run_within};
use super::run::gappa;
use super::{Missing, TIME_LIMIT};
use hexagen_codegen::emit::gappa::Script;
use std::process::Command;
use std::time::Duration;

/// Time limit of a check; the longest of the 660 W motor takes 1 % of it on an idle core.
const CHECK_LIMIT: Duration = Duration::from_secs(300);

/// Gappa's name of half-up rounding, and its definition, which the library lacks.
const HALF_UP: (&str, &str) = ("rndNU", include_str!("half_up.v"));

/// The theorem at the end of Gappa's output: the hypotheses contradict the negated goal.
const THEOREM: &str = "Lemma l1 : s1 -> False.";

/// Axioms of Coq's library on real numbers, functions and logic.
const AXIOMS: [&str; 4] = [
    "ClassicalDedekindReals.sig_forall_dec",
    "ClassicalDedekindReals.sig_not_dec",
    "FunctionalExtensionality.functional_extensionality_dep",
    "Classical_Prop.classic",
];

/// Certificates cannot be checked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no Coq with the library of Gappa ({0}): install them, `apt install coq libcoq-gappa` on Debian and Ubuntu, `opam install coq-gappa` elsewhere"
)]
pub struct MissingCoq(String);

/// Version of Coq.
///
/// # Errors
/// Without Coq or its Gappa library.
pub fn coq_version() -> Result<String, MissingCoq> {
    let run = |program: &str, arguments: &[&str]| {
        let ended = run_within(Command::new(program).args(arguments), "", CHECK_LIMIT)
            .map_err(|error| MissingCoq(format!("`{program}`: {error}")))?;
        match ended.status {
            Some(status) if status.success() => Ok(ended),
            _ => Err(MissingCoq(format!("`{program}`: {}", ended.reason()))),
        }
    };
    run(
        "coqtop",
        &["-q", "-batch", "-require-import", "Gappa.Gappa_library"],
    )?;
    let version = run("coqc", &["--version"])?.printed;
    Ok(version.lines().next().unwrap_or_default().to_owned())
}

/// The certificate of a script.
///
/// # Errors
/// Gappa's reason for not proving the script, or that Gappa is missing.
pub fn certificate(script: &Script) -> Result<String, String> {
    let ended = run_within(gappa().arg("-Bcoq"), &script.to_string(), TIME_LIMIT)
        .map_err(|error| Missing::of(&error).to_string())?;
    match ended.status {
        None => {
            return Err(format!("no certificate in {} s", TIME_LIMIT.as_secs()));
        }
        Some(status) if !status.success() => {
            return Err(format!("no certificate: {}", ended.reason()));
        }
        Some(_) if !ended.printed.contains(THEOREM) => {
            return Err(format!("no certificate: no `{THEOREM}`"));
        }
        Some(_) => {}
    }
    let (name, missing) = HALF_UP;
    let prelude = if ended.printed.contains(name) {
        missing
    } else {
        ""
    };
    Ok(format!(
        "(* {}: the bounds that hexagen states, proved by Gappa; `coqc` checks them. *)\n\n{prelude}\n{}\nPrint Assumptions l1.\n",
        script.name, ended.printed
    ))
}

/// Checks a certificate with Coq; returns the time.
///
/// # Errors
/// Why it is refused.
pub fn check_certificate(certificate: &str) -> Result<Duration, String> {
    let failed = |error: std::io::Error| format!("certificate not checked: {error}");
    // Coq writes files next to its input.
    let folder = tempfile::tempdir().map_err(failed)?;
    std::fs::write(folder.path().join("certificate.v"), certificate).map_err(failed)?;
    let mut coqc = Command::new("coqc");
    coqc.args(["-q", "-w", "-all", "certificate.v"])
        .current_dir(folder.path());
    let ended = run_within(&mut coqc, "", CHECK_LIMIT).map_err(failed)?;
    match ended.status {
        None => Err(format!(
            "certificate not checked in {} s",
            CHECK_LIMIT.as_secs()
        )),
        Some(status) if status.success() => rests_on_axioms_alone(&ended),
        Some(_) => Err(format!("certificate refused: {}", ended.reason())),
    }
}

/// Checks the assumptions of an accepted certificate.
fn rests_on_axioms_alone(ended: &Ended) -> Result<Duration, String> {
    let mut lines = ended.printed.lines();
    let assumed: Vec<&str> = match lines.next() {
        Some("Closed under the global context") => vec![],
        // Types go on in indented lines.
        Some("Axioms:") => lines
            .filter(|line| !line.starts_with(' '))
            .filter_map(|line| line.split_whitespace().next())
            .collect(),
        said => {
            return Err(format!(
                "certificate without a list of assumptions: {}",
                said.unwrap_or_default()
            ));
        }
    };
    match assumed.iter().find(|name| !AXIOMS.contains(name)) {
        None => Ok(ended.took),
        Some(name) => Err(format!("certificate refused: it assumes `{name}`")),
    }
}
