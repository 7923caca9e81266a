//! The pipeline: from a checked specification to a verified graph and its interface.

use crate::at_once::at_once;
use crate::design::weakening::last_speed;
use crate::diagnostics::{
    Code, Collector, Diagnostic, Diagnostics, catalogue, engineering, percent, rpm,
};
use crate::interface::Interface;
use crate::ir::VerifiedGraph;
use crate::laws::current_loop::{LinearLoop, LoopDesign, SEARCHED};
use crate::laws::{
    Allowance, Cause, Period, StableRange, accuracy_constants, interface, law, narrow_words,
    trust_in_estimate, wide_words,
};
use crate::scaling::{Scaled, Unscalable, choose_scale};
use crate::spec::health::TRIP_BY_DEFAULT;
use crate::spec::{Envelope, InverterSpec, Origins, Spec};
use crate::stopwatch::Part;
use crate::timing::StepTime;

/// Input of the emitters.
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
    Part::Design.timed(|| {
        if spec.controller.common().word_by_target {
            by_target(spec, origins)
        } else {
            designed(spec, origins)
        }
    })
}

/// Words of the target's length if they suffice, else of 32 bits; documented in the type.
fn by_target(spec: &Spec, origins: &Origins) -> Result<Generated, Diagnostics> {
    let wide = Spec {
        controller: spec.controller.clone().with_word(32),
        ..spec.clone()
    };
    let mut wide = designed(&wide, origins)?;
    match designed(spec, origins) {
        Ok(mut narrow) => {
            narrow
                .interface
                .doc
                .extend(narrow_words(&narrow.interface, &wide.interface));
            Ok(narrow)
        }
        Err(reasons) => {
            let reasons = reasons
                .as_slice()
                .iter()
                .map(|reason| reason.message.as_str());
            let reasons: Vec<&str> = reasons.collect();
            wide.interface.doc.extend(wide_words(&reasons.join("; ")));
            Ok(wide)
        }
    }
}

fn designed(spec: &Spec, origins: &Origins) -> Result<Generated, Diagnostics> {
    let common = spec.controller.common();
    let design = LoopDesign::new(spec, common);
    let law = law(&spec.controller);
    let scaled = choose_scale(&spec.inverter, common.word, |scale| {
        law.lower(spec, &design, scale)
    })
    .map_err(|why| Diagnostics::from(unscalable(&why, common.word, origins)))?;
    let rounded = design.rounded(&scaled);
    let mut errors = Collector::new();
    let description = || {
        match law.period() {
            Period::Pulses | Period::Intervals => {}
            Period::TwoVectors => check_miss(spec, &design, origins, &mut errors),
            Period::OneVector => check_stride(spec, &design, origins, &mut errors),
        }
        let linear = law.linear(spec, &rounded);
        let stable =
            linear.map(|linear| check_stability(spec, linear.as_ref(), origins, &mut errors));
        law.describe(spec, &design, stable)
    };
    let accuracy = || accuracy_constants(scaled.graph.program(), &spec.inverter);
    let (accuracy, description) = at_once(accuracy, description);
    let interface = interface((spec, origins), &design, &scaled, &description, accuracy);
    let Scaled { graph, .. } = scaled;
    errors.into_result(Generated { graph, interface })
}

/// Warnings about a drive that is generated nevertheless, with its step's time on its target.
pub fn warnings(spec: &Spec, origins: &Origins, times: &[StepTime]) -> Vec<Diagnostic> {
    let mut warnings = origins.warnings().to_vec();
    if law(&spec.controller).loses_current() {
        warnings.push(catalogue::printed_table(origins.at("controller.table")));
    }
    // Round numbers in a specification may lie exactly on the limit.
    if let Some(trust) = trust_in_estimate(spec)
        && trust.turn > trust.limit * (1.0 + 1e-9)
    {
        warnings.push(catalogue::estimate_turns_too_far(
            origins.at("controller.emf"),
            &origins.given("controller.emf", "estimated"),
            [trust.turn, trust.limit],
            spec.inverter.t_s,
            [trust.filtered, spec.angle_sensor().is_some()],
        ));
    }
    warnings.extend(warn_of_bus(spec, origins));
    warnings.extend(warn_of_weakening(spec, origins));
    warnings.extend(warn_of_watch(spec, origins));
    warnings.extend(warn_of_trip(spec, origins));
    warnings.extend(times.iter().filter_map(|time| warn_of_time(time, origins)));
    warnings
}

