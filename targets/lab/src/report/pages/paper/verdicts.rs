//! The paper's claims with measured figures and verdicts, and the two readings.

use crate::report::{Block, Cell, Column, Label, Table, Tone};
use crate::reproduction::{Claim, Finding, Method, Reading, Reproduction, Verdict};
use crate::text::{number, quantity, ripple};

/// A table of claims without rows.
fn table_of_claims() -> Table {
    let names = [
        "Claim of the paper",
        "Literal reading",
        "Corrected reading",
        "Verdict",
    ];
    Table::new("results claims", names.map(Column::text))
}

/// The claims with their verdicts, and the reasons.
pub fn summary(data: &Reproduction) -> Vec<Block> {
    let (claims, mut table) = (data.claims(), table_of_claims());
    for claim in &claims {
        table.row(verdict_row(claim));
    }
    let figures = "Figures are those of FCS-MPC / PDCC / PHCC / PI-PWM.".to_owned();
    let reasons = claims
        .iter()
        .map(|claim| format!("({}) {}", claim.letter, claim.reason()));
    let first = [Block::Note(figures), Block::Table(table)];
    first.into_iter().chain(reasons.map(Block::Prose)).collect()
}

/// The claims with their verdicts, reasons and statements.
pub fn claims(data: &Reproduction) -> Vec<Block> {
    let mut table = table_of_claims();
    for claim in &data.claims() {
        table.group(Label::None);
        table.row(verdict_row(claim));
        let summary = Cell::from(format!("{}.", claim.summary()));
        table.row([summary.across(4)]);
        for statement in &claim.statements {
            let findings = statement.findings.iter().map(finding_text);
            let cells = [statement.text.clone()].into_iter().chain(findings);
            table.row(cells.map(|text| Cell::from(text).toned(Tone::Muted)));
        }
    }
    let note = "Figures are those of FCS-MPC / PDCC / PHCC / PI-PWM, in this order; a dash is a drive that has lost its current without a trip. No statement is judged on \
                such a drive, or on one that tripped. A claim holds if each of its statements is true under every reading that can be judged, \
                does not hold if none is true, and else holds in part. Verdicts and reasons are computed from the figures.";
    vec![Block::Note(note.to_owned()), Block::Table(table)]
}

/// A claim with its figures and verdict.
fn verdict_row(claim: &Claim) -> [Cell; 4] {
    let verdict = claim.verdict();
    let tone = match verdict {
        Verdict::Holds => Tone::Good,
        Verdict::DoesNotHold => Tone::Missed,
        Verdict::InPart | Verdict::CannotBeJudged => Tone::None,
    };
    let [literal, corrected] = claim
        .figures
        .each_ref()
        .map(|text| text.replace("; ", "\n"));
    [
        Cell::from(format!("**({}) {}**", claim.letter, claim.text)),
        literal.into(),
        corrected.into(),
        Cell::from(format!("**{}**", verdict.text())).toned(tone),
    ]
}

fn finding_text(finding: &Finding) -> String {
    let outcome = match finding.outcome {
        Some(true) => "**true**",
        Some(false) => "**false**",
        None => "not judged",
    };
    format!("{outcome}: {}", finding.why)
}

/// The readings, and what cannot be implemented.
pub fn readings(data: &Reproduction) -> Vec<Block> {
    let mut table = Table::new(
        "results readings",
        ["Method", "Reading", "Drive", "Description"].map(Column::text),
    );
    for method in Method::ALL {
        table.group(Label::Beside(lettered(method).into()));
        for reading in Reading::ALL {
            let run = data.methods[method.index()].of(reading);
            let drive = Cell::from(format!("`{}`", run.variant));
            table.row([
                reading.name().into(),
                drive.detail(format!("\n{}", run.engine)),
                about(method, reading).into(),
            ]);
        }
    }
    let how = format!(
        "Every drive is generated fixed-point code, fed by the simulated motor through {}-bit ADCs and a Hall timer. The literal reading \
         uses the paper's equations and tables as printed, as far as a drive can; the corrected one applies the errata in the documentation \
         of the crate hexagen (hexagen::errata). The paper does not say what a modulator does beyond its limit: the literal reading scales \
         the voltage, the corrected one takes the nearest.",
        data.inverter.adc_bits
    );
    vec![Block::Prose(how), Block::Table(table)]
}

