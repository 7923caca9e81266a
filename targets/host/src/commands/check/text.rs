//! The lines of `hexagen check`.

use crate::commands::cut::{followed, least_held};
use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::spec::{
    BusSource, CurrentSensing, EmfShape, Envelope, InverterSpec, MotorSpec, RotorSensing, SpeedLoop,
};
use hexagen_lab::engine::Prepared;
use hexagen_lab::judgement::{Judgement, Point};
use hexagen_lab::text::significant;
use hexagen_lab::times::sentence;
use std::iter::repeat;

/// Torque of `max_current` over the demanded one above which it is told.
const MORE: f64 = 1.01;

/// Speed without the limit of the bus current over that with it from which on the limit is told.
const LATER: f64 = 1.001;

/// Titles and texts, of which the last is the `next` command; `with_reasons`: also each option chosen by default on
/// a row of its own, with its reason. Of the clauses of a text the first is the most important.
pub(super) fn rows(
    judgement: &Judgement,
    drive: &Prepared,
    with_reasons: bool,
    next: &str,
) -> Vec<(&'static str, String)> {
    let (motor, inverter) = (&drive.spec.motor, &drive.spec.inverter);
    let mut rows = vec![
        ("motor", of_motor(motor)),
        ("controller", of_controller(judgement, drive)),
        ("sensing", of_sensing(judgement, inverter)),
        ("bus", of_bus(judgement, drive)),
    ];
    rows.extend(judgement.bus_limits().map(|text| ("limits", text)));
    rows.push(("current", of_current(judgement, motor, inverter)));
    rows.push(("step", sentence(&drive.generated.interface.times)));
    rows.push(("torque", of_torque(judgement)));
    if with_reasons {
        let heading = ["by default"].into_iter().chain(repeat(""));
        rows.extend(heading.zip(of_defaults(judgement)));
    }
    rows.push(("next", next.to_owned()));
    rows
}

/// The options that rules chose, with their reasons.
fn of_defaults(judgement: &Judgement) -> Vec<String> {
    let chosen = judgement.chosen.iter();
    let lines = chosen.map(|choice| {
        let (option, value, reason) = (choice.option, &choice.value, choice.reason);
        format!("{option} {value}: {reason}")
    });
    lines.collect()
}

/// Distance of a stated rated torque from that of the rated current, over it, from which on a note says so.
const APART: f64 = 0.02;

/// The note on a stated rated torque that the rated current makes neither as a block nor as a sine.
pub(super) fn stated_torque(motor: &MotorSpec) -> Option<String> {
    let stated = motor.rated_torque?;
    let block = motor.emf_constant * motor.emf_shape.quasi_square_factor();
    let sine = motor.rated_torque_constant();
    let is_apart = |per_ampere: f64| {
        let made = per_ampere * motor.rated_current;
        (stated / made - 1.0).abs() > APART
    };
    let made = |per_ampere: f64, basis: &str| {
        let torque = engineering(per_ampere * motor.rated_current, "Nm");
        format!("{torque} {basis} ({})", engineering(per_ampere, "Nm/A"))
    };
    let as_sine = match motor.emf_shape {
        EmfShape::Trapezoidal { .. } => String::new(),
        EmfShape::Sinusoidal | EmfShape::Harmonics(_) => {
            format!(", and {}", made(sine, "as the peak of a sine"))
        }
    };
    (is_apart(block) && is_apart(sine)).then(|| {
        format!(
            "`rated_torque` {} is taken as stated; the rated {} makes {}{as_sine}",
            engineering(stated, "Nm"),
            engineering(motor.rated_current, "A"),
            made(block, "as a block, in the mean"),
        )
    })
}

/// Basis of the torque per ampere: of which current the ampere is the peak.
fn basis(shape: EmfShape) -> &'static str {
    match shape {
        EmfShape::Sinusoidal | EmfShape::Harmonics(_) => "of a sine",
        EmfShape::Trapezoidal { .. } => "of a block",
    }
}

/// In g cm2 as data sheets have it, unless it is that of a large machine.
fn of_inertia(inertia: f64) -> String {
    if inertia < 1e-3 {
        format!("; {} g cm2", significant(1e7 * inertia, 3))
    } else {
        format!("; {} kg m2", significant(inertia, 3))
    }
}