/// Warns of a step that may take longer than the control period on the core that is named.
fn warn_of_time(time: &StepTime, origins: &Origins) -> Option<Diagnostic> {
    let told = || catalogue::step_exceeds_period(origins.at(TARGET), &long_step(time, origins));
    time.is_too_long().then(told)
}

/// Warns of a step that fits in Rust and may take longer than the control period in C.
pub fn warning_in_c(origins: &Origins, times: &[StepTime]) -> Option<Diagnostic> {
    let time = times
        .iter()
        .find(|time| time.is_named && time.is_too_long_in_c_only())?;
    let step = long_step(time, origins);
    Some(catalogue::step_exceeds_period_in_c(
        origins.at(TARGET),
        &step,
    ))
}

/// The option that names the core.
const TARGET: &str = "controller.target";

fn long_step<'a>(time: &'a StepTime, origins: &'a Origins) -> catalogue::LongStep<'a> {
    catalogue::LongStep {
        given: origins.given(TARGET, ""),
        chip: time.chip.name,
        most: [time.most_cycles(), time.most_cycles_in_c()],
        clock: time.clock,
        is_stated: origins.is_given("controller.core_clock"),
        period: time.period,
        estimate: time
            .errors
            .map(|errors| (time.told().any_cycles, errors.any_cycles)),
    }
}

/// Bus voltage over that of the envelope at which a drive makes its whole torque: sampling and dead time take a little.
const ROOM: f64 = 1.01;

/// Warns of a rating beyond the drive's envelope.
fn warn_of_bus(spec: &Spec, origins: &Origins) -> Option<Diagnostic> {
    const SPEED: &str = "motor.rated_speed";
    // A limit of the bus current is meant to cut the torque.
    let envelope = Envelope::of(spec).without_bus_limit();
    let rated = spec.motor.rated_speed;
    let set_point =
        (spec.motor.torque_rating() / envelope.torque_constant()).min(envelope.max_current);
    let torque = set_point * envelope.torque_constant();
    let taken = envelope.bus_voltage(rated, set_point);
    let bus = spec.inverter.v_bus;
    (envelope.torque(rated) < torque * (1.0 - 1e-9)).then(|| {
        let voltages = envelope.voltages(rated, set_point);
        let values = [
            origins.emf_constant(),
            origins.of_motor("resistance"),
            origins.of_motor("inductance"),
        ];
        if let Some(value) = catalogue::most_of_absurd([bus, taken], voltages, values) {
            return catalogue::thousandfold(Code::RatingBeyondBus, &value, [bus, taken]);
        }
        let [emf, drop, inductive] = voltages;
        let inductance = || origins.of_motor("inductance");
        let beyond = catalogue::Beyond {
            torques: [torque, envelope.torque(rated)],
            speed: envelope.speed(torque),
            bus,
            raised: Some(ROOM * taken).filter(|taken| {
                let is_of_board = origins.board_bus().is_none_or(|most| *taken <= most);
                // A turned current takes less than `taken`.
                let is_turned = envelope.weakening.is_some();
                !is_turned && is_of_board && spec.inverter.bus.takes(*taken)
            }),
            pairs: envelope.pairs,
            inductive: (inductive > emf.max(drop))
                .then(|| (inductance(), spec.motor.pole_pairs, inductive)),
        };
        let given = origins.given(SPEED, "");
        catalogue::rating_beyond_bus((origins.at(SPEED), &given), &beyond)
    })
}

