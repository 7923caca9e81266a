//! From the same state and the same sample, the ideal and the bit-true model take the same step
//! except for rounding, in every variant.

use crate::variants::{self, Variant};
use hexagen::{Command, LegState, Sample};
use hexagen_reference::verify::{Action, Context, Stimulus};
use hexagen_reference::{
    AnyCommand, BitTrue, Controller, DiscretePhase, Duties, Ideal, Mode, OffLeg, PhysicalState,
    Switch, Trace, sixths,
};
use std::f64::consts::{FRAC_PI_3, FRAC_PI_6, PI, TAU};

const STEPS: u64 = 1000;

/// Largest distance of the shape's table from the shape: parabolas over 48 segments of the trapezoid.
const SHAPE_MISFIT: f64 = 8e-5;

/// Largest deviations, volt and counts; of EMF and unlimited voltage beyond the shape's misfit.
#[derive(Debug, Default)]
struct Worst {
    emf: f64,
    unsat: f64,
    limited: f64,
    compare: f64,
    compared: u64,
    decided_otherwise: u64,
}

fn follow(variant: &Variant, seed: u64) -> Worst {
    let mut bit_true =
        BitTrue::new(&variant.spec, &variants::table(variant)).expect("a bit-true model");
    let mut ideal = Ideal::new(&variant.spec).expect("an ideal model");
    let mut stimulus = Stimulus::new(&variant.spec, seed).expect("a stimulus");
    let mut worst = Worst::default();
    for step in 0..STEPS {
        let context = Context {
            offset: bit_true.offset_counts(),
            tripped: bit_true.mode() == Mode::Tripped,
        };
        let (action, sample) = stimulus.next(&context);
        match action {
            Some(Action::SetCurrent(bits)) => {
                bit_true.set_current(bits);
                ideal.set_current(bits);
            }
            Some(Action::SetTorque(bits)) => {
                bit_true.set_torque(bits);
                ideal.set_torque(bits);
            }
            Some(Action::SetSpeed(bits)) => {
                bit_true.set_speed(bits);
                ideal.set_speed(bits);
            }
            Some(Action::SetBus(counts)) => {
                bit_true.set_bus(counts);
                ideal.set_bus(counts);
            }
            Some(Action::Reset) => {
                // Both clear the set-point, or neither.
                ideal.rebuild_from(&bit_true.physical_state());
                bit_true.reset();
                ideal.reset();
            }
            Some(Action::Calibrate) => bit_true.calibrate(),
            Some(Action::Precharge) => bit_true.precharge(),
            Some(Action::Stop(stop)) => {
                ideal.rebuild_from(&bit_true.physical_state());
                bit_true.stop(stop);
                ideal.stop(stop);
            }
            Some(Action::Remember | Action::Recall) | None => {}
        }
        let before = bit_true.physical_state();
        let tie = floated_at_threshold(variant, &before);
        ideal.rebuild_from(&before);
        let command = bit_true.step(&sample);
        let duties = ideal.step(&sample);
        stimulus.respond(command);
        let states = [bit_true.physical_state(), ideal.physical_state()];
        let [of_words, exact] = states.map(|state| state.torque_ratio());
        assert!(
            (of_words - exact).abs() < 1e-5,
            "{} step {step}: {of_words}, exactly {exact}",
            variant.name
        );
        if tie && far(bit_true.trace().e, ideal.trace().e) > 0.1 {
            worst.decided_otherwise += 1;
            continue;
        }
        compare(
            variant,
            step,
            sample,
            &before,
            (&bit_true, &ideal),
            &mut worst,
            |phase| {
                let period = f64::from(variant.spec.inverter.timer_period);
                let [on, off] = times_of(command, phase, period);
                let [exact_on, exact_off] = exact_times(&duties, phase).map(|share| share * period);
                (on - exact_on, (off - exact_off).abs() < 0.02 * period)
            },
        );
    }
    worst
}

/// Counts for which a leg is on, and off. Which vector has no length, and which of two low legs has a pulse of no length,
/// makes no difference.
fn times_of(command: AnyCommand, leg: usize, period: f64) -> [f64; 2] {
    let on = command.on()[leg].unwrap_or_default();
    [on, command.off(period as u16)[leg]].map(f64::from)
}

