//! Documentation of the method.

use crate::diagnostics::{engineering, significant};
use crate::laws::Description;
use crate::laws::current_loop::LoopDesign;
use crate::laws::whole_vectors::pulsed_legs;
use crate::spec::{Candidates, FcsMpcSpec, Spec};

const TITLE: &str = "Finite-control-set model predictive current controller";

/// Documentation of the method.
pub(super) fn describe(spec: &Spec, options: &FcsMpcSpec, design: &LoopDesign) -> Description {
    let high = spec.inverter.v_bus * spec.reach_share();
    let stride = design.plant.gain * 2.0 / 3.0 * high;
    let begin = if options.modulated {
        "The chosen voltage vector is the"
    } else {
        "One voltage vector per period: the"
    };
    if options.horizon == 2 {
        return two_steps(spec, options, stride);
    }
    let mut notes = vec![
        format!(
            "{begin} allowed one of the least predicted error |i_ref - i(k+2)|^2. The error of a"
        ),
        format!(
            "vector v is b |u - v| with u the deadbeat voltage, so the step takes the vector nearest to u, {}.",
            if options.torque_weight > 0.0 {
                "found by enumeration"
            } else {
                "found by geometry"
            }
        ),
        format!(
            "One three-phase vector moves the current by at most {} per period.",
            engineering(stride, "A")
        ),
    ];
    if options.switching_weight > 0.0 {
        notes.push(format!(
            "Switching a leg costs as much as an error of {} at the nominal bus, in proportion to the bus.",
            engineering(options.switching_weight, "A")
        ));
    }
    if options.torque_weight > 0.0 {
        notes.push(format!(
            "The squared error along the sector's mean EMF, which makes torque, has an additional weight of {}.",
            significant(options.torque_weight)
        ));
    }
    if options.modulated {
        notes.push("It shares the period with the best second vector that one pulse per leg allows; their mean is the point".to_owned());
        notes.push("nearest to u on the line between them.".to_owned());
    }
    notes.extend(pulsed_legs(spec));
    Description {
        title: TITLE,
        notes,
        stable: None,
        constants: vec![],
    }
}

/// Documentation of the choice over two periods.
fn two_steps(spec: &Spec, options: &FcsMpcSpec, stride: f64) -> Description {
    let (sequences, first) = match options.candidates {
        Candidates::ThreePhase => (49, 7),
        _ => (169, 13),
    };
    let mut notes = vec![
        format!("One voltage vector per period: the first of the best of {sequences} sequences of two, by the predicted error"),
        "|i_ref - i(k+2)|^2 + |i_ref - i(k+3)|^2. The best second vector follows from geometry, so that the step".to_owned(),
        format!("compares {first} scores."),
        format!("One three-phase vector moves the current by at most {} per period.", engineering(stride, "A")),
    ];
    notes.extend(pulsed_legs(spec));
    Description {
        title: TITLE,
        notes,
        stable: None,
        constants: vec![],
    }
}