/// Warns of a greatest speed at which field weakening no longer suffices.
fn warn_of_weakening(spec: &Spec, origins: &Origins) -> Option<Diagnostic> {
    const SPEED: &str = "inverter.maximum_speed";
    let InverterSpec {
        maximum_speed,
        max_current,
        v_bus,
        ..
    } = spec.inverter;
    if !spec.controller.common().field_weakening {
        return None;
    }
    let last = last_speed(&Envelope::of(spec), maximum_speed)?;
    let given = origins.given(SPEED, &rpm(maximum_speed));
    Some(catalogue::weakening_ends(
        (origins.at(SPEED), &given),
        [max_current, v_bus, last],
    ))
}

/// Warns of a residual watch whose allowance at standstill and full current exceeds half the bus, about what a dead
/// sensor or an open phase causes.
fn warn_of_watch(spec: &Spec, origins: &Origins) -> Option<Diagnostic> {
    const WATCH: &str = "controller.residual_timeout";
    const MAX: &str = "inverter.max_current";
    spec.controller.common().residual_periods?;
    let (most, bus) = (spec.inverter.max_current, spec.inverter.v_bus);
    let allowed = Allowance::of(spec).at(most, 0.0);
    (allowed > 0.5 * bus * (1.0 + 1e-9)).then(|| {
        catalogue::watch_is_blind(
            origins.at(WATCH),
            &origins.given(WATCH, ""),
            &origins.given(MAX, &engineering(most, "A")),
            [allowed, bus],
        )
    })
}

/// Ratio of a stated trip current to the largest set-point's peak above which a warning is given.
const TRIP_GIVEN: f64 = 3.0;

/// Warns of a trip current that protects little, or that PHCC may reach without a fault.
fn warn_of_trip(spec: &Spec, origins: &Origins) -> Vec<Diagnostic> {
    const TRIP: &str = "inverter.trip_current";
    const MAX: &str = "inverter.max_current";
    let (drive, inverter) = (spec.drive(), &spec.inverter);
    let (trip, peak) = (inverter.trip_current, drive.peak());
    let mut warnings = vec![];
    let usual = TRIP_BY_DEFAULT * peak;
    let (most, remedy) = if origins.is_given(TRIP) {
        let usual = engineering(usual, "A");
        let remedy =
            format!("lower it to about {usual} unless switches and magnets withstand more");
        (TRIP_GIVEN * peak, remedy)
    } else {
        let remedy = format!(
            "one vector of {} changes the current by up to {} per period; shorten the control period to lower it",
            spec.controller.kind(),
            engineering(drive.stride(1.0), "A")
        );
        // Rounded up to a count.
        (usual + inverter.adc_gain.abs(), remedy)
    };
    if trip > most * (1.0 + 1e-9) {
        let given = origins.given(TRIP, &engineering(trip, "A"));
        let at = origins.at(TRIP);
        warnings.push(catalogue::trip_far_above(
            at,
            &given,
            trip / peak,
            peak,
            &remedy,
        ));
    }
    let swing = drive.swing();
    if swing > trip && !law(&spec.controller).loses_current() {
        let given = origins.given(MAX, &engineering(inverter.max_current, "A"));
        warnings.push(catalogue::swing_above_trip(
            origins.at(MAX),
            &given,
            [swing, trip],
        ));
    }
    warnings
}

/// A vector that lasts a whole period must not change the current by more than the rated current.
fn check_stride(spec: &Spec, design: &LoopDesign, origins: &Origins, errors: &mut Collector) {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let high = inverter.greatest_bus() * spec.reach_share();
    let stride = design.plant.gain * 2.0 / 3.0 * high;
    if stride > motor.rated_current {
        let at = origins.at("controller.kind");
        let longest = |gain| {
            let t_s = LoopDesign::longest_period(spec, gain);
            [t_s, inverter.pwm_frequency(t_s)]
        };
        errors.push(catalogue::vector_too_strong(
            at,
            spec.controller.kind(),
            stride,
            motor.rated_current,
            longest(design.plant.gain * motor.rated_current / stride),
        ));
    }
}

