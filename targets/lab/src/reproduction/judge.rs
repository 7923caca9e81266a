//! Claims, their statements, and verdicts.

use super::data::Reading;

/// Finding of a reading on a statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Whether the statement is true; `None` if undecidable.
    pub outcome: Option<bool>,
    /// The figures that decide it.
    pub why: String,
}

/// One checkable part of a claim.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statement {
    /// The statement, in few words.
    pub text: String,
    /// Findings of the literal and of the corrected reading.
    pub findings: [Finding; 2],
}

/// A claim of the paper.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Claim {
    /// Its letter.
    pub letter: char,
    /// What the paper claims.
    pub text: String,
    /// Measured figures of the literal and of the corrected reading, separated by semicolons.
    pub figures: [String; 2],
    /// Its statements.
    pub statements: Vec<Statement>,
}

/// Verdict on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every statement is true under every reading with an outcome, and has at least one.
    Holds,
    /// Every statement that can be judged is false.
    DoesNotHold,
    /// Neither.
    InPart,
    /// No statement has an outcome.
    CannotBeJudged,
}

impl Verdict {
    /// Text for reports.
    pub fn text(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::DoesNotHold => "does not hold",
            Self::InPart => "holds in part",
            Self::CannotBeJudged => "cannot be judged",
        }
    }
}

impl Claim {
    /// The verdict over both readings.
    pub fn verdict(&self) -> Verdict {
        let outcomes = self
            .statements
            .iter()
            .flat_map(|statement| &statement.findings)
            .filter_map(|finding| finding.outcome);
        let (mut any_true, mut any_false) = (false, false);
        for outcome in outcomes {
            any_true |= outcome;
            any_false |= !outcome;
        }
        let is_told = |statement: &Statement| {
            let outcomes = &statement.findings;
            outcomes.iter().any(|finding| finding.outcome.is_some())
        };
        match (any_true, any_false) {
            (false, false) => Verdict::CannotBeJudged,
            (false, true) => Verdict::DoesNotHold,
            (true, false) if self.statements.iter().all(is_told) => Verdict::Holds,
            _ => Verdict::InPart,
        }
    }

    /// How many statements are true under each reading.
    pub fn summary(&self) -> String {
        let counts = Reading::ALL.map(|reading| {
            let outcomes = self.outcomes(reading);
            let judged = outcomes.iter().flatten().count();
            let true_ones = outcomes.iter().flatten().filter(|&&is| is).count();
            let rest = match outcomes.len() - judged {
                0 => String::new(),
                unknown => format!(", {unknown} not judged"),
            };
            format!(
                "{}: {true_ones} of {} true{rest}",
                reading.name(),
                outcomes.len()
            )
        });
        counts.join("; ")
    }

    /// The reason: the summary, and the false statements with their figures.
    pub fn reason(&self) -> String {
        let against: Vec<String> = self
            .statements
            .iter()
            .filter_map(|statement| {
                let false_ones: Vec<String> = Reading::ALL
                    .into_iter()
                    .zip(&statement.findings)
                    .filter(|(_, finding)| finding.outcome == Some(false))
                    .map(|(reading, finding)| format!("{}: {}", reading.name(), finding.why))
                    .collect();
                let is_any = !false_ones.is_empty();
                is_any.then(|| format!("{} ({})", statement.text, false_ones.join("; ")))
            })
            .collect();
        if against.is_empty() {
            self.summary()
        } else {
            format!("{}. False: {}", self.summary(), against.join(", "))
        }
    }

    fn outcomes(&self, reading: Reading) -> Vec<Option<bool>> {
        let place = reading as usize;
        let statements = self.statements.iter();
        statements
            .map(|statement| statement.findings[place].outcome)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn claim(outcomes: &[[Option<bool>; 2]]) -> Claim {
        let finding = |outcome| Finding {
            outcome,
            why: "w".to_owned(),
        };
        Claim {
            letter: 'x',
            text: String::new(),
            figures: [String::new(), String::new()],
            statements: outcomes
                .iter()
                .enumerate()
                .map(|(k, outcomes)| Statement {
                    text: format!("s{k}"),
                    findings: outcomes.map(finding),
                })
                .collect(),
        }
    }

    #[test]
    fn verdict_follows_from_all_findings() {
        let (yes, no) = (Some(true), Some(false));
        for (outcomes, verdict) in [
            (vec![[yes, yes], [yes, yes]], Verdict::Holds),
            (vec![[None, yes], [yes, None]], Verdict::Holds),
            (vec![[None, None], [yes, yes]], Verdict::InPart),
            (vec![[no, no], [no, None]], Verdict::DoesNotHold),
            (vec![[no, yes]], Verdict::InPart),
            (vec![[yes, yes], [no, no]], Verdict::InPart),
            (vec![[None, None]], Verdict::CannotBeJudged),
        ] {
            assert_eq!(claim(&outcomes).verdict(), verdict, "{outcomes:?}");
        }
    }

    #[test]
    fn reason_counts_statements_and_names_false_ones() {
        let (yes, no) = (Some(true), Some(false));
        let reason = claim(&[[yes, yes], [no, yes], [no, no], [None, no]]).reason();
        assert_eq!(
            reason,
            "literal: 1 of 4 true, 1 not judged; corrected: 2 of 4 true. \
             False: s1 (literal: w), s2 (literal: w; corrected: w), s3 (corrected: w)"
        );
        let reason = claim(&[[yes, None]]).reason();
        assert_eq!(
            reason,
            "literal: 1 of 1 true; corrected: 0 of 1 true, 1 not judged"
        );
    }
}
