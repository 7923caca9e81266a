//! What users see of an emitted controller: documentation, tables and associated constants.

use super::accuracy::accuracy_notes;
use super::current_loop::LoopDesign;
use super::operation;
use super::start::start_rpm;
use super::{Description, Period};
use crate::blocks::Scale;
use crate::design::vectors::{THREE_PHASE, TWO_PHASE, leg_vector, svm_coefficients};
use crate::diagnostics::{engineering, frequency, percent, rpm, significant};
use crate::interface::{Interface, Limits, OptionEntry, PublicConstant, PublicValue, Unit, Units};
use crate::scaling::Scaled;
use crate::spec::{HallCapture, InverterSpec, Rule, Spec};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Builds the interface of a scaled controller.
pub fn interface(
    spec: &Spec,
    design: &LoopDesign,
    scaled: &Scaled,
    law: &Description,
    accuracy: Vec<PublicConstant>,
) -> Interface {
    let inverter = &spec.inverter;
    Interface {
        type_name: spec.name.clone(),
        doc: documentation(spec, design, law),
        header: header(design, scaled),
        spec_toml: spec.to_toml(),
        options: options(spec),
        formats: scaled.formats.clone(),
        constants: constants(spec, design, law, accuracy),
        delay: spec.controller.common().delay,
        timer_capture: matches!(inverter.hall_capture, HallCapture::Timer { .. }),
        bus_periods: inverter.bus_periods().map(|periods| periods as i32),
        limits: limits(inverter, scaled.scale),
        units: units(spec, scaled.scale),
    }
}

fn limits(inverter: &InverterSpec, scale: Scale) -> Limits {
    let words = |counts: i32| counts << scale.current_bits;
    Limits {
        adc_max: inverter.adc_max() as u16,
        adc_inverted: inverter.adc_gain < 0.0,
        current_bits: scale.current_bits,
        offset: inverter.adc_offset as u16,
        offsets: inverter.offsets().map(|offset| offset as u16),
        trip: (inverter.trip_current * scale.current() + 0.5).floor() as i32,
        currents: inverter.current_counts().map(words),
        calibration_log2: inverter.calibration_log2,
        precharge_periods: inverter.precharge_periods as u16,
        stall_periods: inverter.stall_periods as i32,
    }
}

fn units(spec: &Spec, scale: Scale) -> Units {
    // A speed loop goes by the angle per tick, all else by the one per control period.
    let per_period = match spec.controller.common().speed {
        Some(_) => spec.inverter.hall_capture.ticks_per_period(),
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

fn ratios((low, high): (f64, f64)) -> String {
    let bound = |ratio: f64| {
        if ratio <= 0.1 {
            "10 % or less".to_owned()
        } else if ratio >= 10.0 {
            "1000 % or more".to_owned()
        } else {
            percent(ratio)
        }
    };
    format!("{} to {}", bound(low), bound(high))
}

fn options(spec: &Spec) -> Vec<OptionEntry> {
    let lines = spec.controller.lines().into_iter();
    let entry = |(rule, value): (&'static Rule, String)| OptionEntry {
        name: rule.name,
        value,
        meaning: rule.about,
    };
    lines.map(entry).collect()
}

fn documentation(spec: &Spec, design: &LoopDesign, law: &Description) -> Vec<String> {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let name = if motor.description.is_empty() {
        "BLDC motor".to_owned()
    } else {
        motor.description.clone()
    };
    let mut doc = vec![
        format!("{}: {name}.", law.title),
        String::new(),
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
            frequency(1.0 / inverter.t_s),
            engineering(inverter.t_s, "s"),
            inverter.timer_period,
            inverter.adc_bits,
            engineering(inverter.adc_gain, "A"),
            engineering(inverter.trip_current, "A"),
        ),
    ];
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
        doc.extend([
            String::new(),
            "# Speed loop".to_owned(),
            String::new(),
            format!(
                "A PI regulator of {} asks for the current: gain 2 pi f J/k_t with J = {}, integral time 4/(2 pi f), for two real poles at half",
                engineering(speed.bandwidth, "Hz"),
                engineering(speed.inertia, "kg m2"),
            ),
            "the bandwidth (four times the inertia: half the damping). `set_speed` sets the speed, `set_current` and `set_torque` the greatest".to_owned(),
            "current that it asks for. Where that is reached the integral follows it, so a long run-up ends without overshoot; a step that does not".to_owned(),
            "reach it overshoots by 13.5 %, unless the set-point is a ramp. The speed is the mean of the last electrical turn: below".to_owned(),
            format!(
                "{}, four turns in the time 1/f, the mean comes too late for the loop, and the speed swings around the set-point.",
                rpm(4.0 * speed.bandwidth / f64::from(motor.pole_pairs) * TAU)
            ),
        ]);
    }
    doc.extend(accuracy_notes());
    doc.extend(operation::wiring(spec));
    doc.extend(operation::supervision(spec, design));
    doc
}

