//! `hexagen report`: the result table and the page of one motor.

use super::accuracy::one_step;
use super::compare::{WORDS, at_speeds, with_word};
use super::results::{Planned, SPEEDS, held};
use super::robustness;
use super::verify::{self, Checked};
use crate::cli::{Failure, PlantArguments, SelectedMotor, TextTable, bar, print_text, significant};
use crate::report::{
    self, Capture, ErrorsSeen, Judged, Model, ReportData, Run, SpeedMark, Variant, Verification,
    design_table, judge_limit, judge_mean, judge_pp, judge_rms,
};
use clap::Args;
use hexagen_codegen::spec::KINDS;
use hexagen_lab::closed_loop::Side;
use hexagen_lab::engine::{EngineKind, Prepared};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// The motor of the paper.
pub(super) const PAPER_MOTOR: &str = "trivedi-keshri-660w";

/// Where the page goes.
pub(super) const FOLDER: &str = "target/hexagen";

/// Steps of the bit-for-bit check per variant.
const VERIFY_STEPS: u64 = 1_000_000;

/// The row whose code and data sheet are shown: the best of three pulsed legs.
const SHOWN: &str = "PDCC three_phase, torque_priority, advance 2, model EMF";

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

/// Everything the report shows. A folder that the page is meant for is tried before the long work.
///
/// # Errors
/// No such motor, diagnostics of its own controller or of all variants, or a folder that cannot be
/// written into.
pub fn collect(
    options: &Options,
    folder: Option<&Path>,
) -> Result<(ReportData, Vec<Checked>), Failure> {
    let given = options.motor.as_deref().unwrap_or(PAPER_MOTOR);
    let motor = SelectedMotor::find(given, &PlantArguments::default())?;
    let own = motor.prepare_for_torque(None)?;
    let is_paper = motor.source.name == PAPER_MOTOR;
    let mut notes = Vec::new();
    let planned = plan(&motor, is_paper, &mut notes)?;
    if let Some(folder) = folder {
        report::prepare_folder(folder)?;
    }
    if is_paper {
        notes.extend(PAPER_NOTES.map(str::to_owned));
    }

    notes.extend(planned.iter().filter_map(|row| {
        let (torque, rated) = (row.reach()?, row.best().rated_torque());
        Some(format!(
            "{}: its set-point is limited to max_current = {} A, which gives {} Nm with this reference, {:.0} % of the demand; it is measured at that torque, its limit, too.",
            row.row.label,
            significant(row.best().spec.inverter.max_current, 3),
            significant(torque, 3),
            100.0 * torque / rated,
        ))
    }));

    let drives: Vec<Prepared> = planned
        .iter()
        .flat_map(|row| row.drives.iter().map(|(_, drive)| drive.clone()))
        .chain([own.clone()])
        .collect();
    let progress = bar(VERIFY_STEPS * drives.len() as u64, "comparing bit for bit");
    let checked = verify::collect(&drives, VERIFY_STEPS, 1, &progress);
    progress.finish_and_clear();

    let progress = bar(planned.len() as u64, "simulating");
    let variants = planned
        .par_iter()
        .map(|row| {
            let variant = row.run(row.row.label == SHOWN);
            progress.inc(1);
            variant
        })
        .collect::<Result<Vec<_>, _>>();
    progress.finish_and_clear();
    let variants = variants?;

    let errors = errors(&motor, &mut notes)?;
    let kinds = KINDS.map(|kind| kind.name.to_owned());
    let as_given = PlantArguments::default();
    let robustness = robustness::collect(given, &kinds, &as_given)
        .map_err(|failure| notes.push(format!("Robustness: {failure}")))
        .ok();

    let data = ReportData {
        generator: format!("hexagen {}", env!("CARGO_PKG_VERSION")),
        name: own.spec.name.clone(),
        file: motor.source.name.clone(),
        motor: own.spec.motor.clone(),
        inverter: own.spec.inverter.clone(),
        source: source(&own),
        torque: own.rated_torque(),
        current: own.rated_torque() / own.spec.torque_constant(),
        held: held(is_paper),
        speeds_rpm: SPEEDS.map(|part| part * own.rated_rpm()).to_vec(),
        verification: Some(verification(&checked)),
        variants,
        errors,
        robustness,
        marks: if is_paper { paper_marks() } else { vec![] },
        notes,
    };
    Ok((data, checked))
}

