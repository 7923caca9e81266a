//! All results of one motor: its table, its proofs and the contents of the page.

use super::{
    Capture, DesignRow, ErrorsSeen, Own, PAPER_MOTOR, Planned, Results, SPEEDS, SpeedMark, Variant,
    Verification, design_table, held, links, own_row, rows_of,
};
use crate::accuracy::{WORDS, at_speeds, one_step, with_word};
use crate::engine::{EngineKind, PlantOptions, Prepared, SelectedMotor, stem};
use crate::envelope::TorqueBounds;
use crate::judgement::Judgement;
use crate::robustness::robustness;
use crate::text::{significant, without_place};
use crate::verification::{Checked, verify_drives};
use crate::{LabError, Progress};
use hexagen_codegen::spec::Envelope;
use hexagen_codegen::spec::{KINDS, RotorSensing};
use rayon::prelude::*;
use std::path::Path;

/// A motor with the rows of its table, before the runs.
#[derive(Debug)]
pub struct Plan {
    given: String,
    /// A board in place of the motor file's.
    on_board: PlantOptions,
    motor: SelectedMotor,
    /// The motor file's own drive, with its speed loop.
    whole: Prepared,
    /// What is measured of it: its current loop.
    own: Prepared,
    rows: Vec<Planned>,
    notes: Vec<String>,
    is_expected: bool,
}

impl Plan {
    /// Takes all variants of a motor file or of a library motor through the generator, on a board in
    /// place of the motor file's if one is given.
    ///
    /// # Errors
    /// No such motor or board, or diagnostics of its own controller.
    pub fn of(given: &str, board: Option<&str>) -> Result<Self, LabError> {
        let on_board = PlantOptions::on_board(board);
        let motor = SelectedMotor::find(given, &on_board)?;
        let whole = motor.prepare(None)?;
        let own = motor.without_speed_loop(whole.clone(), None)?;
        let is_paper = motor.source.name == PAPER_MOTOR;
        let mut notes = Vec::new();
        let planned = rows_of(&own.spec.inverter);
        let mut rows = plan(&motor, planned, [is_paper, false], &mut notes);
        rows.insert(0, of_file(&own));
        notes.extend(rows.iter().filter_map(limited));
        notes.extend(own.left_out.map(|_| NO_SPEED_LOOP.to_owned()));
        Ok(Self {
            given: given.to_owned(),
            on_board,
            motor,
            whole,
            own,
            rows,
            notes,
            is_expected: false,
        })
    }