/// With two vectors per period the voltage misses its reference by at most the distance of a
/// triangle's centre from its edges.
fn check_miss(spec: &Spec, design: &LoopDesign, origins: &Origins, errors: &mut Collector) {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let side = 2.0 / 3.0 * inverter.greatest_bus() * spec.reach_share();
    let miss = design.plant.gain * side / 12_f64.sqrt();
    if miss > motor.rated_current {
        let at = origins.at("controller.modulated");
        let t_s = LoopDesign::longest_period(spec, design.plant.gain * motor.rated_current / miss);
        let longest = [t_s, inverter.pwm_frequency(t_s)];
        errors.push(catalogue::vectors_too_coarse(
            at,
            miss,
            motor.rated_current,
            longest,
        ));
    }
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
    linear: &dyn LinearLoop,
    origins: &Origins,
    errors: &mut Collector,
) -> StableRange {
    let radius = linear.spectral_radius(spec);
    let stable = linear.stable_range(spec);
    let law = law(&spec.controller);
    if radius >= 1.0 {
        let Cause {
            field,
            value,
            remedy,
        } = law.unstable_by(spec);
        let path = format!("controller.{field}");
        errors.push(catalogue::unstable_loop(
            origins.at(&path),
            field,
            &origins.given(&path, &value),
            radius,
            remedy,
        ));
        return stable;
    }
    let remedy = law.steadier(spec);
    let leaves = |tolerance: f64, (low, high): (f64, f64)| {
        // Beyond the searched range nothing is known to be unstable.
        let [least, most] = SEARCHED;
        (1.0 - tolerance < low && low > least) || (1.0 + tolerance > high && high < most)
    };
    let motor = &spec.motor;
    for (code, quantity, tolerance, range) in [
        (
            Code::InductanceOutsideStableRange,
            "inductance",
            motor.inductance_tolerance,
            stable.inductance,
        ),
        (
            Code::ResistanceOutsideStableRange,
            "resistance",
            motor.resistance_tolerance,
            stable.resistance,
        ),
    ] {
        if leaves(tolerance, range) {
            let path = format!("motor.{quantity}_tolerance");
            let given = origins.given(&path, &percent(tolerance));
            errors.push(catalogue::outside_stable_range(
                code,
                origins.at(&path),
                quantity,
                &given,
                range,
                remedy,
            ));
        }
    }
    stable
}

#[cfg(test)]
mod tests {
    use super::{check_stability, generate};
    use crate::design::DiscretePlant;
    use crate::diagnostics::{Code, Collector};
    use crate::laws::current_loop::LinearLoop;
    use crate::spec::{apply_variant, check, parse_toml};
    use nalgebra::DVector;

    const MOTOR: &str = r#"
[motor]
description = "660 W"
pole_pairs = 4
resistance = "0.135 ohm per_phase"
inductance = "0.22 mH per_phase"
winding = "star"
back_emf = "0.1648 V/(rad/s) line_to_line peak"
emf_shape = "trapezoidal"
rated_current = "20 A peak"
rated_torque = "3.3 Nm"
rated_speed = "2000 rpm"
[inverter]
bus_voltage = "48 V"
f_pwm = "20 kHz"
timer_clock = "72 MHz"
adc_bits = 12
adc_range = "40 A"
current_sensing = "in_phase"
hall_timer_clock = "1 MHz"
[controller]
kind = "pdcc"
"#;