/// The rows of the table, each prepared with the captures that the motor's file allows; what does
/// not generate is a note.
///
/// # Errors
/// When nothing generates: all reasons.
fn plan(
    motor: &SelectedMotor,
    is_paper: bool,
    notes: &mut Vec<String>,
) -> Result<Vec<Planned>, Failure> {
    let (mut planned, mut refused) = (Vec::new(), Vec::new());
    // Reasons why a capture is left out, and the rows that they are about.
    let mut left_out: Vec<(&str, String, Vec<&str>)> = Vec::new();
    for row in design_table() {
        // The paper's Euler steps suit its motor; the exact discretisation suits all.
        let timer = if is_paper {
            row.variant.to_owned()
        } else {
            row.variant.replace("discretisation=euler,", "")
        };
        let sampled = timer.replace("hall_capture=timer", "hall_capture=sampled");
        let made = [
            (Capture::Timer, "timer", timer),
            (Capture::Sampled, "sampled", sampled),
        ]
        .map(|(capture, word, variant)| (capture, word, motor.prepare(Some(&variant))));
        let generates = made.iter().any(|(_, _, drive)| drive.is_ok());
        let mut drives = Vec::new();
        for (capture, word, drive) in made {
            match drive {
                Ok(drive) => drives.push((capture, drive)),
                Err(failure) if generates => {
                    let reason = without_place(&failure.to_string());
                    match left_out
                        .iter_mut()
                        .find(|left| left.0 == word && left.1 == reason)
                    {
                        Some((_, _, rows)) => rows.push(row.label),
                        None => left_out.push((word, reason, vec![row.label])),
                    }
                }
                // One reason suffices, of the capture that asks for less.
                Err(failure) if capture == Capture::Sampled => {
                    refused.push(format!("{}: {failure}", row.label));
                }
                Err(_) => {}
            }
        }
        if !drives.is_empty() {
            planned.push(Planned {
                row,
                drives,
                is_expected: is_paper,
            });
        }
    }
    if planned.is_empty() {
        return Err(Failure::Specification(refused.join("\n")));
    }
    notes.extend(refused);
    notes.extend(left_out.into_iter().map(|(word, reason, rows)| {
        let rows = if rows.len() == planned.len() {
            "any row".to_owned()
        } else {
            rows.join("; ")
        };
        format!("No run with `hall_capture={word}` of {rows}: {reason}")
    }));
    Ok(planned)
}

/// A diagnostic without the variant that it is about and its column.
fn without_place(diagnostic: &str) -> String {
    match diagnostic.find("error[") {
        Some(start) => diagnostic[start..].to_owned(),
        None => diagnostic.to_owned(),
    }
}

/// Errors of single steps of every kind of controller at every word length; a word length that is refused is a note.
fn errors(motor: &SelectedMotor, notes: &mut Vec<String>) -> Result<Vec<ErrorsSeen>, Failure> {
    let mut drives = vec![];
    for kind in KINDS.map(|kind| kind.name) {
        let made = WORDS.map(|word| (word, motor.prepare(with_word(kind, word).as_deref())));
        // Why a controller is refused altogether, the rows of the table have said.
        if made.iter().all(|(_, drive)| drive.is_err()) {
            continue;
        }
        for (word, drive) in made {
            match drive {
                Ok(drive) => drives.push((word, drive)),
                Err(failure) => notes.push(format!("{kind}, {word} bits: {failure}")),
            }
        }
    }
    let seen = drives.par_iter().map(|(word, drive)| {
        let measured = at_speeds(drive, &PlantArguments::default())?;
        let (one_step, counts) = one_step(drive, measured.iter().map(|(_, both)| both));
        Ok(ErrorsSeen {
            controller: without_word(&drive.variant, *word),
            word: *word,
            snr_db: one_step.snr_db,
            largest_v: one_step.largest_v,
            bound_v: one_step.bound_v,
            decisions_equal_pct: one_step.decisions_equal_pct,
            counts,
        })
    });
    seen.collect()
}

/// A variant without its word length, which is its last option.
fn without_word(variant: &str, word: u32) -> String {
    let option = format!("word={word}");
    let kept = variant.strip_suffix(&option).unwrap_or(variant);
    kept.trim_end_matches([',', ':']).to_owned()
}