    /// The variants of the design document's table on the paper's motor, beside the figures that are
    /// expected of them.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn of_paper() -> Result<Self, LabError> {
        let motor = SelectedMotor::find(PAPER_MOTOR, &PlantOptions::default())?;
        let own = motor.prepare_for_torque(None)?;
        let mut notes = Vec::new();
        let rows = plan(&motor, design_table(), [true, true], &mut notes);
        Ok(Self {
            given: PAPER_MOTOR.to_owned(),
            on_board: PlantOptions::default(),
            motor,
            whole: own.clone(),
            own,
            rows,
            notes,
            is_expected: true,
        })
    }

    /// Verifies and simulates every variant.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn run(mut self, progress: &dyn Progress) -> Result<(Results, Vec<Checked>), LabError> {
        let checked = self.verify(progress);
        let variants = self.simulate(progress)?;
        let errors = errors(&self.motor, &mut self.notes)?;
        let kinds = KINDS.map(|kind| kind.name.to_owned());
        let robustness = robustness(&self.given, &kinds, &self.on_board, progress)
            .map_err(|error| self.notes.push(format!("Robustness: {error}")))
            .ok();
        let data = Results {
            verification: Some(verification(&checked)),
            links: links(&self.motor, &self.whole.rust()),
            errors,
            robustness,
            ..self.results(variants)?
        };
        Ok((data, checked))
    }

    /// The table alone, without proofs and without what a page shows besides.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn table(self, progress: &dyn Progress) -> Result<Results, LabError> {
        let variants = self.simulate(progress)?;
        self.results(variants)
    }

    fn simulate(&self, progress: &dyn Progress) -> Result<Vec<Variant>, LabError> {
        progress.begin("simulating", self.rows.len() as u64);
        // Code and data sheet are those of the motor file's own controller.
        let shown = (!self.is_expected).then(|| own_row().label);
        let whole = &self.whole;
        let variants = self.rows.par_iter().map(|row| {
            let is_shown = shown == Some(row.row.label);
            let variant = row.run(is_shown.then_some(whole));
            progress.advance(1);
            variant
        });
        variants.collect()
    }

    fn results(self, variants: Vec<Variant>) -> Result<Results, LabError> {
        let own = &self.own;
        let judgement = (!self.is_expected)
            .then(|| Judgement::of(own))
            .transpose()?;
        Ok(Results {
            generator: format!("hexagen {}", env!("CARGO_PKG_VERSION")),
            name: own.spec.name.clone(),
            file: self.file(),
            board: self.motor.ast.board.as_ref().map(|of| of.name.text.clone()),
            motor: own.spec.motor.clone(),
            inverter: own.spec.inverter.clone(),
            source: source(own),
            torque: own.rated_torque(),
            current: own.rated_torque() / own.spec.torque_constant(),
            held: held(self.is_expected),
            speeds_rpm: SPEEDS.map(|part| part * own.rated_rpm()).to_vec(),
            verification: None,
            bounds: TorqueBounds::of(&Envelope::of(&own.spec), own.spec.motor.rated_speed),
            variants,
            own: judgement.map(|judgement| Own {
                variant: 0,
                judgement,
                times: own.generated.interface.times.clone(),
            }),
            links: Vec::new(),
            errors: Vec::new(),
            robustness: None,
            marks: if self.is_expected {
                paper_marks()
            } else {
                vec![]
            },
            notes: self.notes,
        })
    }

    /// The motor's name, with that of a board in place of the motor file's.
    fn file(&self) -> String {
        let motor = self.motor.source.name.clone();
        match &self.on_board.board {
            Some(board) => format!("{motor}-{}", stem(Path::new(board))),
            None => motor,
        }
    }

    /// Compares every drive of the table and the motor file's own, bit for bit.
    fn verify(&self, progress: &dyn Progress) -> Vec<Checked> {
        let rows = self.rows.iter().flat_map(|row| &row.drives);
        let rows = rows.map(|(_, drive)| drive);
        let whole = self.own.left_out.map(|_| &self.whole);
        let drives: Vec<Prepared> = rows.chain(whole).cloned().collect();
        verify_drives(&drives, VERIFY_STEPS, 1, progress)
    }
}

/// The motor file's own controller as a row.
fn of_file(own: &Prepared) -> Planned {
    let capture = match own.spec.inverter.rotor_sensing {
        RotorSensing::TimedHalls { .. } => Capture::Timer,
        RotorSensing::SampledHalls => Capture::Sampled,
        RotorSensing::Angle(_) => Capture::Angle,
    };
    Planned {
        row: own_row(),
        drives: vec![(capture, own.clone())],
        is_expected: false,
    }
}

/// A note for a row that is measured below the demand.
fn limited(row: &Planned) -> Option<String> {
    let (torque, rated) = (row.reach()?, row.best().rated_torque());
    Some(format!(
        "{}: max_current = {} A limits the torque to {} Nm with this reference, {:.0} % of the rated torque; the row and its limit are measured at that torque.",
        row.row.label,
        significant(row.best().spec.inverter.max_current, 3),
        significant(torque, 3),
        100.0 * torque / rated,
    ))
}

/// Steps of the bit-for-bit check per variant.
const VERIFY_STEPS: u64 = 1_000_000;

