//! Ripple over a varied parameter, with the computed stable range.

use super::super::palette::PHASES;
use super::{Axis, Element, Plot, Stroke, step};
use crate::stability::StabilityCheck;

/// Ends of the search for the range's edges: a range that reaches them has no edge there.
pub const SEARCH: (f64, f64) = (0.1001, 9.9);

/// Simulated runs of one parameter at one speed: dots are stable, crosses not. `range` is the
/// computed stable range of true over nominal value.
pub fn stability(
    description: String,
    checks: &[&StabilityCheck],
    range: (f64, f64),
    x_title: String,
) -> Plot {
    let factors = checks.iter().map(|check| check.factor);
    let (least, most) = factors.fold((1.0_f64, 1.0_f64), |(l, m), f| (l.min(f), m.max(f)));
    let pad = 0.04 * (most - least).max(0.1);
    let x_range = least - pad..most + pad;
    let greatest = |is_asked: &dyn Fn(&StabilityCheck) -> bool| {
        let asked = checks.iter().filter(|check| is_asked(check));
        asked.filter_map(|c| c.ripple_rms_pct).fold(0.0, f64::max)
    };
    // Far outside the range, the ripple only shows that the loop is unstable.
    let calm = greatest(&|check| check.stable);
    let end = greatest(&|_| true).min(4.0 * calm).max(1.0);
    let y_step = step(&(0.0..end), 6);
    let top = (end / y_step).ceil() * y_step;
    let x = Axis::new(x_title, &x_range, 8);
    let y = Axis::stepped("RMS torque ripple in %", &(0.0..top), y_step);
    let mut plot = Plot::new(description, (550.0, 250.0), x, y);
    let (low, high) = (range.0.max(x_range.start), range.1.min(x_range.end));
    if low < high {
        plot.block((low, 0.0), (high, top), (PHASES[0], 0.12));
        for edge in [range.0, range.1] {
            if x_range.contains(&edge) && (SEARCH.0..SEARCH.1).contains(&edge) {
                plot.line([(edge, 0.0), (edge, top)], Stroke::solid(PHASES[0], 1.2));
            }
        }
    }
    for check in checks {
        let ripple = check.ripple_rms_pct.map_or(top, |ripple| ripple.min(top));
        let at = (check.factor, ripple);
        plot.add(if check.stable {
            Element::Dot {
                at,
                radius: 3.5,
                color: PHASES[0],
                width: None,
            }
        } else {
            Element::Cross {
                at,
                color: PHASES[2],
            }
        });
    }
    plot
}
