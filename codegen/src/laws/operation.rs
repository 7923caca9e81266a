//! The type's documentation of operation: signs and wiring, start-up, faults.

use super::current_loop::{Allowance, LoopDesign};
use super::start::start_rpm;
use crate::blocks::OVER_SPEED_EDGES;
use crate::design::vectors::SECTOR_CURRENT;
use crate::diagnostics::{engineering, frequency, percent, rpm, significant};
use crate::spec::{
    BusCurrents, BusSource, CurrentSensor, CurrentSum, InverterSpec, MOST_TURN, RotorSensing,
    SensedPhases, Spec,
};
use std::f64::consts::{FRAC_PI_3, TAU};

/// Conducting pairs of sectors S1 to S6 at a positive set-point: phase in, phase out.
fn pairs() -> [String; 6] {
    SECTOR_CURRENT.map(|signs| {
        let phase_of = |wanted: i32| {
            let mut phases = ["a", "b", "c"].into_iter().zip(signs);
            phases
                .find(|&(_, sign)| sign == wanted)
                .map_or("", |(phase, _)| phase)
        };
        format!("{}, {}", phase_of(1), phase_of(-1))
    })
}

/// The phases with a sensor, and the third.
fn named_phases(inverter: &InverterSpec) -> [&'static str; 3] {
    let name = |place: usize| ["a", "b", "c"][place % 3];
    let first = inverter.sensed_phases.phases()[0];
    [name(first), name(first + 1), name(first + 2)]
}

/// What the counts say of the currents.
fn sensors(inverter: &InverterSpec) -> String {
    let all = inverter.sensors();
    let gain = engineering(inverter.adc_gain.abs(), "A");
    let way = |sensor: &CurrentSensor| if sensor.gain < 0.0 { "fall" } else { "rise" };
    let named = named_phases(inverter);
    let first = all[0];
    let start = "Phase currents are positive into the motor";
    if all.iter().all(|sensor| *sensor == first) {
        let mut sensed = named[..all.len()].to_vec();
        sensed.sort_unstable();
        let (last, others) = (sensed.pop().unwrap_or_default(), sensed.join(", "));
        return format!(
            "{start}; the counts of phases {others} and {last} {} with the current, {gain} each, from {} at zero",
            way(&first),
            first.offset
        );
    }
    let of_each = all.iter().zip(named).map(|(sensor, phase)| {
        let gain = engineering(sensor.gain.abs(), "A");
        let way = way(sensor);
        format!(
            "of phase {phase} {way} with the current from {} at zero, {gain} each",
            sensor.offset
        )
    });
    format!(
        "{start}; the counts {}",
        of_each.collect::<Vec<_>>().join(", ")
    )
}

/// What a drive makes of three currents.
fn three_sensors(inverter: &InverterSpec) -> Vec<String> {
    let mut lines = vec![String::new()];
    if let Some(top) = inverter.readable_at_end() {
        lines.push(format!(
            "A leg that is off, or whose compare value is above {top}, is not read at the end of its period: its current is the rest of the other two."
        ));
    }
    if let Some(CurrentSum { tolerance, samples }) = inverter.current_sum {
        lines.push(format!(
            "Where all three currents are read, a sum above {} in {samples} samples in a row trips the drive.",
            engineering(tolerance, "A")
        ));
    }
    lines
}

/// Signs, sectors, and the sensors' scales.
pub fn wiring(spec: &Spec) -> Vec<String> {
    let inverter = &spec.inverter;
    let angles = spec.motor.hall_angles.map(|angle| format!("{angle} deg"));
    let mut lines = vec![
        String::new(),
        "# Signs and wiring".to_owned(),
        String::new(),
        sensors(inverter),
        "current. Forward is the order of the sectors, in which the EMFs of a, b and c peak one after the other:".to_owned(),
        String::new(),
        "| sector | S1 | S2 | S3 | S4 | S5 | S6 |".to_owned(),
        "|---|---|---|---|---|---|---|".to_owned(),
    ];
    if spec.angle_sensor().is_none() {
        let codes = spec.motor.hall_codes.map(|code| format!("{code:03b}"));
        lines.push(format!(
            "| Hall code `Ha Hb Hc`, Ha in bit 2 | {} |",
            codes.join(" | ")
        ));
    }
    lines.extend([
        format!(
            "| current into, out of phase (positive set-point) | {} |",
            pairs().join(" | ")
        ),
        format!(
            "| begins at (forward, `theta_e`) | {} |",
            angles.join(" | ")
        ),
        String::new(),
        "More: `hexagen::conventions`.".to_owned(),
    ]);
    let [x, y, z] = named_phases(inverter);
    match inverter.sensed_phases {
        SensedPhases::Ab => {}
        SensedPhases::Abc => lines.extend(three_sensors(inverter)),
        SensedPhases::Bc | SensedPhases::Ca => lines.extend([
            String::new(),
            format!("The current of phase {z}, which has no sensor, is -(i_{x} + i_{y}); its count in the sample is ignored."),
        ]),
    }
    if spec.controller.has_intervals() {
        lines.extend([
            String::new(),
            "The command has three intervals, at whose ends legs turn on and off: the timer changes its output modes and enables by compare events.".to_owned(),
        ]);
    }
    lines.extend(rotor_sensor(spec));
    lines
}

