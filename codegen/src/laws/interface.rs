//! Interface of an emitted controller: documentation, tables and associated constants.

use super::Description;
use super::accuracy::accuracy_notes;
use super::constants::{constants, ratios};
use super::current_loop::{LoopDesign, RESIDUAL_COUNT};
use super::{operation, supervision};
use crate::blocks::{HALL_SHIFTS, OVER_SPEED_COUNT, OVER_SPEED_EDGES, Scale, TORQUE_RATIO};
use crate::diagnostics::{engineering, frequency, percent, rpm};
use crate::interface::{Interface, OptionEntry, PublicConstant, Unit, Units, Watch};
use crate::scaling::Scaled;
use crate::spec::{
    ControllerSpec, CurrentSensing, EmfSource, Envelope, Origins, Reference, RotorSensing, Rule,
    Spec, SpeedLoop,
};
use crate::timing::{self, Asked};

/// Builds the interface of a scaled controller.
pub fn interface(
    (spec, origins): (&Spec, &Origins),
    design: &LoopDesign,
    scaled: &Scaled,
    law: &Description,
    accuracy: Vec<PublicConstant>,
) -> Interface {
    let inverter = &spec.inverter;
    let core = spec.controller.common().core;
    let spec_toml = spec.to_toml();
    let asked = Asked {
        spec_toml: &spec_toml,
        target: core.name(),
        clock: core.clock,
        period: inverter.t_s,
        learns_halls: spec.controller.common().learning.halls,
    };
    let times = timing::of_step(scaled.graph.program(), asked);
    Interface {
        type_name: spec.name.clone(),
        doc: documentation(spec, design, law),
        header: header(design, scaled),
        spec_toml,
        envelope: envelope(spec),
        times,
        options: options(spec, origins),
        formats: scaled.formats.clone(),
        constants: constants(spec, design, law, accuracy),
        delay: spec.controller.common().delay,
        timer_capture: matches!(inverter.rotor_sensing, RotorSensing::TimedHalls { .. }),
        bus_periods: inverter.bus_periods().map(|periods| periods as i32),
        residual: (spec.controller.common().residual_periods).map(|periods| Watch {
            word: RESIDUAL_COUNT,
            most: periods as i32,
        }),
        over_speed: inverter.over_speed.map(|_| Watch {
            word: OVER_SPEED_COUNT,
            most: OVER_SPEED_EDGES,
        }),
        hall_shifts: (spec.controller.common().learning.halls).then_some(HALL_SHIFTS),
        torque_ratio: (spec.controller.common().learning.torque).then_some(TORQUE_RATIO),
        limits: supervision::limits(spec, scaled.scale),
        units: units(spec, scaled.scale),
    }
}

fn units(spec: &Spec, scale: Scale) -> Units {
    // The speed loop works with the angle per tick, all else with the angle per control period.
    let per_period = match spec.controller.common().speed {
        Some(_) => spec.inverter.rotor_sensing.ticks_per_period(),
        None => 1.0,
    };
    let turns = per_period / spec.inverter.t_s / 32_f64.exp2() / f64::from(spec.motor.pole_pairs);
    Units {
        ampere: Unit::of(1.0 / scale.current()),
        volt: Unit::of(1.0 / scale.voltage()),
        volt_per_count: Unit::of(scale.volt_per_count),
        rpm: Unit::of(60.0 * turns),
        sectors: spec.hall_sectors(),
    }
}

/// Shares of the rated speed at which the data sheet has the greatest torque.
const SHARES: [f64; 6] = [0.25, 0.5, 0.75, 1.0, 1.25, 1.5];

fn envelope(spec: &Spec) -> Vec<[f64; 2]> {
    let envelope = Envelope::of(spec);
    let speeds = SHARES.map(|share| share * spec.motor.rated_speed);
    let points = speeds.map(|omega_m| [omega_m, envelope.torque(omega_m)]);
    points.to_vec()
}

fn options(spec: &Spec, origins: &Origins) -> Vec<OptionEntry> {
    let lines = spec.controller.lines().into_iter();
    let entry = |(rule, value): (&'static Rule, String)| {
        let is_given = origins.is_given(&format!("controller.{}", rule.name));
        OptionEntry {
            name: rule.name,
            reason: rule.reason(&value).filter(|_| !is_given),
            value,
            meaning: rule.about,
            is_choice: rule.is_choice(),
        }
    };
    let effective = lines.filter(|(rule, _)| has_effect(rule.name, &spec.controller));
    effective.map(entry).collect()
}

/// Whether an option changes anything of this controller: without a leg that is turned off no commutation is timed,
/// and no other EMF source than the estimate is filtered.
fn has_effect(option: &str, controller: &ControllerSpec) -> bool {
    let common = controller.common();
    let turns_off = controller.turns_off().is_some();
    match option {
        "commutation_threshold" | "commutation_timeout" => turns_off,
        "advance" => turns_off || common.reference == Reference::QuasiSquare,
        "emf_filter" => common.emf == EmfSource::Estimated,
        _ => true,
    }
}

