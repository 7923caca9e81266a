//! Associated constants of the emitted type: specification, vectors, stable ranges.

use super::current_loop::{LoopDesign, StableRange};
use super::start::start_rpm;
use super::{Description, Period};
use crate::design::vectors::{THREE_PHASE, TWO_PHASE, leg_vector, svm_coefficients};
use crate::diagnostics::{engineering, percent, significant};
use crate::interface::{PublicConstant, PublicValue};
use crate::spec::{InverterSpec, Reference, RotorSensing, Spec};
use nalgebra::Vector2;

/// All constants; `accuracy`: the proven error bounds.
pub(super) fn constants(
    spec: &Spec,
    design: &LoopDesign,
    law: &Description,
    accuracy: Vec<PublicConstant>,
) -> Vec<PublicConstant> {
    let mut list = drive_constants(spec, start_rpm(spec, design));
    list.extend(plant_constants(design));
    list.extend(vector_constants(
        &spec.inverter,
        super::law(&spec.controller).period(),
    ));
    list.extend(law.constants.iter().cloned());
    list.extend(accuracy);
    list.extend(law.stable.into_iter().flat_map(stable_constants));
    if let RotorSensing::TimedHalls { ticks } = spec.inverter.rotor_sensing {
        list.push(integer(
            "HALL_TIMER_HZ",
            "u32",
            (ticks / spec.inverter.t_s).round() as i64,
            &format!(
                "Clock of the Hall capture timer that counts `hall_ticks`, Hz: {} ticks in a control period.",
                significant(ticks)
            ),
        ));
    }
    list
}

fn drive_constants(spec: &Spec, start_rpm: i64) -> Vec<PublicConstant> {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let mut list = vec![
        integer(
            "POLE_PAIRS",
            "u32",
            i64::from(motor.pole_pairs),
            "Pole pairs.",
        ),
        integer(
            "T_S_NS",
            "u32",
            (inverter.t_s * 1e9).round() as i64,
            "Control period, rounded to ns.",
        ),
        integer(
            "TIMER_PERIOD",
            "u16",
            i64::from(inverter.timer_period),
            "Compare value of 100 % duty: top of the centre-aligned timer.",
        ),
    ];
    if inverter.pwm_per_control > 1 {
        list.push(integer(
            "PWM_PER_CONTROL",
            "u16",
            i64::from(inverter.pwm_per_control),
            "PWM periods in a control period: each command is held for so many.",
        ));
    }
    list.extend(adc_constants(inverter));
    list.extend([
        fixed("V_BUS", inverter.v_bus, "V", "Nominal bus voltage"),
        fixed("I_MAX", inverter.max_current, "A", "Largest set-point"),
        fixed(
            "I_TRIP",
            inverter.trip_current,
            "A",
            "Trip level of the phase currents",
        ),
        fixed(
            "TORQUE_CONSTANT",
            spec.torque_constant(),
            "Nm/A",
            about_torque_constant(spec.controller.common().reference),
        ),
        integer(
            "START_SPEED_RPM",
            "u32",
            start_rpm,
            "Greatest rotor speed at which control may begin without a trip, rpm, at a bus within its limits and set-point 0. After a start it holds for any set-point, with a trip level of at least 1.5 times `I_MAX`. (Pre-charge shorts the windings.)",
        ),
    ]);
    list
}

fn about_torque_constant(reference: Reference) -> &'static str {
    match reference {
        Reference::QuasiSquare => {
            "Torque per ampere of set-point, the plateau of a quasi-square current, k_t"
        }
        Reference::Proportional => {
            "Torque per ampere of set-point, the current of a phase where its EMF peaks, k_t"
        }
    }
}

fn adc_constants(inverter: &InverterSpec) -> [PublicConstant; 3] {
    let sensors = inverter.sensors();
    let is_one = sensors.iter().all(|sensor| *sensor == sensors[0]);
    [
        integer(
            "ADC_BITS",
            "u32",
            i64::from(inverter.adc_bits),
            "Bits of the phase-current ADCs.",
        ),
        fixed(
            "ADC_GAIN",
            inverter.adc_gain,
            "A",
            match (is_one, inverter.adc_gain < 0.0) {
                (true, false) => "Current into the motor per ADC count",
                (true, true) => {
                    "Current into the motor per ADC count, negative because counts fall with it"
                }
                (false, false) => "Current into the motor per ADC count, first sensor",
                (false, true) => {
                    "Current into the motor per ADC count, first sensor, negative because counts fall with it"
                }
            },
        ),
        integer(
            "ADC_OFFSET",
            "u16",
            i64::from(inverter.adc_offset),
            if is_one {
                "ADC count at zero current before calibration."
            } else {
                "ADC count at zero current before calibration, first sensor."
            },
        ),
    ]
}

fn plant_constants(design: &LoopDesign) -> [PublicConstant; 3] {
    [
        fixed(
            "POLE",
            design.plant.pole,
            "",
            "Pole a of the discrete plant i(k+1) = a i(k) + b (v(k) - e(k))",
        ),
        fixed(
            "GAIN",
            design.plant.gain,
            "A/V",
            "Gain b of the discrete plant",
        ),
        fixed("STIFFNESS", design.k_di, "V/A", "K = 1/b"),
    ]
}

/// The paper's vectors and (16) at the nominal bus.
fn vector_constants(inverter: &InverterSpec, period: Period) -> [PublicConstant; 3] {
    let v_bus = inverter.v_bus;
    let three = THREE_PHASE.map(|legs| leg_vector(legs, v_bus));
    let two = TWO_PHASE.map(|legs| leg_vector(legs, v_bus));
    let counts = f64::from(inverter.timer_period);
    let svm: Vec<Vector2<f64>> = (0..6)
        .flat_map(|n| svm_coefficients(n, v_bus))
        .map(|c| c * counts)
        .collect();
    [
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
                match period {
                    Period::Pulses => {
                        "For comparison: the step reaches the same times by min/max injection."
                    }
                    Period::Intervals => {
                        "The step uses these times in commutation; outside it those of pair vectors, with 2 in place of sqrt(3)."
                    }
                    Period::TwoVectors => {
                        "For comparison: the step divides a period between two vectors, not three."
                    }
                    Period::OneVector => {
                        "For comparison: the step applies whole vectors."
                    }
                }
                .to_owned(),
            ],
        ),
    ]
}

fn stable_constants(stable: StableRange) -> [PublicConstant; 2] {
    let text = |low_high: (f64, f64)| PublicValue::Text(ratios(low_high));
    [
        PublicConstant {
            name: "STABLE_INDUCTANCE".to_owned(),
            value: text(stable.inductance),
            doc: vec!["True over stated inductance with a stable loop.".to_owned()],
        },
        PublicConstant {
            name: "STABLE_RESISTANCE".to_owned(),
            value: text(stable.resistance),
            doc: vec!["True over stated resistance with a stable loop.".to_owned()],
        },
    ]
}

fn integer(name: &str, rust_type: &'static str, value: i64, doc: &str) -> PublicConstant {
    PublicConstant {
        name: name.to_owned(),
        value: PublicValue::Integer { rust_type, value },
        doc: vec![doc.to_owned()],
    }
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

/// Fraction bits at which `largest` fits a 32-bit word.
pub(super) fn fraction_bits(largest: f64) -> u32 {
    (30.0 - largest.abs().max(1e-9).log2())
        .floor()
        .clamp(0.0, 31.0) as u32
}

pub(super) fn ratios((low, high): (f64, f64)) -> String {
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
