//! `hexagen prove`: absence of overflow and error bounds, proved with Gappa.

mod certificates;

pub use certificates::{Certificates, Certify};

use crate::checker::{Proof, coq_version, gappa_version, missing_goals, prove};
use crate::cli::{Bar, Failure, Selection, note, print_json, print_table};
use crate::commands::selected::{Refused, select};
use certificates::Certified;
use clap::Args;
use hexagen_codegen::emit::gappa::{Script, emit_gappa};
use hexagen_codegen::ir::stated_errors;
use hexagen_lab::Progress;
use hexagen_lab::engine::Prepared;
use hexagen_lab::report::{Column, Table};
use hexagen_lab::text::significant;
use rayon::prelude::*;
use serde::Serialize;
use std::path::PathBuf;

/// Default folder of certificates.
const FOLDER: &str = "target/hexagen/coq";

/// Options of `prove`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor files or names of library motors [default: the whole library]
    #[arg(value_name = "MOTOR")]
    pub motors: Vec<String>,
    /// Board, a name of the library or a file [default: the motor files']
    #[arg(long, value_name = "BOARD")]
    pub board: Option<String>,
    /// Controller variant, or `all`, with 32-bit and with 16-bit words [default: the motor file's]
    #[arg(long, value_name = "NAME[:KEY=VALUE,…]")]
    pub controller: Option<Selection>,
    /// Write Coq proofs, MOTOR/CONTROLLER/*.v, into a folder [default: target/hexagen/coq], and check
    /// them if coqc is installed
    #[arg(
        long,
        value_name = "DIR",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = FOLDER
    )]
    pub coq: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// The proofs of one drive.
#[derive(Clone, Debug, Serialize)]
pub struct Proved {
    /// Motor.
    pub motor: String,
    /// Controller variant.
    pub controller: String,
    /// Scripts, one implication each.
    pub scripts: usize,
    /// Stated bounds.
    pub goals: usize,
    /// Proved bounds.
    pub proved: usize,
    /// Largest ratio of the generator's own bound on an error to the one that Gappa finds.
    pub widest: f64,
    /// Time of the longest script, seconds.
    pub longest_s: f64,
    /// Coq proofs, if requested.
    pub certificates: Option<Certificates>,
    /// Bounds on the distance from the ideal computation.
    pub errors: Vec<Stated>,
    /// Whether everything is proved.
    pub passed: bool,
    /// Unproved goals.
    pub failures: Vec<String>,
}

/// A stated bound.
#[derive(Clone, Debug, Serialize)]
pub struct Stated {
    /// Quantity.
    pub quantity: String,
    /// Unit.
    pub unit: String,
    /// Largest error on the normal path.
    pub bound: f64,
    /// The same in units of the last place.
    pub bound_ulp: f64,
    /// Largest error where the voltage is limited, in the quantity's unit.
    pub limited: Option<f64>,
}

/// Proves all drives, all scripts in parallel. A goal of a drive's graph that no script states is a
/// failure as well.
///
/// # Errors
/// Without Gappa, or if a certificate cannot be written.
pub fn collect(drives: &[Prepared], certify: Option<Certify>) -> Result<Vec<Proved>, Failure> {
    let scripts = drives
        .iter()
        .map(|drive| emit_gappa(&drive.generated.graph));
    collect_scripts(drives, scripts.collect(), certify)
}

/// As [`collect`], with the given scripts of each drive.
///
/// # Errors
/// As [`collect`].
pub fn collect_scripts(
    drives: &[Prepared],
    scripts: Vec<Vec<Script>>,
    certify: Option<Certify>,
) -> Result<Vec<Proved>, Failure> {
    gappa_version()?;
    let missing: Vec<Vec<String>> = drives
        .iter()
        .zip(&scripts)
        .map(|(drive, scripts)| missing_goals(&drive.generated.graph, scripts))
        .collect();
    let scripts: Vec<(usize, Script)> = scripts
        .into_iter()
        .enumerate()
        .flat_map(|(drive, scripts)| scripts.into_iter().map(move |script| (drive, script)))
        .collect();
    let progress = Bar::of_long_work();
    progress.begin("proving", scripts.len() as u64);
    let proofs: Result<Vec<(usize, Proof, Option<Certified>)>, _> = scripts
        .par_iter()
        .map(|(drive, script)| {
            let mut proof = prove(script)?;
            let certified = certify.map(|certify| certify.script(&drives[*drive], script));
            let certified = certified.transpose()?;
            let refused = certified.as_ref().and_then(|one| one.failure(&script.name));
            proof.failure = proof.failure.or(refused);
            progress.advance(1);
            Ok::<_, Failure>((*drive, proof, certified))
        })
        .collect();
    let proofs = proofs?;
    let of_drive = |(number, drive): (usize, &Prepared)| {
        let own = || proofs.iter().filter(|(of, ..)| *of == number);
        let proofs = || own().map(|(_, proof, _)| proof);
        let refused = proofs().filter_map(|proof| proof.failure.clone());
        let failures: Vec<String> = missing[number].iter().cloned().chain(refused).collect();
        Proved {
            motor: drive.motor.clone(),
            controller: drive.variant.clone(),
            scripts: own().count(),
            goals: proofs().map(|proof| proof.goals).sum(),
            proved: proofs().map(|proof| proof.proved).sum(),
            widest: proofs().map(|proof| proof.widest).fold(1.0, f64::max),
            longest_s: proofs()
                .map(|proof| proof.took.as_secs_f64())
                .fold(0.0, f64::max),
            certificates: certify
                .map(|_| Certificates::of(own().filter_map(|(.., certified)| certified.as_ref()))),
            errors: stated(drive),
            passed: failures.is_empty(),
            failures,
        }
    };
    Ok(drives.iter().enumerate().map(of_drive).collect())
}

