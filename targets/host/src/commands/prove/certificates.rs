//! Coq proofs: one file per script, checked if Coq is installed.

use crate::checker::{certificate, check_certificate};
use crate::cli::{Failure, write_file};
use hexagen_codegen::emit::gappa::Script;
use hexagen_lab::engine::Prepared;
use serde::Serialize;
use std::path::Path;
use std::time::Duration;

/// Coq proofs of one drive.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Certificates {
    /// Files, one per script.
    pub written: usize,
    /// Files that Coq has accepted and that add no axioms.
    pub checked: usize,
    /// Time of the longest check, seconds.
    pub longest_s: f64,
}

impl Certificates {
    /// Totals of a drive's scripts.
    pub(super) fn of<'a>(certified: impl Iterator<Item = &'a Certified>) -> Self {
        let mut all = Self {
            written: 0,
            checked: 0,
            longest_s: 0.0,
        };
        for one in certified {
            all.written += usize::from(!matches!(one, Certified::Missing(_)));
            if let Certified::Checked(took) = one {
                all.checked += 1;
                all.longest_s = all.longest_s.max(took.as_secs_f64());
            }
        }
        all
    }
}

/// Options for certificates.
#[derive(Clone, Copy, Debug)]
pub struct Certify<'a> {
    /// Their folder.
    pub folder: &'a Path,
    /// Whether Coq can check them.
    pub checks: bool,
}

/// Result of a script's certificate.
#[derive(Clone, Debug)]
pub(super) enum Certified {
    /// No certificate, with the reason.
    Missing(String),
    /// Not checked.
    Written,
    /// Accepted, with the time of the check.
    Checked(Duration),
    /// Refused, with the reason.
    Refused(String),
}

impl Certified {
    /// The failure, if any.
    pub(super) fn failure(&self, script: &str) -> Option<String> {
        match self {
            Self::Missing(reason) | Self::Refused(reason) => Some(format!("{script}: {reason}")),
            Self::Written | Self::Checked(_) => None,
        }
    }
}

impl Certify<'_> {
    /// Writes a script's certificate and has it checked.
    pub(super) fn script(self, drive: &Prepared, script: &Script) -> Result<Certified, Failure> {
        let text = match certificate(script) {
            Ok(text) => text,
            Err(reason) => return Ok(Certified::Missing(reason)),
        };
        let path = [&drive.motor, &drive.variant, &script.name].map(|name| file_name(name));
        let path = self.folder.join(path.join("/")).with_extension("v");
        write_file(&path, text.as_bytes())?;
        Ok(match self.checks.then(|| check_certificate(&text)) {
            None => Certified::Written,
            Some(Ok(took)) => Certified::Checked(took),
            Some(Err(reason)) => Certified::Refused(reason),
        })
    }
}

/// A name that is valid for a Coq module.
fn file_name(name: &str) -> String {
    name.replace(|letter: char| !letter.is_ascii_alphanumeric(), "_")
}