/// What a sample says of the rotor, Hall codes at samples apart.
fn rotor_sensor(spec: &Spec) -> Vec<String> {
    let inverter = &spec.inverter;
    match inverter.rotor_sensing {
        RotorSensing::SampledHalls => vec![],
        RotorSensing::TimedHalls { ticks } => vec![
            String::new(),
            format!("`hall_ticks` is the time from the last Hall edge to the sample, counted at {} (`HALL_TIMER_HZ`), {} ticks", frequency(ticks / inverter.t_s), significant(ticks)),
            "in a control period. If an edge comes between the reading of code and ticks, the contradiction to the last period".to_owned(),
            "is detected, and the angle uses the expected time instead.".to_owned(),
        ],
        RotorSensing::Angle(sensor) => vec![
            String::new(),
            format!(
                "A sample has an angle (`Sample::with_angle`), 2^32 for a turn of the sensor: `theta_e` is {} times it, plus {} deg.",
                sensor.turns,
                significant(sensor.offset_deg)
            ),
            format!(
                "The speed is the difference of two angles, with a time constant of {} periods; a difference above {} deg is taken as that.",
                1 << spec.speed_filter(sensor),
                significant(f64::from(spec.greatest_turn(sensor)) * 360.0 / 32_f64.exp2())
            ),
        ],
    }
}

/// When control begins, and at which speed it may.
fn start(spec: &Spec, design: &LoopDesign) -> String {
    let told = match spec.inverter.bus {
        BusSource::Fixed => "",
        BusSource::Measured { .. } => ", once `set_bus` has told the bus voltage",
    };
    let speed = start_rpm(spec, design);
    match spec.start_periods() {
        0 => format!(
            "Control may begin on a rotor that turns at up to {speed} rpm, at set-point 0{told}."
        ),
        periods => format!(
            "A start keeps all legs off until {} in one direction tell the {}, and for {} where the rotor \
             stands or turns slowly; control may begin at up to {speed} rpm{told}.",
            if spec.angle_sensor().is_some() {
                "two sectors"
            } else {
                "two Hall edges"
            },
            if spec.angle_sensor().is_some() {
                "speed"
            } else {
                "angle"
            },
            engineering(f64::from(periods) * spec.inverter.t_s, "s")
        ),
    }
}

/// Steps and acceptance of the calibration, and what follows it.
fn calibration(inverter: &InverterSpec) -> String {
    let tolerance = f64::from(inverter.offset_tolerance) * inverter.adc_gain.abs();
    let precharge = match inverter.precharge_periods {
        0 => "no pre-charge follows".to_owned(),
        periods => format!("{periods} steps of pre-charge follow"),
    };
    format!(
        "`calibrate()` takes {} steps and accepts offsets within {} of the nominal one; {precharge}.",
        1_u32 << inverter.calibration_log2,
        engineering(tolerance, "A")
    )
}

/// What trips the drive, the bus apart, and what is bridged.
fn trips(spec: &Spec) -> Vec<String> {
    let inverter = &spec.inverter;
    let mut lines = vec![format!(
        "A phase current above {} trips the drive.",
        engineering(inverter.trip_current, "A")
    )];
    if let Some(periods) = spec.controller.common().residual_periods {
        lines.push(format!(
            "It also trips when periods in which the currents do not follow the voltages outnumber the others by {periods}."
        ));
        let allowance = Allowance::of(spec);
        let rated = spec.motor.rated_speed * f64::from(spec.motor.pole_pairs);
        let [still, turning] = [0.0, rated]
            .map(|omega_e| engineering(allowance.at(inverter.max_current, omega_e), "V"));
        lines.push(format!(
            "They may be off by {still} at standstill and by {turning} at rated speed, with `max_current`: a smaller fault is not seen."
        ));
    }
    lines.push(match inverter.stall_periods {
        0 => "A stalled rotor does not (`stall_timeout` is off).".to_owned(),
        periods => {
            let edge = if spec.angle_sensor().is_some() {
                "in one sector"
            } else {
                "without a Hall edge"
            };
            format!("It also trips after {periods} periods {edge} while the set-point is not 0.")
        }
    });
    lines.extend(over_speed(spec));
    lines.extend(field_weakening(spec));
    if spec.controller.common().learning.halls {
        lines.push("While the rotor turns steadily the drive learns how the Hall sensors stand against each other, and at up to a tenth of `max_current` how all stand against the EMF: up to 15 electrical degrees, until `reset()`.".to_owned());
    }
    if spec.controller.common().learning.torque {
        lines.push("While the rotor turns and hardly any current flows the drive learns the torque constant, which `set_torque` uses: two thirds to 1.5 times the stated one, until `reset()`.".to_owned());
    }
    if inverter.hall_glitches > 0 {
        lines.push(format!(
            "A disturbed Hall code is bridged for {} samples in a row, and trips it then.",
            inverter.hall_glitches
        ));
    }
    lines
}