/// The same of the ideal model, shares of the period.
fn exact_times(duties: &Duties, leg: usize) -> [f64; 2] {
    let Some([second, third]) = duties.later else {
        let is_off = duties.state[leg] == LegState::Off;
        return [duties.duty[leg], f64::from(u8::from(is_off))];
    };
    let [first_end, second_end, _] = duties.duty;
    let states = [duties.state, second, third].map(|legs| legs[leg]);
    let lengths = [first_end, second_end - first_end];
    let on = states.iter().zip(lengths);
    let on = on.filter(|(state, _)| **state == LegState::Pulsed);
    let off = states
        .iter()
        .zip([lengths[0], lengths[1], 1.0 - second_end]);
    let off = off.filter(|(state, _)| **state == LegState::Off);
    [
        on.map(|(_, length)| length).sum(),
        off.map(|(_, length)| length).sum(),
    ]
}

fn compare(
    variant: &Variant,
    step: u64,
    sample: Sample,
    before: &PhysicalState,
    (bit_true, ideal): (&BitTrue, &Ideal),
    worst: &mut Worst,
    leg: impl Fn(usize) -> (f64, bool),
) {
    let (b, a) = (bit_true.trace(), ideal.trace());
    assert_eq!(b.run, a.run, "{} step {step} {sample:?}", variant.name);
    if !b.run {
        assert!((0..3).all(|phase| leg(phase) == (0.0, true)));
        return;
    }
    // A threshold may fall between the two models. With sampled edges an advanced angle often falls
    // on a sector's edge exactly, where the rounded one stays just before it.
    if b.sector_eff != a.sector_eff {
        let advanced = a.theta + variant.spec.loop_options().advance * a.step_angle;
        let from_edge = (advanced - FRAC_PI_6).rem_euclid(FRAC_PI_3);
        let distance = from_edge.min(FRAC_PI_3 - from_edge);
        assert!(
            distance < 1e-5,
            "{} step {step}: {distance} rad from the sector's edge",
            variant.name
        );
        return;
    }
    // The end of a commutation, a clamped leg.
    if b.commutating != a.commutating || (b.net[0] - a.net[0]).abs() > 0.1 {
        worst.decided_otherwise += 1;
        return;
    }
    // At an edge the currents may be just as small as those at which the EMF tells the angle: then it moves by a step
    // or not.
    let learns = variant.spec.loop_options().hall_learning == Switch::On;
    let apart = ((b.theta - a.theta + PI).rem_euclid(TAU) - PI).abs();
    if learns && apart > 1e-4 {
        let of_edges = FRAC_PI_3 / 1024.0;
        assert!(
            apart < 1.1 * of_edges,
            "{} step {step}: {apart} rad",
            variant.name
        );
        worst.decided_otherwise += 1;
        return;
    }
    worst.compared += 1;
    // The observed error of the EMF, q and d, is multiplied by shapes of phase and line, and with a
    // bus of 390 V it may be several times the nominal bus.
    let [q, d] = bit_true.physical_state().emf_error.map(f64::abs);
    let misfit = SHAPE_MISFIT * (q + 3.0 * d);
    worst.emf = worst.emf.max(far(b.e, a.e) - misfit);
    worst.unsat = worst.unsat.max(far(b.u_unsat, a.u_unsat) - misfit);
    if b.vector != a.vector {
        if let Controller::Phcc(options) = &variant.spec.controller {
            // A direction may differ only if the error lies at the edge of its band, or at zero
            // without a previous direction.
            let DiscretePhase { b: gain, .. } = DiscretePhase::new(&variant.spec);
            let [q_a, q_b] = a.u_unsat;
            let errors = [q_a, (q_a + 2.0 * q_b) / 3f64.sqrt()].map(|q| (q * gain).abs());
            let near = errors.iter().zip(before.rises).any(|(error, before)| {
                let edge = before.map_or(0.0, |_| options.band);
                (error - edge).abs() < 0.02 * options.band
            });
            assert!(near, "{} step {step}: errors {errors:?}", variant.name);
            worst.decided_otherwise += 1;
            return;
        }
        // Two vectors at nearly the same distance. With an off leg at a rail, two numbers name one
        // voltage; where the leg sits may be decided otherwise, too.
        let v_bus = variant.spec.inverter.v_bus_max().expect("a bus");
        let [of_a, of_b] = [a, &b].map(|trace| compared_voltage(variant, trace));
        let gap = (distance(a.u_unsat, of_a) - distance(a.u_unsat, of_b)).abs();
        let near_tie = gap < 2e-3 * v_bus * (v_bus + a.u_unsat[0].abs() + a.u_unsat[1].abs());
        if near_tie {
            return;
        }
        assert!(
            matches!(&variant.spec.controller,
                Controller::FcsMpc(options) if options.off_leg == OffLeg::Physical || !variants::is_plain(options)),
            "{} step {step}: {} and {}, costs {gap} apart",
            variant.name,
            b.vector,
            a.vector
        );
        worst.decided_otherwise += 1;
        return;
    }
    // Torque priority switches to the nearest point where the EMF nearly vanishes.
    let limited = far(b.u, a.u);
    if limited > 0.01 * variant.spec.inverter.v_bus {
        worst.decided_otherwise += 1;
        return;
    }
    worst.limited = worst.limited.max(limited);
    for phase in 0..3 {
        let (error, same) = leg(phase);
        if same {
            worst.compare = worst.compare.max(error.abs());
        } else {
            worst.decided_otherwise += 1;
        }
    }
}

