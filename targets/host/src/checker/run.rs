//! One run of Gappa and its output.

use super::program::run_within;
use hexagen_codegen::emit::gappa::Script;
use hexagen_codegen::ir::Real;
use std::collections::BTreeMap;
use std::fmt;
use std::process::Command;
use std::time::Duration;

/// Least and greatest value.
pub(super) type Bounds = [f64; 2];

/// Gappa could not be started.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "cannot run `gappa` ({0}): install it, `apt install gappa` on Debian and Ubuntu, or https://gappa.gitlabpages.inria.fr"
)]
pub struct Missing(String);

impl Missing {
    /// What the system said.
    pub(super) fn of(error: &std::io::Error) -> Self {
        Self(error.to_string())
    }
}

/// Version of the checker.
///
/// # Errors
/// When there is none.
pub fn gappa_version() -> Result<String, Missing> {
    let output = Command::new("gappa").arg("--version").output();
    let output = output.map_err(|error| Missing::of(&error))?;
    let text = [output.stdout, output.stderr].concat();
    Ok(String::from_utf8_lossy(&text).trim().to_owned())
}

/// The checker. By default it ignores a bound less than 1 % tighter than a known one; the goals are
/// the generator's bounds to the last digit.
pub(super) fn gappa() -> Command {
    let mut command = Command::new("gappa");
    command.arg("-Echange-threshold=0.0001");
    command
}

/// Result of goals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Finding {
    /// All hold.
    Proved,
    /// Some could not be proved.
    Refused(String),
    /// It did not end.
    TooLong(Duration),
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Proved => write!(f, "proved"),
            Self::Refused(text) => write!(f, "{text}"),
            Self::TooLong(limit) => write!(f, "not proved in {} s", limit.as_secs()),
        }
    }
}

/// A run that has ended.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) finding: Finding,
    pub(super) took: Duration,
    said: String,
}

impl Run {
    /// Checks a script within a time limit.
    pub(super) fn new(script: &str, limit: Duration) -> Result<Self, Missing> {
        let ended = run_within(&mut gappa(), script, limit).map_err(|error| Missing::of(&error))?;
        let finding = match ended.status {
            None => Finding::TooLong(limit),
            Some(status) if status.success() => Finding::Proved,
            Some(_) => Finding::Refused(ended.reason()),
        };
        Ok(Self {
            finding,
            took: ended.took,
            said: ended.said,
        })
    }

    /// The bounds of all goals of the script, in order.
    pub(super) fn bounds(&self, script: &Script) -> Result<Vec<[Real; 2]>, String> {
        if self.finding != Finding::Proved {
            return Err(format!("no bounds found: {}", self.finding));
        }
        let mut found = BTreeMap::new();
        for line in self.said.lines() {
            if let Some((expression, range)) = line.trim().split_once(" in [")
                && let Some(bounds) = ends(range)
            {
                found.insert(expression.to_owned(), bounds);
            }
        }
        // Two definitions of the same expression get one name.
        let renamed: BTreeMap<&str, &str> = self.said.lines().filter_map(renaming).collect();
        let asked = script.goals.iter().map(|goal| {
            let words = goal.expression.split(' ');
            let words = words.map(|word| *renamed.get(word).unwrap_or(&word));
            words.collect::<Vec<_>>().join(" ")
        });
        let asked: Vec<String> = asked.collect();
        let read: Vec<[Real; 2]> = asked
            .iter()
            .filter_map(|goal| found.get(goal).copied())
            .collect();
        if read.len() == asked.len() {
            Ok(read)
        } else {
            Err(format!(
                "{} bounds read of {} asked",
                read.len(),
                asked.len()
            ))
        }
    }
}

/// Old and new name of `Warning: renaming identifier 'a' as 'b' at …`.
fn renaming(line: &str) -> Option<(&str, &str)> {
    let rest = line.strip_prefix("Warning: renaming identifier '")?;
    let (old, rest) = rest.split_once("' as '")?;
    Some((old, rest.split_once('\'')?.0))
}

/// Both ends of `-3b-1 {-1.5, -2^(0.58)}, 4 {4, 2^(2)}]`; braces repeat the number.
fn ends(range: &str) -> Option<[Real; 2]> {
    let mut text = String::new();
    let mut inside = false;
    for letter in range.trim_end_matches(']').chars() {
        match letter {
            '{' => inside = true,
            '}' => inside = false,
            _ if !inside => text.push(letter),
            _ => {}
        }
    }
    let (low, high) = text.split_once(',')?;
    Some([number(low.trim())?, number(high.trim())?])
}

/// `-123b-4` or `567`, with its value in braces behind it.
fn number(text: &str) -> Option<Real> {
    let text = text.split(' ').next()?;
    let (mantissa, exponent) = text.split_once('b').unwrap_or((text, "0"));
    Some(Real {
        mantissa: mantissa.parse().ok()?,
        exponent: exponent.parse().ok()?,
    })
}