/// The drives that go beyond the paper, in rows of their own.
pub fn improvements(data: &Reproduction) -> Vec<Block> {
    let speeds = data.speeds_rpm.map(|rpm| format!("{} rpm", number(rpm, 0)));
    let of_speeds = speeds.iter().flat_map(|speed| {
        [
            Column::number("Mean, Nm", "").of(speed),
            Column::number("Ripple pp, %", "").of(speed),
        ]
    });
    let costs = [
        Column::number("Limit, %", "").of("Of rated speed"),
        Column::number("usual", "").of("Instructions"),
        Column::number("worst", "").of("Instructions"),
    ];
    let mut table = Table::new(
        "results improvements",
        [Column::text("Drive")]
            .into_iter()
            .chain(of_speeds)
            .chain(costs),
    );
    for improved in &data.improvements {
        let run = &improved.run;
        let figures = run.points.iter().flat_map(|point| {
            let figures = &point.figures;
            [
                number(figures.mean_torque_nm, 3),
                ripple(figures.ripple_pp_pct),
            ]
        });
        let rest = [
            number(run.limit.limit_pct, 0),
            number(run.usual_instructions().map(f64::from), 0),
            run.cost.worst.to_string(),
        ];
        let name = Cell::from(improved.about).detail(format!("\n`{}`", run.variant));
        let cells = figures.chain(rest).map(Cell::from);
        table.row([name].into_iter().chain(cells));
    }
    let how = format!(
        "What the paper does not have, on the same motor at {} demanded; no claim is judged by these drives.",
        quantity(data.torque, "Nm")
    );
    vec![Block::Prose(how), Block::Table(table)]
}

/// A method's name after its letter.
pub fn lettered(method: Method) -> String {
    format!("({}) {}", method.letter(), method.name())
}

fn about(method: Method, reading: Reading) -> &'static str {
    match (method, reading) {
        (Method::FcsMpc, Reading::Literal) => {
            "Predicts without the loop's delay of one period. Table 2's vectors, the off leg's diode ignored; the EMF of the last period is taken as unchanged."
        }
        (Method::FcsMpc, Reading::Corrected) => {
            "Predicts with the applied vector, the off leg clamped by its diode or floating (erratum of (15)); EMF from the motor's shape, as (5)."
        }
        (Method::Pdcc, Reading::Literal) => {
            "The paper's modulator, (14), (15) and the corrected (16), without which times turn negative; the voltage is scaled to what it reaches; the EMF of the last period is taken as unchanged."
        }
        (Method::Pdcc, Reading::Corrected) => {
            "Three legs are pulsed, since vectors of two pairs do not give the mean that (15) computes; at its limit the nearest voltage; EMF from the motor's shape, as (5)."
        }
        (Method::Phcc, Reading::Literal) => {
            "The printed row of sector 1, rotated through the sectors; the off leg's diode ignored; the EMF of the last period is taken as unchanged."
        }
        (Method::Phcc, Reading::Corrected) => {
            "Switching table derived from the vectors' geometry; EMF from the motor's shape, as (5)."
        }
        (Method::PiPwm, Reading::Literal) => {
            "800 Hz, integral time 0.5 ms (the paper states neither), no feed-forward of the EMF; the paper's modulator, as with PDCC."
        }
        (Method::PiPwm, Reading::Corrected) => {
            "The same controller; three legs are pulsed, at their limit the nearest voltage, as with PDCC."
        }
    }
}
