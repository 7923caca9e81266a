//! `hexagen report`: the result table and the page of one motor.

use crate::cli::{Bar, Failure, TextTable, print_text};
use crate::report;
use clap::Args;
use hexagen_lab::closed_loop::Side;
use hexagen_lab::engine::Model;
use hexagen_lab::results::{
    Capture, Judged, PAPER_MOTOR, Plan, Results, Run, Variant, judge_limit, judge_mean, judge_pp,
    judge_rms,
};
use hexagen_lab::text::significant;
use std::path::PathBuf;

/// Where the page goes.
pub(super) const FOLDER: &str = "target/hexagen";

/// Options of `report`.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
    /// Motor file, or name of a library motor [default: the 660 W motor of the paper]
    #[arg(value_name = "MOTOR")]
    pub motor: Option<String>,
    /// Folder of the page [default: target/hexagen]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// No such motor, diagnostics, or a page that cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    let folder = options.out.clone().unwrap_or_else(|| PathBuf::from(FOLDER));
    let plan = Plan::of(options.motor.as_deref().unwrap_or(PAPER_MOTOR))?;
    // A folder that cannot be written into is told before the long work.
    report::prepare_folder(&folder)?;
    let (data, checked) = plan.run(&Bar::default())?;
    let motor = &data.motor;
    print_text(&format!(
        "{}: {} Nm, {} V bus, Ts {} us, {}-bit ADC",
        motor.description,
        significant(data.torque, 3),
        significant(data.inverter.v_bus, 3),
        significant(data.inverter.t_s * 1e6, 3),
        data.inverter.adc_bits
    ))?;
    print_text(&table(&data))?;
    for note in &data.notes {
        print_text(&format!("- {note}"))?;
    }
    if let Some(verification) = &data.verification {
        print_text(&format!(
            "Bit for bit: {} steps of {} drives, engine: {}, {} differ.",
            verification.steps,
            checked.len(),
            verification.engine,
            verification.mismatches
        ))?;
    }
    let page = report::write(&data, &folder)?;
    print_text(&format!("Page: {}", page.display()))?;
    let different: Vec<String> = checked
        .iter()
        .filter_map(|drive| {
            let mismatch = drive.mismatch.as_ref()?;
            Some(format!("{}, {}: {mismatch}", drive.motor, drive.controller))
        })
        .collect();
    if different.is_empty() {
        Ok(())
    } else {
        Err(Failure::Check(different.join("\n")))
    }
}

/// The result table: measured figures, `*` where the design document expects another one.
fn table(data: &Results) -> String {
    let mut header = vec!["variant".to_owned(), "Hall".to_owned(), "model".to_owned()];
    for rpm in &data.speeds_rpm {
        header.push(format!("{rpm:.0} rpm: Nm"));
        header.extend(["pp %".to_owned(), "rms %".to_owned()]);
    }
    header.push("limit %".to_owned());
    let mut table = TextTable::new(3, header);
    for variant in &data.variants {
        for run in &variant.runs {
            table.row(row(variant, run));
        }
    }
    let expects = data
        .variants
        .iter()
        .any(|variant| variant.runs.iter().any(|run| run.expected.is_some()));
    let mut text = table.render();
    if expects {
        text.push_str("\n* expected otherwise, see below; (value expected)");
    }
    text
}

fn row(variant: &Variant, run: &Run) -> Vec<String> {
    let label = variant.label.clone();
    let capture = match run.capture {
        Capture::Timer => "timer",
        Capture::Sampled => "sampled",
    };
    let model = match run.model {
        Model::Fixed => "fixed",
        Model::BitTrue => "bit-true",
        Model::Ideal => "ideal",
    };
    let mut cells = vec![label, capture.to_owned(), model.to_owned()];
    for point in &run.points {
        let expected = run
            .expected
            .as_ref()
            .and_then(|expected| expected.at(point.rpm.round()));
        let mean = judge_mean(&point.figures, expected);
        cells.push(match point.tripped {
            None => figure(&mean, 3, "-"),
            Some(_) => figure(&mean, 3, "trips"),
        });
        cells.push(figure(&judge_pp(&point.figures, expected), 2, "-"));
        cells.push(figure(&judge_rms(&point.figures, expected), 3, "-"));
    }
    let limit = run.limit.as_ref();
    let found = figure(&judge_limit(limit, run.expected.as_ref()), 1, "never");
    cells.push(match limit.and_then(|limit| limit.lost) {
        Some(Side::Above) => format!("{found}, torque above"),
        Some(Side::Below) | None => found,
    });
    cells
}

/// A figure with so many decimals, or what stands for `none`; what was expected stands in brackets
/// where it was not met.
fn figure(judged: &Judged, decimals: usize, none: &str) -> String {
    let measured = judged
        .measured
        .map_or_else(|| none.to_owned(), |x| format!("{x:.decimals$}"));
    match judged.expected {
        Some(expected) if !judged.met => {
            let expected = expected.text("-", |x| x.to_string());
            format!("{measured} * ({expected})")
        }
        _ => measured,
    }
}