fn verification(checked: &[Checked]) -> Verification {
    let compiled = checked
        .iter()
        .all(|drive| drive.engine == EngineKind::Compiled);
    Verification {
        engine: if compiled { "compiled" } else { "interpreted" }.to_owned(),
        steps: checked.iter().map(|drive| drive.steps).sum(),
        mismatches: checked.iter().filter(|drive| !drive.passed).count() as u64,
    }
}

fn source(drive: &Prepared) -> Option<String> {
    let parts: Vec<String> = drive
        .source
        .iter()
        .map(|(_, text)| format!("{}.", text.trim().trim_end_matches('.')))
        .collect();
    (!parts.is_empty()).then(|| parts.join(" "))
}

/// The paper's claims and the bound of any controller, in percent of rated speed.
fn paper_marks() -> Vec<SpeedMark> {
    let mark = |label: &str, percent| SpeedMark {
        label: label.to_owned(),
        percent,
    };
    vec![
        mark("PI-PWM (paper)", 67.0),
        mark("predictive (paper)", 85.0),
        mark("PDCC (paper)", 87.0),
        mark("bound at 20 A", 119.0),
    ]
}

/// What is known about differences from the design document's table.
const PAPER_NOTES: [&str; 5] = [
    "Pair, torque_priority: the expected ripple is that of the nominal reckoning, which takes a pair's vector for \
     Table 2's whatever the third leg does. What runs here reckons with the leg as it is, clamped by its diode or \
     floating, and has less.",
    "Estimated EMF: the expected figures are those of an estimate that takes the last period's EMF for that of the \
     target, two periods late. Here the motor's shape moves the estimate on, which leaves less ripple and a higher limit.",
    "FCS-MPC, nominal (literal): the expected figures lie between two readings. With the delay predicted, as here, \
     the torque is lost as well, from the limit on and at less ripple; with the delay left out of the prediction the \
     ripple is larger than expected (`hexagen reproduce` shows that reading).",
    "PI-PWM three_phase: the expected figures are those of the paper's modulation over neighbouring pair vectors \
     (`modulation=table2`), which one state per leg and period cannot give. Three pulsed legs hold the torque to higher speeds.",
    "PI-PWM six_step: the expected mean and ripple are those of a regulator that holds the largest of the three currents, \
     (|ia| + |ib| + |ic|)/2. Here it holds the mean of the conducting pair's, which sees the incoming phase from the \
     first period of a commutation on (`cargo test -p hexagen-lab --test plant_six_step` runs both; neither has the expected limit).",
];

/// Runs the command.
///
/// # Errors
/// As [`collect`], or a page that cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    let folder = options.out.clone().unwrap_or_else(|| PathBuf::from(FOLDER));
    let (data, checked) = collect(options, Some(&folder))?;
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
fn table(data: &ReportData) -> String {
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

#[cfg(test)]
mod tests {
    use super::{Capture, PAPER_MOTOR, PlantArguments, SelectedMotor, plan};
    use crate::report::design_table;

    fn paper_motor() -> SelectedMotor {
        SelectedMotor::find(PAPER_MOTOR, &PlantArguments::default()).expect("is in the library")
    }

    #[test]
    fn a_motor_without_edge_timer_has_all_rows_with_sampled_edges_and_the_reason() {
        let mut motor = paper_motor();
        let fields = &mut motor.ast.inverter.fields;
        fields.retain(|field| field.name != "hall_timer_clock");
        let mut notes = Vec::new();
        let planned = plan(&motor, false, &mut notes).expect("rows");
        assert_eq!(planned.len(), design_table().len());
        for row in &planned {
            let captures: Vec<Capture> = row.drives.iter().map(|(capture, _)| *capture).collect();
            assert_eq!(captures, [Capture::Sampled], "{}", row.row.label);
        }
        let run = planned[0].run(false).expect("runs").runs;
        assert_eq!(run.len(), 2);
        assert_eq!(
            notes,
            [
                "No run with `hall_capture=timer` of any row: error[HX0111]: `hall_capture: timer` needs the field `hall_timer_clock`; add it, for example `hall_timer_clock: 1 MHz`"
            ]
        );
    }

    #[test]
    fn a_motor_that_nothing_generates_for_is_an_error_and_no_empty_page() {
        let mut motor = paper_motor();
        motor.ast.motor.fields.clear();
        let failure = plan(&motor, false, &mut Vec::new()).expect_err("no rows");
        assert!(failure.to_string().contains("`pole_pairs`"), "{failure}");
    }
}
