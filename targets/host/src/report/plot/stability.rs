//! Ripple over a parameter that is off, with the range in which the loop should be stable.

use super::canvas::{
    self, Axis, Margins, chart, decimals, failed, line, polyline, px, tick_text, ticks,
};
use super::palette::PHASES;
use crate::report::ReportError;
use hexagen_lab::stability::StabilityCheck;
use maud::PreEscaped;
use plotters::prelude::*;

/// Ends of the search for the range's edges: beyond them nothing is known to be unstable, so they
/// are no edges.
pub const SEARCH: (f64, f64) = (0.1001, 9.9);

/// Draws simulated runs of one parameter at one speed: filled dots are stable, crosses not.
/// `range` is the computed stable range of true over stated value.
pub fn stability(
    checks: &[&StabilityCheck],
    range: (f64, f64),
    x_title: &str,
    description: &str,
) -> Result<PreEscaped<String>, ReportError> {
    let factors = checks.iter().map(|check| check.factor);
    let (least, most) = factors.fold((1.0_f64, 1.0_f64), |(l, m), f| (l.min(f), m.max(f)));
    let pad = 0.04 * (most - least).max(0.1);
    let x_range = least - pad..most + pad;
    // Far outside the range the ripple says no more than that the loop is unstable.
    let stable = checks.iter().filter(|check| check.stable);
    let calm = stable.filter_map(|c| c.ripple_rms_pct).fold(0.0, f64::max);
    let any = checks
        .iter()
        .filter_map(|c| c.ripple_rms_pct)
        .fold(0.0, f64::max);
    let y_step = canvas::step(&(0.0..any.min(4.0 * calm).max(1.0)), 6);
    let top = (any.min(4.0 * calm).max(1.0) / y_step).ceil() * y_step;
    canvas::svg((550.0, 250.0), description, |area| {
        let x_step = canvas::step(&x_range, 8);
        let (x_digits, y_digits) = (decimals(x_step), decimals(y_step));
        let y = Axis {
            range: 0.0..top,
            ticks: ticks(&(0.0..top), y_step),
            label: &|ripple| tick_text(*ripple, y_digits),
            title: "RMS torque ripple in %",
        };
        let margins = Margins {
            right: 20.0,
            ..Margins::fitting(&y)
        };
        let mut chart = chart(
            area,
            margins,
            Axis {
                range: x_range.clone(),
                ticks: ticks(&x_range, x_step),
                label: &|factor| tick_text(*factor, x_digits),
                title: x_title,
            },
            y,
        )?;
        let (low, high) = (range.0.max(x_range.start), range.1.min(x_range.end));
        if low < high {
            let block = Rectangle::new([(low, top), (high, 0.0)], PHASES[0].mix(0.12).filled());
            chart.plotting_area().draw(&block).map_err(failed)?;
            for edge in [range.0, range.1] {
                if x_range.contains(&edge) && (SEARCH.0..SEARCH.1).contains(&edge) {
                    polyline(&mut chart, [(edge, 0.0), (edge, top)], line(PHASES[0], 1.2))?;
                }
            }
        }
        for check in checks {
            let at = (
                check.factor,
                check.ripple_rms_pct.map_or(top, |ripple| ripple.min(top)),
            );
            let plane = chart.plotting_area();
            if check.stable {
                plane.draw(&Circle::new(at, px(3.5), PHASES[0].filled()))
            } else {
                plane.draw(&Cross::new(at, px(4.0), line(PHASES[2], 2.0)))
            }
            .map_err(failed)?;
        }
        Ok(())
    })
}
