//! `hexagen explain`: cause, example and remedy of a diagnostic.

use crate::cli::{Failure, paragraph, print_json, print_text, wrapped_row};
use clap::Args;
use hexagen_codegen::diagnostics::Code;
use serde::Serialize;

/// Options of `explain`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Code of an error or warning, such as HX0302 [default: the list of all]
    #[arg(value_name = "CODE")]
    pub code: Option<String>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

#[derive(Serialize)]
struct Told {
    code: String,
    is_warning: bool,
    cause: &'static str,
    wrong: &'static str,
    right: &'static str,
    remedy: &'static str,
}

impl Told {
    fn of(code: Code) -> Self {
        let told = code.explanation();
        Self {
            code: code.to_string(),
            is_warning: code.is_warning(),
            cause: told.cause,
            wrong: told.wrong,
            right: told.right,
            remedy: told.remedy,
        }
    }

    fn print(&self) -> Result<(), Failure> {
        let lines = |text: &str| match text {
            "" => "    (left out)".to_owned(),
            text => {
                let lines: Vec<String> = text.lines().map(|line| format!("    {line}")).collect();
                lines.join("\n")
            }
        };
        let severity = if self.is_warning { "warning" } else { "error" };
        print_text(&format!(
            "{} ({severity})\n{}\n\nWrong:\n{}\n\nRight:\n{}\n\n{}",
            self.code,
            paragraph(self.cause),
            lines(self.wrong),
            lines(self.right),
            paragraph(self.remedy)
        ))
    }
}

/// Runs the command.
///
/// # Errors
/// A code that there is not.
pub fn run(options: &Options) -> Result<(), Failure> {
    let Some(given) = &options.code else {
        return list(options.json);
    };
    let code = Code::from_text(given).ok_or_else(|| {
        Failure::Argument(format!(
            "no code `{given}`; codes stand in the brackets of a message, as in error[HX0302], and `hexagen explain` lists all"
        ))
    })?;
    let told = Told::of(code);
    if options.json {
        print_json(&told)
    } else {
        told.print()
    }
}

fn list(json: bool) -> Result<(), Failure> {
    let all: Vec<Told> = Code::ALL.iter().map(|code| Told::of(*code)).collect();
    if json {
        #[derive(Serialize)]
        struct List {
            codes: Vec<Told>,
        }
        return print_json(&List { codes: all });
    }
    let lines: Vec<String> = all
        .iter()
        .map(|told| wrapped_row(&format!("{:<12}{}", told.code, told.cause)))
        .collect();
    print_text(&lines.join("\n"))
}
