//! The lines of `hexagen check`.

use super::{Checked, Chosen, Point};
use crate::cli::wrapped;
use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::spec::{CurrentSensing, InverterSpec, MotorSpec, Reference, RotorSensing};
use hexagen_lab::engine::Prepared;
use hexagen_lab::text::significant;
use hexagen_lab::times::sentence;

/// What a torque of more than the demanded one is worth a word for.
const MORE: f64 = 1.01;

/// About ten lines of at most 100 columns, then the options chosen by default and the `next` command.
pub(super) fn lines(checked: &Checked, drive: &Prepared, next: &str) -> Vec<String> {
    let (motor, inverter) = (&drive.spec.motor, &drive.spec.inverter);
    let mut rows = vec![
        ("motor", of_motor(motor)),
        ("controller", of_controller(drive)),
        ("sensing", of_sensing(checked, inverter)),
        ("bus", of_bus(checked, drive)),
    ];
    rows.extend(of_limits(checked).map(|text| ("limits", text)));
    rows.push(("current", of_current(checked, motor, inverter)));
    rows.push(("step", sentence(&drive.generated.interface.times)));
    rows.push(("torque", of_torque(checked)));
    rows.push(("ripple", of_ripple(checked)));
    let mut heading = "by default";
    for Chosen {
        option,
        value,
        reason,
    } in &checked.chosen
    {
        rows.push((heading, format!("{option} {value}: {reason}")));
        heading = "";
    }
    rows.push(("next", next.to_owned()));
    let rows = rows
        .iter()
        .map(|(title, text)| format!("{title:<12}{text}"));
    [format!("{}: {}", checked.motor, checked.verdict)]
        .into_iter()
        .chain(rows)
        .map(|line| wrapped(&line))
        .collect()
}

fn of_motor(motor: &MotorSpec) -> String {
    let inertia = motor
        .inertia
        .map_or("inertia unknown".to_owned(), |inertia| {
            format!("{} kg m2", significant(inertia, 3))
        });
    format!(
        "{} pole pairs, {}, {} per phase; {}, {inertia}",
        motor.pole_pairs,
        engineering(motor.resistance, "ohm"),
        engineering(motor.inductance, "H"),
        engineering(motor.rated_torque_constant(), "Nm/A"),
    )
}

fn of_controller(drive: &Prepared) -> String {
    let common = drive.spec.controller.common();
    let current = match common.reference {
        Reference::Proportional => "proportional",
        Reference::QuasiSquare => "quasi-square",
    };
    let edges = match drive.spec.inverter.rotor_sensing {
        RotorSensing::SampledHalls => "Hall edges to a period (a timer is finer)",
        RotorSensing::TimedHalls { .. } => "Hall edges by a capture timer",
        RotorSensing::Angle(_) => "an angle sensor",
    };
    format!(
        "{}, {}-bit words, {current} current, {edges}",
        drive.spec.controller.kind(),
        common.word
    )
}

fn of_sensing(checked: &Checked, inverter: &InverterSpec) -> String {
    let place = match inverter.current_sensing {
        CurrentSensing::InPhase => "in the phases",
        CurrentSensing::LowSide(_) => "in the low legs",
    };
    let dead_time = match inverter.dead_time {
        0.0 => "no dead time".to_owned(),
        time => format!("dead time {}", engineering(time, "s")),
    };
    format!(
        "{place}, {} bits to {}, {} a count, {} at rated current; {dead_time}",
        inverter.adc_bits,
        engineering(inverter.shown_current(), "A"),
        engineering(inverter.adc_gain.abs(), "A"),
        significant(checked.rated_counts, 3),
    )
}

fn of_bus(checked: &Checked, drive: &Prepared) -> String {
    let (share, v_bus) = (drive.spec.reach_share(), drive.spec.inverter.v_bus);
    // Where legs must be low for a while.
    let reach = if share < 1.0 {
        format!("{} of ", engineering(v_bus * share, "V"))
    } else {
        String::new()
    };
    format!(
        "rated speed takes {}, the inverter makes {reach}{}; whole current to {:.0} rpm",
        engineering(checked.rating_v, "V"),
        engineering(v_bus, "V"),
        checked.envelope_rpm,
    )
}

/// The limits of the bus current, where there are any.
fn of_limits(checked: &Checked) -> Option<String> {
    let limits = [
        (checked.bus_current_limit_a, "drawn from the bus"),
        (checked.return_current_limit_a, "returned to it"),
    ];
    let limits = limits.into_iter().filter_map(|(most, way)| {
        let most = engineering(most?, "A");
        Some(format!("{most} {way}"))
    });
    let limits: Vec<String> = limits.collect();
    (!limits.is_empty()).then(|| format!("at most {}", limits.join(", ")))
}

/// The demanded torque's current beside the rated one, and what the largest set-point gives beyond it.
fn of_current(checked: &Checked, motor: &MotorSpec, inverter: &InverterSpec) -> String {
    let beyond = if checked.greatest_torque_nm > MORE * checked.torque_nm {
        format!(
            "; max_current {} gives {} {}",
            engineering(inverter.max_current, "A"),
            engineering(checked.greatest_torque_nm, "Nm"),
            checked
                .greatest_torque_rpm
                .map_or("at no speed".to_owned(), |rpm| format!("to {rpm:.0} rpm")),
        )
    } else {
        String::new()
    };
    format!(
        "{} takes a peak of {}, rated {}{beyond}; trips at {}",
        engineering(checked.torque_nm, "Nm"),
        engineering(checked.peak_a, "A"),
        engineering(motor.rated_current, "A"),
        engineering(inverter.trip_current, "A"),
    )
}

fn of_torque(checked: &Checked) -> String {
    let parts = checked.points.iter().map(|point| {
        let at = place(checked, point);
        match (point.torque_pct, point.tripped) {
            (_, Some(_)) => format!("trips {at}"),
            (Some(torque), None) => format!("{} % {at}", significant(torque, 3)),
            (None, None) => format!("none {at}"),
        }
    });
    let parts: Vec<String> = parts.collect();
    let demand = engineering(checked.torque_nm, "Nm");
    format!("of {demand}: {}", parts.join(", "))
}

fn of_ripple(checked: &Checked) -> String {
    let points = || checked.points.iter();
    let ripples: Vec<String> = points()
        .filter_map(|point| Some(format!("{} %", significant(point.ripple_pp_pct?, 2))))
        .collect();
    let mut rates: Vec<String> = points()
        .filter_map(|point| Some(significant(1e-3 * point.switching_hz?, 3)))
        .collect();
    rates.dedup();
    format!(
        "{} peak to peak, means over a period; switches at {} kHz",
        ripples.join(", "),
        rates.join(", "),
    )
}

/// Where a run was.
fn place(checked: &Checked, point: &Point) -> String {
    let is_nominal = checked
        .points
        .first()
        .is_some_and(|first| first.bus_v == point.bus_v);
    if is_nominal {
        format!("at {:.0} rpm", point.rpm)
    } else {
        format!("there on a bus of {}", engineering(point.bus_v, "V"))
    }
}
