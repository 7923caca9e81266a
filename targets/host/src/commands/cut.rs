//! What cuts a torque besides the voltage of the bus, and which speeds a drive holds.

use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::spec::{BusSource, InverterSpec, RotorSensing, Spec, SpeedLoop};
use hexagen_lab::engine::Prepared;
use hexagen_lab::judgement::limit_acts;
use std::f64::consts::TAU;

/// The limit of the bus current and the fade that cut a torque on a bus of `v_bus` volt, in words; none where neither
/// does. `bus_current`: the mean that was drawn, ampere; none where no limit needs it.
pub fn cut_by(
    inverter: &InverterSpec,
    is_motoring: bool,
    v_bus: f64,
    bus_current: Option<f64>,
) -> Option<String> {
    let current = of_current(inverter, is_motoring, bus_current);
    let BusSource::Measured {
        braking, motoring, ..
    } = inverter.bus
    else {
        return current;
    };
    let (name, fade) = if is_motoring {
        let begun = motoring.filter(|fade| v_bus < fade.full);
        ("motoring_fade", begun)
    } else {
        let begun = braking.filter(|fade| v_bus > fade.full);
        ("braking_fade", begun)
    };
    let bus = engineering(v_bus, "V");
    let of_voltage = fade.map(|_| format!("`{name}` on a bus of {bus}"));
    let both: Vec<String> = current.into_iter().chain(of_voltage).collect();
    (!both.is_empty()).then(|| both.join(", "))
}

/// A speed in rpm, or the greatest that the drive follows, and in that case why it ends there.
pub fn followed(drive: &Prepared, rpm: f64) -> (f64, Option<&'static str>) {
    let most = drive.maximum_rpm();
    if rpm > most {
        (most, Some(", maximum_speed"))
    } else {
        (rpm, None)
    }
}

/// What is told of a speed in rpm that the drive does not follow.
pub fn beyond_followed(drive: &Prepared, rpm: f64) -> Option<String> {
    let most = drive.maximum_rpm();
    (rpm.abs() > most * (1.0 + 1e-9)).then(|| {
        format!(
            "--rpm {rpm}: beyond maximum_speed = {most:.0} rpm, up to which the drive follows the rotor"
        )
    })
}

/// Least speed that a speed loop holds, rpm, where the mean over an electrical turn of Hall edges tells it.
pub fn least_held(spec: &Spec, speed: SpeedLoop) -> Option<f64> {
    let has_halls = !matches!(spec.inverter.rotor_sensing, RotorSensing::Angle(_));
    has_halls.then(|| speed.least_speed(spec.motor.pole_pairs) * 60.0 / TAU)
}

/// What is told of a mean bus current beyond its limit: behind a step of the set-point the limit takes the torque back
/// over many periods.
pub fn beyond_limit(inverter: &InverterSpec, bus_current: f64) -> Option<String> {
    let limits = [
        (
            "bus_current_limit",
            inverter.bus_currents.drawn,
            bus_current,
        ),
        (
            "return_current_limit",
            inverter.bus_currents.returned,
            -bus_current,
        ),
    ];
    limits.into_iter().find_map(|(name, limit, current)| {
        let limit = limit.filter(|limit| current > 1.02 * limit)?;
        Some(format!(
            "the bus current is above `{name}` of {}: behind a step of the set-point the drive takes the torque back over many control periods, which --csv shows and a `slew_rate`, or a lower one, avoids; the drive computes this current, so a bus or sensors unlike the file's move its limit, too",
            engineering(limit, "A")
        ))
    })
}

fn of_current(
    inverter: &InverterSpec,
    is_motoring: bool,
    bus_current: Option<f64>,
) -> Option<String> {
    let (name, most, way) = if is_motoring {
        ("bus_current_limit", inverter.bus_currents.drawn, 1.0)
    } else {
        ("return_current_limit", inverter.bus_currents.returned, -1.0)
    };
    let acts = |most: &f64| bus_current.is_some_and(|current| limit_acts(*most, way * current));
    Some(format!(
        "`{name}` of {}",
        engineering(most.filter(acts)?, "A")
    ))
}
