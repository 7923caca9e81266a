//! The paper's claims with our figures and verdicts, and what the two readings are.

use crate::report::sections::variant_text;
use hexagen_lab::reproduction::{Claim, Finding, Method, Reading, Reproduction, Verdict};
use maud::{Markup, html};

/// The claims.
pub fn claims(data: &Reproduction) -> Markup {
    let claims = data.claims();
    html! {
        p.note {
            "Figures are those of FCS-MPC / PDCC / PHCC / PI-PWM, in this order; a dash stands for a drive that has lost its current, and what depends on it is not judged. "
            "A claim holds when each of its statements is true under every reading that can tell, does not hold when none is true, and else holds in part. "
            "Verdicts and reasons are computed from the figures."
        }
        div.scroll {
            table.results.claims {
                thead {
                    tr {
                        th { "Claim of the paper" } th { "Literal reading" } th { "Corrected reading" } th { "Verdict" }
                    }
                }
                @for claim in &claims { (claim_rows(claim)) }
            }
        }
    }
}

fn claim_rows(claim: &Claim) -> Markup {
    let verdict = claim.verdict();
    let [literal, corrected] = &claim.figures;
    html! {
        tbody {
            tr {
                th scope="rowgroup" { "(" (claim.letter) ") " (claim.text) }
                td { (lines(literal)) } td { (lines(corrected)) }
                td.verdict.good[verdict == Verdict::Holds].missed[verdict == Verdict::DoesNotHold] { (verdict.text()) }
            }
            tr {
                td.reason colspan="4" { (claim.summary()) "." }
            }
            @for statement in &claim.statements {
                tr.statement {
                    td { (statement.text) }
                    @for finding in &statement.findings { td { (finding_text(finding)) } }
                    td {}
                }
            }
        }
    }
}

fn finding_text(finding: &Finding) -> Markup {
    html! {
        @match finding.outcome {
            Some(true) => { span.good { "true" } }
            Some(false) => { span.false { "false" } }
            None => { span.muted { "not judged" } }
        }
        ": " (finding.why)
    }
}

/// Parts of figures, a line each.
fn lines(text: &str) -> Markup {
    html! {
        @for (index, part) in text.split("; ").enumerate() {
            @if index > 0 { br; }
            span.unbroken { (part) }
        }
    }
}

/// What the readings are, and what cannot be had.
pub fn readings(data: &Reproduction) -> Markup {
    html! {
        p {
            "Every drive is generated fixed-point code, fed by the simulated motor through "
            (data.inverter.adc_bits) "-bit converters and a Hall timer. The literal reading takes the paper's equations and tables as they are printed; "
            "the corrected one takes them with the errata that the documentation of the crate hexagen lists (hexagen::errata)."
        }
        div.scroll {
            table.results.readings {
                thead { tr { th { "Method" } th { "Reading" } th { "Drive" } th { "What it is" } } }
                @for method in Method::ALL {
                    tbody {
                        @for reading in Reading::ALL {
                            @let run = data.methods[method.index()].of(reading);
                            tr {
                                @if reading == Reading::Literal {
                                    th scope="rowgroup" rowspan="2" { "(" (method.letter()) ") " (method.name()) }
                                }
                                td { (reading.name()) }
                                td { (variant_text(&run.variant)) br; span.muted { (run.engine) } }
                                td { (about(method, reading)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn about(method: Method, reading: Reading) -> &'static str {
    match (method, reading) {
        (Method::FcsMpc, Reading::Literal) => {
            "Predicts as if its command took effect at once; the loop has a period of delay. Table 2's vectors whatever the off leg does; EMF from the last period."
        }
        (Method::FcsMpc, Reading::Corrected) => {
            "Predicts with the applied vector, the off leg clamped by its diode or floating; EMF from the motor's shape."
        }
        (Method::Pdcc, Reading::Literal) => {
            "Voltage scaled to the hexagon; EMF from the last period. The paper's own modulation over neighbouring pair vectors, (15), cannot be had from compare values with one state per leg and period: all three legs are pulsed."
        }
        (Method::Pdcc, Reading::Corrected) => {
            "Keeps the component along the EMF at the limit of voltage, commutates two periods ahead; EMF from the motor's shape."
        }
        (Method::Phcc, Reading::Literal) => {
            "The printed row of sector 1, turned through the sectors; EMF from the last period."
        }
        (Method::Phcc, Reading::Corrected) => {
            "Switching table derived from the vectors' geometry; EMF from the motor's shape."
        }
        (Method::PiPwm, Reading::Literal) => {
            "800 Hz, integral time 0.5 ms, no EMF feed-forward. (15) cannot be had, as with PDCC: all three legs are pulsed."
        }
        (Method::PiPwm, Reading::Corrected) => {
            "1 kHz, integral time L/R, feed-forward of the motor's EMF."
        }
    }
}