/// The bounds that a drive states.
fn stated(drive: &Prepared) -> Vec<Stated> {
    let errors = stated_errors(drive.generated.graph.program());
    let stated = errors.into_iter().map(|error| Stated {
        bound: error.normal_bound(),
        bound_ulp: error.normal.magnitude(),
        limited: error.rare_bound(),
        quantity: error.name,
        unit: error.unit,
    });
    stated.collect()
}

/// Runs the command.
///
/// # Errors
/// Diagnostics, a missing checker, or unproved goals.
pub fn run(options: &Options) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Proofs {
        passed: bool,
        checker: String,
        certificate_checker: Option<String>,
        goals: usize,
        results: Vec<Proved>,
        refused: Vec<Refused>,
    }
    let takes_all = options.controller == Some(Selection::All);
    let variants: Vec<Option<String>> = match &options.controller {
        None => vec![None],
        Some(Selection::One(variant)) => vec![Some(variant.clone())],
        Some(all) => {
            let words = |kind: &String| [format!("{kind}:word=32"), format!("{kind}:word=16")];
            all.variants().iter().flat_map(words).map(Some).collect()
        }
    };
    let checker = gappa_version()?;
    let coq = options.coq.as_ref().map(|_| coq_version());
    let (drives, refused) = select(
        &options.motors,
        options.board.as_deref(),
        &variants,
        takes_all,
    )?;
    let certify = options.coq.as_ref().map(|folder| Certify {
        folder,
        checks: matches!(coq, Some(Ok(_))),
    });
    let results = collect(&drives, certify)?;
    let failures: Vec<String> = results
        .iter()
        .flat_map(|proved| {
            let place = format!("{}, {}", proved.motor, proved.controller);
            let failures = proved.failures.iter();
            failures.map(move |failure| format!("{place}: {failure}"))
        })
        .collect();
    let passed = failures.is_empty();
    if options.json {
        print_json(&Proofs {
            passed,
            checker,
            certificate_checker: coq.as_ref().and_then(|coq| coq.clone().ok()),
            goals: results.iter().map(|proved| proved.goals).sum(),
            results,
            refused,
        })?;
    } else {
        print_table(&table(&results))?;
    }
    if let (Some(folder), Some(Err(missing))) = (&options.coq, &coq) {
        note(&format!(
            "certificates are in {}, not checked: {missing}",
            folder.display()
        ));
    }
    if passed {
        Ok(())
    } else {
        Err(Failure::Check(failures.join("\n")))
    }
}

fn table(results: &[Proved]) -> Table {
    let certifies = results.iter().any(|proved| proved.certificates.is_some());
    let mut header = vec![
        "scripts",
        "goals",
        "proved",
        "own/found",
        "longest s",
        "error of v, uV",
        "ulp",
        "error of duty, counts",
        "limited",
    ];
    if certifies {
        header.extend(["certificates", "checked by Coq", "longest s"]);
    }
    let columns = header.into_iter().map(|name| Column::number(name, ""));
    let names = ["motor", "controller", "result"].map(Column::text);
    let mut table = Table::new("", names.into_iter().chain(columns));
    for proved in results {
        let of = |quantity: &str| {
            proved
                .errors
                .iter()
                .find(|error| error.quantity == quantity)
        };
        let shown = |value: Option<f64>| {
            value.map_or_else(|| "-".to_owned(), |value| significant(value, 3))
        };
        let mut cells = vec![
            proved.motor.clone(),
            proved.controller.clone(),
            if proved.passed { "proved" } else { "UNPROVED" }.to_owned(),
            proved.scripts.to_string(),
            proved.goals.to_string(),
            proved.proved.to_string(),
            significant(proved.widest, 3),
            significant(proved.longest_s, 2),
            shown(of("voltage").map(|error| error.bound * 1e6)),
            shown(of("voltage").map(|error| error.bound_ulp)),
            shown(of("duty").map(|error| error.bound)),
            shown(of("duty").and_then(|error| error.limited)),
        ];
        if let Some(certificates) = proved.certificates {
            cells.extend([
                certificates.written.to_string(),
                certificates.checked.to_string(),
                significant(certificates.longest_s, 2),
            ]);
        }
        table.row(cells);
    }
    table
}
