//! Certificates: Gappa's proofs as terms that Coq, whose kernel is a few thousand lines, checks again.
//!
//! A certificate is one file that stands for itself. It ends by asking what it rests on: nothing but the
//! axioms of Coq's real numbers is let through, so neither an admitted lemma nor an axiom of its own passes.

use super::program::{Ended, run_within};
use super::run::gappa;
use super::{Missing, TIME_LIMIT};
use hexagen_codegen::emit::gappa::Script;
use std::process::Command;
use std::time::Duration;

/// A check may take so long; the longest of the 660 W motor's takes a hundredth of it on an idle core.
const CHECK_LIMIT: Duration = Duration::from_secs(300);

/// What Gappa's output calls half-up rounding, and what the library lacks of it.
const HALF_UP: (&str, &str) = ("rndNU", include_str!("half_up.v"));

/// The theorem at the end of Gappa's output: hypotheses and a goal that does not hold contradict each other.
const THEOREM: &str = "Lemma l1 : s1 -> False.";

/// What Coq's library takes for granted of real numbers, functions and truth.
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
/// When there is none, or it has no library of Gappa.
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
/// What Gappa says where it does not prove the script, or that there is no Gappa.
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

/// Has Coq check a certificate; how long that took.
///
/// # Errors
/// Why it does not hold.
pub fn check_certificate(certificate: &str) -> Result<Duration, String> {
    let failed = |error: std::io::Error| format!("certificate not checked: {error}");
    // Coq writes beside what it reads.
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

/// Looks at what a certificate that has been checked assumes.
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
                "certificate does not tell what it assumes: {}",
                said.unwrap_or_default()
            ));
        }
    };
    match assumed.iter().find(|name| !AXIOMS.contains(name)) {
        None => Ok(ended.took),
        Some(name) => Err(format!("certificate refused: it assumes `{name}`")),
    }
}