fn of_motor(motor: &MotorSpec) -> String {
    format!(
        "{} pole pair{} ({} magnets), star phase {}, {}; {} {}{}",
        motor.pole_pairs,
        if motor.pole_pairs == 1 { "" } else { "s" },
        2 * motor.pole_pairs,
        engineering(motor.resistance, "ohm"),
        engineering(motor.inductance, "H"),
        engineering(motor.rated_torque_constant(), "Nm/A"),
        basis(motor.emf_shape),
        motor.inertia.map_or(String::new(), of_inertia),
    )
}

fn of_controller(judgement: &Judgement, drive: &Prepared) -> String {
    let edges = match drive.spec.inverter.rotor_sensing {
        RotorSensing::SampledHalls => "Hall edges sampled once a period".to_owned(),
        RotorSensing::TimedHalls { .. } => "Hall edges by a capture timer".to_owned(),
        RotorSensing::Angle(sensor) => {
            of_angle(sensor.turns.unsigned_abs(), drive.spec.motor.pole_pairs)
        }
    };
    let (nominal, _) = judgement.runs();
    let rates = nominal
        .iter()
        .filter_map(|point| Some(significant(1e-3 * point.switching_hz?, 3)));
    let mut rates: Vec<String> = rates.collect();
    rates.dedup();
    let rates = match rates.as_slice() {
        [slow, rated] => format!("{slow} kHz, at rated speed {rated} kHz"),
        rates => format!("{} kHz", rates.join(", ")),
    };
    // At the nominal bus.
    let ripple = drive.spec.pwm_ripple().map_or(String::new(), |most| {
        format!("; PWM ripple to {} A pp", significant(most, 3))
    });
    let speed = drive.left_out.map(|speed| of_speed_loop(speed, drive));
    format!(
        "{}, {edges}{ripple}; switches at {rates}{}",
        drive.spec.controller.kind(),
        speed.unwrap_or_default(),
    )
}

/// Bandwidth of the speed loop, and the least speed that it holds where Hall edges tell it.
fn of_speed_loop(speed: SpeedLoop, drive: &Prepared) -> String {
    let bandwidth = engineering(speed.bandwidth, "Hz");
    let from =
        least_held(&drive.spec, speed).map_or(String::new(), |rpm| format!(", from {rpm:.0} rpm"));
    format!("; speed loop {bandwidth}{from}")
}

/// The angle that a sensor of so many pole pairs tells of a motor of `all`.
fn of_angle(pairs: u32, all: u32) -> String {
    match pairs {
        _ if pairs == all => "angle of the shaft".to_owned(),
        1 => "electrical angle".to_owned(),
        _ => format!("angle of {pairs} electrical turns a turn"),
    }
}

fn of_sensing(judgement: &Judgement, inverter: &InverterSpec) -> String {
    let place = match inverter.current_sensing {
        CurrentSensing::InPhase => "in the phases",
        CurrentSensing::LowSide(_) => "in the low legs",
    };
    let dead_time = match inverter.dead_time {
        0.0 => "no dead time".to_owned(),
        time => format!("dead time {}", engineering(time, "s")),
    };
    format!(
        "{place}, {} bits to {}, {} a count ({} at rating); {dead_time}",
        inverter.adc_bits,
        engineering(inverter.shown_current(), "A"),
        engineering(inverter.adc_gain.abs(), "A"),
        significant(judgement.rated_counts, 3),
    )
}

fn of_bus(judgement: &Judgement, drive: &Prepared) -> String {
    let (share, v_bus) = (drive.spec.reach_share(), drive.spec.inverter.v_bus);
    let bus = engineering(v_bus, "V");
    // Where legs must be low for a while.
    let reach = if share < 1.0 {
        format!("{} (bus {bus})", engineering(v_bus * share, "V"))
    } else {
        bus
    };
    let weakens = drive.spec.controller.common().field_weakening;
    let lasts = if weakens {
        "whole turned current"
    } else {
        "whole current"
    };
    let (end, why) = followed(drive, judgement.envelope_rpm);
    let why = why
        .map(str::to_owned)
        .or_else(|| ended_by(judgement, drive));
    format!(
        "rated speed takes {} of {reach}; {lasts} to {} rpm{}{}",
        engineering(judgement.rating_v, "V"),
        end.floor(),
        why.unwrap_or_default(),
        if drive.spec.inverter.bus == BusSource::Fixed {
            "; not measured"
        } else {
            ""
        },
    )
}