/// The voltage by which a vector was chosen. A divided period has a partner's, too: on a fixed bus, where no diode takes
/// part, it is that of the whole vector.
fn compared_voltage(variant: &Variant, trace: &Trace) -> [f64; 2] {
    let inverter = &variant.spec.inverter;
    let is_fixed = inverter.bus_sense().is_ok_and(|bus| bus.is_none());
    match &variant.spec.controller {
        Controller::FcsMpc(options)
            if is_fixed
                && options.off_leg == OffLeg::Nominal
                && options.modulated == Switch::On =>
        {
            let [a, b, _] = sixths(trace.vector).map(|part| part * inverter.v_bus / 6.0);
            [a, b]
        }
        _ => trace.u,
    }
}

/// The off leg carried its diode's threshold current, to the last bit: the models may differ in
/// whether they observed its EMF.
fn floated_at_threshold(variant: &Variant, state: &PhysicalState) -> bool {
    let [a, b] = state.i_prev;
    let end = variant.spec.commutation_end().unwrap_or_default();
    state.off_prev.is_some_and(|off| {
        let current = [a, b, -(a + b)][off].abs();
        (current - end.threshold).abs() < 1e-9
    })
}

/// The larger deviation of phases a, b.
fn far(b: [f64; 2], a: [f64; 2]) -> f64 {
    (b[0] - a[0]).abs().max((b[1] - a[1]).abs())
}

/// Squared distance of two zero-sum vectors by phases a, b.
fn distance(u: [f64; 2], v: [f64; 2]) -> f64 {
    let [a, b] = [u[0] - v[0], u[1] - v[1]];
    a * a + b * b + (a + b) * (a + b)
}

#[test]
fn in_every_variant() {
    let mut variants = variants::all();
    variants.extend(variants::others());
    variants.extend(variants::of_table2());
    variants.extend(variants::limited());
    let weakened = variants::weakened();
    assert!(weakened.len() > 20, "{}", weakened.len());
    variants.extend(weakened);
    let learnt = variants::learnt();
    assert!(learnt.len() > 20, "{}", learnt.len());
    variants.extend(learnt);
    let of_torque = variants::with_torque_learnt();
    assert!(of_torque.len() > 20, "{}", of_torque.len());
    variants.extend(of_torque);
    let mut overall = Worst::default();
    for (seed, variant) in (0..).zip(&variants) {
        let worst = follow(variant, seed);
        let v_bus = variant.spec.inverter.v_bus;
        let named = || format!("{}: {worst:?}", variant.name);
        assert!(worst.compared > STEPS / 5, "{}", named());
        assert!(worst.decided_otherwise <= STEPS / 50, "{}", named());
        // The model EMF has the flux table's interpolation error; all else is rounding.
        assert!(worst.emf < 5e-4 * v_bus, "{}", named());
        assert!(worst.unsat < 1e-3 * v_bus, "{}", named());
        assert!(worst.limited < 0.01 * v_bus, "{}", named());
        overall.emf = overall.emf.max(worst.emf / v_bus);
        overall.unsat = overall.unsat.max(worst.unsat / v_bus);
        overall.limited = overall.limited.max(worst.limited / v_bus);
        overall.compare = overall.compare.max(worst.compare);
        overall.compared += worst.compared;
        overall.decided_otherwise += worst.decided_otherwise;
    }
    println!(
        "{} variants, in units of the bus: {overall:?}",
        variants.len()
    );
}
