//! Warnings of what makes the torque ripple: Hall edges seen at samples, a long control period, a dead time not stated.

use crate::diagnostics::Diagnostic;
use crate::diagnostics::catalogue;
use crate::diagnostics::catalogue::Part;
use crate::spec::Spec;
use crate::spec::ast::Section;
use crate::spec::controller::common::FELT_DEAD_TIME;
use crate::spec::reader::Reader;

/// A dead time as many inverters have it, second: the median of the board library.
const USUAL_DEAD_TIME: f64 = 500e-9;

/// `options`: those of the controller; `period`: the field that states the control period.
pub(super) fn check(
    inverter: &Reader,
    options: &Section,
    period: &Part,
    spec: &Spec,
    warnings: &mut Vec<Diagnostic>,
) {
    if let Some(ripple) = spec.told_sampled_ripple() {
        let degrees = spec.degrees_per_period();
        warnings.push(catalogue::sampled_halls(period, degrees, ripple));
    }
    // What whole vectors need is told with them.
    let clause = spec.long_period();
    if let Some(clause) = clause.filter(|_| spec.controller.modulates()) {
        warnings.push(catalogue::long_control_period(period, &clause));
    }
    // Without compensation a stated dead time would change nothing.
    if options.field("dead_time_compensation").is_none() {
        check_dead_time(inverter, spec, warnings);
    }
}

/// A dead time that is not stated, and of which a usual one would be compensated.
fn check_dead_time(reader: &Reader, spec: &Spec, warnings: &mut Vec<Diagnostic>) {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let pulses_all = spec.controller.common_mode().is_some();
    let lost = f64::from(inverter.pwm_per_control) * inverter.v_bus * USUAL_DEAD_TIME;
    let moved = lost / (motor.inductance * motor.rated_current);
    if pulses_all && reader.field("dead_time").is_none() && moved > FELT_DEAD_TIME {
        warnings.push(catalogue::no_dead_time(
            reader.location(),
            USUAL_DEAD_TIME,
            moved,
        ));
    }
}
