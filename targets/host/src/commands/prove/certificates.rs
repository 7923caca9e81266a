//! Proofs for Coq: one file a script, checked where there is a Coq.

use crate::checker::{certificate, check_certificate};
use crate::cli::{Failure, write_file};
use hexagen_codegen::emit::gappa::Script;
use hexagen_lab::engine::Prepared;
use serde::Serialize;
use std::path::Path;
use std::time::Duration;

/// Proofs of one drive for Coq.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Certificates {
    /// Files, one a script.
    pub written: usize,
    /// Of these, files that Coq has checked to the end and that assume nothing of their own.
    pub checked: usize,
    /// Time of the longest check, seconds.
    pub longest_s: f64,
}

impl Certificates {
    /// What came of a drive's scripts.
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

/// What to do about certificates.
#[derive(Clone, Copy, Debug)]
pub struct Certify<'a> {
    /// Where they go.
    pub folder: &'a Path,
    /// Whether there is a Coq that can check them.
    pub checks: bool,
}

/// What came of a script's certificate.
#[derive(Clone, Debug)]
pub(super) enum Certified {
    /// There is none, and why.
    Missing(String),
    /// Nobody checked it.
    Written,
    /// It holds; how long the check took.
    Checked(Duration),
    /// It does not, and why.
    Refused(String),
}

impl Certified {
    /// What is not as it should be.
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

/// A name of which Coq can make one of a module.
fn file_name(name: &str) -> String {
    name.replace(|letter: char| !letter.is_ascii_alphanumeric(), "_")
}