/// What a controller was made of.
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
            "A change of current of more than {} in a period is not believed.",
            engineering(design.di_limit, "A")
        ),
    ]
}

/// Fraction bits at which `largest` fits a 32-bit word.
pub(super) fn fraction_bits(largest: f64) -> u32 {
    (30.0 - largest.abs().max(1e-9).log2())
        .floor()
        .clamp(0.0, 31.0) as u32
}

fn fixed(name: &str, value: f64, unit: &str, doc: &str) -> PublicConstant {
    let frac_bits = fraction_bits(value);
    let bits = (value * f64::from(frac_bits).exp2()).round() as i32;
    let error = f64::from(bits) / f64::from(frac_bits).exp2() - value;
    let error = if error == 0.0 {
        "exact".to_owned()
    } else {
        format!("{error:.1e} off")
    };
    PublicConstant {
        name: name.to_owned(),
        value: PublicValue::Fixed { bits, frac_bits },
        doc: vec![format!(
            "{doc}: {}; {frac_bits} fraction bits, {error}.",
            engineering(value, unit)
        )],
    }
}

fn vectors(name: &str, list: &[Vector2<f64>], doc: Vec<String>) -> PublicConstant {
    let largest = list.iter().map(Vector2::amax).fold(0.0, f64::max);
    let frac_bits = fraction_bits(largest);
    let scale = f64::from(frac_bits).exp2();
    let bits = list
        .iter()
        .map(|v| [(v.x * scale).round() as i32, (v.y * scale).round() as i32])
        .collect();
    PublicConstant {
        name: name.to_owned(),
        value: PublicValue::Vectors { bits, frac_bits },
        doc,
    }
}

fn integer(name: &str, rust_type: &'static str, value: i64, doc: &str) -> PublicConstant {
    PublicConstant {
        name: name.to_owned(),
        value: PublicValue::Integer { rust_type, value },
        doc: vec![doc.to_owned()],
    }
}