/// The rows of the table, each prepared with the captures that the motor's file allows; a variant
/// that cannot be generated is a note: the motor file's own controller stands even alone.
fn plan(
    motor: &SelectedMotor,
    rows: Vec<DesignRow>,
    [is_paper, is_expected]: [bool; 2],
    notes: &mut Vec<String>,
) -> Vec<Planned> {
    let mut planned = Vec::new();
    // Reasons for left-out rows and captures, with their rows; no capture stands for both.
    let mut left_out: Vec<(&str, String, Vec<&str>)> = Vec::new();
    let mut leave_out = |word, error: LabError, row| {
        let reason = without_place(&error.to_string()).to_owned();
        let mut alike = left_out.iter_mut();
        match alike.find(|left| left.0 == word && left.1 == reason) {
            Some((_, _, rows)) => rows.push(row),
            None => left_out.push((word, reason, vec![row])),
        }
    };
    let has_angle = motor.has_angle();
    for row in rows {
        // The paper's Euler discretisation suits its motor; the exact one suits all.
        let timer = if is_paper {
            row.variant.to_owned()
        } else {
            row.variant.replace("discretisation=euler,", "")
        };
        let made = if has_angle {
            let variant = timer.replace(",hall_capture=timer", "");
            let variant = variant.replace(":hall_capture=timer", "");
            vec![(Capture::Angle, "", variant)]
        } else {
            let sampled = timer.replace("hall_capture=timer", "hall_capture=sampled");
            vec![
                (Capture::Timer, "timer", timer),
                (Capture::Sampled, "sampled", sampled),
            ]
        };
        let made: Vec<_> = made
            .into_iter()
            .map(|(capture, word, variant)| {
                (capture, word, motor.prepare_for_torque(Some(&variant)))
            })
            .collect();
        let generates = made.iter().any(|(_, _, drive)| drive.is_ok());
        let mut drives = Vec::new();
        for (capture, word, drive) in made {
            match drive {
                Ok(drive) => drives.push((capture, drive)),
                Err(error) if generates => leave_out(word, error, row.label),
                // One reason suffices, that of the capture with fewer requirements.
                Err(error) if capture != Capture::Timer => leave_out("", error, row.label),
                Err(_) => {}
            }
        }
        if !drives.is_empty() {
            planned.push(Planned {
                row,
                drives,
                is_expected,
            });
        }
    }
    // What a board without an edge timer leaves out is told once, in the user's words.
    if !motor.has_edge_timer() && !has_angle {
        left_out.retain(|(word, ..)| *word != "timer");
        notes.push(NO_TIMER.to_owned());
    }
    notes.extend(left_out.into_iter().map(|(word, reason, rows)| {
        let rows = if rows.len() == planned.len() {
            "any row".to_owned()
        } else {
            rows.join("; ")
        };
        match word {
            "" => format!("No run of {rows}: {reason}"),
            word => format!("No run with `hall_capture={word}` of {rows}: {reason}"),
        }
    }));
    planned
}

/// What is left out of a drive with a speed loop.
const NO_SPEED_LOOP: &str = "The speed loop is left out of every row: all are measured at a torque that is set. Code and data sheet are those of \
     the whole drive.";

/// What a board without an edge timer has not.
const NO_TIMER: &str = "Every row sees Hall edges at samples alone, half a period late on the mean: the motor file has no \
     `hall_timer_clock`, so that no row is repeated with captured edges.";