/// What field weakening does, and what a trip does where the EMF exceeds the bus.
fn field_weakening(spec: &Spec) -> Option<String> {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    if !spec.controller.common().field_weakening {
        return None;
    }
    let emf = inverter.maximum_speed * motor.emf_constant * motor.emf_shape.line_to_line_peak();
    let bus = inverter
        .bus_clamp
        .unwrap_or_else(|| inverter.greatest_bus());
    let rectified = (emf - bus) / (2.0 * motor.resistance);
    let danger = if rectified > 0.0 {
        format!(
            "; at {} the EMF is {}, and a trip or `coast()` drives up to {} into the bus, which its clamp holds at {}",
            rpm(inverter.maximum_speed),
            engineering(emf, "V"),
            engineering(rectified, "A"),
            engineering(bus, "V"),
        )
    } else {
        String::new()
    };
    let most = (360.0 * MOST_TURN).round();
    Some(format!(
        "Where the bus voltage ends, the current turns against the field by up to {most} degrees, with up to `max_current` whatever the set-point{danger}."
    ))
}

/// The speed that trips the drive, and how well it is measured.
fn over_speed(spec: &Spec) -> Option<String> {
    let InverterSpec {
        over_speed, t_s, ..
    } = spec.inverter;
    let speed = over_speed?;
    let turn = TAU / (speed * f64::from(spec.motor.pole_pairs));
    let unsure = match spec.inverter.rotor_sensing {
        RotorSensing::SampledHalls => format!(
            ", where a turn is measured to a control period, {}",
            percent(t_s / turn)
        ),
        RotorSensing::TimedHalls { .. } => String::new(),
        RotorSensing::Angle(_) => {
            return Some(format!(
                "It also trips after {OVER_SPEED_EDGES} periods in a row at more than {}.",
                rpm(speed)
            ));
        }
    };
    Some(format!(
        "It also trips after {OVER_SPEED_EDGES} Hall edges in a row at which the last electrical turn was faster than {}{unsure}.",
        rpm(speed)
    ))
}

/// What `brake()` does, by the speed.
fn brake(spec: &Spec) -> String {
    match spec.brake_periods() {
        0 => "At any speed `brake()` shorts the motor, which takes at most `max_current` then."
            .to_owned(),
        periods => {
            let sector = FRAC_PI_3 * spec.motor.widest_sector();
            let electrical = sector / (f64::from(periods) * spec.inverter.t_s);
            format!(
                "Up to {} `brake()` shorts the motor; above, it opposes the rotation.",
                rpm(electrical / f64::from(spec.motor.pole_pairs))
            )
        }
    }
}

/// Fades, trips and limits of a measured bus.
fn measured_bus(inverter: &InverterSpec) -> Vec<String> {
    let BusSource::Measured {
        min,
        max,
        under,
        over,
        braking,
        motoring,
        ..
    } = inverter.bus
    else {
        return vec![];
    };
    let mut lines = vec![];
    for (fade, what) in [(braking, "Braking"), (motoring, "Motoring")] {
        if let Some(fade) = fade {
            lines.push(format!(
                "{what} torque falls from {} to 0 at {} of the bus.",
                engineering(fade.full, "V"),
                engineering(fade.none, "V")
            ));
        }
    }
    let levels = [(over, "above"), (under, "below")].into_iter();
    let levels: Vec<String> = levels
        .filter(|(level, _)| *level > 0.0)
        .map(|(level, way)| format!("{way} {}", engineering(level, "V")))
        .collect();
    if !levels.is_empty() {
        lines.push(format!(
            "A bus voltage {} trips it, when `set_bus` tells so.",
            levels.join(" or ")
        ));
    }
    lines.push(format!(
        "The bus voltage is {} until the first `set_bus`, and clamped to {} to {}.",
        engineering(inverter.v_bus, "V"),
        engineering(min, "V"),
        engineering(max, "V")
    ));
    lines
}

/// Limits of the bus current.
fn bus_current(inverter: &InverterSpec) -> Vec<String> {
    let mut lines = vec![];
    let BusCurrents { drawn, returned } = inverter.bus_currents;
    for (most, what) in [
        (drawn, "drawn from the supply"),
        (returned, "returned to it"),
    ] {
        if let Some(most) = most {
            lines.push(format!(
                "The set-point is taken back where more than {} would be {what}, in the mean over some periods.",
                engineering(most, "A")
            ));
        }
    }
    lines
}

/// Start-up and trips, with the drive's numbers.
pub fn supervision(spec: &Spec, design: &LoopDesign) -> Vec<String> {
    let mut lines = vec![
        String::new(),
        "# Start-up and faults".to_owned(),
        String::new(),
        calibration(&spec.inverter),
        start(spec, design),
    ];
    lines.extend(trips(spec));
    lines.push(brake(spec));
    lines.extend(measured_bus(&spec.inverter));
    lines.extend(bus_current(&spec.inverter));
    lines.push("What the supervisor cannot see: `hexagen::Supervisor`.".to_owned());
    lines
}
