//! PI control as IR: the shared step, two regulators, the voltage limit and the modulator.

use crate::controllers::current_loop::{CurrentLoop, EmfUse, Front, LoopDesign, Needs, lower_with};
use crate::ir::{Interval, Value};
use crate::lower::{Coefficient, Command, Lowering, Priority, Scale};
use crate::scaling::Lowered;
use crate::spec::{PiPwmSpec, Spec};

/// What the stage that integrates is about.
const INTEGRATION: &[&str] = &[
    "Integration and tracking anti-windup with one time constant: s + k_i (p + v - u) with u = p + s + e the voltage asked",
    "for and v what the limit left of it, so the integral part follows v - e.",
];

/// Lowers the controller at a scale.
pub fn lower(spec: &Spec, options: &PiPwmSpec, design: &LoopDesign, scale: Scale) -> Lowered {
    let gain = options.proportional_gain(&spec.motor);
    lower_with(spec, scale, gain, |lowering, set_point| {
        let mut step = CurrentLoop {
            lowering,
            options: &options.common,
            design,
            needs: Needs {
                commutation: false,
                off_leg: false,
                emf: if options.feed_forward {
                    EmfUse::FeedForward
                } else {
                    EmfUse::None
                },
                integral: false,
                memory: 0,
            },
        };
        let front = step.front(set_point);
        if options.six_step {
            return six_step(&mut step, &front, spec, options);
        }
        let l = &mut *step.lowering;
        let range = integral_range(l, options);
        let integrals = ["integral_a", "integral_b"].map(|name| {
            let doc = "Integral part of the regulator, words of voltage.";
            l.state(name, 0, range, doc)
        });
        let [k_drop, k_i] = gains(l, spec, options);
        l.b.stage(
            "regulate",
            &["PI regulator per phase: v = k_p (i_ref - i) + integral, and the EMF where it is fed forward."],
        );
        let regulated = [0, 1].map(|x| {
            let drop = l.times(k_drop, front.currents.phases[x]);
            let held = options.dead_time_compensation.then(|| {
                l.b.name(["drop_a", "drop_b"][x], drop);
                let held = l.b.neg(drop);
                l.b.name(["held_a", "held_b"][x], held)
            });
            let part = l.b.add(front.reference[x], drop);
            (held, l.b.name(["p_a", "p_b"][x], part))
        });
        let sums = [0, 1].map(|x| l.b.state(integrals[x]));
        let u = [0, 1].map(|x| {
            let volts = l.b.add(regulated[x].1, sums[x]);
            let volts = match front.e {
                Some(e) => l.b.add(volts, e[x]),
                None => volts,
            };
            let doc = "Voltage of a phase that the law asks for, before the limit";
            let word = 1.0 / l.scale.voltage();
            l.b.state_error("voltage", volts, [doc, "V"], word);
            l.b.name(["u_a_unsat", "u_b_unsat"][x], volts)
        });
        let shifts = match regulated {
            [(Some(a), _), (Some(b), _)] => {
                Some(step.dead_time_shifts(front.reference, [a, b], gain))
            }
            _ => None,
        };
        let l = &mut *step.lowering;
        let emf = front.e.map(|e| move |_: &mut Lowering<'_>| e);
        let lifts = front.bus.ratio.is_none();
        let bus = (front.bus, front.third);
        let priority = Priority::of(options.saturation, emf);
        let limited = l.limit_voltage(priority, u, bus, lifts);
        l.b.stage("integrate", INTEGRATION);
        let mut remembered = vec![];
        for x in 0..2 {
            let target = match front.e {
                Some(e) => l.b.sub(limited.u[x], e[x]),
                None => limited.u[x],
            };
            let names = [
                ["distance_a", "integral_a_now"],
                ["distance_b", "integral_b_now"],
            ][x];
            let held = integrate(l, range, k_i, [sums[x], target], names);
            remembered.push((integrals[x], held));
        }
        let command = l.modulate(limited, front.bus, shifts);
        step.remember(&front, &command, Some(limited.u), None, remembered);
    })
}

/// -k_p, by which a product is added in one instruction, and k_i.
fn gains(l: &mut Lowering<'_>, spec: &Spec, options: &PiPwmSpec) -> [Coefficient; 2] {
    let gain = options.proportional_gain(&spec.motor);
    let word = options.common.word;
    let k_drop = l.impedance(
        "k_drop",
        -gain,
        word,
        "Weight of the present current: the proportional gain k_p = 2 pi f L, negative.",
        ["-k_p", "V/A"],
    );
    let share = options.integral_share(spec);
    let k_i = l.coefficient(
        "k_i",
        share,
        word,
        "Share of its distance that the integral part covers in one period, T_s/T_i.",
        &format!("T_s/T_i = {share:.6}"),
    );
    [k_drop, k_i]
}

/// Where the integral part may lie: within the greatest bus. Without an EMF it cannot leave that, as a mean of itself and
/// the limited voltage; the clamp is there for the proof then, and at the next power of two it takes one instruction
/// where there is one that saturates.
fn integral_range(l: &Lowering<'_>, options: &PiPwmSpec) -> Interval {
    let bus = l.bus_interval().high;
    if options.feed_forward {
        return Interval::symmetric(bus);
    }
    let limit = bus.unsigned_abs().next_power_of_two() as i64;
    Interval::new(-limit, limit - 1)
}

/// The new integral part `sum`, which follows `target`: what the limit left of the voltage, less the EMF fed forward.
/// `names` are those of its distance and of itself.
fn integrate(
    l: &mut Lowering<'_>,
    range: Interval,
    k_i: Coefficient,
    [sum, target]: [Value; 2],
    names: [&str; 2],
) -> Value {
    let distance = l.b.sub(target, sum);
    l.b.name(names[0], distance);
    let change = l.times(k_i, distance);
    let sum = l.b.add(sum, change);
    let doc = "Largest integral part";
    let (low, high) = (
        l.voltage("integral_min", range.low, doc),
        l.voltage("integral_max", range.high, doc),
    );
    let held = l.b.clamp(sum, low, high);
    let doc = "Integral part after one step";
    let word = 1.0 / l.scale.voltage();
    l.b.state_error("integral", held, [doc, "V"], word);
    l.b.name(names[1], held)
}

/// One regulator for the current of the conducting pair, and the pulses of its line voltage.
fn six_step(step: &mut CurrentLoop<'_, '_>, front: &Front, spec: &Spec, options: &PiPwmSpec) {
    let l = &mut *step.lowering;
    let range = integral_range(l, options);
    let doc = "Integral part of the regulator, words of voltage.";
    let integral = l.state("integral", 0, range, doc);
    let [k_drop, k_i] = gains(l, spec, options);
    l.b.stage(
        "regulate",
        &["PI regulator of the pair's current: v = k_p (i_ref - i) + integral, per winding."],
    );
    let sign = l.pair_signs(front.sector);
    let halves = [0, 1, 2].map(|x| l.b.shift_right(front.currents.phases[x], 1));
    let current = l.across_pair(sign, halves);
    l.b.name("pair_current", current);
    let drop = l.times(k_drop, current);
    let part = l.b.add(front.set_point, drop);
    l.b.name("part", part);
    let flow = options.dead_time_compensation.then(|| {
        [0, 1].map(|x| {
            let drop = l.times(k_drop, front.currents.phases[x]);
            let flow = l.b.neg(drop);
            l.b.name(["held_a", "held_b"][x], flow)
        })
    });
    let sum = l.b.state(integral);
    let u = l.b.add(part, sum);
    let doc = "Voltage of a winding that the law asks for, before the limit";
    let word = 1.0 / l.scale.voltage();
    l.b.state_error("voltage", u, [doc, "V"], word);
    l.b.name("u", u);
    let line = l.b.shift_left(u, 1);
    let line = l.limit_line(line, front.bus);
    l.b.stage("integrate", INTEGRATION);
    let limited = l.b.shift_right(line, 1);
    let held = integrate(l, range, k_i, [sum, limited], ["distance", "integral_now"]);
    let gain = options.proportional_gain(&spec.motor);
    let shifts = flow.map(|flow| step.dead_time_shifts(front.reference, flow, gain));
    let l = &mut *step.lowering;
    l.b.stage(
        "modulate_pair",
        &["One leg of the pair pulsed, its partner low, the third off, in commutation as well."],
    );
    let pulses = l.pulse_pair(sign, line, front.bus, shifts);
    let command = Command {
        compares: pulses.compares,
        legs: pulses.legs,
    };
    step.remember(front, &command, None, None, vec![(integral, held)]);
}