/// Errors of single steps of every kind of controller at every word length; a refused word length
/// is a note.
fn errors(motor: &SelectedMotor, notes: &mut Vec<String>) -> Result<Vec<ErrorsSeen>, LabError> {
    let mut drives = vec![];
    for kind in KINDS.map(|kind| kind.name) {
        let made = WORDS.map(|word| {
            (
                word,
                motor.prepare_for_torque(with_word(kind, word).as_deref()),
            )
        });
        // A refused controller has a note of the table's rows already.
        if made.iter().all(|(_, drive)| drive.is_err()) {
            continue;
        }
        for (word, drive) in made {
            match drive {
                Ok(drive) => drives.push((word, drive)),
                Err(error) => notes.push(format!("{kind}, {word} bits: {error}")),
            }
        }
    }
    let seen = drives.par_iter().map(|(word, drive)| {
        let measured = at_speeds(drive, &PlantOptions::default())?;
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
    let bound = SpeedMark::new("bound at 20 A", 119.0);
    SpeedMark::of_paper().into_iter().chain([bound]).collect()
}

#[cfg(test)]
mod tests {
    use super::{NO_SPEED_LOOP, Plan, plan};
    use crate::engine::{PlantOptions, Prepared, SelectedMotor};
    use crate::results::unstated::stating;
    use crate::results::{Capture, PAPER_MOTOR, design_table};
    use hexagen_codegen::spec::apply_variant;

    fn paper_motor() -> SelectedMotor {
        SelectedMotor::find(PAPER_MOTOR, &PlantOptions::default()).expect("is in the library")
    }

    #[test]
    fn a_motor_without_edge_timer_has_all_rows_with_sampled_edges_and_the_reason() {
        let mut motor = paper_motor();
        let fields = &mut motor.ast.inverter.fields;
        fields.retain(|field| field.name != "hall_timer_clock");
        let mut notes = Vec::new();
        let planned = plan(&motor, design_table(), [false; 2], &mut notes);
        assert_eq!(planned.len(), design_table().len());
        for row in &planned {
            let captures: Vec<Capture> = row.drives.iter().map(|(capture, _)| *capture).collect();
            assert_eq!(captures, [Capture::Sampled], "{}", row.row.label);
        }
        let run = planned[0].run(None).expect("runs").runs;
        assert_eq!(run.len(), 2);
        assert_eq!(notes, [super::NO_TIMER]);
    }

    #[test]
    fn variants_of_a_drive_with_a_speed_loop_are_measured_at_the_demanded_torque() {
        let mut motor = paper_motor();
        let inertia = "inertia = \"2e-3 kg m2\"";
        motor.ast = stating(&motor.ast, "motor", inertia);
        let options = "speed_loop=on,speed_bandwidth=5Hz,acceleration_limit=500rpm/s";
        apply_variant(&mut motor.ast, &format!("pdcc:{options}")).expect("is a variant");
        let rows = plan(&motor, design_table(), [false; 2], &mut Vec::new());
        assert_eq!(rows.len(), design_table().len());
        for row in &rows {
            for (_, drive) in &row.drives {
                let (slow, demand) = (0.2 * drive.spec.motor.rated_speed, drive.demand());
                let measured = drive.measure_at(slow, demand).expect("runs");
                let torque = measured.figures.mean_torque_nm.expect("no trip");
                let name = &drive.variant;
                assert!((0.9..1.1).contains(&(torque / demand)), "{name}: {torque}");
            }
        }
    }

    #[test]
    fn a_drive_with_a_speed_loop_is_measured_without_and_shown_with_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("regulated.toml");
        let lines = [
            ("[motor]\n", "inertia = \"2e-3 kg m2\"\n"),
            ("[controller]\n", "speed_loop = \"on\"\n"),
        ];
        let text = lines
            .iter()
            .fold(paper_motor().source.text, |text, (head, line)| {
                text.replace(head, &format!("{head}{line}"))
            });
        std::fs::write(&file, text).expect("is written");
        let plan = Plan::of(file.to_str().expect("a path"), None).expect("rows");
        let regulates = |drive: &Prepared| drive.spec.controller.common().speed.is_some();
        assert!(regulates(&plan.whole));
        for (_, drive) in plan.rows.iter().flat_map(|row| &row.drives) {
            assert!(!regulates(drive), "{}", drive.variant);
        }
        assert!(plan.notes.iter().any(|note| note == NO_SPEED_LOOP));
        let shown = plan.rows[0].run(Some(&plan.whole)).expect("runs").generated;
        let sheet = shown.expect("is shown").data_sheet;
        assert!(sheet.contains("Speed loop"), "{sheet}");
    }

    #[test]
    fn variants_that_cannot_be_generated_are_left_out_with_the_reason() {
        let mut motor = paper_motor();
        motor.ast.motor.fields.clear();
        let mut notes = Vec::new();
        assert!(plan(&motor, design_table(), [false; 2], &mut notes).is_empty());
        let notes = notes.join("\n");
        assert!(notes.contains("`pole_pairs`"), "{notes}");
    }
}