fn constants(
    spec: &Spec,
    design: &LoopDesign,
    law: &Description,
    accuracy: Vec<PublicConstant>,
) -> Vec<PublicConstant> {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let v_bus = inverter.v_bus;
    let three: Vec<Vector2<f64>> = THREE_PHASE
        .iter()
        .map(|&legs| leg_vector(legs, v_bus))
        .collect();
    let two: Vec<Vector2<f64>> = TWO_PHASE
        .iter()
        .map(|&legs| leg_vector(legs, v_bus))
        .collect();
    let period = f64::from(inverter.timer_period);
    let svm: Vec<Vector2<f64>> = (0..6)
        .flat_map(|n| svm_coefficients(n, v_bus))
        .map(|c| c * period)
        .collect();
    let text = |low_high: (f64, f64)| PublicValue::Text(ratios(low_high));
    let mut list = vec![
        integer("POLE_PAIRS", "u32", i64::from(motor.pole_pairs), "Pole pairs."),
        integer("T_S_NS", "u32", (inverter.t_s * 1e9).round() as i64, "Control period, rounded to ns."),
        integer("TIMER_PERIOD", "u16", i64::from(inverter.timer_period), "Compare value of 100 % duty: top of the centre-aligned timer."),
        integer("ADC_BITS", "u32", i64::from(inverter.adc_bits), "Bits of the phase-current converters."),
        fixed("ADC_GAIN", inverter.adc_gain, "A", if inverter.adc_gain < 0.0 { "Current into the motor per ADC count, negative because counts fall with it" } else { "Current into the motor per ADC count" }),
        integer("ADC_OFFSET", "u16", i64::from(inverter.adc_offset), "ADC count at zero current, where calibration has not told another."),
        fixed("V_BUS", v_bus, "V", "Nominal bus voltage"),
        fixed("I_MAX", inverter.max_current, "A", "Largest set-point"),
        fixed("I_TRIP", inverter.trip_current, "A", "Trip level of the phase currents"),
        fixed("TORQUE_CONSTANT", spec.torque_constant(), "Nm/A", "Torque per ampere of set-point, k_t"),
        integer("START_SPEED_RPM", "u32", start_rpm(spec, design), "Greatest speed of the rotor at which control may begin, at set-point 0 and a bus within its limits, rpm: no sampled current reaches the trip level. (Pre-charge shorts the windings.)"),
        fixed("POLE", design.plant.pole, "", "Pole a of the discrete plant i(k+1) = a i(k) + b (v(k) - e(k))"),
        fixed("GAIN", design.plant.gain, "A/V", "Gain b of the discrete plant"),
        fixed("STIFFNESS", design.k_di, "V/A", "K = 1/b"),
        vectors(
            "THREE_PHASE_VECTORS",
            &three,
            vec!["Vectors V1 to V6 at the nominal bus, (alpha, beta) in volt: the commutation vectors of the paper's Table 2; sector S_k takes V_(k+1).".to_owned()],
        ),
        vectors(
            "TWO_PHASE_VECTORS",
            &two,
            vec!["Vectors V12 to V61 at the nominal bus, (alpha, beta) in volt: the vectors of Table 2 outside commutation; sector S_k takes V_(k,k+1).".to_owned()],
        ),
        vectors(
            "SVM_COEFFICIENTS",
            &svm,
            vec![
                "Coefficients of the paper's (16), timer counts per volt of (v_alpha, v_beta): t_a and t_b in turn for voltage sectors 1 to 6.".to_owned(),
                String::new(),
                match super::law(&spec.controller).period() {
                    Period::Pulses => {
                        "The step reaches the same times by min/max injection, which needs none of them."
                    }
                    Period::TwoVectors => {
                        "The step divides a period between two vectors, not three: these times are for comparison."
                    }
                    Period::OneVector => {
                        "The step applies whole vectors and modulates none: these times are for comparison."
                    }
                }
                .to_owned(),
            ],
        ),
    ];
    list.extend(law.constants.iter().cloned());
    list.extend(accuracy);
    if let Some(stable) = law.stable {
        list.extend([
            PublicConstant {
                name: "STABLE_INDUCTANCE".to_owned(),
                value: text(stable.inductance),
                doc: vec![
                    "True over stated inductance within which the loop is stable.".to_owned(),
                ],
            },
            PublicConstant {
                name: "STABLE_RESISTANCE".to_owned(),
                value: text(stable.resistance),
                doc: vec![
                    "True over stated resistance within which the loop is stable.".to_owned(),
                ],
            },
        ]);
    }
    if let HallCapture::Timer { ticks } = inverter.hall_capture {
        list.push(integer(
            "HALL_TIMER_HZ",
            "u32",
            (ticks / inverter.t_s).round() as i64,
            &format!(
                "Clock of the Hall capture timer that counts `hall_ticks`, Hz: {} ticks in a control period.",
                significant(ticks)
            ),
        ));
    }
    list
}