/// What ends the whole current where that is the limit of the bus current and not the voltage, as ` (by 20 A of bus
/// current)`.
fn ended_by(judgement: &Judgement, drive: &Prepared) -> Option<String> {
    let limited = Envelope::of(&drive.spec);
    let free = limited.without_bus_limit();
    let torque = judgement.torque_nm;
    let most = engineering(judgement.bus_current_limit_a?, "A");
    let is_limit = free.speed(torque)? > limited.speed(torque)? * LATER;
    is_limit.then(|| format!(" (by {most} of bus current)"))
}

/// The demanded torque's current beside the rated one, the mean that it draws from the bus at rated speed
/// and in braking returns to one that nobody watches, and what the largest set-point gives beyond it.
fn of_current(judgement: &Judgement, motor: &MotorSpec, inverter: &InverterSpec) -> String {
    let beyond = if judgement.greatest_torque_nm > MORE * judgement.torque_nm {
        format!(
            "; max_current {} gives {} {}",
            engineering(inverter.max_current, "A"),
            engineering(judgement.greatest_torque_nm, "Nm"),
            judgement
                .greatest_torque_rpm
                .map_or("at no speed".to_owned(), |rpm| format!(
                    "to {} rpm",
                    rpm.floor()
                )),
        )
    } else {
        String::new()
    };
    let rated = engineering(motor.rated_current, "A");
    let rated = match motor.emf_shape {
        _ if judgement.peak_a <= MORE * motor.rated_current => format!("rated {rated} peak"),
        // A current that is no block gives the torque of the rated one with another peak.
        EmfShape::Trapezoidal { .. } | EmfShape::Harmonics(_) => {
            format!("by shape above rated {rated}")
        }
        EmfShape::Sinusoidal => {
            let as_block = judgement.peak_a * 3.0_f64.sqrt() / 2.0;
            if as_block <= MORE * motor.rated_current {
                format!("heats no more than a block of the rated {rated}")
            } else {
                format!("heats more than a block of the rated {rated}")
            }
        }
    };
    let drawn = judgement.rated().and_then(|point| point.bus_current_a);
    let drawn = drawn.map_or(String::new(), |mean| {
        let returned = judgement.unwatched_return_a.map(|returned| {
            let returned = significant(returned, 2);
            format!(", {returned} A back in braking")
        });
        format!(
            "; bus mean {}{}",
            engineering(mean, "A"),
            returned.unwrap_or_default()
        )
    });
    format!(
        "{} takes a peak of {}; trips at {}; {rated}{drawn}{beyond}",
        engineering(judgement.torque_nm, "Nm"),
        engineering(judgement.peak_a, "A"),
        engineering(inverter.trip_current, "A"),
    )
}

/// Torque and ripple, peak to peak of the means over a control period, of each run.
fn of_torque(judgement: &Judgement) -> String {
    let (nominal, lowest) = judgement.runs();
    let nominal = nominal.iter().chain(&judgement.asked);
    let nominal = nominal.map(|point| of_run(&format!("at {:.0} rpm", point.rpm), point));
    let lowest = lowest.iter().map(|point| {
        let bus = engineering(point.bus_v, "V");
        of_run(&format!("there on {bus}"), point)
    });
    let runs: Vec<String> = nominal.chain(lowest).collect();
    let demand = engineering(judgement.torque_nm, "Nm");
    format!("of demand {demand}: {}", runs.join("; "))
}

fn of_run(at: &str, point: &Point) -> String {
    match (point.torque_pct, point.tripped) {
        (_, Some(_)) => format!("{at} trips"),
        (Some(torque), None) => {
            let ripple = point.ripple_pp_pct.map_or_else(String::new, |ripple| {
                format!(", ripple {} %", significant(ripple, 2))
            });
            format!("{at} {} %{ripple}", significant(torque, 3))
        }
        (None, None) => format!("{at} none"),
    }
}

#[cfg(test)]
mod tests {
    use super::of_angle;

    #[test]
    fn an_angle_is_told_as_the_shafts_or_as_electrical() {
        let told = [(21, 21), (1, 21), (3, 21)].map(|(pairs, all)| of_angle(pairs, all));
        let turns = "angle of 3 electrical turns a turn";
        assert_eq!(told, ["angle of the shaft", "electrical angle", turns]);
    }
}