fn documentation(spec: &Spec, design: &LoopDesign, law: &Description) -> Vec<String> {
    let motor = &spec.motor;
    let name = if motor.description.is_empty() {
        "BLDC motor".to_owned()
    } else {
        motor.description.clone()
    };
    let mut doc = vec![format!("{}: {name}.", law.title), String::new()];
    doc.extend(motor_and_inverter(spec));
    if !law.notes.is_empty() {
        doc.extend([String::new(), "# Method".to_owned(), String::new()]);
        doc.extend(law.notes.iter().cloned());
    }
    if let Some(stable) = law.stable {
        doc.extend([
            format!(
                "The loop is stable while the true inductance is {} of the stated one, and while the true resistance",
                ratios(stable.inductance)
            ),
            format!("is {} (one off at a time).", ratios(stable.resistance)),
        ]);
    }
    if let Some(speed) = spec.controller.common().speed {
        doc.extend(speed_loop(speed, spec));
    }
    doc.extend(accuracy_notes());
    doc.extend(operation::wiring(spec));
    doc.extend(operation::supervision(spec, design));
    doc
}

/// The machine and its inverter.
fn motor_and_inverter(spec: &Spec) -> Vec<String> {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let mut lines = vec![
        format!(
            "Motor: {} pole pair{}, R = {}, L = {} per phase, EMF constant {} (phase peak), rated {} at {}.",
            motor.pole_pairs,
            if motor.pole_pairs == 1 { "" } else { "s" },
            engineering(motor.resistance, "ohm"),
            engineering(motor.inductance, "H"),
            engineering(motor.emf_constant, "V s/rad"),
            engineering(motor.rated_current, "A"),
            rpm(motor.rated_speed),
        ),
        format!(
            "Inverter: {} bus, PWM of {} (period {}, timer of {} counts), {}-bit ADC with {} per count, trip at {}.",
            engineering(inverter.v_bus, "V"),
            frequency(1.0 / inverter.pwm_period()),
            engineering(inverter.pwm_period(), "s"),
            inverter.timer_period,
            inverter.adc_bits,
            engineering(inverter.adc_gain, "A"),
            engineering(inverter.trip_current, "A"),
        ),
    ];
    lines.push(format!(
        "By this EMF constant the motor turns at {} without load on that bus, in block commutation.",
        rpm(motor.no_load_speed(inverter.v_bus)),
    ));
    lines.push(current_sensors(spec));
    if inverter.pwm_per_control > 1 {
        lines.push(format!(
            "Control at {} (period {}): each command is held for {} periods of the PWM.",
            frequency(1.0 / inverter.t_s),
            engineering(inverter.t_s, "s"),
            inverter.pwm_per_control,
        ));
    }
    lines
}

/// Where the phase currents are measured, and what that leaves of the bus.
fn current_sensors(spec: &Spec) -> String {
    let inverter = &spec.inverter;
    let place = match inverter.current_sensing {
        CurrentSensing::InPhase => "in the phases",
        CurrentSensing::LowSide(_) => "in the low legs of",
    };
    let phases = inverter.sensed_phases.phases().iter();
    let phases: Vec<&str> = phases.map(|phase| ["a", "b", "c"][*phase]).collect();
    let instant = spec.sampling_instant();
    let instant = instant.map_or(String::new(), |instant| format!(", sampled {instant}"));
    let sensors = format!("Current sensors: {place} {}{instant}", phases.join(", "));
    let share = spec.reach_share();
    if share >= 1.0 {
        return format!("{sensors}.");
    }
    format!(
        "{sensors}; legs that must be low for a while reach {} between them, {} of the bus.",
        engineering(inverter.v_bus * share, "V"),
        percent(share)
    )
}

/// Documentation of the speed regulator.
fn speed_loop(speed: SpeedLoop, spec: &Spec) -> [String; 8] {
    let delay = match spec.angle_sensor() {
        Some(sensor) => format!(
            "it holds any speed, for it has the speed from two angles in a row through a filter of {}.",
            engineering(
                sensor.filter_time(spec.motor.rated_frequency(), spec.inverter.t_s),
                "s"
            )
        ),
        None => format!(
            "below {} its delay makes the speed oscillate around the set-point: it has the mean of the last electrical turn, and four turns take 1/f there.",
            rpm(speed.least_speed(spec.motor.pole_pairs))
        ),
    };
    [
            String::new(),
            "# Speed loop".to_owned(),
            String::new(),
            format!(
                "A PI regulator with a bandwidth of {} sets the current: gain 2 pi f J/k_t with J = {}, integral time 4/(2 pi f), two real poles at half",
                engineering(speed.bandwidth, "Hz"),
                engineering(speed.inertia, "kg m2"),
            ),
            "the bandwidth (four times the inertia: half the damping). `set_speed` sets the speed, `set_current` and `set_torque` the greatest".to_owned(),
            "current. At that limit the integral tracks it, so a long run-up ends without overshoot; a step that does not".to_owned(),
            "reach it overshoots by 13.5 %, unless the set-point is a ramp.".to_owned(),
            format!("At low speed: {delay}"),
        ]
}

/// Generator version and scale.
fn header(design: &LoopDesign, scaled: &Scaled) -> Vec<String> {
    let scale = scaled.scale;
    vec![
        format!(
            "Generated by hexagen {} from `SPEC`.",
            env!("CARGO_PKG_VERSION")
        ),
        format!(
            "Words of current are {} (an ADC count of {} with {} fraction bits),",
            engineering(1.0 / scale.current(), "A"),
            engineering(scale.ampere_per_count, "A"),
            scale.current_bits
        ),
        format!(
            "words of voltage {} (a timer count of {} with {}).",
            engineering(1.0 / scale.voltage(), "V"),
            engineering(scale.volt_per_count, "V"),
            scale.voltage_bits
        ),
        format!(
            "A change of current is limited to {} per period.",
            engineering(design.di_limit, "A")
        ),
    ]
}