    #[test]
    fn every_controller_generates_for_the_paper_motor() {
        // The second is for regulators without EMF options.
        let common = [
            "emf=estimated",
            "discretisation=exact",
            "emf=model",
            "emf=estimated,emf_filter=0.7",
        ];
        let rest = [
            "delay=1",
            "delay=0",
            "delay=1,advance=1.5",
            "delay=1,word=16",
            "delay=1,reference=proportional",
        ];
        let fcs = ["table2", "all"]
            .into_iter()
            .flat_map(|set| {
                ["physical", "nominal"].map(|off| format!("fcs-mpc:candidates={set},off_leg={off}"))
            })
            .chain(["fcs-mpc:candidates=three_phase".to_owned()]);
        let fcs = fcs.flat_map(|kind| {
            ["off", "on"].map(|modulated| format!("{kind},modulated={modulated}"))
        });
        let pi = ["keep_angle", "nearest", "torque_priority"]
            .into_iter()
            .map(|rule| format!("pi-pwm:saturation={rule}"))
            .chain([
                "pi-pwm:feed_forward=off".to_owned(),
                "pi-pwm:six_step=on".to_owned(),
            ]);
        let ph = [
            "phcc",
            "phcc:table=printed",
            "phcc:off_leg=nominal",
            "phcc:candidates=three_phase",
        ]
        .map(str::to_owned);
        let mut generated = 0;
        for kind in fcs.chain(pi).chain(ph) {
            for emf in common {
                for rest in rest {
                    let joint = if kind.contains(':') { ',' } else { ':' };
                    let variant = format!("{kind}{joint}{emf},{rest}");
                    let mut ast = parse_toml(MOTOR, "motor.toml").expect("the motor parses");
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
        assert!(generated > 100, "{generated}");
    }

    #[test]
    fn every_variant_of_the_paper_motor_generates_or_is_refused() {
        let mut generated = 0;
        for modulation in ["three_phase", "pair"] {
            for saturation in ["keep_angle", "nearest", "torque_priority"] {
                for emf in [
                    "emf=estimated",
                    "emf=model",
                    "emf=estimated,emf_filter=0.7",
                    "emf=observer",
                ] {
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

    #[test]
    fn an_estimate_that_turns_too_far_is_warned_of() {
        let sine = MOTOR
            .replace("trapezoidal", "sinusoidal")
            .replace("rated_torque = \"3.3 Nm\"\n", "");
        let slow = sine.replace("f_pwm = \"20 kHz\"", "f_pwm = \"4 kHz\"");
        let told = |motor: &str, variant: &str| {
            let mut ast = parse_toml(motor, "motor.toml").expect("the motor parses");
            apply_variant(&mut ast, variant).expect("the variant parses");
            let (spec, origins) = check(&ast).expect("it passes the checks");
            let warnings = super::warnings(&spec, &origins, &[]);
            let of_emf = warnings
                .iter()
                .filter(|warning| warning.code == Code::EstimateTurnsTooFar);
            of_emf.map(ToString::to_string).collect::<Vec<_>>()
        };
        for variant in ["pdcc", "fcs-mpc", "phcc", "pi-pwm"] {
            assert_eq!(told(MOTOR, variant), [""; 0], "the paper's with {variant}");
            assert_eq!(told(&sine, variant), [""; 0], "a sine with {variant}");
        }
        for variant in [
            "pdcc",
            "pdcc:emf=model",
            "pdcc:emf=held",
            "pi-pwm:feed_forward=off",
            "phcc:delay=0",
        ] {
            assert_eq!(told(&slow, variant), [""; 0], "{variant}");
        }
        for (motor, variant, told_of) in [
            (
                &slow,
                "fcs-mpc",
                "warning[HX0602]: `emf`: estimated (default), but the EMF turns 12 electrical degrees per control period at rated speed; above 9 the torque may be more than 5 % off; choose `emf=observer` with `reference=proportional` and `hall_capture=timer`, or a control period of at most 187.5 us",
            ),
            (
                &sine,
                "pdcc:emf_filter=0.01",
                "above 1.146 the estimate cannot follow; choose a greater `emf_filter`, `emf=observer`",
            ),
        ] {
            let told = told(motor, variant);
            assert!(
                matches!(&told[..], [one] if one.contains(told_of)),
                "{told:?}"
            );
        }
    }

    fn of(variant: &str) -> super::Generated {
        let mut ast = parse_toml(MOTOR, "motor.toml").expect("the motor parses");
        apply_variant(&mut ast, variant).expect("the variant parses");
        let (spec, origins) = check(&ast).expect("it passes the checks");
        generate(&spec, &origins).unwrap_or_else(|errors| panic!("{variant}: {errors}"))
    }

    /// A loop with one pole, whatever the motor.
    struct OnePole(f64);

    impl LinearLoop for OnePole {
        fn order(&self) -> usize {
            1
        }

        fn advance(&self, _: DiscretePlant, x: &DVector<f64>) -> DVector<f64> {
            x * self.0
        }
    }

    #[test]
    fn a_loop_is_stable_with_its_largest_pole_below_1_only() {
        let ast = parse_toml(MOTOR, "motor.toml").expect("the motor parses");
        let (spec, origins) = check(&ast).expect("it passes the checks");
        let codes = |pole: f64| {
            let mut errors = Collector::new();
            check_stability(&spec, &OnePole(pole), &origins, &mut errors);
            let errors = errors.into_result(()).err().into_iter().flatten();
            errors.map(|error| error.code).collect::<Vec<_>>()
        };
        for sign in [1.0, -1.0] {
            for stable in [0.0, 0.5, 1.0_f64.next_down()] {
                assert_eq!(codes(sign * stable), [], "{stable}");
            }
            for unstable in [1.0, 1.0_f64.next_up(), 2.0] {
                assert_eq!(codes(sign * unstable), [Code::Unstable], "{unstable}");
            }
        }
    }

    #[test]
    fn a_target_chooses_words_that_suffice_and_says_what_they_cost() {
        let narrow = of("pdcc:reference=quasi_square,target=cortex_m0");
        let given = of("pdcc:reference=quasi_square,word=16");
        assert_eq!(narrow.graph, given.graph);
        assert_eq!(narrow.interface.spec_toml, given.interface.spec_toml);
        let doc = narrow.interface.doc.join("\n");
        let (_, cost) = doc.split_once("`DUTY_ERROR` is ").expect("the cost");
        let (narrow_bound, rest) = cost.split_once(" in place of ").expect("two bounds");
        let (wide_bound, _) = rest.split_once([',', '\n']).unwrap_or((rest, ""));
        let [narrow_bound, wide_bound] = [narrow_bound, wide_bound].map(|bound| {
            bound
                .trim_end_matches('.')
                .parse::<f64>()
                .expect("a number")
        });
        assert!(narrow_bound > 1000.0 * wide_bound, "{doc}");
        let (stated, chosen) = (of("pdcc:target=cortex_m0,word=32"), of("pdcc"));
        assert_eq!(stated.graph, chosen.graph);
        assert_eq!(stated.interface.spec_toml, chosen.interface.spec_toml);
        for target in ["cortex_m4", "riscv32", "portable"] {
            assert_eq!(of(&format!("pdcc:target={target}")).graph, of("pdcc").graph);
        }
    }

    #[test]
    fn hall_angles_and_torque_constant_are_learnt_together() {
        let bus = "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"65 V\"\nf_pwm";
        let mut ast = parse_toml(&MOTOR.replace("f_pwm", bus), "motor.toml").expect("it parses");
        let variant = "pdcc:emf=observer,hall_learning=on,torque_learning=on";
        apply_variant(&mut ast, variant).expect("the variant parses");
        let (spec, origins) = check(&ast).expect("it passes the checks");
        generate(&spec, &origins).expect("each signal has a name of its own");
    }

    #[test]
    fn where_narrow_words_do_not_suffice_wide_ones_stand_with_the_reason() {
        let motor = parse_toml(
            &MOTOR.replace("adc_bits = 12", "adc_bits = 16"),
            "motor.toml",
        )
        .expect("the motor parses");
        let checked = |variant: &str| {
            let mut ast = motor.clone();
            apply_variant(&mut ast, variant).expect("the variant parses");
            check(&ast).expect("it passes the checks")
        };
        let (spec, origins) = checked("pdcc:word=16");
        generate(&spec, &origins).expect_err("16 bits hold no current of 16 bits");
        let (spec, origins) = checked("pdcc:target=cortex_m0");
        let wide = generate(&spec, &origins).expect("32 bits do");
        assert!(wide.interface.spec_toml.contains("word = 32"));
        let doc = wide.interface.doc.join("\n");
        assert!(
            doc.contains("do not suffice (") && doc.contains("phase currents"),
            "{doc}"
        );
    }
}
