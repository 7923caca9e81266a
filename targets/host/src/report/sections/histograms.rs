//! Errors of single steps against their proven bounds, per controller and word length.

use super::{field, figure, legend, number, swatch, variant_text};
use crate::report::ReportError;
use crate::report::plot::{Histogram, histogram, palette};
use hexagen_codegen::diagnostics::engineering;
use hexagen_lab::results::{ErrorsSeen, Results};
use maud::{Markup, html};

/// A plot of each controller and word length, with its figures in the caption; nothing where none was measured.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn section(data: &Results) -> Result<Markup, ReportError> {
    let plots = data
        .errors
        .iter()
        .map(plot)
        .collect::<Result<Vec<_>, _>>()?;
    if plots.is_empty() {
        return Ok(html! {});
    }
    Ok(html! {
        h3 { "Errors of single steps against the proven bound" }
        p.note {
            "Default variants at the speeds above, 32- and 16-bit words: the signal of one step less that of the ideal model from the same state, \
             phases a and b. The signal is the voltage that the law asks for before the limit (PHCC: the predicted error of the current, times K). \
             Steps on which a tie was decided otherwise are left out. "
            code { "hexagen compare" } " prints the figures."
        }
        (legend([
            (field(palette::PHASES[0], 1.0), "errors seen, share on a scale of powers of ten".to_owned()),
            (swatch(palette::PHASES[2], 3.0, (0.0, 0.0)), "proven bound".to_owned()),
        ]))
        div.plots.four { @for plot in plots { (plot) } }
    })
}

fn plot(seen: &ErrorsSeen) -> Result<Markup, ReportError> {
    let volts = |volts| engineering(volts, "V").replace(" u", " \u{b5}");
    let (largest, bound) = (volts(seen.largest_v), volts(seen.bound_v));
    let description = format!(
        "Errors of {} with {}-bit words: {largest} at most, proven {bound}",
        seen.controller, seen.word
    );
    let plot = histogram(&Histogram {
        description: &description,
        unit: "V",
        bound: seen.bound_v,
        counts: &seen.counts,
    })?;
    let caption = html! {
        span {
            (variant_text(&seen.controller)) ", " strong { (seen.word) "\u{a0}bits" } ": "
            (largest) " of " (bound) ", SNR\u{a0}" (number(seen.snr_db, 0)) "\u{a0}dB, decisions alike\u{a0}" (number(seen.decisions_equal_pct, 1)) "\u{a0}%"
        }
    };
    Ok(figure(&caption, &plot))
}
