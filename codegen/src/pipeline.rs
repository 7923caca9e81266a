//! The pipeline behind all front ends: checked specification in, verified graph and interface out.

use crate::controllers::{ControllerSpec, pdcc};
use crate::diagnostics::{Collector, Diagnostic, Diagnostics, catalogue};
use crate::interface::Interface;
use crate::ir::VerifiedGraph;
use crate::scaling::{Scaled, Unscalable, choose_scale};
use crate::spec::{Origins, Spec};

/// What emitters take.
#[derive(Clone, Debug, PartialEq)]
pub struct Generated {
    /// The verified program.
    pub graph: VerifiedGraph,
    /// Names, documentation and fixed numbers.
    pub interface: Interface,
}

/// Designs, scales, lowers and verifies one controller.
///
/// # Errors
/// Diagnostics of the design (stability) and of scaling (word too narrow), located by `origins`.
pub fn generate(spec: &Spec, origins: &Origins) -> Result<Generated, Diagnostics> {
    let ControllerSpec::Pdcc(options) = &spec.controller;
    let design = pdcc::PdccDesign::new(spec, options);
    let scaled = choose_scale(&spec.inverter, options.word, |scale| {
        pdcc::lower(spec, options, &design, scale)
    })
    .map_err(|why| Diagnostics::from(unscalable(&why, options.word, origins)))?;
    let mut errors = Collector::new();
    let rounded = design.rounded(&scaled);
    let stable = check_stability(spec, options, &rounded, origins, &mut errors);
    let interface = pdcc::interface(spec, &design, &scaled, stable);
    let Scaled { graph, .. } = scaled;
    errors.into_result(Generated { graph, interface })
}

fn unscalable(why: &Unscalable, word: u32, origins: &Origins) -> Diagnostic {
    let at = origins.at("controller.word");
    match why {
        Unscalable::TooNarrow { signal, bits } => {
            catalogue::word_too_narrow(at, signal, *bits, word)
        }
        Unscalable::Broken(violations) => {
            let list: Vec<String> = violations.iter().map(ToString::to_string).collect();
            catalogue::internal(at, &list.join("; "))
        }
    }
}

fn check_stability(
    spec: &Spec,
    options: &pdcc::PdccSpec,
    design: &pdcc::PdccDesign,
    origins: &Origins,
    errors: &mut Collector,
) -> pdcc::StableRange {
    let radius = design.spectral_radius(spec, options, 1.0, 1.0);
    let stable = pdcc::StableRange {
        inductance: design.stable_inductance(spec, options),
        resistance: design.stable_resistance(spec, options),
    };
    if radius >= 1.0 {
        let path = if options.emf_filter < 1.0 {
            "controller.emf_filter"
        } else {
            "controller.discretisation"
        };
        let given = origins.given(path, "the setting");
        errors.push(catalogue::unstable_loop(
            origins.at(path),
            path.trim_start_matches("controller."),
            &given,
            radius,
        ));
        return stable;
    }
    let leaves = |tolerance: f64, (low, high): (f64, f64)| {
        // The search ends at 0.1 and 10; beyond it nothing is known to be unstable.
        (1.0 - tolerance < low && low > 0.1) || (1.0 + tolerance > high && high < 10.0)
    };
    let motor = &spec.motor;
    if leaves(motor.inductance_tolerance, stable.inductance) {
        let path = "motor.inductance_tolerance";
        let given = origins.given(
            path,
            &crate::diagnostics::percent(motor.inductance_tolerance),
        );
        errors.push(catalogue::inductance_outside_stable_range(
            origins.at(path),
            &given,
            stable.inductance.0,
            stable.inductance.1,
        ));
    }
    if leaves(motor.resistance_tolerance, stable.resistance) {
        let path = "motor.resistance_tolerance";
        let given = origins.given(
            path,
            &crate::diagnostics::percent(motor.resistance_tolerance),
        );
        errors.push(catalogue::resistance_outside_stable_range(
            origins.at(path),
            &given,
            stable.resistance.0,
            stable.resistance.1,
        ));
    }
    stable
}

#[cfg(test)]
mod tests {
    use super::generate;
    use crate::spec::{apply_variant, check, parse_toml};

    const MOTOR: &str = r#"
[motor]
description = "660 W"
pole_pairs = 4
resistance = "0.135 ohm per_phase"
inductance = "0.22 mH per_phase"
winding = "star"
back_emf = "0.1648 V/(rad/s) line_to_line peak"
emf_shape = "trapezoidal"
rated_current = "20 A"
rated_torque = "3.3 Nm"
rated_speed = "2000 rpm"
[inverter]
bus_voltage = "48 V"
f_pwm = "20 kHz"
timer_clock = "72 MHz"
adc_bits = 12
adc_range = "40 A"
hall_timer_clock = "1 MHz"
[controller]
kind = "pdcc"
"#;

    #[test]
    fn every_variant_of_the_paper_motor_generates_or_is_refused() {
        let mut generated = 0;
        for modulation in ["three_phase", "pair"] {
            for saturation in ["keep_angle", "nearest", "torque_priority"] {
                for emf in ["emf=estimated", "emf=model", "emf=estimated,emf_filter=0.7"] {
                    for reference in ["quasi_square", "proportional"] {
                        for advance in ["0", "1.5"] {
                            for rest in [
                                "delay=1,word=32",
                                "delay=0,word=32",
                                "delay=1,word=16",
                                "delay=1,hall_capture=timer",
                            ] {
                                let variant = format!(
                                    "pdcc:modulation={modulation},saturation={saturation},{emf},reference={reference},advance={advance},{rest}"
                                );
                                let mut ast =
                                    parse_toml(MOTOR, "motor.toml").expect("the motor parses");
                                apply_variant(&mut ast, &variant).expect("the variant parses");
                                let Ok((spec, origins)) = check(&ast) else {
                                    continue;
                                };
                                match generate(&spec, &origins) {
                                    Ok(_) => generated += 1,
                                    Err(errors) => panic!("{variant}: {errors}"),
                                }
                            }
                        }
                    }
                }
            }
        }
        assert!(generated > 200, "{generated}");
    }
}
